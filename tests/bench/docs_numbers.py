#!/usr/bin/env python3
"""Compares marked numbers in the prose of README.md and docs/ with the program.

    docs_numbers.py check TREE PROGRAM   fails where a marked number differs from the program, or from a table of its page
    docs_numbers.py make TREE PROGRAM    writes the numbers of the program

A comment behind a number, which no reader sees, names its source:

    4975<!-- = full c9-inflation peak_force_N --> N         a metric of a run of a scene of data/scenes
    1.5<!-- = full c9-speeds:fr-2.7 filling_time_s --> s     of a case of a series
    48<!-- = [gap-demo: + Line elasticity | Peak opening force [N]] --> N    a cell of a block that docs_tables.py makes
    0.5<!-- = 100 * (full c9-inflation peak_force_N / rom c9-inflation peak_force_N - 1) --> %    arithmetic with these

A comment <!-- A = B --> alone demands that two of them agree to the digits of the first, a cell. Results of the full model are equal to
the last digit only with the same compiler and instruction set. The last line of a page names those of its numbers; with others the check
skips its numbers of the full model.
"""

import ast
import json
import operator
import os
import re
import subprocess
import sys
import tempfile

PAGES = ["README.md", "docs"]
NUMBER = r"[-+]?\d+(?:\.\d+)?"
MARK = re.compile(rf"({NUMBER})<!-- = (.*?) -->", re.DOTALL)
PAIR = re.compile(r"<!-- (\[[^=]*\]) = (.*?) -->", re.DOTALL)
MADE = re.compile(r"<!-- numbers made with (.*) -->\n")
RUN = re.compile(r"\b(rom|full) ([\w./-]+)(?::([\w.-]+))? (\w+)")
CELL = re.compile(r"\[([\w-]+): ([^|]+?) \| (.+?)\](?=[\s)*/+-]|$)")


class Program:
    def __init__(self, tree, program):
        self.tree, self.program, self.records = tree, program, {}

    def records_of(self, command, scene):
        """The records of a run by case, "" where there is one."""
        if (command, scene) not in self.records:
            file = os.path.join(self.tree, "data", "scenes", scene + ".toml")
            with tempfile.TemporaryDirectory() as directory:
                ended = subprocess.run([self.program, command, file, "--json", "--out", directory], stdin=subprocess.DEVNULL,
                                       capture_output=True, text=True)
            if ended.returncode != 0:
                sys.exit(f"{command} {scene} ended with {ended.returncode}: {ended.stderr[-1000:]}")
            read = json.loads(ended.stdout)
            self.records[command, scene] = ({record["scene"]["name"].rsplit(", ", 1)[1]: record for record in read}
                                         if isinstance(read, list) else {"": read})
        return self.records[command, scene]

    def metric(self, command, scene, case, name):
        return self.records_of(command, scene)[case or ""]["metrics"][name]

    def made_with(self):
        made = self.records_of("full", "c9-inflation")[""]["provenance"]
        return f"{made['compiler']}, {made['instruction_set'].split(',')[0]}"


def cell(page, block, row, column):
    """Of a block that stands between its markers: the text of a cell."""
    begin, end = (f"<!-- {word} of what docs-tables makes: {block} -->\n" for word in ("begin", "end"))
    lines = [re.split(r"\s*\|\s*|\s{2,}", line.strip("| ")) for line in page.split(begin)[1].split(end)[0].splitlines()]
    head = next(line for line in lines if column in line)
    # The first cell of a row may be the only one without a head above it.
    return next(line for line in lines if line[0] == row)[head.index(column) - len(head)]


def arithmetic(text):
    """The value of numbers, + - * / and brackets."""
    known = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}

    def value(node):
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
            return node.value
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            return -value(node.operand)
        if isinstance(node, ast.BinOp) and type(node.op) in known:
            return known[type(node.op)](value(node.left), value(node.right))
        raise ValueError(text)

    return value(ast.parse(" ".join(text.split()), mode="eval").body)


def decimals(number):
    return len(number.partition(".")[2])


class Page:
    def __init__(self, path, program):
        self.path, self.program = path, program
        with open(path) as file:
            self.text = file.read()
        self.bad, self.held, self.left = [], 0, 0
        made = MADE.search(self.text)
        self.same = made is not None and made.group(1) == program.made_with() if self.is_marked() else True

    def is_marked(self):
        return MARK.search(self.text) or PAIR.search(self.text)

    def value(self, expression):
        """None where it is one of the full model's, which this build makes otherwise."""
        try:
            if not self.same and re.search(r"\bfull \w", CELL.sub("", expression)):
                self.left += 1
                return None
            cells = CELL.sub(lambda m: f"({float(cell(self.text, *m.groups()))})", expression)
            return arithmetic(RUN.sub(lambda m: f"({self.program.metric(*m.groups())!r})", cells))
        except (KeyError, ValueError, SyntaxError, IndexError, StopIteration) as error:
            self.bad.append(f"'{expression}' is not understood: {error!r}")
            return None

    def compare(self, quoted, expression):
        value = self.value(expression)
        if value is None:
            return
        self.held += 1
        # Half a unit of the last digit, and what is a tie in a table that is rounded itself.
        if abs(value - float(quoted)) > 0.51 * 10.0 ** -decimals(quoted):
            self.bad.append(f"{quoted} stands where {expression} is {value:.{decimals(quoted) + 1}f}")

    def check(self):
        if self.is_marked() and not MADE.search(self.text):
            self.bad.append("its last line does not name the compiler that its numbers were made with: docs_numbers.py make")
        for quoted, expression in MARK.findall(self.text):
            self.compare(quoted, expression)
        for of_table, expression in PAIR.findall(self.text):
            if self.value(of_table) is not None:
                self.compare(cell(self.text, *CELL.fullmatch(of_table).groups()), expression)
        return [f"{self.path}: {line}" for line in self.bad]

    def make(self):
        if not self.is_marked():
            return
        self.same = True

        def renewed(mark):
            value = self.value(mark.group(2))
            if value is None:
                return mark.group(0)
            sign = "+" if mark.group(1).startswith("+") else ""
            return f"{value:{sign}.{decimals(mark.group(1))}f}<!-- = {mark.group(2)} -->"

        text = MADE.sub("", MARK.sub(renewed, self.text))
        with open(self.path, "w") as file:
            file.write(text + f"<!-- numbers made with {self.program.made_with()} -->\n")


def pages(tree, program):
    for name in PAGES:
        path = os.path.join(tree, name)
        files = [path] if os.path.isfile(path) else sorted(os.path.join(at, file) for at, _, names in os.walk(path) for file in names)
        for file in files:
            if file.endswith(".md"):
                yield Page(file, program)


def main(arguments):
    if len(arguments) != 3 or arguments[0] not in ("check", "make"):
        print(__doc__)
        return 2
    bad, held, left = [], 0, 0
    for page in pages(arguments[1], Program(*arguments[1:])):
        if arguments[0] == "make":
            page.make()
            page = Page(page.path, page.program)
        bad += page.check()
        held, left = held + page.held, left + page.left
    print("\n".join(bad + [f"{held} numbers held, {left} left alone: made with another compiler or instruction set"]))
    return 1 if bad or held == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
