// Drag area of a body by how it lies in the air.
#pragma once

#include <string>
#include <vector>

namespace twinchute {

/// C_D S between points of a table, linear in the angle: a measurement says nothing of its curvature.
class AttitudeDrag {
public:
    /// `angle` [rad] rises from 0, where the air goes past the body along its axis, from foot to head, to pi,
    /// or to pi/2, beyond which the body is its mirror image; `area` [m^2]. `file`: as a scene names it.
    AttitudeDrag(std::string file, std::vector<double> angle, std::vector<double> area);

    /// [m^2] at any angle in [0, pi] [rad].
    double drag_area(double angle) const;

    const std::string& file() const { return file_; }
    const std::vector<double>& angle() const { return angle_; }
    const std::vector<double>& area() const { return area_; }

    bool operator==(const AttitudeDrag&) const = default;

private:
    std::string file_;
    std::vector<double> angle_, area_;
};

}  // namespace twinchute
