// Parts of a record that read_record puts together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/checksum.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/record_error.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute {

class JsonNode;

/// A term of the energy ledger in summary.json. Zero is written only where it says something.
struct EnergyTerm {
    const char* key;  ///< with unit
    double EnergyLedger::*term;
    bool zero_is_absent;

    /// The value where the key is absent.
    double absent() const { return zero_is_absent ? 0.0 : std::numeric_limits<double>::quiet_NaN(); }
};

inline constexpr EnergyTerm energy_terms[] = {
    {"kinetic_J", &EnergyLedger::kinetic, false},
    {"elastic_J", &EnergyLedger::elastic, true},
    {"gravity_work_J", &EnergyLedger::gravity_work, false},
    {"drag_work_J", &EnergyLedger::drag_work, true},
    {"damping_J", &EnergyLedger::damping, true},
    {"added_mass_J", &EnergyLedger::added_mass, true},
    {"ramp_J", &EnergyLedger::ramp, true},
    {"external_work_J", &EnergyLedger::external_work, true},
    {"air_loss_J", &EnergyLedger::air_loss, true},
    {"residual_fraction", &EnergyLedger::residual_fraction, false},
};

/// The bytes of a file that belongs to a record. Only regular files are read, a pipe would be waited for, and
/// none beyond `largest` [bytes]. Throws RecordError.
std::string read_record_file(const std::filesystem::path& file, std::size_t largest);

/// Units by column.
using ColumnUnits = std::map<std::string, std::string>;

/// Facts in summary.json about the files beside it.
struct FilesBeside {
    FileChecksums checksums;                   ///< by plain names
    std::optional<ColumnUnits> history_units;  ///< where the tables have no line of units
};

/// Everything but channels and events. `file` stands for it in messages. Throws RecordError.
RunRecord read_summary(std::string_view text, const std::string& file, FilesBeside& beside);

/// Parts that other files hold as well. Each throws RecordError.
SceneId read_scene_id(const JsonNode& node);
std::vector<Input> read_inputs(const JsonNode& node);
Provenance read_provenance(const JsonNode& node);
/// That a file is of twinchute, and of the schema that this version knows; `what` it should be: "record".
void require_schema(const JsonNode& top, std::string_view what, std::int64_t known);

/// `units`: of a table without a line of them. Throws RecordError.
std::vector<Channel> read_history(std::string_view text, const std::string& file,
                                  const std::optional<ColumnUnits>& units);

/// Throws RecordError.
std::vector<Event> read_events(std::string_view text, const std::string& file, CsvHead head);

}  // namespace twinchute
