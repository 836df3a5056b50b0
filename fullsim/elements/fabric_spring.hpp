// Loops over the edges of fabric as springs, and as folds (see membrane.hpp for views and the guard).
#if defined(TWINCHUTE_ELEMENTS_FABRIC_SPRING) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_ELEMENTS_FABRIC_SPRING
#undef TWINCHUTE_ELEMENTS_FABRIC_SPRING
#else
#define TWINCHUTE_ELEMENTS_FABRIC_SPRING
#endif

#include "fullsim/elements/passes.hpp"
#include "fullsim/laws/fabric_spring.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// Springs, folds, or both: they need the same lengths.
template <bool with_springs, bool with_folds, class View>
HWY_INLINE ElementSums spring_forces_of(const View& view, const SpringPass& pass) {
    using T = typename View::T;
    using T3 = typename View::T3;
    const T zero = View::all(0.0);
    T dissipated = zero;
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        T part_dissipated = zero;
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto edge = part.element(k);
            T3 d, w;
            edge.ends(d, w);
            const auto span = span_of(d, w);
            const T strain = span.strain(edge.inverse_length());
            T tension = zero;
            if constexpr (with_springs) {
                const auto spring = spring_tension(span, strain, edge.stiffness(), edge.hardening(),
                                                   edge.dashpot(), pass.repulsion);
                tension = spring.tension;
                part_dissipated += spring.dissipated;
            }
            if constexpr (with_folds) {
                const auto fold = fold_tension(span, strain, edge.fold_force());
                tension += fold.tension;
                part_dissipated += fold.dissipated;
            }
            edge.pull_together((tension * span.inverse) * span.d);
        }
        dissipated += part.live(part_dissipated);
    }
    ElementSums sums;
    sums.dissipated = sum(dissipated);
    return sums;
}

template <class View>
HWY_INLINE ElementSums spring_forces(const View& view, const SpringPass& pass) {
    if (pass.springs && pass.folds) return spring_forces_of<true, true>(view, pass);
    return pass.springs ? spring_forces_of<true, false>(view, pass)
                        : spring_forces_of<false, true>(view, pass);
}

/// Without folds, which hold no energy.
template <class View>
HWY_INLINE EnergyAndStrain spring_levels(const View& view, const SpringPass& pass) {
    using T = typename View::T;
    T energy = View::all(0.0), largest = View::all(-1.0);
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto edge = part.element(k);
            const T strain = span_strain(edge.inverse_length(), edge.distance());
            energy += edge.stiffness_times_length() *
                      spring_energy(edge.live(strain, 0.0), edge.hardening(), pass.repulsion);
            largest = larger(edge.live(strain, -1.0), largest);
        }
    }
    return {sum(energy), greatest(largest)};
}

template <class View>
HWY_INLINE void spring_rows(const View& view, const SpringPass& pass) {
    using T = typename View::T;
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto edge = part.element(k);
            T stiffness = View::all(0.0), damping = stiffness;
            if (pass.springs && pass.folded) {
                stiffness = pass.repulsion * (edge.stiffness() * edge.inverse_length());
            } else if (pass.springs) {
                const T strain = span_strain(edge.inverse_length(), edge.distance());
                stiffness =
                    edge.stiffness() * edge.inverse_length() * spring_tangent(strain, edge.hardening());
                damping = edge.dashpot();
            }
            if (pass.folds) damping += (1.0 / full_fold_speed) * edge.fold_force();
            edge.add_rows(stiffness, damping);
        }
    }
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
