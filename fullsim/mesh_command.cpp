#include "fullsim/mesh_command.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "fullsim/canopy/canopy_geometry.hpp"
#include "fullsim/canopy/cross.hpp"
#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/gmsh_write.hpp"
#include "fullsim/mesh/gore_mesh.hpp"
#include "fullsim/mesh/import_mesh.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/mesh/summary.hpp"
#include "fullsim/run/fields.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/needs.hpp"
#include "lib/scene/scene_id.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::fullsim {
namespace {

namespace fs = std::filesystem;

/// A mesh of a scene, and where it goes.
struct View {
    std::string what;
    Mesh mesh;
    fs::path file;  // empty: nowhere
};

/// Formats of the files that --out may name, by their extension.
constexpr std::string_view vtk_file = ".vtu", gmsh_file = ".msh";

/// For Gmsh: the parachute as it is made.
View view_for_gmsh(const Scene& scene, const fs::path& file) {
    const Parachute& chute = scene.parachutes.front();
    if (cross_arm_ratio(chute) > 0.0)
        throw UsageError(
            fmt::format("{}: a Gmsh file has no cross (cables of a file are as long as their nodes lie "
                        "apart, and those of a flat cross do not), name a .vtu file",
                        scene.file.string()));
    const GoreOutline outline = canopy_geometry(chute).outline(chute);
    const double reach = outline.seam_point(outline.skirt).radius;
    if (!chute.mesh && chute.line_length <= reach)
        throw UsageError(
            fmt::format("{}: the parachute cannot be laid flat for Gmsh (lines of {:g} m do not reach from "
                        "the axis to the "
                        "skirt at {:.4g} m), name a .vtu file",
                        scene.file.string(), chute.line_length, reach));
    if (!built_mesh(scene).other_fabrics.empty())
        throw UsageError(
            fmt::format("{}: a Gmsh file has one fabric (parachute.panel names others), name a .vtu file",
                        scene.file.string()));
    if (chute.vent_lines)
        throw UsageError(
            fmt::format("{}: a Gmsh file has no vent lines (cables of a file are as long as their nodes lie "
                        "apart, and these are not), name a .vtu file",
                        scene.file.string()));
    if (scene.payload.body && scene.payload.body->sling_length)
        throw UsageError(fmt::format(
            "{}: a Gmsh file has no slings (their apex belongs to no tetrahedron), name a .vtu file",
            scene.file.string()));
    Mesh mesh = built_mesh(scene);
    if (scene.payload.body) attach_payload(scene, mesh, Hang::as_made);
    return {"as made", std::move(mesh), file};
}

/// As it starts, without its load: drawn out, and packed where the scene begins so. Both about the payload.
std::vector<View> views_of(const Scene& scene, const std::optional<fs::path>& out) {
    if (out && out->extension() == gmsh_file)
        return {view_for_gmsh(scene, directory_of(scene, out->parent_path()) / out->filename())};
    const fs::path file = out ? directory_of(scene, out->parent_path()) / out->filename() : fs::path();
    std::vector<View> views{{"drawn out", unloaded_mesh(scene), file}};
    const Deployment& deploy = scene.parachutes.front().deploy;
    if (deploy.starts_packed()) {
        Mesh packed = views.front().mesh;
        pack(packed, deploy.pack_ratio);
        const fs::path beside =
            out ? file.parent_path() / (file.stem().string() + "-packed.vtu") : fs::path();
        views.push_back({"packed", std::move(packed), beside});
    }
    return views;
}

std::string vtu_of(const Mesh& mesh) {
    VtuGrid grid = mesh_grid(mesh);
    grid.point_data.push_back({"mass_kg", 1, mesh.mass});
    add_cell_data(grid, mesh, "area_m2", [](const Triangle& t) { return t.area(); }, {});
    add_cell_data(grid, mesh, "length_m", {}, [](const Cable& c) { return c.rest_length; });
    return vtu_text(grid);
}

std::string text_of(const View& view, const Scene& scene, GmshVersion version) {
    return view.file.extension() == gmsh_file ? gmsh_text(view.mesh, version, printable(scene.name))
                                              : vtu_of(view.mesh);
}

std::optional<fs::path> wanted_file(const Arguments& arguments) {
    const auto text = arguments.value("out");
    if (!text) return {};
    fs::path file = *text;
    if ((file.extension() != vtk_file && file.extension() != gmsh_file) || file.stem().empty())
        throw UsageError(fmt::format(
            "'--out {}' is not understood (the name of a .vtu file, for VTK, or of a .msh file, for "
            "Gmsh, is wanted), e.g. --out c9.vtu",
            *text));
    return file;
}

GmshVersion wanted_version(const Arguments& arguments) {
    const std::string text = arguments.value("msh-version").value_or("4.1");
    if (text != "4.1" && text != "2.2")
        throw UsageError(
            fmt::format("'--msh-version {}' is not understood (4.1 or 2.2), e.g. --msh-version 2.2", text));
    return text == "4.1" ? GmshVersion::v4_1 : GmshVersion::v2_2;
}

/// Areas that the mesh is held against: of the nominal circle and of the vent.
struct Circles {
    double nominal, vent;  // [m^2]
};

Circles circles_of(const Parachute& chute) {
    const auto area = [](double diameter) { return 0.25 * pi * diameter * diameter; };
    return {area(chute.nominal_diameter), area(chute.vent_diameter)};
}

Grading grading_of(const Scene& scene) {
    return meshed_grading(scene.parachutes.front(), scene.full.mesh);
}

/// Difference between the mesh and the canopy of the parachute's type; nothing where there is none.
std::optional<std::string> note_of(const Parachute& chute) {
    if (const auto other = stand_in(chute)) return other->what + ": " + other->why;
    if (const auto slots = smeared_slots(chute))
        return slots->what + ": " + slots->why + "; read back by parachute.mesh, the fabric is whole";
    if (const auto open = open_middle(chute)) return open->what + ": " + open->why;
    if (const auto corners = open_corners(chute)) return corners->what + ": " + corners->why;
    if (has_gaps(chute)) return open_gaps(chute).why;
    return std::nullopt;
}

std::string summary_json_of(const Scene& scene, const std::vector<View>& views) {
    using nlohmann::ordered_json;
    const MeshSummary s = summarise(views.front().mesh);
    const Circles circles = circles_of(scene.parachutes.front());
    ordered_json cables = ordered_json::object(), masses = {{"fabric", s.fabric_mass}};
    for (std::size_t i = 0; i < cable_kind_count; ++i) {
        const std::string kind(cable_kind_name(static_cast<CableKind>(i)));
        cables[kind] = s.cables[i];
        masses[kind] = s.cable_mass[i];
    }
    cables["reefing line"] = s.reefing_line;
    masses["total"] = s.total_mass;
    masses["parachute.mass"] = scene.parachutes.front().mass;
    ordered_json meshes = ordered_json::array();
    for (const View& view : views) {
        const Vec3 size = bounding_size(view.mesh);
        ordered_json mesh{{"mesh", view.what}, {"size_m", {size.x(), size.y(), size.z()}}};
        if (!view.file.empty()) mesh["file"] = view.file.string();
        meshes.push_back(std::move(mesh));
    }
    ordered_json json{{"generator", "twinchute"},
                      {"scene", scene_json(scene_id(scene))},
                      {"parachute", scene.parachutes.front().name},
                      {"grading", grading_name(grading_of(scene))},
                      {"nodes", s.nodes},
                      {"triangles", s.triangles},
                      {"cables", std::move(cables)},
                      {"mass_kg", std::move(masses)},
                      {"fabric_area_m2", s.fabric_area},
                      {"gap_area_m2", s.gap_area},
                      {"nominal_area_m2", circles.nominal},
                      {"vent_area_m2", circles.vent},
                      {"smallest_edge_m", s.smallest_edge},
                      {"meshes", std::move(meshes)}};
    if (const auto note = note_of(scene.parachutes.front())) json["note"] = *note;
    return json_text(json);
}

/// named: --parachute has chosen it.
std::string summary_text_of(const Scene& scene, const std::vector<View>& views, bool named) {
    const MeshSummary s = summarise(views.front().mesh);
    const Parachute& chute = scene.parachutes.front();
    const Circles circles = circles_of(chute);
    Table table;
    table.header = {"", "count", "mass [kg]", ""};
    table.right = {false, true, true};
    const auto row = [&](std::string_view what, std::size_t count, double mass) {
        table.rows.push_back({std::string(what), std::to_string(count), fmt::format("{:.3f}", mass), ""});
    };
    table.rows.push_back({"nodes", std::to_string(s.nodes), "", ""});
    row("fabric triangles", s.triangles, s.fabric_mass);
    for (std::size_t i = 0; i < cable_kind_count; ++i)
        row(fmt::format("{} cables", cable_kind_name(static_cast<CableKind>(i))), s.cables[i],
            s.cable_mass[i]);
    if (s.reefing_line > 0) row("reefing line cables", s.reefing_line, 0.0);
    table.rows.push_back({"parachute", "", fmt::format("{:.3f}", s.total_mass),
                          fmt::format("parachute.mass says {:.3f} kg, {:+.1f} %", chute.mass,
                                      100.0 * (s.total_mass / chute.mass - 1.0))});
    Table sizes;
    sizes.right = {false, true};
    sizes.rows = {
        {"fabric area", readable(s.fabric_area, 6), "m2",
         has_open_middle(chute)
             ? fmt::format("pi/4 D0^2 is {} m2", readable(circles.nominal, 6))
             : fmt::format("pi/4 D0^2 less {} is {} m2", s.gap_area > 0.0 ? "vent and gaps" : "the vent",
                           readable(circles.nominal - circles.vent - s.gap_area, 6))},
        {"smallest edge", readable(s.smallest_edge), "m",
         fmt::format("of a triangle or cable, unstrained; {} mesh", grading_name(grading_of(scene)))}};
    if (cross_arm_ratio(chute) > 0.0) {
        const CrossOutline cross = cross_outline(chute);
        sizes.rows.push_back({"strips", fmt::format("{} x {}", readable(cross.width), readable(cross.length)),
                              "m", "two that cross, as cut"});
    }
    for (const View& view : views) {
        const Vec3 size = bounding_size(view.mesh);
        sizes.rows.push_back(
            {view.what,
             fmt::format("{} x {} x {}", readable(size.x()), readable(size.y()), readable(size.z())), "m",
             "east, north, up"});
    }
    const Style style = output_style();
    std::string text = style.paint(printable(scene.name), Colour::bold);
    if (!scene.case_name.empty()) text += ", " + printable(scene.case_name);
    if (named || chute.count > 1) text += ", " + printable(chute.name);
    if (chute.count > 1) text += fmt::format(", one of {}", chute.count);
    text += "\n\n" + aligned(table, style, 2) + "\n" + aligned(sizes, style, 2);
    if (const auto note = note_of(chute)) text += "\nnote      " + *note;
    for (const View& view : views)
        if (!view.file.empty()) text += fmt::format("\nmesh      {}", printable(view.file.string()));
    return text + (views.front().file.empty() ? "" : "\n");
}

ExitCode run_mesh(const Arguments& arguments) {
    const std::optional<fs::path> out = wanted_file(arguments);
    const GmshVersion version = wanted_version(arguments);
    std::vector<Scene> scenes = scenes_of(arguments);
    for (Scene& scene : scenes)
        scene = with_one_parachute(std::move(scene), arguments);
    for (const Scene& scene : scenes)
        if (const auto missing = missing_structure(scene.parachutes.front()); !missing.empty())
            throw UsageError(
                fmt::format("{}: the parachute has no structure to mesh ({}), give these keys or a design",
                            scene.file.string(), unsupported_text(scene, missing)));
    for (const Scene& scene : scenes)
        if (const std::string why = lacks_canopy(scene.parachutes.front()); !why.empty())
            throw UsageError(
                fmt::format("{}: no canopy is meshed for 'parachute.type' ({}), give parachute.mesh, "
                            "or run the scene with `twinchute rom`",
                            scene.file.string(), why));
    for (const Scene& scene : scenes)
        if (const auto refusals = cross_refusals(scene); !refusals.empty())
            throw UsageError(fmt::format("{}: '{}' ({})", scene.file.string(), refusals.front().key,
                                         refusals.front().why));
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    FileBatch batch;
    std::vector<std::string> texts;
    for (const Scene& scene : scenes) {
        const std::vector<View> views = views_of(scene, out);
        for (const View& view : views) {
            if (view.file.empty()) continue;
            check_output_file(view.file, {"<!-- twinchute", "$Comments\ntwinchute"}, "mesh");
            batch.add(view.file, text_of(view, scene, version));
        }
        texts.push_back(arguments.has("json") ? summary_json_of(scene, views)
                                              : summary_text_of(scene, views, arguments.has("parachute")));
    }
    batch.commit();
    print_each(arguments, scenes, texts);
    return ExitCode::done;
}

}  // namespace

Command mesh_command() {
    Command command;
    command.name = "mesh";
    command.summary = "what the full model's mesh weighs and measures, and its shape for VTK";
    command.operand = "SCENE";
    command.example = "twinchute mesh data/scenes/c9-inflation.toml --out c9.vtu";
    command.options = scene_options(
        "write the mesh there: .vtu, a packed one beside it as <name>-packed.vtu; or .msh for Gmsh, as made");
    command.options.front().value = "FILE";
    command.options.insert(command.options.begin() + 1, {"msh-version",
                                                         "VERSION",
                                                         "of a .msh file: 4.1 (default) or 2.2, both ASCII",
                                                         false,
                                                         {"4.1", "2.2"}});
    command.options.insert(command.options.begin() + 2, parachute_option());
    command.run = &run_mesh;
    return command;
}

}  // namespace twinchute::fullsim
