// HTTP/1.1 on the loopback interface: reads requests within limits and hands them on; knows nothing of what
// is served.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

namespace twinchute::serve {

/// [bytes] that the body of a request may have.
inline constexpr std::size_t largest_body = 4u << 20;

struct HttpRequest {
    std::string method;  ///< in capitals
    std::string path;    ///< without the query, percent signs decoded
    std::multimap<std::string, std::string> query;
    std::multimap<std::string, std::string> headers;  ///< names in small letters
    std::string body;

    /// The one value of a header or a parameter; nothing where it is absent or given several times.
    std::optional<std::string> header(std::string_view name) const;
    std::optional<std::string> parameter(std::string_view name) const;
};

struct HttpAnswer {
    int status = 200;
    std::string body;
    std::string type = "application/json";
    std::multimap<std::string, std::string> headers = {};
};

struct HttpService {
    int port = 0;  ///< on 127.0.0.1; 0: any that is free
    /// Takes the port once connections are accepted.
    std::function<void(int port)> listening;
    /// Asked before the body of a request is read: an answer ends the request and its connection.
    std::function<std::optional<HttpAnswer>(const HttpRequest&)> refuse;
    /// Called by several threads at once, for requests that were not refused.
    std::function<HttpAnswer(const HttpRequest&)> answer;
    std::stop_token stop;
    std::multimap<std::string, std::string> headers = {};  ///< of every answer
};

/// Whether this build has an HTTP library.
bool has_http();

/// Answers requests until it is asked to stop, which takes a tenth of a second and as long as answers that
/// are being made take. Throws UsageError where the port cannot be had, or the library cannot be loaded.
void serve_http(const HttpService& service);

}  // namespace twinchute::serve
