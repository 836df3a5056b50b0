"""The pages of the site: cmake --build ... --target site. Sphinx with MyST reads README.md and docs/ as they are."""

import json
import os
import subprocess

from docutils import nodes

project = "twinchute"
author = copyright = "The twinchute developers"
extensions = ["myst_parser"]
root_doc = "README"
include_patterns = ["*.md", "docs/**"]
exclude_patterns = ["build*", "docs/site"]
source_suffix = {".md": "markdown"}
myst_heading_anchors = 6  # as GitHub makes them of headings
suppress_warnings = ["myst.header"]  # generated pages begin with smaller headings
highlight_language = "none"
html_theme = "furo"
html_title = "twinchute"
html_extra_path = ["extra"]
html_copy_source = False
html_last_updated_fmt = None

# Sphinx wants a tree of pages; GitHub has the tables of the README.
CONTENTS = """
```{toctree}
:hidden:
:caption: Guides
:glob:
docs/guide/*
```
```{toctree}
:hidden:
:caption: Theory and evidence
:glob:
docs/theory/*
docs/verification
docs/validation
docs/ladder
docs/stability
docs/cost
docs/generated/*
```
```{toctree}
:hidden:
:caption: Project
docs/glossary
docs/architecture
docs/adding
CONTRIBUTING
CHANGELOG
SECURITY
```
"""
API = '\n<p><a href="{}api/files.html">The C++ interface, header by header</a></p>\n'  # by Doxygen
KEYS, LIBRARY = "docs/guide/keys", "docs/guide/library"
keys = json.loads(subprocess.run([os.environ["TWINCHUTE"], "list", "keys", "--json"], check=True, capture_output=True, text=True).stdout)
names = {row["key"] for row in keys if "." in row["key"]}


def plain(text):
    """Text that Markdown leaves as it is."""
    return "".join("\\" + c if c in "\\`*_{}[]()<>#+-.!|$^~" else c for c in text)


def entry(row):
    rows = "\n".join(f"- {plain(name)}: {plain(value)}" for name, value in row.items() if name not in ("key", "meaning") and value)
    return f'\n<span id="{row["key"]}"></span>\n\n### `{row["key"]}`\n\n{plain(row["meaning"])}\n\n{rows}\n'


def complete(app, name, source):
    """Adds what is not in the files: the tree of pages, the C++ interface, and the keys as the program lists them."""
    if name == root_doc:
        source[0] += API.format("") + CONTENTS
    if name == LIBRARY:
        source[0] += API.format("../../")
    if name == KEYS:
        shown = None
        for row in keys:
            first = row["key"].split(".")[0]
            table = first if any(name.startswith(f"{first}.") for name in names) else "scene"
            if table != shown:
                source[0] += f"\n## {table}\n"
                shown = table
            source[0] += entry(row)


def link_keys(app, tree, name):
    """Makes every key that a page names a link to its entry."""
    for literal in list(tree.findall(nodes.literal)):
        if literal.astext() in names and name != KEYS and not isinstance(literal.parent, (nodes.reference, nodes.title)):
            target = f"{app.builder.get_relative_uri(name, KEYS)}#{literal.astext()}"
            literal.replace_self(nodes.reference("", "", literal.deepcopy(), internal=True, refuri=target))


def leave_folder(app, env, link, text):
    """A link to a folder of the repository is text here."""
    folder = os.path.join(app.srcdir, os.path.dirname(link.get("refdoc", "")), link["reftarget"])
    return text if os.path.isdir(folder) else None


def setup(app):
    app.connect("source-read", complete)
    app.connect("missing-reference", leave_folder)
    app.connect("doctree-resolved", link_keys)
