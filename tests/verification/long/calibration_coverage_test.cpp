// A 95 % interval is one in 95 % of cases.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/calibration_coverage.hpp"

namespace twinchute::test {
namespace {

TEST(CalibrationCoverage, IntervalsHoldTheTruthAsOftenAsTheySay) {
    const std::vector<Coverage> coverage = coverage_of(1000, 2);
    std::fputs(coverage_text(coverage).c_str(), stdout);
    for (const Coverage& one : coverage) {
        EXPECT_GT(one.identified, 900) << one.parameter;
        EXPECT_GE(one.share(), 0.92) << one.parameter;
        EXPECT_LE(one.share(), 0.98) << one.parameter;
        EXPECT_LT(std::abs(one.bias), 0.2) << one.parameter;
    }
}

}  // namespace
}  // namespace twinchute::test
