// Archive that writes a state and reads it back to the same bits, by one list of its parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "lib/record/record_error.hpp"

namespace twinchute {

/// Either writes or reads: whatever has a state names its parts to an archive, once and in one order, so that
/// both ways agree. A part is written as its kind, name, count and values, little endian. Reading throws
/// RecordError where another part follows than the one asked for. Values keep their bits, NaNs and zeros with
/// a sign among them.
class Archive {
public:
    /// Writes.
    Archive() = default;
    /// Reads `bytes`, which outlive it; `place` stands for them in messages.
    Archive(std::string_view bytes, std::string place)
        : reads_(true), bytes_(bytes), place_(std::move(place)) {}

    bool reads() const { return reads_; }
    /// Returns the bytes written so far.
    std::string take() { return std::move(written_); }
    /// Nothing is left to read.
    void end() const;

    void number(std::string_view name, double& value) { numbers(name, std::span(&value, 1)); }
    void number(std::string_view name, std::optional<double>& value);
    /// Numbers of a fixed count.
    void numbers(std::string_view name, std::span<double> values);
    /// Numbers of a list, which takes the length that was written. `max`: a longer one is refused.
    void numbers(std::string_view name, std::vector<double>& values,
                 std::size_t max = std::numeric_limits<std::size_t>::max());
    void text(std::string_view name, std::string& value);

    /// A whole number from `min` to `max`.
    template <class Integer>
    void whole(std::string_view name, Integer& value,
               std::type_identity_t<Integer> min = std::numeric_limits<Integer>::min(),
               std::type_identity_t<Integer> max = std::numeric_limits<Integer>::max()) {
        static_assert(std::is_integral_v<Integer>);
        const std::int64_t stored = integer(name, static_cast<std::int64_t>(value));
        if (!std::in_range<Integer>(stored) || static_cast<Integer>(stored) < min ||
            static_cast<Integer>(stored) > max)
            refuse_range(name);
        value = static_cast<Integer>(stored);
    }
    void flag(std::string_view name, bool& value) {
        int number = value ? 1 : 0;
        whole(name, number, 0, 1);
        value = number == 1;
    }
    /// One of an enumeration that begins with 0 and ends with `last`.
    template <class Enum>
    requires std::is_enum_v<Enum>
    void choice(std::string_view name, Enum& value, Enum last) {
        int number = static_cast<int>(value);
        whole(name, number, 0, static_cast<int>(last));
        value = static_cast<Enum>(number);
    }
    /// Length of a list whose rows follow. `max`: more are refused.
    template <class Row>
    void length(std::string_view name, std::vector<Row>& rows, std::size_t max) {
        std::size_t count = rows.size();
        whole(name, count, 0, max);
        if (!reads_) return;
        if (count > bytes_.size()) refuse_range(name);  // each row takes some
        rows.resize(count);
    }
    /// Small whole numbers, or enumerations, as bytes.
    template <class Small>
    void small(std::string_view name, std::vector<Small>& values) {
        static_assert(std::is_trivially_copyable_v<Small> && sizeof(Small) <= 2);
        std::string bytes;
        for (const Small value : values)
            for (std::size_t b = 0; b < sizeof(Small); ++b)
                bytes += static_cast<char>(static_cast<unsigned>(value) >> (8 * b));
        text(name, bytes);
        if (!reads_) return;
        if (bytes.size() % sizeof(Small) != 0) refuse_range(name);
        values.resize(bytes.size() / sizeof(Small));
        for (std::size_t i = 0; i < values.size(); ++i) {
            unsigned value = 0;
            for (std::size_t b = 0; b < sizeof(Small); ++b)
                value |= static_cast<unsigned>(static_cast<unsigned char>(bytes[i * sizeof(Small) + b]))
                         << (8 * b);
            values[i] = static_cast<Small>(value);
        }
    }

    /// The numbers of a struct: visit(row, each) calls each(x) for every double or vector of three of it.
    template <class Row, class Visit>
    void row(std::string_view name, Row& row, Visit&& visit) {
        std::vector<double> flat;
        gather(flat, row, visit);
        numbers(name, std::span(flat));
        scatter(flat.data(), row, visit);
    }
    /// The numbers of a list of structs, as row().
    template <class Row, class Visit>
    void rows(std::string_view name, std::vector<Row>& rows, Visit&& visit) {
        std::vector<double> flat;
        if (!reads_)
            for (Row& row : rows)
                gather(flat, row, visit);
        numbers(name, flat);
        if (!reads_) return;
        const std::size_t width = numbers_in<Row>(visit);
        if (width == 0 || flat.size() % width != 0) refuse_range(name);
        rows.resize(flat.size() / width);
        for (std::size_t i = 0; i < rows.size(); ++i)
            scatter(flat.data() + i * width, rows[i], visit);
    }

    /// A word by which what is read has to be of the same kind as what reads it. `problem`: what is wrong
    /// otherwise, e.g. "is of another mesh".
    void same(std::string_view name, const std::string& mine, const std::string& problem);

    /// Throws RecordError: what was read does not fit.
    [[noreturn]] void refuse(const std::string& problem, const std::string& why) const;

private:
    template <class Row, class Visit>
    static void gather(std::vector<double>& flat, Row& row, Visit& visit) {
        visit(row, [&](auto& x) {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(x)>, double>)
                flat.push_back(x);
            else
                for (int c = 0; c < 3; ++c)
                    flat.push_back(x[c]);
        });
    }
    template <class Row, class Visit>
    static std::size_t numbers_in(Visit& visit) {
        Row any{};
        std::size_t count = 0;
        visit(any,
              [&](auto& x) { count += std::is_same_v<std::remove_cvref_t<decltype(x)>, double> ? 1 : 3; });
        return count;
    }
    template <class Row, class Visit>
    static void scatter(const double* next, Row& row, Visit& visit) {
        visit(row, [&](auto& x) {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(x)>, double>)
                x = *next++;
            else
                for (int c = 0; c < 3; ++c)
                    x[c] = *next++;
        });
    }

    std::int64_t integer(std::string_view name, std::int64_t value);
    void write_head(char kind, std::string_view name, std::uint64_t count);
    /// How many there are of the part that comes next, which has to be this one.
    std::uint64_t read_head(char kind, std::string_view name, std::size_t bytes_each);
    std::string_view read_bytes(std::size_t count);
    [[noreturn]] void refuse_range(std::string_view name) const;

    bool reads_ = false;
    std::string written_;
    std::string_view bytes_;  // still to be read
    std::string place_;
};

}  // namespace twinchute
