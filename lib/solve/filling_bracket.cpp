#include "lib/solve/filling_bracket.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "lib/solve/opening.hpp"

namespace twinchute {

void add_filling_bracket(RunRecord& record, const Scene& scene, double density,
                         const std::function<RunRecord(const Scene&)>& run_again) {
    const auto predicted =
        std::ranges::find_if(scene.parachutes, [](const Parachute& p) { return p.filling.is_predicted(); });
    if (predicted == scene.parachutes.end()) return;
    const Filling& filling = predicted->filling;
    record.filling = {std::string(filling.model->name),
                      filling.initial_mouth,
                      filling.entrance_loss,
                      filling_canopy(*predicted).critical_speed(density),
                      {}};
    // A scene that stops before its canopy is open asks for no filling time, and neither do longer runs.
    const StatusCode code = record.status.code;
    if ((code == StatusCode::completed || code == StatusCode::stopped_by_event) &&
        std::ranges::none_of(record.events, [](const Event& e) { return e.name.ends_with("full-open"); }))
        return;
    std::vector<RunRecord> ends;
    for (const double mouth : {filling.lowest_mouth, filling.highest_mouth}) {
        Scene other = scene;
        for (Parachute& p : other.parachutes)
            p.filling.initial_mouth = mouth;
        const RunRecord& at = ends.emplace_back(mouth == filling.initial_mouth ? record : run_again(other));
        record.filling->bracket.push_back({mouth, std::string(status_name(at.status.code)),
                                           at.metric("filling_time_s"), at.metric("fill_constant"),
                                           at.metric("peak_force_N")});
    }
    // No filling time that is predicted stands without its bracket, of whichever parachute or stage it is.
    const auto text = [](const std::optional<double>& value) {
        return value ? fmt::format("{:.3g} s", *value) : std::string("no opening");
    };
    for (Metric& time : record.metrics) {
        if (!time.key.ends_with("filling_time_s") || time.kind != MetricKind::result) continue;
        time.note += fmt::format("{}{} from the lowest mouth, {:g}, {} from the highest, {:g}",
                                 time.note.empty() ? "" : "; ", text(ends[0].metric(time.key)),
                                 filling.lowest_mouth, text(ends[1].metric(time.key)), filling.highest_mouth);
    }
}

}  // namespace twinchute
