#include "lib/scene/write_scene.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "lib/record/metrics.hpp"
#include "lib/scene/drag_area.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/units.hpp"

namespace twinchute {
namespace {

/// A TOML basic string.
std::string quoted(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            out += {'\\', c};
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            out += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
        else
            out += c;
    }
    return out + "\"";
}

class Writer {
public:
    void table(std::string_view head) { text_ += fmt::format("\n{}\n", head); }
    void number(std::string_view key, double value) {
        // "-0" would be a whole number, which has no sign to keep.
        const std::string written = value == 0.0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value);
        text_ += fmt::format("{} = {}\n", key, written);
    }
    void numbers(std::string_view key, const std::vector<double>& values) {
        text_ += fmt::format("{} = [{}]\n", key, fmt::join(values, ", "));
    }
    void whole(std::string_view key, std::uint64_t value) { text_ += fmt::format("{} = {}\n", key, value); }
    void count(std::string_view key, int value) { text_ += fmt::format("{} = {}\n", key, value); }
    void words(std::string_view key, std::string_view value) {
        text_ += fmt::format("{} = {}\n", key, quoted(value));
    }
    void list(std::string_view key, const std::vector<std::string>& values) {
        std::vector<std::string> all;
        for (const std::string& value : values)
            all.push_back((quoted)(value));  // not std::quoted
        text_ += fmt::format("{} = [{}]\n", key, fmt::join(all, ", "));
    }
    std::string text() && { return std::move(text_); }

private:
    std::string text_;
};

void write_environment(Writer& w, const Environment& e) {
    w.table("[environment]");
    w.words("atmosphere.model", e.atmosphere.model->name);
    const std::string_view model = e.atmosphere.model->name;
    if (model == "constant") w.number("atmosphere.density", e.atmosphere.constant_density);
    if (model == "us76") w.number("atmosphere.temperature_offset", e.atmosphere.temperature_offset);
    if (model == "table") w.words("atmosphere.table", e.atmosphere.table.file);
    w.number("gravity", e.gravity);
    w.number("ground", e.ground);
    if (!e.wind) return;
    if (!e.wind->table.empty()) {
        w.words("wind.table", e.wind->table);
        return;
    }
    const Vec3& velocity = e.wind->levels.front().velocity;
    w.number("wind.east", velocity.x());
    w.number("wind.north", velocity.y());
    w.number("wind.up", velocity.z());
}

void write_deployment(Writer& w, const Deployment& d) {
    w.words("deploy.by", deployment_name(d.by));
    if (d.by == DeployBy::static_line) {
        w.number("deploy.length", d.static_line_length);
        w.words("deploy.far_end", d.anchor_moves ? "aircraft" : "fixed");
    }
    if (d.by == DeployBy::extraction) {
        if (d.extraction.table.empty())
            w.number("deploy.force", d.extraction.force.front());
        else
            w.words("deploy.force_table", d.extraction.table);
        w.number("deploy.duration", d.extraction.duration);
        w.words("deploy.load", d.extraction_on_apex ? "point" : "distributed");
    }
    if (d.by == DeployBy::pilot) w.number("deploy.pilot_drag_area", d.pack_drag_area);
    if (d.by == DeployBy::mortar) w.number("deploy.muzzle_speed", d.muzzle_speed);
    if (!d.starts_packed()) return;
    w.number("deploy.pitch", d.pitch);
    w.number("deploy.pack_ratio", d.pack_ratio);
    w.number("deploy.drag_coefficient", d.drag_coefficient);
    if (d.by != DeployBy::pilot) w.number("deploy.pack_drag_area", d.pack_drag_area);
    w.number("deploy.fold_repulsion", d.compressive_stiffness_ratio);
    w.number("deploy.fold_resistance", d.deployment_resistance);
}

void write_fill_time(Writer& w, const std::string& table, const FillTime& f) {
    w.words(table + ".model", f.model->name);
    if (f.model->name == "given") {
        w.number(table + ".time", f.given);
    } else if (f.model->name == "ribbon") {
        w.number(table + ".geometric_porosity", f.porosity);
    } else if (f.table) {
        w.words(table + ".table", f.table->file);
    } else if (f.balance) {
        if (f.balance->volume) w.number(table + ".volume", *f.balance->volume);
        if (f.balance->mouth_area) w.number(table + ".mouth_area", *f.balance->mouth_area);
        w.number(table + ".permeability", f.balance->permeability);
        w.number(table + ".pressure_coefficient", f.balance->pressure_coefficient);
    } else {
        if (f.n > 0.0) w.number(table + ".n", f.n);  // not given where nothing fills
        w.number(table + ".density_exponent", f.density_exponent);
    }
}

std::string_view occurrence_name(Trigger::Kind kind) {
    switch (kind) {
        case Trigger::Kind::steady_descent:
            return "steady-descent";
        case Trigger::Kind::peak_force:
            return "peak-force";
        case Trigger::Kind::full_open:
            return "full-open";
        case Trigger::Kind::line_stretch:
            return "line-stretch";
        case Trigger::Kind::ground:
            return "ground";
        case Trigger::Kind::release:
            return "release";
        case Trigger::Kind::apogee:
            return "apogee";
        case Trigger::Kind::cut:
            return "cut";
        case Trigger::Kind::time:
        case Trigger::Kind::altitude:
        case Trigger::Kind::dynamic_pressure:
            break;
    }
    return "";
}

void write_trigger(Writer& w, const std::string& table, const Trigger& t) {
    const auto key = [&](const char* name) { return table.empty() ? name : table + "." + name; };
    if (t.kind == Trigger::Kind::time)
        w.number(key("time"), t.value);
    else if (t.kind == Trigger::Kind::altitude)
        w.number(key("altitude"), t.value);
    else if (t.kind == Trigger::Kind::dynamic_pressure)
        w.number(key("dynamic_pressure"), t.value);
    else if (!t.of.empty())
        w.words(key("after"), fmt::format("{}.{}", t.of, occurrence_name(t.kind)));
    else
        w.words(key("at"), occurrence_name(t.kind));
    w.number(key("delay"), t.delay);
}

void write_reefing(Writer& w, const Reefing& stage) {
    w.table("[[parachute.reefing]]");
    w.number("drag_area_ratio", stage.drag_area_ratio);
    if (stage.line_length) w.number("line_length", *stage.line_length);
    if (stage.fill_time) write_fill_time(w, "fill_time", *stage.fill_time);
    write_trigger(w, "until", stage.until);
}

/// What there is of it.
void write_structure(Writer& w, const Parachute& p) {
    const auto length = [&](const char* key, double value) {
        if (value > 0.0) w.number(key, value);
    };
    const auto material = [&](const char* key, const std::string& name) {
        if (!name.empty()) w.words(key, name);
    };
    if (p.gores > 0) w.count("gores", p.gores);
    length("vent_diameter", p.vent_diameter);
    length("line_length", p.line_length);
    length("riser_length", p.riser_length);
    if (p.risers > 0) w.count("risers", p.risers);
    material("fabric", p.fabric.name);
    material("line", p.line.name);
    material("tapes.radial", p.tapes.radial.name);
    material("tapes.skirt", p.tapes.skirt.name);
    material("tapes.vent", p.tapes.vent.name);
    if (p.mesh) w.words("mesh", p.mesh->name);
}

void write_parachute(Writer& w, const Parachute& p) {
    w.table("[[parachute]]");
    w.words("name", p.name);
    w.count("count", p.count);
    if (!p.lag.empty()) w.numbers("lag", p.lag);
    w.number("cluster_drag_ratio", p.cluster_drag_ratio);
    if (p.type) w.words("type", p.type->name);
    w.number("nominal_diameter", p.nominal_diameter);
    w.number("drag_area", stated_drag_area(p));
    if (p.projected_diameter_ratio > 0.0) w.number("projected_diameter_ratio", p.projected_diameter_ratio);
    if (p.opening_force_coefficient) w.number("opening_force_coefficient", *p.opening_force_coefficient);
    w.number("mass", p.mass);
    write_structure(w, p);
    w.number("joint_efficiency", p.strength.joint_efficiency);
    w.number("design_factor", p.strength.design_factor);
    write_deployment(w, p.deploy);
    if (p.deploy_when) write_trigger(w, "deploy.when", *p.deploy_when);
    if (p.cut) write_trigger(w, "cut", *p.cut);
    write_fill_time(w, "fill_time", p.fill_time);
    if (p.drag_area_table) {
        w.words("drag_area_table", p.drag_area_table->file());
    } else {
        w.words("drag_area_law", p.drag_area_law->name);
        w.number("initial_drag_area_ratio", p.initial_drag_area_ratio);
    }
    if (p.drag_area_mach_table) w.words("drag_area_mach_table", p.drag_area_mach_table->file());
    if (p.initial_phase.transit)
        w.words("initial_phase", "transit");
    else
        w.number("initial_phase", p.initial_phase.seconds);
    for (const Reefing& stage : p.reefing)
        write_reefing(w, stage);
}

void write_aerodynamics(Writer& w, const Aerodynamics& a) {
    w.table("[aerodynamics]");
    if (a.added_mass) {
        w.words("added_mass.model", a.added_mass->model->name);
        const bool accreting = a.added_mass->momentum == AddedMassMomentum::accreting;
        w.words("added_mass.momentum", accreting ? "accreting" : "inertia-only");
        const bool drag_area = a.added_mass->open_radius == AddedMassRadius::drag_area;
        w.words("added_mass.radius", drag_area ? "drag-area" : "shape-once-open");
        if (a.added_mass->model->uses_depth) w.number("added_mass.depth_ratio", a.added_mass->depth_ratio);
        if (a.added_mass->model->name == "porosity") w.number("added_mass.porosity", a.added_mass->porosity);
    }
    if (a.line_drag) w.words("line_drag.model", "cylinder");
    if (a.breathing_damping) w.number("breathing_damping.k", *a.breathing_damping);
    if (a.line_ratio) w.words("line_ratio.model", (*a.line_ratio)->name);
    if (a.forebody_wake) w.words("forebody_wake.model", (*a.forebody_wake)->name);
    w.number("radial_pressure", a.radial_pressure);
}

void write_stop(Writer& w, const Trigger& stop) {
    w.table("[stop]");
    write_trigger(w, "", stop);
}

void write_settings(Writer& w, const RomSettings& rom, const FullSettings& full) {
    w.table("[rom]");
    w.words("method", rom.method);
    w.number("rtol", rom.rtol);
    w.table("[full]");
    w.count("mesh.gore_columns", full.mesh.gore_columns);
    w.count("mesh.gore_rows", full.mesh.gore_rows);
    w.words("mesh.grading", grading_name(full.mesh.grading));
    w.count("mesh.line_elements", full.mesh.line_elements);
    w.count("mesh.riser_elements", full.mesh.riser_elements);
    w.words("symmetry", full.symmetry == Symmetry::sector ? "sector" : "none");
    w.words("structure", full.structure == Structure::fe ? "fe" : "msd-fe");
    w.words("contact", full.contact == Contact::gores ? "gores" : "none");
    w.number("switch_area_ratio", full.switch_area_ratio);
    if (full.ramp_time) w.number("ramp_time", *full.ramp_time);
    w.number("beta", full.beta);
    w.number("alpha", full.alpha);
    w.words("alpha_from", full.alpha_from_release ? "release" : "snatch");
    w.number("bulk_viscosity", full.bulk_viscosity);
    w.number("time_step_factor", full.time_step_factor);
    w.count("line_substeps", full.line_substeps);
    w.number("mass_scaling", full.mass_scaling);
    w.number("strain_limit", full.strain_limit);
    w.number("output_rate", full.output_rate);
    if (full.fields_rate) w.number("fields_rate", *full.fields_rate);
    w.number("checkpoint_interval", full.checkpoint_interval);
    if (!full.noise) return;
    w.number("noise.amplitude", full.noise->amplitude);
    w.whole("noise.seed", full.noise->seed);
}

/// The number of per cent that is read as this share. Times 100 may miss it by a rounding error, so its
/// neighbours are asked too.
std::string per_cent(double share) {
    for (const double away : {0.0, 1.0, -1.0, 2.0, -2.0}) {
        double number = 100.0 * share;
        for (int i = 0; i < std::abs(away); ++i)
            number = std::nextafter(number, away > 0.0 ? HUGE_VAL : -HUGE_VAL);
        const std::string text = fmt::format("{} %", number);
        if (number >= 0.0 && to_si(text, "1") == share) return text;
    }
    return fmt::format("{} %", 100.0 * share);
}

void write_tolerances(Writer& w, const std::map<std::string, Tolerance>& tolerances) {
    if (tolerances.empty()) return;
    w.table("[compare.tolerance]");
    for (const auto& [name, tolerance] : tolerances) {
        const MetricRow* metric = find_judgeable_row(name);
        const std::string_view unit = metric == nullptr ? "1" : metric->tolerance_unit();
        w.words(name, tolerance.relative ? per_cent(tolerance.value)
                      : unit == "1"      ? fmt::format("{}", tolerance.value)
                                         : fmt::format("{} {}", tolerance.value, unit));
    }
}

void write_series(Writer& w, const SeriesSpec& s) {
    w.table("[series]");
    w.words("x", s.x);
    w.words("y", s.y);
    if (!s.group.empty()) w.words("group", s.group);
    if (!s.test.empty()) w.words("test", s.test);
}

void write_size(Writer& w, const SizeSpec& s) {
    w.table("[size]");
    if (s.max_descent_rate) w.number("max_descent_rate", *s.max_descent_rate);
    if (s.max_force) w.number("max_force", *s.max_force);
    if (s.max_canopy_force) w.number("max_canopy_force", *s.max_canopy_force);
    if (s.max_deceleration) w.number("max_deceleration", *s.max_deceleration);
    if (!s.parachute.empty()) w.words("parachute", s.parachute);
    w.list("vary", s.vary);
    std::vector<std::string> names;
    for (const CanopyType& type : s.types)
        names.push_back(type.name);
    if (!names.empty()) w.list("types", names);
}

}  // namespace

std::string trigger_text(const Trigger& t) {
    std::string text;
    if (t.kind == Trigger::Kind::time)
        text = fmt::format("time {:g} s", t.value);
    else if (t.kind == Trigger::Kind::altitude)
        text = fmt::format("altitude {:g} m", t.value);
    else if (t.kind == Trigger::Kind::dynamic_pressure)
        text = fmt::format("dynamic pressure {:g} Pa", t.value);
    else
        text = fmt::format("{}{}{}", t.of, t.of.empty() ? "" : ".", occurrence_name(t.kind));
    return t.delay > 0.0 ? fmt::format("{} and {:g} s", text, t.delay) : text;
}

std::string write_scene(const Scene& scene) {
    Writer w;
    w.count("schema", 1);
    w.words("name", scene.name);
    write_environment(w, scene.environment);
    w.table("[payload]");
    w.number("mass", scene.payload.mass);
    if (const auto& table = scene.payload.drag_area_table; table && scene.payload.drag_area)
        w.words("drag_area_table", table->file());
    else if (scene.payload.drag_area)
        w.number("drag_area", *scene.payload.drag_area);
    if (scene.payload.diameter) w.number("diameter", *scene.payload.diameter);
    if (scene.payload.body) {
        constexpr const char* shapes[] = {"box", "cylinder", "mesh"};
        w.words("body.shape", shapes[static_cast<std::size_t>(scene.payload.body->shape)]);
        if (!scene.payload.body->size.empty()) w.numbers("body.size", scene.payload.body->size);
        if (const auto& elastic = scene.payload.body->elasticity) {
            w.number("body.elasticity.youngs_modulus", elastic->youngs_modulus);
            w.number("body.elasticity.poisson_ratio", elastic->poisson_ratio);
        }
    }
    w.table("[release]");
    w.number("altitude", scene.release.altitude);
    w.number("speed", scene.release.speed);
    w.number("path_angle", scene.release.path_angle);
    w.number("heading", scene.release.heading);
    for (const Parachute& parachute : scene.parachutes)
        write_parachute(w, parachute);
    write_aerodynamics(w, scene.aerodynamics);
    write_stop(w, scene.stop);
    if (!scene.then.empty()) w.words("then", scene.then);
    write_settings(w, scene.rom, scene.full);
    write_tolerances(w, scene.tolerances);
    if (scene.size) write_size(w, *scene.size);
    if (scene.series) write_series(w, *scene.series);
    return std::move(w).text();
}

bool same_scene(const Scene& a, const Scene& b) {
    return a.name == b.name && a.environment == b.environment && a.payload == b.payload &&
           a.release == b.release && a.parachutes == b.parachutes && a.aerodynamics == b.aerodynamics &&
           a.stop == b.stop && a.then == b.then && a.rom == b.rom && a.full == b.full &&
           a.tolerances == b.tolerances && a.size == b.size;
}

}  // namespace twinchute
