#include "serve/access.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <nlohmann/json.hpp>
#include <system_error>

#include "lib/record/record_json.hpp"

namespace twinchute::serve {
namespace {

/// The media type without its parameters.
std::string_view media_type(std::string_view text) {
    text = text.substr(0, text.find(';'));
    while (!text.empty() && text.back() == ' ')
        text.remove_suffix(1);
    return text;
}

std::optional<HttpAnswer> refuse_body(const HttpRequest& request) {
    if (request.headers.contains("transfer-encoding"))
        return error_answer(411,
                            "the length of the body is not said (it comes in chunks), give Content-Length");
    if (request.headers.contains("content-encoding"))
        return error_answer(415,
                            "the body is packed (only plain JSON is read), send it without Content-Encoding");
    const std::optional<std::string> length = request.header("content-length");
    std::size_t bytes = 0;
    if (length) {
        const char* const end = length->data() + length->size();
        const auto [rest, error] = std::from_chars(length->data(), end, bytes);
        if (error == std::errc::result_out_of_range)
            bytes = largest_body + 1;
        else if (error != std::errc{} || rest != end)
            return error_answer(400, "Content-Length is no number, give that of the bytes of the body");
    } else if (request.headers.contains("content-length")) {
        return error_answer(400, "Content-Length is given several times, give it once");
    }
    if (request.method != "POST") {
        if (bytes > 0)
            return error_answer(400,
                                fmt::format("{} has a body (none is read), leave it out", request.method));
        return std::nullopt;
    }
    if (!length) return error_answer(411, "the length of the body is not said, give Content-Length");
    if (media_type(request.header("content-type").value_or("")) != "application/json")
        return error_answer(415, "the body is not JSON, send it with Content-Type: application/json");
    if (bytes > largest_body)
        return error_answer(
            413, fmt::format("the body is too large (more than {} MiB), is it a scene?", largest_body >> 20));
    return std::nullopt;
}

}  // namespace

std::string new_token() {
    std::array<unsigned char, 16> bytes{};
    for (std::size_t have = 0; have < bytes.size();) {
        const ssize_t got = ::getrandom(bytes.data() + have, bytes.size() - have, 0);
        if (got < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "getrandom");
        if (got > 0) have += static_cast<std::size_t>(got);
    }
    return fmt::format("{:02x}", fmt::join(bytes, ""));
}

bool is_same_secret(std::string_view one, std::string_view other) {
    unsigned differ = one.size() == other.size() ? 0u : 1u;
    for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i)
        differ |=
            static_cast<unsigned>(static_cast<unsigned char>(one[i]) ^ static_cast<unsigned char>(other[i]));
    return differ == 0;
}

HttpAnswer error_answer(int status, std::string_view message) {
    return {status, json_text({{"error", {{"message", message}}}})};
}

std::optional<HttpAnswer> refuse_stranger(const HttpRequest& request, int port) {
    const std::array<std::string, 2> hosts{fmt::format("127.0.0.1:{}", port),
                                           fmt::format("localhost:{}", port)};
    const std::optional<std::string> host = request.header("host");
    if (!host || std::ranges::count(hosts, *host) == 0)
        return error_answer(403, fmt::format("the host is not this one, ask for http://{}/", hosts.front()));
    if (request.headers.contains("origin") && request.header("origin") != "http://" + *host)
        return error_answer(
            403, "the page that asks is not of this server, open the address that twinchute printed");
    if (request.headers.contains("sec-fetch-site")) {
        const std::string site = request.header("sec-fetch-site").value_or("");
        if (site != "same-origin" && site != "none")
            return error_answer(403, "another site asks, open the address that twinchute printed");
    }
    return refuse_body(request);
}

}  // namespace twinchute::serve
