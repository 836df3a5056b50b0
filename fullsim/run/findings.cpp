#include "fullsim/run/findings.hpp"

namespace twinchute::fullsim {
namespace {

void serialize_window(Archive& archive, std::optional<DescentWindow>& window) {
    bool is_there = window.has_value();
    archive.flag("window", is_there);
    if (!is_there) return window.reset();
    if (archive.reads()) window.emplace();
    auto& [from, to, rate, amplitude, drift, remaining, breathing, filling, breath, turns] = *window;
    for (double* x : {&from, &to, &rate, &amplitude, &drift, &remaining, &breathing, &filling, &breath[0],
                      &breath[1], &turns})
        archive.number("window", *x);
}

}  // namespace

void Findings::serialize(Archive& archive) {
    for (double* x : {&snatch, &snatch_speed, &snatch_path_angle, &payload_snatch_speed, &snatch_density})
        archive.number("snatch", *x);
    for (std::optional<double>* x : {&line_stretch_time, &descent_altitude, &landing_time, &met_payload})
        archive.number("event", *x);
    for (std::optional<DescentWindow>* window : {&descent, &last_window})
        serialize_window(archive, *window);
    archive.flag("switched late", switched_late);
    archive.length("stages", stages, 1000);
    for (ParachuteResult::Stage& stage : stages) {
        auto& [begin, full, peak_force, peak_time] = stage;
        archive.number("begin", begin);
        archive.number("full", full);
        archive.number("peak force", peak_force);
        archive.number("peak time", peak_time);
    }
}

}  // namespace twinchute::fullsim
