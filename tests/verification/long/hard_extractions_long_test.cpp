// Sixty parachutes torn out of their pack at the default step: each comes to its end. Some minutes.
#include <gtest/gtest.h>

#include "tests/support/hard_extractions.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

TEST(HardExtractionsLong, SixtyComeToTheirEnd) {
    for (std::size_t k = 0; k < 60; ++k) {
        const RunRecord record = test::run_full(test::hard_extraction(k));
        EXPECT_EQ(record.status.code, StatusCode::completed) << k << ": " << record.status.detail;
    }
}

}  // namespace
}  // namespace twinchute
