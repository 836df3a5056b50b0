// Lists that stand in two rooms because the include order keeps them apart: they have to agree.
#include <gtest/gtest.h>

#include <algorithm>

#include "lib/scene/keys.hpp"
#include "lib/solve/sundials.hpp"

namespace twinchute {
namespace {

TEST(KeysContract, RomMethodsAreTheIntegratorsMethods) {
    const Key* key = find_key(scene_keys(), "rom.method");
    ASSERT_NE(key, nullptr);
    const auto words = key->choices();
    ASSERT_EQ(words.size(), ode_methods().size());
    for (const OdeMethod& method : ode_methods())
        EXPECT_NE(std::ranges::find(words, method.name), words.end()) << method.name;
    const OdeMethod* fallback = find_ode_method(key->fallback);
    ASSERT_NE(fallback, nullptr);
    EXPECT_FALSE(fallback->implicit);
}

}  // namespace
}  // namespace twinchute
