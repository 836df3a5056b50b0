// Answers of the server: the page, and what the page asks for. Knows requests and answers, no sockets.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>

#include "serve/http.hpp"
#include "serve/runs.hpp"
#include "serve/scene_text.hpp"

namespace twinchute::serve {

class Api {
public:
    /// `place`: where scenes and interrupted runs are saved; there is such a directory. `stop`: ends runs of
    /// the reduced-order model.
    Api(const Models& models, OpenedScene opened, std::filesystem::path place, std::stop_token stop);

    const std::string& token() const { return token_; }
    /// Before the first request.
    void listen_on(int port) { port_ = port; }

    /// As HttpService: strangers, paths and methods that there are none of, a token that is absent or wrong.
    std::optional<HttpAnswer> refuse(const HttpRequest& request) const;
    /// To a request that is not refused. Throws nothing but for want of memory.
    HttpAnswer answer(const HttpRequest& request);

    /// Cancels runs that go on and saves what they have. Returns the directories. Throws WriteError.
    std::vector<std::filesystem::path> end();

private:
    struct Route;
    static const Route routes[];
    /// The route of a path, and the id of a run in it.
    struct Match;
    static std::optional<Match> match(const HttpRequest& request);

    HttpAnswer page(const HttpRequest&, const std::string&);
    HttpAnswer keys(const HttpRequest&, const std::string&);
    HttpAnswer scene(const HttpRequest&, const std::string&);
    HttpAnswer size(const HttpRequest& request, const std::string& id);
    HttpAnswer rom(const HttpRequest&, const std::string&);
    HttpAnswer full(const HttpRequest&, const std::string&);
    HttpAnswer compare(const HttpRequest&, const std::string&);
    HttpAnswer calibrate(const HttpRequest&, const std::string&);
    HttpAnswer campaign(const HttpRequest&, const std::string&);
    HttpAnswer save(const HttpRequest&, const std::string&);
    HttpAnswer runs(const HttpRequest&, const std::string&);
    HttpAnswer run(const HttpRequest&, const std::string& id);
    HttpAnswer cancel(const HttpRequest&, const std::string& id);
    HttpAnswer history(const HttpRequest&, const std::string& id);
    HttpAnswer table(const HttpRequest&, const std::string& id);
    HttpAnswer summary(const HttpRequest&, const std::string& id);
    HttpAnswer report(const HttpRequest&, const std::string& id);
    HttpAnswer frames(const HttpRequest&, const std::string& id);

    HttpAnswer start(RunKind kind, const HttpRequest& request);
    HttpAnswer begin(RunKind kind, Scene scene, study::StudyWork study);
    std::shared_ptr<BackgroundRun> found(const std::string& id) const;
    /// The record that `model` asks for.
    const RunRecord& record_of(const compare::Comparison& result, const HttpRequest& request) const;
    [[noreturn]] void refuse_without_result(const BackgroundRun& run) const;
    std::shared_ptr<const compare::Comparison> result_of(const std::string& id) const;
    std::shared_ptr<const study::StudyResult> study_of(const BackgroundRun& run) const;

    const Models models_;
    const OpenedScene opened_;
    const std::filesystem::path place_;
    const std::stop_token stop_;
    const std::string token_;
    const std::string page_;
    int port_ = 0;
    Runs runs_;
    std::mutex saving_;
    std::set<std::string> saved_;  // names in place_, by this server
};

}  // namespace twinchute::serve
