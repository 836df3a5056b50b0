#include "lib/record/record_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

namespace twinchute {
namespace {

void append_number(std::string& text, double value) {
    if (std::isfinite(value)) fmt::format_to(std::back_inserter(text), "{}", value);
}

}  // namespace

std::string unit_field(std::string_view unit) {
    return unit.empty() ? "1" : csv_field(unit);  // what UDUNITS calls dimensionless
}

std::string csv_field(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

std::string history_csv(const RunRecord& record, CsvHead head) {
    const auto& channels = record.channels;
    std::string names, units;
    std::size_t rows = channels.empty() ? 0 : channels.front().values.size();
    for (std::size_t i = 0; i < channels.size(); ++i) {
        assert(channels[i].values.size() == rows);
        rows = std::min(rows, channels[i].values.size());
        const char* separator = i == 0 ? "" : ",";
        names += separator + csv_field(channels[i].name);
        units += separator + unit_field(channels[i].unit);
    }
    std::string text = names + '\n';
    if (head == CsvHead::names_and_units) text += units + '\n';
    text.reserve(text.size() + rows * channels.size() * 20);
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t i = 0; i < channels.size(); ++i) {
            if (i > 0) text += ',';
            append_number(text, channels[i].values[row]);
        }
        text += '\n';
    }
    return text;
}

std::string events_csv(const RunRecord& record, CsvHead head) {
    std::string text = "name,time,altitude,speed\n";
    if (head == CsvHead::names_and_units) text += "-,s,m,m/s\n";
    for (const Event& event : record.events) {
        text += csv_field(event.name);
        for (const double value : {event.time, event.altitude, event.speed}) {
            text += ',';
            append_number(text, value);
        }
        text += '\n';
    }
    return text;
}

}  // namespace twinchute
