// The fingerprint that a record carries of the scene it was made from.
#pragma once

#include <string>
#include <string_view>

namespace twinchute {

/// SHA-256 of `bytes` as 64 lowercase hexadecimal digits (FIPS 180-4, sections 5 and 6.2).
std::string sha256_hex(std::string_view bytes);

}  // namespace twinchute
