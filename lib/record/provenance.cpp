// Who made these numbers: build, machine, time.
#include <charconv>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "lib/record/build_info.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute {
namespace {

// The x86-64 levels of the System V ABI, by the last feature that each adds.
std::string_view instruction_set() {
#if defined(__x86_64__)
#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && defined(__AVX512DQ__) && \
    defined(__AVX512VL__)
    return "x86-64-v4";
#elif defined(__AVX2__) && defined(__BMI__) && defined(__BMI2__) && defined(__F16C__) && defined(__FMA__)
    return "x86-64-v3";
#elif defined(__SSE4_2__) && defined(__POPCNT__)
    return "x86-64-v2";
#else
    return "x86-64";
#endif
#elif defined(__aarch64__)
#if defined(__ARM_FEATURE_SVE)
    return "aarch64+sve";
#else
    return "aarch64";
#endif
#else
    return "unknown";
#endif
}

std::string host_cpu() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (!line.starts_with("model name")) continue;
        const auto colon = line.find(':');
        const auto begin = colon == std::string::npos ? colon : line.find_first_not_of(" \t", colon + 1);
        if (begin != std::string::npos) return line.substr(begin);
    }
    return "unknown";
}

// Reproducible builds and tests pin the date: https://reproducible-builds.org/specs/source-date-epoch/
std::optional<std::time_t> pinned_time() {
    const char* text = std::getenv("SOURCE_DATE_EPOCH");
    if (text == nullptr) return {};
    const std::string_view digits(text);
    std::time_t seconds = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), seconds);
    if (error != std::errc{} || end != digits.data() + digits.size()) return {};
    return seconds;
}

std::string utc_now() {
    const std::time_t now = pinned_time().value_or(std::time(nullptr));
    std::tm parts{};
    if (gmtime_r(&now, &parts) == nullptr) return "unknown";
    char text[32];
    const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return {text, length};
}

}  // namespace

Provenance current_provenance() {
    const BuildInfo build = build_info();
    Provenance provenance;
    provenance.version = build.version;
    provenance.commit = build.commit;
    provenance.compiler = build.compiler;
    provenance.flags = build.flags;
    provenance.instruction_set = instruction_set();
    static const std::string cpu = host_cpu();
    provenance.host_cpu = cpu;
    provenance.date = utc_now();
    return provenance;
}

}  // namespace twinchute
