// Campaigns as large as they get on one machine: memory that does not grow, time that grows with the runs
// alone.
#include <sys/resource.h>

#include <chrono>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

class SystemLargeCampaign : public ProgramTest {
protected:
    struct Cost {
        double seconds = 0.0;
        double megabytes = 0.0;  ///< most that any child process of this test has had so far
    };
    Cost cost_of(long runs) const {
        std::ofstream(here_ / "c.toml")
            << "base = \"c9-inflation.toml\"\nset = ['stop.at=\"peak-force\"']\n[campaign]\nruns = " << runs
            << "\ndesign = \"sobol\"\n[[vary]]\nkey = \"parachute.fill_time.n\"\ndist = { normal = { mean = "
               "4, sd "
               "= 0.4 } }\n[[vary]]\nkey = \"release.speed\"\ndist = { normal = { mean = 21, sd = 0.7 } }\n"
               "[[answer]]\nname = \"p\"\nquantile = \"peak_force\"\nlevel = \"99.9 %\"\n";
        const auto start = std::chrono::steady_clock::now();
        EXPECT_EQ(run({"campaign", "c.toml", "--out", "out", "--quiet"}).code, 0);
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        std::filesystem::remove_all(here_ / "out");
        rusage usage{};
        ::getrusage(RUSAGE_CHILDREN, &usage);
        return {seconds, static_cast<double>(usage.ru_maxrss) / 1024.0};
    }
};

TEST_F(SystemLargeCampaign, TenMillionRunsTakeTheMemoryOfAFewAndTimeInProportion) {
    cost_of(10'000);
    const Cost some = cost_of(1'000'000), many = cost_of(10'000'000);
    EXPECT_LT(many.megabytes, 300.0);
    EXPECT_LT(many.seconds, 15.0 * some.seconds);
}

}  // namespace
}  // namespace twinchute::test
