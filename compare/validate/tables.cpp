#include "compare/validate/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "lib/scene/logged_table.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/scene/units.hpp"

namespace twinchute::compare {
namespace {

std::vector<std::string> cells_of(std::string_view line) {
    std::vector<std::string> cells;
    for (std::size_t begin = 0;;) {
        const std::size_t comma = std::min(line.find(',', begin), line.size());
        cells.emplace_back(line.substr(begin, comma - begin));
        if (comma == line.size()) return cells;
        begin = comma + 1;
    }
}

}  // namespace

std::optional<std::size_t> ReferenceTable::column(std::string_view name) const {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) return {};
    return static_cast<std::size_t>(found - names.begin());
}

std::optional<double> ReferenceTable::number(std::size_t line, std::size_t column) const {
    const std::string_view text = trimmed(lines[line][column]);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) return {};
    // A remark in brackets, and no unit: "8 (reefed 6)".
    const std::string_view rest = trimmed({end, text.data() + text.size()});
    if (!rest.empty() && !rest.starts_with('(')) return {};
    return value;
}

ReferenceTable read_reference_table(std::string_view text, const std::string& file) {
    ReferenceTable table;
    table.file = file;
    int number = 0;
    while (!text.empty()) {
        const std::size_t feed = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, feed);
        text.remove_prefix(std::min(feed + 1, text.size()));
        ++number;
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (line.empty() || line.front() == '#') continue;
        std::vector<std::string> cells = cells_of(line);
        if (table.names.empty()) {
            table.names = std::move(cells);
            continue;
        }
        if (cells.size() != table.names.size())
            throw SceneError(
                {file, number, 1}, "",
                fmt::format("{} cells where the first line has {}", cells.size(), table.names.size()), "",
                "every line has a cell for every column");
        table.lines.push_back(std::move(cells));
        table.numbers.push_back(number);
    }
    if (table.lines.empty())
        throw SceneError({file, 0, 0}, "", "is not a table", "the first line names the columns",
                         "add lines below it");
    return table;
}

std::optional<std::vector<std::string>> canopy_type_keys(const ReferenceTable& types, std::string_view type) {
    const auto name = types.column("type");
    if (!name) return {};
    const auto row = std::ranges::find(types.lines, type,
                                       [&](const auto& cells) -> const std::string& { return cells[*name]; });
    if (row == types.lines.end()) return {};
    const auto line = static_cast<std::size_t>(row - types.lines.begin());
    const auto value = [&](std::string_view column) -> std::optional<double> {
        const auto at = types.column(column);
        if (!at) return {};
        return types.number(line, *at);
    };
    const auto middle = [&](std::string_view low, std::string_view high) -> std::optional<double> {
        const auto a = value(low), b = value(high);
        if (!a || !b) return {};
        return 0.5 * (*a + *b);
    };
    const auto n = value("n_unreefed"), coefficient = middle("CD0_lo", "CD0_hi");
    if (!n || !coefficient) return {};
    std::vector<std::string> keys{fmt::format("parachute.fill_time.n={}", *n),
                                  fmt::format("parachute.drag_coefficient={}", *coefficient)};
    if (const auto ratio = middle("Dp_over_D0_lo", "Dp_over_D0_hi"))
        keys.push_back(fmt::format("parachute.projected_diameter_ratio={}", *ratio));
    if (const auto exponent = value("j"))
        keys.push_back(fmt::format("parachute.drag_area_law=power-{:g}", *exponent));
    return keys;
}

RunRecord read_recording(std::string_view text, const std::string& file, const Scene& scene) {
    struct Row {
        std::string_view column;
        Channel channel;
        double factor, offset;
    };
    const Row rows[] = {{"force", {"force", "N", {}}, 1.0, 0.0},
                        {"height", {"altitude", "m", {}}, 1.0, scene.environment.ground},
                        {"speed", {"vertical_speed", "m/s", {}}, -1.0, 0.0}};
    const LoggedTable table = read_logged_table(text, file);
    const std::vector<double> times = logged_times(table);
    RunRecord record;
    record.fidelity = "recording";
    record.channels.push_back({"time", "s", times});
    for (const Row& row : rows) {
        const LoggedColumn* column = table.find(row.column);
        if (column == nullptr) continue;
        Channel channel = row.channel;
        channel.values = logged_history(table, times, *column, channel.unit).value;
        if (channel.values.size() != times.size())
            throw SceneError({file, table.head_line, column->column}, "",
                             fmt::format("{} is missing in some lines", row.column),
                             "the columns of a recording share their times", "leave out lines without it");
        for (double& value : channel.values)
            value = row.factor * value + row.offset;
        record.channels.push_back(std::move(channel));
    }
    if (record.channels.size() < 2)
        throw SceneError({file, table.head_line, 1}, "", "nothing is recorded beside the time", "",
                         "the columns are time, and force, height or speed");
    return record;
}

}  // namespace twinchute::compare
