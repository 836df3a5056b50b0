// Calibration of a model to a family of runs: factors on inputs of an opening, found at some conditions of
// the drop, and powers of those conditions between them.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

/// Conditions of a drop that its calibration may depend on, SI.
struct DropConditions {
    double payload_mass = 0.0;  ///< [kg]
    double airspeed = 0.0;      ///< [m/s] at release
    double density = 0.0;       ///< [kg/m^3] of the air at release

    std::array<double, 3> values() const { return {payload_mass, airspeed, density}; }
    bool operator==(const DropConditions&) const = default;
};

/// A condition as a column of a table and in messages.
struct ConditionRow {
    std::string_view column, unit, title;
};
std::span<const ConditionRow, 3> condition_rows();

/// Inputs that may have a factor: their keys below those of a parachute, which are columns of a table, too.
std::span<const std::string_view> calibrated_keys();

/// Factors of one input, one for each run of the family.
struct CalibratedFactors {
    std::string key;  ///< of calibrated_keys()
    std::vector<double> factor;
    bool operator==(const CalibratedFactors&) const = default;
};

/// Between its runs each factor is a product of powers of the conditions: least squares of the logarithms,
/// flat where the runs leave it open. Beyond the range of its runs the nearest conditions within it
/// are taken. An assumption of this toolkit: no physics says that factors are powers.
class CalibrationTable {
public:
    /// `file`: as a scene names it. One run or more, all numbers above 0; as many factors of each input.
    CalibrationTable(std::string file, std::vector<DropConditions> runs,
                     std::vector<CalibratedFactors> inputs);

    /// [-] on an input of inputs(), by its number, at some conditions.
    double factor(std::size_t input, const DropConditions& at) const;
    /// [-] Root mean square by which the factors of its runs are off the powers, of an input by its number.
    double scatter(std::size_t input) const { return scatter_[input]; }

    const std::string& file() const { return file_; }
    const std::vector<DropConditions>& runs() const { return runs_; }
    const std::vector<CalibratedFactors>& inputs() const { return inputs_; }
    /// Lowest and highest of a condition, by its number, among the runs.
    std::pair<double, double> range(std::size_t condition) const {
        return {lowest_[condition], highest_[condition]};
    }
    bool operator==(const CalibrationTable& other) const {
        return file_ == other.file_ && runs_ == other.runs_ && inputs_ == other.inputs_;
    }

private:
    struct Powers {
        double at_centre = 0.0;  // logarithm of the factor
        std::array<double, 3> exponent{};
    };
    std::string file_;
    std::vector<DropConditions> runs_;
    std::vector<CalibratedFactors> inputs_;
    std::array<double, 3> lowest_{}, highest_{}, centre_{};  // the last of the logarithms
    std::vector<Powers> powers_;
    std::vector<double> scatter_;
};

}  // namespace twinchute
