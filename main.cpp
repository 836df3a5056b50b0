// twinchute: one parachute scene at two fidelities, and the gap between them.
#include <array>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "compare/compare_command.hpp"
#include "compare/ladder_command.hpp"
#include "compare/report_command.hpp"
#include "compare/stability_command.hpp"
#include "compare/validate/validate_command.hpp"
#include "fullsim/fidelity.hpp"
#include "fullsim/mesh_command.hpp"
#include "lib/cli/fidelity_command.hpp"
#include "lib/cli/list_command.hpp"
#include "lib/cli/plan_command.hpp"
#include "lib/cli/program.hpp"
#include "rom/fidelity.hpp"
#include "rom/sensitivity/rom_command.hpp"
#include "rom/size/size_command.hpp"
#include "study/calibrate/calibrate_command.hpp"
#include "study/calibrate/calibrated_case.hpp"
#include "study/campaign/campaign_command.hpp"

namespace {

/// Keeps what is freed for the next run. Calibrations and campaigns make thousands of runs with buffers of
/// the same sizes; glibc gives such buffers back after each, and to ask for them anew takes longer than the
/// run.
void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int largest = 32 << 20;  // [bytes] that glibc would ever keep by itself
    mallopt(M_MMAP_THRESHOLD, largest);
    mallopt(M_TRIM_THRESHOLD, 2 * largest);
#endif
}

}  // namespace

int main(int argc, char** argv) {
    using namespace twinchute;
    keep_freed_memory();
    const Fidelity& rom = rom::rom_fidelity();
    const Fidelity& full = fullsim::full_fidelity();

    const std::array commands{
        compare::compare_command(full, rom),
        rom::rom_command(full),
        fidelity_command(full, "full aeroelastic run", DefaultOutput::directory, {&rom}),
        rom::size_command(),
        study::calibrate_command(rom),
        study::campaign_command(rom, full),
        compare::report_command(full, rom),
        compare::ladder_command({&rom, &full}),
        compare::stability_command(full, rom),
        compare::validate_command({&rom, &full}, study::case_calibrator(rom)),
        fullsim::mesh_command(),
        plan_command({&rom, &full}),
        list_command(),
    };
    return run_program(commands, argc, argv);
}
