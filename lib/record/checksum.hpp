// Checksums in a record, by which a file that was cut short or edited is noticed.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace twinchute {

/// SHA-256 in lowercase hexadecimal digits by file name, e.g. "history.csv".
using FileChecksums = std::map<std::string, std::string>;

/// Throws RecordError when `checksums` names the file and its bytes differ. A record without checksums was
/// written by an earlier version and is read unchecked. `place`: the file as messages call it.
void require_checksum(const FileChecksums& checksums, const std::string& name, std::string_view bytes,
                      const std::string& place);

/// A JSON object with its own checksum: `text` with one more key, its last, "sha256". The value is the
/// SHA-256 of the whole result with these 64 digits left out.
std::string with_checksum(std::string text);

/// Throws RecordError unless `checksum`, the value under "sha256", is the one that `with_checksum` wrote.
/// `place`: the file as messages call it; `hint`: what to do about it.
void require_own_checksum(std::string_view text, const std::string& checksum, const std::string& place,
                          const std::string& hint = "run the scene again");

}  // namespace twinchute
