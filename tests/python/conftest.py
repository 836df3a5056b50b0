"""What the tests of the Python module share: the program to compare with, and small scenes."""

import json
import os
import pathlib
import subprocess

import pytest

SOURCE = pathlib.Path(os.environ["TWINCHUTE_SOURCE_DIR"])
PROGRAM = os.environ["TWINCHUTE_PROGRAM"]

# A full run of a moment: few elements, short flight.
MOMENT = {"stop.time": 0.25, "full.mesh.gore_columns": 1, "full.mesh.gore_rows": 4, "full.mesh.line_elements": 4}


@pytest.fixture
def c9():
    """A scene with nothing optional left out, stopped when the descent is steady."""
    return SOURCE / "data/scenes/c9-inflation.toml"


@pytest.fixture
def program(tmp_path):
    """Runs the program: its exit code, standard output and standard error."""

    def run(*words):
        ended = subprocess.run([PROGRAM, *map(str, words)], cwd=tmp_path, capture_output=True, text=True, check=False)
        return ended.returncode, ended.stdout, ended.stderr

    return run


@pytest.fixture
def record_of(program, tmp_path):
    """Runs the program with --out: summary.json, and the directory."""

    def run(*words):
        code, _, error = program(*words, "--quiet", "--out", tmp_path / "cli")
        assert code == 0, error
        return json.loads((tmp_path / "cli/summary.json").read_text()), tmp_path / "cli"

    return run


def sets(values):
    """--set of each value."""
    return [word for key, value in values.items() for word in ("--set", f"{key}={value}")]
