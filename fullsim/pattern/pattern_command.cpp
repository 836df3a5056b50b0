#include "fullsim/pattern/pattern_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "fullsim/canopy/canopy_geometry.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/mesh/summary.hpp"
#include "fullsim/pattern/drawings.hpp"
#include "fullsim/pattern/gore_pattern.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/needs.hpp"
#include "lib/scene/scene_id.hpp"
#include "lib/scene/units.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double largest_allowance = 0.2;  // [m]

struct PatternFormat {
    std::string_view extension;
    std::string (*drawing)(const GorePattern& pattern, const PatternNotes& notes);
};
constexpr PatternFormat pattern_formats[] = {
    {".svg", pattern_svg}, {".dxf", pattern_dxf}, {".pdf", pattern_pdf}};

/// A row of the list of parts.
struct Part {
    std::string name;
    int count;
    double length;               ///< [m] of each, unstrained
    std::optional<double> mass;  ///< [kg] of all; absent: not in the mesh
    std::string material;
    int strands = 1;  ///< cords side by side
};

/// A canopy to cut: its scene with the one parachute.
struct Cut {
    Scene scene;
    GorePattern pattern;
    MeshSummary mesh;
    std::vector<Part> parts;

    const Parachute& chute() const { return scene.parachutes.front(); }
};

double allowance_of(const Arguments& arguments) {
    const auto text = arguments.value("allowance");
    if (!text) return 0.0;
    try {
        const double allowance = to_si(*text, "m");
        if (allowance >= 0.0 && allowance <= largest_allowance) return allowance;
    } catch (const UnitError&) {
        // as below
    }
    throw UsageError(
        fmt::format("'--allowance {}' is not understood (a length with its unit up to {:g} m is wanted), "
                    "e.g. --allowance "
                    "'15 mm'",
                    *text, largest_allowance));
}

const PatternFormat* format_of(const Arguments& arguments) {
    const auto text = arguments.value("out");
    if (!text) return nullptr;
    const auto format = std::ranges::find(pattern_formats, std::filesystem::path(*text).extension().string(),
                                          &PatternFormat::extension);
    if (format != std::end(pattern_formats)) return format;
    throw UsageError(fmt::format(
        "'--out {}' is not understood (the name of a .svg, .dxf or .pdf file is wanted), e.g. --out gore.dxf",
        *text));
}

PatternPieces pieces_of(const Arguments& arguments) {
    const auto text = arguments.value("pieces");
    if (!text || *text == "gore") return PatternPieces::gore;
    if (*text == "panels") return PatternPieces::panels;
    throw UsageError(fmt::format("'--pieces {}' is not understood (gore or panels is wanted), {}", *text,
                                 suggest(*text, {"gore", "panels"})));
}

const Paper& paper_of(const Arguments& arguments) {
    const auto text = arguments.value("paper");
    if (!text) return papers[0];
    const auto paper = std::ranges::find(papers, std::string_view(*text), &Paper::name);
    if (paper != std::end(papers)) return *paper;
    throw UsageError(fmt::format("'--paper {}' is not understood (a4 or letter is wanted), {}", *text,
                                 suggest(*text, {"a4", "letter"})));
}

/// A pattern of another canopy than the scene's would be worse than none.
void require_pattern(const Scene& scene, const Parachute& chute, PatternPieces pieces) {
    const auto refuse = [&](const std::string& problem, const std::string& why, const std::string& hint) {
        throw UsageError(fmt::format("{}: {} ({}), {}", scene.file.string(), problem, why, hint));
    };
    if (const auto missing = missing_structure(chute); !missing.empty())
        refuse("the parachute has no structure to cut", unsupported_text(scene, missing),
               "give these keys or a design");
    if (chute.mesh)
        refuse("parachute.mesh has no gores to cut", "its triangles are somebody's own",
               "take it out to cut the gores of the parachute's type");
    if (const std::string why = lacks_canopy(chute); !why.empty())
        refuse("there is no cut for 'parachute.type'", why, "give parachute.cone_angle, or another type");
    if (!chute.panel.empty())
        refuse("parachute.panel has fabrics of its own", "the list of parts knows one",
               "take it out to cut the gores, and take each panel of its own fabric");
    if (cross_arm_ratio(chute) > 0.0)
        refuse("there is no gore of a cross to cut", "its two strips are rectangles",
               "take their width and length from `twinchute mesh`");
    if (const auto other = stand_in(chute))
        refuse("there is no cut for 'parachute.type'", other->what + ": " + other->why,
               "give parachute.cone_angle, or another type");
    if (const auto slots = smeared_slots(chute))
        refuse("a canopy with slots is not cut in whole gores", slots->what + ": " + slots->why,
               "take its ribbons from its own drawings");
    if (has_gaps(chute) && pieces == PatternPieces::gore)
        refuse("a canopy with gaps is not cut in whole gores", open_gaps(chute).why,
               "cut it with --pieces panels");
}

std::vector<Part> parts_of(const Parachute& chute, const MeshSummary& mesh) {
    const GoreOutline outline = canopy_geometry(chute).outline(chute);
    const auto around = [&](double seam) {
        return 2.0 * outline.gores * cut_point(outline, {seam, 1}, 1).x();
    };
    std::vector<Part> parts;
    const auto add = [&](CableKind kind, int count, double length, const Cord& cord) {
        const double mass = mesh.cable_mass[static_cast<std::size_t>(kind)];
        const long strands = std::lround(mass / (count * length * cord.linear_density()));
        parts.push_back(
            {std::string(cable_kind_name(kind)), count, length, mass, cord.name, static_cast<int>(strands)});
    };
    add(CableKind::radial, outline.gores, outline.skirt - outline.vent, chute.tapes.radial);
    add(CableKind::skirt, 1, around(outline.skirt), chute.tapes.skirt);
    add(CableKind::vent, 1, around(outline.vent), chute.tapes.vent);
    add(CableKind::line, chute.gores, chute.line_length, chute.line);
    if (chute.vent_lines) {
        const VentLines& lines = *chute.vent_lines;
        add(CableKind::vent_line, lines.model == VentLines::Model::across ? chute.gores / 2 : chute.gores,
            vent_line_length(chute, outline.vent, outline.skirt),
            lines.cord.name.empty() ? chute.line : lines.cord);
    }
    if (chute.riser_length > 0.0) add(CableKind::riser, chute.risers, chute.riser_length, chute.line);
    for (std::size_t stage = 0; stage < chute.reefing.size(); ++stage)
        parts.push_back(
            {fmt::format("reefing line {}", stage + 1), 1, reefing_line_length(chute, stage), {}, ""});
    return parts;
}

Cut cut_of(const Scene& of, const Arguments& arguments, double allowance) {
    const Scene scene = with_one_parachute(of, arguments);
    const PatternPieces pieces = pieces_of(arguments);
    require_pattern(scene, scene.parachutes.front(), pieces);
    Cut cut{scene, gore_pattern(scene.parachutes.front(), allowance, pieces), {}, {}};
    cut.mesh = summarise(built_mesh(cut.scene));
    cut.parts = parts_of(cut.chute(), cut.mesh);
    return cut;
}

/// [kg] that all gores have of a piece, cut to `area` [m^2] of its fabric.
double fabric_mass(const Cut& cut, double area) {
    double sewn = 0.0;
    for (const PatternPiece& piece : cut.pattern.pieces)
        sewn += piece.area;
    return cut.mesh.fabric_mass * area / sewn;
}

Table parts_table(const Cut& cut) {
    const Parachute& chute = cut.chute();
    Table table;
    table.header = {"part", "count", "each", "", "mass of all [kg]", "material"};
    table.right = {false, true, true, false, true};
    for (const PatternPiece& piece : cut.pattern.pieces) {
        const auto row = [&](const char* state, double area) {
            table.rows.push_back({piece.name + state, std::to_string(chute.gores), readable(area, 6), "m2",
                                  fmt::format("{:.3f}", fabric_mass(cut, area)),
                                  printable(chute.fabric.name)});
        };
        row(", sewn", piece.area);
        if (cut.pattern.allowance > 0.0) row(", cut", piece.cut_area);
    }
    for (const Part& part : cut.parts)
        table.rows.push_back({part.name, std::to_string(part.count), readable(part.length, 6), "m",
                              part.mass ? fmt::format("{:.3f}", *part.mass) : "-",
                              (part.strands > 1 ? fmt::format("{} side by side, ", part.strands) : "") +
                                  printable(part.material)});
    return table;
}

PatternNotes notes_of(const Cut& cut, const Paper& paper) {
    PatternNotes notes{
        printable(cut.scene.name) + ", " + printable(cut.chute().name), cut.chute().gores, {}, &paper};
    std::istringstream table(aligned(parts_table(cut), Style{}, 0));
    for (std::string row; std::getline(table, row);)
        notes.parts.push_back(row);
    return notes;
}

std::string text_of(const Cut& cut, const std::string& file) {
    const Parachute& chute = cut.chute();
    const Style style = output_style();
    std::string text = style.paint(printable(cut.scene.name), Colour::bold) + ", " + printable(chute.name);
    if (chute.count > 1) text += fmt::format(", one of {}", chute.count);
    text += "\n\n" + aligned(parts_table(cut), style, 2);
    text +=
        "\nLengths are unstrained, between attachments: hems, loops and knots come on top. Masses are those "
        "of\n"
        "the mesh, without thread and hardware. A gore is straight across the axis, so that it lies flat\n"
        "without strain. Its grain runs along the centre line (assumption of this toolkit).\n";
    if (!file.empty()) text += fmt::format("\npattern   {}\n", printable(file));
    return text;
}

std::string json_of(const Cut& cut, const std::string& file) {
    nlohmann::ordered_json parts = nlohmann::ordered_json::array();
    for (const Part& part : cut.parts) {
        nlohmann::ordered_json row{{"part", part.name}, {"count", part.count}, {"length_m", part.length}};
        if (part.mass) row["mass_kg"] = *part.mass;
        if (!part.material.empty()) row["material"] = part.material;
        if (part.mass) row["strands"] = part.strands;
        parts.push_back(std::move(row));
    }
    nlohmann::ordered_json pieces = nlohmann::ordered_json::array();
    double area = 0.0, cut_area = 0.0;
    for (const PatternPiece& piece : cut.pattern.pieces) {
        area += piece.area;
        cut_area += piece.cut_area;
        pieces.push_back({{"piece", piece.name},
                          {"count", cut.chute().gores},
                          {"area_m2", piece.area},
                          {"cut_area_m2", piece.cut_area}});
    }
    nlohmann::ordered_json json{{"generator", "twinchute"},
                                {"scene", scene_json(scene_id(cut.scene))},
                                {"parachute", cut.chute().name},
                                {"gores", cut.chute().gores},
                                {"allowance_m", cut.pattern.allowance},
                                {"gore_area_m2", area},
                                {"gore_cut_area_m2", cut_area},
                                {"fabric", cut.chute().fabric.name},
                                {"fabric_mass_kg", cut.mesh.fabric_mass},
                                {"pieces", std::move(pieces)},
                                {"parts", std::move(parts)}};
    if (!file.empty()) json["file"] = file;
    return json_text(json);
}

ExitCode run_pattern(const Arguments& arguments) {
    const PatternFormat* format = format_of(arguments);
    const Paper& paper = paper_of(arguments);
    const double allowance = allowance_of(arguments);
    const std::vector<Scene> scenes = scenes_of(arguments);
    std::vector<Cut> cuts;
    for (const Scene& scene : scenes)
        cuts.push_back(cut_of(scene, arguments, allowance));
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    FileBatch batch;
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        std::filesystem::path file;
        if (format) {
            const std::filesystem::path out = *arguments.value("out");
            file = directory_of(scenes[i], out.parent_path()) / out.filename();
            check_output_file(
                file, {"<!-- twinchute pattern", "999\ntwinchute pattern", "(twinchute pattern)"}, "pattern");
            batch.add(file, format->drawing(cuts[i].pattern, notes_of(cuts[i], paper)));
        }
        texts.push_back(arguments.has("json") ? json_of(cuts[i], file.string())
                                              : text_of(cuts[i], file.string()));
    }
    batch.commit();
    print_each(arguments, scenes, texts);
    return ExitCode::done;
}

}  // namespace

Command pattern_command() {
    Command command;
    command.name = "pattern";
    command.summary = "the gore of a canopy as it is cut, and a list of parts";
    command.operand = "SCENE";
    command.example = "twinchute pattern data/scenes/c9-inflation.toml --out gore.svg --allowance '15 mm'";
    command.options = scene_options("draw the gore there at true scale: .svg, .dxf or .pdf");
    command.options.front().value = "FILE";
    command.options.insert(
        command.options.begin() + 1,
        {{"allowance", "LENGTH", "seam allowance around the gore, e.g. '15 mm'; none unless given"},
         {"pieces", "WHICH", "that a gore is cut in: gore (unless given) or panels"},
         {"paper", "SIZE", "that a .pdf is tiled to: a4 (unless given) or letter"},
         parachute_option()});
    command.run = &run_pattern;
    return command;
}

}  // namespace twinchute::fullsim
