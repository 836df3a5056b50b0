// The rows of the table of keys.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <string>

#include "lib/math/vec.hpp"
#include "lib/models/added_mass.hpp"
#include "lib/models/atmosphere.hpp"
#include "lib/models/drag_area.hpp"
#include "lib/models/drag_correction.hpp"
#include "lib/models/fill_time.hpp"
#include "lib/models/filling.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/binding.hpp"
#include "lib/scene/drag_area.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/scene.hpp"
#include "lib/scene/trigger.hpp"

namespace twinchute {
namespace {

using enum KeyKind;
using enum KeyNeed;
using enum KeyUser;
using Words = std::vector<std::string_view>;

/// Deployments that start from a pack, as `only_with` wants them.
constexpr std::string_view packed = "static-line|free|extraction|pilot|mortar";

constexpr KeyRange above(double low, double high) {
    return {low, high, true, false};
}
constexpr KeyRange from(double low, double high) {
    return {low, high, false, false};
}
constexpr KeyRange below(double low, double high) {
    return {low, high, false, true};
}

// Choices come from the tables that run, so that a new row is known here at once.
template <auto rows>
Words names_of() {
    Words names;
    for (const auto& row : rows())
        names.push_back(row.name);
    return names;
}
Words added_masses() {
    Words names = names_of<added_mass_models>();
    names.emplace_back("none");
    return names;
}
Words fillings() {
    Words names = names_of<filling_models>();
    names.emplace_back("prescribed");
    return names;
}
template <const auto& words>
Words listed() {
    return {std::begin(words), std::end(words)};
}
constexpr std::string_view winds[] = {"uniform", "components", "table"};
constexpr std::string_view varied[] = {"nominal_diameter", "release_speed", "reefing_ratio", "cutter_delay"};
constexpr std::string_view line_drags[] = {"cylinder"};
constexpr std::string_view stops[] = {"steady-descent", "peak-force", "full-open", "line-stretch", "ground"};
constexpr std::string_view successors[] = {"rom"};
constexpr std::string_view occurrences[] = {"release", "apogee", "line-stretch", "full-open",
                                            "steady-descent"};
constexpr std::string_view phases[] = {"transit"};
constexpr std::string_view methods[] = {"auto",           "heun-euler", "bogacki-shampine", "zonneveld",
                                        "dormand-prince", "adams",      "kvaerno-3",        "kvaerno-4",
                                        "kvaerno-5",      "bdf"};
constexpr std::string_view fabrics[] = {"fabric"};
constexpr std::string_view cords[] = {"cord"};

constexpr Word<AddedMassMomentum> momentums[] = {{"inertia-only", AddedMassMomentum::inertia_only},
                                                 {"accreting", AddedMassMomentum::accreting}};
constexpr Word<AddedMassRadius> radii[] = {{"shape-once-open", AddedMassRadius::shape_once_open},
                                           {"drag-area", AddedMassRadius::drag_area}};
constexpr Word<PayloadBody::Shape> shapes[] = {{"box", PayloadBody::Shape::box},
                                               {"cylinder", PayloadBody::Shape::cylinder},
                                               {"mesh", PayloadBody::Shape::mesh}};
constexpr Word<bool> anchors[] = {{"aircraft", true}, {"fixed", false}};
constexpr Word<bool> extraction_loads[] = {{"point", true}, {"distributed", false}};
constexpr Word<Grading> gradings[] = {{"graded", Grading::graded}, {"uniform", Grading::uniform}};
constexpr Word<Symmetry> symmetries[] = {{"none", Symmetry::none}, {"sector", Symmetry::sector}};
constexpr Word<Contact> contacts[] = {
    {"none", Contact::none}, {"gores", Contact::gores}, {"self", Contact::self}};
constexpr Word<VentLines::Model> vent_line_models[] = {{"pull-down", VentLines::Model::pull_down},
                                                       {"across", VentLines::Model::across}};
constexpr Word<Structure> structures[] = {{"msd-fe", Structure::msd_fe}, {"fe", Structure::fe}};
constexpr Word<bool> alpha_begins[] = {{"snatch", false}, {"release", true}};

// clang-format off
// Bindings below one table.
template <auto... m> constexpr auto of_air = member<&Scene::environment, &Environment::atmosphere, m...>;
template <auto... m> constexpr auto of_body = member<&Scene::payload, &Payload::body, m...>;
template <auto... m> constexpr auto of_release = member<&Scene::release, m...>;
template <auto tape> constexpr auto of_tapes = member<&Parachute::tapes, tape, &Cord::name>;
template <auto... m> constexpr auto of_vent_lines = member<&Parachute::vent_lines, m...>;
template <auto... m> constexpr auto of_deploy = member<&Parachute::deploy, m...>;
template <auto... m> constexpr auto of_balance = member<&FillTime::balance, m...>;
template <auto m> constexpr auto of_filling = member<&Parachute::filling, m>;
template <auto... m> constexpr auto of_added_mass = member<&Scene::aerodynamics, &Aerodynamics::added_mass, m...>;
template <auto... m> constexpr auto of_full = member<&Scene::full, m...>;
template <auto... m> constexpr auto of_series = member<&Scene::series, m...>;
template <auto... m> constexpr auto of_size = member<&Scene::size, m...>;
template <auto... m> constexpr auto of_uncertainty = member<&Scene::uncertainty, m...>;
// clang-format on

// Bindings that are more than a member.
OptionalValue optional_text(std::string text) {
    return text.empty() ? OptionalValue{} : OptionalValue{std::move(text)};
}

/// The CSV file that a table came from; the reader makes the table.
template <auto table, class Object = decltype(owner_of(table))>
constexpr BindingOf<Object> file_of{.get = [](const Object& object) {
    return object.*table ? optional_text((object.*table)->file()) : OptionalValue{};
}};

constexpr BindingOf<Scene> wind_model{.get = [](const Scene& s) -> OptionalValue {
    if (!s.environment.wind) return {};
    return std::string(s.environment.wind->table.empty() ? "components" : "table");
}};

template <int axis>
constexpr BindingOf<Scene> wind_component{
    .get = [](const Scene& s) -> OptionalValue { return s.environment.wind->levels.front().velocity[axis]; }};

/// Without a drag area nothing is left of the table either.
constexpr BindingOf<Scene> attitude_table{.get = [](const Scene& s) {
    const Payload& p = s.payload;
    return p.drag_area && p.drag_area_table ? optional_text(p.drag_area_table->file()) : OptionalValue{};
}};

constexpr BindingOf<Scene> line_drag{
    [](Scene& s, const KeyValue&) { s.aerodynamics.line_drag.emplace(); },
    [](const Scene& s) { return optional_text(s.aerodynamics.line_drag ? "cylinder" : ""); }};

constexpr BindingOf<Scene> size_types{.get = [](const Scene& s) -> OptionalValue {
    if (!s.size || s.size->types.empty()) return {};
    std::vector<std::string> names;
    for (const CanopyType& type : s.size->types)
        names.push_back(type.name);
    return names;
}};

constexpr BindingOf<Parachute> canopy_type{
    .get = [](const Parachute& p) { return optional_text(p.type ? p.type->name : ""); }};

constexpr BindingOf<Parachute> deploy_by{
    [](Parachute& p, const KeyValue& word) {
        p.deploy.by =
            std::ranges::find(deployment_rows(), std::get<std::string>(word), &DeploymentRow::name)->by;
    },
    [](const Parachute& p) -> OptionalValue { return std::string(deployment_name(p.deploy.by)); }};

constexpr BindingOf<Parachute> extraction_force{
    .get = [](const Parachute& p) -> OptionalValue { return p.deploy.extraction.force.front(); }};

constexpr BindingOf<Parachute> initial_phase{
    [](Parachute& p, const KeyValue& value) {
        const auto* seconds = std::get_if<double>(&value);
        p.initial_phase = {seconds == nullptr, seconds == nullptr ? 0.0 : *seconds};
    },
    [](const Parachute& p) -> OptionalValue {
        if (p.initial_phase.transit) return std::string("transit");
        return p.initial_phase.seconds;
    }};

/// One point of a fabric's law.
constexpr BindingOf<Fabric> fabric_speed{[](Fabric& f, const KeyValue& value) {
    f.permeability = permeability_at_half_inch(std::get<double>(value));
}};

/// A condition of a trigger with a value.
template <Trigger::Kind kind>
struct Condition {
    static void set(Trigger& t, const KeyValue& from) {
        t.kind = kind;
        t.value = std::get<double>(from);
    }
    static OptionalValue get(const Trigger& t) {
        return t.kind == kind ? OptionalValue{t.value} : OptionalValue{};
    }
};

/// An event of one's own.
struct AtEvent {
    static void set(Trigger& t, const KeyValue& from) { t.kind = *find_event(std::get<std::string>(from)); }
    static OptionalValue get(const Trigger& t) {
        return t.of.empty() ? optional_text(std::string(event_name(t.kind))) : OptionalValue{};
    }
};

/// An event of another parachute; the reader takes it apart.
constexpr BindingOf<Trigger> after_event{.get = [](const Trigger& t) {
    return optional_text(t.of.empty() ? "" : fmt::format("{}.{}", t.of, event_name(t.kind)));
}};

// clang-format off
/// Conditions of a trigger, below the table that it stands in.
constexpr Key trigger_rows[] = {
    {.path = "at", .binding = bound<AtEvent, Trigger>, .kind = word, .choices = listed<occurrences>, .meaning = "the event of this parachute, or of the flight"},
    {.path = "time", .binding = bound<Condition<Trigger::Kind::time>, Trigger>, .unit = "s", .need = optional, .range = from(0, 36000), .meaning = "since release"},
    {.path = "altitude", .binding = bound<Condition<Trigger::Kind::altitude>, Trigger>, .unit = "m", .need = optional, .range = from(-5000, 86000), .meaning = "above sea level that the payload falls to"},
    {.path = "height", .unit = "m", .need = optional, .range = from(0, 86000), .meaning = "above ground that the payload falls to"},
    {.path = "dynamic_pressure", .binding = bound<Condition<Trigger::Kind::dynamic_pressure>, Trigger>, .unit = "Pa", .need = optional, .range = above(0, 1e6), .meaning = "that it falls to"},
    {.path = "after", .binding = after_event, .kind = text, .need = optional, .meaning = "an event of another parachute: \"drogue.full-open\", line-stretch or cut"},
    {.path = "delay", .binding = member<&Trigger::delay>, .unit = "s", .need = defaulted, .fallback = "0", .range = from(0, 36000), .meaning = "after that"},
};

constexpr std::string_view predicted = "predicted|wolf|mass-balance";
constexpr std::string_view with_n = "fill-constant|knacke-0.85|knacke-0.9";

/// A filling time, below the table that it stands in.
constexpr Key fill_time_rows[] = {
    {.path = "model", .binding = row_of<find_fill_time, &FillTime::model>, .kind = word, .need = defaulted, .fallback = "fill-constant", .choices = names_of<fill_time_models>,
     .meaning = "time from snatch to full drag area; of a reefed stage its part of that, but given is the time of the stage itself", .source = "paper Eq. 13"},
    {.path = "n", .binding = unless_zero<&FillTime::n>, .unit = "1", .range = above(0, 200), .only_with = with_n,
     .meaning = "fill constant: t_f = n D0/v_s; with knacke-0.85 and -0.9 n D0/v_s^0.85 in feet and feet per second; not needed where the scene starts inflated", .source = "paper Eq. 13; Knacke NWC TP 6575, Table 5-6"},
    {.path = "density_exponent", .binding = member<&FillTime::density_exponent>, .unit = "1", .need = defaulted, .fallback = "0", .range = from(-5, 5), .only_with = with_n,
     .meaning = "k of the altitude correction (rho/rho_0)^k", .source = "paper 5.2 (0.8 there)"},
    {.path = "table", .binding = member<&FillTime::table, &FillTable::file>, .kind = csv_file, .only_with = "table",
     .meaning = "columns froude_number or mass_ratio, and fill_constant; makes the model \"table\"; its ends hold beyond them"},
    {.path = "volume", .binding = of_balance<&FillBalance::volume>, .unit = "m^3", .need = optional, .fallback = "2/3 pi (D_p/2)^3", .range = above(0, 1e6), .only_with = "ludtke",
     .meaning = "of the open canopy"},
    {.path = "mouth_area", .binding = of_balance<&FillBalance::mouth_area>, .unit = "m^2", .need = optional, .fallback = "pi (D_p/2)^2", .range = above(0, 1e5), .only_with = "ludtke",
     .meaning = "that air enters by, of the open canopy"},
    {.path = "pressure_coefficient", .binding = of_balance<&FillBalance::pressure_coefficient>, .unit = "1", .need = defaulted, .fallback = "1", .range = from(0, 5), .only_with = "ludtke",
     .meaning = "C_p of the pressure across the fabric, which drives the leak", .source = "dynamic pressure: our assumption"},
    {.path = "time", .binding = member<&FillTime::given>, .unit = "s", .range = above(0, 1000), .only_with = "given", .meaning = "the filling time itself"},
};

constexpr Key scene_rows[] = {
    {.path = "schema", .binding = BindingOf<Scene>{.get = [](const Scene&) -> OptionalValue { return std::int64_t{1}; }}, .kind = integer, .range = from(1, 1), .meaning = "version of this list of keys"},
    {.path = "name", .binding = member<&Scene::name>, .kind = text, .meaning = "what the scene is called in tables and reports"},

    {.path = "base", .kind = text, .need = optional, .fallback = "all keys given here",
     .meaning = "the file of a scene that this one starts from; keys given here override it"},
    {.path = "case", .kind = table, .need = optional, .meaning = "[[case]], a series: every case is run for itself"},
    {.path = "case.name", .kind = text, .meaning = "unique, and fit for the name of a directory"},
    {.path = "case.set", .kind = table, .need = optional, .meaning = "what differs in it: { \"release.altitude\" = \"60 m\" }"},

    {.path = "environment.atmosphere.model", .binding = row_of<find_atmosphere, &Scene::environment, &Environment::atmosphere, &Atmosphere::model>,
     .kind = word, .need = defaulted, .fallback = "us76", .choices = names_of<atmosphere_models>,
     .meaning = "the air; atmosphere = \"us76\" is short for it", .source = "US Standard Atmosphere 1976"},
    {.path = "environment.atmosphere.density", .binding = of_air<&Atmosphere::constant_density>, .unit = "kg/m^3", .range = above(0, 100), .only_with = "constant",
     .meaning = "uniform density; makes the model \"constant\""},
    {.path = "environment.atmosphere.temperature_offset", .binding = of_air<&Atmosphere::temperature_offset>, .unit = "K", .need = defaulted, .fallback = "0", .range = from(-100, 100),
     .only_with = "us76", .meaning = "warmer than standard at the same pressure altitude; a difference, in K"},
    {.path = "environment.atmosphere.table", .binding = of_air<&Atmosphere::table, &AirTable::file>, .kind = csv_file, .only_with = "table",
     .meaning = "columns altitude, temperature, and pressure or density; or a sounding as published, a Wyoming list or FSL; makes the model \"table\""},
    {.path = "environment.gravity", .binding = member<&Scene::environment, &Environment::gravity>, .unit = "m/s^2", .need = defaulted, .fallback = "9.80665", .range = above(0, 100),
     .meaning = "downward acceleration", .source = "standard gravity, ISO 80000-3"},
    {.path = "environment.ground", .binding = member<&Scene::environment, &Environment::ground>, .unit = "m", .need = defaulted, .fallback = "0", .range = from(-1000, 80000),
     .meaning = "elevation of the ground above sea level"},
    {.path = "environment.wind", .kind = table, .need = optional, .meaning = "the air moves; absent: it is at rest"},
    {.path = "environment.wind.model", .binding = wind_model, .kind = word, .choices = listed<winds>,
     .meaning = "follows from the keys below: uniform by speed and from, components, or a table"},
    {.path = "environment.wind.speed", .unit = "m/s", .range = from(0, 200), .only_with = "uniform", .meaning = "horizontal"},
    {.path = "environment.wind.from", .unit = "rad", .range = from(-2 * pi, 2 * pi), .only_with = "uniform",
     .meaning = "where it comes from, from north, clockwise; 270 deg blows toward the east"},
    {.path = "environment.wind.east", .binding = wind_component<0>, .unit = "m/s", .range = from(-200, 200), .only_with = "components", .meaning = "toward the east"},
    {.path = "environment.wind.north", .binding = wind_component<1>, .unit = "m/s", .range = from(-200, 200), .only_with = "components", .meaning = "toward the north"},
    {.path = "environment.wind.up", .binding = wind_component<2>, .unit = "m/s", .need = defaulted, .fallback = "0", .range = from(-100, 100),
     .only_with = "components", .meaning = "upward"},
    {.path = "environment.wind.table", .binding = member<&Scene::environment, &Environment::wind, &Wind::table>, .kind = csv_file, .only_with = "table",
     .meaning = "columns altitude, and speed and from, or east, north and perhaps up; or a sounding as published; its ends hold beyond them"},

    {.path = "payload.mass", .binding = member<&Scene::payload, &Payload::mass>, .unit = "kg", .range = above(0, 1e6), .meaning = "everything below the risers"},
    {.path = "payload.drag_area", .binding = member<&Scene::payload, &Payload::drag_area>, .unit = "m^2", .need = optional, .range = from(0, 1e4), .instead_of = "payload.drag_area_table", .meaning = "C_D S of the payload"},
    {.path = "payload.drag_area_table", .binding = attitude_table, .kind = csv_file, .need = optional, .instead_of = "payload.drag_area",
     .meaning = "columns angle, between the body's axis up to the risers and the way the air goes past it, from 0 to 180 deg (or 90 deg, alike from above and below), and drag_area; of payload.body in the full model, elsewhere that of angle 0"},
    {.path = "payload.diameter", .binding = member<&Scene::payload, &Payload::diameter>, .unit = "m", .need = optional, .fallback = "required by a forebody wake", .range = above(0, 1000),
     .meaning = "of a disc with its frontal area, for its wake"},
    {.path = "payload.body", .kind = table, .need = optional, .user = full, .meaning = "a homogeneous body that turns; absent: a point mass"},
    {.path = "payload.body.shape", .binding = word_of<shapes, &Scene::payload, &Payload::body, &PayloadBody::shape>,
     .kind = word, .choices = words_in<shapes>, .user = full, .meaning = "hangs from the four upper corners of a box, from the upper rim of a cylinder, or where the mesh says: tetrahedra of the group payload in parachute.mesh"},
    {.path = "payload.body.size", .binding = of_body<&PayloadBody::size>, .kind = quantities, .unit = "m", .range = above(0, 100), .user = full,
     .meaning = "of a box: its edges, two across and the last along the parachute; of a cylinder: diameter and height; of a mesh: none"},
    {.path = "payload.body.sling_length", .binding = of_body<&PayloadBody::sling_length>, .unit = "m", .need = optional, .range = above(0, 100), .user = full,
     .meaning = "of four slings from the upper corners, or the rim, to the one point that parachutes hang on; absent: risers end on the body"},
    {.path = "payload.body.elasticity", .kind = table, .need = optional, .user = full, .meaning = "its tetrahedra give way; absent: they are lumped into a rigid body"},
    {.path = "payload.body.elasticity.youngs_modulus", .binding = of_body<&PayloadBody::elasticity, &Elasticity::youngs_modulus>,
     .unit = "Pa", .range = above(0, 1e13), .user = full, .meaning = "of its material; the density follows from payload.mass"},
    {.path = "payload.body.elasticity.poisson_ratio", .binding = of_body<&PayloadBody::elasticity, &Elasticity::poisson_ratio>,
     .unit = "1", .range = below(0, 0.5), .user = full, .meaning = "of its material; damped by full.beta and full.bulk_viscosity"},

    {.path = "release.altitude", .binding = of_release<&Release::altitude>, .unit = "m", .range = from(-5000, 86000), .instead_of = "release.height",
     .meaning = "of the payload above sea level"},
    {.path = "release.height", .unit = "m", .range = above(0, 86000), .instead_of = "release.altitude",
     .meaning = "of the payload above ground"},
    {.path = "release.speed", .binding = of_release<&Release::speed>, .unit = "m/s", .range = from(0, 1000), .instead_of = "release.airspeed",
     .meaning = "over ground"},
    {.path = "release.airspeed", .unit = "m/s", .range = from(0, 1000), .instead_of = "release.speed",
     .meaning = "relative to the air; path angle and heading are then through the air too"},
    {.path = "release.path_angle", .binding = of_release<&Release::path_angle>, .unit = "rad", .need = optional, .fallback = "required when speed > 0",
     .range = from(-pi / 2, pi / 2), .meaning = "of the flight path below the horizon, 90 deg is straight down"},
    {.path = "release.heading", .binding = of_release<&Release::heading>, .unit = "rad", .need = defaulted, .fallback = "1.5707963267948966",
     .range = from(-2 * pi, 2 * pi), .meaning = "from north, clockwise; 90 deg is east"},

    {.path = "parachute", .kind = table, .meaning = "[[parachute]], one for each that opens by itself"},
    {.path = "parachute.design", .kind = data_file, .need = optional, .fallback = "all keys given here", .folder = "parachutes",
     .meaning = "a design file; keys given beside it override it, and to another nominal_diameter its lengths, drag area and mass are scaled"},
    {.path = "parachute.type", .binding = canopy_type, .kind = data_file, .need = optional, .fallback = "no type", .folder = "parachutes/types",
     .meaning = "of canopy: C_D0, C_x, D_p/D0 and n in the middle of its ranges and the law of growth, where neither scene nor design give them"},
    {.path = "parachute.name", .binding = member<&Parachute::name>, .kind = text, .need = defaulted, .fallback = "main", .meaning = "what the parachute is called; with several, keys and metrics carry it"},
    {.path = "parachute.count", .binding = member<&Parachute::count>, .kind = integer, .need = defaulted, .fallback = "1", .range = from(1, 100),
     .meaning = "parachutes of this kind that open together, a cluster; all other keys are those of one"},
    {.path = "parachute.lag", .binding = member<&Parachute::lag>, .kind = quantities, .unit = "s", .need = optional, .fallback = "none", .range = from(0, 1000),
     .meaning = "of each in a cluster: by how much later its filling begins; as many as there are"},
    {.path = "parachute.skips_reefing", .binding = member<&Parachute::skips_reefing>, .kind = integer, .need = defaulted, .fallback = "0", .range = from(0, 100),
     .meaning = "canopies, the first of the cluster, whose reefing lines do not hold: they fill at once, a failure to size for"},
    {.path = "parachute.cluster_drag_ratio", .binding = member<&Parachute::cluster_drag_ratio>, .unit = "1", .need = defaulted, .fallback = "1", .range = above(0, 1.5),
     .meaning = "drag coefficient of one in the cluster over that of one alone", .source = "nothing taken off: our assumption; spread canopies lose some drag"},
    {.path = "parachute.nominal_diameter", .binding = member<&Parachute::nominal_diameter>, .unit = "m", .range = above(0, 200), .meaning = "D0"},
    {.path = "parachute.drag_area", .binding = BindingOf<Parachute>{.get = [](const Parachute& p) -> OptionalValue { return stated_drag_area(p); }}, .unit = "m^2", .range = above(0, 1e5), .instead_of = "parachute.drag_coefficient",
     .meaning = "(C_D S)_0 of the steady canopy"},
    {.path = "parachute.drag_coefficient", .unit = "1", .range = above(0, 5), .instead_of = "parachute.drag_area",
     .meaning = "C_D0 on the nominal area pi/4 D0^2"},
    {.path = "parachute.projected_diameter_ratio", .binding = unless_zero<&Parachute::projected_diameter_ratio>, .unit = "1", .need = optional, .fallback = "required by added mass and the full model", .range = above(0, 1),
     .meaning = "D_p/D0 of the steady canopy, sets the added mass while it fills"},
    {.path = "parachute.opening_force_coefficient", .binding = member<&Parachute::opening_force_coefficient>, .unit = "1", .need = optional, .fallback = "no formulas with it", .range = above(0, 5),
     .user = rom, .meaning = "C_x of the canopy's type at infinite mass, for estimates by formula; multiplies no integrated force"},
    {.path = "parachute.mass", .binding = member<&Parachute::mass>, .unit = "kg", .range = above(0, 1e4), .user = rom,
     .meaning = "canopy, lines and risers; the full model weighs its mesh"},
    {.path = "parachute.gores", .binding = unless_zero<&Parachute::gores>,
     .kind = integer, .need = optional, .fallback = "required by packed starts and the full model", .range = from(3, 400), .meaning = "gores, and as many lines; of a cross its lines, a quarter of them on each arm"},
    {.path = "parachute.vent_diameter", .binding = unless_zero<&Parachute::vent_diameter>,
     .unit = "m", .need = optional, .fallback = "required by the full model", .range = above(0, 200), .user = full, .meaning = "of a circle with the vent's area, across the axis"},
    {.path = "parachute.cone_angle", .binding = member<&Parachute::cone_angle>, .kind = quantities, .unit = "rad", .need = optional, .fallback = "those of the type", .range = {0, pi, false, true}, .user = full,
     .meaning = "constructed angle of each panel of a gore below the plane across the axis, from apex to skirt: [\"30 deg\"] of a conical canopy"},
    {.path = "parachute.panel_length", .binding = member<&Parachute::panel_length>, .kind = quantities, .unit = "1", .need = optional, .fallback = "those of the type", .range = above(0, 1000), .user = full,
     .meaning = "of each panel along the seam, from the apex on, over those of the others"},
    {.path = "parachute.panel", .kind = tables, .need = optional, .user = full,
     .meaning = "[[parachute.panel]], materials of each panel of a gore, from apex to skirt; of a cross, of the square in its middle and of its arms; absent: all as the parachute has them"},
    {.path = "parachute.panel.fabric", .binding = member<&PanelMaterials::fabric, &Fabric::name>, .kind = data_file, .need = optional, .fallback = "that of parachute.fabric", .folder = "materials", .user = full,
     .meaning = "of the panel"},
    {.path = "parachute.arm_ratio", .binding = member<&Parachute::arm_ratio>, .unit = "1", .need = optional, .fallback = "that of the type", .range = {0, 1, true, true}, .user = full,
     .meaning = "of a cross: width of its arms over its length from end to end; with D0 it gives both"},
    {.path = "parachute.corner_tie", .binding = unless_zero<&Parachute::corner_tie>, .unit = "m", .need = optional, .fallback = "D0/6", .range = above(0, 1000), .user = full,
     .meaning = "of a cross: cord from a corner of each arm to that of the next one, as made; longer than these corners lie apart in the flat cross it never acts",
     .source = "D0/6: assumption of this toolkit, D_p/D0 is then as in the handbook"},
    {.path = "parachute.line_length", .binding = unless_zero<&Parachute::line_length>,
     .unit = "m", .need = optional, .fallback = "required by packed starts and the full model", .range = above(0, 1000), .meaning = "suspension line, skirt to link"},
    {.path = "parachute.riser_length", .binding = unless_zero<&Parachute::riser_length>,
     .unit = "m", .need = optional, .fallback = "required by packed starts and the full model", .range = above(0, 1000), .meaning = "link to confluence"},
    {.path = "parachute.risers", .binding = unless_zero<&Parachute::risers>,
     .kind = integer, .need = optional, .fallback = "required by the full model", .range = from(1, 400), .user = full, .meaning = "links; a divisor of gores"},
    {.path = "parachute.fabric", .binding = member<&Parachute::fabric, &Fabric::name>,
     .kind = data_file, .need = optional, .fallback = "required by the full model", .folder = "materials", .meaning = "canopy fabric"},
    {.path = "parachute.line", .binding = member<&Parachute::line, &Cord::name>,
     .kind = data_file, .need = optional, .fallback = "required by packed starts and the full model", .folder = "materials", .meaning = "suspension line and riser cord"},
    {.path = "parachute.tapes.radial", .binding = of_tapes<&Tapes::radial>,
     .kind = data_file, .need = optional, .fallback = "required by the full model", .folder = "materials", .user = full, .meaning = "tape along the gore seams"},
    {.path = "parachute.tapes.skirt", .binding = of_tapes<&Tapes::skirt>, .kind = data_file, .need = optional, .fallback = "required by the full model", .folder = "materials", .user = full, .meaning = "tape around the skirt"},
    {.path = "parachute.tapes.vent", .binding = of_tapes<&Tapes::vent>, .kind = data_file, .need = optional, .fallback = "required by the full model", .folder = "materials", .user = full, .meaning = "tape around the vent"},
    {.path = "parachute.vent_lines", .kind = table, .need = optional, .user = full, .meaning = "lines from the edge of the vent; absent: none"},
    {.path = "parachute.vent_lines.model", .binding = word_of<vent_line_models, &Parachute::vent_lines, &VentLines::model>, .kind = word, .need = defaulted, .fallback = "pull-down", .choices = words_in<vent_line_models>, .user = full,
     .meaning = "pull-down: one from each seam to its suspension line, which hold the vent down; across: from each seam to the one opposite, for an even number of gores"},
    {.path = "parachute.vent_lines.length", .binding = of_vent_lines<&VentLines::length>, .unit = "m", .need = optional, .fallback = "by pull_down_ratio; across: as wide as the vent", .range = above(0, 1000), .instead_of = "parachute.vent_lines.pull_down_ratio", .user = full,
     .meaning = "of each, as made"},
    {.path = "parachute.vent_lines.pull_down_ratio", .binding = of_vent_lines<&VentLines::pull_down_ratio>, .unit = "1", .need = optional, .fallback = "by length", .range = below(0, 1), .instead_of = "parachute.vent_lines.length", .only_with = "pull-down", .user = full,
     .meaning = "1 - (length - joint)/seam from vent to skirt: 0 holds nothing down, 1 brings the vent down to the skirt of a canopy that is drawn out"},
    {.path = "parachute.vent_lines.joint", .binding = of_vent_lines<&VentLines::joint>, .unit = "m", .need = optional, .fallback = "line_length: at the link", .range = above(0, 1000), .only_with = "pull-down", .user = full,
     .meaning = "where they are tied to the suspension lines, below the skirt"},
    {.path = "parachute.vent_lines.cord", .binding = of_vent_lines<&VentLines::cord, &Cord::name>, .kind = data_file, .need = optional, .fallback = "that of parachute.line", .folder = "materials", .user = full,
     .meaning = "of vent lines"},
    {.path = "parachute.mesh", .binding = member<&Parachute::mesh, &MeshFile::name>, .kind = mesh_file, .need = optional, .fallback = "generated from the sizes above", .user = full,
     .meaning = "a mesh of one's own in place of the generated one, Gmsh 2.2 or 4.1 in ASCII", .source = "docs/guide/meshes.md"},
    {.path = "parachute.joint_efficiency", .binding = member<&Parachute::strength, &StrengthFactors::joint_efficiency>, .unit = "1", .need = defaulted, .fallback = "1", .range = above(0, 1), .user = full,
     .meaning = "strength of seams and joints over that of fabric and line, for the margins", .source = "nothing taken off: our assumption; it belongs to the joint"},
    {.path = "parachute.design_factor", .binding = member<&Parachute::strength, &StrengthFactors::design_factor>, .unit = "1", .need = defaulted, .fallback = "1", .range = from(1, 100), .user = full,
     .meaning = "loads times this are held against the strength, for the margins", .source = "nothing added: our assumption; safety, uneven load and wear belong here"},
    {.path = "parachute.deploy.by", .binding = deploy_by, .kind = word, .choices = names_of<deployment_rows>,
     .meaning = "how it leaves its pack; line-stretch and inflated: the scene starts with lines and canopy drawn out"},
    {.path = "parachute.deploy.length", .binding = of_deploy<&Deployment::static_line_length>, .unit = "m", .range = above(0, 1000), .only_with = "static-line",
     .meaning = "of the static line, from its anchor to the apex"},
    {.path = "parachute.deploy.anchor", .binding = word_of<anchors, &Parachute::deploy, &Deployment::anchor_moves>, .kind = word, .need = defaulted, .fallback = "aircraft", .choices = words_in<anchors>,
     .only_with = "static-line", .meaning = "of the static line: flies on at the speed of the release, or stands still", .formerly = "parachute.deploy.far_end"},
    {.path = "parachute.deploy.force", .binding = extraction_force, .unit = "N", .range = above(0, 1e7), .instead_of = "parachute.deploy.force_table",
     .only_with = "extraction", .meaning = "pulls the parachute straight behind the release, until snatch at the latest",
     .source = "paper 2.1"},
    {.path = "parachute.deploy.duration", .binding = of_deploy<&Deployment::extraction, &ForceHistory::duration>, .unit = "s", .need = defaulted, .fallback = "36000", .range = above(0, 36000),
     .only_with = "extraction", .meaning = "of that force, from where its parachute begins to deploy; beside a force_table it cuts it short"},
    {.path = "parachute.deploy.force_table", .binding = of_deploy<&Deployment::extraction, &ForceHistory::table>, .kind = csv_file, .need = optional, .fallback = "deploy.force",
     .instead_of = "parachute.deploy.force", .only_with = "extraction", .meaning = "columns time and force; none after its end"},
    {.path = "parachute.deploy.load", .binding = word_of<extraction_loads, &Parachute::deploy, &Deployment::extraction_on_apex>, .kind = word, .need = defaulted, .fallback = "point", .choices = words_in<extraction_loads>,
     .only_with = "extraction", .user = full, .meaning = "where it acts: on the apex, or on the canopy by area"},
    {.path = "parachute.deploy.pitch", .binding = of_deploy<&Deployment::pitch>, .unit = "rad", .need = defaulted, .fallback = "0", .range = from(-pi, pi),
     .only_with = packed, .user = full, .meaning = "of the pack from the line straight behind the release, apex up"},
    {.path = "parachute.deploy.pack_ratio", .binding = of_deploy<&Deployment::pack_ratio>, .unit = "1", .need = defaulted, .fallback = "0.01", .range = above(0, 0.5),
     .only_with = packed, .user = full, .meaning = "length of the pack over that of the parachute drawn out",
     .source = "paper 4: compressed to a very small length"},
    {.path = "parachute.deploy.drag_coefficient", .binding = of_deploy<&Deployment::drag_coefficient>, .unit = "1", .need = defaulted, .fallback = "0.1", .range = from(0, 5),
     .only_with = packed, .user = full, .meaning = "of the canopy's fabric until snatch, on its area across the air",
     .source = "paper 3.2.1; flags and windsocks, assumption of this toolkit"},
    {.path = "parachute.deploy.pack_drag_area", .binding = unless_zero<&Parachute::deploy, &Deployment::pack_drag_area>, .unit = "m^2", .need = optional, .range = from(0, 1e4),
     .only_with = "static-line|free|extraction|mortar", .user = rom, .meaning = "C_D S of the pack until line stretch"},
    {.path = "parachute.deploy.compressive_stiffness_ratio", .binding = of_deploy<&Deployment::compressive_stiffness_ratio>, .unit = "1", .need = defaulted, .fallback = "1e-5", .range = from(0, 1),
     .only_with = packed, .user = full, .meaning = "of folded fabric, over its stiffness in tension", .source = "paper 2.1", .formerly = "parachute.deploy.fold_repulsion"},
    {.path = "parachute.deploy.deployment_resistance", .binding = of_deploy<&Deployment::deployment_resistance>, .unit = "N/m", .need = defaulted, .fallback = "2", .range = from(0, 1e5),
     .only_with = packed, .user = full, .meaning = "of folded fabric against being drawn out, per width; lines come first",
     .source = "paper 5.2: a small force, value not printed; assumption of this toolkit", .formerly = "parachute.deploy.fold_resistance"},
    {.path = "parachute.deploy.pilot_drag_area", .binding = of_deploy<&Deployment::pack_drag_area>, .unit = "m^2", .range = above(0, 1e4), .only_with = "pilot",
     .meaning = "C_D S of the pilot chute that draws the pack out"},
    {.path = "parachute.deploy.muzzle_speed", .binding = of_deploy<&Deployment::muzzle_speed>, .unit = "m/s", .range = above(0, 200), .only_with = "mortar",
     .meaning = "of the pack relative to the payload, straight behind it; the payload recoils"},
    {.path = "parachute.deploy.when", .kind = table, .need = optional,
     .meaning = "what deployment waits for; absent: it begins at release"},
    {.path = "parachute.drag_area_law", .binding = row_of<find_drag_area_law, &Parachute::drag_area_law>, .kind = word, .need = defaulted, .fallback = "ludtke", .choices = names_of<drag_area_laws>,
     .instead_of = "parachute.drag_area_table|parachute.drag_area_exponent", .meaning = "growth of the drag area", .source = "paper Eqs 14-15; power laws: Knacke NWC TP 6575, Fig. 5-51"},
    {.path = "parachute.calibration", .binding = file_of<&Parachute::calibration>, .kind = csv_file, .need = optional, .user = rom,
     .meaning = "columns run, payload_mass, airspeed and air_density at release, and factors on inputs of this table, e.g. fill_time.n and drag_area: what makes the reduced-order model that of a family of full runs; written by `twinchute calibrate --to RECORD`"},
    {.path = "parachute.drag_area_exponent", .binding = member<&Parachute::drag_area_exponent>, .unit = "1", .need = optional, .fallback = "drag_area_law", .range = from(0.5, 12),
     .instead_of = "parachute.drag_area_law|parachute.drag_area_table", .meaning = "j of a growth with (t/t_f)^j above the initial drag area: any power, where the laws have five", .source = "Knacke NWC TP 6575, Fig. 5-51"},
    {.path = "parachute.drag_area_table", .binding = file_of<&Parachute::drag_area_table>, .kind = csv_file, .need = optional, .fallback = "drag_area_law",
     .instead_of = "parachute.drag_area_law|parachute.drag_area_exponent|parachute.initial_drag_area_ratio",
     .meaning = "columns fill_fraction and drag_area_ratio: (C_D S)/(C_D S)_0 from snatch or the end of the initial phase, at 0, to full open, at 1, and back to 1 beyond that where the canopy over-inflates"},
    {.path = "parachute.drag_area_mach_table", .binding = file_of<&Parachute::drag_area_mach_table>, .kind = csv_file, .need = optional, .fallback = "one drag area at all Mach numbers",
     .meaning = "columns mach_number and drag_area_factor, on drag_area by the Mach number of the air; its ends hold beyond them"},
    {.path = "parachute.initial_drag_area_ratio", .binding = member<&Parachute::initial_drag_area_ratio>, .unit = "1", .need = defaulted, .fallback = "0.04", .range = below(0, 1),
     .instead_of = "parachute.drag_area_table", .meaning = "(C_D S)_i/(C_D S)_0 = eta^2; dominates the peak force", .source = "assumption of this toolkit, eta = 0.2"},
    {.path = "parachute.initial_phase", .binding = initial_phase, .kind = quantity_or_word, .unit = "s", .need = defaulted, .fallback = "transit",
     .range = from(0, 1000), .choices = listed<phases>, .meaning = "t_i from snatch to the rise of the drag area; transit: 0.5 D0/v_s",
     .source = "paper 3.2.2"},
    {.path = "parachute.filling.model", .binding = row_of<find_filling, &Parachute::filling, &Filling::model>, .kind = word, .need = optional, .fallback = "prescribed", .choices = fillings,
     .meaning = "prescribed: by fill_time and drag_area_law; the others say how long it fills and how its drag area grows, in place of those; filling = \"predicted\" is short for it",
     .source = "docs/theory/filling.md"},
    {.path = "parachute.filling.initial_mouth", .binding = of_filling<&Filling::initial_mouth>, .unit = "1", .need = defaulted, .fallback = "0.005", .range = from(1e-5, 0.5), .only_with = predicted,
     .meaning = "area of the bulb at snatch over that of the steady canopy; the filling time is never printed without it and its bracket",
     .source = "calibrated on n = 8 of a C-9 at 45.7 to 152 m/s: the one input that is"},
    {.path = "parachute.filling.lowest_mouth", .binding = of_filling<&Filling::lowest_mouth>, .unit = "1", .need = defaulted, .fallback = "0.002", .range = from(1e-5, 0.5), .only_with = predicted,
     .meaning = "lower end of the bracket of initial_mouth", .source = "our assumption"},
    {.path = "parachute.filling.highest_mouth", .binding = of_filling<&Filling::highest_mouth>, .unit = "1", .need = defaulted, .fallback = "0.04", .range = from(1e-5, 0.5), .only_with = predicted,
     .meaning = "upper end of it", .source = "our assumption; the drag area that prescribed openings begin with"},
    {.path = "parachute.filling.entrance_loss", .binding = of_filling<&Filling::entrance_loss>, .unit = "1", .need = defaulted, .fallback = "2", .range = from(0.5, 50), .only_with = predicted,
     .meaning = "K: dynamic pressures of the entering air that the mouth costs",
     .source = "a re-entrant inlet loses 1, its velocity head 1: handbook analogy"},
    {.path = "parachute.permeability", .binding = member<&Parachute::permeability>, .unit = "m/s", .need = optional, .fallback = "that of parachute.fabric", .range = from(0, 100),
     .meaning = "of the canopy's fabric at half an inch of water, \"90 ft^3/min/ft^2\"; 0: coated fabric; in place of the fabric's own, for a predicted filling and fill_time.model \"ludtke\"", .formerly = "parachute.fill_time.permeability|parachute.reefing.fill_time.permeability"},
    {.path = "parachute.geometric_porosity", .binding = member<&Parachute::geometric_porosity>, .unit = "1", .need = defaulted, .fallback = "0", .range = below(0, 1),
     .meaning = "lambda_g, open over total area: slots, and the vent if it counts, for a predicted filling, fill_time.model \"ribbon\" and added_mass.model \"porosity\"", .source = "solid fabric, the vent left out",
     .formerly = "parachute.fill_time.geometric_porosity|parachute.reefing.fill_time.geometric_porosity|aerodynamics.added_mass.porosity"},
    {.path = "parachute.reefing", .kind = tables, .need = optional,
     .meaning = "[[parachute.reefing]], stages with the mouth held together, from the first on; absent: none"},
    {.path = "parachute.reefing.drag_area_ratio", .binding = member<&Reefing::drag_area_ratio>, .unit = "1", .range = {0, 1, true, true},
     .meaning = "(C_D S) of the reefed canopy over (C_D S)_0; rises from stage to stage"},
    {.path = "parachute.reefing.line_length", .binding = member<&Reefing::line_length>, .unit = "m", .need = optional, .fallback = "pi D_p sqrt(drag_area_ratio)",
     .range = above(0, 1000), .user = full, .meaning = "of the reefing line, once around the mouth"},
    {.path = "parachute.reefing.fill_time", .kind = table, .need = optional,
     .meaning = "time of the filling to this stage; absent: as parachute.fill_time"},
    {.path = "parachute.cut", .kind = table, .need = optional,
     .meaning = "when the parachute is let go; absent: never"},

    {.path = "aerodynamics.added_mass", .kind = table, .need = optional, .meaning = "air that moves with the canopy"},
    {.path = "aerodynamics.added_mass.model", .binding = row_of<find_added_mass, &Scene::aerodynamics, &Aerodynamics::added_mass, &AddedMassSpec::model>,
     .kind = word, .need = defaulted, .fallback = "hemisphere", .choices = added_masses,
     .meaning = "volume of that air", .source = "paper Eqs 16 and 18"},
    {.path = "aerodynamics.added_mass.momentum", .binding = word_of<momentums, &Scene::aerodynamics, &Aerodynamics::added_mass, &AddedMassSpec::momentum>,
     .kind = word, .need = defaulted, .fallback = "inertia-only", .choices = words_in<momentums>,
     .meaning = "what becomes of the momentum of air that joins", .source = "paper 3.3"},
    {.path = "aerodynamics.added_mass.radius", .binding = word_of<radii, &Scene::aerodynamics, &Aerodynamics::added_mass, &AddedMassSpec::open_radius>,
     .kind = word, .need = defaulted, .fallback = "shape-once-open", .choices = words_in<radii>,
     .user = full, .meaning = "of the open canopy: of its own shape, or R_0 = D_p/2 as in the reduced-order model", .source = "paper 3.3"},
    {.path = "aerodynamics.added_mass.depth_ratio", .binding = of_added_mass<&AddedMassSpec::depth_ratio>, .unit = "1", .need = defaulted, .fallback = "0.41", .range = above(0, 2),
     .only_with = "half-ellipsoid|porosity", .meaning = "depth of the canopy over its projected diameter, h_p/D_p",
     .source = "Ewing, quoted in the paper, 5.2 (its own simulation: 0.45)"},
    {.path = "aerodynamics.line_drag", .kind = table, .need = optional, .user = full, .meaning = "drag of the suspension lines"},
    {.path = "aerodynamics.line_drag.model", .binding = line_drag, .kind = word, .need = defaulted, .fallback = "cylinder", .choices = listed<line_drags>,
     .user = full, .meaning = "cross-flow drag against Reynolds number", .source = "paper Eq. 10; Wieselsberger"},
    {.path = "aerodynamics.breathing_damping", .kind = table, .need = optional, .user = full,
     .meaning = "air resists fabric that moves relative to the canopy"},
    {.path = "aerodynamics.breathing_damping.k", .binding = member<&Scene::aerodynamics, &Aerodynamics::breathing_damping>, .unit = "1", .need = defaulted, .fallback = "0.5", .range = from(0, 100),
     .user = full, .meaning = "its coefficient", .source = "assumption of this toolkit; 0.2 to 2 give the same peak"},
    {.path = "aerodynamics.radial_pressure", .binding = member<&Scene::aerodynamics, &Aerodynamics::radial_pressure>, .unit = "1", .need = defaulted, .fallback = "0.8", .range = from(0, 5), .user = full,
     .meaning = "phi(t_f) of Eq. 12", .source = "gives the paper's steady shape; the paper prints 0.5"},

    {.path = "aerodynamics.line_ratio", .kind = table, .need = optional,
     .meaning = "corrects (C_D S)_0, as of lines of D0, for lines and risers of another length"},
    {.path = "aerodynamics.line_ratio.model", .binding = row_of<find_line_ratio, &Scene::aerodynamics, &Aerodynamics::line_ratio>,
     .kind = word, .need = defaulted, .fallback = "flat-circular", .choices = names_of<line_ratio_models>,
     .meaning = "kind of canopy", .source = "Knacke NWC TP 6575, Fig. 5-20"},
    {.path = "aerodynamics.forebody_wake", .kind = table, .need = optional,
     .meaning = "corrects (C_D S)_0, as of a canopy in free air, for the wake of the payload"},
    {.path = "aerodynamics.forebody_wake.model", .binding = row_of<find_forebody_wake, &Scene::aerodynamics, &Aerodynamics::forebody_wake>,
     .kind = word, .need = defaulted, .fallback = "knacke", .choices = names_of<forebody_wake_models>,
     .meaning = "loss against distance and size", .source = "Knacke NWC TP 6575, Fig. 5-21"},

    {.path = "stop.at", .binding = chain<AtEvent, &Scene::stop>, .kind = word, .need = defaulted, .fallback = "steady-descent", .choices = listed<stops>,
     .instead_of = "stop.time|stop.altitude|stop.height", .meaning = "the event that ends the run; line-stretch: the snatch"},
    {.path = "stop.time", .binding = chain<Condition<Trigger::Kind::time>, &Scene::stop>, .unit = "s", .need = optional, .fallback = "stop.at", .range = above(0, 36000),
     .instead_of = "stop.at|stop.altitude|stop.height", .meaning = "since release"},
    {.path = "stop.altitude", .binding = chain<Condition<Trigger::Kind::altitude>, &Scene::stop>, .unit = "m", .need = optional, .fallback = "stop.at", .range = from(-5000, 86000),
     .instead_of = "stop.at|stop.time|stop.height", .meaning = "above sea level that the payload falls to"},
    {.path = "stop.height", .unit = "m", .need = optional, .fallback = "stop.at", .range = from(0, 86000),
     .instead_of = "stop.at|stop.time|stop.altitude", .meaning = "above ground that the payload falls to"},
    {.path = "stop.delay", .binding = member<&Scene::stop, &Trigger::delay>, .unit = "s", .need = defaulted, .fallback = "0", .range = from(0, 36000), .meaning = "after that"},
    {.path = "stop.then", .binding = member<&Scene::then>, .kind = word, .need = optional, .fallback = "the run ends", .choices = listed<successors>,
     .meaning = "the model that flies the rest of the fall, to the ground, from the open canopy that the run stopped with", .source = "docs/guide/long-runs.md"},

    {.path = "rom.method", .binding = member<&Scene::rom, &RomSettings::method>, .kind = word, .need = defaulted, .fallback = "auto", .choices = listed<methods>, .user = rom,
     .meaning = "auto: dormand-prince, and bdf for a long steady descent; else a Runge-Kutta pair, explicit or (kvaerno) implicit; or multistep method: adams, or bdf for stiff problems", .source = "SUNDIALS ARKODE and CVODE"},
    {.path = "rom.rtol", .binding = member<&Scene::rom, &RomSettings::rtol>, .unit = "1", .need = defaulted, .fallback = "1e-6", .range = from(1e-14, 0.1), .user = rom,
     .meaning = "relative tolerance of position and velocity"},

    {.path = "full.mesh.gore_columns", .binding = of_full<&FullSettings::mesh, &MeshCounts::gore_columns>, .kind = integer, .need = defaulted, .fallback = "2", .range = from(1, 64), .user = full,
     .meaning = "elements across a gore"},
    {.path = "full.mesh.gore_rows", .binding = of_full<&FullSettings::mesh, &MeshCounts::gore_rows>, .kind = integer, .need = defaulted, .fallback = "17", .range = from(2, 1000), .user = full,
     .meaning = "elements from vent to skirt", .source = "about the paper's 1932 triangles on 28 gores"},
    {.path = "full.mesh.grading", .binding = word_of<gradings, &Scene::full, &FullSettings::mesh, &MeshCounts::grading>, .kind = word, .need = defaulted, .fallback = "graded", .choices = words_in<gradings>, .user = full,
     .meaning = "uniform: as many across at the vent as at the skirt, all equally long; graded: one across a gore at the vent, longer ones beside it",
     .source = "docs/theory/full-model.md"},
    {.path = "full.mesh.line_elements", .binding = of_full<&FullSettings::mesh, &MeshCounts::line_elements>, .kind = integer, .need = defaulted, .fallback = "31", .range = from(1, 2000), .user = full,
     .meaning = "cables a suspension line", .source = "about the paper's 1461 cables on 28 gores"},
    {.path = "full.mesh.riser_elements", .binding = of_full<&FullSettings::mesh, &MeshCounts::riser_elements>, .kind = integer, .need = defaulted, .fallback = "5", .range = from(1, 2000), .user = full,
     .meaning = "cables a riser"},
    {.path = "full.symmetry", .binding = word_of<symmetries, &Scene::full, &FullSettings::symmetry>, .kind = word, .need = defaulted, .fallback = "none", .choices = words_in<symmetries>, .user = full,
     .meaning = "none: the whole canopy; sector: one gore under one riser, else the gores of one riser, without folds that differ between sectors",
     .source = "docs/theory/full-model.md"},
    {.path = "full.structure", .binding = word_of<structures, &Scene::full, &FullSettings::structure>, .kind = word, .need = defaulted, .fallback = "msd-fe", .choices = words_in<structures>, .user = full,
     .meaning = "of a packed start: springs and dashpots until the canopy begins to fill, or finite elements throughout",
     .source = "paper 2"},
    {.path = "full.contact", .binding = word_of<contacts, &Scene::full, &FullSettings::contact>, .kind = word, .need = defaulted, .fallback = "none", .choices = words_in<contacts>, .user = full,
     .meaning = "none: fabric passes through fabric; gores: the fabric of a gore stays between its seams, on a generated mesh that starts at line stretch or inflated; self: nodes of fabric and lines do not pass through triangles of fabric, on any mesh that starts at line stretch or inflated",
     .source = "docs/theory/full-model.md"},
    {.path = "full.contact_friction", .binding = of_full<&FullSettings::contact_friction>, .unit = "1", .need = defaulted, .fallback = "0.2", .range = from(0, 2), .user = full,
     .meaning = "coefficient of friction of fabric and lines on fabric, with full.contact = \"self\"",
     .source = "assumption of this toolkit"},
    {.path = "full.switch_area_ratio", .binding = of_full<&FullSettings::switch_area_ratio>, .unit = "1", .need = defaulted, .fallback = "0.12", .range = from(0, 1), .user = full,
     .meaning = "mouth over steady projected area at which finite elements take over", .source = "paper 4: 10 to 20 %"},
    {.path = "full.ramp_time", .binding = of_full<&FullSettings::ramp_time>, .unit = "s", .need = optional, .fallback = "0.135 D0/v", .range = above(0, 10), .user = full,
     .meaning = "over which their stiffness grows; v: the steady speed of the open canopy", .source = "docs/theory/deployment.md"},
    {.path = "full.beta", .binding = of_full<&FullSettings::beta>, .unit = "s", .need = defaulted, .fallback = "0", .range = from(0, 10), .user = full,
     .meaning = "stiffness-proportional damping of cables and of spring-dashpot edges", .source = "paper Eq. 3"},
    {.path = "full.alpha", .binding = of_full<&FullSettings::alpha>, .unit = "1/s", .need = defaulted, .fallback = "0", .range = from(0, 1e4), .user = full,
     .meaning = "mass-proportional damping about the mean motion", .source = "paper Eq. 4"},
    {.path = "full.alpha_from", .binding = word_of<alpha_begins, &Scene::full, &FullSettings::alpha_from_release>, .kind = word, .need = defaulted, .fallback = "snatch", .choices = words_in<alpha_begins>, .user = full,
     .meaning = "when it begins: while the parachute is drawn out it would hold it back", .source = "docs/theory/deployment.md"},
    {.path = "full.bulk_viscosity", .binding = of_full<&FullSettings::bulk_viscosity>, .unit = "1", .need = defaulted, .fallback = "0.06", .range = from(0, 2), .user = full,
     .meaning = "b1 of the cables", .source = "paper Eq. 3"},
    {.path = "full.time_step_factor", .binding = of_full<&FullSettings::time_step_factor>, .unit = "1", .need = defaulted, .fallback = "0.95", .range = above(0, 4), .user = full,
     .meaning = "share of the bound on the critical time step; above 1 is for tests of stability; where a run without it does not conserve energy, half and a quarter of it follow", .source = "docs/theory/full-model.md"},
    {.path = "full.line_substeps", .binding = of_full<&FullSettings::line_substeps>, .kind = integer, .need = defaulted, .fallback = "4", .range = from(1, 100), .user = full,
     .meaning = "most steps that lines and risers take within one of the canopy, where theirs is shorter", .source = "docs/theory/full-model.md"},
    {.path = "full.mass_scaling", .binding = of_full<&FullSettings::mass_scaling>, .unit = "1", .need = defaulted, .fallback = "0", .range = from(0, 1e-3), .user = full,
     .meaning = "share of the mass of canopy and steady air that is added to the nodes that set the step", .source = "docs/theory/full-model.md"},
    {.path = "full.strain_limit", .binding = of_full<&FullSettings::strain_limit>, .unit = "1", .need = defaulted, .fallback = "0.5", .range = above(0, 10), .user = full,
     .meaning = "a run that strains an element further ends", .source = "nylon cord breaks at about 0.3"},
    {.path = "full.output_rate", .binding = of_full<&FullSettings::output_rate>, .unit = "1/s", .need = defaulted, .fallback = "200", .range = above(0, 1e5), .user = full,
     .meaning = "rows of the history per second"},
    {.path = "full.fields_rate", .binding = of_full<&FullSettings::fields_rate>, .unit = "1/s", .need = optional, .fallback = "no fields", .range = above(0, 1e5), .user = full,
     .meaning = "frames of the fields per second, for VTK"},
    {.path = "full.checkpoint_interval", .binding = of_full<&FullSettings::checkpoint_interval>, .unit = "s", .need = defaulted, .fallback = "30", .range = from(0, 86400), .user = full,
     .meaning = "of wall time, from one checkpoint to the next, for --resume; 0: none", .source = "docs/guide/long-runs.md"},
    {.path = "full.noise", .kind = table, .need = optional, .user = full, .meaning = "initial disturbance of the canopy nodes"},
    {.path = "full.noise.amplitude", .binding = of_full<&FullSettings::noise, &Noise::amplitude>, .unit = "m", .range = from(0, 1), .user = full, .meaning = "half edge of the cube it is drawn from"},
    {.path = "full.noise.seed", .binding = of_full<&FullSettings::noise, &Noise::seed>, .kind = integer, .need = defaulted, .fallback = "1", .range = from(0, 9e15), .user = full,
     .meaning = "of the random numbers"},

    {.path = "compare.tolerance", .kind = tolerance, .need = optional, .range = from(0, 1e12), .user = compare,
     .meaning = "by metric: \"10 %\" of the full model, or a value in the metric's unit"},

    {.path = "series", .kind = table, .need = optional, .meaning = "how the cases of a series are shown together"},
    {.path = "series.x", .binding = of_series<&SeriesSpec::x>, .kind = word, .need = defaulted, .fallback = "froude_number", .choices = names_of<metric_rows>, .user = compare,
     .meaning = "metric along the plot's axis"},
    {.path = "series.y", .binding = of_series<&SeriesSpec::y>, .kind = word, .need = defaulted, .fallback = "peak_force_ratio", .choices = names_of<metric_rows>, .user = compare,
     .meaning = "metric up the plot's axis"},
    {.path = "series.group", .binding = of_series<&SeriesSpec::group>, .kind = text, .need = optional, .fallback = "all cases are one", .user = compare,
     .meaning = "of a case, in its set: cases of one group are joined by lines and stand in the legend"},
    {.path = "series.test", .binding = of_series<&SeriesSpec::test>, .kind = csv_file, .need = optional, .fallback = "no test data", .user = compare,
     .meaning = "points of a test to show beside the runs: columns named as the metrics of x and y, sorted by x"},

    {.path = "uncertainty", .kind = table, .need = optional, .user = KeyUser::campaign,
     .meaning = "what is known of calibrated inputs, normal about the scene's values: a campaign draws them together; written by `twinchute calibrate`"},
    {.path = "uncertainty.inputs", .binding = of_uncertainty<&Uncertainty::inputs>, .kind = list, .user = KeyUser::campaign,
     .meaning = "keys of numbers, e.g. \"parachute.drag_area\", or \"ln \" and a key: of its logarithm"},
    {.path = "uncertainty.covariance", .binding = of_uncertainty<&Uncertainty::covariance>, .kind = quantities, .unit = "1", .user = KeyUser::campaign,
     .meaning = "in SI, of the inputs in their order: the lower triangle, row by row"},

    {.path = "size", .kind = table, .need = optional, .meaning = "what `twinchute size` has to meet: at least one limit"},
    {.path = "size.max_descent_rate", .binding = of_size<&SizeSpec::max_descent_rate>, .unit = "m/s", .need = optional, .fallback = "no limit", .range = above(0, 1000), .user = KeyUser::size,
     .meaning = "mean over the last window of the run, once it is steady"},
    {.path = "size.max_force", .binding = of_size<&SizeSpec::max_force>, .unit = "N", .need = optional, .fallback = "no limit", .range = above(0, 1e9), .user = KeyUser::size,
     .meaning = "largest opening force of the run, snatch included"},
    {.path = "size.max_canopy_force", .binding = of_size<&SizeSpec::max_canopy_force>, .unit = "N", .need = optional, .fallback = "no limit", .range = above(0, 1e9), .user = KeyUser::size,
     .meaning = "largest force of any single canopy, at the confluence; of one alone the opening force"},
    {.path = "size.max_deceleration", .binding = of_size<&SizeSpec::max_deceleration>, .unit = "m/s^2", .need = optional, .fallback = "no limit", .range = above(0, 1e5), .user = KeyUser::size,
     .meaning = "of the payload, e.g. \"5 g0\""},
    {.path = "size.parachute", .binding = of_size<&SizeSpec::parachute>, .kind = text, .need = optional, .fallback = "the one that the payload lands under", .user = KeyUser::size,
     .meaning = "name of the one that is sized"},
    {.path = "size.vary", .binding = of_size<&SizeSpec::vary>, .kind = list, .need = defaulted, .fallback = "nominal_diameter", .choices = listed<varied>, .user = KeyUser::size,
     .meaning = "in the order in which they are decided on: the smallest diameter, the largest speed; ratio and delay of the first reefed stage with the least load"},
    {.path = "size.types", .binding = size_types, .kind = list, .need = optional, .fallback = "the scene's canopy alone", .folder = "parachutes/types", .user = KeyUser::size,
     .meaning = "types of canopy to compare"},
};

constexpr Key material_rows[] = {
    {.path = "fabric.kind", .kind = word, .choices = listed<fabrics>, .user = full, .meaning = "\"fabric\""},
    {.path = "fabric.density", .binding = member<&Fabric::density>, .unit = "kg/m^3", .range = above(0, 1e5), .user = full, .meaning = "of the material"},
    {.path = "fabric.youngs_modulus", .binding = member<&Fabric::youngs_modulus>, .unit = "Pa", .range = above(0, 1e13), .user = full, .meaning = "in both directions"},
    {.path = "fabric.poisson_ratio", .binding = member<&Fabric::poisson_ratio>, .unit = "1", .range = below(0, 0.5), .user = full, .meaning = "in the plane"},
    {.path = "fabric.thickness", .binding = member<&Fabric::thickness>, .unit = "m", .range = above(0, 0.1), .user = full, .meaning = "of the sheet"},
    {.path = "fabric.strength", .binding = member<&Fabric::strength>, .unit = "N/m", .need = optional, .fallback = "no margin", .range = above(0, 1e7), .user = full,
     .meaning = "at which a strip breaks, over its width"},
    {.path = "fabric.permeability.alpha", .binding = member<&Fabric::permeability, &Permeability::alpha>, .unit = "Pa*s/m", .need = optional, .fallback = "unknown", .range = from(0, 1e9),
     .instead_of = "fabric.permeability.speed", .user = rom, .meaning = "of dp = alpha u + beta u^2, air through the fabric"},
    {.path = "fabric.permeability.beta", .binding = member<&Fabric::permeability, &Permeability::beta>, .unit = "Pa*s^2/m^2", .need = optional, .fallback = "unknown", .range = from(0, 1e9),
     .instead_of = "fabric.permeability.speed", .user = rom, .meaning = "of that law"},
    {.path = "fabric.permeability.speed", .binding = fabric_speed, .unit = "m/s", .need = optional, .fallback = "alpha and beta", .range = from(0, 100),
     .instead_of = "fabric.permeability.alpha|fabric.permeability.beta", .user = rom,
     .meaning = "through the fabric at half an inch of water, with the shape of the law of MIL-C-7020; permeability = \"90 ft^3/min/ft^2\" is short for it"},
    {.path = "cord.kind", .kind = word, .choices = listed<cords>, .user = full, .meaning = "\"cord\""},
    {.path = "cord.density", .binding = member<&Cord::density>, .unit = "kg/m^3", .range = above(0, 1e5), .user = full, .meaning = "of the solid round section"},
    {.path = "cord.youngs_modulus", .binding = member<&Cord::youngs_modulus>, .unit = "Pa", .range = above(0, 1e13), .user = full, .meaning = "in tension"},
    {.path = "cord.diameter", .binding = member<&Cord::diameter>, .unit = "m", .range = above(0, 1), .user = full, .meaning = "of that section, and what the air sees"},
    {.path = "cord.strength", .binding = member<&Cord::strength>, .unit = "N", .need = optional, .fallback = "no margin", .range = above(0, 1e8), .user = full,
     .meaning = "at which it breaks"},
};
// clang-format on

}  // namespace

namespace {

/// Keys that stand below several tables: which, below what, behind which row, and who reads them.
struct Family {
    std::span<const Key> rows;
    std::string_view table;
    std::string_view behind;
    KeyUser user;
};

constexpr Family families[] = {
    {trigger_rows, "parachute.deploy.when", "parachute.deploy.when", both},
    {fill_time_rows, "parachute.fill_time", "parachute.deploy.when", both},
    {fill_time_rows, "parachute.reefing.fill_time", "parachute.reefing.fill_time", both},
    {trigger_rows, "parachute.reefing.until", "parachute.reefing.fill_time", both},
    {trigger_rows, "parachute.cut", "parachute.cut", both},
};

/// Rows with the names that were put together for them.
struct SceneRows {
    std::deque<std::string> names;
    std::vector<Key> rows;

    std::string_view keep(std::string name) { return names.emplace_back(std::move(name)); }

    void add(const Family& family) {
        const auto path = [&](const Key& row) { return fmt::format("{}.{}", family.table, row.path); };
        std::vector<std::string> conditions;  // a trigger has exactly one
        if (family.rows.data() == trigger_rows)
            for (const Key& row : family.rows)
                if (row.path != "delay") conditions.push_back(path(row));
        for (Key row : family.rows) {
            const std::string full = path(row);
            if (std::ranges::count(conditions, full) != 0) {
                std::vector<std::string> others = conditions;
                std::erase(others, full);
                row.instead_of = keep(fmt::format("{}", fmt::join(others, "|")));
                if (row.need == optional)
                    row.fallback =
                        keep(fmt::format("{}.at", family.table.substr(family.table.rfind('.') + 1)));
            }
            row.path = keep(full);
            row.user = family.user;
            rows.push_back(row);
        }
    }
};

}  // namespace

std::span<const Key> scene_keys() {
    static const SceneRows all = [] {
        SceneRows built;
        for (const Key& row : scene_rows) {
            built.rows.push_back(row);
            for (const Family& family : families)
                if (family.behind == row.path) built.add(family);
        }
        return built;
    }();
    return all.rows;
}

std::span<const Key> design_keys() {
    static const std::vector<Key> rows = [] {
        std::vector<Key> chosen;
        for (const Key& row : scene_keys())
            if (row.path.starts_with("parachute.") && row.path != "parachute.design" &&
                !row.path.starts_with("parachute.deploy.") && !row.path.starts_with("parachute.cut"))
                chosen.push_back(row);
        return chosen;
    }();
    return rows;
}

std::span<const Key> material_keys() {
    return material_rows;
}

std::span<const Key> fabric_keys() {
    const auto split = std::ranges::find(material_rows, "cord.kind", &Key::path);
    return {std::begin(material_rows), split};
}

std::span<const Key> cord_keys() {
    return material_keys().subspan(fabric_keys().size());
}

}  // namespace twinchute
