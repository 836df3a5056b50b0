#!/usr/bin/env python3
"""Whether docs/adding.md sends its readers to the right files.

    adding.py TREE           every path that it names is there, what is said to have rows has rows, what a row of the page calls by name
                             stands in a file of that row, and nothing is said twice
    adding.py TREE can-fail  that each of these is found when it is wrong
"""

import glob
import os
import re
import sys

SUFFIXES = (".cpp", ".hpp", ".py", ".css", ".md")
# A row of a table, in C++ or Python: {"name", ...}, {.path = ...}, Piece{...}, rows.push_back({...}), "name": (...), Row(NAME, "...".
A_ROW = re.compile(r'^\s*\w*\{(?:\.\w+ = |"|[\w:]+, *"|\{)|^\s+"[\w -]+": [({]|^\s+[A-Z]\w*[{(][A-Z]\w*, "|push_back\(\{', re.MULTILINE)


def found(tree, name, near):
    """Files that a name means: from the root, or beside those that were named before it."""
    return next((paths for place in ["", *reversed(near)] if (paths := glob.glob(os.path.join(tree, place, name)))), [])


def faults(tree, page):
    bad, seen = [], set()
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        if not line.startswith("| ") or len(cells) != 2 or cells[0] in ("to add", "---"):
            continue
        what, where = cells
        if what in seen:
            bad.append(f"'{what}' is said twice")
        seen.add(what)
        near, files, names = [], [], []
        for token in re.finditer(r"`([^`]+)`(: (?:one|its) row)?", where):
            name = token.group(1)
            if not name.endswith(SUFFIXES) and not name.endswith("/"):
                names.append(name)
                continue
            paths = found(tree, name, near)
            if not paths:
                bad.append(f"'{what}': there is no {name}")
                continue
            near.append(os.path.relpath(paths[0] if os.path.isdir(paths[0]) else os.path.dirname(paths[0]), tree))
            files += [path for path in paths if os.path.isfile(path)]
            keyed = re.search(r"\b(word|key|name)\b[^`;]*$", where[:token.start()])  # its word in a table of keys
            if (token.group(2) or keyed) and os.path.isfile(paths[0]) and not A_ROW.search(text_of(paths[0])):
                bad.append(f"'{what}': {name} has no rows")
        for name in names:
            last = re.split(r"::|\.", name)[-1]
            if re.fullmatch(r"\w+(?:::\w+)*", name) and any("main.cpp" not in file for file in files) and not any(re.search(rf"\b{last}\b", text_of(file)) for file in files):
                bad.append(f"'{what}': {name} stands in none of its files")
    if len(seen) < 30:
        bad.append(f"only {len(seen)} rows were understood")
    return bad


def text_of(file):
    with open(file) as stream:
        return stream.read()


def main(arguments):
    tree = arguments[0]
    page = text_of(os.path.join(tree, "docs", "adding.md"))
    if arguments[1:] == []:
        bad = faults(tree, page)
        print("\n".join(bad) or "docs/adding.md: every path is there")
        return 1 if bad else 0
    row = "| an atmosphere | `lib/models/atmosphere.cpp`: one function and its row |\n"
    if row not in page:
        print("the row that is broken here has another wording")
        return 1
    code = 0
    for wrong in (row.replace("atmosphere.cpp", "air.cpp"), row.replace("models/atmosphere.cpp`: one function and its", "scene/keys.cpp`: one"),
                  row.replace("one function", "`no_such_name`"), row + row):
        if not faults(tree, page.replace(row, wrong)):
            print(f"not found: {wrong}")
            code = 1
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
