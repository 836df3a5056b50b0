#include "fullsim/run/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "fullsim/cluster.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/run/observer.hpp"
#include "fullsim/run/parts.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/time/choose_step.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/solve/opening.hpp"
#include "lib/solve/stopwatch.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int parts_of_stage = 32;  // of the central difference scheme over a stage
/// Share of the filling time until the mouth is open enough for finite elements to begin: 0.50 in the paper's
/// crane drop, 0.32 in its free deployment. Steps of springs and of elements differ less than that.
constexpr double mouth_share = 0.4;
/// Share of the time to snatch in which all fabric is folded: 0.40 in the crane drop, 0.39 in the free
/// deployment.
constexpr double folded_share = 0.4;
constexpr double settling = 2.0;  // D0/v of an open canopy, before it is released (settle.cpp)

/// Durations of a run's stages, as far as they can be known beforehand.
struct ExpectedFlight {
    bool known = false;                               ///< its end
    double snatch = 0.0, full_open = 0.0, end = 0.0;  ///< [s] since release; infinite where not reached
    double altitude = 0.0;                            ///< [m] of the snatch
    double speed = 0.0;                               ///< [m/s] through the air, at snatch
    Inflation inflation;
};

double density_at(const Scene& scene, double altitude) {
    return scene.environment.atmosphere.at(altitude).density;
}

ExpectedFlight expected_flight(const Scene& scene, const RunRecord* expected) {
    const Parachute& chute = scene.parachutes.front();
    ExpectedFlight flight;
    flight.altitude = scene.release.altitude;
    flight.speed = release_airspeed(scene).norm();
    if (expected && !is_numerical_failure(expected->status.code) &&
        expected->status.code != StatusCode::refused) {
        flight.known = true;
        flight.end = expected->find_channel("time")->values.back();
    } else if (scene.stop.kind == Trigger::Kind::time && !chute.deploy.starts_packed()) {
        flight.known = true;
        flight.end = scene.stop.value + scene.stop.delay;
    }
    if (chute.deploy.by == DeployBy::inflated) {
        flight.inflation = inflated(chute);
    } else {
        if (chute.deploy.starts_packed()) {
            flight.snatch = infinity;
            const Event* event = expected ? expected->find_event("snatch") : nullptr;
            if (const auto speed = expected ? expected->metric("snatch_speed_m_s") : std::nullopt;
                event && speed) {
                flight.snatch = event->time;
                flight.altitude = event->altitude;
                flight.speed = *speed;
            }
        }
        const double snatch = std::isfinite(flight.snatch) ? flight.snatch : 0.0;
        flight.inflation =
            make_inflation(scene, chute, snatch, flight.speed, density_at(scene, flight.altitude));
    }
    flight.full_open = std::isfinite(flight.snatch) ? flight.inflation.end_of(Phase::filling) : flight.snatch;
    if ((chute.filling.is_predicted() || !chute.reefing.empty()) && expected)
        if (const Event* full = expected->find_event("full-open")) flight.full_open = full->time;
    // A descent is not called steady before there is a shape to report, a mean over two seconds.
    if (scene.stop.kind == Trigger::Kind::steady_descent && std::isfinite(flight.full_open))
        flight.end = std::max(flight.end, flight.full_open + 2.0 + scene.stop.delay);
    return flight;
}

/// [kg] of air that moves with the canopy, as a run prescribes it.
double added_mass_at(const Scene& scene, const ExpectedFlight& flight, double time) {
    if (!scene.aerodynamics.added_mass) return 0.0;
    const Inflation& inflation = flight.inflation;
    const Parachute& chute = scene.parachutes.front();
    return inflation
        .added_mass(*scene.aerodynamics.added_mass, inflation.phase_at(time), time,
                    density_at(scene, flight.altitude), steady_radius(chute), chute.geometric_porosity)
        .value;
}

/// The scene with another start, straight down through still air.
Scene start_of(Scene scene, DeployBy by, double altitude, double speed) {
    scene.parachutes.front().deploy.by = by;
    scene.release = {altitude, speed, 0.5 * pi, scene.release.heading};
    scene.environment.wind.reset();
    return scene;
}

/// A simulation that takes steps as a run does, to see what they cost.
class Probe {
public:
    Probe(Scene scene, int threads)
        : scene_(std::move(scene)),
          simulation_(scene_,
                      [threads](const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
                          return make_layout(s, mesh, constants, threads);
                      }),
          observer_(simulation_.mesh(), scene_.environment.gravity, scene_.full.row_rate()) {}

    Simulation& simulation() { return simulation_; }

    /// The next stage begins; false where the simulation refuses to.
    bool begin(const std::function<bool(Simulation&)>& change) {
        simulation_.evaluate_forces();
        const bool begun = change(simulation_);
        simulation_.step_to(infinity);
        return begun;
    }

    /// Steps for so many seconds of wall time.
    void run(double budget) {
        std::vector<double> seconds;  // of a step, by group of steps
        const double start = simulation_.system().time;
        const std::int64_t before = simulation_.system().step;
        const Stopwatch all;
        do {
            const Stopwatch watch;
            for (int k = 0; k < StepControl::steps_between_bounds; ++k) {
                simulation_.evaluate_forces();
                observer_.observe(simulation_.system(), simulation_.payload_force());
                if (observer_.row_is_due(simulation_.system().time))
                    observer_.add_row(simulation_.synchronised_state());
                simulation_.step_to(infinity);
            }
            seconds.push_back(time_of(watch) / StepControl::steps_between_bounds);
        } while (all.wall() < budget);
        steps_ = simulation_.system().step - before;
        mean_step_ = (simulation_.system().time - start) / static_cast<double>(steps_);
        // Interrupts make some groups dear.
        const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
        std::ranges::nth_element(seconds, middle);
        const Stopwatch check;
        simulation_.find_fault();
        seconds_ = (*middle + time_of(check) / Simulation::steps_between_checks) /
                   cost_of(simulation_.step().subcycles);
    }

    double seconds() const { return seconds_; }      ///< [s] of wall time of a step without subcycles
    double mean_step() const { return mean_step_; }  ///< [s]
    std::int64_t steps() const { return steps_; }    ///< that were tried

private:
    /// [s] Of one thread its own time, which other work on the machine does not add to.
    double time_of(const Stopwatch& watch) const {
        return simulation_.layout().threads() > 1 ? watch.wall() : watch.cpu();
    }

    Scene scene_;
    Simulation simulation_;
    Observer observer_;
    double seconds_ = 0.0, mean_step_ = 0.0;
    std::int64_t steps_ = 0;
};

class Forecast {
public:
    Forecast(const Scene& scene, const PlanBasis& basis)
        : scene_(scene), basis_(basis), flight_(expected_flight(scene, basis.expected)) {
        plan_.parts = parts_of(scene);
        plan_.whole = flight_.known;
    }

    Plan make() {
        const std::vector<Stage> stages = stages_of(scene_);
        const bool packed = stages.front() == Stage::deployment;
        const bool opens = !plan_.whole || flight_.snatch < flight_.end;
        // Deployment, springs, ramp; filling and the open canopy.
        budget_ = basis_.probe / static_cast<double>(stages.size() + 1);
        double begin = 0.0;
        if (packed) {
            Probe probe(scene_, basis_.threads);
            run(probe);
            begin = std::min(flight_.snatch, flight_.end);
            const double drawn_out = folded_share * begin;
            add(probe, "deployment", 0.0, begin, [&](double time) {
                if (time > drawn_out) return probe.simulation().step_with(0.0, 0.0);
                return ChosenStep{probe.mean_step(), probe.simulation().step().subcycles};
            });
        }
        if (opens && stages.size() > 2) begin = add_springs(begin);
        if (opens && scene_.parachutes.front().deploy.by != DeployBy::inflated)
            begin = add_filling(packed, begin);
        if (opens && (!plan_.whole || flight_.end > begin)) add_open(begin);
        if (plan_.whole)
            add_bytes(
                plan_.arrays, "history",
                sizeof(HistoryRow) * static_cast<std::size_t>(flight_.end * scene_.full.row_rate() + 1.0));
        plan_.how = fmt::format("{}: {} steps tried in {} {}{}; ", layout_, tried_, plan_.stages.size(),
                                plan_.stages.size() == 1 ? "state" : "states",
                                basis_.threads > 1 ? fmt::format(" on {} threads", basis_.threads) : "");
        if (!plan_.whole)
            plan_.how += "no end is known beforehand, figures are of one step";
        else if (!basis_.expected)
            plan_.how += "the scene says when it ends";
        else
            plan_.how += fmt::format("times of events from '{}'{}", basis_.expected->fidelity,
                                     packed ? ", whose snatch may come at another time" : "");
        if (scene_.payload.body) plan_.how += "; " + cost_of_elasticity();
        plan_.how += "; time of a machine without other work";
        return std::move(plan_);
    }

private:
    using StepAt = std::function<ChosenStep(double time)>;

    void run(Probe& probe) {
        probe.run(budget_);
        tried_ += probe.steps();
        const Layout& layout = probe.simulation().layout();
        layout_ = fmt::format("{}, {}", layout.instruction_set(), layout.name());
        // A stage has its own; what a run holds at once is never more than the largest of each.
        for (const PlanArray& array : probe.simulation().arrays()) {
            const auto found = std::ranges::find(plan_.arrays, array.name, &PlanArray::name);
            if (found == plan_.arrays.end())
                plan_.arrays.push_back(array);
            else
                found->bytes = std::max(found->bytes, array.bytes);
        }
    }

    void add(const Probe& probe, const char* name, double begin, double end, const StepAt& step_at) {
        PlanStage stage{name, begin, end};
        if (!plan_.whole) {
            const ChosenStep step = step_at(begin);
            stage.end = begin + step.dt;
            stage.steps = 1.0;
            stage.seconds = probe.seconds() * cost_of(step.subcycles);
        } else if (end > begin) {
            const double length = (end - begin) / parts_of_stage;
            for (int k = 0; k < parts_of_stage; ++k) {
                const ChosenStep step = step_at(begin + (k + 0.5) * length);
                const double steps = length / step.dt;
                stage.steps += steps;
                stage.seconds += steps * probe.seconds() * cost_of(step.subcycles);
            }
        }
        plan_.stages.push_back(std::move(stage));
    }

    /// Springs and ramp, on a parachute that is drawn out already. Says when they are over.
    double add_springs(double begin) {
        const Scene drawn_out = [&] {
            Scene scene =
                start_of(scene_, scene_.parachutes.front().deploy.by, flight_.altitude, flight_.speed);
            scene.parachutes.front().deploy.pack_ratio = 1.0;
            return scene;
        }();
        Probe probe(drawn_out, basis_.threads);
        if (!probe.begin([](Simulation& s) { return !s.snatch().has_value(); })) return begin;
        run(probe);
        const double change = std::min(flight_.end, begin + mouth_share * flight_.inflation.filling_time);
        add(probe, "springs", begin, change, [&](double time) {
            return probe.simulation().step_with(added_mass_at(scene_, flight_, time), 0.0);
        });
        probe.begin([](Simulation& s) {
            s.begin_ramp();
            return true;
        });
        run(probe);
        const double ramp = probe.simulation().ramp_time(), end = std::min(flight_.end, change + ramp);
        add(probe, "ramp", change, end, [&](double time) {
            const double share = end > change ? (time - change) / ramp : 1.0;
            return probe.simulation().step_with(added_mass_at(scene_, flight_, time), share * share * share);
        });
        return end;
    }

    double add_filling(bool packed, double begin) {
        Probe probe(
            packed ? start_of(scene_, DeployBy::line_stretch, flight_.altitude, flight_.speed) : scene_,
            basis_.threads);
        run(probe);
        const double end = std::max(begin, std::min(flight_.end, flight_.full_open));
        add(probe, "filling", begin, end, [&](double time) {
            return probe.simulation().step_with(added_mass_at(scene_, flight_, time), 1.0);
        });
        return end;
    }

    /// Effect of a deformable payload on the time step at the start, actual or hypothetical.
    std::string cost_of_elasticity() const {
        constexpr double sample = 1e9;  // [Pa] of a payload that has no modulus: boards, plastics
        Scene rigid = scene_, soft = scene_;
        const auto& given = scene_.payload.body->elasticity;
        rigid.payload.body->elasticity.reset();
        if (!given) soft.payload.body->elasticity = Elasticity{sample, 0.3};
        const double lumped = Simulation(rigid).step().dt;
        try {
            const double ratio = lumped / Simulation(soft).step().dt;
            if (given)
                return fmt::format("the payload's tetrahedra divide the step by {:.3g} against a rigid one",
                                   ratio);
            return fmt::format("tetrahedra that give way would divide the step by {:.3g} with E = 1 GPa",
                               ratio);
        } catch (const SceneError&) {
            return "its tetrahedra are too few to give way";
        }
    }

    void add_open(double begin) {
        const Parachute& chute = scene_.parachutes.front();
        const double weight = (scene_.payload.mass + chute.mass) * scene_.environment.gravity;
        const double density = density_at(scene_, flight_.altitude);
        const double descent =
            density > 0.0 ? std::sqrt(2.0 * weight / (density * chute.drag_area)) : flight_.speed;
        const bool as_it_is = chute.deploy.by == DeployBy::inflated;
        Probe probe(as_it_is ? scene_ : start_of(scene_, DeployBy::inflated, flight_.altitude, descent),
                    basis_.threads);
        run(probe);
        const auto steps = [&](double) {
            return ChosenStep{probe.mean_step(), probe.simulation().step().subcycles};
        };
        if (as_it_is && plan_.whole && flight_.speed > 0.0)
            add(probe, "settling",
                begin - settling *
                            std::min(chute.nominal_diameter / flight_.speed, probe.simulation().time_scale()),
                begin, steps);
        add(probe, "open canopy", begin, flight_.end, steps);
    }

    const Scene& scene_;
    const PlanBasis& basis_;
    ExpectedFlight flight_;
    Plan plan_;
    double budget_ = 0.0;     // [s] of wall time of a probe
    std::int64_t tried_ = 0;  // steps
    std::string layout_;
};

/// One parachute, or a cluster of it, from the release on.
Plan plan_of_canopies(const Scene& scene, const PlanBasis& basis) {
    const int count = scene.parachutes.front().count;
    if (count == 1) return Forecast(scene_of_canopy(scene, 0), basis).make();
    // Canopies of a cluster take the same steps; the last one to open says when they are done.
    const auto& lag = scene.parachutes.front().lag;
    const auto last = lag.empty() ? 0 : std::ranges::max_element(lag) - lag.begin();
    const Scene one = scene_of_canopy(scene, static_cast<int>(last));
    PlanBasis alone = basis;
    alone.threads = 1;
    Plan plan = Forecast(one, alone).make();
    plan.parts = parts_of(scene);
    for (PlanStage& stage : plan.stages)
        stage.seconds *= count;
    for (PlanArray& array : plan.arrays)
        array.bytes *= static_cast<std::size_t>(count);
    plan.how += fmt::format(
        "; {} times one canopy of the cluster, on one thread, without what they do to each other", count);
    return plan;
}

/// A parachute's part of a run of several, as a run of it alone from where it leaves its pack.
struct PartOfFlight {
    Scene scene;
    RunRecord expected;
};

/// [s] at which the parachute leaves its pack, whose lines come taut at `taut`: where the separation of pack
/// and payload begins.
double leaves_pack(const RunRecord& record, double taut) {
    const Channel *time = record.find_channel("time"), *apart = record.find_channel("separation");
    double begin = taut;
    for (std::size_t i = 0; apart && i < time->values.size() && time->values[i] <= taut; ++i)
        if (apart->values[i] == 0.0 || i == 0) begin = time->values[i];
    return begin;
}

/// Absent where the expected run does not come to it.
std::optional<PartOfFlight> part_of_flight(const Scene& scene, std::size_t parachute,
                                           const RunRecord& expected) {
    const Parachute& chute = scene.parachutes[parachute];
    const std::string head = scene.parachutes.size() > 1 ? chute.name + "." : "";
    const Event* taut = expected.find_event(head + "line-stretch");
    const bool inflates_at_release = chute.deploy.by == DeployBy::inflated && !chute.deploy_when;
    if (!taut && !inflates_at_release) return {};
    const double begin = !taut                          ? 0.0
                         : chute.deploy.starts_packed() ? leaves_pack(expected, taut->time)
                                                        : taut->time;
    const Event* cut = expected.find_event(head + "cut");
    const double end = cut ? cut->time : expected.find_channel("time")->values.back();
    PayloadFlight at = released_payload(scene);
    if (taut) {
        at.position.z() = taut->altitude;
        at.velocity = -taut->speed * Vec3::UnitZ();
        at.body.reset();  // it hangs straight, as far as a plan knows
    }
    PartOfFlight part{scene_in_flight(scene, parachute, at), {}};
    part.scene.release.time = 0.0;
    part.expected.fidelity = expected.fidelity;
    part.expected.status = expected.status;
    part.expected.channels.push_back({"time", "s", {0.0, end - begin}});
    for (Event event : expected.events) {
        if (!event.name.starts_with(head)) continue;
        event.name.erase(0, head.size());
        event.time -= begin;
        part.expected.events.push_back(std::move(event));
    }
    if (const Event* snatch = part.expected.find_event("snatch"))
        part.expected.add_metric("snatch_speed_m_s", snatch->speed);
    part.scene.release.time = begin;
    return part;
}

/// Parachute by parachute, each for the time that it is out.
Plan plan_of_stages(const Scene& scene, const PlanBasis& basis) {
    Plan plan;
    plan.parts = parts_of(scene);
    const PayloadFlight start = released_payload(scene);
    for (std::size_t p = 0; p < scene.parachutes.size(); ++p) {
        PartOfFlight part{scene_in_flight(scene, p, start), {}};
        PlanBasis own = basis;
        own.threads = 1;
        own.expected = nullptr;
        own.probe = basis.probe / static_cast<double>(scene.parachutes.size());
        std::optional<PartOfFlight> known;
        if (basis.expected) known = part_of_flight(scene, p, *basis.expected);
        if (known) {
            part = std::move(*known);
            own.expected = &part.expected;
        }
        const double begin = std::exchange(part.scene.release.time, 0.0);
        Plan one = plan_of_canopies(part.scene, own);
        plan.whole = plan.whole && one.whole && known;
        for (PlanStage& stage : one.stages) {
            if (scene.parachutes.size() > 1) stage.name.insert(0, scene.parachutes[p].name + ": ");
            stage.begin += begin;
            stage.end += begin;
            plan.stages.push_back(std::move(stage));
        }
        for (const PlanArray& array : one.arrays)
            add_bytes(plan.arrays, array.name, array.bytes);
        plan.how += (p == 0 ? "" : "; ") + scene.parachutes[p].name + ": " + one.how;
    }
    if (scene.parachutes.size() > 1)
        plan.how += "; while several are out all take the smallest of their steps, which is not foreseen";
    return plan;
}

}  // namespace

Plan plan_full(const Scene& scene, const PlanBasis& basis) {
    const Scene meshed = weighed(scene);
    if (has_stages(scene)) return plan_of_stages(meshed, basis);
    return plan_of_canopies(meshed, basis);
}

}  // namespace twinchute::fullsim
