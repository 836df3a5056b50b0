// The full model by way of the reduced one, held against the full model alone: half an hour of one core.
#include <fmt/format.h>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

class SystemExceedance : public ProgramTest {
protected:
    json answer_of(const std::string& plan, const std::string& out) const {
        std::ofstream(here_ / "c.toml")
            << "base = \"c9-inflation.toml\"\nset = ['stop.at=\"peak-force\"']\n[campaign]\nseed = 8\n"
            << plan
            << "\n[[vary]]\nkey = \"parachute.fill_time.n\"\ndist = { lognormal = { mean = 4, sd = 0.4 } }\n"
               "[[vary]]\nkey = \"payload.mass\"\ndist = { normal = { mean = 140, sd = 10 } }\n"
               "[[answer]]\nname = \"high\"\nprobability = \"peak_force > 5.2 kN\"\n";
        const Ended ended = run({"campaign", "c.toml", "--out", out, "--quiet"});
        EXPECT_EQ(ended.code, 0) << ended.err;
        const json all = read(out + "/campaign.json");
        return all.contains("both") ? all["both"]["answers"][0] : all["answers"][0];
    }
};

// About one run in seventeen is above. Sixty full runs know as much of that as two thousand: the estimate
// lies in their interval, and its own is narrower.
TEST_F(SystemExceedance, OfSixtyPairsIsThatOfTwoThousandFullRuns) {
    const json pairs = answer_of("runs = 100000\nfidelity = \"both\"\nfull_runs = 60", "both"),
               full = answer_of("runs = 2000\nfidelity = \"full\"", "full");
    fmt::print("EXCEEDANCE|both {} {}|full {} {}\n", pairs["estimate"].dump(), pairs["interval_95"].dump(),
               full["estimate"].dump(), full["interval_95"].dump());
    const auto end = [](const json& answer, int i) { return answer["interval_95"][i].get<double>(); };
    EXPECT_GE(pairs["estimate"], end(full, 0));
    EXPECT_LE(pairs["estimate"], end(full, 1));
    EXPECT_LT(end(pairs, 1) - end(pairs, 0), end(full, 1) - end(full, 0));
}

}  // namespace
}  // namespace twinchute::test
