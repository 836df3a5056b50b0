// Winds of a campaign: one of an ensemble of soundings, and gusts that are correlated over altitude.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "lib/models/wind.hpp"

namespace twinchute::study {

/// Gusts of a run: of each component (east, north, up) a stationary Gaussian process over altitude whose
/// correlation falls as exp(-|dz|/length), the first-order autoregression of the Dryden form's longitudinal
/// component; the components are independent. Frozen: a run falls through them.
struct GustProcess {
    Vec3 sd = Vec3::Zero();                       ///< [m/s]
    Vec3 correlation_length = Vec3::Constant(1);  ///< [m]

    /// [m] between levels, between which a gust is a straight line: a tenth of the shortest length.
    double step() const;
};

/// The gusts on `levels` levels, step() apart, from the lowest up: a column each. A function of the seed and
/// of `realisation`, any number; more levels have the same gusts below.
Eigen::Matrix3Xd gusts_of(const GustProcess& process, std::uint64_t seed, double realisation, int levels);

/// The wind with gusts from `ground` to `top` [m], on the levels of both.
Wind with_gusts(const Wind& wind, const GustProcess& process, std::uint64_t seed, double realisation,
                double ground, double top);

}  // namespace twinchute::study
