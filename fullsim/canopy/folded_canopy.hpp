// How a flat canopy is folded before it opens: a narrow cone whose mouth has a given area.
#pragma once

#include "lib/math/vec.hpp"
#include "lib/models/material.hpp"

namespace twinchute::fullsim {

/// The folded canopy as seen from its apex: a fan of rays, one per column line, each as long as its
/// line of the cut pattern. Coordinates: z along the axis toward the payload, x and y across.
///
/// With an even number of columns it is pleated like an umbrella: every second ray, the seams among
/// them, lies on an inner cone, the others on an outer one, at such angles that no panel is strained.
/// An odd number leaves no such pleats: all rays lie on one cone, and the excess fabric around it hangs
/// in folds finer than the mesh, which a tension field carries for nothing.
class FoldedCanopy {
public:
    /// seam_angle: between seams and axis [rad]; 0 is closed, pi/2 lies flat. stretch: along the rays [-].
    FoldedCanopy(int gores, int columns, double seam_angle, double stretch);

    int columns() const { return columns_; }
    /// The point of column line `column` (0 is the seam) at unit seam length.
    Vec3 point(int gore, int column) const;
    /// Where a point of the flat canopy goes: `radius` [m] from the apex, `azimuth` in [0, 2 pi) from the
    /// first seam. Linear between rays, so that no distance grows.
    Vec3 folded(double radius, double azimuth) const;
    /// Area that the ring of all column lines encloses across the axis, at unit seam length.
    double mouth() const;

    /// Length of a column line of the cut pattern over that of the seam: columns are equal angles.
    static double column_length(int gores, int columns, int column);

private:
    int gores_, columns_;
    double stretch_, inner_, outer_;
};

/// The canopy whose mouth at unit seam length has the wanted area: by bisection, the mouth opens
/// with the seam angle.
FoldedCanopy canopy_with_mouth(int gores, int columns, double mouth, double stretch);

/// Stretch of the rays [-]: 1 for a pleated canopy, whose seams are straight. Without pleats
/// the fabric of a column is as long in its middle as along its edges, but was cut shorter there,
/// by cos(delta/columns): the middle comes taut first and carries the load at the skirt.
/// skirt_radius [m]; load [N].
double folded_stretch(int gores, int columns, double skirt_radius, const Fabric& fabric, double load);

/// Seam length [m] at which a vent of one element across a gore starts so that its fabric hangs loose.
/// Folding shortens that element. The triangle below it would have to be longer for that, were
/// the seams not slack by a few millimetres: so far that its height is that of the cut.
/// vent, foot: middle of that element at unit seam length, and of the edge below it [m]; height [m] of the
/// cut between them.
double loose_vent_radius(const Vec3& vent, const Vec3& foot, double height);

}  // namespace twinchute::fullsim
