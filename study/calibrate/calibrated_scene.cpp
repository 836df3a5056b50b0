#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <system_error>

#include "lib/scene/read_scene.hpp"
#include "study/calibrate/calibration_files.hpp"

namespace twinchute::study {
namespace {

namespace fs = std::filesystem;

/// Text in TOML's double quotes.
std::string toml_text(std::string_view text) {
    std::string out = "\"";
    for (const char c : printable(text)) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + "\"";
}

/// The calibrated scene as seen from the new one.
std::string base_name(const Scene& scene, const fs::path& directory) {
    std::error_code error;
    const fs::path from = fs::weakly_canonical(fs::absolute(directory), error),
                   to = fs::weakly_canonical(fs::absolute(scene.file), error);
    const fs::path relative = to.lexically_relative(from);
    return (relative.empty() ? to : relative).generic_string();
}

std::string source_of(const std::vector<DropTest>& tests) {
    std::string names;
    for (const DropTest& test : tests)
        names += (names.empty() ? "" : ", ") + fs::path(test.name).filename().string();
    return "twinchute calibrate, " + names;
}

/// A key, and the parachute whose table it stands in; nothing: above all tables.
struct WrittenKey {
    std::optional<std::size_t> parachute;
    std::string path;
};
WrittenKey written(const std::string& key, const Scene& scene) {
    constexpr std::string_view head = "parachute.";
    if (!key.starts_with(head)) return {{}, key};
    for (std::size_t i = 0; i < scene.parachutes.size(); ++i)
        if (const std::string own = fmt::format("parachute.{}.", scene.parachutes[i].name);
            key.starts_with(own))
            return {i, key.substr(own.size())};
    return {0, key.substr(head.size())};
}

/// Keys of a scene, those of its parachutes below the others.
class SceneLines {
public:
    explicit SceneLines(const Scene& scene) : scene_(scene), chutes_(scene.parachutes.size()) {}

    void add(const std::string& key, const std::string& value) {
        const WrittenKey place = written(key, scene_);
        (place.parachute ? chutes_[*place.parachute] : top_) += fmt::format("{} = {}\n", place.path, value);
    }
    std::string text() const {
        std::string all = top_;
        for (const std::string& chute : chutes_)
            all += "\n[[parachute]]\n" + chute;
        return all;
    }

private:
    const Scene& scene_;
    std::string top_;
    std::vector<std::string> chutes_;
};

/// Keys that the command line gave the scene: its base has not got them.
void add_command_line(SceneLines& lines, const Scene& scene, const Calibration& calibration) {
    for (const Input& input : scene.inputs) {
        if (!input.source.starts_with(command_line_source)) continue;
        const Parameter* fitted = calibration.find(input.key);
        if (fitted != nullptr && !fitted->held) continue;
        const auto* number = std::get_if<double>(&input.value);
        const std::string value =
            number ? fmt::format("{}", *number) : toml_text(std::get<std::string>(input.value));
        lines.add(input.key, fmt::format("{{ value = {}, source = \"command line\" }}", value));
    }
}

/// Whether a parameter stands in the scene.
bool is_written(const Parameter& p) {
    return p.unknown.kind == Unknown::Kind::key && !p.held;
}

/// The table `uncertainty`: what a campaign draws from. The next drop scatters as the tests did.
std::string uncertainty_table(const Calibration& calibration) {
    std::string inputs, rows;
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i) {
        const Parameter& p = calibration.parameters[i];
        if (!is_written(p)) continue;
        inputs += fmt::format("{}{}", inputs.empty() ? "" : ", ",
                              toml_text((p.unknown.variable.logarithmic ? "ln " : "") + p.unknown.name));
        rows += "\n   ";
        for (std::size_t j = 0; j <= i; ++j) {
            if (!is_written(calibration.parameters[j])) continue;
            double value = calibration.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
            if (i == j) value += std::pow(p.scatter.value_or(0.0), 2);
            rows += fmt::format(" {},", value);
        }
    }
    return fmt::format("\n[uncertainty]\ninputs     = [{}]\ncovariance = [  # lower triangle{}\n]\n", inputs,
                       rows);
}

}  // namespace

std::string calibrated_scene(const Calibration& calibration, const Scene& scene,
                             const std::vector<DropTest>& tests, const fs::path& directory) {
    std::string text = fmt::format(
        "# Written by `twinchute calibrate` from the scene '{}'.\n"
        "# Intervals, correlation and residuals: calibration.json\n"
        "schema = 1\nname = {}\nbase = {}\n",
        printable(scene.name), toml_text(scene.name + ", calibrated"),
        toml_text(base_name(scene, directory)));
    SceneLines lines(scene);
    add_command_line(lines, scene, calibration);
    const bool by_table = is_of_records(tests);
    if (by_table)
        for (const Parameter& p : calibration.parameters)
            if (is_written(p)) {
                const std::size_t parachute = written(p.unknown.name, scene).parachute.value_or(0);
                lines.add(fmt::format("parachute.{}.calibration", scene.parachutes[parachute].name),
                          fmt::format("{{ value = {}, source = {} }}", toml_text(calibration_table_name),
                                      toml_text(source_of(tests))));
                break;
            }
    for (const Parameter& p : calibration.parameters) {
        if (!is_written(p) || by_table) continue;
        const std::string source =
            fmt::format("{}; 95 % {} to {}{}", source_of(tests), readable(p.interval.low),
                        readable(p.interval.high), p.identified ? "" : ", not identified: " + p.why);
        lines.add(p.unknown.name, fmt::format("{{ value = {}, source = {}, grade = \"measured\" }}",
                                              p.estimate, toml_text(source)));
    }
    return text + lines.text() + (by_table ? "" : uncertainty_table(calibration));
}

}  // namespace twinchute::study
