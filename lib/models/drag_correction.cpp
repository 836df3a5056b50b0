#include "lib/models/drag_correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lib/math/interpolation.hpp"

namespace twinchute {
namespace {

/// Straight between readings; the nearer end beyond them.
DragFactor read_off(const std::vector<double>& at, const std::vector<double>& read, double x) {
    const double held = std::clamp(x, at.front(), at.back());
    return {Between(at, held).linear(read), held == x};
}

// Knacke, Fig. 5-20: own readings of the symbols, +-0.004; every curve goes through 1 at 1 by definition.
DragFactor flat_circular(double ratio) {  // D0 = 28 ft, free flight
    static const std::vector<double> at{0.62, 1.0, 1.2, 1.4}, read{0.895, 1.0, 1.053, 1.085};
    return read_off(at, read, ratio);
}

DragFactor extended_skirt(
    double ratio) {  // D0 = 11 ft, free flight: the mean of two canopies, 0.01 to 0.04 apart
    static const std::vector<double> at{0.585, 1.0, 1.4}, read{0.8175, 1.0, 1.0155};
    return read_off(at, read, ratio);
}

DragFactor ribbon(double ratio) {  // D0 = 3.1 ft, free flight
    static const std::vector<double> at{0.56, 1.0, 1.8}, read{0.879, 1.0, 1.095};
    return read_off(at, read, ratio);
}

DragFactor hemispherical(double ratio) {  // D0 = 3.1 ft, free flight
    static const std::vector<double> at{0.57, 1.0, 1.25}, read{0.822, 1.0, 1.004};
    return read_off(at, read, ratio);
}

constexpr std::array<LineRatioModel, 4> line_ratios{{
    {"flat-circular", "Knacke NWC TP 6575, Fig. 5-20, 28 ft in free flight", "0.62 to 1.4", flat_circular},
    {"extended-skirt", "Knacke NWC TP 6575, Fig. 5-20, 11 ft in free flight", "0.585 to 1.4", extended_skirt},
    {"ribbon", "Knacke NWC TP 6575, Fig. 5-20, 3.1 ft in free flight", "0.56 to 1.8", ribbon},
    {"hemispherical", "Knacke NWC TP 6575, Fig. 5-20, 3.1 ft in free flight", "0.57 to 1.25", hemispherical},
}};

/// A few points of each curve of Knacke's Fig. 5-21 as stanford-ssi/rockets-irec digitised it, straight
/// between them over the logarithm of the distance.
DragFactor behind_equal(double trailing) {  // D_p/D_B = 1
    static const std::vector<double> at{std::log(1.0639), std::log(1.485),  std::log(2.1256),
                                        std::log(3.1485), std::log(5.0223), std::log(8.1305),
                                        std::log(12.175), std::log(17.86)};
    static const std::vector<double> read{0.314, 0.500, 0.610, 0.713, 0.800, 0.863, 0.908, 0.949};
    return read_off(at, read, std::log(trailing));
}

DragFactor behind_third(double trailing) {  // D_p/D_B = 3
    static const std::vector<double> at{std::log(1.1549), std::log(3.1757), std::log(6.6632),
                                        std::log(10.22),  std::log(16.212), std::log(21.915)};
    static const std::vector<double> read{0.867, 0.891, 0.921, 0.942, 0.964, 0.978};
    return read_off(at, read, std::log(trailing));
}

/// The figure has two curves; between them over the logarithm of the diameter, our assumption.
DragFactor knacke_wake(double trailing, double diameter) {
    const DragFactor narrow = behind_equal(trailing), wide = behind_third(trailing);
    const double share = std::clamp(std::log(diameter) / std::log(3.0), 0.0, 1.0);
    const bool between = diameter >= 1.0 && diameter <= 3.0;
    return {narrow.value + share * (wide.value - narrow.value),
            between && (share == 1.0 || narrow.inside) && (share == 0.0 || wide.inside)};
}

constexpr std::array<ForebodyWakeModel, 1> wakes{{
    {"knacke", "Knacke NWC TP 6575, Fig. 5-21, by one digitisation",
     "D_p/D_B from 1 to 3, the skirt 1.15 to 17.9 body diameters behind", knacke_wake},
}};

}  // namespace

std::span<const LineRatioModel> line_ratio_models() {
    return line_ratios;
}

const LineRatioModel* find_line_ratio(std::string_view name) {
    const auto row = std::ranges::find(line_ratios, name, &LineRatioModel::name);
    return row == line_ratios.end() ? nullptr : &*row;
}

std::span<const ForebodyWakeModel> forebody_wake_models() {
    return wakes;
}

const ForebodyWakeModel* find_forebody_wake(std::string_view name) {
    const auto row = std::ranges::find(wakes, name, &ForebodyWakeModel::name);
    return row == wakes.end() ? nullptr : &*row;
}

}  // namespace twinchute
