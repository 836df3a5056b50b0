#include "tests/bench/work/opening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "fullsim/fidelity.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/read_scene.hpp"

namespace twinchute::bench {
namespace {

constexpr std::array members{&Opening::peak, &Opening::peak_time, &Opening::filling};

double metric(const RunRecord& record, const char* key) {
    const auto value = record.metric(key);
    if (!value) throw std::runtime_error(fmt::format("a run of {} has no {}", record.scene.name, key));
    return *value;
}

double element_steps(const Sample& s) {
    return s.more.front();
}

}  // namespace

Measured run_opening(const Scene& scene) {
    Run run;
    const RunRecord record = fullsim::full_fidelity().run(scene, run);
    // From the pack a canopy of elements may go through itself, and has no descent or has not opened then;
    // its peak is what that costs.
    if (record.status.code != StatusCode::completed && record.status.code != StatusCode::not_opened &&
        record.status.code != StatusCode::stopped_by_event)
        throw std::runtime_error(
            fmt::format("{}: {}", status_name(record.status.code), record.status.detail));
    const double diameter =
        scene.parachutes.front().nominal_diameter * metric(record, "projected_diameter_ratio");
    return {{metric(record, "peak_force_N"), metric(record, "time_to_peak_force_s"),
             metric(record, "filling_time_s")},
            record.cost.steps,
            static_cast<double>(record.cost.element_steps),
            record.cost.wall_s,
            0.25 * pi * diameter * diameter};
}

std::array<double, 3> errors_of(const Opening& found, const Opening& truth) {
    std::array<double, 3> errors{};
    for (std::size_t i = 0; i < members.size(); ++i)
        errors[i] = std::abs(found.*members[i] / truth.*members[i] - 1.0);
    return errors;
}

Opening range_of(const std::vector<Opening>& all) {
    Opening range;
    for (const auto member : members) {
        const auto [low, high] = std::ranges::minmax(all, {}, member);
        range.*member = high.*member - low.*member;
    }
    return range;
}

Opening median_of(std::vector<Opening> all) {
    Opening median;
    for (const auto member : members) {
        std::ranges::sort(all, {}, member);
        const std::size_t half = all.size() / 2;
        median.*member = 0.5 * (all[half].*member + all[all.size() - 1 - half].*member);
    }
    return median;
}

Sample sample_of(const std::string& setting, const Measured& run, const Opening& truth) {
    const auto [peak, time, filling] = errors_of(run.opening, truth);
    return {setting,
            run.evaluations,
            run.seconds,
            peak,
            time,
            {run.element_steps, filling, run.opening.peak, run.opening.peak_time, run.opening.filling}};
}

void say(const Curve& curve) {
    const Sample& s = curve.samples.back();
    fmt::print(
        "{}, {} at {}: {:.3g} s, {:.3g} element-steps; {:.2f} N off by {:.1e}, its time {:.1e}, "
        "filling time {:.1e}\n",
        curve.family, curve.method, s.setting, s.seconds, s.more[0], s.more[2], s.error, s.other_error,
        s.more[1]);
    std::fflush(stdout);
}

void say(const char* what, const Measured& run) {
    fmt::print("{}: {:.2f} N at {:.5f} s, filled at {:.5f} s; {} evaluations, {:.3g} s\n", what,
               run.opening.peak, run.opening.peak_time, run.opening.filling, run.evaluations, run.seconds);
    std::fflush(stdout);
}

Opening micrometre_apart(Scene scene) {
    std::vector<Opening> all{run_opening(scene).opening};
    for (const std::uint64_t seed : {1, 2, 3}) {
        scene.full.noise = Noise{1e-6, seed};
        all.push_back(run_opening(scene).opening);
    }
    return range_of(all);
}

Study opening_study(std::string name, std::string title, std::string subtitle, const std::string& floor_word,
                    const Opening& floor, const Opening& about) {
    Study study{std::move(name), std::move(title), std::move(subtitle), "peak force", {}};
    study.more = {"element_steps", "filling_error", "peak_force_N", "time_to_peak_force_s", "filling_time_s"};
    const auto level = [&](double Opening::*member) {
        return std::vector<Level>{{floor_word, floor.*member / about.*member}};
    };
    constexpr const char* seconds = "wall time [s]";
    constexpr const char* work = "elements evaluated, of all steps [-]";
    constexpr const char* peak = "relative error of the peak force [-]";
    study.views = {
        {"", seconds, peak, [](const Sample& s) { return s.seconds; },
         [](const Sample& s) { return s.error; }, level(&Opening::peak)},
        {"-work", work, peak, element_steps, [](const Sample& s) { return s.error; }, level(&Opening::peak)},
        {"-time", work, "relative error of the time of the peak force [-]", element_steps,
         [](const Sample& s) { return s.other_error; }, level(&Opening::peak_time)},
        {"-filling", work, "relative error of the filling time [-]", element_steps,
         [](const Sample& s) { return s.more[1]; }, level(&Opening::filling)}};
    return study;
}

void study_openings(const std::filesystem::path& directory, bool quick) {
    Scene demo = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml");
    // Full open at 1.8 s, and the two seconds over which the steady area is a mean.
    demo.stop = {Trigger::Kind::time, 4.0, 0.0};
    if (quick) {
        demo.full.mesh = {1, 3, 2, 1};
        study_opening_in_time(demo, {"opening-quick-time", {0.95, 0.475}, {1e-4}, 1e-5, 3, 3}, directory);
        study_opening_by_mesh(demo, {"opening-quick-mesh", {1, 1.5}, {1}, {2}, 2}, directory);
    } else {
        study_opening_in_time(demo, {"opening-time", {0.95, 0.475, 0.2375, 0.11875}, {1e-4, 1e-5}, 1e-6},
                              directory);
        study_opening_by_mesh(demo, {"opening-mesh", {0.5, 1, 1.5, 2}, {0.5, 1, 1.5, 2, 3}, {6, 8, 12}, 4},
                              directory);
    }
    study_opening_from_pack(directory, quick);
}

}  // namespace twinchute::bench
