#include "lib/models/cylinder_drag.hpp"

#include <algorithm>
#include <cmath>

namespace twinchute {
namespace {

struct Point {
    double reynolds, drag_coefficient;
};

// Wieselsberger 1922 (NACA TN 84, NTRS 19930080855), one transcription.
constexpr std::array<Point, 35> measured{{
    {0.116, 54.1},   {0.241, 30.5},   {0.728, 13.2},   {3.18, 4.87},    {8.01, 2.94},    {17.7, 2.12},
    {31.7, 1.73},    {63.6, 1.48},    {196, 1.27},     {356, 1.15},     {892, 0.964},    {2270, 0.886},
    {5150, 0.944},   {9180, 1.06},    {15000, 1.14},   {30300, 1.16},   {65500, 1.17},   {107000, 1.17},
    {161000, 1.18},  {176000, 1.17},  {220000, 1.06},  {256000, 0.985}, {293000, 0.91},  {329000, 0.827},
    {365000, 0.726}, {391000, 0.649}, {427000, 0.547}, {456000, 0.454}, {490000, 0.337}, {503000, 0.302},
    {563000, 0.309}, {628000, 0.318}, {683000, 0.328}, {735000, 0.34},  {810000, 0.355},
}};

}  // namespace

double cylinder_drag_coefficient(double reynolds) {
    if (reynolds >= measured.back().reynolds) return measured.back().drag_coefficient;
    auto right = std::ranges::upper_bound(measured, reynolds, {}, &Point::reynolds);
    if (right == measured.begin()) ++right;
    const Point& a = *(right - 1);
    const Point& b = *right;
    const double exponent =
        std::log(b.drag_coefficient / a.drag_coefficient) / std::log(b.reynolds / a.reynolds);
    return a.drag_coefficient * std::pow(reynolds / a.reynolds, exponent);
}

CylinderDragTable::CylinderDragTable() {
    for (std::size_t cell = 0; cell < cell_.size(); ++cell) {
        const double left = std::bit_cast<double>((cell + static_cast<std::uint64_t>(first_cell)) << 48);
        const double right = std::bit_cast<double>((cell + static_cast<std::uint64_t>(first_cell) + 1) << 48);
        const double value = cylinder_drag_coefficient(left);
        cell_[cell] = {value, (cylinder_drag_coefficient(right) - value) / (right - left)};
    }
    at_lowest_ = cell_.front().value;
}

}  // namespace twinchute
