// OpenRocket designs. Sources of what elements mean: file_specification.rst and fileformat.txt of OpenRocket,
// and how OpenRocket itself reads and flies them: descent under all devices that are out, without drag of the
// body.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <pugixml.hpp>

#include "lib/exchange/fall.hpp"
#include "lib/exchange/read_design.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::exchange {
namespace {

constexpr int deepest_component = 64;
/// [s] after apogee: an opening until then may begin at apogee without drag of the body, a later one begins
/// with the stored state.
constexpr double short_fall = 1.0;

struct Stage {
    std::string name;
    pugi::xml_node node;
};

struct Device {
    pugi::xml_node node;
    std::string name, id;
    bool streamer = false;
    std::size_t stage = 0;
    int count = 1;  ///< of instances: pods, boosters, clusters of tubes
};

/// A row of results, for the columns that are used; NaN where a file has none.
struct State {
    double time, altitude, climb, lateral, speed, mass, gravity, east, north;
};

struct Branch {
    pugi::xml_node node;
    std::vector<State> rows;

    /// [s] of the first event of a type, and of a source where one is given.
    std::optional<double> event(std::string_view type, std::string_view source = {}) const {
        for (const pugi::xml_node event : node.children("event"))
            if (event.attribute("type").value() == type &&
                (source.empty() || event.attribute("source").value() == source))
                return event.attribute("time").as_double();
        return {};
    }
    /// Whether its events say which device they are of.
    bool names_sources() const {
        return std::ranges::any_of(node.children("event"), [](pugi::xml_node event) {
            return event.attribute("type").value() == std::string_view("recoverydevicedeployment") &&
                   event.attribute("source");
        });
    }
};

class OpenRocketReader {
public:
    OpenRocketReader(std::string_view xml, const std::string& file, const ImportChoice& choice)
        : text_(xml), file_(file), choice_(choice) {
        const pugi::xml_parse_result parsed = document_.load_buffer(xml.data(), xml.size());
        if (!parsed)
            throw SceneError(place(parsed.offset), "", "is no OpenRocket design",
                             fmt::format("not XML: {}", parsed.description()),
                             "name a design that OpenRocket saved (.ork)");
        root_ = document_.child("openrocket");
        if (!root_ || !root_.child("rocket"))
            throw SceneError({file_, 1, 1}, "", "is no OpenRocket design",
                             fmt::format("its XML is a <{}> without <rocket>",
                                         one_line(document_.document_element().name())),
                             "name a design that OpenRocket saved (.ork)");
    }

    ImportedScene read() {
        const std::string_view creator = root_.attribute("creator").value();
        scene_.program = fmt::format("{}, file format {}", creator.empty() ? "OpenRocket" : creator,
                                     root_.attribute("version").value());
        walk(root_.child("rocket").child("subcomponents"), 0, 1, 0);
        if (devices_.empty())
            throw SceneError({file_, 0, 0}, "", "has no recovery device",
                             "neither a parachute nor a streamer is in it", "add one in OpenRocket");
        check_names();
        choose_simulation();
        choose_devices();
        find_release();
        write_top();
        add_common_assumptions(scene_, "OpenRocket");
        write_environment();
        write_payload_and_release();
        for (const Device* device : taken_)
            write_device(*device);
        scene_.table("stop", "[stop]").add("at", "\"ground\"");
        say_rest();
        return std::move(scene_);
    }

private:
    // --- places and values ---------------------------------------------------------------------------

    SourcePlace place(std::ptrdiff_t offset) const {
        const std::string_view before =
            text_.substr(0, static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
        const auto line = std::ranges::count(before, '\n');
        const std::size_t start = before.rfind('\n');
        const std::size_t column = before.size() - (start == std::string_view::npos ? 0 : start + 1);
        return {file_, static_cast<int>(line) + 1, static_cast<int>(column) + 1};
    }

    [[noreturn]] void refuse(pugi::xml_node node, std::string problem, std::string why,
                             std::string hint) const {
        throw SceneError(place(node.offset_debug()), node.name(), std::move(problem), std::move(why),
                         std::move(hint));
    }

    /// Number in a text; nothing where it is none.
    static std::optional<double> as_number(std::string_view text) {
        while (text.starts_with(' ') || text.starts_with('\n'))
            text.remove_prefix(1);
        while (text.ends_with(' ') || text.ends_with('\n'))
            text.remove_suffix(1);
        double value = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return {};
        return value;
    }

    /// Value of a child element; nothing where there is none.
    std::optional<double> number(pugi::xml_node parent, const char* child, double low, double high) const {
        const pugi::xml_node node = parent.child(child);
        if (!node) return {};
        const auto value = as_number(node.child_value());
        if (!value || !(*value >= low && *value <= high))
            refuse(node, fmt::format("'{}' is not taken", one_line(node.child_value())),
                   fmt::format("a number from {:g} to {:g} is wanted", low, high),
                   "correct the design in OpenRocket");
        return value;
    }

    double required(pugi::xml_node parent, const char* child, double low, double high) const {
        const auto value = number(parent, child, low, high);
        if (!value)
            refuse(parent, fmt::format("<{}> is missing", child), "", "save the design again in OpenRocket");
        return *value;
    }

    static std::string name_of(pugi::xml_node node) { return one_line(node.child_value("name")); }

    // --- components ----------------------------------------------------------------------------------

    /// Number of tubes in a cluster, from its name: "single", "double", "3-ring".
    static int tubes_of(pugi::xml_node tube) {
        const std::string_view name = tube.child_value("clusterconfiguration");
        if (name == "double") return 2;
        int count = 1;
        std::from_chars(name.data(), name.data() + name.size(), count);
        return std::clamp(count, 1, 100);
    }

    void walk(pugi::xml_node subcomponents, std::size_t stage, int count, int depth) {
        if (depth > deepest_component)
            refuse(subcomponents, "lies too deep",
                   fmt::format("{} components within each other are the most", deepest_component),
                   "flatten the design");
        for (const pugi::xml_node node : subcomponents.children()) {
            const std::string_view kind = node.name();
            std::size_t own = stage;
            int instances = count;
            if (kind == "stage" || kind == "parallelstage" || kind == "boosterset") {
                own = stages_.size();
                stages_.push_back({name_of(node), node});
            }
            if (kind == "parallelstage" || kind == "boosterset" || kind == "podset")
                instances = count * static_cast<int>(number(node, "instancecount", 1, 100).value_or(1));
            else if (kind == "innertube")
                instances = count * tubes_of(node);
            if (kind == "parachute" || kind == "streamer")
                devices_.push_back({node, name_of(node), node.child_value("id"), kind == "streamer", own,
                                    std::min(instances, 100)});
            else if (kind == "shockcord")
                cords_.push_back(
                    fmt::format("shock cord '{}': the reduced-order model has rigid lines", name_of(node)));
            walk(node.child("subcomponents"), own, instances, depth + 1);
        }
    }

    void check_names() const {
        for (const std::string& wanted : choice_.devices) {
            if (std::ranges::find(devices_, wanted, &Device::name) != devices_.end()) continue;
            std::vector<std::string_view> names;
            for (const Device& device : devices_)
                names.push_back(device.name);
            throw SceneError({file_, 0, 0}, "", fmt::format("has no recovery device '{}'", one_line(wanted)),
                             "", suggest(wanted, names));
        }
    }

    bool is_wanted(const Device& device) const {
        return choice_.devices.empty() || std::ranges::count(choice_.devices, device.name) != 0;
    }

    /// Value of a stage's or device's setting in the chosen configuration, else its own.
    pugi::xml_node setting(pugi::xml_node node, const char* list, const char* child) const {
        for (const pugi::xml_node one : node.children(list))
            if (!config_.empty() && one.attribute("configid").value() == config_ && one.child(child))
                return one.child(child);
        return node.child(child);
    }

    /// Stages that fall together, by the first of them.
    std::size_t body_of(std::size_t stage) const {
        while (stage > 0 &&
               setting(stages_[stage].node, "separationconfiguration", "separationevent").child_value() ==
                   std::string_view("never"))
            --stage;
        return stage;
    }

    // --- simulation ----------------------------------------------------------------------------------

    void choose_simulation() {
        std::vector<std::string> names;
        for (const pugi::xml_node one : root_.child("simulations").children("simulation")) {
            const std::string name = name_of(one);
            if (!choice_.simulation.empty() && name != choice_.simulation) {
                names.push_back(name);
                continue;
            }
            if (simulation_ && (!choice_.simulation.empty() || branch_.node)) {
                others_.push_back(name);
                continue;
            }
            // One with a flight is better than one without.
            const pugi::xml_node flight = find_branch(one);
            const bool first = !simulation_;
            const bool summary = !summary_of(simulation_) && summary_of(one);
            if (first || flight || (summary && !branch_.node)) {
                if (simulation_) others_.push_back(name_of(simulation_));
                simulation_ = one;
                branch_.node = flight;
            } else {
                others_.push_back(name);
            }
        }
        if (!choice_.simulation.empty() && !simulation_)
            throw SceneError({file_, 0, 0}, "",
                             fmt::format("has no simulation '{}'", one_line(choice_.simulation)),
                             names.empty() ? "it has none at all" : "",
                             names.empty() ? "leave out --simulation"
                                           : suggest(choice_.simulation, {names.begin(), names.end()}));
        if (!choice_.simulation.empty()) others_ = names;
        config_ = simulation_.child("conditions").child_value("configid");
        if (branch_.node) read_rows();
    }

    static bool summary_of(pugi::xml_node simulation) {
        return static_cast<bool>(simulation.child("flightdata").attribute("maxaltitude"));
    }

    /// The first branch of a simulation in which a wanted device opens.
    pugi::xml_node find_branch(pugi::xml_node simulation) const {
        for (const pugi::xml_node one : simulation.child("flightdata").children("databranch")) {
            if (!one.child("datapoint")) continue;
            for (const pugi::xml_node event : one.children("event")) {
                if (event.attribute("type").value() != std::string_view("recoverydevicedeployment")) continue;
                const std::string_view source = event.attribute("source").value();
                if (choice_.devices.empty() || std::ranges::any_of(devices_, [&](const Device& device) {
                        return is_wanted(device) &&
                               (source.empty() ? stages_[device.stage].name == one.attribute("name").value()
                                               : source == device.id);
                    }))
                    return one;
            }
        }
        return {};
    }

    void read_rows() {
        const std::string_view types = branch_.node.attribute("types").value();
        std::vector<std::string_view> names;
        for (std::size_t begin = 0; begin <= types.size();) {
            const std::size_t comma = std::min(types.find(',', begin), types.size());
            names.push_back(types.substr(begin, comma - begin));
            begin = comma + 1;
        }
        const auto column = [&](std::string_view name) {
            return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
        };
        const std::array columns{column("Time"),
                                 column("Altitude"),
                                 column("Vertical velocity"),
                                 column("Lateral velocity"),
                                 column("Total velocity"),
                                 column("Mass"),
                                 column("Gravitational acceleration"),
                                 column("Position East of launch"),
                                 column("Position North of launch")};
        for (const pugi::xml_node point : branch_.node.children("datapoint")) {
            std::vector<double> values;
            std::string_view text = point.child_value();
            for (std::size_t begin = 0; begin <= text.size();) {
                const std::size_t comma = std::min(text.find(',', begin), text.size());
                values.push_back(as_number(text.substr(begin, comma - begin)).value_or(nan));
                begin = comma + 1;
            }
            if (values.size() != names.size())
                refuse(point,
                       fmt::format("{} values where {} columns are named", values.size(), names.size()), "",
                       "run the simulation again in OpenRocket and save it");
            const auto at = [&](std::size_t i) {
                return columns[i] < values.size() ? values[columns[i]] : nan;
            };
            const State row{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8)};
            if (std::isfinite(row.time) && (branch_.rows.empty() || row.time >= branch_.rows.back().time))
                branch_.rows.push_back(row);
        }
        const bool understood = !branch_.rows.empty() && std::isfinite(branch_.rows.back().altitude) &&
                                std::isfinite(branch_.rows.back().climb);
        if (understood) return;
        scene_.assumptions.push_back(
            "the stored flight has no columns 'Time', 'Altitude' and 'Vertical velocity' (another language "
            "than English?): "
            "only its summary counts");
        branch_ = {};
    }

    /// Linear between the rows.
    State state_at(double time) const {
        const std::vector<State>& rows = branch_.rows;
        const auto after = std::ranges::lower_bound(rows, time, {}, &State::time);
        if (after == rows.begin()) return rows.front();
        if (after == rows.end()) return rows.back();
        const State& a = *(after - 1);
        const State& b = *after;
        const double share = b.time > a.time ? (time - a.time) / (b.time - a.time) : 1.0;
        const auto mixed = [&](double State::*member) {
            return share >= 1.0 || !std::isfinite(a.*member)   ? b.*member
                   : share <= 0.0 || !std::isfinite(b.*member) ? a.*member
                                                               : a.*member + share * (b.*member - a.*member);
        };
        return {time,
                mixed(&State::altitude),
                mixed(&State::climb),
                mixed(&State::lateral),
                mixed(&State::speed),
                mixed(&State::mass),
                mixed(&State::gravity),
                mixed(&State::east),
                mixed(&State::north)};
    }

    // --- what falls ----------------------------------------------------------------------------------

    std::string event_of(const Device& device) const {
        const std::string_view event =
            setting(device.node, "deploymentconfiguration", "deployevent").child_value();
        return event.empty() ? "ejection" : std::string(event);  // OpenRocket's default
    }
    double delay_of(const Device& device) const {
        const pugi::xml_node node = setting(device.node, "deploymentconfiguration", "deploydelay");
        return node ? number(node.parent(), "deploydelay", 0, 36000).value_or(0.0) : 0.0;
    }
    double altitude_of(const Device& device) const {
        const pugi::xml_node node = setting(device.node, "deploymentconfiguration", "deployaltitude");
        return node ? number(node.parent(), "deployaltitude", 0, 86000).value_or(200.0) : 200.0;
    }

    void leave_out(const Device& device, std::string_view why) {
        scene_.left_out.push_back(
            fmt::format("{} '{}': {}", device.streamer ? "streamer" : "parachute", device.name, why));
    }

    void choose_devices() {
        const bool sources = branch_.node && branch_.names_sources();
        std::size_t body = body_of(devices_.front().stage);
        if (branch_.node && !sources) {
            const auto stage =
                std::ranges::find(stages_, branch_.node.attribute("name").value(), &Stage::name);
            if (stage != stages_.end()) body = body_of(static_cast<std::size_t>(stage - stages_.begin()));
        } else if (!choice_.devices.empty()) {
            body = body_of(std::ranges::find(devices_, choice_.devices.front(), &Device::name)->stage);
        }
        for (const Device& device : devices_) {
            const bool opens = sources ? branch_.event("recoverydevicedeployment", device.id).has_value()
                                       : body_of(device.stage) == body;
            if (event_of(device) == "never")
                leave_out(device, "it never deploys in this configuration");
            else if (!opens)
                leave_out(
                    device,
                    device.stage != stage_of_branch() || !sources
                        ? fmt::format("it is of the stage '{}', which falls by itself; --device '{}' takes "
                                      "that one",
                                      stages_.empty() ? "" : stages_[device.stage].name, device.name)
                        : std::string("it does not deploy in the stored simulation"));
            else if (!is_wanted(device))
                leave_out(device, "--device names another");
            else
                taken_.push_back(&device);
        }
        if (taken_.empty())
            throw SceneError({file_, 0, 0}, "", "has no recovery device that deploys",
                             scene_.left_out.empty() ? "" : scene_.left_out.front(),
                             "name one with --device, or another simulation with --simulation");
    }

    std::size_t stage_of_branch() const {
        const auto stage = std::ranges::find(stages_, branch_.node.attribute("name").value(), &Stage::name);
        return stage == stages_.end() ? 0 : static_cast<std::size_t>(stage - stages_.begin());
    }

    /// [s] in the stored flight at which a device leaves its pack; nothing where the file does not tell.
    std::optional<double> stored_deployment(const Device& device) const {
        if (branch_.rows.empty()) return {};
        if (branch_.names_sources()) return branch_.event("recoverydevicedeployment", device.id);
        if (taken_.size() == 1) return branch_.event("recoverydevicedeployment");
        const std::string event = event_of(device);
        const auto after = [&](std::optional<double> time) {
            return time ? std::optional(*time + delay_of(device)) : std::nullopt;
        };
        if (event == "launch") return delay_of(device);
        if (event == "apogee") return after(branch_.event("apogee"));
        if (event == "ejection") return after(branch_.event("ejectioncharge"));
        if (event == "lowerstageseparation") return after(branch_.event("stageseparation"));
        if (event != "altitude") return {};
        const double altitude = altitude_of(device);
        for (std::size_t i = 1; i < branch_.rows.size(); ++i)
            if (branch_.rows[i - 1].altitude >= altitude && branch_.rows[i].altitude <= altitude)
                return branch_.rows[i].time + delay_of(device);
        return {};
    }

    void find_release() {
        if (branch_.rows.empty()) return;
        const auto highest = std::ranges::max_element(branch_.rows, {}, &State::altitude);
        apogee_ = branch_.event("apogee").value_or(highest->time);
        std::optional<double> first;
        for (const Device* device : taken_)
            if (const auto time = stored_deployment(*device); time && (!first || *time < *first))
                first = time;
        release_ = *apogee_;
        if (!first) return;
        if (*first < *apogee_) {
            release_ = *first;
            scene_.assumptions.push_back(
                fmt::format("the scene begins where the first device deploys, {:.3g} s before apogee",
                            *apogee_ - *first));
        } else if (*first > *apogee_ + short_fall) {
            release_ = *first;
            scene_.assumptions.push_back(fmt::format(
                "the scene begins where the first device deploys, {:.3g} s after apogee: this model knows "
                "no drag of the rocket until then",
                *first - *apogee_));
        }
    }

    // --- the scene -----------------------------------------------------------------------------------

    void write_top() {
        ImportedTable& top = scene_.table("", "");
        top.add("schema", "1");
        const std::string name = name_of(root_.child("rocket"));
        top.add("name", toml_string(name.empty() ? "rocket" : name));
        if (simulation_) {
            scene_.taken = fmt::format("Simulation '{}'", name_of(simulation_));
            if (branch_.node)
                scene_.taken += fmt::format(", stage '{}'", one_line(branch_.node.attribute("name").value()));
            if (simulation_.attribute("status").value() == std::string_view("outdated"))
                scene_.assumptions.push_back(
                    "the stored results fit the design, although OpenRocket marks them as outdated");
        }
    }

    void write_environment() {
        const pugi::xml_node conditions = simulation_.child("conditions");
        ground_ = number(conditions, "launchaltitude", -1000, 80000).value_or(0.0);
        ImportedTable& table = scene_.table("environment", "[environment]");
        const pugi::xml_node air = conditions.child("atmosphere");
        if (air.attribute("model").value() == std::string_view("extendedisa"))
            add_ground_air(scene_, table, ground_, required(air, "basetemperature", 100, 400),
                           required(air, "basepressure", 1000, 200000));
        else
            table.add("atmosphere", "\"us76\"",
                      conditions ? "OpenRocket's ISA" : "assumed: no simulation is stored");
        table.add("ground", ground_, "m", conditions.child("launchaltitude") ? "launch altitude" : "assumed");
        if (!branch_.rows.empty())
            if (const double g = state_at(release_).gravity; std::isfinite(g) && g > 9.0 && g < 10.0)
                table.add("gravity", g, "m/s^2", "of the stored flight, at the start of this scene");
        write_wind(conditions, table);
    }

    void write_wind(pugi::xml_node conditions, ImportedTable& table) {
        const std::string_view model = conditions.child_value("windmodeltype");
        pugi::xml_node average, levels;
        for (const pugi::xml_node wind : conditions.children("wind"))
            (wind.attribute("model").value() == std::string_view("multilevel") ? levels : average) = wind;
        const auto is_multilevel = [](std::string_view word) {
            return word.starts_with('M') || word.starts_with('m');
        };
        if (levels && (is_multilevel(model) || (model.empty() && !average))) {
            const bool above_ground = levels.attribute("altituderef").value() == std::string_view("agl");
            for (const pugi::xml_node level : levels.children("windlevel"))
                scene_.wind.push_back(
                    {level.attribute("altitude").as_double() + (above_ground ? ground_ : 0.0),
                     level.attribute("speed").as_double(), level.attribute("direction").as_double()});
            order_levels(scene_.wind);
            if (scene_.wind.size() == 1)
                add_uniform_wind(scene_, table, scene_.wind.front().speed, scene_.wind.front().from);
        } else {
            const auto speed =
                average ? number(average, "speed", 0, 200) : number(conditions, "windaverage", 0, 200);
            const auto from =
                average ? number(average, "direction", -7, 7) : number(conditions, "winddirection", -7, 7);
            if (!speed || *speed == 0.0) return;
            if (!from)
                scene_.assumptions.push_back(
                    "the wind comes from the east: this file format has no direction");
            add_uniform_wind(scene_, table, *speed, from.value_or(0.5 * pi));
        }
        scene_.left_out.push_back("turbulence of the wind: the air moves evenly here");
    }

    double mass_of(const Device& device) const {
        if (const auto given = number(device.node, "overridemass", 0, 1e4); given && *given > 0.0)
            return *given;
        const auto density = [&](const char* child) {
            return as_number(device.node.child(child).attribute("density").value()).value_or(0.0);
        };
        if (device.streamer) return area_of(device) * density("material");
        return area_of(device) * density("material") +
               number(device.node, "linecount", 0, 1000).value_or(0.0) *
                   number(device.node, "linelength", 0, 1000).value_or(0.0) * density("linematerial");
    }

    double area_of(const Device& device) const {
        if (device.streamer)
            return required(device.node, "striplength", 1e-6, 1000) *
                   required(device.node, "stripwidth", 1e-6, 1000);
        const double diameter = required(device.node, "diameter", 1e-3, 200);
        return 0.25 * pi * diameter * diameter;
    }

    double drag_coefficient_of(const Device& device) const {
        const std::string_view text = device.node.child_value("cd");
        if (!text.empty() && !text.starts_with("auto")) return required(device.node, "cd", 1e-6, 5);
        if (!device.streamer) return 0.8;
        const double density =
            as_number(device.node.child("material").attribute("density").value()).value_or(0.0);
        const double length = required(device.node, "striplength", 1e-6, 1000);
        return std::min(0.034 * (density + 0.025) / 0.105 * (length + 1.0) / length, 0.4);
    }

    void write_payload_and_release() {
        ImportedTable& payload = scene_.table("payload", "[payload]");
        double devices = 0.0;
        for (const Device* device : taken_)
            devices += device->count * std::max(mass_of(*device), least_mass);
        const auto add_mass = [&](double whole, std::string_view of) {
            if (std::isfinite(whole) && whole > devices)
                payload.add("mass", whole - devices, "kg",
                            fmt::format("{}, {:.4g} kg, less the recovery devices below", of, whole));
            else
                payload.add("mass", "",
                            "the file has no mass that is larger than that of its recovery devices");
        };
        const pugi::xml_node stage =
            stages_.empty() ? pugi::xml_node() : stages_[body_of(taken_.front()->stage)].node;
        const bool whole_stage = stage.child_value("overridesubcomponentsmass") == std::string_view("true") ||
                                 stage.child_value("overridesubcomponents") == std::string_view("true");
        if (!branch_.rows.empty() && std::isfinite(branch_.rows.back().mass)) {
            add_mass(branch_.rows.back().mass, "all that falls at the end of the stored flight");
        } else if (const auto mass = whole_stage ? number(stage, "overridemass", 0, 1e6) : std::nullopt) {
            add_mass(*mass, "mass override of the stage");
            scene_.assumptions.push_back(
                "the burnt-out motor weighs nothing: the file does not say what it weighs");
        } else {
            payload.add("mass", "",
                        "mass under the parachutes without propellant; the file keeps no flight and no mass "
                        "of the whole stage");
        }
        write_release();
    }

    void write_release() {
        ImportedTable& table = scene_.table("release", "[release]");
        if (!branch_.rows.empty()) {
            const State at = state_at(release_);
            if (at.altitude <= 0.0)
                table.add("height", "", "the stored flight is at or below the ground there");
            else
                table.add("height", at.altitude, "m", "above the launch site, stored flight");
            const double lateral = std::isfinite(at.lateral) ? std::abs(at.lateral) : 0.0;
            add_velocity(table, lateral, at.climb, heading_at(release_));
            return;
        }
        const pugi::xml_node flight = simulation_.child("flightdata");
        const auto highest = as_number(flight.attribute("maxaltitude").value());
        if (highest && *highest > 0.0)
            table.add("height", *highest, "m", "highest point of the stored flight");
        else
            table.add("height", "", "height of apogee above the launch site; the file keeps no flight");
        table.add("speed", "\"0 m/s\"", "assumed: apogee without horizontal speed");
        scene_.assumptions.push_back(
            "the rocket is at rest at apogee: the file keeps no flight with its horizontal speed");
        // Without drag of the body a long fall before the first device would be far too fast.
        if (std::ranges::all_of(taken_, [&](const Device* one) { return event_of(*one) == "altitude"; }))
            scene_.table("payload", "[payload]")
                .add("drag_area", "",
                     "C_D S of the falling rocket: no device opens at apogee, and the file keeps no flight "
                     "that says how "
                     "fast it falls until then");
    }

    /// [rad] of the horizontal velocity, from north; nothing where the rows do not tell.
    std::optional<double> heading_at(double time) const {
        const auto after = std::ranges::upper_bound(branch_.rows, time, {}, &State::time);
        if (after == branch_.rows.begin() || after == branch_.rows.end()) return {};
        const State& a = *(after - 1);
        const double east = after->east - a.east, north = after->north - a.north;
        if (!std::isfinite(east + north) || std::hypot(east, north) == 0.0) return {};
        return std::atan2(east, north);
    }

    /// Trigger of a device as an inline table with a comment; empty: at release.
    struct When {
        std::string toml, comment;
    };

    When when_of(const Device& device) const {
        const std::string event = event_of(device);
        const double delay = delay_of(device);
        const auto delayed = [](std::string condition, double by) {
            return by == 0.0 ? fmt::format("{{ {} }}", condition)
                             : fmt::format("{{ {}, delay = {} }}", condition, toml_quantity(by, "s"));
        };
        if (event == "altitude")
            return {delayed(fmt::format("height = {}", toml_quantity(altitude_of(device), "m")), delay),
                    "deploy altitude, above the launch site"};
        const auto stored = stored_deployment(device);
        if (!stored) {
            if (event == "apogee") return {delayed("at = \"apogee\"", delay), ""};
            if (event == "ejection")
                return {delayed("at = \"apogee\"", delay),
                        "ejection charge, assumed at apogee: its time is that of a motor's delay"};
            const auto to_apogee =
                as_number(simulation_.child("flightdata").attribute("timetoapogee").value());
            if (event == "launch" && to_apogee && delay >= *to_apogee)
                return {delayed("time = \"0 s\"", delay - *to_apogee),
                        "launch and delay, less the time to apogee"};
            refuse(setting(device.node, "deploymentconfiguration", "deployevent"),
                   fmt::format("'{}' has no time here", one_line(event)), "the file keeps no flight",
                   "run the simulation in OpenRocket and save it with its data");
        }
        const double since = *stored - release_;
        const std::string comment =
            fmt::format("{}{}", event, delay > 0.0 ? fmt::format(" + {:g} s", delay) : "");
        if (event == "apogee" && release_ <= *apogee_) return {delayed("at = \"apogee\"", delay), ""};
        if (since <= 1e-6) return {"", comment};
        return {fmt::format("{{ time = {} }}", toml_quantity(since, "s")),
                fmt::format("{}, by the stored flight {:.3g} s {} apogee", comment,
                            std::abs(*stored - *apogee_), *stored < *apogee_ ? "before" : "after")};
    }

    /// [m/s] through the air where a device opens soon after the scene begins.
    std::optional<double> airspeed_at(const Device& device, const When& when) const {
        if (branch_.rows.empty()) {
            if (event_of(device) != "apogee" && event_of(device) != "ejection") return {};
            return airspeed_after(scene_, 0.0, 0.0, {}, delay_of(device));
        }
        const double since =
            when.toml.empty() ? 0.0 : stored_deployment(device).value_or(infinity) - release_;
        if (since > short_fall) return {};
        const State at = state_at(release_);
        return airspeed_after(scene_, std::isfinite(at.lateral) ? std::abs(at.lateral) : 0.0, at.climb,
                              heading_at(release_), since);
    }

    void write_device(const Device& device) {
        const std::string name = parachute_name(device.name, names_);
        names_.push_back(name);
        ImportedTable table{"[[parachute]]", taken_.size() == 1 ? "parachute" : "parachute." + name, {}};
        table.notes.push_back(fmt::format("{} '{}', stage '{}'", device.streamer ? "streamer" : "parachute",
                                          device.name, stages_.empty() ? "" : stages_[device.stage].name));
        const auto material = [&](const char* child, std::string_view what, std::string_view unit) {
            const pugi::xml_node node = device.node.child(child);
            if (node)
                table.notes.push_back(fmt::format("{}: {}, {} {}", what, one_line(node.child_value()),
                                                  one_line(node.attribute("density").value()), unit));
        };
        material("material", "fabric", "kg/m2");
        if (!device.streamer) material("linematerial", "lines", "kg/m");
        table.add("name", toml_string(name));
        if (device.count > 1) {
            table.add("count", fmt::format("{}", device.count),
                      "instances of the pod, booster or tube it lies in");
            scene_.assumptions.push_back(
                fmt::format("the {} '{}' open together and hang from one point", device.count, device.name));
        }
        const double area = area_of(device), coefficient = drag_coefficient_of(device);
        const bool automatic =
            std::string_view(device.node.child_value("cd")).starts_with("auto") || !device.node.child("cd");
        const std::string why = automatic ? "OpenRocket's automatic value" : "";
        if (device.streamer) {
            table.add("nominal_diameter", 2.0 * std::sqrt(area / pi), "m",
                      "circle of the strip's area; sets the filling time");
            table.add(
                "drag_area", coefficient * area, "m^2",
                fmt::format("C_D {:.4g} on {:.4g} m2{}{}", coefficient, area, why.empty() ? "" : ", ", why));
            scene_.assumptions.push_back(fmt::format(
                "the streamer '{}' opens as a small parachute does: its opening force says nothing",
                device.name));
        } else {
            table.add("nominal_diameter", required(device.node, "diameter", 1e-3, 200), "m");
            table.add("drag_coefficient", coefficient, "", why);
        }
        const double mass = mass_of(device);
        table.add("mass", std::max(mass, least_mass), "kg",
                  mass < least_mass ? "the file says less; 1 mg is the least here"
                  : device.node.child("overridemass")
                      ? "mass override"
                      : "area and line lengths times the densities of their materials");
        if (const auto lines = number(device.node, "linecount", 0, 1000);
            lines && *lines >= 3 && *lines <= 400)
            table.add("gores", fmt::format("{:.0f}", *lines), "number of lines");
        if (const auto length = number(device.node, "linelength", 0, 1000); length && *length > 0.0)
            table.add("line_length", *length, "m");
        const When when = when_of(device);
        const double diameter =
            device.streamer ? 2.0 * std::sqrt(area / pi) : required(device.node, "diameter", 1e-3, 200);
        add_opening(scene_, table, {when.toml, when.comment, diameter, airspeed_at(device, when)});
        scene_.tables.push_back(std::move(table));
        if (device.node.child("packedlength")) packed_sizes_ = true;
    }

    /// What concerns recovery and has no place in a scene.
    void say_rest() {
        auto& out = scene_.left_out;
        out.insert(out.end(), cords_.begin(), cords_.end());
        if (packed_sizes_) out.push_back("packed sizes of the devices: the scene starts at line stretch");
        out.push_back(
            "materials of fabric and lines (comments in the scene): the reduced-order model takes their mass "
            "alone");
        const pugi::xml_node conditions = simulation_.child("conditions");
        if (conditions.child("launchlatitude"))
            out.push_back(fmt::format(
                "geographic position of the launch site (latitude {}{}): a scene has none",
                one_line(conditions.child_value("launchlatitude")),
                conditions.child("launchlongitude")
                    ? fmt::format(", longitude {}", one_line(conditions.child_value("launchlongitude")))
                    : ""));
        for (const pugi::xml_node extension : simulation_.children("extension"))
            out.push_back(
                fmt::format("simulation extension {}", one_line(extension.attribute("extensionid").value())));
        for (const pugi::xml_node warning : simulation_.child("flightdata").children("warning")) {
            const std::string text = one_line(
                warning.child("description") ? warning.child_value("description") : warning.child_value());
            if (text.find("ecovery") != std::string::npos)
                out.push_back(fmt::format("OpenRocket's warning: {}", text));
        }
        if (!others_.empty()) {
            std::string names;
            for (std::size_t i = 0; i < others_.size() && i < 8; ++i)
                names += fmt::format("{}'{}'", i > 0 ? ", " : "", others_[i]);
            if (others_.size() > 8) names += fmt::format(" and {} more", others_.size() - 8);
            out.push_back(fmt::format("other simulations: {} (--simulation takes one)", names));
        }
        state_landing();
    }

    void state_landing() {
        if (branch_.rows.empty()) {
            const auto speed =
                as_number(simulation_.child("flightdata").attribute("groundhitvelocity").value());
            if (!speed || !(*speed > 0.0)) return;
            scene_.stated_landing_speed = speed;
            scene_.stated_by = "summary of the simulation";
            // Up to file format 1.9 the total velocity below a parachute is that through the air.
            scene_.stated_over_ground = minor_version() >= 10;
            return;
        }
        const auto hit = branch_.event("groundhit");
        if (!hit) return;
        // A mean: Euler steps of older versions swing about the steady rate.
        constexpr double window = 5.0;  // [s]
        double opened = release_;
        for (const Device* device : taken_)
            opened = std::max(opened, stored_deployment(*device).value_or(release_));
        double time = 0.0, fall = 0.0;
        for (std::size_t i = 1; i < branch_.rows.size(); ++i) {
            const State &a = branch_.rows[i - 1], &b = branch_.rows[i];
            if (a.time < std::max(*hit - window, opened + window) || b.time > *hit + 1e-9) continue;
            time += b.time - a.time;
            fall -= 0.5 * (a.climb + b.climb) * (b.time - a.time);
        }
        const double speed = time > 0.0 ? fall / time : -state_at(*hit).climb;
        if (!std::isfinite(speed) || speed <= 0.0) return;
        scene_.stated_landing_speed = speed;
        scene_.stated_by = time > 0.0 ? fmt::format("mean of the last {:.2g} s of the stored flight", time)
                                      : std::string("end of the stored flight");
        if (minor_version() >= 10)
            if (const double total = state_at(*hit).speed; std::isfinite(total))
                scene_.stated_by +=
                    fmt::format("; ground hit at {:.4g} m/s over ground, gusts included", total);
    }

    /// 8 of file format 1.8; 0 where it is not understood.
    int minor_version() const {
        const std::string_view version = root_.attribute("version").value();
        int minor = 0;
        if (version.starts_with("1."))
            std::from_chars(version.data() + 2, version.data() + version.size(), minor);
        return minor;
    }

    static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    static constexpr double least_mass = 1e-6;  // [kg]

    const std::string_view text_;
    const std::string& file_;
    const ImportChoice& choice_;
    pugi::xml_document document_;
    pugi::xml_node root_, simulation_;
    Branch branch_;
    std::string config_;  ///< flight configuration of the chosen simulation
    std::vector<Stage> stages_;
    std::vector<Device> devices_;
    std::vector<const Device*> taken_;
    std::vector<std::string> cords_, others_, names_;
    bool packed_sizes_ = false;
    std::optional<double> apogee_;  ///< [s] in the stored flight
    double release_ = 0.0;          ///< [s] likewise
    double ground_ = 0.0;           ///< [m] above sea level
    ImportedScene scene_;
};

}  // namespace

ImportedScene read_open_rocket(std::string_view xml, const std::string& file, const ImportChoice& choice) {
    return OpenRocketReader(xml, file, choice).read();
}

}  // namespace twinchute::exchange
