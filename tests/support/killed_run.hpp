// A run that is killed again and again, and what it leaves in the end.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/process.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::test {

/// Files of a record's directory, by name: every file whole, but a summary without date, clocks, and the
/// checksum that depends on these.
inline std::map<std::string, std::string> record_files(const std::filesystem::path& directory) {
    std::map<std::string, std::string> files;
    for (const std::string& name : tree_of(directory)) {
        if (!std::filesystem::is_regular_file(directory / name)) continue;
        if (name == "run.html") continue;  // the same numbers, and those of the clock
        std::string text = content_of(directory / name);
        if (name.ends_with("summary.json")) {
            auto json = nlohmann::json::parse(text);
            for (const char* key : {"wall_s", "cpu_s", "ns_per_element_step", "blocks", "resumed_at_s"})
                json["cost"].erase(key);
            json["provenance"].erase("date");
            json.erase("sha256");
            text = json.dump(1);
        }
        files[name] = text;
    }
    return files;
}

/// Runs a program until it has been killed (SIGKILL) `kills` times, each time after a moment of at most
/// `max` [s] drawn at random, then once more to its end. Each time with --resume, but for the first unless
/// that has it. How often it was really killed: a run that ends before is begun anew no more.
inline int run_with_kills(std::vector<std::string> words, const std::filesystem::path& directory, int kills,
                          double max, std::uint64_t seed, Ended* last) {
    Random random(seed);
    int killed = 0;
    for (; killed < kills; ++killed) {
        Process process(words, directory);
        std::this_thread::sleep_for(std::chrono::duration<double>(max * random.share()));
        ::kill(process.id(), SIGKILL);
        *last = process.wait();
        if (words.back() != "--resume") words.emplace_back("--resume");
        if (last->code != 128 + SIGKILL) return killed;
    }
    *last = Process(words, directory).wait();
    return killed;
}

}  // namespace twinchute::test
