// The membrane: one triangle of fabric (paper, 2.2). A template over the scalar type: a number, four elements
// in Lanes, or as many as the processor takes at once. For the last it is compiled anew for every instruction
// set, hence this guard, which Highway turns over from one to the next, and the namespace.
#if defined(TWINCHUTE_LAWS_MEMBRANE) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_MEMBRANE
#undef TWINCHUTE_LAWS_MEMBRANE
#else
#define TWINCHUTE_LAWS_MEMBRANE
#endif

#include <hwy/highway.h>

#include "fullsim/forces/membrane.hpp"
#include "lib/math/lanes.hpp"
#include "lib/math/vec.hpp"

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

/// Along the principal directions of strain, which are those of stress, too.
template <class T>
struct Principals {
    T first, second;
};

/// The images of the unstrained plane's unit vectors: the deformation gradient by columns.
template <class T3>
struct DeformationGradient {
    T3 f1, f2;
};

/// A triangle by the edges from corner 0 to 1 and 2, the unstrained one by 1/a, 1/c [1/m] and b/a [-]. Of the
/// edges' velocities likewise: the gradient's rate.
template <class T, class T3>
HWY_INLINE DeformationGradient<T3> deformation_gradient(T inverse_a, T inverse_c, T b_over_a, T3 e1, T3 e2) {
    return {inverse_a * e1, inverse_c * (e2 - b_over_a * e1)};
}

template <class T3>
HWY_INLINE auto green_strain(const DeformationGradient<T3>& f) {
    using T = decltype(dot(f.f1, f.f2));
    return SymmetricTensor<T>{0.5 * (dot(f.f1, f.f1) - 1.0), 0.5 * (dot(f.f2, f.f2) - 1.0),
                              0.5 * dot(f.f1, f.f2)};
}

/// Stress resultants [N/m] of the relaxed energy. With E_1 >= E_2: taut where E_2 + nu E_1 > 0, slack where
/// E_1 <= 0, wrinkled between, and all three are
///
///     N_2 = E t/(1 - nu^2) <E_2 + nu E_1>,   N_1 = E t <E_1> + nu N_2,   <a> = max(a, 0).
template <class T>
HWY_INLINE Principals<T> relaxed_stress(const MembraneLaw& law, const PrincipalStrain<T>& p) {
    const T zero = p.mean - p.mean;
    const T second = law.plane_modulus * larger(p.second() + law.poisson * p.first(), zero);
    return {law.tension_modulus * larger(p.first(), zero) + law.poisson * second, second};
}

/// From principal values to the plane's own axes.
template <class T>
HWY_INLINE SymmetricTensor<T> turned_back(const Principals<T>& n, T cosine, T sine) {
    const T mean = 0.5 * (n.first + n.second), half = 0.5 * (n.first - n.second);
    return {mean + half * cosine, mean - half * cosine, half * sine};
}

/// Relaxed energy per reference area [J/m^2], of which that stress is the derivative.
template <class T>
HWY_INLINE T relaxed_energy(const MembraneLaw& law, const PrincipalStrain<T>& p) {
    const T first = p.first(), second = p.second(), zero = like(first, 0.0);
    const T taut =
        0.5 * law.plane_modulus * (first * first + second * second + 2.0 * law.poisson * (first * second));
    const T wrinkled = 0.5 * law.tension_modulus * (first * first);
    return select(first <= zero, zero, select(second + law.poisson * first <= zero, wrinkled, taut));
}

/// Stress per eta [1/s] of bulk viscosity that acts where the fabric carries load: on the trace of the strain
/// rate where taut, along the tension field where wrinkled, not at all where slack. `along`: rate in the
/// first direction.
template <class T>
HWY_INLINE Principals<T> viscous_stress(const MembraneLaw& law, const PrincipalStrain<T>& p, T trace,
                                        T along) {
    const T zero = p.mean - p.mean;
    const auto taut = p.second() + law.poisson * p.first() > zero;
    return {select(p.first() > zero, select(taut, trace, along), zero), select(taut, trace, zero)};
}

/// Forces of a triangle on its corners.
template <class T, class T3>
struct CornerPulls {
    T3 on_first, on_second, on_third;  // [N]: on_first is added to corner 0, the others are taken from theirs
    T stress;                          // [N/m] first principal resultant, elastic, at full stiffness
    T dissipated;                      // [W]
};

/// A triangle from its edges and their velocities: e1, e2 from corner 0 to 1 and 2, w1, w2 alike. The
/// unstrained triangle by 1/a, 1/c and b/a; area [m^2] times the share of its stiffness that it has;
/// viscosity [N s/m].
template <class T, class T3>
HWY_INLINE CornerPulls<T, T3> membrane_pulls(const MembraneLaw& law, T inverse_a, T inverse_c, T b_over_a,
                                             T area, T viscosity, T3 e1, T3 e2, T3 w1, T3 w2) {
    const auto [f1, f2] = deformation_gradient(inverse_a, inverse_c, b_over_a, e1, e2);
    const auto [r1, r2] = deformation_gradient(inverse_a, inverse_c, b_over_a, w1, w2);
    const SymmetricTensor<T> strain = green_strain(DeformationGradient<T3>{f1, f2});
    const SymmetricTensor<T> rate{dot(f1, r1), dot(f2, r2), 0.5 * (dot(f1, r2) + dot(f2, r1))};
    const auto p = principal(strain);
    const T cosine = p.half_difference * p.inverse_radius, sine = strain.xy * p.inverse_radius;
    const T trace = rate.xx + rate.yy;
    const T along = 0.5 * (trace + cosine * (rate.xx - rate.yy)) + sine * rate.xy;
    const auto elastic = relaxed_stress(law, p);
    const auto viscous = viscous_stress(law, p, trace, along);
    const auto n = turned_back<T>(
        {elastic.first + viscosity * viscous.first, elastic.second + viscosity * viscous.second}, cosine,
        sine);
    // First Piola-Kirchhoff stress times reference area, then the edges' shares of it.
    const T3 p1 = (area * n.xx) * f1 + (area * n.xy) * f2;
    const T3 p2 = (area * n.xy) * f1 + (area * n.yy) * f2;
    const T3 s2 = inverse_c * p2;
    const T3 s1 = inverse_a * p1 - b_over_a * s2;
    return {s1 + s2, s1, s2, elastic.first,
            area * viscosity * (viscous.first * along + viscous.second * (trace - along))};
}

/// Row sums of a stretched triangle over those of the unstrained one.
template <class T>
struct MembraneStiffening {
    T stiffness, damping;  // [-]
};

/// St. Venant-Kirchhoff fabric stiffens with its largest principal strain E_1: by lambda^2 and by the stress
/// itself, 1 + 3 E_1; its viscosity acts on longer edges, 1 + 2 E_1. For the critical time step.
template <class T>
HWY_INLINE MembraneStiffening<T> membrane_stiffening(const SymmetricTensor<T>& strain) {
    const T first = principal(strain).first(), stretch = larger(first, like(first, 0.0));
    return {1.0 + 3.0 * stretch, 1.0 + 2.0 * stretch};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
