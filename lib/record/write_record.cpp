#include "lib/record/write_record.hpp"

#include "lib/math/sha256.hpp"
#include "lib/record/field_files.hpp"
#include "lib/record/record_json.hpp"

namespace twinchute {

void add_record(FileBatch& batch, const RunRecord& record, const std::filesystem::path& directory,
                const ShapeFrames& frames, CsvHead head) {
    remove_old_fields(batch, directory);
    FileChecksums checksums;
    const auto add = [&](const char* name, const std::string& text) {
        batch.add(directory / name, text);
        checksums[name] = sha256_hex(text);
    };
    add("history.csv", history_csv(record, head));
    add("events.csv", events_csv(record, head));
    if (frames.empty())
        batch.remove(directory / "frames.bin");
    else
        add("frames.bin", frames_bytes(frames));
    batch.add(directory / "summary.json", with_checksum(summary_json(record, checksums, head)),
              FileBatch::Kind::marker);
}

void write_record(const RunRecord& record, const std::filesystem::path& directory, const ShapeFrames& frames,
                  CsvHead head) {
    FileBatch batch;
    add_record(batch, record, directory, frames, head);
    batch.commit();
}

}  // namespace twinchute
