#include "compare/validate/suite_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "lib/scene/nearest.hpp"
#include "lib/scene/units.hpp"

namespace twinchute::compare {

SuiteTable::SuiteTable(const toml::table& table, std::string file, std::string path)
    : table_(table), file_(std::move(file)), path_(std::move(path)) {}

void SuiteTable::refuse(std::string_view key, std::string problem, std::string why, std::string hint) const {
    throw SceneError(place(key), path_of(key), std::move(problem), std::move(why), std::move(hint));
}

SourcePlace SuiteTable::place(std::string_view key) const {
    const toml::node* node = key.empty() ? nullptr : table_.get(key);
    const auto& begin = (node ? node->source() : table_.source()).begin;
    return {file_, static_cast<int>(begin.line), static_cast<int>(begin.column)};
}

std::string SuiteTable::path_of(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

const toml::node* SuiteTable::find(std::string_view key) {
    asked_.emplace(key);
    return table_.get(key);
}

void SuiteTable::need(std::string_view key, std::string_view why) {
    if (!find(key)) refuse(key, "is missing", std::string(why), fmt::format("add {} = ...", key));
}

std::string SuiteTable::text(std::string_view key) {
    const toml::node* node = find(key);
    if (!node) return {};
    const auto value = node->value_exact<std::string>();
    if (!value || value->empty()) refuse(key, "text in quotes belongs here", "", "write it in quotes");
    return *value;
}

std::string SuiteTable::needed_text(std::string_view key, std::string_view why) {
    need(key, why);
    return text(key);
}

std::vector<std::string> SuiteTable::texts(std::string_view key) {
    const toml::node* node = find(key);
    if (!node) return {};
    std::vector<std::string> found;
    const toml::array* array = node->as_array();
    if (!array) refuse(key, "a list of texts belongs here", "", fmt::format("write {} = [\"...\"]", key));
    for (const toml::node& item : *array) {
        const auto value = item.value_exact<std::string>();
        if (!value) refuse(key, "a list of texts belongs here", "", fmt::format("write {} = [\"...\"]", key));
        found.push_back(*value);
    }
    return found;
}

bool SuiteTable::flag(std::string_view key, bool fallback) {
    const toml::node* node = find(key);
    if (!node) return fallback;
    const auto value = node->value_exact<bool>();
    if (!value) refuse(key, "true or false belongs here", "", "write it without quotes");
    return *value;
}

std::optional<double> SuiteTable::amount(std::string_view key, std::string_view unit) {
    const toml::node* node = find(key);
    if (!node) return {};
    double value = 0.0;
    if (const auto number = node->value<double>(); number && !node->is_string() && !node->is_boolean()) {
        value = *number;
    } else if (const auto words = node->value_exact<std::string>()) {
        try {
            value = to_si(*words, unit);
        } catch (const UnitError& error) {
            refuse(key, error.problem(), error.why(), error.suggestion());
        }
    } else {
        refuse(key, "a number or a string with a unit belongs here", "", fmt::format("in {}", unit));
    }
    if (!std::isfinite(value)) refuse(key, "is not finite", "", "give a number");
    return value;
}

std::optional<Tolerance> SuiteTable::tolerance(std::string_view key, std::string_view unit) {
    const toml::node* node = find(key);
    if (!node) return {};
    const auto words = node->value_exact<std::string>();
    const bool relative = words && is_share(*words);
    const Tolerance found{*amount(key, relative ? "1" : unit), relative};
    if (found.value < 0.0) refuse(key, "is negative", "", "give its size");
    return found;
}

int SuiteTable::count(std::string_view key, int fallback, int most) {
    const toml::node* node = find(key);
    if (!node) return fallback;
    const auto value = node->value_exact<std::int64_t>();
    if (!value || *value < 1 || *value > most)
        refuse(key, fmt::format("a whole number from 1 to {} belongs here", most), "", "");
    return static_cast<int>(*value);
}

const toml::table* SuiteTable::table(std::string_view key) {
    const toml::node* node = find(key);
    if (!node) return nullptr;
    if (!node->is_table()) refuse(key, "a table belongs here", "", fmt::format("write {} = {{ ... }}", key));
    return node->as_table();
}

std::vector<SuiteTable> SuiteTable::list(std::string_view key) {
    const toml::node* node = find(key);
    if (!node) return {};
    const toml::array* array = node->as_array();
    if (!array || array->empty())
        refuse(key, "a list of tables belongs here", "", fmt::format("write [[{}]] or [{{ ... }}]", key));
    std::vector<SuiteTable> found;
    for (const toml::node& item : *array) {
        if (!item.is_table()) refuse(key, "a list of tables belongs here", "", "write { ... }");
        found.emplace_back(*item.as_table(), file_, path_of(key));
    }
    return found;
}

void SuiteTable::end() const {
    for (const auto& [key, node] : table_) {
        if (asked_.contains(std::string(key.str()))) continue;
        const auto& begin = key.source().begin;
        throw SceneError({file_, static_cast<int>(begin.line), static_cast<int>(begin.column)},
                         path_of(key.str()), "unknown key", "",
                         suggest(key.str(), {asked_.begin(), asked_.end()}));
    }
}

}  // namespace twinchute::compare
