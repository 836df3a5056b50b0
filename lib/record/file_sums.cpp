#include "lib/record/file_sums.hpp"

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

}  // namespace twinchute
