// The membrane's arithmetic, written once: for a scalar, for four elements in Lanes, and for as many as the
// processor takes at once. For the last it is compiled anew for every instruction set, hence this guard, which
// Highway turns over from one to the next, and the namespace.
#if defined(TWINCHUTE_MEMBRANE_KERNEL) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_MEMBRANE_KERNEL
#undef TWINCHUTE_MEMBRANE_KERNEL
#else
#define TWINCHUTE_MEMBRANE_KERNEL
#endif

#include <hwy/highway.h>

#include "fullsim/forces/membrane.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

template <class T>
struct SymmetricTensor {
    T xx, yy, xy;
};

/// Principal directions are never formed: with m the mean and r the radius of Mohr's circle,
/// n1 n1^T = 1/2 (1 + (strain - m 1)/r).
template <class T>
struct PrincipalStrain {
    T mean, half_difference, radius, inverse_radius;
    T first() const { return mean + radius; }
    T second() const { return mean - radius; }
};

template <class T>
HWY_INLINE PrincipalStrain<T> principal(const SymmetricTensor<T>& strain) {
    PrincipalStrain<T> p;
    p.mean = 0.5 * (strain.xx + strain.yy);
    p.half_difference = 0.5 * (strain.xx - strain.yy);
    // The inverse is only used where the strains differ; the addend keeps equal ones from dividing by zero.
    const T square = p.half_difference * p.half_difference + strain.xy * strain.xy;
    p.inverse_radius = inverse_root(square + 1e-300);
    p.radius = square * p.inverse_radius;
    return p;
}

/// Stress resultant [N/m] of the relaxed energy: taut, wrinkled or slack in one selection.
template <class T>
HWY_INLINE SymmetricTensor<T> relaxed_stress(const MembraneLaw& law, const SymmetricTensor<T>& e,
                                  const PrincipalStrain<T>& p) {
    const T zero = p.mean - p.mean;
    const auto taut = p.second() + law.poisson * p.first() > zero;
    const auto slack = p.first() <= zero;
    const T field = law.tension_modulus * 0.5 * p.first();
    const T field_difference = field * p.half_difference * p.inverse_radius;
    const T field_shear = field * e.xy * p.inverse_radius;
    SymmetricTensor<T> n;
    const T taut_xx = law.plane_modulus * (e.xx + law.poisson * e.yy);
    const T taut_yy = law.plane_modulus * (e.yy + law.poisson * e.xx);
    const T taut_xy = law.plane_modulus * (1.0 - law.poisson) * e.xy;
    n.xx = select(slack, zero, select(taut, taut_xx, field + field_difference));
    n.yy = select(slack, zero, select(taut, taut_yy, field - field_difference));
    n.xy = select(slack, zero, select(taut, taut_xy, field_shear));
    return n;
}

/// Stress per eta [1/s] of bulk viscosity that acts where the fabric carries load: on the trace
/// of the strain rate where taut, along the tension field where wrinkled, not at all where slack.
template <class T>
HWY_INLINE SymmetricTensor<T> viscous_stress(const MembraneLaw& law, const SymmetricTensor<T>& e,
                                  const PrincipalStrain<T>& p, const SymmetricTensor<T>& rate) {
    const T zero = p.mean - p.mean;
    const auto taut = p.second() + law.poisson * p.first() > zero;
    const auto slack = p.first() <= zero;
    const T trace = rate.xx + rate.yy;
    const T cosine = p.half_difference * p.inverse_radius, sine = e.xy * p.inverse_radius;
    const T along = 0.5 * (trace + cosine * (rate.xx - rate.yy)) + sine * rate.xy;
    SymmetricTensor<T> n;
    n.xx = select(slack, zero, select(taut, trace, 0.5 * along * (1.0 + cosine)));
    n.yy = select(slack, zero, select(taut, trace, 0.5 * along * (1.0 - cosine)));
    n.xy = select(slack, zero, select(taut, zero, 0.5 * along * sine));
    return n;
}

/// What a triangle does to its corners.
template <class T, class T3>
struct CornerPulls {
    T3 on_first, on_second, on_third;  // [N]: on_first is added to corner 0, the others are taken from theirs
    T dissipated;                      // [W]
};

/// A triangle from its edges and their velocities: e1, e2 from corner 0 to 1 and 2, w1, w2 alike. The unstrained
/// triangle by 1/a, 1/c and b/a; area [m^2] times the share of its stiffness that it has; viscosity [N s/m].
template <class T, class T3>
HWY_INLINE CornerPulls<T, T3> membrane_pulls(const MembraneLaw& law, T inverse_a, T inverse_c, T b_over_a, T area,
                                  T viscosity, T3 e1, T3 e2, T3 w1, T3 w2) {
    // Deformation gradient by columns: f1, f2 are the images of the plane's unit vectors.
    const T3 f1 = inverse_a * e1;
    const T3 f2 = inverse_c * (e2 - b_over_a * e1);
    const T3 r1 = inverse_a * w1;
    const T3 r2 = inverse_c * (w2 - b_over_a * w1);
    const SymmetricTensor<T> strain{0.5 * (dot(f1, f1) - 1.0), 0.5 * (dot(f2, f2) - 1.0), 0.5 * dot(f1, f2)};
    const SymmetricTensor<T> rate{dot(f1, r1), dot(f2, r2), 0.5 * (dot(f1, r2) + dot(f2, r1))};
    const auto p = principal(strain);
    const auto elastic = relaxed_stress(law, strain, p);
    const auto viscous = viscous_stress(law, strain, p, rate);
    const T nxx = elastic.xx + viscosity * viscous.xx;
    const T nyy = elastic.yy + viscosity * viscous.yy;
    const T nxy = elastic.xy + viscosity * viscous.xy;
    // First Piola-Kirchhoff stress times reference area, then the edges' shares of it.
    const T3 p1 = area * (nxx * f1 + nxy * f2);
    const T3 p2 = area * (nxy * f1 + nyy * f2);
    const T3 s2 = inverse_c * p2;
    const T3 s1 = inverse_a * p1 - b_over_a * s2;
    return {s1 + s2, s1, s2,
            area * viscosity * (viscous.xx * rate.xx + viscous.yy * rate.yy + 2.0 * viscous.xy * rate.xy)};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
