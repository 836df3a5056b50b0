// twinchute: one parachute scene at two fidelities, and the gap between them.
#include <array>

#include "compare/compare_command.hpp"
#include "compare/ladder_command.hpp"
#include "compare/report_command.hpp"
#include "compare/run_reports.hpp"
#include "compare/stability_command.hpp"
#include "compare/validate/validate_command.hpp"
#include "fullsim/fidelity.hpp"
#include "fullsim/mesh_command.hpp"
#include "fullsim/pattern/pattern_command.hpp"
#include "lib/cli/fidelity_command.hpp"
#include "lib/cli/list_command.hpp"
#include "lib/cli/plan_command.hpp"
#include "lib/cli/program.hpp"
#include "lib/exchange/export_command.hpp"
#include "lib/exchange/import_command.hpp"
#include "rom/fidelity.hpp"
#include "rom/sensitivity/rom_command.hpp"
#include "serve/serve_command.hpp"
#include "study/calibrate/calibrate_command.hpp"
#include "study/calibrate/calibrated_case.hpp"
#include "study/campaign/campaign_command.hpp"
#include "study/size/size_command.hpp"

int main(int argc, char** argv) {
    using namespace twinchute;
    const Fidelity& rom = rom::rom_fidelity();
    const Fidelity& full = fullsim::full_fidelity();

    const std::array commands{
        compare::compare_command(full, rom),
        rom::rom_command(full, compare::run_reports(rom, false)),
        fidelity_command(full, "full aeroelastic run", DefaultOutput::directory, {&rom},
                         compare::run_reports(full, true)),
        study::size_command(),
        study::calibrate_command(rom),
        study::campaign_command(rom, full),
        compare::report_command(full, rom),
        compare::ladder_command({&rom, &full}),
        compare::stability_command(full, rom),
        compare::validate_command({&rom, &full}, study::case_calibrator(rom)),
        exchange::import_command(rom),
        exchange::export_command(rom),
        fullsim::mesh_command(),
        fullsim::pattern_command(),
        serve::serve_command(full, rom),
        plan_command({&rom, &full}),
        list_command(),
    };
    return run_program(commands, argc, argv);
}
