#include "serve/api.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "compare/report/gap_json.hpp"
#include "compare/report/html.hpp"
#include "lib/cli/command.hpp"
#include "lib/cli/list_command.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/solve/hand_over.hpp"
#include "serve/access.hpp"
#include "serve/page_files.hpp"
#include "serve/studies.hpp"
#include "study/size/size_command.hpp"

namespace twinchute::serve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Ends a request with a complaint.
struct Refusal {
    HttpAnswer answer;
    Refusal(int status, std::string_view message) : answer(error_answer(status, message)) {}
};

HttpAnswer scene_error(const SceneError& error) {
    const SourcePlace& place = error.place();
    Json json{{"message", error.what()}, {"file", place.file}};
    if (place.line > 0) {
        json["line"] = place.line;
        json["column"] = place.column;
    }
    if (!error.key().empty()) json["key"] = error.key();
    return {422, json_text({{"error", std::move(json)}})};
}

void add_numbers(std::string& text, const std::vector<double>& values) {
    text += '[';
    for (const double value : values) {
        if (text.back() != '[') text += ',';
        if (std::isfinite(value))
            fmt::format_to(std::back_inserter(text), "{}", value);
        else
            text += "null";
    }
    text += ']';
}

/// {"time": [...], ...}, and the units of the channels: by hand, since it is most of what is sent.
std::string history_json(const RunRecord& record) {
    std::string text = "\"history\": {", units = "\"units\": {";
    for (const Channel& channel : record.channels) {
        const char* const comma = &channel == &record.channels.front() ? "" : ", ";
        text += fmt::format("{}\"{}\": ", comma, channel.name);
        add_numbers(text, channel.values);
        units += fmt::format("{}\"{}\": \"{}\"", comma, channel.name, channel.unit);
    }
    return text + "}, " + units + "}";
}

std::string rows_json(const BackgroundRun::Rows& rows) {
    std::string text = "{\"time\": ";
    add_numbers(text, rows.time);
    text += ", \"force\": ";
    add_numbers(text, rows.force);
    text += ", \"speed\": ";
    add_numbers(text, rows.speed);
    return text + "}";
}

std::string string_json(std::string_view text) {
    return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

HttpAnswer download(std::string body, std::string type, std::string_view name) {
    HttpAnswer answer{200, std::move(body), std::move(type)};
    answer.headers.emplace("Content-Disposition", fmt::format("attachment; filename=\"{}\"", name));
    return answer;
}

}  // namespace

struct Api::Route {
    std::string_view method, path;  ///< ID stands for that of a run
    HttpAnswer (Api::*answer)(const HttpRequest&, const std::string& id);
    bool opened = false;  ///< in the address bar of a browser, with the token in the query
};

constexpr Api::Route Api::routes[] = {
    {"GET", "/", &Api::page, true},
    {"GET", "/api/keys", &Api::keys},
    {"GET", "/api/scene", &Api::scene},
    {"POST", "/api/rom", &Api::rom},
    {"POST", "/api/size", &Api::size},
    {"POST", "/api/full", &Api::full},
    {"POST", "/api/compare", &Api::compare},
    {"POST", "/api/calibrate", &Api::calibrate},
    {"POST", "/api/campaign", &Api::campaign},
    {"POST", "/api/save", &Api::save},
    {"GET", "/api/runs", &Api::runs},
    {"GET", "/api/runs/ID", &Api::run},
    {"DELETE", "/api/runs/ID", &Api::cancel},
    {"GET", "/api/runs/ID/history", &Api::history},
    {"GET", "/api/runs/ID/history.csv", &Api::table, true},
    {"GET", "/api/runs/ID/summary", &Api::summary, true},
    {"GET", "/api/runs/ID/report", &Api::report, true},
    {"GET", "/api/runs/ID/frames", &Api::frames},
};

struct Api::Match {
    const Route* route;  ///< null: the path has no such method
    std::string id, methods;
};

std::optional<Api::Match> Api::match(const HttpRequest& request) {
    constexpr std::string_view runs = "/api/runs/";
    Match match{nullptr, "", ""};
    std::string path = request.path;
    if (path.starts_with(runs)) {
        const std::size_t end = std::min(path.find('/', runs.size()), path.size());
        match.id = path.substr(runs.size(), end - runs.size());
        path.replace(runs.size(), match.id.size(), "ID");
    }
    for (const Route& route : routes) {
        if (route.path != path) continue;
        if (route.method == request.method) match.route = &route;
        match.methods += fmt::format("{}{}", match.methods.empty() ? "" : ", ", route.method);
    }
    if (match.methods.empty()) return std::nullopt;
    return match;
}

Api::Api(const Models& models, OpenedScene opened, fs::path place, std::stop_token stop)
    : models_(models),
      opened_(std::move(opened)),
      place_(std::move(place)),
      stop_(std::move(stop)),
      token_(new_token()),
      page_(page_html()),
      runs_(models) {}

std::optional<HttpAnswer> Api::refuse(const HttpRequest& request) const {
    if (std::optional<HttpAnswer> stranger = refuse_stranger(request, port_)) return stranger;
    const std::optional<Match> match = Api::match(request);
    if (!match) return error_answer(404, "there is no such address, open the one that twinchute printed");
    if (!match->route) {
        HttpAnswer answer =
            error_answer(405, fmt::format("this address has no such method, use {}", match->methods));
        answer.headers.emplace("Allow", match->methods);
        return answer;
    }
    const std::optional<std::string> token =
        match->route->opened && !request.headers.contains("x-twinchute-token")
            ? request.parameter("token")
            : request.header("x-twinchute-token");
    if (token && is_same_secret(*token, token_)) return std::nullopt;
    constexpr std::string_view problem =
        "the token is absent or wrong, open the address that twinchute printed";
    if (request.path == "/") return HttpAnswer{403, fmt::format("{}\n", problem), "text/plain"};
    return error_answer(403, problem);
}

HttpAnswer Api::answer(const HttpRequest& request) {
    const std::optional<Match> match = Api::match(request);
    try {
        return (this->*match.value().route->answer)(request, match->id);
    } catch (const Refusal& refusal) {
        return refusal.answer;
    } catch (const SceneError& error) {
        return scene_error(error);
    } catch (const UsageError& error) {
        return error_answer(422, error.what());
    } catch (const BadBody& error) {
        return error_answer(400, error.what());
    } catch (const std::exception& error) {
        return error_answer(500, error.what());
    }
}

HttpAnswer Api::page(const HttpRequest&, const std::string&) {
    return {200, page_, "text/html; charset=utf-8"};
}

HttpAnswer Api::keys(const HttpRequest&, const std::string&) {
    return {200, keys_json()};
}

HttpAnswer Api::scene(const HttpRequest&, const std::string&) {
    return {200, json_text({{"file", opened_.file}, {"text", opened_.text()}})};
}

HttpAnswer Api::rom(const HttpRequest& request, const std::string&) {
    const ReadScene one = read(scene_request(request.body), opened_);
    const std::array<const Fidelity*, 2> both{&models_.full, &models_.rom};
    require_physics(one.scene, models_.rom, both);
    Run run;
    run.stop = stop_;
    const RunRecord record = run_scene(models_.rom, one.scene, run, both);
    return {200, fmt::format("{{\"summary\": {}, {}, \"cases\": {}}}\n", summary_json(record),
                             history_json(record), Json(one.cases).dump())};
}

HttpAnswer Api::size(const HttpRequest& request, const std::string&) {
    const ReadScene one = read(scene_request(request.body), opened_);
    try {
        return {200, json_text(study::sized_json(one.scene, stop_))};
    } catch (const rom::Interrupted&) {
        throw Refusal(503, "the server ends (half a search says nothing), start it again");
    }
}

HttpAnswer Api::start(RunKind kind, const HttpRequest& request) {
    ReadScene one = read(scene_request(request.body), opened_);
    const std::array<const Fidelity*, 2> both{&models_.full, &models_.rom};
    for (const Fidelity* fidelity : both)
        if (kind == RunKind::compare || fidelity == &models_.full)
            require_physics(one.scene, *fidelity, both);
    if (one.scene.full.fields_rate)
        throw UsageError(
            fmt::format("{}: full.fields_rate: there is no directory for the fields (a run of the page keeps "
                        "what it computes), "
                        "take it out, or run `twinchute {}`",
                        opened_.file, kind_name(kind)));
    return begin(kind, std::move(one.scene), {});
}

HttpAnswer Api::begin(RunKind kind, Scene scene, study::StudyWork study) {
    const auto run = runs_.start(kind, std::move(scene), std::move(study));
    if (!run)
        throw Refusal(429,
                      fmt::format("{} runs go on already (no more may), wait for one of them or cancel it",
                                  Runs::most_active));
    return {202, json_text({{"id", run->id()}})};
}

HttpAnswer Api::full(const HttpRequest& request, const std::string&) {
    return start(RunKind::full, request);
}

HttpAnswer Api::compare(const HttpRequest& request, const std::string&) {
    return start(RunKind::compare, request);
}

HttpAnswer Api::calibrate(const HttpRequest& request, const std::string&) {
    AskedStudy asked = asked_calibration(request.body, opened_, models_, place_);
    return begin(RunKind::calibrate, std::move(asked.scene), std::move(asked.work));
}

HttpAnswer Api::campaign(const HttpRequest& request, const std::string&) {
    AskedStudy asked = asked_campaign(request.body, opened_, models_);
    return begin(RunKind::campaign, std::move(asked.scene), std::move(asked.work));
}

HttpAnswer Api::save(const HttpRequest& request, const std::string&) {
    const nlohmann::json object = object_of(request.body, {"name", "text", "overwrite"});
    const auto is_text = [&](const char* key) { return object.contains(key) && object[key].is_string(); };
    if (!is_text("name") || !is_text("text") ||
        (object.contains("overwrite") && !object["overwrite"].is_boolean()))
        throw BadBody("a scene is saved by its name and text, send {\"name\": \"x.toml\", \"text\": ...}");
    const std::string name = object["name"];
    constexpr std::string_view extension = ".toml";
    const std::string stem = name.ends_with(extension) ? name.substr(0, name.size() - extension.size()) : "";
    if (stem.empty() || file_stem_of(stem) != stem)
        throw Refusal(
            422,
            fmt::format("'{}' is no name for a scene (letters, digits, '-', '_' and '.', ending in .toml), "
                        "e.g. {}.toml",
                        name, file_stem_of(stem.empty() ? name : stem)));
    const fs::path target = (place_ / name).lexically_normal();
    const std::lock_guard guard(saving_);
    std::error_code error;
    if (fs::exists(fs::symlink_status(target, error)) && !saved_.contains(name)) {
        const bool is_opened = !opened_.of_data && fs::equivalent(target, opened_.file, error);
        const bool may = is_opened && object.value("overwrite", false) && !fs::is_symlink(target, error);
        if (!may)
            throw Refusal(
                409,
                is_opened
                    ? fmt::format("{} is the scene that is open, say \"overwrite\": true", name)
                    : fmt::format("{} is there already (and not by this server), choose another name", name));
    }
    replace_file(target, object["text"].get_ref<const std::string&>());
    saved_.insert(name);
    return {200, json_text({{"file", target.string()}})};
}

std::shared_ptr<BackgroundRun> Api::found(const std::string& id) const {
    auto run = runs_.find(id);
    if (!run)
        throw Refusal(
            404, fmt::format("there is no run of that id (the last {} that ended are kept), start it again",
                             Runs::most_ended));
    run->asked();
    return run;
}

void Api::refuse_without_result(const BackgroundRun& run) const {
    throw Refusal(409, run.state() == RunState::running ? "the run goes on, ask again when it has ended"
                                                        : "the run came to nothing, see its error");
}

std::shared_ptr<const compare::Comparison> Api::result_of(const std::string& id) const {
    const auto run = found(id);
    if (is_study(run->kind())) throw Refusal(404, "a study has no history and no shapes, see its report");
    auto result = run->result();
    if (!result) refuse_without_result(*run);
    return result;
}

std::shared_ptr<const study::StudyResult> Api::study_of(const BackgroundRun& run) const {
    auto result = run.study_result();
    if (!result) refuse_without_result(run);
    return result;
}

HttpAnswer Api::runs(const HttpRequest&, const std::string&) {
    Json json = Json::array();
    for (const auto& run : runs_.all()) {
        const BackgroundRun::Status status = run->status();
        json.push_back({{"id", run->id()},
                        {"kind", kind_name(run->kind())},
                        {"state", state_name(status.state)},
                        {"share", status.share},
                        {"scene", run->scene().name}});
    }
    return {200, json_text(json)};
}

HttpAnswer Api::run(const HttpRequest& request, const std::string& id) {
    const auto run = found(id);
    std::size_t first = 0;
    if (const auto from = request.parameter("from"))
        std::from_chars(from->data(), from->data() + from->size(), first);
    // The result first: a status from after it is as new.
    const auto result = run->result();
    const auto study = run->study_result();
    const BackgroundRun::Status status = run->status(first);
    const bool both = run->kind() == RunKind::compare;
    std::string text = fmt::format(
        "{{\"id\": \"{}\", \"kind\": \"{}\", \"scene\": {}, \"state\": \"{}\", \"stage\": {}, \"time\": {}, "
        "\"share\": {}, "
        "\"rows\": {}, \"error\": {}",
        id, kind_name(run->kind()), string_json(run->scene().name), state_name(status.state),
        string_json(status.stage), Json(status.time).dump(), Json(status.share).dump(),
        rows_json(status.rows), status.error.empty() ? "null" : string_json(status.error));
    text += fmt::format(", \"summary\": {}", result ? summary_json(result->reference) : "null");
    text += fmt::format(", \"rom_summary\": {}", result && both ? summary_json(result->candidate) : "null");
    text += fmt::format(", \"gap\": {}", result && both ? compare::gap_json(*result) : "null");
    text += fmt::format(", \"study\": {}, \"scene_text\": {}", study ? study->json : "null",
                        study && !study->scene_text.empty() ? string_json(study->scene_text) : "null");
    return {200, text + "}\n"};
}

HttpAnswer Api::cancel(const HttpRequest&, const std::string& id) {
    found(id)->cancel();
    return {200, json_text({{"id", id}})};
}

const RunRecord& Api::record_of(const compare::Comparison& result, const HttpRequest& request) const {
    const std::string model = request.parameter("model").value_or("full");
    if (model != "rom" && model != "full")
        throw Refusal(400, "there is no such model, ask for model=rom or model=full");
    const bool of_rom = model == "rom";
    if (of_rom && result.candidate.channels.empty())
        throw Refusal(404, "the run is of the full model alone, ask without model=rom");
    return of_rom ? result.candidate : result.reference;
}

HttpAnswer Api::history(const HttpRequest& request, const std::string& id) {
    const auto result = result_of(id);
    return {200, fmt::format("{{{}}}\n", history_json(record_of(*result, request)))};
}

HttpAnswer Api::table(const HttpRequest& request, const std::string& id) {
    const auto result = result_of(id);
    return download(history_csv(record_of(*result, request)), "text/csv; charset=utf-8", "history.csv");
}

HttpAnswer Api::summary(const HttpRequest&, const std::string& id) {
    const auto run = found(id);
    return download(is_study(run->kind()) ? study_of(*run)->json : summary_json(result_of(id)->reference),
                    "application/json", summary_name(run->kind()));
}

HttpAnswer Api::report(const HttpRequest&, const std::string& id) {
    constexpr const char* html = "text/html; charset=utf-8";
    const auto run = found(id);
    if (is_study(run->kind())) return {200, study_of(*run)->page, html};
    const auto result = result_of(id);
    const bool both = run->kind() == RunKind::compare;
    return {200,
            both
                ? compare::report_html(*result)
                : compare::record_html(result->reference, result->reference_frames, models_.full.title, true),
            html};
}

HttpAnswer Api::frames(const HttpRequest&, const std::string& id) {
    return {200, found(id)->frames(), "application/octet-stream"};
}

std::vector<fs::path> Api::end() {
    std::vector<fs::path> directories;
    for (const auto& run : runs_.end())
        if (const auto directory = save_run(*run, place_)) directories.push_back(*directory);
    return directories;
}

}  // namespace twinchute::serve
