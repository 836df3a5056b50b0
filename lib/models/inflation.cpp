#include "lib/models/inflation.hpp"

#include <cmath>
#include <limits>

namespace twinchute {

double Inflation::end_of(Phase phase) const {
    switch (phase) {
        case Phase::initial:
            return snatch + initial_time;
        case Phase::filling:
            return snatch + filling_time;
        case Phase::overshoot:
            return snatch + initial_time + growth().end() * (filling_time - initial_time);
        case Phase::open:
            break;
    }
    return std::numeric_limits<double>::infinity();
}

double Inflation::next_kink() const {
    if (table == nullptr) return std::numeric_limits<double>::infinity();
    const double x = table->kink_after(piece);
    // At full open to the bit where the phase ends.
    return x == 1.0 ? end_of(Phase::filling) : snatch + initial_time + x * (filling_time - initial_time);
}

Phase Inflation::after(Phase phase) const {
    switch (phase) {
        case Phase::initial:
            return Phase::filling;
        case Phase::filling:
            return growth().end() > 1.0 ? Phase::overshoot : Phase::open;
        case Phase::overshoot:
        case Phase::open:
            break;
    }
    return Phase::open;
}

Phase Inflation::phase_at(double time) const {
    Phase phase = Phase::initial;
    while (phase != Phase::open && time >= end_of(phase))
        phase = after(phase);
    return phase;
}

ValueAndRate Inflation::drag_area_ratio(Phase phase, double time) const {
    switch (phase) {
        case Phase::initial:
            return {eta * eta, 0.0};
        case Phase::filling:
        case Phase::overshoot: {
            const double duration = filling_time - initial_time;
            const ValueAndRate ratio = growth().at((time - snatch - initial_time) / duration, piece);
            return {ratio.value, ratio.rate / duration};
        }
        case Phase::open:
            break;
    }
    return {1.0, 0.0};
}

ValueAndRate Inflation::ramp(Phase phase, double time) const {
    if (phase == Phase::open || phase == Phase::overshoot) return {1.0, 0.0};
    const double rest = 1.0 - ramp_start;
    return {ramp_start + rest * ((time - snatch) / filling_time), rest / filling_time};
}

ValueAndRate Inflation::added_mass(const AddedMassSpec& spec, Phase phase, double time, double rho,
                                   double steady_radius, double porosity) const {
    const ValueAndRate ratio = drag_area_ratio(phase, time);
    const double root = std::sqrt(share * ratio.value);
    // Where the canopy starts from nothing no law gives its volume, R^3, a finite rate but zero.
    const double root_rate = root > 0.0 ? 0.5 * share * ratio.rate / root : 0.0;
    return spec.mass(rho, {steady_radius * root, steady_radius * root_rate}, ramp(phase, time), porosity);
}

void serialize(Archive& archive, Inflation& inflation, const DragAreaLaw* law, const DragAreaTable* table) {
    archive.row("inflation", inflation, [](Inflation& of, auto&& each) {
        auto& [snatch, initial_time, filling_time, steady_drag_area, eta, its_law, share, ramp_start,
               its_table, its_piece, exponent] = of;
        static_cast<void>(its_law), static_cast<void>(its_table);  // rows of tables, the parachute's own
        static_cast<void>(its_piece);
        for (double* x :
             {&snatch, &initial_time, &filling_time, &steady_drag_area, &eta, &share, &ramp_start, &exponent})
            each(*x);
    });
    bool has_law = inflation.law != nullptr, has_table = inflation.table != nullptr;
    archive.flag("has law", has_law);
    archive.flag("has table", has_table);
    inflation.law = has_law ? law : nullptr;
    inflation.table = has_table ? table : nullptr;
    archive.whole("piece", inflation.piece, 0, inflation.table ? inflation.table->pieces() - 1 : 0);
}

}  // namespace twinchute
