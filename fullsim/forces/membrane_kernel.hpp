// The membrane's arithmetic, written once for a scalar or for four elements in lanes.
#pragma once

#include "fullsim/forces/membrane.hpp"

namespace twinchute::fullsim {

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
PrincipalStrain<T> principal(const SymmetricTensor<T>& strain) {
    PrincipalStrain<T> p;
    p.mean = 0.5 * (strain.xx + strain.yy);
    p.half_difference = 0.5 * (strain.xx - strain.yy);
    p.radius = square_root(p.half_difference * p.half_difference + strain.xy * strain.xy);
    // Only used where the strains differ; the addend keeps equal ones from dividing by zero.
    p.inverse_radius = 1.0 / (p.radius + 1e-300);
    return p;
}

/// Stress resultant [N/m] of the relaxed energy: taut, wrinkled or slack in one selection.
template <class T>
SymmetricTensor<T> relaxed_stress(const MembraneLaw& law, const SymmetricTensor<T>& e,
                                  const PrincipalStrain<T>& p) {
    const T zero = p.mean - p.mean;
    const auto taut = p.second() + law.poisson * p.first() > zero;
    const auto slack = p.first() <= zero;
    const T field = law.tension_modulus * 0.5 * p.first();
    const T field_difference = field * p.half_difference * p.inverse_radius;
    const T field_shear = field * e.xy * p.inverse_radius;
    SymmetricTensor<T> n;
    n.xx = slack ? zero : taut ? law.plane_modulus * (e.xx + law.poisson * e.yy) : field + field_difference;
    n.yy = slack ? zero : taut ? law.plane_modulus * (e.yy + law.poisson * e.xx) : field - field_difference;
    n.xy = slack ? zero : taut ? law.plane_modulus * (1.0 - law.poisson) * e.xy : field_shear;
    return n;
}

/// Stress per eta [1/s] of bulk viscosity that acts where the fabric carries load: on the trace
/// of the strain rate where taut, along the tension field where wrinkled, not at all where slack.
template <class T>
SymmetricTensor<T> viscous_stress(const MembraneLaw& law, const SymmetricTensor<T>& e,
                                  const PrincipalStrain<T>& p, const SymmetricTensor<T>& rate) {
    const T zero = p.mean - p.mean;
    const auto taut = p.second() + law.poisson * p.first() > zero;
    const auto slack = p.first() <= zero;
    const T trace = rate.xx + rate.yy;
    const T cosine = p.half_difference * p.inverse_radius, sine = e.xy * p.inverse_radius;
    const T along = 0.5 * (trace + cosine * (rate.xx - rate.yy)) + sine * rate.xy;
    SymmetricTensor<T> n;
    n.xx = slack ? zero : taut ? trace : 0.5 * along * (1.0 + cosine);
    n.yy = slack ? zero : taut ? trace : 0.5 * along * (1.0 - cosine);
    n.xy = slack || taut ? zero : 0.5 * along * sine;
    return n;
}

}  // namespace twinchute::fullsim
