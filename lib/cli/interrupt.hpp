// Ctrl-C and SIGTERM as a stop token.
#pragma once

#include <stop_token>
#include <thread>

namespace twinchute {

/// While one of these lives, the first SIGINT and the first SIGTERM ask for a clean end through the token; a
/// second one of the same kind ends the process at once. One at a time.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    std::stop_token token() const { return source_.get_token(); }

private:
    int pipe_[2] = {-1, -1};
    std::stop_source source_;
    std::jthread watcher_;
};

}  // namespace twinchute
