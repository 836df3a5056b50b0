#include "lib/cli/help_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "lib/cli/completion.hpp"
#include "lib/cli/manual_page.hpp"
#include "lib/cli/program.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/scene/nearest.hpp"

namespace twinchute {
namespace {

std::vector<std::string> names_of(std::span<const Command> commands) {
    std::vector<std::string> names;
    for (const Command& command : commands)
        names.push_back(command.name);
    return names;
}

ExitCode run_help(std::span<const Command> commands, const Arguments& arguments) {
    print(arguments.operand.empty() ? program_help(commands)
                                    : command_help(find_command(commands, arguments.operand)));
    return ExitCode::done;
}

ExitCode run_manual(std::span<const Command> commands, const Arguments& arguments) {
    if (const auto directory = arguments.value("out")) {
        if (!arguments.operand.empty())
            throw UsageError("--out takes the pages of all commands, not of one, leave one of them out");
        FileBatch batch;
        const std::filesystem::path place(*directory);
        batch.add(place / "twinchute.1", manual_page(commands));
        for (const Command& command : commands)
            batch.add(place / fmt::format("twinchute-{}.1", command.name), manual_page(command));
        batch.commit();
        return ExitCode::done;
    }
    print(arguments.operand.empty() ? manual_page(commands)
                                    : manual_page(find_command(commands, arguments.operand)));
    return ExitCode::done;
}

ExitCode run_completion(std::span<const Command> commands, const Arguments& arguments) {
    const std::string& name = arguments.operand;
    const auto shell = std::ranges::find(shells(), name, &Shell::name);
    if (shell == shells().end()) {
        std::vector<std::string_view> known;
        for (const Shell& row : shells())
            known.push_back(row.name);
        throw UsageError(fmt::format("there is no completion for '{}', {}", name, suggest(name, known)));
    }
    print(shell->script(commands));
    return ExitCode::done;
}

}  // namespace

std::vector<Command> with_help_commands(std::span<const Command> commands) {
    // Their own rows are part of what they show, so that each makes the whole table anew.
    const auto over_all = [commands](ExitCode (*run)(std::span<const Command>, const Arguments&)) {
        return [commands, run](const Arguments& arguments) {
            return run(with_help_commands(commands), arguments);
        };
    };
    std::vector<Command> all(commands.begin(), commands.end());
    Command help;
    help.name = "help";
    help.summary = "this page, or that of a command";
    help.operand = "[COMMAND]";
    help.example = "twinchute help compare";
    help.run = over_all(run_help);
    Command manual;
    manual.name = "manual";
    manual.summary = "manual page of the program or of a command, for man";
    manual.operand = "[COMMAND]";
    manual.example = "twinchute manual compare | man -l -";
    manual.options = {{"out", "DIR", "write the pages of the program and of all commands there"}};
    manual.run = over_all(run_manual);
    Command completion;
    completion.name = "completion";
    completion.summary = "script that makes a shell complete the command line";
    completion.operand = "SHELL";
    completion.example = "twinchute completion bash";
    completion.run = over_all(run_completion);
    for (const Shell& shell : shells())
        completion.operand_words.emplace_back(shell.name);
    all.push_back(std::move(help));
    all.push_back(std::move(manual));
    all.push_back(std::move(completion));
    for (Command& row : all)
        if (row.operand == "[COMMAND]") row.operand_words = names_of(all);
    return all;
}

}  // namespace twinchute
