// A test to calibrate to: histories and scalars that were measured, with their uncertainty and the instrument
// that they came through.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/metrics.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::study {

/// A history that a test may have, and the channel of a run that it is held against.
struct HistoryKind {
    std::string_view name;     ///< of its column
    std::string_view channel;  ///< of a run
    std::string_view unit;     ///< SI
    std::string_view title;
    bool is_load;  ///< a wrong scale of its sensor can be told from the rest
};
const HistoryKind* find_history_kind(std::string_view name);

struct MeasuredHistory {
    const HistoryKind* kind = nullptr;
    std::vector<double> time;         ///< [s] on the clock of the test
    std::vector<double> value;        ///< [SI]
    std::optional<double> sigma;      ///< [SI] standard uncertainty of a reading; absent: from the residuals
    std::optional<double> bandwidth;  ///< [Hz] of a filter of first order; absent: none
    double largest() const;           ///< by size
};

struct MeasuredScalar {
    const MetricRow* row = nullptr;
    double value = 0.0, sigma = 0.0;  ///< in the row's unit
};

/// Normal distribution of an input before the test, within its bounds.
struct Prior {
    std::string key;
    double mean = 0.0, sigma = 0.0;
};

struct DropTest {
    std::string name;                     ///< as given
    std::vector<std::string> conditions;  ///< "key=value" that hold in this test alone
    bool clock_known = false;             ///< time counts from release, exactly
    bool is_record = false;               ///< of another model: what is left over is a gap, no noise
    std::vector<MeasuredHistory> histories;
    std::vector<MeasuredScalar> scalars;
    std::vector<Prior> priors;
    std::vector<std::string> notes;  ///< what was left aside
    std::string sha256;              ///< of the file
};

/// Reads what --to names: a CSV file, a TOML file that describes a test, or the directory of a record.
/// `scene`: for what a record has other than it. Throws SceneError, RecordError or UsageError.
DropTest read_drop_test(const std::string& name, const Scene& scene);

/// Reads the text of a CSV file.
DropTest read_drop_test_csv(std::string_view text, const std::string& file);
/// Text of the file that a test names, by its path from there.
using TextOfFile = std::function<std::string(const std::filesystem::path&)>;
std::string text_of_test_file(const std::filesystem::path& file);  ///< on disk
/// Reads the text of a TOML file; `directory`: where files that it names lie.
DropTest read_drop_test_toml(std::string_view text, const std::string& file,
                             const std::filesystem::path& directory,
                             const TextOfFile& text_of = text_of_test_file);

/// A file that came with others, none of which are on disk.
struct TextFile {
    std::string name, text;
};
/// The tests among files: each TOML file is one, and each CSV file that none of these names. Throws
/// SceneError, also for a file that is not among them.
std::vector<DropTest> read_drop_tests(const std::vector<TextFile>& files);

}  // namespace twinchute::study
