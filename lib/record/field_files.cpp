#include "lib/record/field_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <string_view>
#include <system_error>

namespace twinchute {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view frame_prefix = "frame-", frame_suffix = ".vtu";

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
    assert(frame.time && (entries_.empty() || *frame.time > entries_.back().time));
    std::string file = fmt::format("fields/{}{:06}{}", frame_prefix, entries_.size(), frame_suffix);
    batch_.add(directory_ / file, vtu_text(frame));
    entries_.push_back({*frame.time, std::move(file)});
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
