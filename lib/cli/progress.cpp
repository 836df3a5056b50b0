#include "lib/cli/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace twinchute {
namespace {

constexpr auto interval = std::chrono::milliseconds(100);  // faster than this nobody reads

std::string duration(double seconds) {
    const auto whole = static_cast<long>(std::ceil(std::min(seconds, 1e7)));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

/// Characters that fit on a line without wrapping; a wrapped line could not be erased.
std::size_t line_width() {
    winsize size{};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < 2) return 79;
    return size.ws_col - 1u;
}

}  // namespace

std::string progress_text(std::string_view fidelity, const Progress& progress, double elapsed,
                          double before) {
    const double share = std::clamp(std::isfinite(progress.share) ? progress.share : 0.0, 0.0, 1.0);
    std::string text = fmt::format("{} {:<12}", fidelity, progress.stage);
    if (!std::isnan(progress.time)) text += fmt::format(" {:7.2f} s", progress.time);
    text += fmt::format(" {:4.0f} %", 100 * share);
    // Before a hundredth is done the estimate is worth nothing.
    if (share >= before + 0.01)
        text += fmt::format("   {} left", duration(elapsed * (1 - share) / (share - before)));
    if (progress.resumed_at) text += fmt::format("   resumed at t = {:.4g} s", *progress.resumed_at);
    return text;
}

bool progress_is_seen() {
    const char* terminal = std::getenv("TERM");
    return ::isatty(STDERR_FILENO) == 1 && (terminal == nullptr || std::string_view(terminal) != "dumb");
}

ProgressLine::ProgressLine(std::string_view fidelity, bool shown) : fidelity_(fidelity), shown_(shown) {}

ProgressLine::~ProgressLine() {
    if (drawn_) std::fputs("\r\033[K", stderr);
}

std::function<void(const Progress&)> ProgressLine::reporter() {
    if (!shown_) return {};
    return [this](const Progress& progress) { update(progress); };
}

void ProgressLine::update(const Progress& progress) {
    const auto now = Clock::now();
    if (next_ == start_ && progress.resumed_at) before_ = progress.share;
    if (now < next_) return;
    next_ = now + interval;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const std::string text = progress_text(fidelity_, progress, elapsed, before_).substr(0, line_width());
    std::fputs(fmt::format("\r{}\033[K", text).c_str(), stderr);
    std::fflush(stderr);
    drawn_ = true;
}

}  // namespace twinchute
