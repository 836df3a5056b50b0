// Lists that two modules hold each, since the include order keeps them apart: they have to agree.
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
    ASSERT_EQ(words.size(), ode_methods().size() + 1);
    EXPECT_NE(std::ranges::find(words, "auto"), words.end());
    EXPECT_EQ(find_ode_method("auto"), nullptr);
    for (const OdeMethod& method : ode_methods())
        EXPECT_NE(std::ranges::find(words, method.name), words.end()) << method.name;
    EXPECT_EQ(key->fallback, "auto");
}

}  // namespace
}  // namespace twinchute
