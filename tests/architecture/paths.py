#!/usr/bin/env python3
"""Checks that the pages send their readers to the right places.

    paths.py TREE           every path in backticks in PAGES exists, every link of a page (*.md) has its file and its heading, and
                            the rows of docs/adding.md hold: a file with rows has rows, a name stands in a file of its row, no row
                            stands twice
    paths.py TREE can-fail  breaks each of these, and finds the breach
"""

import glob
import os
import re
import sys

PAGES = ("README.md", "CONTRIBUTING.md", "docs/architecture.md", "docs/adding.md")
SUFFIXES = (".cpp", ".hpp", ".py", ".css", ".md")
# Files and folders that a user or a build makes.
MADE = re.compile(r"(build|first\.out|random-drops|\./<[^>]*>\.out)(/|$)|(ladder|first|report|summary|stability|trend|series)\.\w+$")
# One path, alone between backticks: with a slash, or with the suffix of a source.
A_PATH = re.compile(r"\.?[\w.*-]+(?:/[\w.*-]+)*/?")
# Row of a table, in C++ or Python: {"name", ...}, {.path = ...}, Piece{...}, rows.push_back({...}), "name": (...), Row(NAME, "...".
A_ROW = re.compile(r'^\s*\w*\{(?:\.\w+ = |"|[\w:]+, *"|\{)|^\s+"[\w -]+": [({]|^\s+[A-Z]\w*[{(][A-Z]\w*, "|push_back\(\{', re.MULTILINE)


def found(tree, name, near):
    """Files that a name means: from the root, or beside those named before it."""
    return next((paths for place in ["", *reversed(near)] if (paths := glob.glob(os.path.join(tree, place, name)))), [])


def headings(text):
    """Anchors of a page, as GitHub makes them of its headings."""
    lines = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL).splitlines()
    return {re.sub(r"[^\w -]", "", line.lstrip("#").strip().lower()).replace(" ", "-") for line in lines if line.startswith("#")}


def prose(text):
    return re.sub(r"^```.*?^```|<!--.*?-->", "", text, flags=re.MULTILINE | re.DOTALL)


def bad_links(tree, name, text):
    """Links of a page to a file or a heading that is not there."""
    bad = []
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(text)):
        if "://" in target or target.startswith("mailto:"):
            continue
        path, _, anchor = target.partition("#")
        file = os.path.normpath(os.path.join(tree, os.path.dirname(name), path)) if path else os.path.join(tree, name)
        if not os.path.exists(file):
            bad.append(f"{name}: the link {target} leads nowhere")
        elif anchor and anchor not in headings(text_of(file) if path else text):
            bad.append(f"{name}: {path or name} has no heading #{anchor}")
    return bad


def bad_paths(tree, name, text):
    """Paths in backticks that are not there. A path stands from the root, beside the page, or below one named in the same line."""
    bad = []
    for line in prose(text).splitlines():
        near = [os.path.dirname(name)]
        for token in re.findall(r"`([^`]+)`", line):
            if not A_PATH.fullmatch(token) or not ("/" in token or token.endswith(SUFFIXES)) or MADE.match(token):
                continue
            paths = found(tree, token, near)
            if paths:
                near.append(os.path.relpath(paths[0] if os.path.isdir(paths[0]) else os.path.dirname(paths[0]), tree))
            else:
                bad.append(f"{name}: there is no {token}")
    return bad


def pages(tree):
    """Names of the pages whose links are checked."""
    below = (path for at in ("*.md", "docs/**/*.md", "data/**/*.md") for path in glob.glob(os.path.join(tree, at), recursive=True))
    return sorted(os.path.relpath(path, tree) for path in below)


def bad_places(tree, name, text):
    return bad_links(tree, name, text) + (bad_paths(tree, name, text) if name in PAGES else [])


def bad_rows(tree, page):
    """Rows of docs/adding.md that do not hold."""
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


def can_fail(tree):
    """Breaks a page in each way that is looked for: 0 where every breach is found."""
    adding = text_of(os.path.join(tree, "docs/adding.md"))
    row = "| an atmosphere | `lib/models/atmosphere.cpp`: one function and its row |\n"
    if row not in adding:
        print("the row that is broken here has another wording")
        return 1
    code = 0
    for wrong in (row.replace("atmosphere.cpp", "air.cpp"), row.replace("models/atmosphere.cpp`: one function and its", "scene/keys.cpp`: one"),
                  row.replace("one function", "`no_such_name`"), row + row):
        if not bad_rows(tree, adding.replace(row, wrong)):
            print(f"not found: {wrong}")
            code = 1
    for name in PAGES:
        text = text_of(os.path.join(tree, name))
        up = "../" * name.count("/")
        for wrong in ("`lib/no_such_folder/`", "`lib/math/no_such_file.hpp`", "`no_such_file.cpp`", "[a page](no_such_page.md)",
                      f"[a heading]({up}docs/glossary.md#no-such-heading)"):
            if len(bad_places(tree, name, f"{text}\n\n{wrong}\n")) != len(bad_places(tree, name, text)) + 1:
                print(f"not found in {name}: {wrong}")
                code = 1
        right = f"`lib/math/` and `lib/math/*.hpp`, [glossary]({up}docs/glossary.md#glossary)"
        if bad_places(tree, name, right):
            print(f"refused in {name}: {right}")
            code = 1
    return code


def main(arguments):
    tree = arguments[0]
    if arguments[1:] == ["can-fail"]:
        return can_fail(tree)
    names = pages(tree)
    bad = [line for name in names for line in bad_places(tree, name, text_of(os.path.join(tree, name)))]
    bad += bad_rows(tree, text_of(os.path.join(tree, "docs/adding.md")))
    print("\n".join(bad) or f"{len(names)} pages: every path and link is there")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
