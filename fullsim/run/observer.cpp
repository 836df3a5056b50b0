#include "fullsim/run/observer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "fullsim/body.hpp"
#include "fullsim/forces/blocks.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double filter_window = 5e-3;  // [s]

/// Signed angle from a to b about the axis, to both of which they are normal [rad].
double angle_about(const Vec3& axis, const Vec3& a, const Vec3& b) {
    return std::atan2(a.cross(b).dot(axis), a.dot(b));
}

/// Turns of the tangent along a closed polygon, seen along the axis: 1 where it does not cross itself (Hopf).
double tangent_turns(const State& state, const std::vector<NodeIndex>& ring, const Vec3& axis) {
    std::optional<Vec3> first, last;
    double angle = 0.0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec3 along =
            to_vec3(state.node[ring[(k + 1) % ring.size()]].x) - to_vec3(state.node[ring[k]].x);
        const Vec3 across = along - along.dot(axis) * axis;
        if (!(across.squaredNorm() > 0.0)) continue;  // several lines may share a node
        if (last) angle += angle_about(axis, *last, across);
        if (!first) first = across;
        last = across;
    }
    if (first) angle += angle_about(axis, *last, *first);
    return std::round(angle / (2.0 * pi));
}

/// Turns of a closed polygon about its centre, and the way [rad] that it goes back on it, in loops.
struct Winding {
    double turns = 0.0, back = 0.0;
};

Winding winding_of(const State& state, const std::vector<NodeIndex>& ring, const Vec3& centre,
                   const Vec3& axis) {
    double forth = 0.0, back = 0.0;
    const auto arm = [&](std::size_t k) {
        const Vec3 from_centre = to_vec3(state.node[ring[k % ring.size()]].x) - centre;
        return Vec3(from_centre - from_centre.dot(axis) * axis);
    };
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const double angle = angle_about(axis, arm(k), arm(k + 1));
        (angle > 0.0 ? forth : back) += std::abs(angle);
    }
    return {std::round((forth - back) / (2.0 * pi)), std::min(forth, back)};
}

/// A loop of a gore or two leaves the canopy a canopy: it goes back by less than this [rad].
constexpr double small_loop = 0.25 * pi;

/// [N/m] of the sheets; none where one of them has none.
std::vector<double> strengths_of(const Mesh& mesh) {
    std::vector<double> strengths;
    for (int sheet = 0; sheet < mesh.sheets(); ++sheet) {
        const std::optional<double>& strength = mesh.fabric_of(sheet).strength;
        if (!strength) return {};
        strengths.push_back(*strength);
    }
    return strengths;
}

}  // namespace

CanopyShape canopy_shape(const State& state, const Mesh& mesh, int sectors) {
    const auto centre_of = [&](const std::vector<NodeIndex>& ring) {
        Vec3 sum = Vec3::Zero();
        for (const NodeIndex i : ring)
            sum += to_vec3(state.node[i].x);
        return Vec3(sum / static_cast<double>(ring.size()));
    };
    const Vec3 vent = centre_of(mesh.seam_rings.front()), skirt = centre_of(mesh.seam_rings.back());
    // A vent that is held down may be as low as the skirt.
    const Vec3 up = mesh.vent_held_down ? Vec3(skirt - to_vec3(state.node[mesh.payload()].x)) : vent - skirt;
    const Vec3 axis = up.normalized();
    const Winding winding = winding_of(state, mesh.seam_rings.back(), skirt, axis);
    CanopyShape shape{
        0.0, mesh.vent_held_down ? 0.0 : (vent - skirt).norm(),
        winding.back < small_loop ? winding.turns : tangent_turns(state, mesh.seam_rings.back(), axis)};
    for (const auto& ring : mesh.seam_rings) {
        const Vec3 centre = centre_of(ring);
        if (mesh.vent_held_down) shape.depth = std::max(shape.depth, (centre - skirt).dot(axis));
        double sum = 0.0;
        const std::size_t unlike = ring.size() / static_cast<std::size_t>(sectors);
        for (const NodeIndex i : std::span(ring).first(unlike)) {
            const Vec3 arm = to_vec3(state.node[i].x) - centre;
            sum += (arm - arm.dot(axis) * axis).norm();
        }
        shape.seam_diameter = std::max(shape.seam_diameter, 2.0 * sum / static_cast<double>(unlike));
    }
    return shape;
}

double stress_p90(const State& state, const Mesh& mesh, std::span<const MembraneLaw> laws, double found,
                  int sectors, std::span<const double> strengths) {
    const double weakest = strengths.empty() ? 1.0 : std::ranges::min(strengths);
    if (!(state.largest.last_stress > found * weakest)) return found;
    const auto triangles =
        std::span(mesh.triangles).first(mesh.triangles.size() / static_cast<std::size_t>(sectors));
    struct Stressed {
        double stress, area;
    };
    std::vector<Stressed> above;
    double whole = 0.0, stressed = 0.0;
    const std::vector<double> stresses = first_stresses(triangles, laws, state);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const double unit = strengths.empty() ? 1.0 : strengths[static_cast<std::size_t>(triangles[i].sheet)];
        const double area = triangles[i].area(), stress = state.fe_weight * stresses[i] / unit;
        whole += area;
        if (!(stress > found)) continue;
        above.push_back({stress, area});
        stressed += area;
    }
    // The lowest first, until no more than 10 % of the area is stressed higher.
    std::ranges::sort(above, {}, &Stressed::stress);
    for (const Stressed& next : above) {
        if (stressed <= 0.1 * whole) break;
        found = next.stress;
        stressed -= next.area;
    }
    return found;
}

CordTensions cord_tensions(const State& state, const Mesh& mesh, const CordTensions& found) {
    CordTensions most = found;
    for (std::size_t c = 0; c < mesh.cables.size(); ++c) {
        const Cable& cable = mesh.cables[c];
        if (!is_tape(cable.kind) && cable.kind != CableKind::vent_line) continue;
        const bool reefs = cable.kind == CableKind::skirt && std::ranges::binary_search(mesh.reefing_line, c);
        for (std::size_t k = 0; k < most.size(); ++k)
            if (cord_groups[k].kind == cable.kind && cord_groups[k].reefs == reefs)
                most[k] = std::max(most[k], strand_tension(state, mesh, cable));
    }
    return most;
}

void thin_out(std::vector<Channel>& channels, double output_rate) {
    if (channels.empty()) return;
    const std::vector<double>& time = channels.front().values;
    std::vector<std::size_t> kept;
    double next = -1.0;
    for (std::size_t i = 0; i < time.size(); ++i) {
        const double interval = std::floor(time[i] * output_rate + 1e-9);
        if (interval < next && i + 1 < time.size()) continue;
        next = interval + 1.0;
        kept.push_back(i);
    }
    for (Channel& channel : channels) {
        std::vector<double> values;
        for (const std::size_t i : kept)
            values.push_back(channel.values[i]);
        channel.values = std::move(values);
    }
}

HistoryRow row_of_all(std::span<const HistoryRow> rows) {
    HistoryRow all = rows.front();
    const auto count = static_cast<double>(rows.size());
    for (const HistoryRow& row : rows.subspan(1)) {
        for (auto sum :
             {&HistoryRow::force_raw, &HistoryRow::drag_area, &HistoryRow::projected_area,
              &HistoryRow::signed_area, &HistoryRow::added_mass, &HistoryRow::volume, &HistoryRow::mouth_area,
              &HistoryRow::dynamic_pressure, &HistoryRow::pressure, &HistoryRow::airspeed,
              &HistoryRow::seam_diameter, &HistoryRow::depth, &HistoryRow::inflow_ratio})
            all.*sum += row.*sum;
        if (std::abs(row.turns - 1.0) > std::abs(all.turns - 1.0)) all.turns = row.turns;
        all.stress_p90 = std::max(all.stress_p90, row.stress_p90);
        all.utilisation_p90 = std::max(all.utilisation_p90, row.utilisation_p90);
        for (std::size_t k = 0; k < all.tension.size(); ++k)
            all.tension[k] = std::max(all.tension[k], row.tension[k]);
    }
    for (auto mean : {&HistoryRow::dynamic_pressure, &HistoryRow::pressure, &HistoryRow::airspeed,
                      &HistoryRow::seam_diameter, &HistoryRow::depth, &HistoryRow::inflow_ratio})
        all.*mean /= count;
    return all;
}

Observer::Observer(const Mesh& mesh, double gravity, double output_rate, int sectors, int payload_parts)
    : mesh_(mesh),
      laws_(membrane_laws(mesh, 0.0)),
      sectors_(sectors),
      gravity_(gravity),
      interval_(1.0 / output_rate),
      payload_mass_(payload_parts * mesh.mass[mesh.payload()]),
      force_(filter_window),
      acceleration_(filter_window),
      opening_(filter_window) {
    rows_.reserve(4096);
    if (mesh.sheets() > 1) strengths_ = strengths_of(mesh);
}

void Observer::observe(const SystemState& state, const Vec3& payload_force) {
    const double raw = state.riser_force.norm();
    const MeanForce pull = mean_riser_force(state);
    const double mean = pull.value.norm();
    const Vec3 others = payload_force - state.riser_force;
    const Vec3 load = others + pull.value;
    // The payload node also carries half a riser element.
    const Vec3 acceleration = load / payload_mass_ - gravity_ * Vec3::UnitZ();
    force_.push(pull.time, mean);
    note_growth({state.air.projected_area, state.time});
    acceleration_.push(pull.time, acceleration.norm());
    Extremes& most = extremes_;
    Peak& raw_most = state.time >= most.peak_from ? most.raw_peak : most.snatch_peak;
    if (raw > raw_most.value) raw_most = {raw, state.time};
    if (pull.time >= most.peak_from) {  // the step lies within the interval
        if (mean > raw_most.value) raw_most = {mean, pull.time};
        opening_.push(pull.time, mean);
        most.peak = opening_.peak();
    }
    // As forces: raw until the peak counts, then filtered.
    if (state.time < most.peak_from)
        most.acceleration =
            std::max(most.acceleration, (payload_force / payload_mass_ - gravity_ * Vec3::UnitZ()).norm());
    if (force_.ready()) {
        most.acceleration = std::max(most.acceleration, acceleration_.value());
        settle_rows();
    }
}

void Observer::add_row(const State& state) {
    const NodeRecord& payload = state.node[mesh_.payload()];
    const CanopyShape shape = canopy_shape(state, mesh_, sectors_);
    HistoryRow row{};
    row.time = state.time;
    row.position = to_vec3(payload.x);
    row.velocity = to_vec3(payload.v);
    row.force_raw = state.riser_force.norm();
    row.drag_area = state.air.drag_area;
    row.dynamic_pressure = state.air.dynamic_pressure;
    row.pressure = state.air.pressure;
    row.airspeed = state.air.airspeed;
    row.projected_area = state.air.projected_area;
    row.signed_area = state.air.signed_area;
    row.added_mass = state.added_mass;
    row.seam_diameter = shape.seam_diameter;
    row.depth = shape.depth;
    row.turns = shape.turns;
    row.density = state.air.density;
    row.volume = state.inflow.volume;
    row.mouth_area = state.inflow.mouth;
    row.inflow_ratio = state.inflow.ratio;
    row.stress_p90 = stress_p90(state, mesh_, laws_, rows_.empty() ? 0.0 : rows_.back().stress_p90, sectors_);
    row.tension = cord_tensions(state, mesh_, rows_.empty() ? CordTensions{} : rows_.back().tension);
    row.utilisation_p90 = 0.0;
    if (!strengths_.empty())
        row.utilisation_p90 = stress_p90(
            state, mesh_, laws_, rows_.empty() ? 0.0 : rows_.back().utilisation_p90, sectors_, strengths_);
    if (state.body) row.tilt = tilt(body_axis(*state.body, principal_axes(mesh_.body->lumped)));
    add_row(row);
}

void Observer::add_row(const HistoryRow& row) {
    if (row_is_due(row.time)) next_row_ = interval_ * (std::floor(row.time / interval_ + 1e-9) + 1.0);
    rows_.push_back(row);
    rows_.back().impulse = force_.integral_until(row.time);
}

void Observer::note_growth(Peak area) {
    const Peak before = std::exchange(area_, area);
    if (growth_.empty()) return growth_.push_back({area, area});
    if (!(area.value > growth_.back().now.value)) return;
    const bool little =
        growth_.size() > 1 && growth_.back().now.value < 1.001 * growth_[growth_.size() - 2].now.value;
    if (little) growth_.pop_back();
    growth_.push_back({before, area});
}

void Observer::settle_rows() {
    for (; unsettled_ < rows_.size() && rows_[unsettled_].time <= force_.centre(); ++unsettled_) {
        rows_[unsettled_].force = force_.value();
        rows_[unsettled_].acceleration = acceleration_.value();
    }
}

void Observer::finish() {
    // The last half window has only its past, and a run that is shorter than that no average but that of all
    // of it.
    const auto last = [&](const MovingAverage& average) {
        return average.ready() ? average.value() : average.so_far();
    };
    if (!acceleration_.ready()) extremes_.acceleration = acceleration_.so_far();
    for (; unsettled_ < rows_.size(); ++unsettled_) {
        rows_[unsettled_].force = last(force_);
        rows_[unsettled_].acceleration = last(acceleration_);
    }
    if (sound_) extremes_.peak = opening_.end();
}

double Observer::largest_force() const {
    const double peak = std::max(largest_peak().value, snatch_peak().value);
    return peak > 0.0 ? peak : std::ranges::max(rows_, {}, &HistoryRow::force).force;
}

void Observer::forget() {
    sound_ = false;
    // The first row is the scene's own start and stays: a record has at least one.
    rows_.resize(std::max<std::size_t>(1, accepted_.rows));
    unsettled_ = std::min(accepted_.unsettled, rows_.size());
    extremes_ = accepted_.extremes;
    while (!growth_.empty() && growth_.back().now.time > accepted_.time)
        growth_.pop_back();
    for (; unsettled_ < rows_.size(); ++unsettled_) {
        // Their filter ran on into what is dropped.
        rows_[unsettled_].force = rows_[unsettled_].force_raw;
        rows_[unsettled_].acceleration = unsettled_ > 0 ? rows_[unsettled_ - 1].acceleration : 0.0;
    }
}

double Observer::turns_since(double time) const {
    double furthest = 1.0;
    for (auto row = rows_.rbegin(); row != rows_.rend() && row->time >= time; ++row)
        if (std::abs(row->turns - 1.0) > std::abs(furthest - 1.0)) furthest = row->turns;
    return furthest;
}

bool Observer::crosses_itself(double seconds) const {
    const double begin = rows_.back().time - seconds;
    return std::all_of(rows_.rbegin(), rows_.rend(),
                       [&](const HistoryRow& row) { return row.time < begin || row.turns != 1.0; });
}

double Observer::mean(double HistoryRow::*column, double seconds) const {
    double integral = 0.0;
    std::size_t i = rows_.size() - 1;
    const double begin = rows_.back().time - seconds - 1e-9;
    for (; i > 0 && rows_[i - 1].time >= begin; --i)
        integral += 0.5 * (rows_[i].time - rows_[i - 1].time) * (rows_[i].*column + rows_[i - 1].*column);
    const double span = rows_.back().time - rows_[i].time;
    return span > 0.0 ? integral / span : rows_.back().*column;
}

double Observer::impulse_until(double time) const {
    const auto next = std::ranges::upper_bound(rows_, time, {}, &HistoryRow::time);
    if (next == rows_.begin()) return rows_.front().impulse;
    const HistoryRow& a = *std::prev(next);
    if (next == rows_.end()) return a.impulse;
    // Between rows as if the force were linear; what it is not, evenly.
    const double after = time - a.time, interval = next->time - a.time, share = after / interval;
    const double curved = next->impulse - a.impulse - 0.5 * interval * (a.force + next->force);
    return a.impulse + after * (a.force + 0.5 * share * (next->force - a.force)) + share * curved;
}

std::optional<double> Observer::first_time_of_area(double area) const {
    const auto found = std::ranges::find_if(growth_, [=](const Growth& g) { return g.now.value >= area; });
    if (found == growth_.end()) return std::nullopt;
    if (found == growth_.begin()) return found->now.time;
    const auto reached = [=](const Peak& a, const Peak& b) {
        return std::lerp(a.time, b.time, (area - a.value) / (b.value - a.value));
    };
    return area > found->before.value ? reached(found->before, found->now)
                                      : reached(std::prev(found)->now, found->before);
}

void Observer::serialize_extremes(Archive& archive, Extremes& most) {
    const auto members = [](Peak& peak, auto&& each) { each(peak.value), each(peak.time); };
    auto& [peak, raw_peak, snatch_peak, earlier, peak_from, acceleration] = most;
    for (Peak* of : {&peak, &raw_peak, &snatch_peak})
        archive.row("peak", *of, members);
    archive.rows("earlier peaks", earlier, members);
    archive.number("peak counts from", peak_from);
    archive.number("largest acceleration", acceleration);
}

void Observer::serialize(Archive& archive) {
    archive.number("next row", next_row_);
    archive.rows("rows", rows_, [](HistoryRow& row, auto&& each) {
        auto& [time, position, velocity, force, force_raw, acceleration, drag_area, dynamic_pressure,
               pressure, airspeed, projected_area, signed_area, added_mass, seam_diameter, depth, turns,
               density, volume, mouth_area, inflow_ratio, stress_p90, utilisation_p90, tension, tilt,
               impulse] = row;
        each(position), each(velocity);
        for (double* x :
             {&time,       &force,           &force_raw,      &acceleration, &drag_area,  &dynamic_pressure,
              &pressure,   &airspeed,        &projected_area, &signed_area,  &added_mass, &seam_diameter,
              &depth,      &turns,           &density,        &volume,       &mouth_area, &inflow_ratio,
              &stress_p90, &utilisation_p90, &tilt,           &impulse})
            each(*x);
        for (double& of_group : tension)
            each(of_group);
    });
    archive.whole("unsettled", unsettled_, 0, rows_.size());
    force_.serialize(archive);
    acceleration_.serialize(archive);
    opening_.serialize(archive);
    const auto both = [](Peak& area, auto&& each) { each(area.value), each(area.time); };
    archive.row("area", area_, both);
    archive.rows("growth", growth_, [&](Growth& g, auto&& each) { both(g.before, each), both(g.now, each); });
    serialize_extremes(archive, extremes_);
    archive.whole("accepted rows", accepted_.rows, 0, rows_.size());
    archive.whole("accepted unsettled", accepted_.unsettled, 0, rows_.size());
    serialize_extremes(archive, accepted_.extremes);
    archive.number("accepted until", accepted_.time);
}

std::vector<Channel> Observer::channels() const {
    std::vector<Channel> all;
    const auto channel = [&](const char* name, const char* unit, auto&& value) {
        Channel c{name, unit, {}};
        c.values.reserve(rows_.size());
        for (const HistoryRow& r : rows_)
            c.values.push_back(value(r));
        all.push_back(std::move(c));
    };
    using Row = HistoryRow;
    channel("time", "s", [](const Row& r) { return r.time; });
    channel("altitude", "m", [](const Row& r) { return r.position.z(); });
    channel("east", "m", [](const Row& r) { return r.position.x(); });
    channel("north", "m", [](const Row& r) { return r.position.y(); });
    channel("speed", "m/s", [](const Row& r) { return r.velocity.norm(); });
    channel("vertical_speed", "m/s", [](const Row& r) { return r.velocity.z(); });
    channel("acceleration", "m/s^2", [](const Row& r) { return r.acceleration; });
    channel("force", "N", [](const Row& r) { return r.force; });
    channel("force_raw", "N", [](const Row& r) { return r.force_raw; });
    channel("drag_area", "m^2", [](const Row& r) { return r.drag_area; });
    channel("dynamic_pressure", "Pa", [](const Row& r) { return r.dynamic_pressure; });
    channel("canopy_airspeed", "m/s", [](const Row& r) { return r.airspeed; });
    channel("canopy_pressure", "Pa", [](const Row& r) { return r.pressure; });
    channel("projected_area", "m^2", [](const Row& r) { return r.projected_area; });
    channel("signed_area", "m^2", [](const Row& r) { return r.signed_area; });
    channel("seam_diameter", "m", [](const Row& r) { return r.seam_diameter; });
    channel("canopy_depth", "m", [](const Row& r) { return r.depth; });
    channel("added_mass", "kg", [](const Row& r) { return r.added_mass; });
    if (std::ranges::any_of(rows_, [](const Row& r) { return r.mouth_area > 0.0; })) {
        channel("canopy_volume", "m^3", [](const Row& r) { return r.volume; });
        channel("mouth_area", "m^2", [](const Row& r) { return r.mouth_area; });
        channel("inflow_ratio", "", [](const Row& r) { return r.inflow_ratio; });
    }
    if (mesh_.body) channel("payload_tilt", "rad", [](const Row& r) { return r.tilt; });
    return all;
}

}  // namespace twinchute::fullsim
