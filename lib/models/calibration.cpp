#include "lib/models/calibration.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace twinchute {
namespace {

constexpr std::array<ConditionRow, 3> conditions{{{"payload_mass", "kg", "payload mass"},
                                                  {"airspeed", "m/s", "airspeed at release"},
                                                  {"air_density", "kg/m^3", "air density at release"}}};

constexpr std::array<std::string_view, 6> keys{"fill_time.n",
                                               "drag_area",
                                               "initial_drag_area_ratio",
                                               "drag_area_exponent",
                                               "filling.initial_mouth",
                                               "filling.entrance_loss"};

/// [-] A condition that varies by less is the same in all runs: a rounded speed says nothing of an exponent.
constexpr double same = 1e-3;

/// [-] of the direction in which the runs spread most: along others with less of it differences of the runs
/// are the noise of their fits, which a slope would carry far beyond them.
constexpr double least_spread = 0.2;

}  // namespace

std::span<const ConditionRow, 3> condition_rows() {
    return conditions;
}

std::span<const std::string_view> calibrated_keys() {
    return keys;
}

CalibrationTable::CalibrationTable(std::string file, std::vector<DropConditions> runs,
                                   std::vector<CalibratedFactors> inputs)
    : file_(std::move(file)), runs_(std::move(runs)), inputs_(std::move(inputs)) {
    assert(!runs_.empty());
    const auto count = static_cast<Eigen::Index>(runs_.size());
    Eigen::MatrixXd x(count, 3);
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index k = 0; k < 3; ++k)
            x(i, k) = std::log(runs_[static_cast<std::size_t>(i)].values()[static_cast<std::size_t>(k)]);
    const Eigen::RowVector3d centre = x.colwise().mean();
    for (Eigen::Index k = 0; k < 3; ++k) {
        const auto condition = static_cast<std::size_t>(k);
        lowest_[condition] = std::exp(x.col(k).minCoeff());
        highest_[condition] = std::exp(x.col(k).maxCoeff());
        centre_[condition] = centre(k);
        const bool varies = x.col(k).maxCoeff() - x.col(k).minCoeff() > same;
        x.col(k).array() -= varies ? centre(k) : 0.0;
        if (!varies) x.col(k).setZero();
    }
    Eigen::JacobiSVD<Eigen::MatrixXd> flattest(x, Eigen::ComputeThinU | Eigen::ComputeThinV);
    flattest.setThreshold(least_spread);
    for (const CalibratedFactors& input : inputs_) {
        assert(input.factor.size() == runs_.size());
        Eigen::VectorXd y = Eigen::Map<const Eigen::ArrayXd>(input.factor.data(), count).log();
        const double mean = y.mean();
        y.array() -= mean;
        const Eigen::Vector3d exponent = flattest.solve(y);
        powers_.push_back({mean, {exponent(0), exponent(1), exponent(2)}});
        scatter_.push_back((y - x * exponent).norm() / std::sqrt(static_cast<double>(count)));
    }
}

double CalibrationTable::factor(std::size_t input, const DropConditions& at) const {
    const Powers& powers = powers_[input];
    double logarithm = powers.at_centre;
    for (std::size_t k = 0; k < 3; ++k)
        logarithm +=
            powers.exponent[k] * (std::log(std::clamp(at.values()[k], lowest_[k], highest_[k])) - centre_[k]);
    return std::exp(logarithm);
}

}  // namespace twinchute
