// Two records, compared to the last bit.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "lib/record/run_record.hpp"

namespace twinchute::test {

/// Collects the names of what differs.
class RecordDifference {
public:
    RecordDifference(const RunRecord& a, const RunRecord& b) {
        all("scene", a.scene, b.scene, &SceneId::name, &SceneId::file, &SceneId::sha256);
        rows("inputs", a.inputs, b.inputs, &Input::key, &Input::value, &Input::unit, &Input::origin,
             &Input::source);
        one("fidelity", a.fidelity, b.fidelity);
        all("status", a.status, b.status, &RunStatus::code, &RunStatus::detail);
        rows("metrics", a.metrics, b.metrics, &Metric::key, &Metric::value, &Metric::kind, &Metric::note);
        rows("missing", a.missing, b.missing, &MissingMetric::metric, &MissingMetric::why,
             &MissingMetric::not_reached);
        one("energy", a.energy.has_value(), b.energy.has_value());
        if (a.energy && b.energy)
            all("energy", *a.energy, *b.energy, &EnergyLedger::kinetic, &EnergyLedger::elastic,
                &EnergyLedger::gravity_work, &EnergyLedger::drag_work, &EnergyLedger::damping,
                &EnergyLedger::added_mass, &EnergyLedger::residual_fraction, &EnergyLedger::ramp,
                &EnergyLedger::external_work);
        all("cost", a.cost, b.cost, &Cost::wall_s, &Cost::cpu_s, &Cost::steps, &Cost::rhs_calls,
            &Cost::rejected_steps, &Cost::dt_min_s, &Cost::dt_max_s, &Cost::element_steps,
            &Cost::ns_per_element_step);
        one("resumed", a.cost.resumed_at, b.cost.resumed_at);
        one("handed over", a.handed_over.has_value(), b.handed_over.has_value());
        if (a.handed_over && b.handed_over)
            all("handed over", *a.handed_over, *b.handed_over, &HandOver::to, &HandOver::time,
                &HandOver::metrics);
        one("filling", a.filling.has_value(), b.filling.has_value());
        if (a.filling && b.filling) {
            all("filling", *a.filling, *b.filling, &PredictedFilling::model, &PredictedFilling::initial_mouth,
                &PredictedFilling::entrance_loss, &PredictedFilling::critical_speed);
            rows("bracket", a.filling->bracket, b.filling->bracket, &PredictedFilling::At::initial_mouth,
                 &PredictedFilling::At::status, &PredictedFilling::At::filling_time,
                 &PredictedFilling::At::fill_constant, &PredictedFilling::At::peak_force);
        }
        rows("blocks", a.cost.blocks, b.cost.blocks, &BlockCost::name, &BlockCost::seconds);
        rows("estimates", a.estimates, b.estimates, &Estimate::name, &Estimate::title, &Estimate::metric,
             &Estimate::value, &Estimate::source, &Estimate::outside);
        rows("warnings", a.warnings, b.warnings, &Warning::what, &Warning::why, &Warning::suggestion);
        rows("left out", a.left_out, b.left_out, &LeftOut::what, &LeftOut::why);
        all("provenance", a.provenance, b.provenance, &Provenance::version, &Provenance::commit,
            &Provenance::compiler, &Provenance::flags, &Provenance::instruction_set, &Provenance::host_cpu,
            &Provenance::date, &Provenance::threads);
        rows("channels", a.channels, b.channels, &Channel::name, &Channel::unit, &Channel::values);
        rows("events", a.events, b.events, &Event::name, &Event::time, &Event::altitude, &Event::speed);
    }

    const std::string& text() const { return text_; }

private:
    template <typename Value>
    static bool same(const Value& a, const Value& b) {
        if constexpr (std::is_same_v<Value, double>) {
            return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
                   (std::isnan(a) && std::isnan(b));
        } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
            if (a.size() != b.size()) return false;
            for (std::size_t i = 0; i < a.size(); ++i)
                if (!same(a[i], b[i])) return false;
            return true;
        } else if constexpr (std::is_same_v<Value, std::variant<double, std::string>>) {
            const auto *x = std::get_if<double>(&a), *y = std::get_if<double>(&b);
            return x && y ? same(*x, *y) : a == b;
        } else {
            return a == b;
        }
    }
    template <typename Value>
    void one(const std::string& what, const Value& a, const Value& b) {
        if (!same(a, b)) text_ += what + " differs\n";
    }
    template <typename Row, typename... Members>
    void all(const std::string& what, const Row& a, const Row& b, Members... members) {
        int index = 0;
        (one(what + ", member " + std::to_string(index++), a.*members, b.*members), ...);
    }
    template <typename Row, typename... Members>
    void rows(const std::string& what, const std::vector<Row>& a, const std::vector<Row>& b,
              Members... members) {
        one(what + ": how many", a.size(), b.size());
        for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
            all(what + " " + std::to_string(i), a[i], b[i], members...);
    }

    std::string text_;
};

/// Empty when the two are the same to the last bit (a NaN is a NaN), else what differs, a line each.
inline std::string record_difference(const RunRecord& a, const RunRecord& b) {
    return RecordDifference(a, b).text();
}

}  // namespace twinchute::test
