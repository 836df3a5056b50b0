// Names and look-ups of a record.
#include "lib/record/run_record.hpp"

#include <algorithm>
#include <utility>

#include "lib/record/metrics.hpp"

namespace twinchute {
namespace {

template <typename Row, typename Name>
const Row* find_by(const std::vector<Row>& rows, Name Row::*name, std::string_view wanted) {
    const auto row = std::ranges::find(rows, wanted, name);
    return row == rows.end() ? nullptr : &*row;
}

}  // namespace

std::string_view status_name(StatusCode code) {
    switch (code) {
        case StatusCode::completed:
            return "completed";
        case StatusCode::stopped_by_event:
            return "stopped_by_event";
        case StatusCode::squids:
            return "squids";
        case StatusCode::not_opened:
            return "not_opened";
        case StatusCode::interrupted:
            return "interrupted";
        case StatusCode::refused:
            return "refused";
        case StatusCode::solver_failed:
            return "solver_failed";
        case StatusCode::step_too_small:
            return "step_too_small";
        case StatusCode::not_finite:
            return "not_finite";
        case StatusCode::strain_limit:
            return "strain_limit";
        case StatusCode::energy_grew:
            return "energy_grew";
        case StatusCode::element_inverted:
            return "element_inverted";
        case StatusCode::step_limit:
            return "step_limit";
        case StatusCode::time_limit:
            return "time_limit";
    }
    return "unknown";
}

bool is_numerical_failure(StatusCode code) {
    switch (code) {
        case StatusCode::completed:
        case StatusCode::stopped_by_event:
        case StatusCode::squids:
        case StatusCode::not_opened:
        case StatusCode::interrupted:
        case StatusCode::refused:
            return false;
        case StatusCode::solver_failed:
        case StatusCode::step_too_small:
        case StatusCode::not_finite:
        case StatusCode::strain_limit:
        case StatusCode::energy_grew:
        case StatusCode::element_inverted:
        case StatusCode::step_limit:
        case StatusCode::time_limit:
            return true;
    }
    return true;
}

std::string_view metric_kind_name(MetricKind kind) {
    switch (kind) {
        case MetricKind::input:
            return "input";
        case MetricKind::result:
            return "result";
        case MetricKind::mixed:
            return "mixed";
    }
    return "unknown";
}

std::string_view origin_name(InputOrigin origin) {
    switch (origin) {
        case InputOrigin::given:
            return "given";
        case InputOrigin::design:
            return "design";
        case InputOrigin::scaled:
            return "scaled";
        case InputOrigin::calibrated:
            return "calibrated";
        case InputOrigin::fallback:
            return "default";
    }
    return "unknown";
}

std::optional<double> RunRecord::metric(std::string_view key) const {
    const Metric* found = find_metric(key);
    if (found == nullptr) return {};
    return found->value;
}

const Metric* RunRecord::find_metric(std::string_view key) const {
    return find_by(metrics, &Metric::key, key);
}

const Input* RunRecord::find_input(std::string_view key) const {
    return find_by(inputs, &Input::key, key);
}

const Channel* RunRecord::find_channel(std::string_view name) const {
    return find_by(channels, &Channel::name, name);
}

const Event* RunRecord::find_event(std::string_view name) const {
    return find_by(events, &Event::name, name);
}

std::vector<const MetricRow*> RunRecord::rows_of_metrics() const {
    std::vector<std::string> heads{""};
    for (const Event& event : events)
        if (const auto dot = event.name.find('.'); dot != std::string::npos) {
            std::string head = metric_head(event.name.substr(0, dot));
            if (std::ranges::find(heads, head) == heads.end()) heads.push_back(std::move(head));
        }
    std::vector<const MetricRow*> rows;
    for (const std::string& head : heads)
        for (const MetricRow& row : metric_rows())
            if (const MetricRow* own = find_metric_row(head + std::string(row.name));
                std::ranges::find(rows, own) == rows.end())
                rows.push_back(own);
    return rows;
}

void RunRecord::add_metric(std::string key, double value, MetricKind kind, std::string note) {
    Metric row{std::move(key), value, kind, std::move(note)};
    const auto existing = std::ranges::find(metrics, row.key, &Metric::key);
    if (existing == metrics.end()) {
        metrics.push_back(std::move(row));
    } else {
        *existing = std::move(row);  // said again, with better knowledge
    }
}

}  // namespace twinchute
