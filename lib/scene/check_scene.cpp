// Consistency checks of a scene whose keys are each right on their own.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/models/meridian.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/assemble.hpp"
#include "lib/scene/calibration.hpp"
#include "lib/scene/drag_area.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/needs.hpp"
#include "lib/scene/waits.hpp"

namespace twinchute {
namespace {

/// [m/s] below which the air draws out nothing; what is left of equal velocities after rounding is less.
constexpr double smallest_airspeed = 1e-6;

/// The complaint about a key, at its place.
class Complain {
public:
    explicit Complain(const Values& values) : values_(values) {}

    [[noreturn]] void about(const std::string& key, std::string problem, std::string why,
                            std::string hint) const {
        throw SceneError(values_.place(key), key, std::move(problem), std::move(why), std::move(hint));
    }

private:
    const Values& values_;
};

void check_release(const Scene& scene, const Values& values, const Complain& complain) {
    const Environment& e = scene.environment;
    const double altitude = scene.release.altitude;
    const char* key = values.given("release.altitude") ? "release.altitude" : "release.height";
    if (altitude <= e.ground)
        complain.about(key, "the release is not above the ground",
                       fmt::format("altitude {} m, ground {} m", altitude, e.ground),
                       "raise the release or lower environment.ground");
    const Atmosphere& air = e.atmosphere;
    const std::string reach =
        fmt::format("'{}' reaches from {} to {} m", air.model->name, air.lowest(), air.highest());
    if (altitude < air.lowest() || altitude > air.highest())
        complain.about(key, fmt::format("{} m is outside the atmosphere", altitude), reach,
                       "release lower or choose another atmosphere");
    if (e.ground < air.lowest())
        complain.about("environment.ground", fmt::format("{} m is outside the atmosphere", e.ground), reach,
                       "raise the ground or choose another atmosphere");
    // An airspeed and a wind, each in its range, may add up to more than a scene may say again.
    const double fastest = find_key(scene_keys(), "release.speed")->range.high;
    if (scene.release.speed > fastest)
        complain.about("release.airspeed", fmt::format("{:.6g} m/s over ground", scene.release.speed),
                       fmt::format("with the wind it is above the {} m/s of release.speed", fastest),
                       "release slower");
}

void check_stop(const Scene& scene, const Values& values, const Complain& complain) {
    const Trigger& stop = scene.stop;
    if (stop.kind != Trigger::Kind::altitude) return;
    const char* key = values.given("stop.altitude") ? "stop.altitude" : "stop.height";
    if (stop.value >= scene.release.altitude)
        complain.about(key, "the run would end before it begins",
                       fmt::format("it falls from {} m to {} m", scene.release.altitude, stop.value),
                       "give an altitude below the release");
    if (stop.value < scene.environment.ground)
        complain.about(key, "lies below the ground",
                       fmt::format("{} m, ground {} m", stop.value, scene.environment.ground),
                       "write at = \"ground\"");
}

/// The atmosphere of another planet: its gas is not said.
std::optional<Warning> air_warning(const Environment& environment) {
    constexpr double of_earth = 0.05;  // share by which its gravity may vary, from the equator up to 100 km
    if (environment.atmosphere.table.altitude.empty() ||
        std::abs(environment.gravity / standard_gravity - 1.0) < of_earth)
        return {};
    const bool by_gas_law = environment.atmosphere.table.beside == AirTable::Beside::pressure;
    return Warning{
        fmt::format("the gas of {} is taken for Earth's air", environment.atmosphere.table.file),
        fmt::format(
            "environment.gravity, {:.4g} m/s^2, is that of another planet; {}Mach numbers take R = 287.05 "
            "J/(kg K) and a ratio of heats of 1.4",
            environment.gravity, by_gas_law ? "densities from its pressures and " : ""),
        by_gas_law
            ? "give the table densities in place of pressures, and do not trust Mach numbers in another gas"
            : "do not trust Mach numbers in another gas"};
}

/// Soundings seldom begin at the ground: that is no mistake, but it is said.
void warn_of_environment(Scene& scene) {
    const Environment& e = scene.environment;
    if (auto warning = wind_warning(e, e.ground, scene.release.altitude))
        scene.warnings.push_back(std::move(*warning));
    if (auto warning = air_warning(e)) scene.warnings.push_back(std::move(*warning));
}

/// Checks the keys that this scene needs of the parachute whichever model runs it.
void check_needs(const Scene& scene, const Parachute& p, const Complain& complain) {
    if (p.deploy.starts_packed())
        for (const std::string& key : missing_lines(p))
            complain.about(key, "is missing", "a parachute in its pack is drawn out by its lines",
                           "give it, or a design, or start at line stretch");
    if (scene.aerodynamics.added_mass && !(p.projected_diameter_ratio > 0.0))
        complain.about("parachute.projected_diameter_ratio", "is missing",
                       "it sets the air that moves with the canopy, aerodynamics.added_mass",
                       "give it (0.6 to 0.7 for solid fabric), or leave added_mass out");
}

/// Corrects the drag area where the scene asks for it.
void correct_drag_area(Scene& scene, const Complain& complain) {
    const std::vector<std::string> missing = missing_for_corrections(scene);
    if (!missing.empty())
        complain.about(missing.front(), "is missing", "a correction of the drag area needs it",
                       scene.aerodynamics.forebody_wake ? "give it, or leave aerodynamics.forebody_wake out"
                                                        : "give it, or leave aerodynamics.line_ratio out");
    for (Parachute& p : scene.parachutes)
        set_drag_area(scene, p, stated_drag_area(p));
    warn_of_drag_area(scene);
}

void check_size(Scene& scene, const Complain& complain) {
    auto& s = scene.size;
    if (s && !s->max_descent_rate && !s->max_force && !s->max_canopy_force && !s->max_deceleration)
        complain.about("size.max_descent_rate", "no limit is given", "there is nothing to meet",
                       "give max_descent_rate, max_force, max_canopy_force or max_deceleration");
    if (s && !s->parachute.empty() &&
        std::ranges::find(scene.parachutes, s->parachute, &Parachute::name) == scene.parachutes.end())
        complain.about("size.parachute", fmt::format("there is no parachute '{}'", s->parachute), "",
                       "write the name of one of [[parachute]]");
    if (s && s->parachute.empty() && scene.parachutes.size() > 1)
        s->parachute = landing_parachute(scene).name;
    using enum Trigger::Kind;
    const Trigger::Kind stop = scene.stop.kind;
    if (s && s->max_descent_rate && (stop == peak_force || stop == full_open || stop == line_stretch))
        complain.about("size.max_descent_rate", "the run ends before the descent is steady",
                       "that is where a descent rate is found", "write stop.at = \"steady-descent\"");
}

/// Checks that a canopy flies on, open as it was left.
void check_then(const Scene& scene, const Complain& complain) {
    if (scene.then.empty()) return;
    using enum Trigger::Kind;
    const auto refuse = [&](const std::string& problem, const char* why, const char* hint) {
        complain.about("stop.then", problem, why, hint);
    };
    if (scene.stop.kind == ground)
        refuse("nothing is left to fly after stop.at = \"ground\"", "the run ends on the ground",
               "stop at \"steady-descent\", or leave stop.then out");
    if (scene.stop.kind == line_stretch)
        refuse("the run stops before the canopy is open", "the rest of the fall starts from an open canopy",
               "stop at \"full-open\" or \"steady-descent\"");
    if (std::ranges::all_of(scene.parachutes, [](const Parachute& chute) { return chute.cut.has_value(); }))
        refuse("no canopy is left for the rest of the fall",
               scene.parachutes.size() > 1 ? "each of the parachutes is cut" : "parachute.cut lets it go",
               "leave stop.then out and stop at \"ground\"");
}

void check_canopy(const Parachute& p, const Complain& complain) {
    if (p.vent_diameter >= p.nominal_diameter)
        complain.about("parachute.vent_diameter", "the vent is not smaller than the canopy",
                       fmt::format("vent {} m, D0 {} m", p.vent_diameter, p.nominal_diameter),
                       "about D0/10 is common");
    if (p.gores > 0 && p.risers > 0 && p.gores % p.risers != 0)
        complain.about("parachute.risers", fmt::format("{} does not divide {} gores", p.risers, p.gores),
                       "every link takes the same number of lines",
                       "choose a divisor of the number of gores");
    const bool has_mouth = p.gores > 0 && p.line_length > 0.0 && p.projected_diameter_ratio > 0.0;
    if (has_mouth && p.line_length <= mouth_radius_at_line_stretch(p))
        complain.about("parachute.line_length",
                       fmt::format("{} m does not reach from the mouth's edge to the axis", p.line_length),
                       fmt::format("at line stretch the mouth has a radius of {:.3g} m",
                                   mouth_radius_at_line_stretch(p)),
                       "about D0 is common; or lower initial_drag_area_ratio");
    // No canopy comes near it: a key is likely in another unit.
    const double coefficient = p.drag_area / (0.25 * pi * p.nominal_diameter * p.nominal_diameter);
    if (coefficient > 5.0)
        complain.about("parachute.drag_area",
                       fmt::format("{} m^2 is a drag coefficient of {:.2f}", p.drag_area, coefficient),
                       fmt::format("on the nominal area of D0 = {} m", p.nominal_diameter),
                       "check drag_area and nominal_diameter");
}

/// The gores that a type's panels and the scene's own angles and lengths make.
void check_gore(const Scene& scene, const Parachute& p, const Complain& complain) {
    const std::vector<GorePanel> panels = p.mesh ? std::vector<GorePanel>{} : gore_panels(p);
    const char* key = !p.cone_angle.empty() ? "parachute.cone_angle.1" : "parachute.panel_length.1";
    if (!p.cone_angle.empty() || !p.panel_length.empty()) {
        if (panels.empty())
            return complain.about(
                key, "there are no panels that it belongs to",
                p.mesh ? "parachute.mesh has its own shape"
                       : "without a type, and for those that are meshed flat or not at all, gores have none",
                "take it out, or write a type such as type = \"conical\"");
        for (const auto* list : {&p.cone_angle, &p.panel_length})
            if (!list->empty() && list->size() != panels.size())
                return complain.about(
                    list == &p.cone_angle ? "parachute.cone_angle.1" : "parachute.panel_length.1",
                    fmt::format("{} of {} panels", list->size(), panels.size()),
                    fmt::format("gores of {} canopies have {}, from apex to skirt", p.type->title,
                                panels.size()),
                    "give one for each");
        const auto arc = [](const GorePanel& panel) { return panel.top != panel.bottom; };
        if (!p.cone_angle.empty() && std::ranges::any_of(p.type->meshed.gore, arc))
            return complain.about("parachute.cone_angle.1", "its panels are no cones",
                                  fmt::format("the constructed shape of {} canopies is round", p.type->title),
                                  "take it out");
    }
    if ((p.arm_ratio || p.corner_tie > 0.0) && !(cross_arm_ratio(p) > 0.0))
        return complain.about(p.arm_ratio ? "parachute.arm_ratio" : "parachute.corner_tie",
                              "there are no arms that it belongs to",
                              p.mesh ? "parachute.mesh has its own shape" : "the canopy is no cross",
                              "take it out, or write type = \"cross\"");
    if (!p.panel.empty() && p.panel.size() != panel_count(p))
        return complain.about(
            "parachute.panel", fmt::format("{} for {} panels", p.panel.size(), panel_count(p)),
            panel_count(p) == 0 ? "without a type, and for those that are meshed flat or not "
                                  "at all, gores have none, as a mesh of one's own"
                                : "gores have them from apex to skirt, a cross its middle "
                                  "and its arms",
            "give one for each, or none");
    for (std::size_t i = 0; i < std::min(panels.size(), p.panel.size()); ++i)
        if (panels[i].gap && !p.panel[i].fabric.name.empty())
            return complain.about(fmt::format("parachute.panel.{}.fabric", i + 1), "is that of a gap",
                                  fmt::format("panel {} of {} canopies has none", i + 1, p.type->title),
                                  "leave its fabric out");
    if (p.filling.is_predicted() && !p.permeability && !p.fabric.name.empty())
        for (const PanelMaterials& panel : p.panel)
            if (!panel.fabric.name.empty() && panel.fabric.permeability != p.fabric.permeability)
                return complain.about("parachute.panel", "its fabrics differ in permeability",
                                      "a filling that is predicted takes that of the whole canopy",
                                      "give parachute.permeability, the mean by area");
    if (panels.empty() || p.gores == 0) return;
    if (has_open_middle(p) && !(std::cos(panels.front().top) > 1e-3))
        return complain.about("parachute.cone_angle.1", "the first panel does not lead outward",
                              "an open middle lies within it", "give an angle below 90 deg");
    const Meridian meridian = gore_meridian(p);
    const double vent = polygon_radius(p.vent_diameter, p.gores);
    if (std::isnan(meridian.seam_at(vent)))
        return complain.about("parachute.vent_diameter", "the vent reaches beyond the first panel",
                              fmt::format("which ends at a diameter of {:.4g} m",
                                          2.0 * meridian.at(meridian.edges().front()).radius),
                              "make it smaller: about D0/10 is common");
    for (std::size_t i = 1; i < panels.size(); ++i)
        if (!(meridian.at(meridian.edges()[i]).radius > vent))
            return complain.about(key, fmt::format("panel {} closes the canopy", i + 1),
                                  "its lower edge lies within the vent", "lower its angle, or shorten it");
    if (scene.full.mesh.gore_rows < static_cast<int>(panels.size()))
        complain.about("full.mesh.gore_rows",
                       fmt::format("{} for {} panels", scene.full.mesh.gore_rows, panels.size()),
                       "each panel has rows of its own", "give at least as many rows as panels");
}

/// Vent lines that have their ends, and a length.
void check_vent_lines(const Scene& scene, const Parachute& p, const Complain& complain) {
    if (!p.vent_lines) return;
    const VentLines& lines = *p.vent_lines;
    if (p.mesh)
        return complain.about("parachute.vent_lines", "given beside parachute.mesh",
                              "a mesh of one's own has its own lines", "take one of them out");
    if (lines.model == VentLines::Model::across) {
        if (p.gores % 2 != 0)
            complain.about("parachute.vent_lines.model",
                           fmt::format("\"across\" the vent of {} gores", p.gores),
                           "no seam lies opposite another", "give an even number of gores");
        return;
    }
    if (!lines.length && !lines.pull_down_ratio)
        return complain.about("parachute.vent_lines.length", "is missing",
                              "how far the lines hold the vent down depends on it",
                              "give it, or pull_down_ratio");
    if (lines.joint && *lines.joint < p.line_length && scene.full.mesh.line_elements < 2)
        complain.about("full.mesh.line_elements", "1 has no node for the joint of a vent line",
                       "parachute.vent_lines.joint lies between skirt and link",
                       "give at least 2, or tie vent lines to the links");
    if (lines.joint && *lines.joint > p.line_length)
        complain.about("parachute.vent_lines.joint",
                       fmt::format("{} m below the skirt lies beyond the link", *lines.joint),
                       fmt::format("suspension lines are {} m long", p.line_length),
                       "give a smaller one, or leave it out for the link");
}

/// The key that a filling time comes from.
const char* fill_time_key(const FillTime& fill) {
    if (fill.given > 0.0) return "parachute.fill_time.time";
    if (fill.model && fill.model->by_porosity) return "parachute.geometric_porosity";
    if (fill.table) return "parachute.fill_time.table";
    return fill.balance ? "parachute.fill_time.model" : "parachute.fill_time.n";
}

/// Air of one density has no temperature, and sound no speed in it.
void check_mach_table(const Scene& scene, const Parachute& p, const Complain& complain) {
    if (p.drag_area_mach_table && !scene.environment.atmosphere.model->has_temperature)
        complain.about(
            "parachute.drag_area_mach_table",
            fmt::format("the atmosphere '{}' has no Mach number", scene.environment.atmosphere.model->name),
            "air of one density has no temperature, and sound no speed in it",
            "write environment.atmosphere = \"us76\", or give a table of the air");
}

void check_porosity(const Scene& scene, const Parachute& p, const Complain& complain) {
    const bool by_porosity = p.fill_time.model && p.fill_time.model->by_porosity;
    if (by_porosity && !p.filling.is_predicted() && !(p.geometric_porosity > 0.0))
        complain.about(
            "parachute.geometric_porosity", "is missing",
            fmt::format("fill_time.model = \"{}\" takes the filling time from it", p.fill_time.model->name),
            "give it, or n");
    const auto& added_mass = scene.aerodynamics.added_mass;
    if (added_mass && added_mass->model->largest_porosity < p.geometric_porosity)
        complain.about(
            "parachute.geometric_porosity",
            fmt::format("{} is above {}", p.geometric_porosity, added_mass->model->largest_porosity),
            fmt::format("aerodynamics.added_mass.model = \"{}\" holds up to there", added_mass->model->name),
            "choose another added_mass.model");
}

void check_growth(const Parachute& p, const Complain& complain) {
    if (p.drag_area_table && !p.reefing.empty())
        complain.about("parachute.drag_area_table", "a table of growth stands beside reefing",
                       "it is that of a whole opening; stages grow by a law", "write drag_area_law instead");
    const auto& balance = p.fill_time.balance;
    if (balance && !(balance->volume && balance->mouth_area) && !(p.projected_diameter_ratio > 0.0))
        complain.about("parachute.projected_diameter_ratio", "is missing",
                       "it gives volume and mouth of the open canopy",
                       "give it, or fill_time.volume and fill_time.mouth_area");
}

/// Factors are on what the opening of this scene is made from, and leave it in its range.
void check_calibration(const Scene& scene, const Parachute& p, const Complain& complain) {
    if (!p.calibration) return;
    constexpr const char* key = "parachute.calibration";
    for (const CalibratedFactors& input : p.calibration->inputs()) {
        const double* value = calibrated_input(p, input.key);
        if (value == nullptr)
            complain.about(key, fmt::format("'{}' has factors on {}", p.calibration->file(), input.key),
                           "the opening of this scene is not made from it",
                           "take the column out, or calibrate for this scene");
    }
    const Parachute own = calibrated(p, drop_conditions(scene));
    for (const CalibratedFactors& input : p.calibration->inputs()) {
        const Key& row = *find_key(scene_keys(), "parachute." + input.key);
        const double value = *calibrated_input(own, input.key);
        if (!row.range.contains(value))
            complain.about(key, fmt::format("makes {} {:g}", input.key, value), allowed_text(row),
                           "check the table");
    }
}

/// A packed start finds its snatch speed while it runs; that a filling time of n diameters outlasts an
/// initial phase of half a diameter holds at any speed, or at none.
void check_packed_opening(const Scene& scene, const Parachute& p, const Complain& complain) {
    const double speed = 1.0, density = scene.environment.atmosphere.at(scene.release.altitude).density;
    const double filling = p.fill_time.seconds(fill_inputs(scene, p, speed, density));
    const bool has_given = p.fill_time.given > 0.0;
    const bool both_scale = p.initial_phase.transit && p.fill_time.model->by_diameters;
    const bool both_given = !p.initial_phase.transit && has_given;
    const double initial =
        p.initial_phase.transit ? 0.5 * p.nominal_diameter / speed : p.initial_phase.seconds;
    if ((both_scale || both_given) && initial >= filling)
        complain.about(
            both_given ? "parachute.initial_phase" : fill_time_key(p.fill_time),
            "the initial phase is not shorter than the filling time",
            both_given ? fmt::format("t_i = {:.4g} s, t_f = {:.4g} s", initial, filling)
                       : fmt::format("it lasts half a diameter, the filling {:.3g} diameters, at any speed",
                                     filling * speed / p.nominal_diameter),
            "shorten initial_phase or lengthen fill_time");
}

/// [m/s] through the air, of a line-stretch start, which snatches at once.
double check_speed(const Scene& scene, const Values& values, const Complain& complain) {
    const double speed = release_airspeed(scene).norm();
    const char* key = values.given("release.speed") ? "release.speed" : "release.airspeed";
    if (speed < smallest_airspeed)
        complain.about(key, "a line-stretch start needs a speed", "lines and canopy are drawn out by the air",
                       "give the snatch speed");
    return speed;
}

/// A line-stretch start snatches at once, so that its times are known before anything runs.
void check_opening(const Scene& scene, const Parachute& p, const Values& values, const Complain& complain) {
    const double speed = check_speed(scene, values, complain);
    const double density = scene.environment.atmosphere.at(scene.release.altitude).density;
    const double filling = p.fill_time.seconds(fill_inputs(scene, p, speed, density));
    const double initial =
        p.initial_phase.transit ? 0.5 * p.nominal_diameter / speed : p.initial_phase.seconds;
    if (!(filling > 0.0) || !std::isfinite(filling))
        complain.about("parachute.fill_time.model", fmt::format("a filling time of {} s", filling),
                       "it has to be positive", "check fill_time and release.speed");
    if (initial >= filling) {
        const char* given =
            values.given("parachute.initial_phase") ? "parachute.initial_phase" : fill_time_key(p.fill_time);
        complain.about(given, "the initial phase is not shorter than the filling time",
                       fmt::format("t_i = {:.4g} s, t_f = {:.4g} s", initial, filling),
                       "shorten initial_phase or lengthen fill_time");
    }
}

void check_slings(const Scene& scene, const PayloadBody& body, const Complain& complain) {
    const char* key = "payload.body.sling_length";
    if (body.shape == PayloadBody::Shape::mesh)
        complain.about(key, "slings on a body of a mesh", "its risers end where the file ties them",
                       "draw them in the file, or leave sling_length out");
    if (body.elasticity)
        complain.about(key, "slings on a deformable body",
                       "the point where they meet is fixed to the body, which has to be rigid",
                       "leave payload.body.elasticity out");
    if (const SlingGeometry slings = sling_geometry(body); !(slings.rise > 0.0))
        complain.about(key, fmt::format("slings of {:.4g} m do not meet", slings.length),
                       fmt::format("they begin {:.4g} m from the axis", std::hypot(slings.x, slings.y)),
                       "lengthen them");
    for (const Parachute& chute : scene.parachutes)
        if (chute.risers != 1)
            complain.about(key, fmt::format("{} risers of '{}' on slings", chute.risers, chute.name),
                           "slings meet at one point", "write risers = 1 for each parachute");
}

/// A body of the mesh needs one.
void check_body(const Scene& scene, const Complain& complain) {
    if (scene.payload.body && scene.payload.body->sling_length)
        check_slings(scene, *scene.payload.body, complain);
    if (!scene.payload.body || scene.payload.body->shape != PayloadBody::Shape::mesh) return;
    if (!scene.parachutes.front().mesh)
        complain.about("payload.body.shape", "'mesh' without parachute.mesh",
                       "its tetrahedra are those of the group payload in that file",
                       "give parachute.mesh, or the shape \"box\" or \"cylinder\"");
}

bool has_packed(const Scene& scene) {
    return std::ranges::any_of(scene.parachutes, [](const Parachute& p) { return p.deploy.starts_packed(); });
}

/// Tolerances of one parachute's metrics: there is that parachute, or that canopy of the cluster.
void check_tolerances(const Scene& scene, const Complain& complain) {
    std::vector<std::string> heads;
    if (scene.parachutes.size() > 1)
        for (const Parachute& p : scene.parachutes)
            heads.push_back(metric_head(p.name));
    for (int k = 1; scene.parachutes.front().count > 1 && k <= scene.parachutes.front().count; ++k)
        heads.push_back(fmt::format("canopy_{}_", k));
    for (const auto& [name, tolerance] : scene.tolerances) {
        const std::string_view head = head_of_judgeable(name);
        if (head.empty() || std::ranges::find(heads, head) != heads.end()) continue;
        std::vector<std::string_view> known;
        for (const std::string& one : heads)
            known.push_back(one);
        for (const MetricRow& row : judgeable_rows())
            known.push_back(row.name);
        complain.about("compare.tolerance." + name, "unknown metric",
                       fmt::format("it would be that of a parachute '{}'", head.substr(0, head.size() - 1)),
                       suggest(name, known));
    }
}

/// Gores that keep their order have to begin in it, and rows of nodes around the axis are the generator's.
/// Fabric that is to stay on its side has to begin there.
void check_contact(const Scene& scene, const Values& values, const Complain& complain) {
    // A scene that was written states the default.
    constexpr const char* friction = "full.contact_friction";
    const double usual = std::stod(std::string(find_key(scene_keys(), friction)->fallback));
    if (scene.full.contact != Contact::self && values.given(friction) && scene.full.contact_friction != usual)
        complain.about(friction, "is not used", "full.contact is not \"self\"",
                       "take it out, or write full.contact = \"self\"");
    if (scene.full.contact == Contact::none) return;
    const bool any_packed = has_packed(scene);
    const bool any_mesh =
        std::ranges::any_of(scene.parachutes, [](const Parachute& p) { return p.mesh.has_value(); });
    const auto refuse = [&](const char* problem, const char* why, const char* hint) {
        complain.about("full.contact", problem, why,
                       fmt::format("{}, or write full.contact = \"none\"", hint));
    };
    if (scene.full.contact == Contact::self) {
        if (any_packed)
            refuse("\"self\" of a packed canopy",
                   "fabric lies across fabric in a pack, and as it is drawn out steps become too short",
                   "start at line stretch");
        return;
    }
    if (any_mesh)
        refuse("\"gores\" with parachute.mesh", "which nodes of an imported mesh lie in one row is not known",
               "leave parachute.mesh out");
    if (any_packed)
        refuse("\"gores\" of a packed canopy", "drawn out of its pack its folds lie in no order",
               "start at line stretch");
}

/// Refuses conditions that make sectors differ, although a run of one sector would not show it.
void check_symmetry(const Scene& scene, const Complain& complain) {
    if (scene.full.symmetry == Symmetry::none) return;
    const auto refuse = [&](std::string why, const char* hint) {
        complain.about("full.symmetry", "one sector cannot stand for the canopy", std::move(why),
                       fmt::format("{}, or write full.symmetry = \"none\"", hint));
    };
    if (has_packed(scene))
        refuse("drawn out of its pack each gore folds in its own way", "start at line stretch");
    if (scene.full.contact == Contact::self)
        refuse("full.contact = \"self\" looks at all nodes", "write full.contact = \"gores\" or \"none\"");
    if (scene.full.noise) refuse("full.noise disturbs each gore in its own way", "leave full.noise out");
    if (scene.payload.body) refuse("payload.body turns as it likes", "leave payload.body out");
    if (scene.environment.wind)
        refuse("environment.wind carries the canopy to one side", "leave environment.wind out");
    const Vec3 velocity = velocity_over_ground(scene.release);
    // As near to the vertical as an angle in radians can be written.
    if (velocity.z() > 0.0 || std::hypot(velocity.x(), velocity.y()) > 1e-9 * velocity.norm())
        refuse("release.path_angle is not straight down: the canopy meets the air from one side",
               "write path_angle = \"90 deg\"");
}

/// Checks what a balance of the air in the canopy needs, and that nothing prescribes beside it.
void check_filling(const Parachute& p, const Complain& complain) {
    const Filling& f = p.filling;
    if (!f.is_predicted()) return;
    const std::string head = "parachute.filling.";
    if (p.deploy.by == DeployBy::inflated)
        complain.about(head + "model", "a canopy that starts open does not fill", "deploy.by is 'inflated'",
                       "take filling out, or deploy by line-stretch");
    for (const auto& [key, length] : {std::pair{"parachute.line_length", p.line_length},
                                      std::pair{"parachute.riser_length", p.riser_length}})
        if (!(length > 0.0))
            complain.about(key, "is missing", "the shape of a canopy that fills hangs on its lines",
                           "give it, or a design, or take filling out");
    const double lines = line_ratio(p);
    if (lines < IsotensoidFamily::shortest_lines || lines > IsotensoidFamily::longest_lines)
        complain.about("parachute.line_length", fmt::format("lines and risers of {:.3g} D0", lines),
                       fmt::format("shapes of canopies that fill are known from {:g} to {:g} D0",
                                   IsotensoidFamily::shortest_lines, IsotensoidFamily::longest_lines),
                       "check line_length, riser_length and nominal_diameter, or prescribe the filling");
    if (f.model->has_balance && !p.permeability && !p.fabric.permeability)
        complain.about("parachute.permeability", "is missing",
                       "how fast a canopy fills depends on what its fabric lets out",
                       "give it, 0 for coated fabric, or a fabric that has one");
    if (f.lowest_mouth > f.initial_mouth || f.highest_mouth < f.initial_mouth)
        complain.about(head + "initial_mouth", fmt::format("{:g} is outside its bracket", f.initial_mouth),
                       fmt::format("from {:g} to {:g}", f.lowest_mouth, f.highest_mouth),
                       "give lowest_mouth and highest_mouth around it");
    if (p.drag_area_mach_table)
        complain.about("parachute.drag_area_mach_table", "stands beside a predicted filling",
                       "the drag of a canopy that fills is a result of subsonic air",
                       "take it out, or prescribe the filling");
    const double initial = pi * p.projected_diameter_ratio * p.nominal_diameter * std::sqrt(f.initial_mouth);
    for (std::size_t i = 0; i < p.reefing.size(); ++i) {
        const std::string key = fmt::format("parachute.reefing.{}.line_length", i + 1);
        if (!p.reefing[i].line_length && !(p.projected_diameter_ratio > 0.0))
            complain.about(key, "is missing", "it bounds the mouth of a canopy that fills by itself",
                           "give it, or projected_diameter_ratio");
        if (const double line = reefing_line_length(p, i); line < initial)
            complain.about(key, fmt::format("{:.4g} m does not go around the mouth", line),
                           fmt::format("at snatch it is {:.4g} m round, by filling.initial_mouth", initial),
                           "lengthen the line, or begin with a smaller initial_mouth");
    }
}

/// The stages of a reefed opening, each wider than the one before.
void check_reefing(const Parachute& p, const Complain& complain) {
    double before = p.initial_drag_area_ratio;
    for (std::size_t i = 0; i < p.reefing.size(); ++i) {
        const std::string key = fmt::format("parachute.reefing.{}.drag_area_ratio", i + 1);
        if (p.reefing[i].drag_area_ratio <= before)
            complain.about(key, fmt::format("{:g} does not rise", p.reefing[i].drag_area_ratio),
                           i == 0
                               ? fmt::format("the canopy begins with initial_drag_area_ratio = {:g}", before)
                               : fmt::format("the stage before it has {:g}", before),
                           "give stages in the order in which they open");
        before = p.reefing[i].drag_area_ratio;
    }
    if (!p.reefing.empty() && p.deploy.by == DeployBy::inflated)
        complain.about("parachute.reefing.1.drag_area_ratio", "a canopy that starts open has no reefed stage",
                       "", "take out reefing, or deploy by line-stretch");
}

void check_cluster(const Parachute& p, const Complain& complain) {
    if (!p.lag.empty() && static_cast<int>(p.lag.size()) != p.count)
        complain.about("parachute.lag.1", fmt::format("{} times for {} parachutes", p.lag.size(), p.count),
                       "each has its own", "give as many as parachute.count");
    if (!p.lag.empty() && p.deploy.by == DeployBy::inflated)
        complain.about("parachute.lag.1", "canopies that start open have no lag", "", "take it out");
    if (p.skips_reefing > p.count)
        complain.about("parachute.skips_reefing",
                       fmt::format("{} of {} parachutes", p.skips_reefing, p.count), "",
                       "give parachute.count at most");
    if (p.skips_reefing > 0 && p.reefing.empty())
        complain.about("parachute.skips_reefing", "no canopy is reefed", "parachute.reefing is absent",
                       "take it out, or give parachute.reefing");
}

/// The name of one of several parachutes is part of keys and metrics.
void check_name(const std::string& name, const Complain& complain) {
    const bool plain = std::ranges::all_of(name, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
               c == '_';
    });
    const std::string path = "parachute." + name;
    const bool is_key = std::ranges::any_of(
        scene_keys(), [&](const Key& row) { return row.path == path || row.path.starts_with(path + "."); });
    const bool is_number = name.find_first_not_of("0123456789") == std::string::npos;
    if (!plain || is_key || is_number)
        complain.about("parachute.name", fmt::format("'{}' is not fit for one of several parachutes", name),
                       is_key ? "it is the name of a key" : "letters, digits, '-' and '_', and not a number",
                       "write e.g. \"drogue\"");
}

/// The key of a trigger: the first of its conditions that is given.
std::string key_of(const Values& values, const std::string& table) {
    for (const char* name : {"at", "time", "altitude", "height", "dynamic_pressure", "after"})
        if (const std::string key = fmt::format("{}.{}", table, name); values.given(key)) return key;
    return table + ".at";
}

/// Names are told apart, and what parachutes wait for is there and can happen.
void check_sequence(const Scene& scene, const std::vector<Values>& values) {
    const auto find = [&](const std::string& name) {
        return std::ranges::find(scene.parachutes, name, &Parachute::name);
    };
    const auto check = [&](std::size_t k, const Trigger& trigger, const std::string& table, bool may_be_own) {
        const Complain complain(values[k]);
        const std::string key = key_of(values[k], table);
        const std::string& own = scene.parachutes[k].name;
        if (!trigger.of.empty() && find(trigger.of) == scene.parachutes.end())
            complain.about(key, fmt::format("there is no parachute '{}'", trigger.of), "",
                           "write the name of one of [[parachute]]");
        const bool its_own = trigger.of.empty() ? trigger.kind == Trigger::Kind::line_stretch ||
                                                      trigger.kind == Trigger::Kind::full_open
                                                : trigger.of == own;
        if (its_own && trigger.kind == Trigger::Kind::cut)
            complain.about(key, "a parachute cannot wait for its own cut", "it is gone then",
                           "name another one with after");
        if (its_own && !may_be_own)
            complain.about(key, "a parachute cannot wait for its own opening", "",
                           "name another one with after");
    };
    for (std::size_t k = 0; scene.parachutes.size() > 1 && k < scene.parachutes.size(); ++k) {
        const std::string& name = scene.parachutes[k].name;
        const Complain complain(values[k]);
        if (static_cast<std::size_t>(find(name) - scene.parachutes.begin()) != k)
            complain.about("parachute.name", fmt::format("two parachutes are called '{}'", name),
                           "keys and metrics carry the name", "give each a name of its own");
        const auto alike = std::ranges::find(scene.parachutes, metric_head(name),
                                             [](const Parachute& other) { return metric_head(other.name); });
        if (alike->name != name)
            complain.about("parachute.name",
                           fmt::format("'{}' and '{}' have the same metrics, {}...", alike->name, name,
                                       metric_head(name)),
                           "capitals and signs are no difference there", "choose other names");
        check_name(name, complain);
    }
    int at_release = 0;
    for (std::size_t k = 0; k < scene.parachutes.size(); ++k) {
        const Parachute& p = scene.parachutes[k];
        const Complain complain(values[k]);
        if (p.deploy_when) check(k, *p.deploy_when, "parachute.deploy.when", false);
        if (p.cut) check(k, *p.cut, "parachute.cut", true);
        for (std::size_t i = 0; i < p.reefing.size(); ++i)
            check(k, p.reefing[i].until, fmt::format("parachute.reefing.{}.until", i + 1), true);
        if (p.deploy.starts_packed() && !p.deploy_when && ++at_release > 1)
            complain.about("parachute.deploy.by", "two parachutes leave their packs at release",
                           "the lines of one are drawn out after the other",
                           "add deploy.when to one of them");
        if (p.deploy.by == DeployBy::static_line && p.deploy_when)
            complain.about("parachute.deploy.by", "a static line has nothing to wait for",
                           "it pays out from release on", "take out deploy.when");
    }
    if (const auto wait = find_hopeless_wait(scene)) {
        const Values& own = values[wait->parachute];
        Complain(own).about(key_of(own, wait->table), wait->problem, wait->why, wait->hint);
    }
}

/// Every input is a number of the scene, and the covariance is one.
void check_uncertainty(const Scene& scene, const Complain& complain) {
    if (!scene.uncertainty) return;
    const Uncertainty& known = *scene.uncertainty;
    for (const std::string& input : known.inputs) {
        std::string key = input.starts_with("ln ") ? input.substr(3) : input;
        for (const Parachute& p : scene.parachutes)
            if (const std::string head = "parachute." + p.name + "."; key.starts_with(head))
                key = "parachute." + key.substr(head.size());
        const Key* row = find_key(scene_keys(), key);
        if (row == nullptr || !row->is_number() || row->kind == KeyKind::integer)
            complain.about("uncertainty.inputs", fmt::format("'{}' is no number of a scene", input), "",
                           "name keys of `twinchute list keys`");
    }
    const auto n = static_cast<Eigen::Index>(known.inputs.size());
    if (static_cast<Eigen::Index>(known.covariance.size()) != n * (n + 1) / 2)
        complain.about("uncertainty.covariance", fmt::format("has {} numbers", known.covariance.size()),
                       fmt::format("the lower triangle of {} inputs has {}", n, n * (n + 1) / 2),
                       "write it row by row");
    Eigen::MatrixXd covariance(n, n);
    auto next = known.covariance.begin();
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j <= i; ++j)
            covariance(i, j) = covariance(j, i) = *next++;
    // In units of the deviations, so that one small variance is not lost beside a large one.
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    constexpr double rounding = 1e-6;  // numbers of a file have a few digits
    const Eigen::VectorXd inverse = deviation.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
    const Eigen::MatrixXd correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
    const bool has_variances = (deviation.array() > 0.0).all();
    if (!has_variances ||
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlation).eigenvalues().minCoeff() < -rounding)
        complain.about(
            "uncertainty.covariance", "is no covariance",
            has_variances ? "inputs would be more than wholly correlated" : "a variance is not positive",
            "check its order: row by row, from the first input on");
}

void check_parachute(const Scene& scene, const Parachute& p, const Values& values) {
    const Complain complain(values);
    check_needs(scene, p, complain);
    check_canopy(p, complain);
    check_gore(scene, p, complain);
    check_vent_lines(scene, p, complain);
    check_growth(p, complain);
    check_porosity(scene, p, complain);
    check_mach_table(scene, p, complain);
    check_reefing(p, complain);
    check_cluster(p, complain);
    check_filling(p, complain);
    check_calibration(scene, p, complain);
    if (p.filling.is_predicted()) {
        if (p.deploy.by == DeployBy::line_stretch && !p.deploy_when) check_speed(scene, values, complain);
        return;
    }
    if (p.deploy.starts_packed())
        check_packed_opening(scene, p, complain);
    else if (p.deploy.by == DeployBy::line_stretch && !p.deploy_when)
        check_opening(scene, p, values, complain);
}

}  // namespace

void check_scene(Scene& scene, const std::vector<Values>& values) {
    const Complain complain(values.front());
    check_release(scene, values.front(), complain);
    for (std::size_t k = 0; k < scene.parachutes.size(); ++k)
        check_parachute(scene, scene.parachutes[k], values[k]);
    check_sequence(scene, values);
    check_size(scene, complain);
    check_uncertainty(scene, complain);
    check_then(scene, complain);
    check_stop(scene, values.front(), complain);
    check_body(scene, complain);
    check_contact(scene, values.front(), complain);
    check_symmetry(scene, complain);
    check_tolerances(scene, complain);
    warn_of_environment(scene);
    correct_drag_area(scene, complain);
}

}  // namespace twinchute
