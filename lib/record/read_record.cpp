#include "lib/record/read_record.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "lib/record/record_parts.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

// [bytes] Real summaries take some 30 kB and histories some MB: what is far beyond is no record of ours.
constexpr std::size_t largest_summary = 4u << 20, largest_history = 256u << 20, largest_events = 4u << 20,
                      largest_other = 256u << 20;

void require_size(std::string_view text, std::size_t largest, const std::string& file) {
    if (text.size() <= largest) return;
    throw RecordError({file}, "is too large", fmt::format("more than {} MiB", largest >> 20),
                      "is it a file of a record?");
}

std::string message(const RecordPlace& place, const std::string& problem, const std::string& why,
                    const std::string& suggestion) {
    std::string text = place.file;
    if (place.line > 0) text += fmt::format(":{}:{}", place.line, place.column);
    if (!text.empty()) text += ": ";
    text += problem;
    if (!why.empty()) text += " (" + why + ")";
    if (!suggestion.empty()) text += ", " + suggestion;
    return text;
}

}  // namespace

std::string read_record_file(const fs::path& file, std::size_t largest) {
    const auto refuse = [&](const std::string& problem, const std::string& why, const std::string& hint) {
        return RecordError({file.string()}, problem, why, hint);
    };
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) throw refuse("no such file", "the record is not whole", "run the scene again");
    if (!fs::is_regular_file(status)) throw refuse("is not a regular file", "", "run the scene again");
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    std::string text, chunk(1 << 16, '\0');
    do {
        stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
        text.append(chunk, 0, static_cast<std::size_t>(stream.gcount()));
    } while (stream && text.size() <= largest);
    if (stream.bad() || !stream.is_open())
        throw refuse("cannot be read", errno ? std::strerror(errno) : "", "check its permissions");
    require_size(text, largest, file.string());
    return text;
}

namespace {

struct Texts {
    std::string_view summary, history, events;
};

/// Reports a fault in a table with its line first, a checksum that does not match only after that.
RunRecord read_parts(const Texts& texts, const fs::path& directory, FilesBeside& beside) {
    const auto name = [&](const char* file) { return (directory / file).string(); };
    require_size(texts.summary, largest_summary, name("summary.json"));
    require_size(texts.history, largest_history, name("history.csv"));
    require_size(texts.events, largest_events, name("events.csv"));
    RunRecord record = read_summary(texts.summary, name("summary.json"), beside);
    record.channels = read_history(texts.history, name("history.csv"), beside.history_units);
    record.events = read_events(texts.events, name("events.csv"),
                                beside.history_units ? CsvHead::names : CsvHead::names_and_units);
    require_checksum(beside.checksums, "history.csv", texts.history, name("history.csv"));
    require_checksum(beside.checksums, "events.csv", texts.events, name("events.csv"));
    return record;
}

}  // namespace

RecordError::RecordError(RecordPlace place, const std::string& problem, const std::string& why,
                         const std::string& suggestion)
    : std::runtime_error(message(place, problem, why, suggestion)), place_(std::move(place)) {}

RunRecord read_record(const fs::path& directory) {
    std::error_code ignored;
    const fs::file_status status = fs::status(directory, ignored);
    if (!fs::exists(status))
        throw RecordError({directory.string()}, "no such directory", "", "check the path");
    if (!fs::is_directory(status))
        throw RecordError({directory.string()}, "is not a directory", "a record is one", "check the path");
    if (!fs::exists(fs::status(directory / "summary.json", ignored)))
        throw RecordError({directory.string()}, "is not a record", "there is no summary.json in it",
                          "name a directory that twinchute wrote");
    const std::string summary = read_record_file(directory / "summary.json", largest_summary),
                      history = read_record_file(directory / "history.csv", largest_history),
                      events = read_record_file(directory / "events.csv", largest_events);
    FilesBeside beside;
    RunRecord record = read_parts({summary, history, events}, directory, beside);
    for (const auto& [name, checksum] : beside.checksums) {
        if (name == "history.csv" || name == "events.csv") continue;  // read_parts has seen to them
        const fs::path file = directory / name;
        require_checksum(beside.checksums, name, read_record_file(file, largest_other), file.string());
    }
    return record;
}

RunRecord read_record_text(std::string_view summary, std::string_view history, std::string_view events,
                           const fs::path& directory) {
    FilesBeside beside;
    return read_parts({summary, history, events}, directory, beside);
}

}  // namespace twinchute
