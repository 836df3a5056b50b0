#include "fullsim/run/stages.hpp"

#include "fullsim/initial_state.hpp"

namespace twinchute::fullsim {

Stages::Stages(const Scene& scene) : sequence(scene, OpeningSequence::Alike::each), scene_(scene) {
    const PayloadFlight start = released_payload(scene);
    std::size_t canopies = 0;
    for (std::size_t p = 0; p < scene.parachutes.size(); ++p) {
        first_canopy_.push_back(canopies);
        canopies += static_cast<std::size_t>(scene.parachutes[p].count);
        const Scene one = scene_in_flight(scene, p, start);
        MassScaling scaling;
        meshes_.push_back(std::make_unique<Mesh>(first_mesh(one, first_inflation(one), scaling)));
    }
    stowed_.resize(meshes_.size());
    sequence.release(flight_state(start));
}

FlightState Stages::flight_state(const PayloadFlight& payload) const {
    const Environment& around = scene_.environment;
    const double altitude = payload.position.z();
    Vec3 airspeed = payload.velocity;
    if (around.wind) airspeed -= around.wind->at(altitude);
    return {payload.time, altitude, payload.velocity.z(), airspeed.norm(),
            around.atmosphere.at(altitude).density};
}

FlightWatch Stages::watch() const {
    return [this](const PayloadFlight& payload) {
        std::vector<double> left = sequence.watch(flight_state(payload));
        left.push_back(payload.position.z() - scene_.environment.ground);
        if (scene_.stop.kind == Trigger::Kind::altitude)
            left.push_back(payload.position.z() - scene_.stop.value);
        return left;
    };
}

std::vector<const Mesh*> Stages::meshes() const {
    std::vector<const Mesh*> all;
    for (std::size_t p = 0; p < meshes_.size(); ++p)
        all.insert(all.end(), static_cast<std::size_t>(scene_.parachutes[p].count), meshes_[p].get());
    return all;
}

std::vector<const State*> Stages::states(const Cluster& cluster) {
    std::vector<const State*> all(sequence.all().size(), nullptr);
    for (const std::size_t k : cluster.out())
        all[first_canopy(cluster.parachute(k)) + cluster.number(k)] = &cluster[k].synchronised_state();
    const PayloadFlight payload = cluster.payload();
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (all[k]) continue;
        const std::size_t p = sequence.all()[k].index;
        State& stowed = stowed_[p];
        stowed.time = payload.time;
        stowed.fe_weight = 0.0;
        stowed.node.assign(static_cast<std::size_t>(meshes_[p]->first_static_line_node()),
                           {to_lanes(payload.position), to_lanes(payload.velocity)});
        all[k] = &stowed;
    }
    return all;
}

void Stages::close_snatch(const Observer& all) {
    if (!snatches_) return;
    snatches_ = false;
    const std::ptrdiff_t owner = owners_.back().opening;
    if (owner >= 0) opened_[static_cast<std::size_t>(owner)].snatch_force = all.snatch_peak().value;
}

void Stages::close_for_another() {
    Owner& before = owners_.back();
    before.still_fills = before.opening >= 0 && sequence.is_growing(opened_.back().index);
}

void Stages::leaves_pack(double time, Observer& all) {
    close_for_another();
    close_snatch(all);
    all.begin_deployment(time);
    owners_.push_back({});
    snatches_ = true;
}

void Stages::opens(std::size_t parachute, const RunView& canopies, double initial_time, double time,
                   Observer& all) {
    const auto own = static_cast<std::ptrdiff_t>(opened_.size());
    const bool of_another = owners_.back().opening >= 0;  // which has opened while this pack was drawn out
    if (!canopies.packed() || of_another) close_for_another();
    ParachuteResult opening;
    opening.index = parachute;
    opening.snatch_time = time;
    opening.snatch_speed = canopies.snatch_speed();
    opening.stages.push_back({time});
    opened_.push_back(std::move(opening));
    if (canopies.packed()) {
        if (of_another) {
            all.begin_stage(time);
            owners_.push_back({});
        }
        owners_.back() = {own, 0};
        all.count_peak_from(time + initial_time);
    } else {
        close_snatch(all);
        all.begin_stage(time);
        owners_.push_back({own, 0});
    }
}

void Stages::disreefs(std::size_t parachute, double time, Observer& all) {
    for (std::size_t i = 0; i < opened_.size(); ++i) {
        if (opened_[i].index != parachute) continue;
        opened_[i].stages.push_back({time});
        if (i + 1 != opened_.size()) return;  // forces are the last one's
        close_snatch(all);
        all.begin_stage(time);
        owners_.push_back({static_cast<std::ptrdiff_t>(i), opened_[i].stages.size() - 1});
    }
}

std::vector<ParachuteResult> Stages::openings(std::span<const RunView> each, const Observer& all) {
    close_snatch(all);
    for (std::size_t i = 0; i < owners_.size(); ++i) {
        if (owners_[i].opening < 0) continue;
        const Observer::Peak& peak = i < all.earlier_peaks().size() ? all.earlier_peaks()[i] : all.peak();
        ParachuteResult::Stage& stage =
            opened_[static_cast<std::size_t>(owners_[i].opening)].stages[owners_[i].stage];
        if (peak.value > 0.0 && !owners_[i].still_fills) stage.peak_force = peak.value;
        stage.peak_time = peak.time;
    }
    for (ParachuteResult& opening : opened_)
        for (const RunView& one : each) {
            if (one.canopies.parachute(one.first) != opening.index) continue;
            const auto& found = one.findings.stages;
            for (std::size_t s = 0; s < std::min(found.size(), opening.stages.size()); ++s)
                opening.stages[s].full = found[s].full;
        }
    return opened_;
}

void Stages::serialize(Archive& archive) {
    sequence.serialize(archive);
    archive.length("openings", opened_, scene_.parachutes.size());
    for (ParachuteResult& opening : opened_) {
        archive.whole("parachute", opening.index, 0, scene_.parachutes.size() - 1);
        archive.number("snatch", opening.snatch_time);
        archive.number("snatch", opening.snatch_speed);
        archive.number("snatch", opening.snatch_force);
        archive.length("stages", opening.stages, 1000);
        for (ParachuteResult::Stage& stage : opening.stages)
            archive.number("begin", stage.begin);
    }
    archive.length("peaks", owners_, 10'000);
    for (Owner& owner : owners_) {
        archive.whole("opening", owner.opening, -1, static_cast<std::ptrdiff_t>(opened_.size()) - 1);
        archive.whole("stage", owner.stage, 0, 1000);
        archive.flag("still fills", owner.still_fills);
        if (owner.opening >= 0 &&
            owner.stage >= opened_[static_cast<std::size_t>(owner.opening)].stages.size())
            archive.refuse("holds what no run writes", "a peak of a stage that has not begun");
    }
    archive.flag("snatches", snatches_);
}

}  // namespace twinchute::fullsim
