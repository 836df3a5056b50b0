// A table of a suite's TOML: keys are asked for by name and kind, and what was not asked for is refused.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/scene.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::compare {

/// Every complaint is a SceneError with file, line and key. An absent key is empty, zero or nothing.
class SuiteTable {
public:
    /// path: of the table in the file, e.g. "case.row"; the table outlives this.
    SuiteTable(const toml::table& table, std::string file, std::string path);

    [[noreturn]] void refuse(std::string_view key, std::string problem, std::string why,
                             std::string hint) const;
    SourcePlace place(std::string_view key = {}) const;  ///< of a key's value, or of the table
    const std::string& file() const { return file_; }
    std::string path_of(std::string_view key) const;

    const toml::node* find(std::string_view key);
    void need(std::string_view key, std::string_view why);  ///< refuses its absence
    std::string text(std::string_view key);
    std::string needed_text(std::string_view key, std::string_view why);
    std::vector<std::string> texts(std::string_view key);
    bool flag(std::string_view key, bool fallback);
    /// In SI; a plain number is taken as that.
    std::optional<double> amount(std::string_view key, std::string_view unit);
    /// "5 %" of what it belongs to, or an amount; not negative.
    std::optional<Tolerance> tolerance(std::string_view key, std::string_view unit);
    int count(std::string_view key, int fallback, int most);  ///< from 1
    const toml::table* table(std::string_view key);           ///< null: absent
    std::vector<SuiteTable> list(std::string_view key);       ///< [[key]] or [{ ... }]
    /// Refuses keys that nobody asked for.
    void end() const;

private:
    const toml::table& table_;
    std::string file_, path_;
    std::set<std::string, std::less<>> asked_;
};

}  // namespace twinchute::compare
