#include "fullsim/time/energy.hpp"

#include <algorithm>
#include <cmath>

namespace twinchute::fullsim {

double static_line_kinetic_energy(const State& state, const NodeConstants& c) {
    double twice = 0.0;
    for (std::size_t k = 0; k < c.static_line_mass.size(); ++k) {
        const Lanes v = state.node[c.first_static_line() + k].v;
        twice += c.static_line_mass[k] * sum3(v * v);
    }
    return 0.5 * twice;
}

double kinetic_energy(const State& state, const NodeConstants& c) {
    double twice = 0.0;
    for (std::size_t i = 0; i < c.mass.size(); ++i) {
        const Lanes v = state.node[i].v;
        twice += (c.mass[i] + c.share[i] * state.added_mass) * sum3(v * v);
    }
    return 0.5 * twice + static_line_kinetic_energy(state, c);
}

double elastic_energy(const State& state, const ForceModels& structure) {
    double total = 0.0;
    for (const auto& block : structure)
        total += block->energy(state);
    return total;
}

double book_scale(EnergyBook& book) {
    // At rest nothing has changed hands yet, and what does not add up is rounding.
    constexpr double energy_of_rounding = 1e-6;  // [J] more than elements at rest have from rounded positions
    const double now = energy_of_rounding + book.kinetic_start + book.elastic_start +
                       std::abs(book.gravity_work) + std::abs(book.drag_work) + std::abs(book.external_work);
    book.changed_hands = std::max(book.changed_hands, now);
    return book.changed_hands;
}

void start_anew(State& state) {
    EnergyBook& book = state.energy;
    const double half = 0.5 * state.dt;
    book.gravity_work += half * book.gravity_power;
    book.drag_work += half * book.drag_power;
    book.damping += half * book.damping_power;
    book.external_work += half * book.external_power;
    book.air_loss += half * book.air_loss_power;
    state.dt = state.line_dt = 0.0;
    for (std::size_t i = 0; i < state.node.size(); ++i)
        state.v_half[i].value = state.node[i].v;
    if (state.body) state.body->half_momentum = state.body->momentum;
}

double residual(const EnergyLedger& e) {
    return e.kinetic + e.elastic -
           (e.gravity_work + e.drag_work - e.damping + e.added_mass + e.ramp + e.external_work);
}

namespace {

/// half: [s] from the middle of the last kick, up to which works are booked, to the time of the balance.
EnergyLedger balance(const EnergyBook& book, double half, double kinetic, double elastic) {
    EnergyLedger ledger;
    ledger.kinetic = kinetic - book.kinetic_start;
    ledger.elastic = elastic - book.elastic_start;
    ledger.gravity_work = book.gravity_work + half * book.gravity_power;
    ledger.drag_work = book.drag_work + half * book.drag_power;
    ledger.damping = book.damping + half * book.damping_power;
    ledger.added_mass = book.added_mass;
    ledger.ramp = book.ramp;
    ledger.external_work = book.external_work + half * book.external_power;
    ledger.air_loss = book.air_loss + half * book.air_loss_power;
    const double scale = std::abs(ledger.drag_work);
    ledger.residual_fraction = scale > 0.0 ? residual(ledger) / scale : 0.0;
    return ledger;
}

}  // namespace

EnergyLedger energy_ledger(const State& state, double kinetic, double elastic) {
    return balance(state.energy, 0.5 * state.dt, kinetic, elastic);
}

EnergyLedger ledger_before(const State& state, double elastic, double turning, double added_mass) {
    EnergyBook book = state.energy;
    book.added_mass = added_mass;
    return balance(book, -0.5 * state.dt, book.kinetic + turning, elastic);
}

}  // namespace twinchute::fullsim
