#include "compare/validate/validate_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "compare/parallel.hpp"
#include "compare/validate/report.hpp"
#include "compare/validate/run_suite.hpp"
#include "compare/validate/scatter_plot.hpp"
#include "lib/cli/interrupt.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/progress.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/file_batch.hpp"

namespace twinchute::compare {
namespace {

std::vector<ValidationSuite> suites_of(const Arguments& arguments) {
    std::vector<ValidationSuite> suites;
    for (const std::string& name : arguments.values("suite"))
        suites.push_back(read_suite(suite_file(name)));
    for (const std::string& file : arguments.operands)
        suites.push_back(read_suite(file));
    if (suites.empty())
        for (const std::string& name : suite_names())
            suites.push_back(read_suite(suite_file(name)));
    if (suites.empty()) throw UsageError("no suites are installed, name one: twinchute validate SUITE.toml");
    std::set<std::string> names;
    for (const ValidationSuite& suite : suites)
        if (!names.insert(suite.name).second)
            throw UsageError(fmt::format(
                "two suites are called '{}' (results are kept by name), name each once", suite.name));
    return suites;
}

/// Command as it can be typed again; files of one's own are not part of a published command.
std::string command_of(const Arguments& arguments) {
    std::string command = "twinchute validate";
    for (const std::string& name : arguments.values("suite"))
        command += " --suite " + name;
    for (const std::string& file : arguments.operands)
        command += " " + std::filesystem::path(file).filename().string();
    return command + (arguments.has("quick") ? " --quick" : "") +
           (arguments.has("strict") ? " --strict" : "");
}

Validation run_all(const std::vector<ValidationSuite>& suites, std::span<const Fidelity* const> fidelities,
                   ValidationOptions options, bool shown) {
    Validation validation;
    for (const ValidationSuite& suite : suites) {
        ProgressLine line("validate " + suite.name, shown);
        options.progress = line.reporter();
        validation.suites.push_back(run_suite(suite, fidelities, options, validation.interrupted));
        if (validation.interrupted) break;
    }
    return validation;
}

void add_files(FileBatch& batch, const Validation& validation, const std::filesystem::path& directory,
               const std::string& json, const std::string& markdown) {
    // Plots of an earlier validation must not stand beside the new numbers.
    std::set<std::filesystem::path> plots;
    for (const SuiteResult& suite : validation.suites)
        for (const GroupResult& group : suite.groups())
            if (group.agreement && plots.insert(directory / plot_name(suite, group)).second)
                batch.add(directory / plot_name(suite, group), scatter_svg(suite, group));
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(directory, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("scatter-") && name.ends_with(".svg") && !plots.contains(entry.path()))
            batch.remove(entry.path());
    }
    batch.add(directory / "validate.csv", validation_csv(validation));
    batch.add(directory / "report.md", markdown);
    batch.add(directory / "validate.json", json, FileBatch::Kind::marker);
}

ExitCode run_validate(const std::vector<const Fidelity*>& fidelities, const Calibrator& calibrate,
                      const Arguments& arguments) {
    const std::vector<ValidationSuite> suites = suites_of(arguments);
    ValidationOptions options;
    options.quick = arguments.has("quick");
    options.calibrate = calibrate;
    options.threads = whole_number(arguments, "threads", processors(), 256, 2);
    const std::filesystem::path directory = arguments.value("out").value_or("validate.out");
    check_output_dir(directory);
    const Interrupt interrupt;  // until the files are safe
    options.stop = interrupt.token();
    const bool quiet = arguments.has("quiet");

    Validation validation = run_all(suites, fidelities, options, !quiet && progress_is_seen());
    // Whoever names a suite asks about it; of those that come with the program only what is exact says
    // whether the program is sound.
    validation.exact_alone =
        arguments.operands.empty() && !arguments.has("suite") && !arguments.has("strict");
    const Provenance provenance = current_provenance();
    const std::string json = validation_json(validation, provenance);
    FileBatch batch;
    add_files(batch, validation, directory, json,
              validation_markdown(validation, provenance, command_of(arguments)));
    batch.commit();
    if (arguments.has("json")) {
        print(json);
    } else if (!quiet) {
        print(validation_terminal(validation, output_style()));
        print(fmt::format("report    {}\n", printable((directory / "report.md").string())));
    }
    if (validation.interrupted) return ExitCode::interrupted;
    return validation.failed() ? ExitCode::verdict : ExitCode::done;
}

}  // namespace

Command validate_command(std::vector<const Fidelity*> fidelities, Calibrator calibrate) {
    Command command;
    command.name = "validate";
    command.summary = "hold the models against exact answers, printed numbers and test data";
    command.operand = "[SUITE.toml...]";
    command.example = "twinchute validate --quick";
    command.options = {
        {"out", "DIR", "write report.md, validate.csv and .json there instead of ./validate.out"},
        {"suite", "NAME", "run this suite of those that come with the program", true},
        {"quick", "", "one seed of each packed scene, fewer samples of uncertain inputs"},
        {"strict", "", "exit code 1 for every judged row that is not within, not for exact answers alone"},
        {"threads", "N",
         "runs at the same time, as many as there are cores unless given; the answer is the same"},
        {"json", "", "print the results as JSON and nothing else"},
        {"quiet", "", "print nothing but errors"}};
    command.run = [fidelities = std::move(fidelities), calibrate = std::move(calibrate)](
                      const Arguments& arguments) { return run_validate(fidelities, calibrate, arguments); };
    return command;
}

}  // namespace twinchute::compare
