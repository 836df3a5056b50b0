#include "fullsim/run/recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace twinchute::fullsim {
namespace {

// Frames of a report: a deployment lasts tenths of a second to some seconds, breathing as long as filling.
constexpr FrameStretch deployment_frames{0.02, 20}, descent_frames{0.1, 16};
constexpr std::size_t opening_frames = 48;
constexpr double opening_and_breathing = 2.0;   // filling times, from snatch
constexpr double expected_fill_constant = 8.0;  // of a filling that is predicted, for frames alone

}  // namespace

Recorder::Together::Together(const Scene& scene, double stated_mass, const Cluster& cluster,
                             std::size_t first, const OpeningSequence* sequence)
    : observer(cluster[first].mesh(), scene.environment.gravity, scene.full.row_rate(), 1,
               scene.parachutes.front().count),
      view{scene,    stated_mass, cluster, first, static_cast<std::size_t>(scene.parachutes.front().count),
           observer, found,       sequence},
      canopies(view.count) {
    std::iota(canopies.begin(), canopies.end(), first);
    found.snatch = view.packed() ? infinity : scene.release.time;
    observer.count_peak_from(found.snatch);
}

Recorder::Together::Together(const Scene& scene, const Mesh& mesh, const Cluster& cluster)
    : observer(mesh, scene.environment.gravity, scene.full.row_rate()),
      view(RunView{scene, 0.0, cluster, 0, 0, observer, found, nullptr}) {
    observer.weigh_payload(cluster.payload().mass);
}

Recorder::Recorder(const Scene& scene, std::span<const double> stated_masses, const Run& run,
                   Cluster& cluster, Stages* stages)
    : scene_(scene),
      run_(run),
      cluster_(cluster),
      stages_(stages),
      stated_masses_(stated_masses.begin(), stated_masses.end()),
      fields_(meshes(), scene.full.fields_rate, run.fields),
      frames_(meshes(), static_cast<bool>(run.frames), stages ? 1 : cluster.front().sectors()) {
    add_canopies();
    if (const auto& body = scene.payload.body; body && body->sling_length)
        slings_.emplace(sling_geometry(*body));
    if (stages) {
        all_ = std::make_unique<Together>(scene, *stages->meshes().front(), cluster);
        return;
    }
    if (cluster.size() > 1)
        all_ = std::make_unique<Together>(scene, stated_masses_.front(), cluster, 0,
                                          canopies_.back()->view().sequence);
    if (view().packed())
        begin_deployment_frames();
    else if (view().inflated())
        begin_descent_frames();
    else
        begin_opening_frames();
}

std::vector<RunView> Recorder::canopy_views() const {
    std::vector<RunView> views;
    for (const auto& canopy : canopies_)
        views.push_back(canopy->view());
    return views;
}

std::vector<RunView> Recorder::parachute_views() const {
    std::vector<RunView> views;
    for (std::size_t k = 0; k < canopies_.size(); ++k)
        if (cluster_.number(k) == 0) views.push_back(parachute(k));
    return views;
}

void Recorder::add_canopies() {
    for (std::size_t k = canopies_.size(); k < cluster_.size(); ++k) {
        past_.emplace_back();
        if (!stages_) {
            canopies_.push_back(
                std::make_unique<CanopyRun>(cluster_.scene(k), stated_masses_.front(), cluster_, k));
            continue;
        }
        const std::size_t parachute = cluster_.parachute(k);
        canopies_.push_back(std::make_unique<CanopyRun>(
            cluster_.scene(k), stated_masses_[parachute], cluster_, k, &stages_->sequence,
            stages_->first_canopy(parachute) + cluster_.number(k)));
        const Scene& all = cluster_.scene_of_all(k);
        if (cluster_.number(k) == 0 && all.parachutes.front().count > 1)
            groups_.push_back(std::make_unique<Together>(
                all, stated_masses_[parachute], cluster_, k,
                all.parachutes.front().reefing.empty() ? nullptr : &stages_->sequence));
    }
}

void Recorder::weigh_payload() {
    double mass = cluster_.out().empty() ? cluster_.payload().mass : 0.0;
    for (const std::size_t k : cluster_.out())
        mass += cluster_[k].payload_node_mass();
    observer().weigh_payload(mass);
}

std::vector<const Mesh*> Recorder::meshes() const {
    if (stages_) return stages_->meshes();
    std::vector<const Mesh*> all;
    for (std::size_t k = 0; k < cluster_.size(); ++k)
        all.push_back(&cluster_[k].mesh());
    return all;
}

std::vector<const State*> Recorder::synchronised_states() const {
    if (stages_) return stages_->states(cluster_);
    std::vector<const State*> all;
    for (std::size_t k = 0; k < cluster_.size(); ++k)
        all.push_back(&cluster_[k].synchronised_state());
    return all;
}

Recorder::Together* Recorder::group_of(std::size_t k) const {
    if (!stages_) return all_.get();
    for (const auto& group : groups_)
        if (k - group->view.first < group->view.count) return group.get();
    return nullptr;
}

/// work(observer): of each canopy, of each parachute of several, of all.
template <class Work>
void Recorder::for_each_observer(Work&& work) {
    for (const auto& canopy : canopies_)
        work(canopy->observer());
    for (const auto& group : groups_)
        work(group->observer);
    if (all_) work(all_->observer);
}

void Recorder::observe() {
    const double now = cluster_.time();
    const bool row = observer().row_is_due(now);
    for (const std::size_t k : cluster_.out())
        canopies_[k]->observe(row);
    for (const auto& group : groups_)
        if (cluster_.is_out(group->view.first)) observe_together(group->observer, group->canopies, row);
    if (all_) observe_together(all_->observer, cluster_.out(), row);
    if (slings_ && !cluster_.out().empty()) {
        Vec3 pull = Vec3::Zero();
        for (const std::size_t k : cluster_.out())
            pull += cluster_[k].system().riser_force;
        slings_->observe(now, pull, *cluster_.front().system().body);
    }
    if (fields_.frame_is_due(now)) fields_.observe(synchronised_states());
    if (now >= descent_frames_from_) begin_descent_frames();
    if (frames_.frame_is_due(now)) frames_.observe(synchronised_states());
}

void Recorder::observe_together(Observer& observer, std::span<const std::size_t> canopies, bool row) {
    SystemState sum;
    sum.time = cluster_.time();
    Vec3 on_payload = Vec3::Zero();
    if (canopies.empty()) {
        const PayloadFlight alone = cluster_.payload();
        on_payload = alone.mass * (alone.acceleration + scene_.environment.gravity * Vec3::UnitZ());
    } else {
        sum.line_dt = cluster_.front().system().line_dt;
        sum.in_subcycles.count = cluster_.front().system().in_subcycles.count;
    }
    for (const std::size_t k : canopies) {
        sum.riser_force += cluster_[k].system().riser_force;
        sum.air.projected_area += cluster_[k].system().air.projected_area;
        sum.in_subcycles.sum += cluster_[k].system().in_subcycles.sum;
        on_payload += cluster_[k].payload_force();
    }
    observer.observe(sum, on_payload);
    if (row) add_row_together(observer, canopies);
}

void Recorder::add_row_together(Observer& observer, std::span<const std::size_t> canopies) {
    std::vector<HistoryRow> rows;
    Vec3 pull = Vec3::Zero();
    for (const std::size_t k : canopies) {
        rows.push_back(canopies_[k]->observer().rows().back());
        pull += canopies_[k]->system().riser_force;
    }
    HistoryRow row = rows.empty() ? row_alone() : row_of_all(rows);
    row.force_raw = pull.norm();
    observer.add_row(row);
}

HistoryRow Recorder::row_alone() const {
    const PayloadFlight payload = cluster_.payload();
    const FlightState flight = stages_->flight_state(payload);
    HistoryRow row{};
    row.time = payload.time;
    row.position = payload.position;
    row.velocity = payload.velocity;
    row.dynamic_pressure = flight.dynamic_pressure();
    row.airspeed = flight.airspeed;
    row.density = flight.density;
    row.turns = 1.0;
    if (payload.body) row.tilt = tilt(body_axis(*payload.body));
    return row;
}

void Recorder::add_rows() {
    for (const std::size_t k : cluster_.out())
        canopies_[k]->observer().observe_end(cluster_[k].synchronised_state());
    for (const auto& group : groups_)
        if (cluster_.is_out(group->view.first)) add_row_together(group->observer, group->canopies);
    if (all_) add_row_together(all_->observer, cluster_.out());
}

void Recorder::observe_parachute(std::size_t k) {
    for (const std::size_t own : canopies_with(k))
        canopies_[own]->observe(true);
    if (Together* group = group_of(k)) observe_together(group->observer, group->canopies, true);
}

void Recorder::observe_cut(std::size_t first) {
    if (canopies_[first]->observer().rows().empty())  // out and cut at one instant
        observe_parachute(first);
    for (const std::size_t k : canopies_with(first))
        canopies_[k]->observer().observe_end(cluster_[k].synchronised_state());
    if (Together* group = group_of(first); group && group->observer.rows().back().time < cluster_.time())
        add_row_together(group->observer, group->canopies);
}

void Recorder::accept() {
    for_each_observer([](Observer& seen) { seen.accept(); });
    if (slings_) slings_->accept();
    sound_events_ = events_.size();
    fields_.accept();
    frames_.accept();
}

void Recorder::forget() {
    for_each_observer([](Observer& seen) { seen.forget(); });
    if (slings_) slings_->forget();
    events_.resize(sound_events_);
    fields_.forget();
    frames_.forget();
}

void Recorder::tell_watchers() {
    if (run_.rows) {
        const std::span<const HistoryRow> rows = observer().final_rows();
        for (; told_rows_ < rows.size(); ++told_rows_)
            run_.rows({rows[told_rows_].time, rows[told_rows_].force, rows[told_rows_].velocity.norm()});
    }
    if (!run_.frames_so_far) return;
    const ShapeFrames& shape = frames_.so_far();
    if (shape.empty() || shape.frames.back().time <= told_frame_) return;
    told_frame_ = shape.frames.back().time;
    run_.frames_so_far(shape);
}

void Recorder::add_event(std::string name) {
    const PayloadFlight payload = cluster_.payload();
    events_.push_back({std::move(name), cluster_.time(), payload.position.z(), payload.velocity.norm()});
}

void Recorder::add_event(std::size_t parachute, const char* name) {
    if (scene_.parachutes.size() == 1) return add_event(name);
    add_event(fmt::format("{}.{}", scene_.parachutes[parachute].name, name));
}

bool Recorder::is_of_parachute(std::size_t k, std::string_view name) {
    if (!group_of(k)) return true;
    past_[k].emplace_back(name);
    const auto times = std::ranges::count(past_[k], name);
    if (name == "end-of-initial-phase")  // their drag area rises with that of the first
        return std::ranges::none_of(canopies_with(k), [&](std::size_t other) {
            return other != k && std::ranges::count(past_[other], name) >= times;
        });
    const bool of_reefed = name == "disreef" || name == "reefed-open" || name == "steady-descent";
    return std::ranges::all_of(canopies_with(k), [&](std::size_t other) {
        return (of_reefed && !canopies_[other]->view().sequence) ||
               std::ranges::count(past_[other], name) >= times;
    });
}

bool Recorder::happened(std::size_t k, const char* name) {
    const std::string_view what = name;
    Together* group = group_of(k);
    if (group && what == "switch") group->found.switched_late |= canopies_[k]->found().switched_late;
    if (!is_of_parachute(k, what)) return false;
    add_event(cluster_.parachute(k), name);
    if (what == "disreef") disreefed(k);
    if (!group) return true;
    if (what == "snatch") {
        // All are out with the last of them.
        const std::size_t last = std::ranges::max(
            group->canopies, {}, [&](std::size_t own) { return canopies_[own]->found().snatch; });
        group->found = canopies_[last]->found();
        group->observer.count_peak_from(cluster_.time() + initial_phase(k));
    }
    if ((what == "full-open" || what == "reefed-open") && !group->found.stages.back().full)
        group->found.stages.back().full = cluster_.time();
    return true;
}

void Recorder::disreefed(std::size_t k) {
    begin_opening_frames();
    Together* group = group_of(k);
    if (!group) return;
    group->found.stages.push_back({cluster_.time()});
    group->observer.begin_stage(cluster_.time());
}

double Recorder::initial_phase(std::size_t k) const {
    double soonest = infinity;
    for (const std::size_t own : canopies_with(k))
        soonest = std::min(soonest, cluster_[own].inflation().initial_time);
    return soonest;
}

void Recorder::begin_deployment_frames() {
    frames_.begin(cluster_.time(), deployment_frames);
}

void Recorder::begin_opening_frames() {
    const RunView& newest = parachute(canopies_.size() - 1);
    const Simulation& simulation = newest.simulation();
    const Inflation& inflation = simulation.inflation();
    const double filling = simulation.predicts_filling()
                               ? expected_fill_constant * newest.parachute().nominal_diameter /
                                     std::max(1.0, canopies_.back()->flight_state().airspeed)
                               : inflation.end_of(Phase::filling) - inflation.snatch;
    const double lasts = opening_and_breathing * filling;
    frames_.begin(cluster_.time(), {lasts / opening_frames, opening_frames});
    descent_frames_from_ = cluster_.time() + lasts;
}

void Recorder::begin_descent_frames() {
    frames_.begin(cluster_.time(), descent_frames);
    descent_frames_from_ = infinity;
}

void Recorder::finish(bool is_sound) {
    // Results of the end are those of its own instant, not of the last row before.
    if (is_sound && cluster_.time() > observer().rows().back().time) add_rows();
    for_each_observer([](Observer& seen) { seen.finish(); });
    fields_.accept();
    frames_.accept();
    if (run_.frames) run_.frames(frames_.finish());
}

void Recorder::serialize(Archive& archive) {
    add_canopies();
    for (const auto& canopy : canopies_)
        canopy->serialize(archive);
    for (const auto& group : groups_) {
        group->observer.serialize(archive);
        group->found.serialize(archive);
    }
    if (all_) {
        all_->observer.serialize(archive);
        all_->found.serialize(archive);
        if (stages_) weigh_payload();
    }
    for (std::vector<std::string>& of_one : past_) {
        archive.length("past events", of_one, 1'000'000);
        for (std::string& name : of_one)
            archive.text("past event", name);
    }
    if (slings_) slings_->serialize(archive);
    fields_.serialize(archive);
    frames_.serialize(archive);
    archive.number("descent frames", descent_frames_from_);
    archive.length("events", events_, 1'000'000);
    for (Event& event : events_) {
        auto& [name, time, altitude, speed] = event;
        archive.text("event", name);
        for (double* x : {&time, &altitude, &speed})
            archive.number("event", *x);
    }
    archive.whole("sound events", sound_events_, 0, events_.size());
}

}  // namespace twinchute::fullsim
