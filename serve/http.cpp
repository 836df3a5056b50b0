#include "serve/http.hpp"

#include <fmt/format.h>

#include "lib/cli/command.hpp"
#include "lib/cli/loaded_library.hpp"

namespace twinchute::serve {
namespace {

std::optional<std::string> only(const std::multimap<std::string, std::string>& all, std::string_view name) {
    const auto [first, last] = all.equal_range(std::string(name));
    if (first == last || std::next(first) != last) return std::nullopt;
    return first->second;
}

}  // namespace

std::optional<std::string> HttpRequest::header(std::string_view name) const {
    return only(headers, name);
}

std::optional<std::string> HttpRequest::parameter(std::string_view name) const {
    return only(query, name);
}

#ifdef TWINCHUTE_HTTP

bool has_http() {
    return true;
}

void serve_http(const HttpService& service) {
    using Serve = void (*)(const HttpService&, std::string&);
    static const Serve serve = [] {
        const LoadedFunction loaded = load_function(TWINCHUTE_HTTP, "serve", "twinchute_serve_http");
        if (!loaded.function)
            throw UsageError(fmt::format(
                "{} cannot be loaded ({}), install twinchute-serve and libcpp-httplib0.11, or build again",
                TWINCHUTE_HTTP, loaded.complaint));
        return reinterpret_cast<Serve>(loaded.function);
    }();
    std::string complaint;
    serve(service, complaint);
    if (!complaint.empty())
        throw UsageError(fmt::format(
            "port {} cannot be had ({}), give another one, or none: --port 0 takes any that is free",
            service.port, complaint));
}

#else

bool has_http() {
    return false;
}

void serve_http(const HttpService&) {
    throw UsageError(
        "`twinchute serve` is not in this build (cpp-httplib was not found), install Debian's "
        "libcpp-httplib-dev and "
        "build again");
}

#endif

}  // namespace twinchute::serve
