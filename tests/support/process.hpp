// Runs a program as a shell would and waits for it: exit code, standard output, standard error.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/scratch_dir.hpp"

namespace twinchute::test {

struct Ended {
    int code = -1;  ///< exit code, or 128 + signal as a shell reports it
    std::string out, err;
};

class Process {
public:
    /// Starts `words[0]` in `directory`. Standard output is kept, or goes to `device` when one is given.
    /// `prepare` runs in the child just before the program does, and may refuse to go on.
    Process(const std::vector<std::string>& words, const std::filesystem::path& directory,
            const std::string& device = {}, const std::function<bool()>& prepare = {})
        : device_(device) {
        std::vector<char*> arguments;
        for (const std::string& word : words)
            arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        const std::string out = device_.empty() ? (log_ / "out").string() : device_;
        const std::string err = (log_ / "err").string();
        pid_ = ::fork();
        if (pid_ < 0) throw std::runtime_error("fork failed");
        if (pid_ > 0) return;
        const auto redirect = [](const std::string& file, int to, int flags) {
            const int fd = ::open(file.c_str(), flags, 0600);
            return fd >= 0 && ::dup2(fd, to) >= 0;
        };
        const bool ready = ::chdir(directory.c_str()) == 0 && redirect("/dev/null", 0, O_RDONLY) &&
                           redirect(out, 1, O_WRONLY | O_CREAT) && redirect(err, 2, O_WRONLY | O_CREAT) &&
                           (!prepare || prepare());
        if (ready) ::execv(arguments[0], arguments.data());
        ::_exit(127);
    }
    ~Process() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            ::waitpid(pid_, nullptr, 0);
        }
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// Waits until the process handles a signal itself, or no longer does. False if it ended before.
    bool wait_until_handled(int signal, bool handled = true) {
        const std::string status = "/proc/" + std::to_string(pid_) + "/status";
        for (;;) {
            siginfo_t ended{};
            ::waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT);
            if (ended.si_pid != 0) return false;
            std::ifstream lines(status);
            for (std::string line; std::getline(lines, line);) {
                if (!line.starts_with("SigCgt:")) continue;
                const unsigned long long caught = std::stoull(line.substr(7), nullptr, 16);
                if (((caught >> (signal - 1)) & 1) == handled) return true;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    }

    /// Waits until the process handles a signal itself, then sends it. False if it ended before.
    bool send_when_handled(int signal) { return wait_until_handled(signal) && ::kill(pid_, signal) == 0; }

    pid_t id() const { return pid_; }

    Ended wait() {
        int status = 0;
        ::waitpid(pid_, &status, 0);
        pid_ = -1;
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        return {code, device_.empty() ? content_of(log_ / "out") : "", content_of(log_ / "err")};
    }

private:
    ScratchDir log_;
    std::string device_;
    pid_t pid_ = -1;
};

}  // namespace twinchute::test
