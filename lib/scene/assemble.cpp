#include "lib/scene/assemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/scene/canopy_types.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/opening_tables.hpp"
#include "lib/scene/scale_canopy.hpp"
#include "lib/scene/soundings.hpp"

namespace twinchute {
namespace {

std::optional<double> optional_number(const Values& v, std::string_view key) {
    return v.given(key) ? std::optional(v.number(key)) : std::nullopt;
}

/// Materials as a scene names them, each file read once a key.
class Materials {
public:
    Materials(const Values& values, std::vector<Input>& inputs) : values_(values), inputs_(inputs) {}

    Fabric fabric(const std::string& key) {
        const Values m = read(key, {fabric_keys(), "fabric.", InputOrigin::design, key});
        return {values_.word(key),
                m.number("fabric.density"),
                m.number("fabric.youngs_modulus"),
                m.number("fabric.poisson_ratio"),
                m.number("fabric.thickness"),
                optional_number(m, "fabric.strength")};
    }

    Cord cord(const std::string& key) {
        const Values m = read(key, {cord_keys(), "cord.", InputOrigin::design, key});
        return {values_.word(key), m.number("cord.density"), m.number("cord.youngs_modulus"),
                m.number("cord.diameter"), optional_number(m, "cord.strength")};
    }

private:
    /// Reads the file that a key names; its values become inputs below that key.
    Values read(const std::string& key, const DocumentKind& kind) {
        const auto file =
            data_file("materials", values_.word(key), key, values_.place(key), values_.directory(key));
        Values values(read_document(read_text_file(file), file.string(), kind), kind);
        for (Input input : values.inputs()) {
            input.key = key + "." + input.key.substr(kind.prefix.size());
            if (!input.key.ends_with(".kind")) inputs_.push_back(std::move(input));
        }
        return values;
    }

    const Values& values_;
    std::vector<Input>& inputs_;
};

/// The CSV or mesh file that a key names.
std::filesystem::path table_file(const Values& v, std::string_view key) {
    const std::string& name = v.word(key);
    if (!is_data_name(name))
        throw SceneError(v.place(key), std::string(key),
                         fmt::format("'{}' is not the name of a data file", name),
                         "letters, digits, '-', '_', '.' and '/' only", "put the file beside the scene");
    if (auto file = find_table_file(name, v.directory(key))) return *file;
    std::vector<std::string> places;
    for (const auto& where : data_directories(v.directory(key)))
        places.push_back(where.string());
    throw SceneError(v.place(key), std::string(key), fmt::format("there is no {}", name),
                     fmt::format("looked in {}", fmt::join(places, ", ")), "put the file beside the scene");
}

Atmosphere atmosphere(const Values& v) {
    Atmosphere a;
    a.model = find_atmosphere(v.word("environment.atmosphere.model"));
    if (v.is_effective("environment.atmosphere.density"))
        a.constant_density = v.number("environment.atmosphere.density");
    if (v.is_effective("environment.atmosphere.temperature_offset"))
        a.temperature_offset = v.number("environment.atmosphere.temperature_offset");
    if (constexpr const char* key = "environment.atmosphere.table"; v.is_effective(key)) {
        const auto file = table_file(v, key);
        a.table = read_air_table(read_text_file(file), file.string(), v.word(key));
    }
    return a;
}

Wind wind(const Values& v) {
    const std::string& model = v.word("environment.wind.model");
    if (model == "uniform")
        return uniform_wind(wind_from(v.number("environment.wind.speed"), v.number("environment.wind.from")));
    if (model == "components")
        return uniform_wind({v.number("environment.wind.east"), v.number("environment.wind.north"),
                             v.number("environment.wind.up")});
    const auto file = table_file(v, "environment.wind.table");
    return read_wind_table(read_text_file(file), file.string(), v.word("environment.wind.table"));
}

Environment environment(const Values& v) {
    Environment e;
    e.atmosphere = atmosphere(v);
    e.gravity = v.number("environment.gravity");
    e.ground = v.number("environment.ground");
    if (v.has_table("environment.wind")) e.wind = wind(v);
    return e;
}

PayloadBody payload_body(const Values& v) {
    PayloadBody body;
    const std::string& shape = v.word("payload.body.shape");
    if (shape == "cylinder") body.shape = PayloadBody::Shape::cylinder;
    if (shape == "mesh") body.shape = PayloadBody::Shape::mesh;
    for (int i = 1; i <= v.count("payload.body.size"); ++i)
        body.size.push_back(v.number(fmt::format("payload.body.size.{}", i)));
    constexpr std::size_t lengths[] = {3, 2, 0};  // in the order of shapes
    const std::size_t wanted = lengths[static_cast<std::size_t>(body.shape)];
    if (body.size.size() != wanted)
        throw SceneError(v.place("payload.body.shape"), "payload.body.size",
                         fmt::format("{} lengths for a {}", body.size.size(), shape), "",
                         wanted == 3   ? "give its three edges, the last along the parachute"
                         : wanted == 2 ? "give diameter and height"
                                       : "leave size out, the file of parachute.mesh has it");
    if (v.has_table("payload.body.elasticity"))
        body.elasticity = Elasticity{v.number("payload.body.elasticity.youngs_modulus"),
                                     v.number("payload.body.elasticity.poisson_ratio")};
    return body;
}

Release release(const Values& v, const Environment& environment) {
    Release r;
    r.altitude = v.given("release.altitude") ? v.number("release.altitude")
                                             : environment.ground + v.number("release.height");
    const bool over_ground = v.given("release.speed");
    const char* key = over_ground ? "release.speed" : "release.airspeed";
    r.speed = v.number(key);
    if (v.given("release.path_angle")) {
        r.path_angle = v.number("release.path_angle");
    } else if (r.speed > 0.0) {
        throw SceneError(v.place(key), "release.path_angle", "is missing", "a speed needs a direction",
                         "add e.g. path_angle = \"90 deg\" for straight down");
    } else {
        r.path_angle = 0.5 * pi;
    }
    r.heading = v.number("release.heading");
    if (!over_ground && environment.wind) return carried_by(environment.wind->at(r.altitude), r);
    return r;
}

/// `table`: the keys stand below it.
FillTime fill_time(const Values& v, const std::string& table) {
    const auto key = [&](const char* name) { return table + "." + name; };
    FillTime f;
    f.model = find_fill_time(v.word(key("model")));
    if (const std::string csv = key("table"); v.is_effective(csv)) {
        const auto file = table_file(v, csv);
        f.table = read_fill_table(read_text_file(file), file.string(), v.word(csv));
    }
    if (f.model->name == "ludtke")
        f.balance = {optional_number(v, key("volume")), optional_number(v, key("mouth_area")),
                     v.number(key("permeability")), v.number(key("pressure_coefficient"))};
    if (v.is_effective(key("n"))) {
        f.n = v.number(key("n"));
        f.density_exponent = v.number(key("density_exponent"));
    }
    if (v.is_effective(key("geometric_porosity"))) f.porosity = v.number(key("geometric_porosity"));
    if (v.is_effective(key("time"))) f.given = v.number(key("time"));
    return f;
}

constexpr std::pair<std::string_view, Trigger::Kind> occurrences[] = {
    {"steady-descent", Trigger::Kind::steady_descent},
    {"peak-force", Trigger::Kind::peak_force},
    {"full-open", Trigger::Kind::full_open},
    {"line-stretch", Trigger::Kind::line_stretch},
    {"ground", Trigger::Kind::ground},
    {"release", Trigger::Kind::release},
    {"apogee", Trigger::Kind::apogee},
    {"cut", Trigger::Kind::cut}};

Trigger::Kind occurrence(std::string_view word) {
    return std::ranges::find(occurrences, word, [](const auto& k) { return k.first; })->second;
}

/// "drogue.full-open": what happens to another parachute.
Trigger of_another(const Values& v, const std::string& key) {
    const std::string& text = v.word(key);
    const std::size_t dot = std::min(text.rfind('.'), text.size());
    const std::string_view event = std::string_view(text).substr(std::min(dot + 1, text.size()));
    if (dot == 0 || (event != "line-stretch" && event != "full-open" && event != "cut"))
        throw SceneError(v.place(key), key, fmt::format("'{}' is not an event of a parachute", text),
                         "its name, a dot and line-stretch, full-open or cut",
                         "write e.g. \"drogue.full-open\"");
    Trigger t;
    t.kind = occurrence(event);
    t.of = text.substr(0, dot);
    return t;
}

/// `table`: the keys stand below it.
Trigger trigger(const Values& v, const std::string& table, const Environment& environment) {
    const auto key = [&](const char* name) { return table + "." + name; };
    Trigger t;
    if (v.given(key("time"))) {
        t.kind = Trigger::Kind::time;
        t.value = v.number(key("time"));
    } else if (v.given(key("altitude")) || v.given(key("height"))) {
        t.kind = Trigger::Kind::altitude;
        t.value = v.given(key("altitude")) ? v.number(key("altitude"))
                                           : environment.ground + v.number(key("height"));
    } else if (v.given(key("dynamic_pressure"))) {
        t.kind = Trigger::Kind::dynamic_pressure;
        t.value = v.number(key("dynamic_pressure"));
    } else if (v.given(key("after"))) {
        t = of_another(v, key("after"));
    } else {
        t.kind = occurrence(v.word(key("at")));
    }
    t.delay = v.number(key("delay"));
    return t;
}

std::vector<Reefing> reefing(const Values& v, const Environment& environment) {
    std::vector<Reefing> stages;
    for (int i = 1; i <= v.count("parachute.reefing"); ++i) {
        const std::string table = fmt::format("parachute.reefing.{}", i);
        Reefing& stage = stages.emplace_back();
        stage.drag_area_ratio = v.number(table + ".drag_area_ratio");
        stage.line_length = optional_number(v, table + ".line_length");
        if (v.has_table(table + ".fill_time")) stage.fill_time = fill_time(v, table + ".fill_time");
        stage.until = trigger(v, table + ".until", environment);
    }
    return stages;
}

ForceHistory extraction(const Values& v) {
    ForceHistory f;
    f.duration = v.number("parachute.deploy.duration");
    if (constexpr const char* key = "parachute.deploy.force_table"; v.is_effective(key)) {
        const auto file = table_file(v, key);
        return read_force_table(read_text_file(file), file.string(), v.word(key), f.duration);
    }
    const double force = v.number("parachute.deploy.force");
    f.time = {0.0, f.duration};
    f.force = {force, force};
    return f;
}

Deployment deployment(const Values& v) {
    const auto key = [](const char* name) { return std::string("parachute.deploy.") + name; };
    Deployment d;
    d.by = std::ranges::find(deployment_rows(), v.word(key("by")), &DeploymentRow::name)->by;
    if (d.by == DeployBy::static_line) {
        d.static_line_length = v.number(key("length"));
        d.anchor_moves = v.word(key("far_end")) == "aircraft";
    }
    if (d.by == DeployBy::extraction) {
        d.extraction = extraction(v);
        d.extraction_on_apex = v.word(key("load")) == "point";
    }
    if (!d.starts_packed()) return d;
    d.pitch = v.number(key("pitch"));
    d.pack_ratio = v.number(key("pack_ratio"));
    d.drag_coefficient = v.number(key("drag_coefficient"));
    if (d.by == DeployBy::pilot) d.pack_drag_area = v.number(key("pilot_drag_area"));
    if (d.by == DeployBy::mortar) d.muzzle_speed = v.number(key("muzzle_speed"));
    if (v.given(key("pack_drag_area"))) d.pack_drag_area = v.number(key("pack_drag_area"));
    d.compressive_stiffness_ratio = v.number(key("fold_repulsion"));
    d.deployment_resistance = v.number(key("fold_resistance"));
    return d;
}

/// What is given of the sizes and materials that a structure is made of.
void add_structure(const Values& v, Materials& materials, Parachute& p) {
    const auto number = [&](std::string_view key) { return optional_number(v, key).value_or(0.0); };
    const auto count = [&](std::string_view key) {
        return v.given(key) ? static_cast<int>(v.integer(key)) : 0;
    };
    const auto cord = [&](const char* key) { return v.given(key) ? materials.cord(key) : Cord{}; };
    p.projected_diameter_ratio = number("parachute.projected_diameter_ratio");
    p.gores = count("parachute.gores");
    p.vent_diameter = number("parachute.vent_diameter");
    p.line_length = number("parachute.line_length");
    p.riser_length = number("parachute.riser_length");
    p.risers = count("parachute.risers");
    if (v.given("parachute.fabric")) p.fabric = materials.fabric("parachute.fabric");
    p.line = cord("parachute.line");
    p.tapes = {cord("parachute.tapes.radial"), cord("parachute.tapes.skirt"), cord("parachute.tapes.vent")};
    if (constexpr const char* key = "parachute.mesh"; v.given(key))
        p.mesh = MeshFile{v.word(key), table_file(v, key)};
}

/// Of a table the law's name means nothing; it begins where the table does.
void add_growth(const Values& v, Parachute& p) {
    constexpr const char* key = "parachute.drag_area_table";
    if (!v.given(key)) {
        p.drag_area_law = find_drag_area_law(v.word("parachute.drag_area_law"));
        p.initial_drag_area_ratio = v.number("parachute.initial_drag_area_ratio");
        return;
    }
    const auto file = table_file(v, key);
    p.drag_area_law = &drag_area_laws().front();
    p.drag_area_table = read_drag_area_table(read_text_file(file), file.string(), v.word(key));
    p.initial_drag_area_ratio = p.drag_area_table->start_ratio();
}

Parachute parachute(const Values& v, Materials& materials, const Environment& environment) {
    Parachute p;
    p.name = v.word("parachute.name");
    if (constexpr const char* key = "parachute.type"; v.given(key))
        p.type = read_canopy_type(v.word(key), key, v.place(key), v.directory(key));
    p.nominal_diameter = v.number("parachute.nominal_diameter");
    p.drag_area = v.given("parachute.drag_area") ? v.number("parachute.drag_area")
                                                 : v.number("parachute.drag_coefficient") * 0.25 * pi *
                                                       p.nominal_diameter * p.nominal_diameter;
    if (v.given("parachute.opening_force_coefficient"))
        p.opening_force_coefficient = v.number("parachute.opening_force_coefficient");
    p.mass = v.number("parachute.mass");
    add_structure(v, materials, p);
    p.strength = {v.number("parachute.joint_efficiency"), v.number("parachute.design_factor")};

    p.deploy = deployment(v);
    p.count = static_cast<int>(v.integer("parachute.count"));
    for (int i = 1; i <= v.count("parachute.lag"); ++i)
        p.lag.push_back(v.number(fmt::format("parachute.lag.{}", i)));
    p.cluster_drag_ratio = v.number("parachute.cluster_drag_ratio");
    if (v.has_table("parachute.deploy.when"))
        p.deploy_when = trigger(v, "parachute.deploy.when", environment);
    if (v.has_table("parachute.cut")) p.cut = trigger(v, "parachute.cut", environment);
    p.reefing = reefing(v, environment);
    // "main.full-open" of main itself is its own, which a stage has, too.
    const auto is_own = [&](Trigger& t) {
        if (t.of == p.name && t.kind != Trigger::Kind::cut) t.of.clear();
    };
    if (p.cut) is_own(*p.cut);
    for (Reefing& stage : p.reefing)
        is_own(stage.until);
    p.fill_time = fill_time(v, "parachute.fill_time");
    add_growth(v, p);
    p.initial_phase.transit = v.is_word("parachute.initial_phase");
    if (!p.initial_phase.transit) p.initial_phase.seconds = v.number("parachute.initial_phase");
    if (constexpr const char* key = "parachute.drag_area_mach_table"; v.given(key)) {
        const auto file = table_file(v, key);
        p.drag_area_mach_table = read_mach_drag(read_text_file(file), file.string(), v.word(key));
    }
    return p;
}

/// A design that the scene gives another D0 keeps its shape: what the design says of its size goes along,
/// what the scene says stays. Told in `inputs` and `warnings`.
void scale_design(const Values& v, Parachute& p, std::vector<Input>& inputs, std::vector<Warning>& warnings) {
    const auto designed = v.design_diameter();
    if (!designed || *designed == p.nominal_diameter) return;
    const double wanted = p.nominal_diameter;
    const std::string& design = v.word("parachute.design");
    p.nominal_diameter = *designed;
    const auto scaled = scale_canopy(p, wanted, [&](std::string_view key) { return v.is_designed(key); });
    std::vector<std::string_view> names;
    for (const ScaledQuantity& quantity : scaled) {
        const auto input = std::ranges::find(inputs, quantity.key, &Input::key);
        input->value = quantity.value;
        input->origin = InputOrigin::scaled;
        input->source = fmt::format("{} at D0 = {:g} m, scaled{}{}", design, *designed,
                                    input->source.empty() ? "" : ": ", input->source);
        names.push_back(std::string_view(quantity.key).substr(std::string_view("parachute.").size()));
    }
    if (names.empty()) return;  // the scene gives all of its sizes
    warnings.push_back(
        {fmt::format("{}: design {} of D0 = {:g} m is scaled to {:g} m", p.name, design, *designed, wanted),
         fmt::format("of the same shape: {} go along; gores, risers and materials stay",
                     fmt::join(names, ", ")),
         "a canopy of another size is seldom sewn of the same cloth: give what differs"});
}

Aerodynamics aerodynamics(const Values& v) {
    Aerodynamics a;
    if (v.has_table("aerodynamics.added_mass") && v.word("aerodynamics.added_mass.model") != "none") {
        AddedMassSpec& spec = a.added_mass.emplace();
        spec.model = find_added_mass(v.word("aerodynamics.added_mass.model"));
        if (v.word("aerodynamics.added_mass.momentum") == "accreting")
            spec.momentum = AddedMassMomentum::accreting;
        if (v.word("aerodynamics.added_mass.radius") == "drag-area")
            spec.open_radius = AddedMassRadius::drag_area;
        if (v.is_effective("aerodynamics.added_mass.depth_ratio"))
            spec.depth_ratio = v.number("aerodynamics.added_mass.depth_ratio");
        if (v.is_effective("aerodynamics.added_mass.porosity"))
            spec.porosity = v.number("aerodynamics.added_mass.porosity");
    }
    if (v.has_table("aerodynamics.line_drag")) a.line_drag = LineDrag{};
    if (v.has_table("aerodynamics.breathing_damping"))
        a.breathing_damping = v.number("aerodynamics.breathing_damping.k");
    if (v.has_table("aerodynamics.line_ratio"))
        a.line_ratio = find_line_ratio(v.word("aerodynamics.line_ratio.model"));
    if (v.has_table("aerodynamics.forebody_wake"))
        a.forebody_wake = find_forebody_wake(v.word("aerodynamics.forebody_wake.model"));
    a.radial_pressure = v.number("aerodynamics.radial_pressure");
    return a;
}

FullSettings full(const Values& v) {
    FullSettings f;
    f.mesh.gore_columns = static_cast<int>(v.integer("full.mesh.gore_columns"));
    f.mesh.gore_rows = static_cast<int>(v.integer("full.mesh.gore_rows"));
    f.mesh.grading = v.word("full.mesh.grading") == "graded" ? Grading::graded : Grading::uniform;
    f.mesh.line_elements = static_cast<int>(v.integer("full.mesh.line_elements"));
    f.mesh.riser_elements = static_cast<int>(v.integer("full.mesh.riser_elements"));
    f.symmetry = v.word("full.symmetry") == "sector" ? Symmetry::sector : Symmetry::none;
    f.structure = v.word("full.structure") == "fe" ? Structure::fe : Structure::msd_fe;
    f.contact = v.word("full.contact") == "gores" ? Contact::gores : Contact::none;
    f.switch_area_ratio = v.number("full.switch_area_ratio");
    if (v.given("full.ramp_time")) f.ramp_time = v.number("full.ramp_time");
    f.beta = v.number("full.beta");
    f.alpha = v.number("full.alpha");
    f.alpha_from_release = v.word("full.alpha_from") == "release";
    f.bulk_viscosity = v.number("full.bulk_viscosity");
    f.time_step_factor = v.number("full.time_step_factor");
    f.line_substeps = static_cast<int>(v.integer("full.line_substeps"));
    f.mass_scaling = v.number("full.mass_scaling");
    f.strain_limit = v.number("full.strain_limit");
    f.output_rate = v.number("full.output_rate");
    if (v.given("full.fields_rate")) f.fields_rate = v.number("full.fields_rate");
    f.checkpoint_interval = v.number("full.checkpoint_interval");
    if (v.has_table("full.noise"))
        f.noise = {v.number("full.noise.amplitude"),
                   static_cast<std::uint64_t>(v.integer("full.noise.seed"))};
    return f;
}

SizeSpec size(const Values& v) {
    SizeSpec s;
    s.max_descent_rate = optional_number(v, "size.max_descent_rate");
    s.max_force = optional_number(v, "size.max_force");
    s.max_canopy_force = optional_number(v, "size.max_canopy_force");
    s.max_deceleration = optional_number(v, "size.max_deceleration");
    if (v.given("size.parachute")) s.parachute = v.word("size.parachute");
    s.vary = v.list("size.vary");
    if (constexpr const char* key = "size.types"; v.given(key))
        for (const std::string& name : v.list(key))
            s.types.push_back(read_canopy_type(name, key, v.place(key), v.directory(key)));
    return s;
}

SeriesSpec series(const Values& v) {
    SeriesSpec s;
    s.x = v.word("series.x");
    s.y = v.word("series.y");
    if (v.given("series.group")) s.group = v.word("series.group");
    if (constexpr const char* key = "series.test"; v.given(key)) {
        const auto file = table_file(v, key);
        s.test = v.word(key);
        std::tie(s.test_x, s.test_y) = read_test_points(read_text_file(file), file.string(), s.x, s.y);
    }
    return s;
}

}  // namespace

Release carried_by(const Vec3& wind, const Release& through_air) {
    Release r = through_air;
    const Vec3 velocity = velocity_over_ground(through_air) + wind;
    r.speed = velocity.norm();
    r.path_angle = std::atan2(-velocity.z(), std::hypot(velocity.x(), velocity.y()));
    if (velocity.x() != 0.0 || velocity.y() != 0.0) r.heading = std::atan2(velocity.x(), velocity.y());
    return r;
}

Scene assemble_scene(const Values& v) {
    Scene scene;
    scene.name = v.word("name");
    scene.inputs = v.inputs();
    Materials materials(v, scene.inputs);
    scene.environment = environment(v);
    scene.payload.mass = v.number("payload.mass");
    if (v.given("payload.drag_area")) scene.payload.drag_area = v.number("payload.drag_area");
    if (constexpr const char* key = "payload.drag_area_table"; v.given(key)) {
        const auto file = table_file(v, key);
        scene.payload.drag_area_table = read_attitude_drag(read_text_file(file), file.string(), v.word(key));
        scene.payload.drag_area = scene.payload.drag_area_table->drag_area(0.0);
    }
    scene.release = release(v, scene.environment);
    scene.payload.diameter = optional_number(v, "payload.diameter");
    if (v.has_table("payload.body")) scene.payload.body = payload_body(v);
    scene.parachutes.push_back(parachute(v, materials, scene.environment));
    scale_design(v, scene.parachutes.back(), scene.inputs, scene.warnings);
    scene.aerodynamics = aerodynamics(v);
    scene.stop = trigger(v, "stop", scene.environment);
    if (v.given("stop.then")) scene.then = v.word("stop.then");
    scene.rom = {v.word("rom.method"), v.number("rom.rtol")};
    scene.full = full(v);
    scene.tolerances = v.tolerances();
    if (v.has_table("size")) scene.size = size(v);
    if (v.has_table("series")) scene.series = series(v);
    return scene;
}

void add_parachute(Scene& scene, const Values& v) {
    std::vector<Input> inputs;
    for (Input& input : v.inputs())
        if (input.key.starts_with("parachute.")) inputs.push_back(std::move(input));
    Materials materials(v, inputs);
    scene.parachutes.push_back(parachute(v, materials, scene.environment));
    scale_design(v, scene.parachutes.back(), inputs, scene.warnings);
    name_inputs(inputs, scene.parachutes.back().name);
    scene.inputs.insert(scene.inputs.end(), inputs.begin(), inputs.end());
}

void name_inputs(std::vector<Input>& inputs, const std::string& name) {
    constexpr std::string_view head = "parachute.";
    for (Input& input : inputs)
        if (input.key.starts_with(head)) input.key.insert(head.size(), name + ".");
}

std::filesystem::path data_file(std::string_view folder, const std::string& name, std::string_view key,
                                const SourcePlace& place, const std::filesystem::path& directory) {
    if (!is_data_name(name))
        throw SceneError(place, std::string(key), fmt::format("'{}' is not the name of a data file", name),
                         "letters, digits, '-', '_', '.' and '/' only",
                         fmt::format("write the name of a file in {}/ without .toml", folder));
    if (auto file = find_data_file(folder, name, directory)) return *file;
    const std::vector<std::string> names = data_names(folder, directory);
    std::vector<std::string> places;
    for (const auto& where : data_directories(directory))
        places.push_back((where / folder).string());
    throw SceneError(place, std::string(key), fmt::format("there is no {}/{}.toml", folder, name),
                     fmt::format("looked in {}", fmt::join(places, ", ")),
                     suggest(name, {names.begin(), names.end()}));
}

}  // namespace twinchute
