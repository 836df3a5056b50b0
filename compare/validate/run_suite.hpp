// Suites are run and every row is judged.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "compare/validate/statistics.hpp"
#include "compare/validate/suite.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

enum class RowVerdict {
    within,      ///< as near as the row asks for
    exceeded,    ///< not so, or the run did not give the quantity
    not_judged,  ///< shown alone
    fitted,      ///< an input was adjusted until it was met
    not_run,     ///< what is missing stands beside it
    by_test      ///< no scene can show it, a test does
};

/// "within", "exceeded", "not judged", "fitted", "not run", "by test".
std::string_view row_verdict_name(RowVerdict verdict);

/// One row of the table. Values and widths in the SI unit of the quantity.
struct RowResult {
    std::string name;      ///< of the case
    std::string fidelity;  ///< empty: not run
    std::string quantity;  ///< in words
    std::string unit;      ///< empty for ratios
    int line = 0;          ///< of the case's table; 0: it has none
    std::optional<double> expected, predicted;
    std::optional<double> low,
        high;  ///< smallest and largest prediction, over seeds or both ends of a bracket
    std::optional<double> tolerance;  ///< half width of what is within; of a bracket that beyond its ends
    std::optional<double> sigma_measured;  ///< standard uncertainty of the measurement
    std::optional<double> sigma_inputs;    ///< that of the prediction, from uncertain inputs
    RowVerdict verdict = RowVerdict::not_judged;
    std::string why;  ///< what is missing, what failed, what was adjusted
    std::string source, grade, where, note, group;

    std::optional<double> error() const;           ///< predicted less expected
    std::optional<double> relative_error() const;  ///< over |expected|; nothing where that is 0
};

/// Bias and scatter of the rows of one group.
struct GroupResult {
    std::string name;
    std::vector<const RowResult*> rows;  ///< what it is made from; of the SuiteResult it stands in
    std::optional<Agreement> agreement;  ///< of three or more
};

struct SuiteResult {
    std::string name, title, about, file;
    Evidence evidence = Evidence::exact;
    std::vector<RowResult> rows;
    std::vector<std::string> remarks;       ///< what a case says of itself, a sentence each
    std::vector<std::string> calibrations;  ///< inputs of cases that are judged by other drops, a line each
    std::vector<std::string> offsets;       ///< errors that cases say together, a line each (ValidationCase)
    double seconds = 0.0;                   ///< [s] wall time

    int count(RowVerdict verdict) const;
    int judged() const { return count(RowVerdict::within) + count(RowVerdict::exceeded); }
    /// In the order in which they appear. Rows of grade D, which their source does not vouch for, and fitted
    /// ones are left out.
    std::vector<GroupResult> groups() const;
};

struct Validation {
    std::vector<SuiteResult> suites;
    bool interrupted = false;  ///< the rest was not run
    bool exact_alone = false;  ///< rows of exact suites alone decide

    bool failed() const;  ///< a judged row that decides is not within
};

/// Inputs of a case from other drops.
struct CalibratedCase {
    std::vector<std::string> values;              ///< "key=value"
    std::vector<std::vector<std::string>> draws;  ///< the same, from what is known of them
    std::string text;                             ///< what they are, and doubts
};

/// Calibrates inputs of a scene, which it takes with "key=value" over it, to tests. Throws SceneError,
/// UsageError and RecordError.
using Calibrator = std::function<CalibratedCase(
    const std::function<Scene(const std::vector<std::string>&)>& scene_with,
    const std::vector<std::string>& tests, const std::vector<std::string>& vary, int draws)>;

struct ValidationOptions {
    bool quick = false;  ///< one seed of each packed scene, fewer samples
    int threads = 1;     ///< runs at the same time; the answer is the same
    std::stop_token stop = {};
    std::function<void(const Progress&)> progress = {};
    Calibrator calibrate = {};  ///< of cases that ask for it
};

/// Seeds, and samples of uncertain inputs; 200 samples know a standard deviation to 5 %.
inline constexpr int quick_seeds = 1, most_samples = 200, quick_samples = 50;

/// Throws SceneError for a scene or a table that is wrong, with the place of its case. Rows of cases that an
/// interruption did not let end are not there; `interrupted` says so.
SuiteResult run_suite(const ValidationSuite& suite, std::span<const Fidelity* const> fidelities,
                      const ValidationOptions& options, bool& interrupted);

}  // namespace twinchute::compare
