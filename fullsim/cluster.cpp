#include "fullsim/cluster.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "fullsim/initial_state.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/time/energy.hpp"
#include "fullsim/time/subcycling.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double clearance = 1.02;           // of neighbours at the start
constexpr double widest_lean = 0.9;          // sine of it
constexpr double near_share = 0.005;         // of D0, within which nodes are looked at in every step
constexpr double step_of_free_flight = 0.1;  // [s] a condition that is met for less may be missed
constexpr double one_moment = 1e-9;          // [s] by which two times may miss each other

/// w [1/s] of contact between canopies: that of waves in taut fabric across an element of mean size. It costs
/// some per cent of the step, and the fabric of a C-9 goes some millimetres behind the plane.
double contact_frequency(const Mesh& mesh) {
    const Fabric& fabric = mesh.stiffest_fabric();
    const double wave = std::sqrt(fabric.youngs_modulus / fabric.density);
    const double mean_area = mesh.fabric_area() / static_cast<double>(mesh.triangles.size());
    return wave / std::sqrt(4.0 / std::sqrt(3.0) * mean_area);
}

/// Mesh of one canopy, along the axis of all.
Mesh upright_mesh(const Scene& one) {
    MassScaling scaling;
    return first_mesh(one, first_inflation(one), scaling);
}

int canopies_of(const Scene& scene) {
    int sum = 0;
    for (const Parachute& chute : scene.parachutes)
        sum += chute.count;
    return sum;
}

/// Tangent of the widest angle that a node of a canopy has to its axis, which adds to `widest`.
void widen(double& widest, const Vec3& from_pivot, const Vec3& axis) {
    const double along = from_pivot.dot(axis);
    widest = std::max(widest, (from_pivot - along * axis).norm() / along);
}

/// Sine of the lean at which canopies so wide just stay clear of each other.
double sine_of_lean(double widest, int count) {
    return clearance * widest / std::sin(pi / count);
}

/// Rotation of canopy k of a parachute that leans out by so much [rad].
Eigen::Quaterniond leaning(double lean, std::size_t k, int count, const Vec3& axis) {
    const Eigen::AngleAxisd out(lean, axis.unitOrthogonal()),
        around(2.0 * pi * static_cast<double>(k) / count, axis);
    return around * out;
}

double lean_of(const Scene& scene, const Mesh& upright) {
    const int count = scene.parachutes.front().count;
    double widest = 0.0;
    for (NodeIndex i = 0; i < upright.canopy_nodes; ++i)
        widen(widest, upright.position[static_cast<std::size_t>(i)] - upright.pivot(), upright.axis);
    const double sine = sine_of_lean(widest, count);
    if (!(sine < widest_lean))
        throw SceneError({scene.file.string()}, "parachute.count",
                         fmt::format("{} canopies have no place beside each other", count),
                         "as wide as they start, they would have to lean out by more than 64 deg",
                         "give fewer, longer lines, or start them at line stretch");
    return std::asin(sine);
}

/// Drag of one of so many parts of a payload.
void share_drag(const Payload& whole, double count, Payload& part) {
    if (whole.drag_area) part.drag_area = *whole.drag_area / count;
    if (const auto& table = whole.drag_area_table) {
        std::vector<double> area = table->area();
        for (double& x : area)
            x /= count;
        part.drag_area_table.emplace(table->file(), table->angle(), std::move(area));
    }
}

}  // namespace

double outward_lean(const Scene& scene) {
    if (scene.parachutes.front().count == 1) return 0.0;
    return lean_of(scene, upright_mesh(scene_of_canopy(scene, 0)));
}

Scene scene_of_canopy(const Scene& scene, int k) {
    Scene one = scene;
    Parachute& chute = one.parachutes.front();
    const double count = chute.count;
    one.payload.mass /= count;
    share_drag(scene.payload, count, one.payload);
    chute.lag =
        chute.lag.empty() ? std::vector<double>{} : std::vector{chute.lag[static_cast<std::size_t>(k)]};
    if (k < chute.skips_reefing) chute.reefing.clear();
    chute.skips_reefing = 0;
    chute.count = 1;
    // Far apart, so that runs of neighbouring seeds have no canopy in common.
    if (one.full.noise) one.full.noise->seed += 0x9E3779B97F4A7C15u * static_cast<std::uint64_t>(k);
    return one;
}

bool has_stages(const Scene& scene) {
    return scene.parachutes.size() > 1 || scene.parachutes.front().deploy_when ||
           scene.parachutes.front().cut;
}

Scene scene_in_flight(const Scene& scene, std::size_t parachute, const PayloadFlight& at) {
    Scene one = scene;
    one.parachutes = {scene.parachutes[parachute]};
    one.parachutes.front().deploy_when.reset();
    one.parachutes.front().cut.reset();
    one.payload.mass = at.mass;
    const Vec3& v = at.velocity;
    one.release.altitude = at.position.z();
    one.release.speed = v.norm();
    one.release.path_angle = std::atan2(-v.z(), std::hypot(v.x(), v.y()));
    if (std::hypot(v.x(), v.y()) > 0.0) one.release.heading = std::atan2(v.x(), v.y());
    one.release.time = at.time;
    one.release.east = at.position.x();
    one.release.north = at.position.y();
    if (at.body) one.release.attitude = at.body->attitude;
    // As in scene_of_canopy: no canopy of one run is that of a neighbouring seed.
    if (one.full.noise) one.full.noise->seed += 0x9E3779B97F4A7C15u * parachute;
    return one;
}

Cluster::Cluster(const Scene& scene, const Simulation::LayoutMaker& layout, int threads)
    : scene_(scene),
      make_layout_(layout),
      staged_(has_stages(scene)),
      alone_(released_payload(scene)),
      step_to_(alone_),
      moments_(staged_ ? moments_of_payload(scene) : std::nullopt),
      payload_mass_(alone_.mass),
      tuner_(std::min(threads, canopies_of(scene))) {
    const int count = scene.parachutes.front().count;
    if (tuner_.most() > 1) threads_ = std::make_unique<WorkerPool>(tuner_.most() - 1);
    if (staged_) return;
    if (count == 1) {
        scenes_.push_back(&scene);
        canopies_.push_back(std::make_unique<Simulation>(scene, layout));
        out_.push_back(0);
        return;
    }
    add_canopies(scene);
}

/// All canopies of the first parachute of a scene, side by side where there are several.
void Cluster::add_canopies(const Scene& scene) {
    const int count = scene.parachutes.front().count;
    std::vector<std::unique_ptr<Scene>> scenes;
    std::vector<std::unique_ptr<Simulation>> canopies;
    Vec3 axis = Vec3::UnitZ();
    double lean = 0.0;
    if (count > 1) {
        const Mesh upright = upright_mesh(scene_of_canopy(scene, 0));
        lean = lean_of(scene, upright);
        axis = upright.axis;
    }
    for (int k = 0; k < count; ++k) {
        scenes.push_back(std::make_unique<Scene>(scene_of_canopy(scene, k)));
        canopies.push_back(
            std::make_unique<Simulation>(*scenes.back(), make_layout_, force_blocks(),
                                         count > 1 ? leaning(lean, static_cast<std::size_t>(k), count, axis)
                                                   : Eigen::Quaterniond::Identity()));
        if (count > 1) canopies.back()->meet_others(contact_frequency(canopies.back()->mesh()));
    }
    const std::size_t first = size();
    for (std::size_t k = 0; k < canopies.size(); ++k) {
        out_.push_back(size());
        scenes_.push_back(scenes[k].get());
        made_.push_back(std::move(scenes[k]));
        canopies_.push_back(std::move(canopies[k]));
    }
    for (std::size_t i = first; i < size(); ++i)
        for (std::size_t j = i + 1; j < size(); ++j)
            planes_.emplace_back(i, j);
    has_new_planes_ = true;
}

PayloadFlight Cluster::payload() const {
    if (out_.empty()) return alone_;
    const NodeRecord& node = front().payload();
    PayloadFlight whole{time(), to_vec3(node.x), to_vec3(node.v), payload_mass_};
    whole.body = front().system().body;
    if (whole.body) whole.body->momentum *= static_cast<double>(out_.size());
    return whole;
}

/// One of `count` even parts of a payload, but for the mass of its node.
PayloadPart Cluster::part_of(const PayloadFlight& payload, double count) const {
    PayloadPart part{0.0, payload.velocity};
    if (!moments_) return part;
    part.moments = *moments_ / count;
    part.body = BodyState{payload.body->attitude};
    part.body->momentum = part.body->half_momentum = payload.body->momentum / count;
    return part;
}

bool Cluster::was_checked() const {
    return out_.empty() ? checked_alone_ : front().was_checked();
}

std::size_t Cluster::join(std::size_t parachute, double left) {
    const std::int64_t step = out_.empty() ? steps_before_ : this->step();
    const PayloadFlight now = payload();
    const std::size_t first = size();
    auto scene = std::make_unique<Scene>(scene_in_flight(scene_, parachute, now));
    scene->payload.mass = left;
    add_canopies(*scene);
    departures_.push_back({parachute, first, std::move(scene)});
    payload_mass_ = left;
    for (std::size_t k = first; k < size(); ++k) {
        members_.push_back(
            {departures_.size() - 1, canopies_[k]->payload_node_mass() - made_[k]->payload.mass});
        canopies_[k]->begin_at(now.position, part_of(now, 1.0), step);
    }
    if (out_.size() == 1 && !moments_) {
        front().evaluate_forces();
        return first;
    }
    // A mortar throws the payload back, with what all others carry of their risers, and turns a body.
    PayloadFlight thrown = now;
    for (std::size_t k = first; k < size(); ++k) {
        const Simulation& canopy = *canopies_[k];
        const Vec3 more = to_vec3(canopy.payload().v) - now.velocity;
        thrown.velocity += canopy.payload_node_mass() / payload_nodes_mass() * more;
        if (thrown.body)
            thrown.body->momentum +=
                canopy.payload_node_mass() * (canopy.riser_end() - now.position).cross(more);
    }
    share_payload(thrown);
    return first;
}

void Cluster::settle(std::size_t first, const std::function<bool()>& stop) {
    const int count = scene_of_all(first).parachutes.front().count;
    double widest = 0.0;
    for (std::size_t k = first; k < first + static_cast<std::size_t>(count); ++k) {
        Simulation& canopy = *canopies_[k];
        canopy.settle(stop);
        for (const NodeRecord& node : canopy.canopy_nodes().node)
            widen(widest, to_vec3(node.x) - canopy.pivot(), canopy.mesh().axis);
    }
    if (count > 1) {  // under load they are wider than they were made
        const Vec3 axis = trailing_direction(scene_of_all(first));
        const double sine = std::min(sine_of_lean(widest, count), widest_lean);
        for (std::size_t k = first; k < first + static_cast<std::size_t>(count); ++k)
            canopies_[k]->turn_to(leaning(std::asin(sine), number(k), count, axis));
    }
    for (std::size_t k = first; staged_ && k < first + static_cast<std::size_t>(count); ++k)
        canopies_[k]->evaluate_forces();  // nobody else does at this instant
}

void Cluster::leave(std::size_t first) {
    const PayloadFlight now = payload();
    steps_before_ = step();
    std::erase_if(out_, [&](std::size_t k) { return members_[k].departure == members_[first].departure; });
    if (!out_.empty()) return share_payload(now);
    alone_ = now;
    alone_.acceleration = free_acceleration(scene_, now);
    step_to_ = alone_;
}

/// [kg] of all nodes of the payload: it, its packs, and what they carry of the risers.
double Cluster::payload_nodes_mass() const {
    double mass = payload_mass_;
    for (const std::size_t k : out_)
        mass += members_[k].riser_mass;
    return mass;
}

/// An even share of the payload, with all that it carries, for each that is out. Nodes that are to move as
/// one under even forces have to weigh the same.
void Cluster::share_payload(const PayloadFlight& payload) {
    const auto count = static_cast<double>(out_.size());
    PayloadPart part = part_of(payload, count);
    part.node_mass = payload_nodes_mass() / count;
    for (const std::size_t k : out_) {
        made_[k]->payload.mass = payload_mass_ / count;
        share_drag(scene_.payload, count, made_[k]->payload);
        members_[k].parts = count;
        canopies_[k]->bear(part);
    }
}

/// work(canopy) for each that is out. What it reads of others it must not write.
template <class Work>
void Cluster::for_each(Work&& work) {
    const auto one = [&](int k) { work(*canopies_[out_[static_cast<std::size_t>(k)]]); };
    const auto count = static_cast<int>(out_.size());
    if (threads_ && count > 1 && tuner_.now() > 1) return threads_->share(count, one);
    for (int k = 0; k < count; ++k)
        one(k);
}

void Cluster::evaluate_forces() {
    tuner_.begin_step();
    for_each([](Simulation& canopy) { canopy.evaluate_forces(); });
}

void Cluster::push_apart() {
    if (planes_.empty()) return;
    const SystemState& now = front().system();
    const bool searches =
        std::exchange(has_new_planes_, false) || now.step % CanopyPlane::steps_between_searches == 0;
    for (CanopyPlane& plane : planes_) {
        if (!is_out(plane.first())) continue;  // cut, both of them
        Simulation &a = *canopies_[plane.first()], &b = *canopies_[plane.second()];
        if (searches)
            plane.search(a.canopy_nodes(), b.canopy_nodes(), CanopyPlane::steps_between_searches * now.dt,
                         near_share * scenes_[plane.first()]->parachutes.front().nominal_diameter);
        if (!plane.may_touch()) continue;
        Touching &of_a = touching_[0], &of_b = touching_[1];
        const PressedNodes nodes_a = a.canopy_nodes(plane.near_first(), of_a.node, of_a.mass),
                           nodes_b = b.canopy_nodes(plane.near_second(), of_b.node, of_b.mass);
        of_a.force.assign(of_a.node.size(), splat(0.0));
        of_b.force.assign(of_b.node.size(), splat(0.0));
        const PlaneContact contact = press_apart(nodes_a, nodes_b, of_a.force, of_b.force);
        plane.note(contact);
        if (!(contact.force > 0.0)) continue;
        a.push_canopy(plane.near_first(), of_a.node, of_a.force, contact.on_first);
        b.push_canopy(plane.near_second(), of_b.node, of_b.force, contact.on_second);
        a.push_payload(contact.on_payload);
    }
}

/// The mean of one force on the payload over all canopies that are out.
template <class Force>
Lanes Cluster::mean_of(Force&& force) const {
    Lanes sum = splat(0.0);
    for (std::size_t i = 0; i < out_.size(); ++i)
        sum += force(i);
    return sum / splat(static_cast<double>(out_.size()));
}

void Cluster::share_pulls(double kick, int subcycles) {
    const Lanes mean = mean_of([&](std::size_t i) { return canopies_[out_[i]]->payload_load(); });
    const Vec3 torque =
        to_vec3(mean_of([&](std::size_t i) { return to_lanes(canopies_[out_[i]]->payload_torque()); }));
    for (const std::size_t k : out_) {
        Simulation& canopy = *canopies_[k];
        const double power = sum3((mean - canopy.payload_load()) * canopy.payload().v) +
                             (torque - canopy.payload_torque()).dot(canopy.payload_spin());
        canopy.add_outer_work(kick * power, power / subcycles);
        canopy.payload_load() = mean;
        canopy.set_payload_torque(torque);
    }
}

void Cluster::fly_alone(double end) {
    checked_alone_ = steps_alone_ % Simulation::steps_between_checks == 0;
    ++steps_alone_;
    const double next_row = alone_.time + 1.0 / scene_.full.row_rate();
    try {
        if (alone_.time >= step_to_.time)
            step_to_ = fly_free(scene_, alone_, std::min(end, alone_.time + step_of_free_flight), watch_);
        const double next = std::min(next_row, end);
        alone_ = next < step_to_.time - one_moment ? fly_free(scene_, alone_, next) : step_to_;
    } catch (const std::runtime_error& failure) {
        fault_alone_ = RunStatus{StatusCode::solver_failed,
                                 fmt::format("the payload's flight without a canopy from t = {:.4g} s: {}",
                                             alone_.time, failure.what())};
        checked_alone_ = true;  // nothing would come of another step
    }
}

void Cluster::step_to(double end) {
    if (out_.empty()) return fly_alone(end);
    if (out_.size() == 1) return front().step_to(end);
    push_apart();
    ChosenStep chosen{infinity, 1};
    for_each([](Simulation& canopy) { canopy.choose_step(); });
    for (const std::size_t k : out_) {
        const ChosenStep own = canopies_[k]->step();
        chosen.dt = std::min(chosen.dt, own.dt);
        chosen.subcycles = std::max(chosen.subcycles, own.subcycles);
    }
    rest_.clear();
    for (const std::size_t k : out_)
        rest_.push_back(canopies_[k]->payload_load());
    for_each([&](Simulation& canopy) { canopy.begin_step(chosen, end); });
    const int count = chosen.subcycles;
    for (std::size_t i = 0; i < out_.size(); ++i)
        rest_[i] = count == 1 ? splat(0.0) : rest_[i] - canopies_[out_[i]]->payload_load();
    const Lanes mean_rest = mean_of([&](std::size_t i) { return rest_[i]; });
    const Lanes mean_drag = mean_of([&](std::size_t i) { return canopies_[out_[i]]->payload_drag(); });
    for (std::size_t i = 0; i < out_.size(); ++i)
        canopies_[out_[i]]->payload_drag() = mean_drag + (mean_rest - rest_[i]);

    const double dt = front().step_under_way().dt;
    const auto kick_of = [&](int k) {
        const SystemState& s = front().system();
        return count == 1 ? 0.5 * (dt + s.dt) : subcycle(s, dt, count, k).kick;
    };
    share_pulls(kick_of(0), count);
    // As Layout::move; what one canopy does before the next pulls are shared goes together.
    for (int k = 1; k <= count; ++k) {
        for_each([&](Simulation& canopy) {
            if (k == 1) canopy.impulse();
            if (count > 1) canopy.drift(k - 1);
            if (k < count)
                canopy.pull(k);
            else
                canopy.end_step();
        });
        if (k < count) share_pulls(kick_of(k), count);
    }
    // To the last bit: the rest of the loads came by way of a difference.
    for (const std::size_t k : out_)
        if (k != out_.front()) canopies_[k]->follow_payload_of(front());
}

std::size_t Cluster::last_to_open(std::size_t first, std::size_t count) const {
    std::size_t last = first;
    for (std::size_t k = first + 1; k < first + count; ++k)
        if (canopies_[k]->full_open() > canopies_[last]->full_open()) last = k;
    return last;
}

void Cluster::start_anew_but(std::size_t changed) {
    for (const std::size_t k : out_)
        if (k != changed) canopies_[k]->start_anew();
}

EnergyLedger Cluster::ledger() const {
    if (canopies_.empty()) return {};
    EnergyLedger sum = canopies_.front()->ledger();
    if (size() == 1) return sum;
    for (std::size_t k = 1; k < size(); ++k) {
        const EnergyLedger one = canopies_[k]->ledger();
        for (auto part : {&EnergyLedger::kinetic, &EnergyLedger::elastic, &EnergyLedger::gravity_work,
                          &EnergyLedger::drag_work, &EnergyLedger::damping, &EnergyLedger::added_mass,
                          &EnergyLedger::ramp, &EnergyLedger::external_work, &EnergyLedger::air_loss})
            sum.*part += one.*part;
    }
    const double scale = std::abs(sum.drag_work);
    sum.residual_fraction = scale > 0.0 ? residual(sum) / scale : 0.0;
    return sum;
}

LargestLoads Cluster::largest_loads(std::size_t first, std::size_t count) const {
    LargestLoads most;
    for (std::size_t k = first; k < first + count; ++k) {
        most.add_tension(canopies_[k]->largest_loads().line_tension);
        most.add_stress(canopies_[k]->largest_loads().fabric_stress);
    }
    return most;
}

std::int64_t Cluster::element_steps() const {
    std::int64_t sum = 0;
    for (const auto& canopy : canopies_)
        sum += canopy->element_steps();
    return sum;
}

std::vector<BlockCost> Cluster::block_costs() const {
    if (canopies_.empty()) return {};
    std::vector<BlockCost> sum = canopies_.front()->block_costs();
    for (std::size_t k = 1; k < size(); ++k)
        for (const BlockCost& one : canopies_[k]->block_costs()) {
            const auto same = std::ranges::find(sum, one.name, &BlockCost::name);
            if (same == sum.end())
                sum.push_back(one);
            else
                same->seconds += one.seconds;
        }
    return sum;
}

std::string Cluster::name_of(std::size_t k) const {
    const Parachute& chute = scene_of_all(k).parachutes.front();
    std::string name = is_of_several() ? chute.name : "";
    if (chute.count > 1) name += fmt::format("{}canopy {}", name.empty() ? "" : ", ", number(k) + 1);
    return name;
}

std::optional<RunStatus> Cluster::of_first(
    const std::function<std::optional<RunStatus>(std::size_t)>& fault) const {
    if (out_.empty()) return fault_alone_;
    for (const std::size_t k : out_)
        if (auto found = fault(k)) {
            if (const std::string name = name_of(k); !name.empty())
                found->detail = fmt::format("{}: {}", name, found->detail);
            return found;
        }
    return std::nullopt;
}
std::optional<RunStatus> Cluster::fault() const {
    return of_first([&](std::size_t k) { return canopies_[k]->fault(); });
}
std::optional<RunStatus> Cluster::find_fault() {
    return of_first([&](std::size_t k) { return canopies_[k]->find_fault(); });
}

/// Writes the members of a scene with stages, or makes them: where they are read nobody has yet.
void Cluster::serialize_members(Archive& archive) {
    archive.number("payload's mass", payload_mass_);
    for (PayloadFlight* flight : {&alone_, &step_to_}) {
        for (double* x : {&flight->time, &flight->mass})
            archive.number("payload alone", *x);
        for (Vec3* vector : {&flight->position, &flight->velocity, &flight->acceleration})
            for (double& x : *vector)
                archive.number("payload alone", x);
        if (!moments_) continue;
        for (double& x : flight->body->attitude)
            archive.number("payload's attitude", x);
        for (double& x : flight->body->momentum)
            archive.number("payload's angular momentum", x);
    }
    archive.whole("steps alone", steps_alone_, 0);
    archive.whole("steps before", steps_before_, 0);
    archive.flag("checked", checked_alone_);
    std::size_t count = departures_.size();
    archive.whole("parachutes that have left their packs", count, 0, scene_.parachutes.size());
    if (archive.reads()) out_.clear();
    for (std::size_t d = 0; d < count; ++d) {
        std::size_t parachute = archive.reads() ? 0 : departures_[d].parachute;
        archive.whole("parachute", parachute, 0, scene_.parachutes.size() - 1);
        if (archive.reads())
            departures_.push_back(
                {parachute, size(), std::make_unique<Scene>(scene_in_flight(scene_, parachute, {}))});
        const std::size_t first = departures_[d].first;
        Scene& all = *departures_[d].scene;
        for (double* x :
             {&all.release.altitude, &all.release.speed, &all.release.path_angle, &all.release.heading,
              &all.release.time, &all.release.east, &all.release.north, &all.payload.mass})
            archive.number("parachute", *x);
        if (moments_ && archive.reads()) all.release.attitude.emplace();
        if (moments_)
            for (double& x : *all.release.attitude)
                archive.number("payload's attitude", x);
        if (archive.reads()) add_canopies(all);
        for (std::size_t k = first; k < first + static_cast<std::size_t>(all.parachutes.front().count); ++k) {
            if (archive.reads()) members_.push_back({d});
            Member& member = members_[k];
            Payload& payload = made_[k]->payload;
            double node_mass = canopies_[k]->payload_node_mass();
            bool out = is_out(k);
            for (double* x : {&member.riser_mass, &member.parts, &node_mass, &payload.mass})
                archive.number("canopy", *x);
            archive.flag("is out", out);
            if (!archive.reads()) continue;
            share_drag(scene_.payload, member.parts, payload);
            PayloadPart part = part_of(alone_, member.parts);
            part.node_mass = node_mass;
            canopies_[k]->weigh_payload(part);
            if (!out) std::erase(out_, k);
        }
    }
}

void Cluster::serialize(Archive& archive) {
    if (staged_) serialize_members(archive);
    for (const auto& canopy : canopies_)
        canopy->serialize(archive);
    for (CanopyPlane& plane : planes_)
        plane.serialize(archive, {canopies_[plane.first()]->mesh().canopy_nodes,
                                  canopies_[plane.second()]->mesh().canopy_nodes});
    if (archive.reads()) has_new_planes_ = false;
}

}  // namespace twinchute::fullsim
