"""Notebooks do what they show: their cells run in order, from their own directory, and print what is stored in
them. Numbers may differ by 2e-3: a kernel for another instruction set rounds differently, which a full run
carries on to 1e-3 at most, and a printed number has three digits or more."""

import contextlib
import io
import json
import pathlib
import re

import pytest

NOTEBOOKS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "notebooks"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def code_cells(notebook):
    for cell in json.loads(notebook.read_text())["cells"]:
        if cell["cell_type"] == "code":
            printed = "".join("".join(o["text"]) for o in cell["outputs"] if o["output_type"] == "stream")
            yield "".join(cell["source"]), printed


@pytest.mark.parametrize("name", ["first-drop", "calibrate", "campaign"])
def test_prints_what_it_shows(name, monkeypatch):
    monkeypatch.chdir(NOTEBOOKS)
    monkeypatch.setenv("MPLBACKEND", "agg")
    try:
        import matplotlib  # noqa: F401
        plots = True
    except ImportError:
        plots = False
    names = {}
    compared = 0
    for source, stored in code_cells(NOTEBOOKS / f"{name}.ipynb"):
        if ("matplotlib" in source or "plt." in source) and not plots:
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(source, f"{name}.ipynb", "exec"), names)
        text = printed.getvalue()
        assert NUMBER.sub("#", text).split() == NUMBER.sub("#", stored).split()
        for now, then in zip(map(float, NUMBER.findall(text)), map(float, NUMBER.findall(stored))):
            assert now == pytest.approx(then, rel=2e-3)
            compared += 1
    assert compared > 8


def test_every_notebook_is_run():
    assert sorted(p.stem for p in NOTEBOOKS.glob("*.ipynb")) == ["calibrate", "campaign", "first-drop"]
