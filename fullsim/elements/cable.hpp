// Loops over cables: lines, risers, tapes, and the drag of lines (see membrane.hpp for views and the guard).
#if defined(TWINCHUTE_ELEMENTS_CABLE) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_ELEMENTS_CABLE
#undef TWINCHUTE_ELEMENTS_CABLE
#else
#define TWINCHUTE_ELEMENTS_CABLE
#endif

#include "fullsim/elements/passes.hpp"
#include "fullsim/laws/cable.hpp"
#include "fullsim/laws/cylinder_drag.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// Tension, drag, or both: half of what either does is to find the same nodes. A part may be a chain, in
/// which each cable begins where the one before ends: it takes the elements in their order and `finish` hands
/// over the nodes that are done.
template <bool pulls, bool drags, class View>
HWY_INLINE ElementSums cable_forces(const View& view, const CylinderDrag* cylinder,
                                    const std::array<double, 3>& wind_velocity) {
    using T = typename View::T;
    using T3 = typename View::T3;
    const T zero = View::all(0.0);
    const T3 wind = View::all3(wind_velocity);
    T dissipated = zero, largest = zero;
    for (int p = view.first(); p < view.last(); ++p) {
        auto part = view.part(p);
        T part_dissipated = zero, part_largest = zero;
        for (std::size_t k = 0; k < part.size(); ++k) {
            auto cable = part.element(k);
            T3 d, w;
            cable.ends(d, w);
            if constexpr (pulls) {
                const auto pull =
                    cable_pull(cable.inverse_length(), cable.stiffness(), cable.dashpot(), d, w);
                part_dissipated += pull.dissipated;
                part_largest = larger(cable.counted(pull.spring), part_largest);
                cable.pull_together(pull.force);
            }
            if constexpr (drags) cable.add_drag(cylinder->on_end(d, wind - cable.mean_velocity(w)));
            part.finish(k);
        }
        part.close();
        dissipated += part.live(part_dissipated);
        largest = larger(part.live_load(part_largest), largest);
    }
    const double lost = sum(dissipated);
    return {0.0, 0.0, lost, nan_greatest(largest, lost)};
}

template <class View>
HWY_INLINE ElementSums cable_forces(const View& view) {
    return cable_forces<true, false>(view, nullptr, {});
}

template <bool pulls, class View>
HWY_INLINE ElementSums cable_forces_in(const View& view, const LineAir& air) {
    const CylinderDrag cylinder(*air.coefficient, air.diameter, air.density, air.viscosity);
    return cable_forces<pulls, true>(view, &cylinder, air.wind);
}

template <class View>
HWY_INLINE EnergyAndStrain cable_levels(const View& view) {
    using T = typename View::T;
    T energy = View::all(0.0), largest = View::all(-1.0);
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto cable = part.element(k);
            const T strain = span_strain(cable.inverse_length(), cable.distance());
            energy += cable.stiffness_times_length() * cable_energy(cable.live(strain, 0.0));
            largest = larger(cable.live(strain, -1.0), largest);
        }
    }
    return {sum(energy), greatest(largest)};
}

/// Row sums of all cables: slack ones may pull tight any time.
template <class View>
HWY_INLINE void cable_rows(const View& view) {
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto cable = part.element(k);
            cable.add_rows(cable.stiffness() * cable.inverse_length(), cable.dashpot());
        }
    }
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
