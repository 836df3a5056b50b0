// Parts of a record that read_record puts together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/checksum.hpp"
#include "lib/record/record_error.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute {

class JsonNode;

/// The bytes of a file that belongs to a record. Only regular files are read, a pipe would be waited for, and
/// none beyond `largest` [bytes]. Throws RecordError.
std::string read_record_file(const std::filesystem::path& file, std::size_t largest);

/// Everything but channels and events. `file` stands for it in messages. `checksums` gets what it says of the
/// files beside it, by plain names. Throws RecordError.
RunRecord read_summary(std::string_view text, const std::string& file, FileChecksums& checksums);

/// Parts that other files hold as well. Each throws RecordError.
SceneId read_scene_id(const JsonNode& node);
std::vector<Input> read_inputs(const JsonNode& node);
Provenance read_provenance(const JsonNode& node);
/// That a file is of twinchute, and of the schema that this version knows; `what` it should be: "record".
void require_schema(const JsonNode& top, std::string_view what, std::int64_t known);

/// Throws RecordError.
std::vector<Channel> read_history(std::string_view text, const std::string& file);

/// Throws RecordError.
std::vector<Event> read_events(std::string_view text, const std::string& file);

}  // namespace twinchute
