// What a record says of its files, so that one that was cut short or edited is noticed.
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

/// A JSON object that vouches for itself: the text of `json_text` with one key more, its last, "sha256". Its
/// value is the SHA-256 of the whole sealed text with these 64 digits left out.
std::string sealed(std::string text);

/// Throws RecordError unless `sum`, what the text says under "sha256", is the one that `sealed` gave it.
/// `place`: the file as messages call it; `hint`: what to do about it.
void require_seal(std::string_view text, const std::string& sum, const std::string& place,
                  const std::string& hint = "run the scene again");

}  // namespace twinchute
