#include "lib/scene/assemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <type_traits>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/scene/canopy_types.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/opening_tables.hpp"
#include "lib/scene/scale_canopy.hpp"
#include "lib/scene/soundings.hpp"
#include "lib/scene/trigger.hpp"

namespace twinchute {
namespace {

/// Materials as a scene names them, each file read once a key.
class Materials {
public:
    Materials(const Values& values, std::vector<Input>& inputs) : values_(values), inputs_(inputs) {}

    /// Reads the file that a key names, of the keys of a Fabric or Cord. An absent key changes nothing.
    template <class Material>
    void read(Material& material, const std::string& key) {
        if (!values_.given(key)) return;
        constexpr bool is_fabric = std::is_same_v<Material, Fabric>;
        const DocumentKind kind{is_fabric ? fabric_keys() : cord_keys(), is_fabric ? "fabric." : "cord.",
                                InputOrigin::design, key};
        const auto file =
            data_file("materials", values_.word(key), key, values_.place(key), values_.directory(key));
        const Values values(read_document(read_text_file(file), file.string(), kind), kind);
        values.read_into(material);
        for (Input input : values.inputs()) {
            input.key = key + "." + input.key.substr(kind.prefix.size());
            if (!input.key.ends_with(".kind")) inputs_.push_back(std::move(input));
        }
    }

private:
    const Values& values_;
    std::vector<Input>& inputs_;
};

/// The CSV or mesh file that a key names.
std::filesystem::path table_file(const Values& v, std::string_view key) {
    const std::string& name = v.word(key);
    if (!is_data_name(name))
        throw SceneError(v.place(key), std::string(key),
                         fmt::format("'{}' is not the name of a data file", name),
                         "letters, digits, '-', '_', '.' and '/' only, from the scene's directory",
                         "put the file beside the scene, or below");
    if (auto file = find_table_file(name, v.directory(key))) return *file;
    std::vector<std::string> places;
    for (const auto& where : data_directories(v.directory(key)))
        places.push_back(where.string());
    throw SceneError(v.place(key), std::string(key), fmt::format("there is no {}", name),
                     fmt::format("looked in {}", fmt::join(places, ", ")), "put the file beside the scene");
}

/// The file of the table that a key names, if it does, read by `read(text, file, name)` into `to`.
void read_table(const Values& v, std::string_view key, auto& to, const auto& read) {
    if (!v.given(key)) return;
    const auto file = table_file(v, key);
    to = read(read_text_file(file), file.string(), v.word(key));
}

void finish_environment(const Values& v, Environment& e) {
    read_table(v, "environment.atmosphere.table", e.atmosphere.table, read_air_table);
    if (!v.has_table("environment.wind")) return;
    const std::string& model = v.word("environment.wind.model");
    if (model == "uniform")
        e.wind =
            uniform_wind(wind_from(v.number("environment.wind.speed"), v.number("environment.wind.from")));
    if (model == "components")
        e.wind = uniform_wind({v.number("environment.wind.east"), v.number("environment.wind.north"),
                               v.number("environment.wind.up")});
    read_table(v, "environment.wind.table", e.wind, read_wind_table);
}

void check_body(const Values& v, const PayloadBody& body) {
    constexpr std::size_t lengths[] = {3, 2, 0};  // in the order of shapes
    const std::size_t wanted = lengths[static_cast<std::size_t>(body.shape)];
    if (body.size.size() != wanted)
        throw SceneError(v.place("payload.body.shape"), "payload.body.size",
                         fmt::format("{} lengths for a {}", body.size.size(), v.word("payload.body.shape")),
                         "",
                         wanted == 3   ? "give its three edges, the last along the parachute"
                         : wanted == 2 ? "give diameter and height"
                                       : "leave size out, the file of parachute.mesh has it");
}

void finish_release(const Values& v, Release& r, const Environment& environment) {
    if (!v.given("release.altitude")) r.altitude = environment.ground + v.number("release.height");
    const bool over_ground = v.given("release.speed");
    const char* key = over_ground ? "release.speed" : "release.airspeed";
    r.speed = v.number(key);
    if (!v.given("release.path_angle")) {
        if (r.speed > 0.0)
            throw SceneError(v.place(key), "release.path_angle", "is missing", "a speed needs a direction",
                             "add e.g. path_angle = \"90 deg\" for straight down");
        r.path_angle = 0.5 * pi;
    }
    if (!over_ground && environment.wind) r = carried_by(environment.wind->at(r.altitude), r);
}

/// `table`: the keys stand below it.
FillTime fill_time(const Values& v, const std::string& table) {
    FillTime f;
    v.read_into(f, table);
    read_table(v, table + ".table", f.table, read_fill_table);
    return f;
}

/// "drogue.full-open": what happens to another parachute.
void wait_for_another(const Values& v, const std::string& key, Trigger& t) {
    const std::string& text = v.word(key);
    const std::size_t dot = std::min(text.rfind('.'), text.size());
    const std::string_view event = std::string_view(text).substr(std::min(dot + 1, text.size()));
    if (dot == 0 || (event != "line-stretch" && event != "full-open" && event != "cut"))
        throw SceneError(v.place(key), key, fmt::format("'{}' is not an event of a parachute", text),
                         "its name, a dot and line-stretch, full-open or cut",
                         "write e.g. \"drogue.full-open\"");
    t.kind = *find_event(event);
    t.of = text.substr(0, dot);
}

/// Conditions that take more than their value. `table`: the keys stand below it.
void finish_trigger(const Values& v, const std::string& table, const Environment& environment, Trigger& t) {
    if (const std::string key = table + ".height"; v.given(key)) {
        t.kind = Trigger::Kind::altitude;
        t.value = environment.ground + v.number(key);
    }
    if (const std::string key = table + ".after"; v.given(key)) wait_for_another(v, key, t);
}

Trigger trigger(const Values& v, const std::string& table, const Environment& environment) {
    Trigger t;
    v.read_into(t, table);
    finish_trigger(v, table, environment, t);
    return t;
}

std::vector<Reefing> reefing(const Values& v, const Environment& environment) {
    std::vector<Reefing> stages;
    for (int i = 1; i <= v.count("parachute.reefing"); ++i) {
        const std::string table = fmt::format("parachute.reefing.{}", i);
        Reefing& stage = stages.emplace_back();
        v.read_into(stage, table);
        if (v.has_table(table + ".fill_time")) stage.fill_time = fill_time(v, table + ".fill_time");
        stage.until = trigger(v, table + ".until", environment);
    }
    return stages;
}

/// A table, or one force for a while.
void finish_extraction(const Values& v, ForceHistory& f) {
    if (constexpr const char* key = "parachute.deploy.force_table"; v.given(key)) {
        const auto file = table_file(v, key);
        f = read_force_table(read_text_file(file), file.string(), v.word(key), f.duration);
        return;
    }
    const double force = v.number("parachute.deploy.force");
    f.time = {0.0, f.duration};
    f.force = {force, force};
}

/// Materials and mesh of a structure, as far as they are given.
void finish_structure(const Values& v, Materials& materials, Parachute& p) {
    materials.read(p.fabric, "parachute.fabric");
    materials.read(p.line, "parachute.line");
    materials.read(p.tapes.radial, "parachute.tapes.radial");
    materials.read(p.tapes.skirt, "parachute.tapes.skirt");
    materials.read(p.tapes.vent, "parachute.tapes.vent");
    for (int i = 1; i <= v.count("parachute.panel"); ++i) {
        const std::string table = fmt::format("parachute.panel.{}", i);
        PanelMaterials& panel = p.panel.emplace_back();
        v.read_into(panel, table);
        materials.read(panel.fabric, table + ".fabric");
    }
    if (p.vent_lines) materials.read(p.vent_lines->cord, "parachute.vent_lines.cord");
    if (p.mesh) p.mesh->file = table_file(v, "parachute.mesh");
}

/// A table stands in place of the law and says where the growth begins.
void finish_growth(const Values& v, Parachute& p) {
    read_table(v, "parachute.drag_area_table", p.drag_area_table, read_drag_area_table);
    if (!p.drag_area_table) return;
    p.drag_area_law = &drag_area_laws().front();
    p.initial_drag_area_ratio = p.drag_area_table->start_ratio();
}

Parachute parachute(const Values& v, Materials& materials, const Environment& environment) {
    Parachute p;
    v.read_into(p);
    if (constexpr const char* key = "parachute.type"; v.given(key))
        p.type = read_canopy_type(v.word(key), key, v.place(key), v.directory(key));
    p.drag_area = v.given("parachute.drag_area") ? v.number("parachute.drag_area")
                                                 : v.number("parachute.drag_coefficient") * 0.25 * pi *
                                                       p.nominal_diameter * p.nominal_diameter;
    finish_structure(v, materials, p);
    if (p.deploy.by == DeployBy::extraction) finish_extraction(v, p.deploy.extraction);
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
    if (!p.filling.is_predicted()) {
        p.fill_time = fill_time(v, "parachute.fill_time");
        finish_growth(v, p);
    }
    read_table(v, "parachute.calibration", p.calibration, read_calibration_table);
    read_table(v, "parachute.drag_area_mach_table", p.drag_area_mach_table, read_mach_drag);
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
         "a canopy of another size is seldom sewn of the same fabric: give what differs"});
}

void finish_series(const Values& v, SeriesSpec& s) {
    if (s.test.empty()) return;
    const auto file = table_file(v, "series.test");
    std::tie(s.test_x, s.test_y) = read_test_points(read_text_file(file), file.string(), s.x, s.y);
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
    v.read_into(scene);
    scene.inputs = v.inputs();
    Materials materials(v, scene.inputs);
    finish_environment(v, scene.environment);
    Payload& payload = scene.payload;
    read_table(v, "payload.drag_area_table", payload.drag_area_table, read_attitude_drag);
    if (payload.drag_area_table) payload.drag_area = payload.drag_area_table->drag_area(0.0);
    finish_release(v, scene.release, scene.environment);
    if (payload.body) check_body(v, *payload.body);
    scene.parachutes.push_back(parachute(v, materials, scene.environment));
    scale_design(v, scene.parachutes.back(), scene.inputs, scene.warnings);
    scene.overridden = v.overridden();
    std::optional<AddedMassSpec>& added_mass = scene.aerodynamics.added_mass;
    if (added_mass && !added_mass->model) added_mass.reset();  // the word "none"
    finish_trigger(v, "stop", scene.environment, scene.stop);
    scene.tolerances = v.tolerances();
    if (constexpr const char* key = "size.types"; v.given(key))
        for (const std::string& name : v.list(key))
            scene.size->types.push_back(read_canopy_type(name, key, v.place(key), v.directory(key)));
    if (scene.series) finish_series(v, *scene.series);
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
    scene.overridden.insert(scene.overridden.end(), v.overridden().begin(), v.overridden().end());
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
