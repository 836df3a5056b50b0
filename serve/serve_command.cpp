#include "serve/serve_command.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <system_error>

#include "lib/cli/interrupt.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "serve/api.hpp"

namespace twinchute::serve {
namespace {

namespace fs = std::filesystem;

int port_of(const Arguments& arguments) {
    const std::string text = arguments.value("port").value_or("0");
    int port = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, port);
    if (error != std::errc{} || rest != end || port < 0 || port > 65535)
        throw UsageError(
            fmt::format("'--port {}' is not understood (a number from 0 to 65535 is wanted), e.g. --port "
                        "8080, or 0 for any",
                        text));
    return port;
}

fs::path place_of(const Arguments& arguments, const OpenedScene& opened) {
    fs::path place = arguments.value("dir").value_or(opened.of_data ? "" : opened.directory.string());
    if (place.empty()) place = ".";
    std::error_code error;
    if (!fs::is_directory(place, error))
        throw UsageError(fmt::format("--dir {}: there is no such directory ({}), make it first",
                                     place.string(), error ? error.message() : "it is a file"));
    return place;
}

/// Nothing is fetched from elsewhere, and no other page may show this one.
std::multimap<std::string, std::string> headers() {
    return {{"Content-Security-Policy",
             "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; "
             "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
            {"Cache-Control", "no-store"},
            {"Cross-Origin-Resource-Policy", "same-origin"},
            {"Referrer-Policy", "no-referrer"},
            {"X-Content-Type-Options", "nosniff"},
            {"X-Frame-Options", "DENY"}};
}

ExitCode run_serve(const Models& models, const Arguments& arguments) {
    const int port = port_of(arguments);
    OpenedScene opened = opened_scene(arguments.operand);
    const fs::path place = place_of(arguments, opened);
    const Interrupt interrupt;  // until what went on is saved
    Api api(models, std::move(opened), place, interrupt.token());
    HttpService service;
    service.port = port;
    service.stop = interrupt.token();
    service.headers = headers();
    service.listening = [&](int its_port) {
        api.listen_on(its_port);
        print(fmt::format("http://127.0.0.1:{}/?token={}\n", its_port, api.token()));
        std::fflush(stdout);
    };
    service.refuse = [&](const HttpRequest& request) { return api.refuse(request); };
    service.answer = [&](const HttpRequest& request) { return api.answer(request); };
    serve_http(service);
    const std::vector<fs::path> saved = api.end();
    for (const fs::path& directory : saved)
        print(fmt::format("record    {}\n", printable(directory.string())));
    return saved.empty() ? ExitCode::done : ExitCode::interrupted;
}

}  // namespace

Command serve_command(const Fidelity& full, const Fidelity& rom) {
    Command command;
    command.name = "serve";
    command.summary = "a page to work in: change a scene, see its curves at once, run both models";
    command.operand = "[SCENE]";
    command.example = "twinchute serve data/scenes/c9-inflation.toml";
    command.options = {
        {"port", "N", "listen there on 127.0.0.1; 0, or nothing: any port that is free"},
        {"dir", "DIR",
         "scenes, and what Ctrl-C interrupts, are saved there; the scene's folder unless given"}};
    command.run = [models = Models{full, rom}](const Arguments& arguments) {
        return run_serve(models, arguments);
    };
    return command;
}

}  // namespace twinchute::serve
