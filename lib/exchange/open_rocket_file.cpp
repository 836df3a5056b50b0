#include "lib/exchange/open_rocket_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "lib/math/vec.hpp"
#include "lib/scene/nearest.hpp"

namespace twinchute::exchange {
namespace {

constexpr int deepest_component = 64;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::optional<double> FlightBranch::event(std::string_view type, std::string_view source) const {
    for (const pugi::xml_node event : node.children("event"))
        if (event.attribute("type").value() == type &&
            (source.empty() || event.attribute("source").value() == source))
            return event.attribute("time").as_double();
    return {};
}

bool FlightBranch::names_sources() const {
    return std::ranges::any_of(node.children("event"), [](pugi::xml_node event) {
        return event.attribute("type").value() == std::string_view("recoverydevicedeployment") &&
               event.attribute("source");
    });
}

OpenRocketFile::OpenRocketFile(std::string_view xml, const std::string& file, const ImportChoice& choice)
    : text_(xml), file_(file), choice_(choice) {
    const pugi::xml_parse_result parsed = document_.load_buffer(xml.data(), xml.size());
    if (!parsed)
        throw SceneError(place(parsed.offset), "", "is no OpenRocket design",
                         fmt::format("not XML: {}", parsed.description()),
                         "name a design that OpenRocket saved (.ork)");
    root = document_.child("openrocket");
    if (!root || !root.child("rocket"))
        throw SceneError(
            {file_, 1, 1}, "", "is no OpenRocket design",
            fmt::format("its XML is a <{}> without <rocket>", one_line(document_.document_element().name())),
            "name a design that OpenRocket saved (.ork)");
    walk(root.child("rocket").child("subcomponents"), 0, 1, 0);
    if (devices.empty())
        throw SceneError({file_, 0, 0}, "", "has no recovery device",
                         "neither a parachute nor a streamer is in it", "add one in OpenRocket");
    check_names();
    choose_simulation();
}

SourcePlace OpenRocketFile::place(std::ptrdiff_t offset) const {
    const std::string_view before =
        text_.substr(0, static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
    const auto line = std::ranges::count(before, '\n');
    const std::size_t start = before.rfind('\n');
    const std::size_t column = before.size() - (start == std::string_view::npos ? 0 : start + 1);
    return {file_, static_cast<int>(line) + 1, static_cast<int>(column) + 1};
}

void OpenRocketFile::refuse(pugi::xml_node node, std::string problem, std::string why,
                            std::string hint) const {
    throw SceneError(place(node.offset_debug()), node.name(), std::move(problem), std::move(why),
                     std::move(hint));
}

std::optional<double> OpenRocketFile::as_number(std::string_view text) {
    while (text.starts_with(' ') || text.starts_with('\n'))
        text.remove_prefix(1);
    while (text.ends_with(' ') || text.ends_with('\n'))
        text.remove_suffix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return {};
    return value;
}

std::optional<double> OpenRocketFile::number(pugi::xml_node parent, const char* child, double low,
                                             double high) const {
    const pugi::xml_node node = parent.child(child);
    if (!node) return {};
    const auto value = as_number(node.child_value());
    if (!value || !(*value >= low && *value <= high))
        refuse(node, fmt::format("'{}' is not taken", one_line(node.child_value())),
               fmt::format("a number from {:g} to {:g} is wanted", low, high),
               "correct the design in OpenRocket");
    return value;
}

double OpenRocketFile::required(pugi::xml_node parent, const char* child, double low, double high) const {
    const auto value = number(parent, child, low, high);
    if (!value)
        refuse(parent, fmt::format("<{}> is missing", child), "", "save the design again in OpenRocket");
    return *value;
}

std::string OpenRocketFile::name_of(pugi::xml_node node) {
    return one_line(node.child_value("name"));
}

int OpenRocketFile::tubes_of(pugi::xml_node tube) {
    const std::string_view name = tube.child_value("clusterconfiguration");
    if (name == "double") return 2;
    int count = 1;
    std::from_chars(name.data(), name.data() + name.size(), count);
    return std::clamp(count, 1, 100);
}

void OpenRocketFile::walk(pugi::xml_node subcomponents, std::size_t stage, int count, int depth) {
    if (depth > deepest_component)
        refuse(subcomponents, "lies too deep",
               fmt::format("{} components within each other are the most", deepest_component),
               "flatten the design");
    for (const pugi::xml_node node : subcomponents.children()) {
        const std::string_view kind = node.name();
        std::size_t own = stage;
        int instances = count;
        if (kind == "stage" || kind == "parallelstage" || kind == "boosterset") {
            own = stages.size();
            stages.push_back({name_of(node), node});
        }
        if (kind == "parallelstage" || kind == "boosterset" || kind == "podset")
            instances = count * static_cast<int>(number(node, "instancecount", 1, 100).value_or(1));
        else if (kind == "innertube")
            instances = count * tubes_of(node);
        if (kind == "parachute" || kind == "streamer")
            devices.push_back({node, name_of(node), node.child_value("id"), kind == "streamer", own,
                               std::min(instances, 100)});
        else if (kind == "shockcord")
            cords.push_back(
                fmt::format("shock cord '{}': the reduced-order model has rigid lines", name_of(node)));
        walk(node.child("subcomponents"), own, instances, depth + 1);
    }
}

void OpenRocketFile::check_names() const {
    for (const std::string& wanted : choice_.devices) {
        if (std::ranges::find(devices, wanted, &RecoveryDevice::name) != devices.end()) continue;
        std::vector<std::string_view> names;
        for (const RecoveryDevice& device : devices)
            names.push_back(device.name);
        throw SceneError({file_, 0, 0}, "", fmt::format("has no recovery device '{}'", one_line(wanted)), "",
                         suggest(wanted, names));
    }
}

bool OpenRocketFile::is_wanted(const RecoveryDevice& device) const {
    return choice_.devices.empty() || std::ranges::count(choice_.devices, device.name) != 0;
}

pugi::xml_node OpenRocketFile::setting(pugi::xml_node node, const char* list, const char* child) const {
    for (const pugi::xml_node one : node.children(list))
        if (!config_.empty() && one.attribute("configid").value() == config_ && one.child(child))
            return one.child(child);
    return node.child(child);
}

std::size_t OpenRocketFile::body_of(std::size_t stage) const {
    while (stage > 0 &&
           setting(stages[stage].node, "separationconfiguration", "separationevent").child_value() ==
               std::string_view("never"))
        --stage;
    return stage;
}

void OpenRocketFile::choose_simulation() {
    std::vector<std::string> names;
    for (const pugi::xml_node one : root.child("simulations").children("simulation")) {
        const std::string name = name_of(one);
        if (!choice_.simulation.empty() && name != choice_.simulation) {
            names.push_back(name);
            continue;
        }
        if (simulation && (!choice_.simulation.empty() || branch.node)) {
            others.push_back(name);
            continue;
        }
        // One with a flight is better than one without.
        const pugi::xml_node flight = find_branch(one);
        const bool first = !simulation;
        const bool summary = !has_summary(simulation) && has_summary(one);
        if (first || flight || (summary && !branch.node)) {
            if (simulation) others.push_back(name_of(simulation));
            simulation = one;
            branch.node = flight;
        } else {
            others.push_back(name);
        }
    }
    if (!choice_.simulation.empty() && !simulation)
        throw SceneError({file_, 0, 0}, "",
                         fmt::format("has no simulation '{}'", one_line(choice_.simulation)),
                         names.empty() ? "it has none at all" : "",
                         names.empty() ? "leave out --simulation"
                                       : suggest(choice_.simulation, {names.begin(), names.end()}));
    if (!choice_.simulation.empty()) others = names;
    config_ = simulation.child("conditions").child_value("configid");
    if (branch.node) read_rows();
}

bool OpenRocketFile::has_summary(pugi::xml_node one) {
    return static_cast<bool>(one.child("flightdata").attribute("maxaltitude"));
}

std::string OpenRocketFile::stage_name(const RecoveryDevice& device) const {
    return stages.empty() ? "" : stages[device.stage].name;
}

bool OpenRocketFile::falls_in(const RecoveryDevice& device, pugi::xml_node flight) const {
    const std::string_view name = flight.attribute("name").value();
    return name == "MAIN" ? device.stage == 0
                          : stage_name(device) == name;  // MAIN: file format 1.4 and before
}

pugi::xml_node OpenRocketFile::find_branch(pugi::xml_node one_simulation) const {
    for (const pugi::xml_node one : one_simulation.child("flightdata").children("databranch")) {
        if (!one.child("datapoint")) continue;
        for (const pugi::xml_node event : one.children("event")) {
            if (event.attribute("type").value() != std::string_view("recoverydevicedeployment")) continue;
            const std::string_view source = event.attribute("source").value();
            if (choice_.devices.empty() || std::ranges::any_of(devices, [&](const RecoveryDevice& device) {
                    return is_wanted(device) &&
                           (source.empty() ? falls_in(device, one) : source == device.id);
                }))
                return one;
        }
    }
    return {};
}

void OpenRocketFile::read_rows() {
    const std::string_view types = branch.node.attribute("types").value();
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
    for (const pugi::xml_node point : branch.node.children("datapoint")) {
        std::vector<double> values;
        std::string_view text = point.child_value();
        for (std::size_t begin = 0; begin <= text.size();) {
            const std::size_t comma = std::min(text.find(',', begin), text.size());
            values.push_back(as_number(text.substr(begin, comma - begin)).value_or(nan));
            begin = comma + 1;
        }
        if (values.size() != names.size())
            refuse(point, fmt::format("{} values where {} columns are named", values.size(), names.size()),
                   "", "run the simulation again in OpenRocket and save it");
        const auto at = [&](std::size_t i) { return columns[i] < values.size() ? values[columns[i]] : nan; };
        const FlightRow row{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8)};
        if (std::isfinite(row.time) && (branch.rows.empty() || row.time >= branch.rows.back().time))
            branch.rows.push_back(row);
    }
    const bool understood = !branch.rows.empty() && std::isfinite(branch.rows.back().altitude) &&
                            std::isfinite(branch.rows.back().climb);
    if (understood) return;
    notes.push_back(
        "the stored flight has no columns 'Time', 'Altitude' and 'Vertical velocity' (another language "
        "than English?): "
        "only its summary counts");
    branch = {};
}

FlightRow OpenRocketFile::state_at(double time) const {
    const std::vector<FlightRow>& rows = branch.rows;
    const auto after = std::ranges::lower_bound(rows, time, {}, &FlightRow::time);
    if (after == rows.begin()) return rows.front();
    if (after == rows.end()) return rows.back();
    const FlightRow& a = *(after - 1);
    const FlightRow& b = *after;
    const double share = b.time > a.time ? (time - a.time) / (b.time - a.time) : 1.0;
    const auto mixed = [&](double FlightRow::*member) {
        return share >= 1.0 || !std::isfinite(a.*member)   ? b.*member
               : share <= 0.0 || !std::isfinite(b.*member) ? a.*member
                                                           : a.*member + share * (b.*member - a.*member);
    };
    return {time,
            mixed(&FlightRow::altitude),
            mixed(&FlightRow::climb),
            mixed(&FlightRow::lateral),
            mixed(&FlightRow::speed),
            mixed(&FlightRow::mass),
            mixed(&FlightRow::gravity),
            mixed(&FlightRow::east),
            mixed(&FlightRow::north)};
}

std::string OpenRocketFile::event_of(const RecoveryDevice& device) const {
    const std::string_view event =
        setting(device.node, "deploymentconfiguration", "deployevent").child_value();
    return event.empty() ? "ejection" : std::string(event);  // OpenRocket's default
}

double OpenRocketFile::delay_of(const RecoveryDevice& device) const {
    const pugi::xml_node node = setting(device.node, "deploymentconfiguration", "deploydelay");
    return node ? number(node.parent(), "deploydelay", 0, 36000).value_or(0.0) : 0.0;
}

double OpenRocketFile::altitude_of(const RecoveryDevice& device) const {
    const pugi::xml_node node = setting(device.node, "deploymentconfiguration", "deployaltitude");
    return node ? number(node.parent(), "deployaltitude", 0, 86000).value_or(200.0) : 200.0;
}

double OpenRocketFile::mass_of(const RecoveryDevice& device) const {
    if (const auto given = number(device.node, "overridemass", 0, 1e4); given && *given > 0.0) return *given;
    const auto density = [&](const char* child) {
        return as_number(device.node.child(child).attribute("density").value()).value_or(0.0);
    };
    if (device.streamer) return area_of(device) * density("material");
    return area_of(device) * density("material") +
           number(device.node, "linecount", 0, 1000).value_or(0.0) *
               number(device.node, "linelength", 0, 1000).value_or(0.0) * density("linematerial");
}

double OpenRocketFile::area_of(const RecoveryDevice& device) const {
    if (device.streamer)
        return required(device.node, "striplength", 1e-6, 1000) *
               required(device.node, "stripwidth", 1e-6, 1000);
    const double diameter = required(device.node, "diameter", 1e-3, 200);
    return 0.25 * pi * diameter * diameter;
}

double OpenRocketFile::drag_coefficient_of(const RecoveryDevice& device) const {
    const std::string_view text = device.node.child_value("cd");
    if (!text.empty() && !text.starts_with("auto")) return required(device.node, "cd", 1e-6, 5);
    if (!device.streamer) return 0.8;
    const double density =
        as_number(device.node.child("material").attribute("density").value()).value_or(0.0);
    const double length = required(device.node, "striplength", 1e-6, 1000);
    return std::min(0.034 * (density + 0.025) / 0.105 * (length + 1.0) / length, 0.4);
}

std::optional<double> OpenRocketFile::heading_at(double time) const {
    const auto after = std::ranges::upper_bound(branch.rows, time, {}, &FlightRow::time);
    if (after == branch.rows.begin() || after == branch.rows.end()) return {};
    const FlightRow& a = *(after - 1);
    const double east = after->east - a.east, north = after->north - a.north;
    if (!std::isfinite(east + north) || std::hypot(east, north) == 0.0) return {};
    return std::atan2(east, north);
}

int OpenRocketFile::minor_version() const {
    const std::string_view version = root.attribute("version").value();
    int minor = 0;
    if (version.starts_with("1."))
        std::from_chars(version.data() + 2, version.data() + version.size(), minor);
    return minor;
}

std::size_t OpenRocketFile::stage_of_branch() const {
    const auto stage = std::ranges::find(stages, branch.node.attribute("name").value(), &RocketStage::name);
    return stage == stages.end() ? 0 : static_cast<std::size_t>(stage - stages.begin());
}

}  // namespace twinchute::exchange
