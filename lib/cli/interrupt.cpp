#include "lib/cli/interrupt.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cassert>
#include <cerrno>
#include <csignal>
#include <system_error>

namespace twinchute {
namespace {

// request_stop() runs callbacks and takes locks, so a signal handler may not call it. The handler
// writes one byte into a pipe instead, and a thread that waits on the other end makes the request.
std::atomic<int> write_end{-1};
static_assert(std::atomic<int>::is_always_lock_free);  // what makes it safe inside a handler

extern "C" void on_signal(int) {
    const int saved = errno;
    const char byte = 's';
    [[maybe_unused]] const ssize_t written = ::write(write_end.load(), &byte, 1);
    errno = saved;
}

void handle(int signal, void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    // Only the first one is taken: whoever asks twice means it. SA_RESTART keeps file writes whole.
    action.sa_flags = SA_RESTART | (handler == SIG_DFL ? 0 : static_cast<int>(SA_RESETHAND));
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
}

}  // namespace

Interrupt::Interrupt() {
    assert(write_end.load() == -1 && "one Interrupt at a time");
    if (::pipe2(pipe_, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    write_end.store(pipe_[1]);
    watcher_ = std::jthread([read_end = pipe_[0], source = source_]() mutable {
        for (char byte = 0;;) {
            const ssize_t got = ::read(read_end, &byte, 1);
            if (got < 0 && errno == EINTR) continue;
            if (got != 1 || byte != 's') return;  // the destructor's goodbye
            source.request_stop();
        }
    });
    handle(SIGINT, on_signal);
    handle(SIGTERM, on_signal);
}

Interrupt::~Interrupt() {
    handle(SIGINT, SIG_DFL);
    handle(SIGTERM, SIG_DFL);
    const char goodbye = 'q';
    [[maybe_unused]] const ssize_t written = ::write(pipe_[1], &goodbye, 1);
    watcher_.join();
    write_end.store(-1);
    ::close(pipe_[0]);
    ::close(pipe_[1]);
}

}  // namespace twinchute
