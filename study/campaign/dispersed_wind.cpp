#include "study/campaign/dispersed_wind.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "study/campaign/random.hpp"

namespace twinchute::study {

double GustProcess::step() const {
    return 0.1 * correlation_length.minCoeff();
}

Eigen::Matrix3Xd gusts_of(const GustProcess& process, std::uint64_t seed, double realisation, int levels) {
    const auto index = std::bit_cast<std::uint64_t>(realisation);
    const Eigen::Array3d kept = (-process.step() / process.correlation_length.array()).exp();
    const Eigen::Array3d fresh = process.sd.array() * (1.0 - kept.square()).sqrt();
    Eigen::Matrix3Xd gusts(3, levels);
    for (int level = 0; level < levels; ++level) {
        Eigen::Array3d score;
        for (int c = 0; c < 3; ++c)
            score[c] = gsl_cdf_ugaussian_Pinv(unit_number(
                random_bits(seed, index, static_cast<std::uint32_t>(3 * level + c), RandomStream::gusts)));
        if (level == 0)
            gusts.col(0) = process.sd.array() * score;
        else
            gusts.col(level) = kept * gusts.col(level - 1).array() + fresh * score;
    }
    return gusts;
}

Wind with_gusts(const Wind& wind, const GustProcess& process, std::uint64_t seed, double realisation,
                double ground, double top) {
    const double step = process.step();
    const int levels = static_cast<int>(std::ceil(std::max(0.0, top - ground) / step)) + 1;
    const Eigen::Matrix3Xd gusts = gusts_of(process, seed, realisation, levels);
    Wind gust;
    for (int level = 0; level < levels; ++level)
        gust.levels.push_back({ground + level * step, gusts.col(level)});
    std::vector<double> altitudes;
    for (const WindLevel& level : wind.levels)
        altitudes.push_back(level.altitude);
    for (const WindLevel& level : gust.levels)
        altitudes.push_back(level.altitude);
    std::ranges::sort(altitudes);
    altitudes.erase(std::unique(altitudes.begin(), altitudes.end()), altitudes.end());
    Wind both{{}, wind.table};
    for (const double altitude : altitudes)
        both.levels.push_back({altitude, wind.at(altitude) + gust.at(altitude)});
    return both;
}

}  // namespace twinchute::study
