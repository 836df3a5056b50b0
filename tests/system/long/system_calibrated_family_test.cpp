// The reduced-order model calibrated to three full runs, against five that it has not seen: a minute of one
// core.
#include <fmt/format.h>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

class SystemCalibratedFamily : public ProgramTest {
protected:
    struct Drop {
        const char *mass, *speed;  // [kg, m/s]
    };
    static Words conditions(const Drop& drop) {
        return {"--set", fmt::format("payload.mass={}", drop.mass), "--set",
                fmt::format("release.speed={}", drop.speed)};
    }
    json metrics_of(const std::string& fidelity, const std::string& scene, const Drop& drop,
                    const std::string& out) const {
        const Ended ended = run(Words{fidelity, scene, "--out", out, "--quiet"} + conditions(drop));
        EXPECT_EQ(ended.code, 0) << ended.err;
        return read(out + "/summary.json")["metrics"];
    }
};

// 2 % is what the guide promises. Of the three runs the table meets the answers that it is made from but for
// what powers of the conditions leave over, up to 0.35 %: to 0.5 %. Readings that are weighed one by one
// outvote these answers; they left -1.3 % of the third run's time to the peak, and -2.2 % of one that was not
// seen.
TEST_F(SystemCalibratedFamily, PredictsRunsThatItHasNotSeen) {
    const std::string scene = shipped_scene("c9-inflation");
    const Drop known[] = {{"120", "18"}, {"152.4", "21"}, {"190", "26"}};
    const Drop unseen[] = {{"135", "19.5"}, {"152.4", "24"}, {"170", "22"}, {"180", "20"}, {"140", "25"}};
    Words calibrate{"calibrate", scene, "--out", "family", "--quiet"};
    for (const Drop& drop : known) {
        metrics_of("full", scene, drop, drop.mass);
        calibrate = calibrate + Words{"--to", drop.mass};
    }
    ASSERT_EQ(run(calibrate).code, 0);
    const auto expect_within = [&](const Drop& drop, const json& full, double limit) {
        const json rom = metrics_of("rom", "family/calibrated.toml", drop, "rom");
        for (const char* metric : {"peak_force_N", "time_to_peak_force_s", "descent_rate_m_s"}) {
            const double off = rom[metric].get<double>() / full[metric].get<double>() - 1.0;
            fmt::print("FAMILY|{} kg {} m/s|{}|{:+.2f} %\n", drop.mass, drop.speed, metric, 100.0 * off);
            EXPECT_LT(std::abs(off), limit) << drop.mass << " kg, " << drop.speed << " m/s: " << metric;
        }
    };
    for (const Drop& drop : known)
        expect_within(drop, read(std::string(drop.mass) + "/summary.json")["metrics"], 0.005);
    for (const Drop& drop : unseen)
        expect_within(drop, metrics_of("full", scene, drop, "full"), 0.02);
}

}  // namespace
}  // namespace twinchute::test
