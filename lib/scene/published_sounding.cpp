#include "lib/scene/published_sounding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute {
namespace {

constexpr double knot = 1852.0 / 3600.0;  // [m/s]
constexpr double ice_point = 273.15;      // [K]

struct NumberedLine {
    int number = 0;
    std::string_view text;
};

std::vector<NumberedLine> numbered_lines(std::string_view text, std::size_t most) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    std::vector<NumberedLine> lines;
    for (int number = 1; !text.empty() && lines.size() < most; ++number) {
        const std::size_t feed = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, feed);
        if (line.ends_with('\r')) line.remove_suffix(1);
        lines.push_back({number, line});
        text.remove_prefix(std::min(feed + 1, text.size()));
    }
    return lines;
}

std::vector<std::string_view> words_between_blanks(std::string_view text) {
    std::vector<std::string_view> words;
    for (std::size_t begin = 0;;) {
        begin = text.find_first_not_of(" \t", begin);
        if (begin == std::string_view::npos) return words;
        const std::size_t end = std::min(text.find_first_of(" \t", begin), text.size());
        words.push_back(text.substr(begin, end - begin));
        begin = end;
    }
}

std::optional<double> sounding_number(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
        return {};
    return value;
}

/// [m] geometric altitude of a geopotential one (US Standard Atmosphere 1976, Eq. 19).
double geometric(double geopotential) {
    constexpr double earth = 6356766.0;  // [m]
    return earth * geopotential / (earth - geopotential);
}

bool is_wyoming_head(std::string_view line) {
    const auto words = words_between_blanks(line);
    return words.size() >= 4 && words[0] == "PRES" && words[1] == "HGHT" && words[2] == "TEMP";
}

/// Line of FSL that opens a sounding: 254, hour, day, month, year.
bool is_fsl_head(std::string_view line) {
    const auto words = words_between_blanks(line);
    return words.size() >= 5 && words[0] == "254";
}

class SoundingReader {
public:
    SoundingReader(std::string_view text, const std::string& file)
        : file_(file), lines_(numbered_lines(text, std::string_view::npos)) {}

    std::vector<SoundingLevel> read() {
        const auto head = std::ranges::find_if(lines_, is_wyoming_head, &NumberedLine::text);
        if (head != lines_.end())
            read_wyoming(static_cast<std::size_t>(head - lines_.begin()));
        else
            read_fsl(static_cast<std::size_t>(std::ranges::find_if(lines_, is_fsl_head, &NumberedLine::text) -
                                              lines_.begin()));
        if (levels_.empty())
            refuse(lines_.back(), 1, "no levels", "the sounding ends before its first one", "copy all of it");
        return std::move(levels_);
    }

private:
    [[noreturn]] void refuse(const NumberedLine& line, std::size_t column, std::string problem,
                             std::string why, std::string hint) const {
        throw SceneError({file_, line.number, static_cast<int>(column)}, "", std::move(problem),
                         std::move(why), std::move(hint));
    }

    void require_range(const NumberedLine& line, std::optional<double> value, double low, double high,
                       std::string_view what) const {
        if (value && !(*value >= low && *value <= high))
            refuse(line, 1, fmt::format("{} {:g} is out of range", what, *value),
                   fmt::format("from {:g} to {:g}", low, high), "correct the line");
    }

    /// Pressure [Pa], temperature [K], wind [m/s] and [deg] of a level at a geopotential height [m].
    void add(const NumberedLine& line, double height, std::optional<double> pressure,
             std::optional<double> temperature, std::optional<double> speed, std::optional<double> from) {
        require_range(line, height, -5000.0, 84000.0, "height [m]");
        require_range(line, pressure, 0.01, 120000.0, "pressure [Pa]");
        require_range(line, temperature, 100.0, 400.0, "temperature [K]");
        require_range(line, speed, 0.0, 200.0, "wind [m/s]");
        require_range(line, from, 0.0, 360.0, "wind direction [deg]");
        if (speed.has_value() != from.has_value())
            refuse(line, 1, "half a wind",
                   speed ? "a speed without a direction" : "a direction without a speed",
                   "correct the line, or leave out both");
        if (from) *from *= pi / 180.0;
        levels_.push_back({line.number, geometric(height), pressure, temperature, speed, from});
    }

    // --- Wyoming: columns, each as wide as its name in the head is far from the one before ---------------

    void read_wyoming(std::size_t head) {
        const NumberedLine& names = lines_[head];
        if (head + 1 == lines_.size()) refuse(names, 1, "has no units below", "", "copy all of the sounding");
        std::vector<std::size_t> ends;
        const std::vector<std::string_view> words = words_between_blanks(names.text);
        for (const std::string_view word : words)
            ends.push_back(static_cast<std::size_t>(word.data() - names.text.data()) + word.size());
        const auto column = [&](std::string_view name) {
            return static_cast<std::size_t>(std::ranges::find(words, name) - words.begin());
        };
        const bool knots = column("SKNT") < words.size();
        const std::size_t from = column("DRCT"), speed = column(knots ? "SKNT" : "SPED");
        check_units(lines_[head + 1], knots);
        std::size_t at = head + 2;
        for (; at < lines_.size(); ++at) {
            const NumberedLine& line = lines_[at];
            const std::size_t first = line.text.find_first_not_of(" \t");
            if (first == std::string_view::npos || line.text[first] == '<' ||
                line.text.substr(first).starts_with("Station"))
                break;
            if (line.text.find_first_not_of("- ") == std::string_view::npos) continue;  // a rule
            const std::vector<std::optional<double>> cells = wyoming_cells(line, ends);
            const auto cell = [&](std::size_t i) { return i < cells.size() ? cells[i] : std::nullopt; };
            const auto scaled = [](std::optional<double> value, double factor) {
                return value ? std::optional(*value * factor) : std::nullopt;
            };
            const auto temperature = cell(2);
            if (!cell(1)) {
                if (temperature || cell(speed))
                    refuse(line, 1, "no height", "a level is placed by its height", "give it");
                continue;
            }
            add(line, *cell(1), scaled(cell(0), 100.0),
                temperature ? std::optional(*temperature + ice_point) : std::nullopt,
                scaled(cell(speed), knots ? knot : 1.0), cell(from));
        }
        for (; at < lines_.size(); ++at)
            if (is_wyoming_head(lines_[at].text)) refuse_second(lines_[at]);
    }

    void check_units(const NumberedLine& line, bool knots) const {
        const auto words = words_between_blanks(line.text);
        const bool right = words.size() >= 3 && words[0] == "hPa" && words[1] == "m" && words[2] == "C";
        const bool speed =
            std::ranges::count(words, knots ? "knot" : "m/s") == 1 ||
            std::ranges::none_of(words, [](auto word) { return word == "knot" || word == "m/s"; });
        if (!right || !speed)
            refuse(line, 1, "these are not the units of a Wyoming list", "hPa, m, C and knot are",
                   "copy the list as it was published");
    }

    std::vector<std::optional<double>> wyoming_cells(const NumberedLine& line,
                                                     const std::vector<std::size_t>& ends) const {
        std::vector<std::optional<double>> cells;
        std::size_t begin = 0;
        for (const std::size_t end : ends) {
            if (begin >= line.text.size()) break;
            // Numbers end below the last letter of their column's name.
            std::string_view text = line.text.substr(begin, end - begin);
            const bool ends_there = text.back() != ' ' && (end >= line.text.size() || line.text[end] == ' ');
            if (text.find_first_not_of(' ') != std::string_view::npos &&
                (!ends_there || text.size() < end - begin || text.find('\t') != std::string_view::npos))
                refuse(line, end,
                       fmt::format("the columns do not end below their names ('{}')", printable_part(text)),
                       "empty cells are told from others by their place alone",
                       "copy the list as it was published, with its blanks");
            const std::size_t first = text.find_first_not_of(' ');
            if (first == std::string_view::npos) {
                cells.emplace_back();
            } else {
                text = text.substr(first, text.find_last_not_of(' ') - first + 1);
                const auto value = sounding_number(text);
                if (!value)
                    refuse(line, begin + first + 1, fmt::format("'{}' is not a number", printable_part(text)),
                           "", "correct the line");
                cells.push_back(value);
            }
            begin = end;
        }
        return cells;
    }

    static std::string printable_part(std::string_view text) {
        std::string shown(text.substr(0, 20));
        std::ranges::replace_if(
            shown, [](char c) { return c < ' ' || c > '~'; }, '?');
        return shown;
    }

    // --- FSL: a kind of line and six numbers; 99999 (or 32767, in old files) was not measured ------------

    void read_fsl(std::size_t head) {
        std::string_view speed_unit;
        struct FslRow {
            NumberedLine line;
            std::array<std::optional<double>, 6> cells;
        };
        std::vector<FslRow> rows;
        for (std::size_t i = head + 1; i < lines_.size(); ++i) {
            const NumberedLine& line = lines_[i];
            const auto words = words_between_blanks(line.text);
            if (words.empty()) continue;
            if (is_fsl_head(line.text) || (i + 1 < lines_.size() && is_fsl_head(lines_[i + 1].text)))
                refuse_second(line);
            const auto kind = sounding_number(words[0]);
            if (!kind || *kind != std::floor(*kind) || *kind < 1.0 || *kind > 9.0)
                refuse(line, 1, fmt::format("'{}' is no kind of line", printable_part(words[0])),
                       "1 to 3 are heads, 4 to 9 levels", "correct the line");
            if (*kind == 3.0) speed_unit = words.back();
            if (*kind < 4.0) continue;
            if (words.size() < 7)
                refuse(line, 1, fmt::format("{} numbers where a level has 7", words.size()),
                       "kind, pressure, height, temperature, dew point, wind direction, wind speed",
                       "correct the line");
            FslRow row{line, {}};
            for (std::size_t k = 0; k < row.cells.size(); ++k) {
                const auto value = sounding_number(words[k + 1]);
                if (!value)
                    refuse(line, static_cast<std::size_t>(words[k + 1].data() - line.text.data()) + 1,
                           fmt::format("'{}' is not a number", printable_part(words[k + 1])), "",
                           "correct the line");
                if (*value != 99999.0 && *value != 32767.0) row.cells[k] = value;
            }
            rows.push_back(row);
        }
        if (speed_unit != "kt" && speed_unit != "ms")
            refuse(lines_[head], 1, fmt::format("'{}' is no unit of the wind", printable_part(speed_unit)),
                   "kt or ms ends the line of kind 3", "copy all of the sounding");
        // Whole millibars in old files, tenths since: no sounding ends below 200 mb.
        double largest = 0.0;
        for (const FslRow& row : rows)
            largest = std::max(largest, row.cells[0].value_or(0.0));
        const double pascals = largest > 2000.0 ? 10.0 : 100.0;
        for (const FslRow& row : rows) {
            const auto& [pressure, height, temperature, dew_point, from, speed] = row.cells;
            if (!height) continue;  // cannot be placed
            add(row.line, *height, pressure ? std::optional(*pressure * pascals) : std::nullopt,
                temperature ? std::optional(0.1 * *temperature + ice_point) : std::nullopt,
                speed ? std::optional(*speed * (speed_unit == "kt" ? knot : 0.1)) : std::nullopt, from);
        }
    }

    [[noreturn]] void refuse_second(const NumberedLine& line) const {
        refuse(line, 1, "a second sounding begins here", "a scene flies through one", "keep one of them");
    }

    const std::string& file_;
    std::vector<NumberedLine> lines_;
    std::vector<SoundingLevel> levels_;
};

}  // namespace

bool is_published_sounding(std::string_view text) {
    constexpr std::size_t longest_head = 60;  // lines of a page before its list
    const std::vector<NumberedLine> lines = numbered_lines(text, longest_head);
    if (std::ranges::any_of(lines, is_wyoming_head, &NumberedLine::text)) return true;
    const auto head = std::ranges::find_if(lines, is_fsl_head, &NumberedLine::text);
    return head != lines.end() && head - lines.begin() < 3;
}

std::vector<SoundingLevel> read_published_sounding(std::string_view text, const std::string& file) {
    return SoundingReader(text, file).read();
}

}  // namespace twinchute
