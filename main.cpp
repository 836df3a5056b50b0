// twinchute: one parachute scene at two fidelities, and the gap between them.
#include <array>
#include <vector>

#include "compare/ladder_verb.hpp"
#include "compare/metrics.hpp"
#include "compare/report_verb.hpp"
#include "compare/stability_verb.hpp"
#include "compare/validate/verb.hpp"
#include "compare/verb.hpp"
#include "fullsim/fidelity.hpp"
#include "fullsim/mesh_verb.hpp"
#include "lib/cli/list_verb.hpp"
#include "lib/cli/plan_verb.hpp"
#include "lib/cli/program.hpp"
#include "lib/cli/single_verb.hpp"
#include "rom/fidelity.hpp"
#include "rom/sensitivity/verb.hpp"
#include "rom/size/size_verb.hpp"

int main(int argc, char** argv) {
    using namespace twinchute;
    const Fidelity& rom = rom::rom_fidelity();
    const Fidelity& full = fullsim::full_fidelity();

    std::vector<ListTopic> topics = library_topics();
    topics.push_back(compare::metrics_topic());

    const std::array verbs{
        compare::compare_verb(full, rom),
        rom::rom_verb(full),
        single_verb(full, "full aeroelastic run", DefaultOutput::directory, {&rom}),
        rom::size_verb(),
        compare::report_verb(full, rom),
        compare::ladder_verb({&rom, &full}),
        compare::stability_verb(full, rom),
        compare::validate_verb({&rom, &full}),
        fullsim::mesh_verb(),
        plan_verb({&rom, &full}),
        list_verb(std::move(topics)),
    };
    return run_program(verbs, argc, argv);
}
