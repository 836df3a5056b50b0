#include "lib/scene/write_scene.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "lib/record/metrics.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/units.hpp"

namespace twinchute {
namespace {

/// A TOML basic string.
std::string toml(std::string_view text) {
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

std::string toml(double value) {
    // "-0" would be a whole number, which has no sign to keep.
    return value == 0.0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value);
}
std::string toml(std::int64_t value) {
    return fmt::format("{}", value);
}
template <class T>
std::string toml(const std::vector<T>& values) {
    std::vector<std::string> all;
    for (const T& value : values)
        all.push_back(toml(value));
    return fmt::format("[{}]", fmt::join(all, ", "));
}

/// Writes what the table of keys binds, in its order, under the heads of tables.
class Writer {
public:
    /// Keys that begin with `prefix` follow, without it.
    void table(std::string_view head, std::string prefix) {
        prefix_ = std::move(prefix);
        head_ = head;
        text_ += fmt::format("\n{}\n", head);
    }

    void line(std::string_view path, std::string_view value) {
        text_ += fmt::format("{} = {}\n", path.substr(prefix_.size()), value);
    }

    /// Nothing where the object has no such value, or the words before it leave it out.
    template <class Object>
    void key(const Object& object, const Key& key) {
        if constexpr (std::is_same_v<Object, Parachute>)
            if (object.filling.is_predicted() && prescribes_filling(key.path)) return;
        const auto value = value_of(object, key);
        if (!value) return;
        if (std::is_same_v<Object, Scene> && key.path.find('.') != std::string_view::npos) section(key.path);
        if (key.is_selector()) selected_[key.path] = std::get<std::string>(*value);
        line(key.path, std::visit([](const auto& v) { return toml(v); }, *value));
    }

    /// Every key that is bound in the object, below a table.
    template <class Object>
    void keys(const Object& object, std::string_view table) {
        for (const Key& row : scene_keys())
            if (is_below(row.path, table)) key(object, row);
    }

    /// The head of a path's table of the scene, unless it is the last one written.
    void section(std::string_view path) {
        const std::string_view name = path.substr(0, path.find('.'));
        if (const std::string head = fmt::format("[{}]", name); head != head_)
            table(head, fmt::format("{}.", name));
    }

    std::string text() && { return std::move(text_); }

private:
    template <class Object>
    OptionalValue value_of(const Object& object, const Key& key) const {
        const auto* binding = std::get_if<BindingOf<Object>>(&key.binding);
        if (!binding || !binding->get) return {};
        if (!key.only_with.empty()) {
            const auto word = selected_.find(selector_of(scene_keys(), key)->path);
            if (word == selected_.end() || !key.goes_with(word->second)) return {};
        }
        // A file stands in place of what is read from it.
        for (const std::string_view other : words_of(key.instead_of)) {
            const Key& file = *find_key(scene_keys(), other);
            if (file.kind == KeyKind::csv_file && value_of(object, file)) return {};
        }
        return binding->get(object);
    }

    std::string text_, head_, prefix_;
    std::map<std::string_view, std::string> selected_;  ///< by path of the selector
};

void write_parachute(Writer& w, const Parachute& p) {
    w.table("[[parachute]]", "parachute.");
    w.keys(p, "parachute");
    if (!p.filling.is_predicted()) w.keys(p.fill_time, "parachute.fill_time");
    if (p.deploy_when) w.keys(*p.deploy_when, "parachute.deploy.when");
    if (p.cut) w.keys(*p.cut, "parachute.cut");
    for (const PanelMaterials& panel : p.panel) {
        w.table("[[parachute.panel]]", "parachute.panel.");
        w.keys(panel, "parachute.panel");
    }
    for (const Reefing& stage : p.reefing) {
        w.table("[[parachute.reefing]]", "parachute.reefing.");
        w.keys(stage, "parachute.reefing");
        if (stage.fill_time) w.keys(*stage.fill_time, "parachute.reefing.fill_time");
        w.keys(stage.until, "parachute.reefing.until");
    }
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
    w.table("[compare.tolerance]", "");
    for (const auto& [name, tolerance] : tolerances) {
        const MetricRow* metric = find_judgeable_row(name);
        const std::string_view unit = metric == nullptr ? "1" : metric->tolerance_unit();
        w.line(name, toml(tolerance.relative ? per_cent(tolerance.value)
                          : unit == "1"      ? fmt::format("{}", tolerance.value)
                                             : fmt::format("{} {}", tolerance.value, unit)));
    }
}

}  // namespace

std::string write_scene(const Scene& scene) {
    Writer w;
    for (const Key& key : scene_keys()) {
        if (key.path == "parachute")
            for (const Parachute& parachute : scene.parachutes)
                write_parachute(w, parachute);
        if (key.kind == KeyKind::tolerance) write_tolerances(w, scene.tolerances);
        w.key(scene, key);
    }
    return std::move(w).text();
}

bool same_scene(const Scene& a, const Scene& b) {
    return a.name == b.name && a.environment == b.environment && a.payload == b.payload &&
           a.release == b.release && a.parachutes == b.parachutes && a.aerodynamics == b.aerodynamics &&
           a.stop == b.stop && a.then == b.then && a.rom == b.rom && a.full == b.full &&
           a.tolerances == b.tolerances && a.size == b.size;
}

}  // namespace twinchute
