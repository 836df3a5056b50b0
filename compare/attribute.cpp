#include "compare/attribute.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "compare/histories.hpp"
#include "compare/physics_effects.hpp"
#include "compare/runs_at_once.hpp"
#include "compare/snatch_state.hpp"

namespace twinchute::compare {
namespace {

/// From line stretch on, times and places count from there: what a packed run has before.
struct Before {
    double time = 0.0;  ///< [s]
    Vec3 way = Vec3::Zero();
};

/// A metric that counts from release.
struct FromRelease {
    std::string_view metric;
    double (*before)(const Before&);
};
constexpr std::array from_release{
    FromRelease{"flight_time", [](const Before& b) { return b.time; }},
    FromRelease{"altitude_loss", [](const Before& b) { return -b.way.z(); }},
    FromRelease{"landing_east", [](const Before& b) { return b.way.x(); }},
    FromRelease{"landing_north", [](const Before& b) { return b.way.y(); }},
};

/// One model's answer.
struct Answer {
    const RunRecord* record = nullptr;
    Before before = {};
    bool own_shape = true;  ///< otherwise the filling time is that of the prescribed drag area

    bool ended() const { return exit_code(record->status.code) == ExitCode::done; }
};

/// Both models' answers to one scene.
struct Pair {
    Answer reference, candidate;
};

std::optional<double> prescribed_filling_time(const RunRecord& record) {
    const Event* open = record.find_event("full-open");
    if (open == nullptr) return {};
    return open->time - snatch_of(record);
}

std::optional<double> value_of(const Answer& answer, const MetricRow& row) {
    if (!answer.ended()) return {};
    if (!answer.own_shape && row.name == "filling_time") return prescribed_filling_time(*answer.record);
    std::optional<double> value = answer.record->metric(row.key);
    if (!value || !std::isfinite(*value)) return {};
    if (row.name == "drift") {
        const double east = answer.record->metric("landing_east_m").value_or(0.0),
                     north = answer.record->metric("landing_north_m").value_or(0.0);
        return std::hypot(east + answer.before.way.x(), north + answer.before.way.y());
    }
    const auto counts = std::ranges::find(from_release, row.name, &FromRelease::metric);
    return counts == from_release.end() ? *value : *value + counts->before(answer.before);
}

/// Reference less candidate.
std::optional<double> gap_of(const Pair& pair, const MetricRow& row) {
    const auto reference = value_of(pair.reference, row), candidate = value_of(pair.candidate, row);
    if (!reference || !candidate) return {};
    return *reference - *candidate;
}

std::optional<double> less(const std::optional<double>& a, const std::optional<double>& b) {
    if (!a || !b) return {};
    return *a - *b;
}

/// Jobs, and where their records will be.
class Agenda {
public:
    /// The number of its record.
    std::size_t add(const Fidelity& fidelity, Scene scene) {
        scene.full.fields_rate.reset();  // nobody looks at them here
        jobs_.push_back({&fidelity, std::move(scene)});
        return jobs_.size() - 1;
    }
    void run(const AttributionOptions& options) {
        records_ = run_jobs(jobs_, options.threads, options.stop, options.progress);
    }
    const RunRecord& record(std::size_t number) const { return records_[number]; }

private:
    std::vector<RunJob> jobs_;
    std::vector<RunRecord> records_;
};

/// A scene that both models are sent to run.
struct JobPair {
    std::size_t reference = 0, candidate = 0;
};

class Study {
public:
    Study(const Comparison& comparison, const Scene& scene, const Fidelity& reference,
          const Fidelity& candidate, const AttributionOptions& options)
        : comparison_(comparison),
          scene_(scene),
          reference_(reference),
          candidate_(candidate),
          options_(options),
          packed_(scene.parachutes.front().deploy.starts_packed()) {}

    Attribution run() {
        if (!both_ended()) return std::move(attribution_);
        if (packed_ && !find_snatches()) return std::move(attribution_);
        const Scene flat = packed_ ? from_snatch(scene_, reference_snatch_) : scene_;
        send_effects(flat);
        if (packed_) send_starts(flat);
        send_seeds();
        agenda_.run(options_);
        if (options_.stop.stop_requested()) {
            note("the runs with effects switched were interrupted: no part of the gap is attributed");
            return std::move(attribution_);
        }
        collect();
        for (const MetricGap& metric : comparison_.gap.metrics)
            if (metric.tolerance && metric.reference && metric.candidate) attribute_metric(metric);
        return std::move(attribution_);
    }

private:
    struct Switched {
        const PhysicsEffect* effect;
        JobPair jobs;
        Pair pair = {};
    };

    void note(std::string text) { attribution_.notes.push_back(std::move(text)); }

    bool both_ended() {
        for (const RunRecord* side : {&comparison_.candidate, &comparison_.reference}) {
            if (exit_code(side->status.code) == ExitCode::done) continue;
            note(fmt::format("{} ended as {}: there is no gap to attribute", side->fidelity,
                             status_name(side->status.code)));
            return false;
        }
        return true;
    }

    bool find_snatches() {
        const auto reference = snatch_state(comparison_.reference, scene_.release);
        const auto candidate = snatch_state(comparison_.candidate, scene_.release);
        if (!reference || !candidate) {
            note(fmt::format("{} never came to snatch: no effect can be switched",
                             reference ? comparison_.candidate.fidelity : comparison_.reference.fidelity));
            return false;
        }
        reference_snatch_ = *reference;
        candidate_snatch_ = *candidate;
        return true;
    }

    JobPair send(const Scene& scene) {
        return {agenda_.add(reference_, scene), agenda_.add(candidate_, scene)};
    }

    /// All off, each back alone, and all but the last.
    void send_effects(const Scene& flat) {
        std::vector<const PhysicsEffect*> there;
        for (const PhysicsEffect& effect : physics_effects())
            if (effect.switching != Switching::never && effect.present(flat)) there.push_back(&effect);
        const auto without = [&](auto&& leaves_out) {
            Scene scene = flat;
            for (const PhysicsEffect* effect : there)
                if (leaves_out(*effect)) silence(*effect, scene);
            return scene;
        };
        off_jobs_ = send(without([](const PhysicsEffect&) { return true; }));
        for (const PhysicsEffect* back : there)
            if (back->switching == Switching::alone)
                switched_.push_back(
                    {back, send(without([&](const PhysicsEffect& p) { return &p != back; }))});
        for (const PhysicsEffect* back : there)
            if (back->switching == Switching::last)
                last_ = {back, send(without([&](const PhysicsEffect& p) { return &p == back; }))};
    }

    /// From the candidate's snatch, that with the reference's speed, and the reference's.
    void send_starts(const Scene& flat) {
        SnatchState faster = candidate_snatch_;
        faster.airspeed = reference_snatch_.airspeed;
        from_own_ = agenda_.add(candidate_, from_snatch(scene_, candidate_snatch_));
        from_own_at_speed_ = agenda_.add(candidate_, from_snatch(scene_, faster));
        flat_ = send(flat);
    }

    void send_seeds() {
        if (!scene_.full.noise || options_.seeds < 2) return;
        const std::uint64_t first = scene_.full.noise->seed;
        for (int i = 0; i < options_.seeds; ++i)
            attribution_.seeds.push_back(first + static_cast<std::uint64_t>(i));
        for (std::size_t i = 1; i < attribution_.seeds.size(); ++i) {
            Scene scene = scene_;
            scene.full.noise->seed = attribution_.seeds[i];
            seeds_.push_back(agenda_.add(reference_, std::move(scene)));
        }
    }

    Before before(const SnatchState& state) const {
        if (!packed_) return {};
        return {state.time, state.place - Vec3(0.0, 0.0, scene_.release.altitude)};
    }

    Answer answer(std::size_t job, const SnatchState& start, bool own_shape) const {
        return {&agenda_.record(job), before(start), own_shape};
    }

    Pair pair(const JobPair& jobs, bool own_shape) const {
        return {answer(jobs.reference, reference_snatch_, own_shape),
                answer(jobs.candidate, reference_snatch_, own_shape)};
    }

    /// Says once which run is of no use, and why.
    void mention(const Pair& pair, std::string_view what) {
        for (const Answer* side : {&pair.candidate, &pair.reference})
            if (!side->ended())
                note(fmt::format("{}: {} ended as {}{}{}; what it would have shown is in the interaction",
                                 what, side->record->fidelity, status_name(side->record->status.code),
                                 side->record->status.detail.empty() ? "" : ", ",
                                 side->record->status.detail));
    }

    void collect() {
        off_ = pair(off_jobs_, false);
        mention(off_, "with every effect off");
        for (Switched& row : switched_) {
            row.pair = pair(row.jobs, false);
            mention(row.pair, row.effect->title);
        }
        if (last_.effect != nullptr) {
            last_.pair = pair(last_.jobs, false);
            mention(last_.pair, last_.effect->title);
        }
        whole_ = packed_ ? pair(flat_, true)
                         : Pair{{&comparison_.reference, {}, true}, {&comparison_.candidate, {}, true}};
        if (packed_) mention(whole_, "from line stretch on");
        std::erase_if(seeds_, [&](std::size_t job) {
            const RunRecord& record = agenda_.record(job);
            const bool useless = exit_code(record.status.code) != ExitCode::done;
            if (useless)
                note(fmt::format("one of the seeds ended as {}: it is not in the scatter",
                                 status_name(record.status.code)));
            return useless;
        });
    }

    void attribute_metric(const MetricGap& metric) {
        const MetricRow& row = *metric.row;
        MetricAttribution found;
        found.metric = row.name;
        found.candidate = metric.candidate->value;
        found.reference = metric.reference->value;
        const bool from_line_stretch = gap_of(whole_, row).has_value();
        if (from_line_stretch) {
            if (packed_) add_start(found, row);
            add_effects(found, row);
            if (packed_) add_drawing_out(found, row);
        } else if (packed_) {
            found.terms.push_back({"deployment", "Deployment", found.reference - found.candidate,
                                   "a run that starts at line stretch has no such thing"});
        }
        found.interaction = found.reference - found.candidate;
        for (const AttributionTerm& term : found.terms)
            found.interaction -= term.effect;
        found.scatter = scatter(row);
        if (!std::isfinite(found.interaction)) {
            note(fmt::format("{}: the terms are too large for a number", row.title));
            return;
        }
        attribution_.metrics.push_back(std::move(found));
    }

    static void add(MetricAttribution& to, std::string_view name, std::string_view title,
                    const std::optional<double>& effect, std::string_view detail) {
        if (effect) to.terms.push_back({std::string(name), std::string(title), *effect, std::string(detail)});
    }

    /// Answer of the candidate from the snatch of the reference.
    void add_start(MetricAttribution& to, const MetricRow& row) {
        const auto own = value_of(answer(from_own_, candidate_snatch_, true), row);
        const auto at_speed = value_of(answer(from_own_at_speed_, candidate_snatch_, true), row);
        const auto there = value_of(whole_.candidate, row);
        add(to, "snatch-speed", "Snatch speed", less(at_speed, own),
            fmt::format("{:.4g} m/s instead of {:.4g} m/s", reference_snatch_.airspeed,
                        candidate_snatch_.airspeed));
        const auto state = less(there, at_speed), restart = less(own, to.candidate);
        add(to, "snatch-state", "Snatch state",
            state && restart ? std::optional(*state + *restart) : std::nullopt,
            "altitude, path and time of the snatch");
    }

    void add_effects(MetricAttribution& to, const MetricRow& row) {
        const auto rest = gap_of(off_, row);
        add(to, "structure", "Structure", rest,
            "what is left with every effect off: fabric and lines in motion, mesh, time step");
        for (const Switched& switched : switched_)
            add(to, switched.effect->name, switched.effect->title, less(gap_of(switched.pair, row), rest),
                switched.effect->detail);
        if (last_.effect != nullptr)
            add(to, last_.effect->name, last_.effect->title,
                less(gap_of(whole_, row), gap_of(last_.pair, row)), last_.effect->detail);
    }

    void add_drawing_out(MetricAttribution& to, const MetricRow& row) {
        add(to, "drawing-out", "Drawing out", less(to.reference, value_of(whole_.reference, row)),
            "folds, noise and motion that lines and canopy bring along from the pack");
    }

    std::optional<double> scatter(const MetricRow& row) const {
        double low = *comparison_.reference.metric(row.key), high = low;
        if (seeds_.empty()) return {};
        for (const std::size_t job : seeds_) {
            const auto value = agenda_.record(job).metric(row.key);
            if (!value || !std::isfinite(*value)) continue;
            low = std::min(low, *value);
            high = std::max(high, *value);
        }
        return high - low;
    }

    const Comparison& comparison_;
    const Scene& scene_;
    const Fidelity &reference_, &candidate_;
    const AttributionOptions& options_;
    const bool packed_;
    Attribution attribution_;
    Agenda agenda_;
    SnatchState reference_snatch_, candidate_snatch_;  // packed scenes
    JobPair off_jobs_, flat_;
    std::vector<Switched> switched_;
    Switched last_{};
    std::size_t from_own_ = 0, from_own_at_speed_ = 0;
    std::vector<std::size_t> seeds_;
    Pair off_, whole_;
};

}  // namespace

Attribution attribute(const Comparison& comparison, const Scene& scene, const Fidelity& reference,
                      const Fidelity& candidate, const AttributionOptions& options) {
    return Study(comparison, scene, reference, candidate, options).run();
}

}  // namespace twinchute::compare
