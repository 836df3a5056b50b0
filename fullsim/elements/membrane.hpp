// Loops over triangles of fabric: membranes, the pressure on them, and drag. Each stands once and works on
// any view of elements that a storage provides:
//
//   view     first(), last(), part(p)      gore-batched: a block of gores; otherwise one part
//            all(a), all3(a), Flow         constants; how e_r is written
//   part     size(), element(k)            the elements that lie side by side at k
//            live(sum)                     without lanes that pad
//   element  out parameters and constants by name; live(a, otherwise): otherwise where a lane pads
//
// Included once for every instruction set (see fullsim/laws/membrane.hpp for the guard).
#if defined(TWINCHUTE_ELEMENTS_MEMBRANE) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_ELEMENTS_MEMBRANE
#undef TWINCHUTE_ELEMENTS_MEMBRANE
#else
#define TWINCHUTE_ELEMENTS_MEMBRANE
#endif

#include "fullsim/elements/passes.hpp"
#include "fullsim/laws/membrane.hpp"
#include "fullsim/laws/pressure.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// Elastic and viscous forces of membranes, the areas that pressure acts on, or both: the strain's edges give
/// the area.
template <bool structure, AirOnFabric air, class View>
HWY_INLINE ElementSums membrane_forces(const View& view, const MembranePass& pass) {
    using T = typename View::T;
    using T3 = typename View::T3;
    const typename View::Flow e = view.flow(pass.direction);
    const T zero = View::all(0.0), third = View::all(1.0 / 3.0),
            radial = View::all(pass.radial_pressure / 3.0);
    T positive = zero, signed_area = zero, dissipated = zero, largest = zero, swept = zero;
    T3 areas = View::all3({});
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        T part_positive = zero, part_area = zero, part_dissipated = zero, part_largest = zero;
        T part_swept = zero;
        T3 part_areas = View::all3({});
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto triangle = part.element(k);
            T3 e1, e2, w1, w2;
            triangle.edges(e1, e2, w1, w2);
            if constexpr (structure) {
                const auto pulls =
                    membrane_pulls(pass.law, triangle.inverse_a(), triangle.inverse_c(), triangle.b_over_a(),
                                   triangle.weighted_area(pass.weight), triangle.viscosity(), e1, e2, w1, w2);
                part_dissipated += pulls.dissipated;
                part_largest = larger(pulls.stress, part_largest);
                triangle.pull(pulls.on_first, pulls.on_second, pulls.on_third);
            }
            if constexpr (air == AirOnFabric::fills) {
                const T3 area = triangle.half() * cross(e1, e2);
                part_positive += larger(area_along(area, e), zero);
                part_areas += area;
                part_swept += dot(area, triangle.first_velocity() + third * (w1 + w2));
                triangle.add_push(third * area);
            } else if constexpr (air == AirOnFabric::pushes) {
                // The pressure itself follows once the projected area is known.
                const auto pushed = pushed_area(triangle.half() * cross(e1, e2), e, third, radial);
                part_positive += pushed.projected;
                part_area += pushed.along;
                triangle.add_push(pushed.on_corner);
            }
        }
        positive += part.live(part_positive);
        signed_area += part.live(part_area);
        swept += part.live(part_swept);
        areas += T3{part.live(part_areas.x), part.live(part_areas.y), part.live(part_areas.z)};
        dissipated += part.live(part_dissipated);
        largest = larger(part.live_load(part_largest), largest);
    }
    const double lost = sum(dissipated);
    return {sum(positive),
            sum(signed_area),
            lost,
            nan_greatest(largest, lost),
            {sum(areas.x), sum(areas.y), sum(areas.z)},
            sum(swept)};
}

/// Energy of membranes and their largest strain, at full stiffness whatever the pass says.
template <class View>
HWY_INLINE EnergyAndStrain membrane_levels(const View& view, const MembranePass& pass) {
    using T = typename View::T;
    using T3 = typename View::T3;
    T energy = View::all(0.0), strain = energy;
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto triangle = part.element(k);
            T3 e1, e2;
            triangle.edges(e1, e2);
            const auto principals = principal(green_strain(deformation_gradient(
                triangle.inverse_a(), triangle.inverse_c(), triangle.b_over_a(), e1, e2)));
            energy += triangle.live(triangle.weighted_area(1.0) * relaxed_energy(pass.law, principals), 0.0);
            // In this order, here and elsewhere: a strain that is not a number must not hide the others.
            strain = larger(triangle.live(principals.first(), 0.0), strain);
        }
    }
    return {sum(energy), greatest(strain)};
}

/// Row sums of stiffness and damping for the critical time step.
template <class View>
HWY_INLINE void membrane_rows(const View& view) {
    using T3 = typename View::T3;
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto triangle = part.element(k);
            T3 e1, e2;
            triangle.edges(e1, e2);
            triangle.add_rows(membrane_stiffening(green_strain(deformation_gradient(
                triangle.inverse_a(), triangle.inverse_c(), triangle.b_over_a(), e1, e2))));
        }
    }
}

/// Drag of fabric until the canopy fills; `positive_area` is the area that the air meets.
template <class View>
HWY_INLINE ElementSums fabric_drag_forces(const View& view, const FabricDragPass& pass) {
    using T = typename View::T;
    using T3 = typename View::T3;
    const T3 wind = View::all3(pass.wind);
    const T zero = View::all(0.0), share = View::all(pass.factor / 3.0);
    T across = zero;
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        T part_across = zero;
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto triangle = part.element(k);
            T3 e1, e2, mean;
            triangle.edges_and_mean_velocity(e1, e2, mean);
            const auto drag = fabric_drag(0.5 * cross(e1, e2), wind - mean, share);
            part_across += drag.across;
            triangle.add_drag(drag.on_corner);
        }
        across += part.live(part_across);
    }
    return {sum(across)};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
