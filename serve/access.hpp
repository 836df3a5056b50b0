// Who may ask: whoever has the token, from the page itself or a program of this machine.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "serve/http.hpp"

namespace twinchute::serve {

/// 128 bits of the system's random numbers, as 32 digits.
std::string new_token();

/// Whether two texts are the same, in a time that does not tell where they differ.
bool is_same_secret(std::string_view one, std::string_view other);

/// {"error": {"message": ...}}; bytes that are not UTF-8 are replaced.
HttpAnswer error_answer(int status, std::string_view message);

/// Refuses what no page of this server asks for: another Host or Origin (a page of somebody else's, or a name
/// of somebody else's that leads here), a body of unknown length, too large, packed, or not JSON.
std::optional<HttpAnswer> refuse_stranger(const HttpRequest& request, int port);

}  // namespace twinchute::serve
