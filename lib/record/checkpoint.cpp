#include "lib/record/checkpoint.hpp"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "lib/math/sha256.hpp"
#include "lib/record/archive.hpp"
#include "lib/record/build_info.hpp"
#include "lib/record/record_parts.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

// The number goes up with what the parts below mean; what a fidelity keeps is told apart by the program.
constexpr std::string_view checkpoint_magic = "twinchute checkpoint 1\n";
constexpr std::size_t hash_digits = 64;
constexpr std::size_t max_field_frames = 10'000'000;
constexpr std::size_t largest = std::size_t{4} << 30;  // [bytes]: a hundred times what the finest meshes take

void serialize(Archive& archive, Checkpoint& c) {
    archive.text("program", c.of.program);
    archive.text("fidelity", c.of.fidelity);
    archive.text("scene", c.of.scene);
    archive.length("frames", c.frames, max_field_frames);
    for (WrittenFrame& frame : c.frames) {
        auto& [time, file, temporary, sha256] = frame;
        archive.number("time", time);
        archive.text("file", file);
        archive.text("temporary", temporary);
        archive.text("sha256", sha256);
    }
    archive.text("state", c.state);
}

[[noreturn]] void refuse(const std::string& file, const std::string& problem, const std::string& why) {
    throw RecordError({file}, problem, why, "run without --resume to begin from release");
}

}  // namespace

std::string current_program() {
    const BuildInfo build = build_info();
    return fmt::format("{} ({}), {}, {}", build.version, build.commit, build.compiler, build.flags);
}

std::string checkpoint_bytes(const Checkpoint& checkpoint) {
    Checkpoint copy = checkpoint;
    Archive archive;
    serialize(archive, copy);
    std::string bytes = std::string(checkpoint_magic) + archive.take();
    return bytes + sha256_hex(bytes);
}

Checkpoint read_checkpoint_bytes(std::string_view bytes, const std::string& file) {
    if (!bytes.starts_with(checkpoint_magic.substr(0, bytes.size())) || bytes.empty())
        refuse(file, "is no checkpoint of this version", "it begins otherwise");
    if (bytes.size() < checkpoint_magic.size() + hash_digits)
        refuse(file, "ends too early", "a part of it is missing");
    const std::string_view rest = bytes.substr(0, bytes.size() - hash_digits);
    if (sha256_hex(rest) != bytes.substr(rest.size()))
        refuse(file, "is not the checkpoint that was written",
               "its SHA-256 is not the one at its end: it was cut short or changed");
    Archive archive(rest.substr(checkpoint_magic.size()), file);
    Checkpoint checkpoint;
    serialize(archive, checkpoint);
    archive.end();
    return checkpoint;
}

void require_same(const CheckpointOf& found, const CheckpointOf& wanted, const std::string& file) {
    if (found.program != wanted.program)
        refuse(file, "is of another version of this program",
               fmt::format("written by {}, this is {}", found.program.substr(0, 300), wanted.program));
    if (found.fidelity != wanted.fidelity)
        refuse(file, "is of another model",
               fmt::format("of '{}', this is '{}'", found.fidelity.substr(0, 40), wanted.fidelity));
    if (found.scene != wanted.scene)
        refuse(file, "is of another scene",
               "a key of the scene, or a table or material that it names, has changed since");
}

fs::path checkpoint_file(const fs::path& directory) {
    return directory / "checkpoint.bin";
}

bool is_checkpoint(const fs::path& file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return false;  // a pipe would be waited for
    std::ifstream stream(file, std::ios::binary);
    std::string begin(checkpoint_magic.size(), '\0');
    return stream.read(begin.data(), static_cast<std::streamsize>(begin.size())) && begin == checkpoint_magic;
}

std::optional<Checkpoint> read_checkpoint(const fs::path& directory) {
    const fs::path file = checkpoint_file(directory);
    std::error_code error;
    if (!fs::exists(fs::symlink_status(file, error))) return {};
    return read_checkpoint_bytes(read_record_file(file, largest), file.string());
}

}  // namespace twinchute
