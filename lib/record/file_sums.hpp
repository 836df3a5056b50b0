// What a record says of the files beside its summary, so that one that was cut short or edited is noticed.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace twinchute {

/// SHA-256 in lowercase hexadecimal digits by file name, e.g. "history.csv".
using FileSums = std::map<std::string, std::string>;

/// Throws RecordError when `sums` names the file and its bytes are others. A record without sums was written
/// by an earlier version and is taken as it is. `place`: the file as messages call it.
void require_sum(const FileSums& sums, const std::string& name, std::string_view bytes,
                 const std::string& place);

}  // namespace twinchute
