#include "lib/record/vtu.hpp"

#include <fmt/format.h>

#include <bit>
#include <cassert>
#include <concepts>
#include <iterator>
#include <string_view>

namespace twinchute {
namespace {

template <class T>
constexpr std::string_view type_name = "UInt8";
template <>
constexpr std::string_view type_name<float> = "Float32";
template <>
constexpr std::string_view type_name<double> = "Float64";
template <>
constexpr std::string_view type_name<std::int32_t> = "Int32";
template <>
constexpr std::string_view type_name<std::int8_t> = "Int8";

/// Bytes as base64, three at a time as they come.
class Base64 {
public:
    explicit Base64(std::string& text) : text_(text) {}

    void add(std::uint8_t byte) {
        held_ = held_ << 8 | byte;
        if (++count_ == 3) flush(4);
    }

    /// The bytes that are left, padded with '='.
    void finish() {
        if (count_ == 0) return;
        const int missing = 3 - count_, digits = count_ + 1;
        held_ <<= 8 * missing;
        flush(digits);
        text_.append(static_cast<std::size_t>(missing), '=');
    }

private:
    void flush(int digits) {
        constexpr std::string_view alphabet =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (int k = 0; k < digits; ++k)
            text_ += alphabet[held_ >> (18 - 6 * k) & 63u];
        held_ = 0;
        count_ = 0;
    }

    std::string& text_;
    std::uint32_t held_ = 0;
    int count_ = 0;
};

template <std::unsigned_integral Bits>
void add_bits(Base64& out, Bits bits) {
    for (unsigned k = 0; k < sizeof(Bits); ++k)
        out.add(static_cast<std::uint8_t>(static_cast<std::uint64_t>(bits) >> (8 * k)));
}

void add_value(Base64& out, double value) {
    add_bits(out, std::bit_cast<std::uint64_t>(value));
}
void add_value(Base64& out, float value) {
    add_bits(out, std::bit_cast<std::uint32_t>(value));
}
void add_value(Base64& out, std::int32_t value) {
    add_bits(out, std::bit_cast<std::uint32_t>(value));
}
void add_value(Base64& out, std::int8_t value) {
    out.add(std::bit_cast<std::uint8_t>(value));
}
void add_value(Base64& out, VtuCell value) {
    out.add(static_cast<std::uint8_t>(value));
}

/// Escapes characters that a name may not hold inside quotes.
std::string escaped(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        switch (c) {
            case '&':
                safe += "&amp;";
                break;
            case '<':
                safe += "&lt;";
                break;
            case '"':
                safe += "&quot;";
                break;
            default:
                safe += c;
        }
    }
    return safe;
}

/// The number of bytes, then the bytes, as one run of base64.
template <class T>
void append_array(std::string& text, std::string_view name, std::string_view shape,
                  const std::vector<T>& values) {
    fmt::format_to(std::back_inserter(text),
                   "        <DataArray type=\"{}\" Name=\"{}\" {} format=\"binary\">\n", type_name<T>,
                   escaped(name), shape);
    Base64 out(text);
    add_bits(out, static_cast<std::uint64_t>(values.size() * sizeof(T)));
    for (const T value : values)
        add_value(out, value);
    out.finish();
    text += "\n        </DataArray>\n";
}

std::string components(int count) {
    return fmt::format("NumberOfComponents=\"{}\"", count);
}

void append_data(std::string& text, std::string_view element, const std::vector<VtuArray>& arrays,
                 [[maybe_unused]] std::size_t tuples) {
    fmt::format_to(std::back_inserter(text), "      <{}>\n", element);
    for (const VtuArray& array : arrays) {
        std::visit(
            [&](const auto& values) {
                assert(values.size() == tuples * static_cast<std::size_t>(array.components));
                append_array(text, array.name, components(array.components), values);
            },
            array.values);
    }
    fmt::format_to(std::back_inserter(text), "      </{}>\n", element);
}

std::string file_head(std::string_view type) {
    return fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n",
        type);
}

}  // namespace

void VtuGrid::add_cell(VtuCell shape, std::span<const std::int32_t> of_points) {
    connectivity.insert(connectivity.end(), of_points.begin(), of_points.end());
    offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
    cells.push_back(shape);
}

void VtuGrid::append(const VtuGrid& other) {
    const auto first = static_cast<std::int32_t>(points.size() / 3),
               cells_before = static_cast<std::int32_t>(connectivity.size());
    points.insert(points.end(), other.points.begin(), other.points.end());
    for (const std::int32_t point : other.connectivity)
        connectivity.push_back(first + point);
    for (const std::int32_t end : other.offsets)
        offsets.push_back(cells_before + end);
    cells.insert(cells.end(), other.cells.begin(), other.cells.end());
    const auto join = [](std::vector<VtuArray>& arrays, const std::vector<VtuArray>& more) {
        assert(arrays.size() == more.size());
        for (std::size_t k = 0; k < arrays.size(); ++k)
            std::visit(
                [&](auto& values) {
                    const auto& others = std::get<std::decay_t<decltype(values)>>(more[k].values);
                    values.insert(values.end(), others.begin(), others.end());
                },
                arrays[k].values);
    };
    join(point_data, other.point_data);
    join(cell_data, other.cell_data);
}

std::string vtu_text(const VtuGrid& grid) {
    assert(grid.note.find("--") == std::string::npos && "it would end the comment");
    const std::size_t points = grid.points.size() / 3;
    std::string text = file_head("UnstructuredGrid");
    const auto line = [&](const std::string& words) { text += words + '\n'; };
    if (!grid.note.empty()) line(fmt::format("  <!-- {} -->", grid.note));
    line("  <UnstructuredGrid>");
    if (grid.time) {
        line("    <FieldData>");
        append_array(text, "TimeValue", "NumberOfTuples=\"1\"", std::vector{*grid.time});
        line("    </FieldData>");
    }
    line(fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", points, grid.cells.size()));
    append_data(text, "PointData", grid.point_data, points);
    append_data(text, "CellData", grid.cell_data, grid.cells.size());
    line("      <Points>");
    append_array(text, "position_m", components(3), grid.points);
    line("      </Points>");
    line("      <Cells>");
    append_array(text, "connectivity", components(1), grid.connectivity);
    append_array(text, "offsets", components(1), grid.offsets);
    append_array(text, "types", components(1), grid.cells);
    line("      </Cells>");
    line("    </Piece>");
    line("  </UnstructuredGrid>");
    line("</VTKFile>");
    return text;
}

std::string pvd_text(std::span<const PvdEntry> entries) {
    std::string text = file_head("Collection") + "  <Collection>\n";
    for (const PvdEntry& entry : entries)
        fmt::format_to(std::back_inserter(text), "    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n",
                       entry.time, escaped(entry.file));
    return text + "  </Collection>\n</VTKFile>\n";
}

}  // namespace twinchute
