// Tables of a record: first line names, second line units unless they are plain, then one line a row. Numbers
// are the shortest text that reads back to the same bits; a number that is not finite is an empty field.
#pragma once

#include <string>
#include <string_view>

#include "lib/record/run_record.hpp"

namespace twinchute {

/// Lines above the numbers.
enum class CsvHead { names_and_units, names };

/// The text of history.csv: one column a channel. Channels of different lengths are a programmer's mistake.
std::string history_csv(const RunRecord& record, CsvHead head = CsvHead::names_and_units);

/// The text of events.csv: name, time, altitude, speed.
std::string events_csv(const RunRecord& record, CsvHead head = CsvHead::names_and_units);

/// A unit as tables write it: "1" for none.
std::string unit_field(std::string_view unit);

/// One field, quoted when it has to be (RFC 4180).
std::string csv_field(std::string_view text);

}  // namespace twinchute
