#include "compare/tolerances.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/cli/text.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/record_error.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::compare {
namespace {

constexpr std::string_view prefix = "compare.tolerance.";

/// As text in TOML, whatever it looks like; what needs an escape there is no quantity.
std::string override_text(const Input& input, const std::string& file) {
    const auto* text = std::get_if<std::string>(&input.value);
    const bool plain = text != nullptr && std::ranges::none_of(*text, [](char c) {
                           return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '"' || c == '\\';
                       });
    if (!plain)
        throw RecordError({file}, fmt::format("inputs.{}: is not a tolerance", input.key),
                          "text such as 10 % is one", "run the scene again");
    return fmt::format("{}=\"{}\"", input.key, *text);
}

}  // namespace

Option tolerance_option(std::string_view reference) {
    return {"tolerance", "METRIC=VALUE",
            fmt::format("largest allowed gap, e.g. peak_force=10% (of {}) or peak_force=500N", reference),
            true};
}

std::vector<std::string> tolerance_overrides(const Arguments& arguments, std::string_view option) {
    std::vector<std::string> overrides;
    for (const std::string& text : arguments.values(option)) {
        const auto equals = text.find('=');
        if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
            throw UsageError(
                fmt::format("'--{0} {1}' is not understood (METRIC=VALUE is wanted), e.g. "
                            "--{0} peak_force=10% or --{0} peak_force=500N",
                            option, text));
        }
        overrides.push_back(fmt::format("--{} {}{}", option, prefix, text));
    }
    return overrides;
}

std::set<std::string, std::less<>> command_line_tolerances(const RunRecord& record) {
    std::set<std::string, std::less<>> names;
    for (const Input& input : record.inputs)
        if (input.key.starts_with(prefix) && input.source.starts_with(command_line_source))
            names.insert(input.key.substr(prefix.size()));
    return names;
}

std::map<std::string, Tolerance> recorded_tolerances(const RunRecord& record, const std::string& file) {
    std::vector<std::string> overrides;
    for (const Input& input : record.inputs) {
        const std::string_view key = input.key;
        if (!key.starts_with(prefix)) continue;
        if (find_judgeable_row(key.substr(prefix.size()))) overrides.push_back(override_text(input, file));
    }
    try {
        return read_tolerances(overrides);
    } catch (const SceneError& error) {
        throw RecordError({file}, fmt::format("inputs.{}: is not a tolerance", error.key()), error.what(),
                          "run the scene again");
    }
}

}  // namespace twinchute::compare
