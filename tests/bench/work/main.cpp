// Work and precision of integrators, on problems of both models: CSV and SVG files into a directory.
//   work_precision rom|full|opening DIRECTORY [--quick]
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <string_view>

#include "tests/bench/work/study.hpp"

int main(int argc, char** argv) {
    using namespace twinchute::bench;
    const bool quick = argc == 4 && std::string_view(argv[3]) == "--quick";
    if (argc != 3 && !quick) {
        fmt::print(stderr, "work_precision rom|full|opening DIRECTORY [--quick]\n");
        return 2;
    }
    const std::string_view what = argv[1];
    try {
        if (what == "rom")
            study_rom(argv[2], quick);
        else if (what == "full")
            study_full(argv[2], quick);
        else if (what == "opening")
            study_openings(argv[2], quick);
        else
            return 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
