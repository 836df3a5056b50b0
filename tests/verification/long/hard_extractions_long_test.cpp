// Sixty parachutes torn out of their pack at the default step: each comes to its end. Some minutes.
#include <gtest/gtest.h>

#include "tests/support/hard_extractions.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

constexpr int shards = 15, each = 60 / shards;

class HardExtractionsLong : public testing::TestWithParam<int> {};

TEST_P(HardExtractionsLong, ComeToTheirEnd) {
    for (int k = GetParam() * each; k < (GetParam() + 1) * each; ++k) {
        const RunRecord record = test::run_full(test::hard_extraction(k));
        EXPECT_EQ(record.status.code, StatusCode::completed) << k << ": " << record.status.detail;
    }
}
INSTANTIATE_TEST_SUITE_P(Sixty, HardExtractionsLong, testing::Range(0, shards));

}  // namespace
}  // namespace twinchute
