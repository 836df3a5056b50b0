#include "lib/cli/completion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/cli/program.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/keys.hpp"

namespace twinchute {
namespace {

using Strings = std::vector<std::string>;

/// Kind of an argument, by which a shell proposes some.
enum class Completes {
    nothing,
    words,
    directories,
    files,
    toml_files,
    csv_files,
    keys,
    assignments,
    metrics
};

/// By the placeholder of an argument, as tables and usage lines write it.
Completes completes(std::string_view placeholder, const Strings& words) {
    const auto begins = [&](std::string_view head) { return placeholder.starts_with(head); };
    while (begins("["))
        placeholder.remove_prefix(1);
    if (!words.empty()) return Completes::words;
    if (begins("DIR")) return Completes::directories;
    if (begins("SCENE") || placeholder.find(".toml") != placeholder.npos) return Completes::toml_files;
    if (begins("FILE.csv")) return Completes::csv_files;
    if (begins("FILE")) return Completes::files;
    if (begins("KEY=")) return Completes::assignments;
    if (begins("KEY")) return Completes::keys;
    return begins("METRIC=") ? Completes::metrics : Completes::nothing;
}

std::string joined_by(const Strings& words, std::string_view separator = " ") {
    return fmt::format("{}", fmt::join(words, separator));
}

/// Text between single quotes, as every shell here reads it but for `special`, which a backslash guards.
std::string quoted(std::string_view text, std::string_view special = "") {
    std::string out = "'";
    for (const char c : text) {
        if (special.find(c) != special.npos) out += '\\';
        out += c == '\'' ? "'\\''" : std::string(1, c);
    }
    return out + "'";
}

Strings key_paths() {
    Strings paths;
    for (const Key* key : keys_below(""))
        if (key->kind != KeyKind::table && key->kind != KeyKind::tables) paths.emplace_back(key->path);
    return paths;
}

Strings metric_names() {
    Strings names;
    for (const MetricRow& row : judgeable_rows())
        names.emplace_back(row.name);
    return names;
}

Strings dashed(const Command& command) {
    Strings names{"-h"};
    for (const Option& option : options_of(command))
        names.push_back("--" + option.name);
    return names;
}

// --- bash -------------------------------------------------------------------------------------------------

std::string bash_action(Completes kind, const Strings& words) {
    switch (kind) {
        case Completes::nothing:
            return "return";
        case Completes::words:
            return "_twinchute_words " + quoted(joined_by(words));
        case Completes::directories:
            return "_twinchute_paths";
        case Completes::files:
            return "_twinchute_paths '*'";
        case Completes::toml_files:
            return "_twinchute_paths '*.toml'";
        case Completes::csv_files:
            return "_twinchute_paths '*.csv'";
        case Completes::keys:
            return "_twinchute_words \"$_twinchute_keys\"";
        case Completes::assignments:
            return "_twinchute_assignments \"$_twinchute_keys\"";
        case Completes::metrics:
            return "_twinchute_assignments \"$_twinchute_metrics\"";
    }
    return "return";
}

constexpr std::string_view bash_head = R"(
_twinchute_words() {
    mapfile -t COMPREPLY < <(compgen -W "$1" -- "$cur")
}

# Names before an equals sign, which the value follows at once.
_twinchute_assignments() {
    compopt -o nospace 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -S = -W "$1" -- "$cur")
}

# Directories, and the files that fit a pattern.
_twinchute_paths() {
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -d -- "$cur"; [[ -z $1 ]] || compgen -f -X "!$1" -- "$cur" |
        while IFS= read -r file; do [[ -d $file ]] || printf '%s\n' "$file"; done)
}

_twinchute() {
    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}
    COMPREPLY=()
    # "--out=x" is three words. Behind any other equals sign there is nothing to propose.
    if [[ $cur == = || $prev == = ]]; then
        [[ $prev != = ]] || prev=${COMP_WORDS[COMP_CWORD-2]}
        [[ $cur != = ]] || cur=
        [[ $prev == --* ]] || return 0
    fi
)";

std::string bash_script(std::span<const Command> commands) {
    std::string text = "# bash completion for twinchute, written by `twinchute completion bash`\n\n";
    text += fmt::format("_twinchute_keys={}\n_twinchute_metrics={}\n", quoted(joined_by(key_paths(), "\n")),
                        quoted(joined_by(metric_names(), "\n")));
    text += bash_head;
    Strings names;
    for (const Command& command : commands)
        names.push_back(command.name);
    text += fmt::format(
        "    if (( COMP_CWORD == 1 )); then\n        _twinchute_words '{} -h --help -V --version'\n"
        "        return 0\n    fi\n    case ${{COMP_WORDS[1]}} in\n",
        joined_by(names));
    for (const Command& command : commands) {
        text += fmt::format("    {})\n        case $prev in\n", command.name);
        for (const Option& option : options_of(command))
            if (!option.value.empty())
                text += fmt::format("        --{}) {}; return 0 ;;\n", option.name,
                                    bash_action(completes(option.value, option.words), option.words));
        text += fmt::format(
            "        esac\n        if [[ $cur == -* ]]; then _twinchute_words '{}'; return 0; fi\n",
            joined_by(dashed(command)));
        const std::string first =
            bash_action(completes(command.operand, command.operand_words), command.operand_words);
        const bool keys_follow = command.operand.find(" [KEY]") != std::string::npos;
        text += keys_follow ? fmt::format("        if (( COMP_CWORD > 2 )); then {}; else {}; fi\n",
                                          bash_action(Completes::keys, {}), first)
                            : fmt::format("        {}\n", first);
        text += "        ;;\n";
    }
    return text + "    esac\n    return 0\n}\n\ncomplete -F _twinchute twinchute\n";
}

// --- zsh --------------------------------------------------------------------------------------------------

std::string zsh_action(Completes kind, const Strings& words) {
    switch (kind) {
        case Completes::nothing:
            return " ";
        case Completes::words:
            return "(" + joined_by(words) + ")";
        case Completes::directories:
            return "_files -/";
        case Completes::files:
            return "_files";
        case Completes::toml_files:
            return "_files -g \"*.toml\"";
        case Completes::csv_files:
            return "_files -g \"*.csv\"";
        case Completes::keys:
            return "_twinchute_keys";
        case Completes::assignments:
            return "_twinchute_assignments";
        case Completes::metrics:
            return "_twinchute_metrics";
    }
    return " ";
}

/// One specification of _arguments.
std::string zsh_option(const Option& option) {
    constexpr std::string_view special = "\\[]:";
    const auto guarded = [&](std::string_view text) {
        const std::string whole = quoted(text, special);
        return whole.substr(1, whole.size() - 2);
    };
    const std::string meaning = "[" + guarded(option.meaning) + "]";
    if (option.name == "help") return fmt::format("'(- *)'{{-h,--help}}'{}'", meaning);
    const std::string star = option.repeatable ? "*" : "";
    if (option.value.empty()) return fmt::format("'{}--{}{}'", star, option.name, meaning);
    return fmt::format("'{}--{}={}:{}:{}'", star, option.name, meaning, guarded(option.value),
                       zsh_action(completes(option.value, option.words), option.words));
}

std::string zsh_script(std::span<const Command> commands) {
    std::string text =
        "#compdef twinchute\n# zsh completion for twinchute, written by `twinchute completion zsh`\n\n";
    text += fmt::format("_twinchute_keys() {{\n    compadd -- {}\n}}\n\n",
                        joined_by(key_paths(), " \\\n        "));
    text += fmt::format("_twinchute_assignments() {{\n    compadd -S = -- {}\n}}\n\n",
                        joined_by(key_paths(), " \\\n        "));
    text += fmt::format("_twinchute_metrics() {{\n    compadd -S = -- {}\n}}\n\n",
                        joined_by(metric_names(), " \\\n        "));
    text += "_twinchute() {\n    local -a commands\n    commands=(\n";
    for (const Command& command : commands)
        text += fmt::format("        {}\n", quoted(command.name + ":" + command.summary));
    text += R"(    )
    if (( CURRENT == 2 )); then
        _describe -t commands command commands
        compadd -- -h --help -V --version
        return
    fi
    local command=$words[2]
    shift words
    (( CURRENT-- ))
    case $command in
)";
    for (const Command& command : commands) {
        text += fmt::format("    {})\n        _arguments -S", command.name);
        for (const Option& option : options_of(command))
            text += " \\\n            " + zsh_option(option);
        const bool keys_follow = command.operand.find(" [KEY]") != std::string::npos;
        const bool several = command.operand.find("...") != std::string::npos && !keys_follow;
        if (!command.operand.empty())
            text += fmt::format(
                " \\\n            '{}:{}:{}'", several ? "*" : "1", keys_follow ? "topic" : "operand",
                zsh_action(completes(command.operand, command.operand_words), command.operand_words));
        if (keys_follow) text += " \\\n            '2:key:_twinchute_keys'";
        text += "\n        ;;\n";
    }
    return text + R"(    esac
}

# Loaded by the completion system, or read by `source`.
if [[ $funcstack[1] == _twinchute ]]; then
    _twinchute "$@"
else
    compdef _twinchute twinchute
fi
)";
}

// --- fish -------------------------------------------------------------------------------------------------

/// `-x` keeps files out, which fish proposes otherwise.
std::string fish_action(Completes kind, const Strings& words) {
    switch (kind) {
        case Completes::nothing:
            return " -x";
        case Completes::words:
            return " -x -a " + quoted(joined_by(words));
        case Completes::directories:
            return " -x -a '(__fish_complete_directories)'";
        case Completes::files:
            return " -r -F";
        case Completes::toml_files:
            return " -x -a '(__fish_complete_suffix .toml)'";
        case Completes::csv_files:
            return " -x -a '(__fish_complete_suffix .csv)'";
        case Completes::keys:
            return " -x -a '$__twinchute_keys'";
        case Completes::assignments:
            return " -x -a '$__twinchute_keys='";
        case Completes::metrics:
            return " -x -a '$__twinchute_metrics='";
    }
    return " -x";
}

/// fish reads \' and \\ between single quotes.
std::string fish_quoted(std::string_view text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'' || c == '\\') out += '\\';
        out += c;
    }
    return out + "'";
}

std::string fish_script(std::span<const Command> commands) {
    std::string text = "# fish completion for twinchute, written by `twinchute completion fish`\n\n";
    text += fmt::format("set -g __twinchute_keys {}\nset -g __twinchute_metrics {}\n\n",
                        joined_by(key_paths()), joined_by(metric_names()));
    text += "complete -c twinchute -f\n";
    text += "complete -c twinchute -n __fish_use_subcommand -s h -l help -d 'the commands'\n";
    text +=
        "complete -c twinchute -n __fish_use_subcommand -s V -l version -d 'version, commit and compiler'\n";
    for (const Command& command : commands) {
        text += fmt::format("\ncomplete -c twinchute -n __fish_use_subcommand -a {} -d {}\n", command.name,
                            fish_quoted(command.summary));
        const std::string here = fmt::format(
            "complete -c twinchute -n '__fish_seen_subcommand_from {0}; and test (commandline -opc)[2] = "
            "{0}'",
            command.name);
        for (const Option& option : options_of(command))
            text += fmt::format(
                "{}{} -l {}{} -d {}\n", here, option.name == "help" ? " -s h" : "", option.name,
                option.value.empty() ? "" : fish_action(completes(option.value, option.words), option.words),
                fish_quoted(option.meaning));
        if (!command.operand.empty())
            text += here +
                    fish_action(completes(command.operand, command.operand_words), command.operand_words) +
                    "\n";
        if (command.operand.find(" [KEY]") != std::string::npos)
            text += here + fish_action(Completes::keys, {}) + "\n";
    }
    return text;
}

constexpr Shell shell_rows[] = {{"bash", bash_script}, {"zsh", zsh_script}, {"fish", fish_script}};

}  // namespace

std::span<const Shell> shells() {
    return shell_rows;
}

}  // namespace twinchute
