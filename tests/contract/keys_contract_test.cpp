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
    ASSERT_EQ(words.size(), explicit_methods().size());
    for (const ExplicitMethod& method : explicit_methods())
        EXPECT_NE(std::ranges::find(words, method.name), words.end()) << method.name;
    EXPECT_NE(find_explicit_method(key->fallback), nullptr);
}

}  // namespace
}  // namespace twinchute
