// Which kernels of a machine are taken.
#include <gtest/gtest.h>

#include "fullsim/storage/gore_batched/kernels.hpp"
#include "fullsim/storage/simd/instruction_sets.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

struct NamedKernels {
    std::string_view instruction_set;
    bool operator==(const NamedKernels&) const = default;
};
const std::vector<NamedKernels> of_machine{{"AVX2"}, {"SSE4"}, {"generic"}};

TEST(InstructionSets, NoneIsWiderThanWanted) {
    EXPECT_EQ(up_to("", of_machine), of_machine);
    EXPECT_EQ(up_to("AVX2", of_machine), of_machine);
    EXPECT_EQ(up_to("SSE4", of_machine), (std::vector<NamedKernels>{{"SSE4"}, {"generic"}}));
    EXPECT_EQ(up_to("generic", of_machine), std::vector<NamedKernels>{{"generic"}});
}

TEST(InstructionSets, OneThatTheMachineHasNotIsRefused) {
    for (const char* wanted : {"AVX-512", "avx2", " "})
        try {
            up_to(wanted, of_machine);
            ADD_FAILURE() << wanted;
        } catch (const SceneError& error) {
            EXPECT_EQ(error.what(),
                      std::string(wanted) +
                          ": TWINCHUTE_INSTRUCTION_SET names no instruction set of this machine "
                          "(it has AVX2, SSE4, generic), set it to one of these, or unset it");
        }
}

TEST(InstructionSets, KernelsAreOfTheWantedOne) {
    // The widest one is wanted unless the environment of these tests names another.
    const std::string& wanted = wanted_instruction_set();
    if (!wanted.empty()) {
        EXPECT_EQ(gore_kernels().instruction_set, wanted);
    }
    EXPECT_EQ(&gore_kernels(), &all_gore_kernels().front());
}

}  // namespace
}  // namespace twinchute::fullsim
