#include "lib/record/field_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <string_view>
#include <system_error>

#include "lib/math/sha256.hpp"
#include "lib/record/record_parts.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view frame_prefix = "frame-", frame_suffix = ".vtu";

constexpr std::size_t largest_frame = std::size_t{1} << 30;  // [bytes]

/// A name that add() gives.
bool is_frame(std::string_view name) {
    if (!name.starts_with(frame_prefix) || !name.ends_with(frame_suffix)) return false;
    name.remove_prefix(frame_prefix.size());
    name.remove_suffix(frame_suffix.size());
    return name.size() >= 6 && name.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

FieldFiles::FieldFiles(FileBatch& batch, fs::path directory)
    : batch_(batch), directory_(std::move(directory)) {}

void FieldFiles::add(const VtuGrid& frame) {
    assert(frame.time);
    if (!entries_.empty() && *frame.time <= entries_.back().time) drop_all();
    std::string file = next_name();
    const std::string text = vtu_text(frame);
    const fs::path temporary = batch_.add(directory_ / file, text);
    if (computes_checksums_)
        written_.push_back({*frame.time, file, temporary.filename().string(), sha256_hex(text)});
    entries_.push_back({*frame.time, std::move(file)});
}

void FieldFiles::drop_all() {
    for (const PvdEntry& entry : entries_)
        batch_.drop(directory_ / entry.file);
    entries_.clear();
    written_.clear();
}

std::string FieldFiles::next_name() const {
    return fmt::format("fields/{}{:06}{}", frame_prefix, entries_.size(), frame_suffix);
}

std::vector<WrittenFrame> FieldFiles::written() {
    batch_.spare();
    return written_;
}

void FieldFiles::adopt(const std::vector<WrittenFrame>& frames) {
    for (const WrittenFrame& frame : frames) {
        const fs::path target = directory_ / frame.file, temporary = target.parent_path() / frame.temporary;
        const auto refuse = [&](const std::string& problem) {
            throw RecordError({target.string()}, problem, "the checkpoint says that it was written before",
                              "run without --resume to begin from release");
        };
        // Nothing but frames of its own is ever looked at.
        if (frame.file != next_name() || frame.temporary.find('/') != std::string::npos)
            refuse("is no frame of this run");
        std::error_code error;
        const bool is_named = !fs::exists(temporary, error);
        if (is_named && !fs::exists(target, error)) refuse("is missing");
        const std::string text = read_record_file(is_named ? target : temporary, largest_frame);
        if (sha256_hex(text) != frame.sha256) refuse("is not the frame that was written");
        WrittenFrame mine = frame;
        if (is_named)  // the run before was interrupted and gave all names
            mine.temporary = batch_.add(target, text).filename().string();
        else
            batch_.adopt(target, temporary);
        written_.push_back(std::move(mine));
        entries_.push_back({frame.time, frame.file});
    }
    batch_.spare();
}

void FieldFiles::finish() {
    if (!entries_.empty()) batch_.add(collection(), pvd_text(entries_));
}

void remove_old_fields(FileBatch& batch, const fs::path& directory) {
    batch.remove(directory / "fields.pvd");
    std::error_code error;
    for (fs::directory_iterator entry(directory / "fields", error), end; !error && entry != end;
         entry.increment(error)) {
        if (is_frame(entry->path().filename().string())) batch.remove(entry->path());
    }
}

}  // namespace twinchute
