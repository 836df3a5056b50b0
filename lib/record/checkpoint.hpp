// A checkpoint: a file from which a run that was cut off goes on, and that refuses any other run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/record_error.hpp"

namespace twinchute {

/// Identity of the run that a checkpoint belongs to. A run goes on only from a checkpoint that agrees in all.
struct CheckpointOf {
    std::string program;   ///< version, commit, compiler and flags, as current_program says
    std::string fidelity;  ///< name of the model
    std::string scene;     ///< scene_digest

    bool operator==(const CheckpointOf&) const = default;
};

std::string current_program();

/// A frame of the fields that was written before the checkpoint, under the temporary name that it keeps until
/// the run has ended.
struct WrittenFrame {
    double time = 0.0;      ///< [s]
    std::string file;       ///< below the record's directory, once it is named
    std::string temporary;  ///< beside it, until then
    std::string sha256;

    bool operator==(const WrittenFrame&) const = default;
};

struct Checkpoint {
    CheckpointOf of;
    std::vector<WrittenFrame> frames;
    std::string state;  ///< of the run, as its fidelity keeps it

    bool operator==(const Checkpoint&) const = default;
};

/// The content of a checkpoint's file: parts by name, and the SHA-256 of all that.
std::string checkpoint_bytes(const Checkpoint& checkpoint);

/// Reads the content of a checkpoint back. `file` stands for it in messages. Throws RecordError for
/// everything that checkpoint_bytes does not write.
Checkpoint read_checkpoint_bytes(std::string_view bytes, const std::string& file);

/// Throws RecordError, which says in what they differ.
void require_same(const CheckpointOf& found, const CheckpointOf& wanted, const std::string& file);

/// "checkpoint.bin" in the directory of a record.
std::filesystem::path checkpoint_file(const std::filesystem::path& directory);
/// Whether the file begins as a checkpoint does.
bool is_checkpoint(const std::filesystem::path& file);

/// Nothing where there is none. Throws RecordError.
std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& directory);

}  // namespace twinchute
