#include "lib/record/file_sums.hpp"

#include <cassert>

#include "lib/math/sha256.hpp"
#include "lib/record/record_error.hpp"

namespace twinchute {

void require_sum(const FileSums& sums, const std::string& name, std::string_view bytes,
                 const std::string& place) {
    const auto sum = sums.find(name);
    if (sum == sums.end() || sum->second == sha256_hex(bytes)) return;
    throw RecordError({place}, "is not the file that this record was written with",
                      "its SHA-256 is not the one in summary.json: it was edited or cut short",
                      "run the scene again");
}

std::string sealed(std::string text) {
    constexpr std::string_view end = "\n}\n", before = ",\n  \"sha256\": \"", after = "\"\n}\n";
    assert(text.ends_with(end));
    text.erase(text.size() - end.size());
    text += before;
    const std::size_t at = text.size();
    text += after;
    return text.insert(at, sha256_hex(text));
}

void require_seal(std::string_view text, const std::string& sum, const std::string& place,
                  const std::string& hint) {
    std::string rest(text);
    if (const std::size_t at = rest.rfind(sum); at != rest.npos) rest.erase(at, sum.size());
    if (sha256_hex(rest) == sum) return;
    throw RecordError({place}, "is not the file that was written",
                      "its SHA-256 without the digits under \"sha256\" is not these digits: it was edited",
                      hint);
}

}  // namespace twinchute
