#include "lib/scene/canopy_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/models/drag_area.hpp"
#include "lib/scene/assemble.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/values.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

constexpr const char* folder = "parachutes/types";
constexpr std::string_view type_prefix = "type.";

std::vector<std::string_view> grades() {
    return {"A", "B", "C", "R"};
}

/// Words of full_model.canopy, in the order of MeshedCanopy::Shape.
std::vector<std::string_view> meshed_canopies() {
    return {"own", "flat-circular", "none"};
}

/// Words of full_model.slots.
std::vector<std::string_view> slot_words() {
    return {"none", "smeared"};
}

/// Words of full_model.middle.
std::vector<std::string_view> middle_words() {
    return {"vent", "open"};
}

/// A range that a type may have, a table of its file: { low, high, source, grade }.
struct RangeRow {
    std::string_view name, unit;
    double highest;
    std::optional<TypeRange> CanopyType::*member;
    std::string_view key;  ///< of a scene, that its middle is the default of; empty: none
    std::string_view meaning;
};

constexpr RangeRow ranges[] = {
    {"drag_coefficient", "1", 5.0, &CanopyType::drag_coefficient, "parachute.drag_coefficient",
     "C_D0 on the nominal area"},
    {"opening_force_coefficient", "1", 5.0, &CanopyType::opening_force_coefficient,
     "parachute.opening_force_coefficient", "C_x at infinite mass"},
    {"projected_diameter_ratio", "1", 1.0, &CanopyType::projected_diameter_ratio,
     "parachute.projected_diameter_ratio", "D_p/D0 of the steady canopy"},
    {"fill_constant", "1", 200.0, &CanopyType::fill_constant, "parachute.fill_time.n",
     "n of t_f = n D0/v_s, unreefed"},
    {"oscillation", "rad", pi, &CanopyType::oscillation, "", "average angle of oscillation"},
    {"growth_exponent", "1", 10.0, &CanopyType::growth_exponent, "", "j: the drag area grows with t^j"},
};

/// The keys of a type's file; a row of five for each range.
std::span<const Key> type_keys() {
    static std::deque<std::string> paths;  // rows refer to their paths
    static const std::vector<Key> rows = [] {
        std::vector<Key> keys{
            {.path = "type.title", .kind = KeyKind::text, .meaning = "what it is called"},
            {.path = "type.full_model",
             .kind = KeyKind::table,
             .need = KeyNeed::optional,
             .meaning = "what the full model meshes for it; absent: nothing"},
            {.path = "type.full_model.canopy",
             .kind = KeyKind::word,
             .choices = meshed_canopies,
             .meaning = "its own shape, a flat circular canopy in its place, or none"},
            {.path = "type.full_model.why",
             .kind = KeyKind::text,
             .meaning = "what sets the type apart from a flat circular canopy"},
            {.path = "type.full_model.cone_angle",
             .kind = KeyKind::quantities,
             .unit = "rad",
             .need = KeyNeed::optional,
             .range = {0.0, pi, false, true},
             .meaning = "of each panel of a gore, from apex to skirt, at its upper edge; absent: "
                        "flat circular"},
            {.path = "type.full_model.lower_angle",
             .kind = KeyKind::quantities,
             .unit = "rad",
             .need = KeyNeed::optional,
             .range = {0.0, pi, false, true},
             .meaning = "at its lower edge, where panels are arcs"},
            {.path = "type.full_model.panel_length",
             .kind = KeyKind::quantities,
             .unit = "1",
             .need = KeyNeed::optional,
             .range = {0.0, 1000.0, true, false},
             .meaning = "along the seam, over those of the others; absent: all alike"},
            {.path = "type.full_model.gaps",
             .kind = KeyKind::quantities,
             .unit = "1",
             .need = KeyNeed::optional,
             .range = {1.0, 1000.0, false, false},
             .meaning = "which panels have no fabric, by their numbers from the apex"},
            {.path = "type.full_model.arm_ratio",
             .kind = KeyKind::quantity,
             .unit = "1",
             .need = KeyNeed::optional,
             .range = {0.0, 1.0, true, true},
             .meaning = "of two strips that cross: their width over their length; absent: gores"},
            {.path = "type.full_model.slots",
             .kind = KeyKind::word,
             .need = KeyNeed::defaulted,
             .fallback = "none",
             .choices = slot_words,
             .meaning =
                 "narrow slots across the gores, which parachute.geometric_porosity gives the share of: "
                 "the full model smears fabric and slots to one sheet"},
            {.path = "type.full_model.middle",
             .kind = KeyKind::word,
             .need = KeyNeed::defaulted,
             .fallback = "vent",
             .choices = middle_words,
             .meaning =
                 "open: panels begin at the edge of a wide middle, which parachute.vent_diameter gives "
                 "and D0 leaves out; vent: at the apex, and D0 counts the vent"},
            {.path = "type.full_model.gore_source",
             .kind = KeyKind::text,
             .need = KeyNeed::optional,
             .meaning = "where these numbers are from"}};
        for (const RangeRow& range : ranges) {
            const auto path = [&](const char* last) -> std::string_view {
                return paths.emplace_back(fmt::format("{}{}{}", type_prefix, range.name, last));
            };
            const KeyRange limits{0.0, range.highest, false, false};
            keys.push_back({.path = path(""),
                            .kind = KeyKind::table,
                            .need = KeyNeed::optional,
                            .meaning = range.meaning});
            keys.push_back({.path = path(".low"), .unit = range.unit, .range = limits, .meaning = "lowest"});
            keys.push_back(
                {.path = path(".high"), .unit = range.unit, .range = limits, .meaning = "highest"});
            keys.push_back({.path = path(".source"), .kind = KeyKind::text, .meaning = "where it is from"});
            keys.push_back({.path = path(".grade"),
                            .kind = KeyKind::word,
                            .choices = grades,
                            .meaning = "how far to rely on it"});
        }
        return keys;
    }();
    return rows;
}

TypeRange range_of(const Values& v, const std::string& path) {
    TypeRange range{v.number(path + ".low"), v.number(path + ".high"), v.word(path + ".source"),
                    v.word(path + ".grade")};
    if (range.low > range.high)
        throw SceneError(v.place(path + ".low"), path.substr(type_prefix.size()) + ".low", "is above high",
                         fmt::format("{} and {}", range.low, range.high), "write the smaller one here");
    return range;
}

/// A gap lies between panels of fabric: vent and skirt are edges of fabric.
void mark_gaps(const Values& v, std::vector<GorePanel>& gore) {
    for (const double number : v.numbers("type.full_model.gaps")) {
        const auto refuse = [&](std::string why, std::string suggestion) {
            throw SceneError(v.place("type.full_model.gaps.1"), "full_model.gaps",
                             fmt::format("panel {:g} cannot be a gap", number), std::move(why),
                             std::move(suggestion));
        };
        const double last = static_cast<double>(gore.size());
        if (number != std::floor(number) || number > last)
            refuse(fmt::format("panels are numbered from 1 to {:g}", last), "give numbers of panels");
        if (number == 1.0 || number == last)
            refuse("vent and skirt are edges of fabric", "begin and end with fabric");
        gore[static_cast<std::size_t>(number) - 1].gap = true;
    }
    for (std::size_t i = 1; i < gore.size(); ++i)
        if (gore[i].gap && gore[i - 1].gap)
            throw SceneError(v.place("type.full_model.gaps.1"), "full_model.gaps",
                             fmt::format("panels {} and {} are gaps", i, i + 1), "nothing lies between them",
                             "make them one");
}

std::vector<GorePanel> gore_of(const Values& v) {
    const auto given = [&](const char* name) { return v.numbers(fmt::format("type.full_model.{}", name)); };
    const auto top = given("cone_angle"), bottom = given("lower_angle"), length = given("panel_length");
    std::vector<GorePanel> gore;
    for (std::size_t i = 0; i < top.size(); ++i)
        gore.push_back({length.empty() ? 1.0 : length[std::min(i, length.size() - 1)], top[i],
                        bottom.empty() ? top[i] : bottom[std::min(i, bottom.size() - 1)]});
    for (const auto& [list, name] : {std::pair{&bottom, "lower_angle"}, std::pair{&length, "panel_length"}})
        if (!list->empty() && list->size() != top.size())
            throw SceneError(v.place(fmt::format("type.full_model.{}.1", name)),
                             fmt::format("full_model.{}", name),
                             fmt::format("{} of {} panels", list->size(), top.size()),
                             "full_model.cone_angle says how many there are", "give one for each");
    mark_gaps(v, gore);
    return gore;
}

MeshedCanopy meshed_canopy(const Values& v) {
    const auto words = meshed_canopies();
    const auto found = std::ranges::find(words, v.word("type.full_model.canopy"));
    MeshedCanopy meshed{static_cast<MeshedCanopy::Shape>(found - words.begin()),
                        v.word("type.full_model.why"),
                        gore_of(v),
                        {}};
    meshed.slotted = v.word("type.full_model.slots") == slot_words().back();
    meshed.open_middle = v.word("type.full_model.middle") == middle_words().back();
    if (meshed.open_middle && (meshed.gore.empty() || meshed.gore.front().top != meshed.gore.front().bottom))
        throw SceneError(v.place("type.full_model.middle"), "full_model.middle", "is \"open\" without a cone",
                         "the first panel leads on to the apex that the open middle cuts off",
                         "give full_model.cone_angle, and no arc as its first panel");
    const std::string source = "type.full_model.gore_source", arms = "type.full_model.arm_ratio";
    if (v.given(source)) meshed.gore_source = v.word(source);
    if (v.given(arms)) meshed.arm_ratio = v.number(arms);
    if (meshed.arm_ratio > 0.0 && (!meshed.gore.empty() || meshed.slotted || meshed.open_middle))
        throw SceneError(v.place(arms), "full_model.arm_ratio", "stands beside keys of gores",
                         "strips that cross have none", "take cone_angle, slots and middle out");
    if (meshed.arm_ratio > 0.0 && meshed.gore_source.empty())
        throw SceneError(v.place(arms), "full_model.gore_source", "is missing", "every number has a source",
                         "say where the ratio is from");
    if (!meshed.gore.empty() && meshed.gore_source.empty())
        throw SceneError(v.place("type.full_model.cone_angle.1"), "full_model.gore_source", "is missing",
                         "every number has a source", "say where the angles are from");
    return meshed;
}

std::string source_text(const CanopyType& type, const TypeRange& range) {
    const std::string what = range.low == range.high ? fmt::format("{} canopies", type.title)
                                                     : fmt::format("middle of {} to {}, {} canopies",
                                                                   range.low, range.high, type.title);
    return fmt::format("{}: {} [grade {}]", what, range.source, range.grade);
}

/// Defaults of a canopy type, laid below a scene.
class Below {
public:
    Below(Document& scene, const CanopyType& type, const Entry& asked_by)
        : scene_(scene), type_(type), asked_by_(asked_by) {}

    bool has(std::string_view path) const { return scene_.entries.contains(std::string(path)); }

    void put(std::string_view path, RawValue value, std::string source) {
        if (has(path)) return;
        Entry entry = asked_by_;
        entry.key = find_key(scene_keys(), path);
        entry.value = std::move(value);
        entry.source = std::move(source);
        entry.origin = InputOrigin::design;
        scene_.entries.emplace(path, std::move(entry));
    }

    void put_middle(std::string_view path, const std::optional<TypeRange>& range) {
        if (range && range->may_be_default()) put(path, range->middle(), source_text(type_, *range));
    }

private:
    Document& scene_;
    const CanopyType& type_;
    const Entry& asked_by_;
};

/// C_D0, or D0 where the scene knows its drag area alone.
void put_size(Below& below, const Document& document, const CanopyType& type, const Entry& asked_by) {
    const auto& range = type.drag_coefficient;
    const bool has_area = document.entries.contains("parachute.drag_area");
    if (!has_area) {
        if (range && !range->may_be_default() && !document.entries.contains("parachute.drag_coefficient"))
            throw SceneError(
                asked_by.value_place, "parachute.drag_coefficient", "is missing",
                fmt::format("of the type '{}' only {} to {} is known, by recollection: that is no "
                            "default",
                            type.name, range->low, range->high),
                "give it or drag_area");
        return below.put_middle("parachute.drag_coefficient", range);
    }
    const auto area = quantity(document, "parachute.drag_area");
    if (!area || !(*area > 0.0) || !range || !range->may_be_default()) return;
    below.put("parachute.nominal_diameter", std::sqrt(*area / (0.25 * pi * range->middle())),
              "from drag_area and C_D0 in the " + source_text(type, *range));
}

/// Only where t_f = n D0/v_s is what the scene computes with: other models have another n, or none.
bool takes_fill_constant(const Document& document) {
    const auto model = document.entries.find("parachute.fill_time.model");
    if (model == document.entries.end()) return true;
    const auto* word = std::get_if<std::string>(&model->second.value);
    return word && *word == "fill-constant";
}

void put_law(Below& below, const CanopyType& type) {
    const auto& exponent = type.growth_exponent;
    if (below.has("parachute.drag_area_table") || below.has("parachute.drag_area_exponent")) return;
    if (!exponent || !exponent->may_be_default()) return;
    const DragAreaLaw* law = find_drag_area_law(fmt::format("power-{:g}", exponent->middle()));
    if (law) below.put("parachute.drag_area_law", std::string(law->name), source_text(type, *exponent));
}

}  // namespace

std::vector<std::string> canopy_type_names(const fs::path& scene_directory) {
    return data_names(folder, scene_directory);
}

CanopyType read_canopy_type(const std::string& name, std::string_view key, const SourcePlace& place,
                            const fs::path& directory) {
    const fs::path file = data_file(folder, name, key, place, directory);
    const DocumentKind kind{type_keys(), std::string(type_prefix), InputOrigin::design, std::string(key),
                            directory};
    const Values values(read_document(read_text_file(file), file.string(), kind), kind);
    CanopyType type;
    type.name = name;
    type.title = values.word("type.title");
    if (values.has_table("type.full_model")) type.meshed = meshed_canopy(values);
    for (const RangeRow& range : ranges) {
        const std::string path = fmt::format("{}{}", type_prefix, range.name);
        if (values.has_table(path)) type.*range.member = range_of(values, path);
    }
    return type;
}

void add_canopy_type(Document& document) {
    const auto found = document.entries.find("parachute.type");
    if (found == document.entries.end()) return;
    const Entry asked_by = found->second;
    const auto* name = std::get_if<std::string>(&asked_by.value);
    if (!name) return;  // the wrong type is refused with the other values
    const CanopyType type =
        read_canopy_type(*name, "parachute.type", asked_by.value_place, asked_by.directory);
    Below below(document, type, asked_by);
    put_size(below, document, type, asked_by);
    const bool filling = takes_fill_constant(document);
    const bool predicted = predicts_filling(document);
    for (const RangeRow& range : ranges) {
        if (range.key.empty() || range.member == &CanopyType::drag_coefficient) continue;
        if (range.member == &CanopyType::fill_constant && (predicted || !filling)) continue;
        below.put_middle(range.key, type.*range.member);
    }
    if (!predicted)
        put_law(below, type);
    else if (type.fill_constant || type.growth_exponent)
        document.overridden.push_back("parachute.type");
}

}  // namespace twinchute
