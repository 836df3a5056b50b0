#include "lib/record/archive.hpp"

#include <fmt/format.h>

#include <bit>

namespace twinchute {
namespace {

constexpr char number_kind = 'd', whole_kind = 'i', text_kind = 't';
constexpr std::size_t word = 8;  // [bytes]

void put(std::string& bytes, std::uint64_t value) {
    char digits[word];
    for (std::size_t b = 0; b < word; ++b)
        digits[b] = static_cast<char>(value >> (8 * b));
    bytes.append(digits, word);
}

std::uint64_t get(const char* bytes) {
    std::uint64_t value = 0;
    for (std::size_t b = 0; b < word; ++b)
        value |= std::uint64_t{static_cast<unsigned char>(bytes[b])} << (8 * b);
    return value;
}

}  // namespace

void Archive::write_head(char kind, std::string_view name, std::uint64_t count) {
    written_ += kind;
    written_ += static_cast<char>(name.size());
    written_ += name;
    put(written_, count);
}

std::string_view Archive::read_bytes(std::size_t count) {
    if (count > bytes_.size()) refuse("ends too early", "a part of it is missing");
    const std::string_view bytes = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return bytes;
}

std::uint64_t Archive::read_head(char kind, std::string_view name, std::size_t bytes_each) {
    const std::string_view head = read_bytes(2);
    const std::string_view found = read_bytes(static_cast<unsigned char>(head[1]));
    if (head[0] != kind || found != name)
        refuse("does not hold what this version keeps",
               fmt::format("'{}' should come where something else does", name));
    const std::uint64_t count = get(read_bytes(word).data());
    if (count > bytes_.size() / bytes_each) refuse("ends too early", "a part of it is missing");
    return count;
}

void Archive::numbers(std::string_view name, std::span<double> values) {
    if (!reads_) {
        write_head(number_kind, name, values.size());
        for (const double value : values)
            put(written_, std::bit_cast<std::uint64_t>(value));
        return;
    }
    if (read_head(number_kind, name, word) != values.size())
        refuse("does not fit this run", fmt::format("'{}' is of another length", name));
    const std::string_view bytes = read_bytes(word * values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = std::bit_cast<double>(get(bytes.data() + word * i));
}

void Archive::numbers(std::string_view name, std::vector<double>& values, std::size_t max) {
    if (reads_) {
        const std::string_view here = bytes_;
        const std::uint64_t count = read_head(number_kind, name, word);
        if (count > max) refuse_range(name);
        bytes_ = here;
        values.resize(count);
    }
    numbers(name, std::span(values));
}

void Archive::number(std::string_view name, std::optional<double>& value) {
    std::vector<double> none_or_one;
    if (value) none_or_one.push_back(*value);
    numbers(name, none_or_one, 1);
    value.reset();
    if (!none_or_one.empty()) value = none_or_one.front();
}

void Archive::text(std::string_view name, std::string& value) {
    if (!reads_) {
        write_head(text_kind, name, value.size());
        written_ += value;
        return;
    }
    value = read_bytes(read_head(text_kind, name, 1));
}

std::int64_t Archive::integer(std::string_view name, std::int64_t value) {
    if (!reads_) {
        write_head(whole_kind, name, 1);
        put(written_, static_cast<std::uint64_t>(value));
        return value;
    }
    if (read_head(whole_kind, name, word) != 1) refuse_range(name);
    return static_cast<std::int64_t>(get(read_bytes(word).data()));
}

void Archive::same(std::string_view name, const std::string& mine, const std::string& problem) {
    std::string found = mine;
    text(name, found);
    if (found != mine)
        refuse(problem, fmt::format("{} '{}', here it is '{}'", name, found.substr(0, 200), mine));
}

void Archive::end() const {
    if (!bytes_.empty()) refuse("does not hold what this version keeps", "something is left over");
}

void Archive::refuse(const std::string& problem, const std::string& why) const {
    throw RecordError({place_}, problem, why, "run without --resume to begin from release");
}

void Archive::refuse_range(std::string_view name) const {
    refuse("holds what no run writes", fmt::format("'{}' is out of range", name));
}

}  // namespace twinchute
