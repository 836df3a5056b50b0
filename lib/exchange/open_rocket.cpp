// From an OpenRocket design to a scene, after how OpenRocket flies it: descent under all devices that are
// out, without drag of the body.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/exchange/fall.hpp"
#include "lib/exchange/open_rocket_file.hpp"
#include "lib/exchange/read_design.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::exchange {
namespace {

/// [s] after apogee: an opening until then may begin at apogee without drag of the body, a later one begins
/// with the stored state.
constexpr double short_fall = 1.0;

class OpenRocketReader {
public:
    OpenRocketReader(std::string_view xml, const std::string& file, const ImportChoice& choice)
        : file_(file), choice_(choice), design_(xml, file, choice) {}

    ImportedScene read() {
        const std::string_view creator = design_.root.attribute("creator").value();
        scene_.program = fmt::format("{}, file format {}", creator.empty() ? "OpenRocket" : creator,
                                     design_.root.attribute("version").value());
        scene_.assumptions = design_.notes;
        choose_devices();
        find_release();
        write_top();
        add_common_assumptions(scene_, "OpenRocket");
        write_environment();
        write_payload_and_release();
        for (const RecoveryDevice* device : taken_)
            write_device(*device);
        scene_.table("stop", "[stop]").add("at", "\"ground\"");
        say_rest();
        return std::move(scene_);
    }

private:
    // --- places and values ---------------------------------------------------------------------------

    // --- components ----------------------------------------------------------------------------------

    // --- simulation ----------------------------------------------------------------------------------

    // --- what falls ----------------------------------------------------------------------------------

    void leave_out(const RecoveryDevice& device, std::string_view why) {
        scene_.left_out.push_back(
            fmt::format("{} '{}': {}", device.streamer ? "streamer" : "parachute", device.name, why));
    }

    void choose_devices() {
        const bool sources = design_.branch.node && design_.branch.names_sources();
        std::size_t body = design_.body_of(design_.devices.front().stage);
        if (design_.branch.node && !sources) {
            const auto stage = std::ranges::find(
                design_.stages, design_.branch.node.attribute("name").value(), &RocketStage::name);
            if (stage != design_.stages.end())
                body = design_.body_of(static_cast<std::size_t>(stage - design_.stages.begin()));
        } else if (!choice_.devices.empty()) {
            body = design_.body_of(
                std::ranges::find(design_.devices, choice_.devices.front(), &RecoveryDevice::name)->stage);
        }
        for (const RecoveryDevice& device : design_.devices) {
            const bool opens = sources
                                   ? design_.branch.event("recoverydevicedeployment", device.id).has_value()
                                   : design_.body_of(device.stage) == body;
            if (design_.event_of(device) == "never")
                leave_out(device, "it never deploys in this configuration");
            else if (!opens)
                leave_out(
                    device,
                    device.stage != design_.stage_of_branch() || !sources
                        ? fmt::format("it is of the stage '{}', which falls by itself; --device '{}' takes "
                                      "that one",
                                      design_.stage_name(device), device.name)
                        : std::string("it does not deploy in the stored simulation"));
            else if (!design_.is_wanted(device)) {
                leave_out(device, "--device names another");
                all_taken_ = false;
            } else
                taken_.push_back(&device);
        }
        if (taken_.empty())
            throw SceneError({file_, 0, 0}, "", "has no recovery device that deploys",
                             scene_.left_out.empty() ? "" : scene_.left_out.front(),
                             "name one with --device, or another simulation with --simulation");
    }

    /// [s] in the stored flight at which a device leaves its pack; nothing where the file does not tell.
    std::optional<double> stored_deployment(const RecoveryDevice& device) const {
        if (design_.branch.rows.empty()) return {};
        if (design_.branch.names_sources())
            return design_.branch.event("recoverydevicedeployment", device.id);
        if (taken_.size() == 1) return design_.branch.event("recoverydevicedeployment");
        const std::string event = design_.event_of(device);
        const auto after = [&](std::optional<double> time) {
            return time ? std::optional(*time + design_.delay_of(device)) : std::nullopt;
        };
        if (event == "launch") return design_.delay_of(device);
        if (event == "apogee") return after(design_.branch.event("apogee"));
        if (event == "ejection") return after(design_.branch.event("ejectioncharge"));
        if (event == "lowerstageseparation") return after(design_.branch.event("stageseparation"));
        if (event != "altitude") return {};
        const double altitude = design_.altitude_of(device);
        for (std::size_t i = 1; i < design_.branch.rows.size(); ++i)
            if (design_.branch.rows[i - 1].altitude >= altitude &&
                design_.branch.rows[i].altitude <= altitude)
                return design_.branch.rows[i].time + design_.delay_of(device);
        return {};
    }

    void find_release() {
        if (design_.branch.rows.empty()) return;
        const auto highest = std::ranges::max_element(design_.branch.rows, {}, &FlightRow::altitude);
        apogee_ = design_.branch.event("apogee").value_or(highest->time);
        std::optional<double> first;
        for (const RecoveryDevice* device : taken_)
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
        const std::string name = design_.name_of(design_.root.child("rocket"));
        top.add("name", toml_string(name.empty() ? "rocket" : name));
        if (design_.simulation) {
            scene_.taken = fmt::format("Simulation '{}'", design_.name_of(design_.simulation));
            if (design_.branch.node)
                scene_.taken +=
                    fmt::format(", stage '{}'", one_line(design_.branch.node.attribute("name").value()));
            if (design_.simulation.attribute("status").value() == std::string_view("outdated"))
                scene_.assumptions.push_back(
                    "the stored results fit the design, although OpenRocket marks them as outdated");
        }
    }

    void write_environment() {
        const pugi::xml_node conditions = design_.simulation.child("conditions");
        ground_ = design_.number(conditions, "launchaltitude", -1000, 80000).value_or(0.0);
        ImportedTable& table = scene_.table("environment", "[environment]");
        const pugi::xml_node air = conditions.child("atmosphere");
        if (air.attribute("model").value() == std::string_view("extendedisa"))
            add_ground_air(scene_, table, ground_, design_.required(air, "basetemperature", 100, 400),
                           design_.required(air, "basepressure", 1000, 200000));
        else
            table.add("atmosphere", "\"us76\"",
                      conditions ? "OpenRocket's ISA" : "assumed: no simulation is stored");
        table.add("ground", ground_, "m", conditions.child("launchaltitude") ? "launch altitude" : "assumed");
        if (!design_.branch.rows.empty())
            if (const double g = design_.state_at(release_).gravity; std::isfinite(g) && g > 9.0 && g < 10.0)
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
            const auto speed = average ? design_.number(average, "speed", 0, 200)
                                       : design_.number(conditions, "windaverage", 0, 200);
            const auto from = average ? design_.number(average, "direction", -7, 7)
                                      : design_.number(conditions, "winddirection", -7, 7);
            if (!speed || *speed == 0.0) return;
            if (!from)
                scene_.assumptions.push_back(
                    "the wind comes from the east: this file format has no direction");
            add_uniform_wind(scene_, table, *speed, from.value_or(0.5 * pi));
        }
        scene_.left_out.push_back("turbulence of the wind: the air moves evenly here");
    }

    void write_payload_and_release() {
        ImportedTable& payload = scene_.table("payload", "[payload]");
        double devices = 0.0;
        for (const RecoveryDevice* device : taken_)
            devices += device->count * std::max(design_.mass_of(*device), least_mass);
        const auto add_mass = [&](double whole, std::string_view of) {
            if (std::isfinite(whole) && whole > devices)
                payload.add("mass", whole - devices, "kg",
                            fmt::format("{}, {:.4g} kg, less the recovery devices below", of, whole));
            else
                payload.add("mass", "",
                            "the file has no mass that is larger than that of its recovery devices");
        };
        const pugi::xml_node stage = design_.stages.empty()
                                         ? pugi::xml_node()
                                         : design_.stages[design_.body_of(taken_.front()->stage)].node;
        const bool whole_stage = stage.child_value("overridesubcomponentsmass") == std::string_view("true") ||
                                 stage.child_value("overridesubcomponents") == std::string_view("true");
        if (!design_.branch.rows.empty() && std::isfinite(design_.branch.rows.back().mass)) {
            add_mass(design_.branch.rows.back().mass, "all that falls at the end of the stored flight");
        } else if (const auto mass =
                       whole_stage ? design_.number(stage, "overridemass", 0, 1e6) : std::nullopt) {
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
        if (!design_.branch.rows.empty()) {
            const FlightRow at = design_.state_at(release_);
            if (at.altitude <= 0.0)
                table.add("height", "", "the stored flight is at or below the ground there");
            else
                table.add("height", at.altitude, "m", "above the launch site, stored flight");
            const double lateral = std::isfinite(at.lateral) ? std::abs(at.lateral) : 0.0;
            add_velocity(table, lateral, at.climb, design_.heading_at(release_));
            return;
        }
        const pugi::xml_node flight = design_.simulation.child("flightdata");
        const auto highest = design_.as_number(flight.attribute("maxaltitude").value());
        if (highest && *highest > 0.0)
            table.add("height", *highest, "m", "highest point of the stored flight");
        else
            table.add("height", "", "height of apogee above the launch site; the file keeps no flight");
        table.add("speed", "\"0 m/s\"", "assumed: apogee without horizontal speed");
        scene_.assumptions.push_back(
            "the rocket is at rest at apogee: the file keeps no flight with its horizontal speed");
        // Without drag of the body a long fall before the first device would be far too fast.
        if (std::ranges::all_of(
                taken_, [&](const RecoveryDevice* one) { return design_.event_of(*one) == "altitude"; }))
            scene_.table("payload", "[payload]")
                .add("drag_area", "",
                     "C_D S of the falling rocket: no device opens at apogee, and the file keeps no flight "
                     "that says how "
                     "fast it falls until then");
    }

    /// Trigger of a device as an inline table with a comment; empty: at release.
    struct When {
        std::string toml, comment;
    };

    When when_of(const RecoveryDevice& device) const {
        const std::string event = design_.event_of(device);
        const double delay = design_.delay_of(device);
        const auto delayed = [](std::string condition, double by) {
            return by == 0.0 ? fmt::format("{{ {} }}", condition)
                             : fmt::format("{{ {}, delay = {} }}", condition, toml_quantity(by, "s"));
        };
        const auto stored = stored_deployment(device);
        // Where the scene begins after it was met, the delay has begun, too.
        const bool was_met = stored && *stored - delay < release_ - 1e-6;
        if (event == "altitude" && !was_met)
            return {
                delayed(fmt::format("height = {}", toml_quantity(design_.altitude_of(device), "m")), delay),
                "deploy altitude, above the launch site"};
        if (!stored) {
            if (event == "apogee") return {delayed("at = \"apogee\"", delay), ""};
            if (event == "ejection")
                return {delayed("at = \"apogee\"", delay),
                        "ejection charge, assumed at apogee: its time is that of a motor's delay"};
            const auto to_apogee =
                design_.as_number(design_.simulation.child("flightdata").attribute("timetoapogee").value());
            if (event == "launch" && to_apogee && delay >= *to_apogee)
                return {delayed("time = \"0 s\"", delay - *to_apogee),
                        "launch and delay, less the time to apogee"};
            design_.refuse(design_.setting(device.node, "deploymentconfiguration", "deployevent"),
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
    std::optional<double> airspeed_at(const RecoveryDevice& device, const When& when) const {
        if (design_.branch.rows.empty()) {
            if (design_.event_of(device) != "apogee" && design_.event_of(device) != "ejection") return {};
            return airspeed_after(scene_, 0.0, 0.0, {}, design_.delay_of(device));
        }
        const double since =
            when.toml.empty() ? 0.0 : stored_deployment(device).value_or(infinity) - release_;
        if (since > short_fall) return {};
        const FlightRow at = design_.state_at(release_);
        return airspeed_after(scene_, std::isfinite(at.lateral) ? std::abs(at.lateral) : 0.0, at.climb,
                              design_.heading_at(release_), since);
    }

    void write_device(const RecoveryDevice& device) {
        const std::string name = parachute_name(device.name, names_);
        names_.push_back(name);
        ImportedTable table{"[[parachute]]", taken_.size() == 1 ? "parachute" : "parachute." + name, {}};
        table.notes.push_back(fmt::format("{} '{}', stage '{}'", device.streamer ? "streamer" : "parachute",
                                          device.name, design_.stage_name(device)));
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
        const double area = design_.area_of(device), coefficient = design_.drag_coefficient_of(device);
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
            table.add("nominal_diameter", design_.required(device.node, "diameter", 1e-3, 200), "m");
            table.add("drag_coefficient", coefficient, "", why);
        }
        const double mass = design_.mass_of(device);
        table.add("mass", std::max(mass, least_mass), "kg",
                  mass < least_mass ? "the file says less; 1 mg is the least here"
                  : device.node.child("overridemass")
                      ? "mass override"
                      : "area and line lengths times the densities of their materials");
        if (const auto lines = design_.number(device.node, "linecount", 0, 1000);
            lines && *lines >= 3 && *lines <= 400)
            table.add("gores", fmt::format("{:.0f}", *lines), "number of lines");
        if (const auto length = design_.number(device.node, "linelength", 0, 1000); length && *length > 0.0)
            table.add("line_length", *length, "m");
        const When when = when_of(device);
        const double diameter = device.streamer ? 2.0 * std::sqrt(area / pi)
                                                : design_.required(device.node, "diameter", 1e-3, 200);
        add_opening(scene_, table, {when.toml, when.comment, diameter, airspeed_at(device, when)});
        scene_.tables.push_back(std::move(table));
        if (device.node.child("packedlength")) packed_sizes_ = true;
    }

    /// Lists the rest of what concerns recovery: it has no place in a scene.
    void say_rest() {
        auto& out = scene_.left_out;
        out.insert(out.end(), design_.cords.begin(), design_.cords.end());
        if (packed_sizes_) out.push_back("packed sizes of the devices: the scene starts at line stretch");
        out.push_back(
            "materials of fabric and lines (comments in the scene): the reduced-order model takes their mass "
            "alone");
        const pugi::xml_node conditions = design_.simulation.child("conditions");
        if (conditions.child("launchlatitude"))
            out.push_back(fmt::format(
                "geographic position of the launch site (latitude {}{}): a scene has none",
                one_line(conditions.child_value("launchlatitude")),
                conditions.child("launchlongitude")
                    ? fmt::format(", longitude {}", one_line(conditions.child_value("launchlongitude")))
                    : ""));
        for (const pugi::xml_node extension : design_.simulation.children("extension"))
            out.push_back(
                fmt::format("simulation extension {}", one_line(extension.attribute("extensionid").value())));
        for (const pugi::xml_node warning : design_.simulation.child("flightdata").children("warning")) {
            const std::string text = one_line(
                warning.child("description") ? warning.child_value("description") : warning.child_value());
            if (text.find("ecovery") != std::string::npos)
                out.push_back(fmt::format("OpenRocket's warning: {}", text));
        }
        if (!design_.others.empty()) {
            std::string names;
            for (std::size_t i = 0; i < design_.others.size() && i < 8; ++i)
                names += fmt::format("{}'{}'", i > 0 ? ", " : "", design_.others[i]);
            if (design_.others.size() > 8) names += fmt::format(" and {} more", design_.others.size() - 8);
            out.push_back(fmt::format("other simulations: {} (--simulation takes one)", names));
        }
        state_landing();
    }

    void state_landing() {
        if (!all_taken_) return;  // the file's landing is under all of them
        if (design_.branch.rows.empty()) {
            const auto speed = design_.as_number(
                design_.simulation.child("flightdata").attribute("groundhitvelocity").value());
            if (!speed || !(*speed > 0.0)) return;
            scene_.stated_landing_speed = speed;
            scene_.stated_by = "summary of the simulation";
            // Up to file format 1.9 the total velocity below a parachute is that through the air.
            scene_.stated_over_ground = design_.minor_version() >= 10;
            return;
        }
        const auto hit = design_.branch.event("groundhit");
        if (!hit) return;
        // A mean: Euler steps of older versions swing about the steady rate.
        constexpr double window = 5.0;  // [s]
        double opened = release_;
        for (const RecoveryDevice* device : taken_)
            opened = std::max(opened, stored_deployment(*device).value_or(release_));
        double time = 0.0, fall = 0.0;
        for (std::size_t i = 1; i < design_.branch.rows.size(); ++i) {
            const FlightRow &a = design_.branch.rows[i - 1], &b = design_.branch.rows[i];
            if (a.time < std::max(*hit - window, opened + window) || b.time > *hit + 1e-9) continue;
            time += b.time - a.time;
            fall -= 0.5 * (a.climb + b.climb) * (b.time - a.time);
        }
        const double speed = time > 0.0 ? fall / time : -design_.state_at(*hit).climb;
        if (!std::isfinite(speed) || speed <= 0.0) return;
        scene_.stated_landing_speed = speed;
        scene_.stated_by = time > 0.0 ? fmt::format("mean of the last {:.2g} s of the stored flight", time)
                                      : std::string("end of the stored flight");
        if (design_.minor_version() >= 10)
            if (const double total = design_.state_at(*hit).speed; std::isfinite(total))
                scene_.stated_by +=
                    fmt::format("; ground hit at {:.4g} m/s over ground, gusts included", total);
    }

    static constexpr double infinity = std::numeric_limits<double>::infinity();
    static constexpr double least_mass = 1e-6;  // [kg]

    const std::string& file_;
    const ImportChoice& choice_;
    const OpenRocketFile design_;
    std::vector<const RecoveryDevice*> taken_;
    std::vector<std::string> names_;  ///< of the parachutes of the scene
    bool packed_sizes_ = false, all_taken_ = true;
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
