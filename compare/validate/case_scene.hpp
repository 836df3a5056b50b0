// From a case of a suite to the scenes that it runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compare/validate/suite.hpp"
#include "compare/validate/tables.hpp"

namespace twinchute::compare {

/// A case with the files that it names. Throws SceneError with the place of the case, or of a file.
class CaseScene {
public:
    CaseScene(const ValidationSuite& suite, const ValidationCase& one);

    /// Why it cannot be run: what its source does not state, or the table of canopy types lacks. Empty: it
    /// can.
    std::string missing() const;

    /// Lines of its table that it asks for, their indices; without a table the single line "none".
    const std::vector<std::optional<std::size_t>>& lines() const { return lines_; }
    int line_number(std::optional<std::size_t> line) const;

    /// The scene for a line, with "key=value" over it.
    Scene scene(std::optional<std::size_t> line, const std::vector<std::string>& more = {}) const;

    /// The scene without what `set` says of the case's own drop, with "key=value" over it.
    Scene before_set(const std::vector<std::string>& more) const;

    /// A file beside the suite or in the data; `key`: of the case, that names it.
    std::filesystem::path file(const std::string& name, const char* key) const;

    /// Scenes of a series, with "key=value" over each.
    std::vector<Scene> series(const std::vector<std::string>& more = {}) const;

    /// Value that a row expects; nothing where its table has an empty cell or its recording does not reach so
    /// far.
    std::optional<double> expected(const ExpectedRow& row, std::optional<std::size_t> line) const;

private:
    [[noreturn]] void refuse(const SceneError& error) const;
    std::size_t column(const std::string& name, const char* key) const;

    const ValidationSuite& suite_;
    const ValidationCase& case_;
    std::optional<std::vector<std::string>> type_;
    ReferenceTable table_;
    std::vector<std::optional<std::size_t>> lines_;
    RunRecord recording_;
};

}  // namespace twinchute::compare
