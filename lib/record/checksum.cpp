#include "lib/record/checksum.hpp"

#include <cassert>

#include "lib/math/sha256.hpp"
#include "lib/record/record_error.hpp"

namespace twinchute {

void require_checksum(const FileChecksums& checksums, const std::string& name, std::string_view bytes,
                      const std::string& place) {
    const auto checksum = checksums.find(name);
    if (checksum == checksums.end() || checksum->second == sha256_hex(bytes)) return;
    throw RecordError({place}, "is not the file that this record was written with",
                      "its SHA-256 is not the one in summary.json: it was edited or cut short",
                      "run the scene again");
}

std::string with_checksum(std::string text) {
    constexpr std::string_view end = "\n}\n", before = ",\n  \"sha256\": \"", after = "\"\n}\n";
    assert(text.ends_with(end));
    text.erase(text.size() - end.size());
    text += before;
    const std::size_t at = text.size();
    text += after;
    return text.insert(at, sha256_hex(text));
}

void require_own_checksum(std::string_view text, const std::string& checksum, const std::string& place,
                          const std::string& hint) {
    std::string rest(text);
    if (const std::size_t at = rest.rfind(checksum); at != rest.npos) rest.erase(at, checksum.size());
    if (sha256_hex(rest) == checksum) return;
    throw RecordError({place}, "is not the file that was written",
                      "its SHA-256 without the digits under \"sha256\" is not these digits: it was edited",
                      hint);
}

}  // namespace twinchute
