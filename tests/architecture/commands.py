#!/usr/bin/env python3
"""Runs the command lines of the documentation.

    commands.py TREE PROGRAM CTEST BUILD           every command line of PAGES ends as it should, or has a row in ELSEWHERE
    commands.py TREE PROGRAM CTEST BUILD can-fail  breaks a page in each way that is looked for, and finds the breach at its line

A fence without a language holds command lines. They run in the order of the page, in a folder of that page with a copy of data/, a link
to docs/ and the files whose text the page shows below their names. So do commands between backticks, where their operands are there.
Of commands with operands such as SCENE or FILE, and of options alone, the program's help has to know every option.
"""

import glob
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

PAGES = ("*.md", "docs/**/*.md", "data/**/*.md")
NOT_PAGES = ("CHANGELOG.md", "docs/generated/")  # of earlier versions; tables with the line that made them
EXAMPLES = "docs/guide/ci/*"  # files for other programs; their options count
COMMANDS = ("", "sh", "bash")  # languages of fences with command lines
FILES = ("text", "toml", "python", "cmake", "cpp")  # and of others
BESIDE = ("echo", "sed")  # other programs that run as they stand
RENDERS = "docs/pictures/render_fields.py"  # runs where a Python has VTK

# What a page takes for granted: files of the reader's own, or folders.
THE_READERS = {
    "docs/guide/ci.md": {"scenes/drop.toml": "data/scenes/c9-inflation.toml"},
    "docs/guide/command-line.md": {"home/.config/fish/completions": None},  # fish makes it
}
# Places where an installation has files of the tree.
INSTALLED = {"/usr/share/twinchute/": "data/"}
# Lines that would take minutes: what is added to them (None: they are looked up and do not run), and who runs them as they are.
SHORTENED = {
    "twinchute stability": ("--quick", "the target docs-tables"),
    "twinchute validate": ("--suite closed-forms", "the target docs-tables"),
    "twinchute validate --suite paper": ("--quick", "the target docs-tables"),
    "twinchute validate --suite paper-series": (None, "the target docs-tables"),
    "twinchute serve": (None, "tests/system/serve_test.py"),  # until Ctrl-C
    "twinchute serve data/scenes/c9-inflation.toml": (None, "tests/system/serve_test.py"),
}
# Lines that end with another exit code than 0, and the page that says why.
ENDS_WITH = {
    "twinchute validate --suite paper": (1, "docs/validation.md: 8 of 13 judged rows"),
    "twinchute validate --suite filling": (1, "docs/theory/filling.md: some rows are not within"),
}
# Options alone that belong to other programs.
OTHERS = {"--keep": ".ci/fresh-machine", "--ccache": ".ci/fresh-machine", "--no-install-recommends": "apt-get"}
# Other programs, their arguments, and who runs such a line or why nobody does. Documentation.lacks looks up what named groups hold.
ELSEWHERE = (
    ("./bootstrap", "(?P<bootstrap>.+)", ".ci/fresh-machine runs demo and test, .ci/run packages"),
    (".ci/run", "", "every change"),
    ("cmake", r"--preset (?P<configure>\S+)( -D(?P<variable>\w+)=\S+)?", ".ci/run, for one preset"),
    ("cmake", r"--build --preset (?P<build>\S+)( --target (?P<target>\S+))?", ".ci/run, for one preset"),
    ("cmake", r"-B build -DCMAKE_PREFIX_PATH=\S+", "architecture.installed_program"),
    ("cmake", "--build build", "architecture.installed_program"),
    ("build/consumer", "", "architecture.installed_program"),
    ("cmake", "--install", "architecture.installed_program"),
    ("ctest", r"(--preset (?P<test>\S+)|--test-dir build/(?P<tree>\S+))?( ?-L (?P<label>\S+))?( -R (?P<name>\S+))?( -V| -j2)?",
     "runs this test"),
    ("cpack", r"--preset (?P<package>\S+)", "package.debian"),
    ("apt-get", r"install (?P<needed>[\w-]+)", "./bootstrap test"),
    ("apt-get", r"install \./build/package/packages/twinchute_(?P<version>[\d.]+)-1_amd64\.deb", "package.debian"),
    ("python3", "", "python.module runs what the page enters"),
    ("verification_tests", r"--gtest_filter=(?P<filter>\S+)", "ctest"),
    ("verification_long_tests", r"--gtest_filter=(?P<filter>\S+)", "ctest"),
    ("man", "twinchute(-(?P<command>.+))?", "package.debian installs these pages"),
    ("man", "-l -", "tests/system/system_manual_test.cpp renders every page"),
    ("source", "", "tests/system/system_manual_test.cpp, in each shell"),
    ("git", "(ls-files|archive|config)( .*)?", "of another program"),
    ("xargs", "clang-format -i", ".ci/run finds what it would change"),
    ("sbatch", r"\S+ (?P<template>\S+) CAMPAIGN.toml DIR", "tests/system/system_campaign_test.cpp"),
    ("mpirun", r"-n 16 (?P<template>\S+) CAMPAIGN.toml DIR", "tests/system/system_campaign_test.cpp"),
    ("parallel", "twinchute (?P<shards>campaign .*)", "tests/system/system_campaign_test.cpp makes shards"),
)

PLACEHOLDER = re.compile(r"\[|(?:[A-Z]+=)?[A-Z]+(?:\.\w+)?$|.*\.\.")  # [TOPIC], FILE.csv, KEY=VALUE, DIR..., LO..HI
BY_PATH = re.compile(r"(?<![\w/.])((?:[\w.-]+/)+)twinchute(?![\w/.-])")  # the program where a build has it


def text_of(*path):
    with open(os.path.join(*path)) as stream:
        return stream.read()


def is_program(word):
    return os.path.basename(word) == "twinchute"


def simple_commands(line):
    """Words of each command of a line, without assignments, redirections and the words of a loop."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split, lexer.commenters = True, ""
    commands, redirected = [[]], False
    for word in lexer:
        if set(word) <= set("();<>|&"):
            redirected = word in ("<", ">", ">>")
            if not redirected:
                commands.append([])
        elif not redirected:
            commands[-1].append(word)
        else:
            redirected = False
    kept = []
    for words in commands:
        while words and (words[0] in ("do", "done") or re.match(r"\w+=", words[0])):
            words = words[1:]
        if words and words[0] != "for":
            kept.append(words)
    return kept


def command_lines(first, text):
    """(number, line) of each command line of a block: without comments, and with the lines in which it goes on."""
    lines, begun = [], ""
    for at, line in enumerate(text.splitlines(), first):
        line = re.sub(r"(^|\s+)#[^'\"]*$", "", line)
        number, begun = (number, f"{begun}\n{line}") if begun else (at, line)
        try:
            shlex.split(begun)  # refuses an open quotation, and a backslash at the end
        except ValueError:
            continue
        if begun.strip():
            lines.append((number, begun.replace("\\\n", "")))
        begun = ""
    return lines + ([(number, begun)] if begun else [])


class Page:
    """What a page holds, in its order: `items` are (line, kind, text). Kinds are `line` (of commands), `span` (between backticks),
    `made` (a span of a table that a target makes), `unknown` (a fence) and names of files."""

    def __init__(self, text):
        self.items, prose, begin, fence, made = [], [], 1, None, False
        for at, line in enumerate(text.splitlines(), 1):
            mark = re.match(r"\s*```(.*)", line)
            if fence is None and mark:
                self.spans(begin, prose, made)
                shown = re.search(r"`([\w-]+\.\w+)`:\s*$", "\n".join(prose))
                fence, fenced = mark[1].strip(), []
            elif mark:
                self.block(at - len(fenced), fence, "\n".join(fenced) + "\n", shown and shown[1])
                fence, prose, begin = None, [], at + 1
            elif fence is not None:
                fenced.append(line)
            elif "what docs-tables makes" in line:
                self.spans(begin, prose, made)
                made, prose, begin = "<!-- begin" in line, [], at + 1
            else:
                prose.append(line)
        if fence is None:
            self.spans(begin, prose, made)
        else:
            self.items.append((at, "unknown", "a fence without an end"))

    def spans(self, first, prose, made):
        text = re.sub(r"<!--.*?-->", lambda comment: re.sub(r"[^\n]", " ", comment[0]), "\n".join(prose), flags=re.DOTALL)
        for paragraph in re.finditer(r"(?:.*\S.*\n?)+", text):
            for span in re.finditer(r"`([^`]+)`", paragraph[0]):
                line = first + text.count("\n", 0, paragraph.start() + span.start())
                self.items.append((line, "made" if made else "span", " ".join(span[1].split())))

    def block(self, first, language, text, shown):
        if language in COMMANDS:
            self.items += [(number, "line", line) for number, line in command_lines(first, text)]
        elif language not in FILES:
            self.items.append((first - 1, "unknown", f"a fence of {language}"))
        elif shown:
            self.items.append((first, shown, text))


class Documentation:
    """The program, what its help and the build know, and what was done so far. Methods that judge return what is wrong, or nothing."""

    def __init__(self, tree, program, ctest, build, scratch):
        self.tree, self.program, self.scratch = os.path.abspath(tree), os.path.abspath(program), scratch
        self.used, self.ended, self.not_run, self.looked_up, self.elsewhere = set(), {}, [], 0, 0
        front = self.ask("-h")
        pages = {command: self.ask("help", command) for command in re.findall(r"^  ([a-z]+) ", front, re.MULTILINE)}
        self.operand = {command: re.search(r"^usage: twinchute \w+ (\S+)", page, re.MULTILINE)[1] for command, page in pages.items()}
        self.options = {command: set(re.findall(r"(?<!\S)--?\w[\w-]*", "".join(re.findall(r"^  -.*?(?=  |$)", page, re.MULTILINE))))
                        for command, page in {"": front, **pages}.items()}
        self.bootstrap, self.presets = text_of(tree, "bootstrap"), json.loads(text_of(tree, "CMakePresets.json"))
        lists = (glob.glob(os.path.join(tree, at), recursive=True) for at in ("CMakeLists.txt", "cmake/*.cmake", "tests/**/CMakeLists.txt"))
        self.cmake = "".join(text_of(file) for files in lists for file in files)
        with tempfile.TemporaryDirectory() as aside:  # ctest begins a log of its last run wherever it starts, even to list
            with open(os.path.join(aside, "CTestTestfile.cmake"), "w", encoding="utf-8") as file:
                file.write(f'subdirs("{os.path.abspath(build)}")\n')
            listed = subprocess.run([ctest, "--test-dir", aside, "--show-only=json-v1"], check=True, capture_output=True, text=True)
        self.tests = {test["name"]: [label for entry in test["properties"] if entry["name"] == "LABELS" for label in entry["value"]]
                      for test in json.loads(listed.stdout)["tests"]}
        self.all_built = not any(name.endswith("_NOT_BUILT") for name in self.tests)  # others have no names yet
        if not self.all_built:
            self.not_run.append("names and labels of tests were not looked up: not all tests are built")

    def ask(self, *words):
        return subprocess.run([self.program, *words], check=True, capture_output=True, text=True).stdout

    # --- what does not run ------------------------------------------------------------------------

    def misused(self, words):
        """Whether the help has a command and its options."""
        self.looked_up += 1
        command = "" if words[0].startswith("-") else words[0]
        if command not in self.options:
            return f"twinchute has no command {command}"
        wrong = [word for word in words if re.match("--?[a-zA-Z]", word) and word.split("=")[0] not in self.options[command]]
        return f"twinchute {command} has no option {wrong[0]}" if wrong else None

    def no_option(self, option):
        """Whether any command has an option."""
        self.looked_up += 1
        if option not in OTHERS:
            return None if any(option in options for options in self.options.values()) else f"no command has the option {option}"
        self.used.add(option)
        at_home = os.path.exists(os.path.join(self.tree, OTHERS[option]))
        return f"{OTHERS[option]} has no option {option}" if at_home and option not in text_of(self.tree, OTHERS[option]) else None

    def lacks(self, kind, value, label):
        """Whether what arguments of another program name is there."""
        def preset(of):
            return any(preset["name"] == value and not preset.get("hidden") for preset in self.presets[of + "Presets"])

        def test(pattern):
            return not self.all_built or any(re.search(pattern, name) and any(re.search(label or "", one) for one in labels)
                                             for name, labels in self.tests.items())
        if kind in ("command", "shards"):
            return self.misused(value.split())
        there = {
            "configure": lambda: preset("configure"), "build": lambda: preset("build"), "test": lambda: preset("test"),
            "package": lambda: preset("package"), "tree": lambda: value == "test" or preset("configure"),
            "bootstrap": lambda: f"./bootstrap {value} " in self.bootstrap,
            "target": lambda: re.search(rf"add_(custom_target|executable)\({value}[\s)]", self.cmake),
            "variable": lambda: re.search(rf"(option|set)\({value} ", self.cmake),
            "needed": lambda: value in self.bootstrap,
            "version": lambda: f"project(twinchute VERSION {value} " in self.cmake,
            "template": lambda: os.path.exists(os.path.join(self.tree, "data/campaigns", value)),
            "label": lambda: test(""), "name": lambda: test(value), "filter": lambda: test(value.replace(".*", r"\.")),
        }[kind]()
        return None if there else f"there is no {value} ({kind})"

    def of_other(self, words):
        """A command of another program, by its row."""
        for row in ELSEWHERE:
            found = row[0] == words[0] and re.fullmatch(row[1], " ".join(words[1:]))
            if found:
                self.used.add(row)
                self.elsewhere += 1
                named = found.groupdict()
                return next(filter(None, (self.lacks(kind, value, named.get("label")) for kind, value in named.items() if value)), None)
        return f"{shlex.join(words)}: neither runs here nor has a row in ELSEWHERE of tests/architecture/commands.py"

    # --- what runs --------------------------------------------------------------------------------

    def folder(self, page):
        """The folder of a page's commands."""
        place = os.path.join(self.scratch, re.sub(r"\W", "-", page))
        if not os.path.isdir(place):
            for name in ("home", "bin"):
                os.makedirs(os.path.join(place, name))
            os.symlink(self.program, os.path.join(place, "bin/twinchute"))
            os.symlink(os.path.join(self.tree, "docs"), os.path.join(place, "docs"))
            shutil.copytree(os.path.join(self.tree, "data"), os.path.join(place, "data"))
            for to, source in THE_READERS.get(page, {}).items():
                os.makedirs(os.path.join(place, to if source is None else os.path.dirname(to)))
                if source:
                    shutil.copy(os.path.join(self.tree, source), os.path.join(place, to))
        return place

    def run(self, place, line):
        """A command line in a shell."""
        more, expected = SHORTENED.get(line, ("", ""))[0], ENDS_WITH.get(line, (0, ""))[0]
        self.used.add(line)
        if more is None:
            return self.misused(shlex.split(line)[1:])
        if line in SHORTENED and line in self.ended:
            return self.ended[line]
        runs = f"{line} {more}".strip()
        for installed, here in INSTALLED.items():
            if installed in runs:
                self.used.add(installed)
                runs = runs.replace(installed, here)
        for path in BY_PATH.findall(runs):
            os.makedirs(os.path.join(place, path), exist_ok=True)
            if not os.path.exists(os.path.join(place, path, "twinchute")):
                os.symlink(self.program, os.path.join(place, path, "twinchute"))
        begin = time.monotonic()
        path = os.path.join(place, "bin") + os.pathsep + os.environ["PATH"]
        ended = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", runs], cwd=place, stdin=subprocess.DEVNULL, capture_output=True,
                               text=True, errors="replace", env=dict(os.environ, HOME=os.path.join(place, "home"), PATH=path))
        print(f"{time.monotonic() - begin:6.2f} s  {runs}")
        said = " ".join((ended.stderr.strip() or ended.stdout.strip()).splitlines()[-3:])
        self.ended[line] = None if ended.returncode == expected else f"{runs}: exit code {ended.returncode}, not {expected}: {said}"
        if "is not in this build" in said:
            self.not_run.append(f"not run: {line}: {said}")
            return None
        return self.ended[line]

    def without_vtk(self, line):
        if RENDERS in line and subprocess.run(["/usr/bin/env", "/usr/bin/python3", "-c", "import vtkmodules"], capture_output=True).returncode:
            self.not_run.append(f"not run: {line}: no Python with VTK (Debian: python3-vtk9)")
            return True
        return False

    def of_line(self, page, line):
        """A command line of a block: as a whole, or the program's part of it where others have rows."""
        try:
            commands = simple_commands(line)
        except ValueError as error:
            return f"{line}: {error}"
        if self.without_vtk(line):
            return None
        runs = [is_program(words[0]) or words[0] in BESIDE or words[0].startswith("docs/") for words in commands]
        if all(runs):
            return self.run(self.folder(page), line)
        wrong = [self.run(self.folder(page), shlex.join(words)) if here else self.of_other(words) for words, here in zip(commands, runs)]
        return next(filter(None, wrong), None)

    def is_whole(self, page, words):
        """Whether a command between backticks says all that it needs: no placeholder, and an operand that is there or should be."""
        if any(PLACEHOLDER.match(word) for word in words):
            return False
        if words[0].startswith("-") or "--help" in words or not self.operand.get(words[0], "SCENE").startswith(("SCENE", "FILE", "DIR")):
            return True
        operand = next((word for word in words[1:] if not word.startswith("-")), None)
        return operand is not None and (operand.startswith(("data/", "/")) or os.path.exists(os.path.join(self.folder(page), operand)))

    def of_span(self, page, text, made):
        """What stands between two backticks; most of it is no command."""
        try:
            commands = simple_commands(text)
        except ValueError as error:
            return f"{text}: {error}" if text.startswith("twinchute ") or "--" in text else None
        for words in commands:
            wrong = None
            if is_program(words[0]):
                if not words[1:] or words[1][0].isdigit():  # a name, with a version
                    continue
                runs = not made and self.is_whole(page, words[1:])
                wrong = self.run(self.folder(page), text if len(commands) == 1 else shlex.join(words)) if runs else self.misused(words[1:])
            elif " " in text and any(words[0] == row[0] for row in ELSEWHERE):
                wrong = self.of_other(words)
            elif words[0] in self.options and words[1:] and words[1].startswith("--"):
                wrong = self.misused(words)
            else:
                wrong = next(filter(None, (self.no_option(word.split("=")[0]) for word in words if re.match("--[a-z]", word))), None)
            if wrong:
                return wrong
        return None

    def of_page(self, name, text):
        """Findings of a page, as FILE:LINE: WHAT."""
        bad = []
        for line, kind, said in Page(text).items:
            if kind == "line":
                wrong = self.of_line(name, said)
            elif kind in ("span", "made"):
                wrong = self.of_span(name, said, kind == "made")
            elif kind == "unknown":
                wrong = f"{said}; commands have no language, and other fences one of {', '.join(FILES)}"
            else:
                with open(os.path.join(self.folder(name), kind), "w") as stream:
                    stream.write(said)
                continue
            if wrong:
                bad.append(f"{name}:{line}: {wrong}")
        return bad

    def of_example(self, name, text):
        return [f"{name}:{at}: {wrong}" for at, line in enumerate(text.splitlines(), 1)
                for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", line) if (wrong := self.no_option(option))]

    def of_all(self):
        def files(*patterns):
            paths = {path for at in patterns for path in glob.glob(os.path.join(self.tree, at), recursive=True)}
            return [(name, text_of(self.tree, name)) for name in sorted(os.path.relpath(path, self.tree) for path in paths)]
        bad = [wrong for name, text in files(*PAGES) if not name.startswith(NOT_PAGES) for wrong in self.of_page(name, text)]
        return bad + [wrong for name, text in files(EXAMPLES) for wrong in self.of_example(name, text)] + self.unused()

    def unused(self):
        rows = [*ELSEWHERE, *INSTALLED, *SHORTENED, *ENDS_WITH, *OTHERS]
        return [f"tests/architecture/commands.py: no page has {row if isinstance(row, str) else ' '.join(row[:2])}, which has a row"
                for row in rows if row not in self.used]


def can_fail(documentation):
    """Breaks a page in each way that is looked for: 0 where every breach is found, at its line."""
    code, tests = 0, re.compile("ctest .*-[LR]|verification_tests")
    scene = "data/scenes/c9-inflation.toml"
    right = f"Text\n`twinchute rom {scene} --units us`\n\n```\ntwinchute rom {scene} \\\n   --out c9  # and its record\nbuild/demo/twinchute rom c9.toml\n```\n"
    right = right.replace("Text", f"`c9.toml`:\n\n```toml\n{text_of(documentation.tree, scene)}```\n")
    if documentation.of_page("right.md", right):
        print("refused:", documentation.of_page("right.md", right))
        code = 1
    lines = (f"twinchute rom {scene} --sensitivty", f"twinchute romm {scene}", "twinchute rom data/scenes/no-such.toml", "twinchute rom c10.toml",
             f"twinchute rom {scene} --set payload.mas=1", f"sed s/21/x/ {scene} | twinchute rom - | sed s/a/b/", "no_such_program --quiet",
             f"twinchute rom {scene} && no_such_program", "./bootstrap demos", "cmake --preset relase", "cmake --build --preset release --target tidi",
             "cmake --preset asan -DTWINCHUTE_FUZZ_MINUTES=10", "ctest --preset relase", "ctest --preset release -L verifcation",
             "ctest --test-dir build/release -R no_such_test", "ctest --test-dir build/test -L unit -R architecture.rules", "cpack --preset release",
             "apt-get install no-such-package", "apt-get install ./build/package/packages/twinchute_9.9.9-1_amd64.deb", "echo 'no end")
    spans = (f"twinchute rom {scene} --sensitivty", "twinchute romm SCENE", "twinchute rom SCENE --sensitivty", "twinchute rom data/scenes/no-such.toml",
             "twinchute list kes", "rom --sensitivty", "--sensitivty", "--out DIR --sensitivty=1", "man twinchute-no-such", "ctest -L verifcation",
             "verification_tests --gtest_filter=NoSuch.*", "sbatch --array=1-8 no-such.sh CAMPAIGN.toml DIR",
             "parallel twinchute campaign FILE --sharp {}/16 ::: $(seq 16)", "cmake --no-such")
    if not documentation.all_built:
        print(*documentation.not_run)
        lines, spans = ([text for text in texts if not tests.match(text)] for texts in (lines, spans))
    for wrong in [f"```\necho\n{line}\n```" for line in lines] + [f"a\n`{span}`" for span in spans] + ["a\n```console\n```", "a\n```"]:
        found = documentation.of_page("wrong.md", f"{wrong}\n")
        at = 3 if wrong.startswith("```") else 2
        if len(found) != 1 or not found[0].startswith(f"wrong.md:{at}: "):
            print(f"not found at line {at}: {wrong}\n{found}")
            code = 1
    if len(documentation.of_example("wrong.yml", "a\n  run: x --tolerance 1 --tolerence 1\n")) != 1:
        print("not found in an example: --tolerence")
        code = 1
    before = documentation.unused()
    documentation.of_page("right.md", "`--keep`\n")
    if len(documentation.unused()) != len(before) - 1:
        print("not found: a row that no page has")
        code = 1
    return code


def main(arguments):
    with tempfile.TemporaryDirectory(prefix="twinchute-commands-") as scratch:
        documentation = Documentation(*arguments[:4], scratch)
        if arguments[4:] == ["can-fail"]:
            return can_fail(documentation)
        bad = documentation.of_all()
    print("\n".join(documentation.not_run + bad))
    print(f"{len(documentation.ended)} command lines ran, {documentation.looked_up} commands and options were looked up, "
          f"{documentation.elsewhere} command lines have a row: {len(bad)} are wrong")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
