// RocketPy's saved flights and parameters. Source of what keys mean: rocketpy.Parachute.to_dict,
// rocketpy.Flight (equations of motion under a parachute: one drag area, the newest parachute's; the motor is
// empty).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/exchange/fall.hpp"
#include "lib/exchange/read_design.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::exchange {
namespace {

using Json = nlohmann::json;

/// [s] after apogee: an opening until then may begin at apogee without drag of the body.
constexpr double short_lag = 1.0;
constexpr double assumed_drag_coefficient =
    0.75;                                    ///< flat circular: the one that RocketPy's own manual names
constexpr double assumed_areal_mass = 0.06;  ///< [kg/m^2] of nominal area, fabric and lines

/// Python writes numbers that JSON does not have; they become null.
std::string without_python_numbers(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (std::size_t i = 0; i < text.size();) {
        if (text[i] == '"') {
            std::size_t end = i + 1;
            while (end < text.size() && text[end] != '"')
                end += text[end] == '\\' ? 2 : 1;
            end = std::min(end + 1, text.size());
            out += text.substr(i, end - i);
            i = end;
            continue;
        }
        bool replaced = false;
        for (const std::string_view word : {"-Infinity", "Infinity", "NaN"}) {
            if (!text.substr(i).starts_with(word)) continue;
            out += "null";
            i += word.size();
            replaced = true;
            break;
        }
        if (!replaced) out += text[i++];
    }
    return out;
}

class RocketPyReader {
public:
    RocketPyReader(std::string_view json, const std::string& file, const ImportChoice& choice)
        : file_(file), choice_(choice) {
        parse(json);
        locate();
    }

    ImportedScene read() {
        if (!choice_.simulation.empty())
            refuse("", "has no simulations to choose from", "", "leave out --simulation");
        const Json* version = at(top_, "version");
        scene_.program = version && version->is_string()
                             ? fmt::format("RocketPy {}", version->get<std::string>())
                             : "RocketPy";
        for (std::size_t i = 0; i < parachutes_->size(); ++i)
            read_parachute((*parachutes_)[i], fmt::format("parachutes[{}]", i));
        choose();
        find_release();
        write_top();
        add_common_assumptions(scene_, "RocketPy");
        write_environment();
        write_payload_and_release();
        if (chutes_.size() > 1 && !order_is_known())
            scene_.assumptions.push_back(
                "parachutes that are open pull together, where RocketPy flies on with the newest alone: the "
                "file does not "
                "tell their order");
        for (std::size_t i = 0; i < chutes_.size(); ++i)
            write_parachute(i);
        scene_.table("stop", "[stop]").add("at", "\"ground\"");
        say_rest();
        return std::move(scene_);
    }

private:
    struct Chute {
        std::string foreign, name;
        double drag_area, lag;
        enum class When { apogee, height, code } when;
        double height = 0.0;           ///< [m] above ground
        std::optional<double> opened;  ///< [s] in the stored flight: triggered, and the lag
        std::string note;              ///< about the trigger
    };

    [[noreturn]] void refuse(std::string key, std::string problem, std::string why, std::string hint) const {
        throw SceneError({file_, 0, 0}, std::move(key), std::move(problem), std::move(why), std::move(hint));
    }

    void parse(std::string_view text) {
        const std::string clean = without_python_numbers(text);
        std::size_t end = 0;
        std::string why = "not JSON";
        try {
            top_ = Json::parse(clean);
            return;
        } catch (const Json::parse_error& error) {
            end = std::min(error.byte, clean.size());
        } catch (const Json::exception&) {
            why = "a number in it is too large";
        }
        // Monte Carlo inputs: a document a line.
        const std::size_t feed = std::min(clean.find('\n'), clean.size());
        top_ = Json::parse(clean.substr(0, feed), nullptr, false);
        const bool more = clean.find_first_not_of(" \r\n", feed) != std::string::npos;
        if (!top_.is_object() || !more) {
            const auto line =
                std::count(clean.begin(), clean.begin() + static_cast<std::ptrdiff_t>(end), '\n');
            throw SceneError({file_, static_cast<int>(line) + 1, 0}, "", "is no file of RocketPy", why,
                             "name a flight that RocketPy saved (.rpy), or parachutes as JSON");
        }
        scene_.taken = "First line of the file";
        scene_.left_out.push_back("all lines after the first, each another run");
    }

    static const Json* at(const Json& object, const char* key) {
        if (!object.is_object()) return nullptr;
        const auto found = object.find(key);
        return found == object.end() ? nullptr : &*found;
    }

    void locate() {
        const Json* flight = at(top_, "simulation");
        flight_ = flight ? flight : &top_;
        const Json* rocket = at(*flight_, "rocket");
        rocket_ = rocket ? rocket : flight_;
        if (at(*rocket_, "cd_s") || top_.is_array()) {
            alone_ = top_.is_array() ? top_ : Json::array({*rocket_});
            parachutes_ = &alone_;
        } else {
            parachutes_ = at(*rocket_, "parachutes");
        }
        if (!parachutes_ || !parachutes_->is_array() || parachutes_->empty())
            refuse("", "has no parachutes of RocketPy", "no 'parachutes' and no 'cd_s' in it",
                   "name a flight that RocketPy saved (.rpy), or parachutes as JSON");
        if (parachutes_->size() > 100) refuse("parachutes", "has more than 100", "", "keep those that open");
    }

    double number(const Json& object, const char* key, const std::string& path, double low, double high,
                  std::optional<double> absent = {}) const {
        const Json* value = at(object, key);
        if (!value && absent) return *absent;
        const std::string full = path.empty() ? key : fmt::format("{}.{}", path, key);
        if (!value) refuse(full, "is missing", "", "save the flight again with RocketPy");
        if (!value->is_number() || !(value->get<double>() >= low && value->get<double>() <= high))
            refuse(full, fmt::format("'{}' is not taken", one_line(value->dump().substr(0, 40))),
                   fmt::format("a number from {:g} to {:g} is wanted", low, high), "correct it");
        return value->get<double>();
    }

    void read_parachute(const Json& json, const std::string& path) {
        if (!json.is_object())
            refuse(path, "is no parachute", "its parameters are a dictionary", "correct it");
        Chute chute{};
        const Json* name = at(json, "name");
        chute.foreign = name && name->is_string() ? one_line(name->get<std::string>()) : "parachute";
        chute.drag_area = number(json, "cd_s", path, 1e-6, 1e5);
        chute.lag = number(json, "lag", path, 0.0, 36000.0, 0.0);
        const Json* trigger = at(json, "trigger");
        if (!trigger)
            refuse(path + ".trigger", "is missing", "", "\"apogee\", or a height above ground in metres");
        if (trigger->is_number()) {
            chute.when = Chute::When::height;
            chute.height = number(json, "trigger", path, 0.0, 86000.0);
        } else if (trigger->is_string() && lowered(trigger->get<std::string>()) == "apogee") {
            chute.when = Chute::When::apogee;
        } else if (trigger->is_string()) {
            chute.when = Chute::When::code;
        } else {
            refuse(path + ".trigger", "is not understood", "\"apogee\", a height or a function is RocketPy's",
                   "correct it");
        }
        for (const char* key : {"radius", "height", "porosity", "drag_coefficient"})
            if (at(json, key)) has_shape_ = true;
        chutes_.push_back(std::move(chute));
    }

    static std::string lowered(std::string text) {
        std::ranges::transform(text, text.begin(), [](char c) {
            return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        });
        return text;
    }

    void choose() {
        std::vector<std::string_view> names;
        for (const Chute& chute : chutes_)
            names.push_back(chute.foreign);
        for (const std::string& wanted : choice_.devices)
            if (std::ranges::count(names, wanted) == 0)
                refuse("", fmt::format("has no parachute '{}'", one_line(wanted)), "",
                       suggest(wanted, names));
        if (choice_.devices.empty()) return;
        std::vector<Chute> kept;
        for (Chute& chute : chutes_) {
            if (std::ranges::count(choice_.devices, chute.foreign) != 0)
                kept.push_back(std::move(chute));
            else
                scene_.left_out.push_back(
                    fmt::format("parachute '{}': --device names another", chute.foreign));
        }
        chutes_ = std::move(kept);
    }

    // --- the stored flight ---------------------------------------------------------------------------

    /// [t, x, y, z, vx, vy, vz]; linear between the rows.
    using Row = std::array<double, 7>;

    void read_rows() {
        const Json* solution = at(*flight_, "solution");
        if (!solution || !solution->is_array()) return;
        for (const Json& json : *solution) {
            Row row{};
            bool right = json.is_array() && json.size() >= row.size();
            for (std::size_t i = 0; right && i < row.size(); ++i) {
                right = json[i].is_number();
                if (right) row[i] = json[i].get<double>();
            }
            if (!right)
                refuse(fmt::format("solution[{}]", rows_.size()), "is no state of a flight",
                       "t, x, y, z, vx, vy, vz and more are wanted", "save the flight again with RocketPy");
            if (rows_.empty() || row[0] >= rows_.back()[0]) rows_.push_back(row);
        }
    }

    Row state_at(double time) const {
        const auto after = std::ranges::lower_bound(rows_, time, {}, [](const Row& row) { return row[0]; });
        if (after == rows_.begin()) return rows_.front();
        if (after == rows_.end()) return rows_.back();
        const Row& a = *(after - 1);
        const Row& b = *after;
        const double share = b[0] > a[0] ? (time - a[0]) / (b[0] - a[0]) : 1.0;
        Row mixed{};
        for (std::size_t i = 0; i < mixed.size(); ++i)
            mixed[i] = a[i] + share * (b[i] - a[i]);
        return mixed;
    }

    void find_release() {
        const Json* env = at(*flight_, "env");
        environment_ = env ? env : flight_;
        ground_ = number(*environment_, "elevation", "", -1000, 80000, 0.0);
        read_rows();
        if (!rows_.empty())
            apogee_ =
                number(*flight_, "apogee_time", "", 0, 1e6,
                       (*std::ranges::max_element(rows_, {}, [](const Row& row) { return row[3]; }))[0]);
        if (const Json* events = at(*flight_, "parachute_events");
            events && events->is_array() && !rows_.empty())
            for (const Json& event : *events)
                if (event.is_array() && event.size() == 2 && event[0].is_number()) take_event(event);
        for (Chute& chute : chutes_)
            if (chute.when == Chute::When::code) chute.note = "RocketPy keeps its trigger as code";
        release_ = apogee_;
        std::optional<double> first;
        for (const Chute& chute : chutes_)
            if (chute.opened && (!first || *chute.opened < *first)) first = chute.opened;
        if (!first || rows_.empty()) return;
        if (*first < apogee_ || *first > apogee_ + short_lag) {
            release_ = *first;
            scene_.assumptions.push_back(
                fmt::format("the scene begins where the first parachute opens, {:.3g} s {} apogee: this "
                            "model knows no drag of the rocket",
                            std::abs(*first - apogee_), *first < apogee_ ? "before" : "after"));
        }
    }

    /// A trigger that is code is known by what it did.
    void take_event(const Json& event) {
        const double time = event[0].get<double>();
        const Json* name = at(event[1], "name");
        if (!name || !name->is_string()) return;
        for (Chute& chute : chutes_) {
            if (chute.opened || chute.foreign != one_line(name->get<std::string>())) continue;
            chute.opened = time + chute.lag;
            if (chute.when != Chute::When::code) continue;
            if (std::abs(time - apogee_) < 0.2) {
                chute.when = Chute::When::apogee;
            } else {
                chute.when = Chute::When::height;
                chute.height = state_at(time)[3] - ground_;
            }
            scene_.assumptions.push_back(fmt::format(
                "'{}' triggers {}, as it did in the stored flight: RocketPy keeps its trigger as code",
                chute.foreign,
                chute.when == Chute::When::apogee ? std::string("at apogee")
                                                  : fmt::format("{:.4g} m above ground", chute.height)));
        }
    }

    // --- the scene -----------------------------------------------------------------------------------

    void write_top() {
        ImportedTable& top = scene_.table("", "");
        top.add("schema", "1");
        const Json* name = at(*flight_, "name");
        top.add("name",
                toml_string(name && name->is_string() ? name->get<std::string>() : "RocketPy parachutes"));
    }

    /// Value of one of RocketPy's functions of altitude: a number, or linear in a table; nothing for code.
    std::optional<double> function_at(const char* key, double altitude) const {
        const Json* function = at(*environment_, key);
        const Json* source = function && function->is_object() ? at(*function, "source") : function;
        if (!source) return {};
        if (source->is_number()) return source->get<double>();
        if (!source->is_array() || source->empty()) return {};
        std::optional<std::pair<double, double>> before;
        for (const Json& point : *source) {
            if (!point.is_array() || point.size() != 2 || !point[0].is_number() || !point[1].is_number())
                return {};
            const std::pair<double, double> here{point[0].get<double>(), point[1].get<double>()};
            if (here.first >= altitude) {
                if (!before || here.first == before->first) return here.second;
                const double share = (altitude - before->first) / (here.first - before->first);
                return before->second + share * (here.second - before->second);
            }
            before = here;
        }
        return before->second;
    }

    void write_environment() {
        ImportedTable& table = scene_.table("environment", "[environment]");
        const Json* type = at(*environment_, "atmospheric_model_type");
        const std::string model = type && type->is_string() ? lowered(type->get<std::string>()) : "";
        const auto pressure = function_at("pressure", ground_),
                   temperature = function_at("temperature", ground_);
        if (model.empty()) {
            table.add("atmosphere", "\"us76\"", "assumed: the file names no atmosphere");
        } else if (model == "standard_atmosphere") {
            table.add("atmosphere", "\"us76\"", "RocketPy's standard atmosphere");
        } else if (pressure && temperature && *pressure > 1000.0 && *temperature > 100.0) {
            add_ground_air(scene_, table, ground_, *temperature, *pressure);
        } else {
            table.add("atmosphere", "\"us76\"", "assumed");
            scene_.left_out.push_back(
                fmt::format("the atmosphere '{}', of which the file keeps code alone", one_line(model)));
        }
        table.add("ground", ground_, "m", at(*environment_, "elevation") ? "elevation" : "assumed");
        if (const auto g = function_at("gravity", ground_); g && *g > 9.0 && *g < 10.0)
            table.add("gravity", *g, "m/s^2", "at the elevation");
        write_wind(table);
    }

    void write_wind(ImportedTable& table) {
        if (!at(*environment_, "wind_velocity_x") && !at(*environment_, "wind_velocity_y")) return;
        std::vector<double> altitudes;
        for (const char* key : {"wind_velocity_x", "wind_velocity_y"}) {
            const Json* function = at(*environment_, key);
            const Json* source = function && function->is_object() ? at(*function, "source") : function;
            if (source && source->is_array())
                for (const Json& point : *source)
                    if (point.is_array() && point.size() == 2 && point[0].is_number())
                        altitudes.push_back(point[0].get<double>());
        }
        if (altitudes.empty()) altitudes.push_back(ground_);
        std::ranges::sort(altitudes);
        bool blows = false;
        for (const double altitude : altitudes) {
            const auto x = function_at("wind_velocity_x", altitude),
                       y = function_at("wind_velocity_y", altitude);
            if (!x || !y) {
                scene_.left_out.push_back("the wind, of which the file keeps code alone: the air is at rest");
                scene_.wind.clear();
                return;
            }
            blows = blows || *x != 0.0 || *y != 0.0;
            scene_.wind.push_back({altitude, std::hypot(*x, *y), std::atan2(-*x, -*y)});
        }
        order_levels(scene_.wind);
        if (!blows) scene_.wind.clear();
        if (scene_.wind.size() == 1)
            add_uniform_wind(scene_, table, scene_.wind.front().speed, scene_.wind.front().from);
    }

    static double nominal_area(const Chute& chute) { return chute.drag_area / assumed_drag_coefficient; }
    static double mass_of(const Chute& chute) { return assumed_areal_mass * nominal_area(chute); }

    void write_payload_and_release() {
        ImportedTable& payload = scene_.table("payload", "[payload]");
        double parachutes = 0.0;
        for (const Chute& chute : chutes_)
            parachutes += mass_of(chute);
        if (!at(*rocket_, "mass")) {
            payload.add(
                "mass", "",
                fmt::format("the file keeps parachutes alone, not the mass of the rocket: its dry mass "
                            "less the {:.4g} kg that the parachutes are assumed to weigh",
                            parachutes));
        } else {
            const double dry = number(*rocket_, "mass", "rocket", 1e-6, 1e6);
            const Json* motor = at(*rocket_, "motor");
            const Json* motors = at(*flight_, "motors");
            if (!motor && motors && motors->is_array() && motors->size() == 1) motor = &motors->front();
            const bool weighed = motor && at(*motor, "dry_mass");
            const double whole = dry + (weighed ? number(*motor, "dry_mass", "motor", 0.0, 1e6) : 0.0);
            if (!weighed)
                scene_.assumptions.push_back(
                    "the empty motor weighs nothing: the file does not say what it weighs");
            if (whole > 2.0 * parachutes)
                payload.add("mass", whole - parachutes, "kg",
                            fmt::format("rocket{}, {:.5g} kg, less the parachutes below",
                                        weighed ? " and empty motor" : "", whole));
            else
                payload.add("mass", "",
                            "the rocket of the file weighs less than twice the parachutes assumed here");
        }
        ImportedTable& release = scene_.table("release", "[release]");
        if (!rows_.empty()) {
            const Row at_release = state_at(release_);
            release.add("altitude", at_release[3], "m", "stored flight");
            const double east = at_release[4], north = at_release[5];
            add_velocity(release, std::hypot(east, north), at_release[6],
                         east == 0.0 && north == 0.0 ? std::nullopt : std::optional(std::atan2(east, north)));
            return;
        }
        release.add("height", "", "height of apogee above ground; the file keeps no flight");
        release.add("speed", "\"0 m/s\"", "assumed: apogee without horizontal speed");
        scene_.assumptions.push_back(
            "the rocket is at rest at apogee: the file keeps no flight with its horizontal speed");
        if (std::ranges::all_of(chutes_, [](const Chute& one) { return one.when == Chute::When::height; }))
            scene_.table("payload", "[payload]")
                .add("drag_area", "",
                     "C_D S of the falling rocket: no parachute opens at apogee, and the file keeps no "
                     "flight that says "
                     "how fast it falls until then");
    }

    void write_parachute(std::size_t i) {
        const Chute& chute = chutes_[i];
        const std::string name = name_of(i);
        ImportedTable table{"[[parachute]]", chutes_.size() == 1 ? "parachute" : "parachute." + name, {}};
        table.notes.push_back(fmt::format("parachute '{}'", chute.foreign));
        table.add("name", toml_string(name));
        table.add("drag_area", chute.drag_area, "m^2", "cd_s");
        table.add("nominal_diameter", std::sqrt(4.0 * nominal_area(chute) / pi), "m",
                  "assumed: of a flat circular canopy with C_D0 = 0.75; it sets the filling time");
        table.add("mass", mass_of(chute), "kg",
                  at(*rocket_, "mass") ? "assumed: 60 g per m2 of nominal area, taken off the rocket"
                                       : "assumed: 60 g per m2 of nominal area, beside payload.mass");
        const std::string lag =
            chute.lag > 0.0 ? fmt::format(", delay = {}", toml_quantity(chute.lag, "s")) : "";
        const std::string comment = chute.lag > 0.0 ? "trigger and lag" : "trigger";
        const bool before = chute.opened && !rows_.empty() && std::abs(*chute.opened - release_) < 1e-9;
        SmallOpening opening{"", comment, std::sqrt(4.0 * nominal_area(chute) / pi), {}};
        // Met before the scene begins; the lag has begun, too.
        const bool was_met = !before && chute.opened && !rows_.empty() && *chute.opened > release_ &&
                             *chute.opened - chute.lag < release_ - 1e-9;
        if (before || was_met) opening.comment += " of the stored flight";
        if (was_met)
            opening.when = fmt::format("{{ time = {} }}", toml_quantity(*chute.opened - release_, "s"));
        else if (before)
            opening.when = "";
        else if (chute.when == Chute::When::apogee)
            opening.when = fmt::format("{{ at = \"apogee\"{} }}", lag);
        else if (chute.when == Chute::When::height)
            opening.when = fmt::format("{{ height = {}{} }}", toml_quantity(chute.height, "m"), lag);
        else
            opening.when = "-";
        if (before || was_met || (chute.when == Chute::When::apogee && release_ == apogee_))
            opening.airspeed = airspeed_at(before ? 0.0 : was_met ? *chute.opened - release_ : chute.lag);
        add_opening(scene_, table, opening);
        if (opening.when == "-") {
            ImportedKey& missing = *std::ranges::find(table.keys, "deploy.when", &ImportedKey::key);
            missing.value.clear();
            missing.comment = chute.note + R"(; e.g. '{ height = "300 m" }')";
        }
        if (const auto next = next_after(i))
            table.add("cut", fmt::format("{{ after = \"{}.line-stretch\" }}", name_of(*next)),
                      "RocketPy flies on with the newest parachute alone");
        scene_.tables.push_back(std::move(table));
    }

    /// [m/s] through the air, `delay` [s] after the scene begins.
    double airspeed_at(double delay) const {
        if (rows_.empty()) return airspeed_after(scene_, 0.0, 0.0, {}, delay);
        const Row at_release = state_at(release_);
        return airspeed_after(scene_, std::hypot(at_release[4], at_release[5]), at_release[6],
                              std::atan2(at_release[4], at_release[5]), delay);
    }

    std::string name_of(std::size_t i) {
        std::vector<std::string> taken;
        for (Chute& chute : chutes_) {
            if (chute.name.empty()) chute.name = parachute_name(chute.foreign, taken);
            taken.push_back(chute.name);
        }
        return chutes_[i].name;
    }

    /// Order in which the parachutes open, as far as the file tells.
    double order_of(std::size_t i) const {
        const Chute& chute = chutes_[i];
        if (chute.opened) return *chute.opened;
        return chute.when == Chute::When::apogee ? 1e6 + chute.lag : 1e7 - chute.height;
    }

    bool order_is_known() const {
        return std::ranges::none_of(chutes_, [](const Chute& one) { return one.when == Chute::When::code; });
    }

    std::optional<std::size_t> next_after(std::size_t i) const {
        std::optional<std::size_t> next;
        if (!order_is_known()) return next;
        for (std::size_t k = 0; k < chutes_.size(); ++k) {
            const bool later = order_of(k) > order_of(i) || (order_of(k) == order_of(i) && k > i);
            if (later && (!next || order_of(k) < order_of(*next))) next = k;
        }
        return next;
    }

    void say_rest() {
        auto& out = scene_.left_out;
        out.push_back("sampling rate and noise of the triggers: conditions are met exactly here");
        out.push_back("drag of the rocket between a trigger and the end of its lag");
        out.push_back(
            has_shape_
                ? "radius, height, porosity: RocketPy takes them for its added mass; this scene has none"
                : "RocketPy's added mass, from its own radius: this scene has none");
        if (const Json* latitude = at(*environment_, "latitude"); latitude && latitude->is_number())
            out.push_back(fmt::format(
                "geographic position of the launch site (latitude {}, longitude {}): a scene has none",
                latitude->get<double>(), function_at("longitude", 0.0).value_or(0.0)));
        if (rows_.empty() || !choice_.devices.empty() || rows_.back()[3] > ground_ + 1.0) return;
        const Row& last = rows_.back();
        scene_.stated_landing_speed = -last[6];
        scene_.stated_by = "last state of the stored flight";
    }

    const std::string& file_;
    const ImportChoice& choice_;
    Json top_, alone_;
    const Json *flight_ = nullptr, *rocket_ = nullptr, *parachutes_ = nullptr, *environment_ = nullptr;
    std::vector<Chute> chutes_;
    std::vector<Row> rows_;
    bool has_shape_ = false;
    double ground_ = 0.0;                  ///< [m] above sea level
    double apogee_ = 0.0, release_ = 0.0;  ///< [s] in the stored flight
    ImportedScene scene_;
};

}  // namespace

ImportedScene read_rocketpy(std::string_view json, const std::string& file, const ImportChoice& choice) {
    return RocketPyReader(json, file, choice).read();
}

}  // namespace twinchute::exchange
