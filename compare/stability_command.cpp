#include "compare/stability_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "compare/stability.hpp"
#include "compare/stability_report.hpp"
#include "lib/cli/interrupt.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/progress.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/record/file_batch.hpp"

namespace twinchute::compare {
namespace {

ExitCode run_stability(std::span<const Fidelity* const> fidelities, const Arguments& arguments) {
    const std::filesystem::path directory = arguments.value("out").value_or("stability.out");
    check_output_dir(directory);
    const Interrupt interrupt;  // until the files are safe
    const bool quiet = arguments.has("quiet"), quick = arguments.has("quick");

    std::vector<const StabilityCase*> rows;
    for (const StabilityCase& row : stability_cases())
        if (row.quick || !quick) rows.push_back(&row);
    StabilityMatrix matrix;
    {
        ProgressLine line("stability", !quiet && progress_is_seen());
        const auto say = line.reporter();
        for (std::size_t i = 0; i < rows.size() && !matrix.interrupted; ++i) {
            const auto fidelity = std::ranges::find(fidelities, rows[i]->fidelity, &Fidelity::name);
            for (const StabilityMethod& method : rows[i]->methods) {
                if (say) say({rows[i]->name, 0.0, static_cast<double>(i) / static_cast<double>(rows.size())});
                auto cell = judge(*rows[i], method, **fidelity, interrupt.token());
                matrix.interrupted = !cell || interrupt.token().stop_requested();
                if (matrix.interrupted) break;
                matrix.cells.push_back(std::move(*cell));
            }
        }
    }
    const Provenance provenance = current_provenance();
    const std::string json = stability_json(matrix, provenance);
    FileBatch batch;
    batch.add(directory / "stability.csv", stability_csv(matrix));
    batch.add(directory / "stability.md",
              stability_markdown(matrix, provenance,
                                 fmt::format("twinchute stability{}", quick ? " --quick" : "")));
    batch.add(directory / "stability.json", json, FileBatch::Kind::marker);
    batch.commit();

    if (arguments.has("json")) {
        print(json);
    } else if (!quiet) {
        print(stability_terminal(matrix, output_style()));
        print(fmt::format("report    {}\n", printable((directory / "stability.md").string())));
    }
    if (matrix.interrupted) return ExitCode::interrupted;
    const bool failed = std::ranges::any_of(matrix.cells, is_failure, &StabilityCell::verdict);
    return failed ? ExitCode::verdict : ExitCode::done;
}

}  // namespace

Command stability_command(const Fidelity& full, const Fidelity& rom) {
    Command command;
    command.name = "stability";
    command.summary = "run stiff and extreme cases, a verdict and a margin each";
    command.operand = "";
    command.example = "twinchute stability --quick";
    command.options = {{"out", "DIR", "write stability.md, .csv and .json there instead of ./stability.out"},
                       {"quick", "", "only cells that take less than about 0.2 s"},
                       {"json", "", "print the matrix as JSON and nothing else"},
                       {"quiet", "", "print nothing but errors"}};
    command.run = [&full, &rom](const Arguments& arguments) {
        return run_stability(std::array{&full, &rom}, arguments);
    };
    return command;
}

}  // namespace twinchute::compare
