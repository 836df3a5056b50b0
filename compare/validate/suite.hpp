// A suite of validation: cases that say which scene to run and what should come out, read from a TOML file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/validate/quantities.hpp"
#include "compare/validate/trends.hpp"
#include "lib/scene/scene.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::compare {

/// Kind of the expected values of a suite. Only test data can validate a model.
enum class Evidence {
    exact,     ///< closed forms and independent integrations of the same equations
    printed,   ///< results of the method that a paper prints
    measured,  ///< test data
    synthetic  ///< numbers that nobody measured, to show or to test the format
};

std::string_view evidence_name(Evidence evidence);   ///< "exact", "printed", "measured", "synthetic"
std::string_view agreement_word(Evidence evidence);  ///< "verified", "reproduced", "validated", "met"

/// One number that a case should give.
struct ExpectedRow {
    std::string quantity;  ///< a row of quantities(), or a metric's name
    QuantityArguments arguments;
    std::optional<TrendAsked> trend;      ///< over the cases of a series, in place of a quantity of one run
    std::vector<std::string> fidelities;  ///< among those of the case; empty: all of them
    /// In SI. Absent: from `column` of the case's table, or from the case's recording.
    std::optional<double> expected;
    std::string column;
    double factor = 1.0;                 ///< of that column, into SI
    std::optional<Tolerance> tolerance;  ///< of the expected value, or in SI
    std::optional<Tolerance> sigma;      ///< one standard deviation of the measurement, likewise
    bool judged = true;
    std::string group;  ///< rows of one group are summed up by bias and scatter
    std::string source, grade, where, note;
    SourcePlace place;
};

/// A column of the case's table that gives a key of its scene: value^power times factor, in SI.
struct GivenColumn {
    std::string column, key;
    double factor = 1.0, power = 1.0;
};

struct ValidationCase {
    std::string name;
    std::string what;  ///< one sentence for the reader
    SourcePlace place;

    std::string scene;             ///< the text of a scene file; empty where the case cannot be run
    bool is_series = false;        ///< it is a series: rows are trends over its cases
    std::vector<std::string> set;  ///< "key=value" over it
    std::string canopy_type;       ///< row of reference/parachute_types.csv, under `set`
    std::vector<std::string> fidelities;
    int seeds = 0;      ///< of full.noise; 0: the scene as it is
    std::string table;  ///< of expected values, a run for each line
    std::string only;   ///< "name=value" that a line of it has to have, or empty
    std::vector<GivenColumn> given;
    std::string recording;  ///< CSV of a test, from which rows without an expected value take theirs

    /// Inputs that the test knows to one standard deviation, propagated by sampling.
    std::vector<std::pair<std::string, Tolerance>> uncertain;
    /// An input that may be off by this share: predicted at both ends.
    std::optional<std::pair<std::string, double>> bracket;
    /// An input that is adjusted until the first row is met, within these bounds; that row judges nothing.
    struct Fit {
        std::string key;
        double low = 0.0, high = 0.0;
    };
    std::optional<Fit> fit;
    /// Inputs calibrated to other drops of the same canopy: every row is then judged blind.
    struct Calibration {
        std::vector<std::string> to;    ///< tests, as calibrate --to takes them
        std::vector<std::string> vary;  ///< as its --vary; empty: by default
    };
    std::optional<Calibration> calibration;

    /// Quantities of its rows whose errors are said together, in one line: instants that one shift of the
    /// clock would have to explain.
    std::vector<std::string> offsets;

    std::vector<std::string> missing;  ///< inputs that no source states: not run
    std::string shown_by;              ///< the test that shows what no scene can: not run

    std::vector<ExpectedRow> rows;
};

struct ValidationSuite {
    std::string name, title, about;
    Evidence evidence = Evidence::exact;
    std::filesystem::path file;
    std::vector<ValidationCase> cases;
};

/// Throws SceneError with file, line and key for everything that is wrong in the suite itself; scenes are
/// read when they run.
ValidationSuite read_suite(const std::filesystem::path& file);
ValidationSuite read_suite_text(std::string_view text, const std::filesystem::path& file);

/// Names of the suites that come with the program, each a file in validation/ of the data.
std::vector<std::string> suite_names();
/// The file of such a name, or of one below that folder. Throws SceneError.
std::filesystem::path suite_file(const std::string& name);

}  // namespace twinchute::compare
