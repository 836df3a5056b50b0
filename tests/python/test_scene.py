"""Scenes: from files and dicts, with other values, and what is said of wrong ones."""

import pathlib
import pickle
import tomllib

import numpy
import pytest

import twinchute
from conftest import SOURCE


def test_a_file_and_its_dict_are_one_scene(c9):
    scene = twinchute.Scene.load(c9)
    with open(c9, "rb") as stream:
        values = tomllib.load(stream)
    assert twinchute.Scene.from_dict(values) == scene
    assert scene.name == values["name"]
    assert twinchute.Scene.from_dict(values, directory=c9.parent) != scene.with_values({"payload.mass": 150})


def test_to_toml_is_the_same_scene(c9, tmp_path):
    scene = twinchute.Scene.load(c9, {"payload.mass": 0.1 + 0.2})  # a number that short decimals miss
    (tmp_path / "again.toml").write_text(scene.to_toml())
    assert twinchute.Scene.load(tmp_path / "again.toml") == scene


# One pound is 0.45359237 kg by definition.
@pytest.mark.parametrize(
    "value, kilograms",
    [(160, 160.0), (160.5, 160.5), ("160 kg", 160.0), ("336 lbm", 336 * 0.45359237), (numpy.float32(0.5), 0.5), (numpy.int64(7), 7.0)],
)
def test_a_value_is_a_number_in_si_or_text_with_a_unit(c9, value, kilograms):
    for scene in (twinchute.Scene.load(c9, overrides={"payload.mass": value}), twinchute.Scene.load(c9).with_values({"payload.mass": value})):
        assert scene.inputs["payload.mass"] == pytest.approx(kilograms, rel=1e-15)
    scene = twinchute.Scene.load(c9)
    scene.set("payload.mass", value)
    assert scene.inputs["payload.mass"] == pytest.approx(kilograms, rel=1e-15)


def test_set_takes_what_the_program_takes(c9):
    scene = twinchute.Scene.load(c9, set=["payload.mass='336 lbm'", "release.speed=25"])
    assert scene == twinchute.Scene.load(c9, {"payload.mass": "336 lbm", "release.speed": 25})


def test_values_may_be_tables_lists_and_paths(c9, tmp_path):
    scene = twinchute.Scene.load(c9, {"environment.atmosphere": {"model": "us76", "temperature_offset": "15 K"}})
    assert scene.inputs["environment.atmosphere.temperature_offset"] == 15.0
    (tmp_path / "wind.csv").write_text("altitude,speed,from\nm,m/s,deg\n0,3,250\n1000,5,250\n")
    with open(c9, "rb") as stream:
        values = tomllib.load(stream)
    values["environment"]["wind"] = {"table": pathlib.Path("wind.csv")}
    assert twinchute.Scene.from_dict(values, directory=tmp_path).inputs["environment.wind.table"] == "wind.csv"
    values["parachute"][0].update(count=2, lag=[0, 0.4])  # a list: one lag for each canopy
    twinchute.Scene.from_dict(values, directory=tmp_path)
    values["parachute"][0]["lag"] = (0, 0.4, 0.8)
    with pytest.raises(twinchute.SceneError, match="lag"):
        twinchute.Scene.from_dict(values, directory=tmp_path)


def test_text_stays_text(c9):
    name = 'tail \\ "quote" \t \x7f \u00e9'
    scene = twinchute.Scene.load(c9, {"name": name})
    assert scene.name == name


def test_what_is_no_value_is_refused(c9):
    for value in (None, {1, 2}, object(), b"160"):
        with pytest.raises(TypeError, match="payload.mass"):
            twinchute.Scene.load(c9, {"payload.mass": value})


def test_an_error_names_file_line_and_key(c9, tmp_path, program):
    wrong = tmp_path / "wrong.toml"
    lines = c9.read_text().splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("mass"))
    wrong.write_text("\n".join([*lines[:at], 'mas = "152.4 kg"', *lines[at + 1 :]]))
    with pytest.raises(twinchute.SceneError) as caught:
        twinchute.Scene.load(wrong)
    error = caught.value
    assert (error.file, error.line, error.column, error.key) == (str(wrong), at + 1, 1, "payload.mas")
    assert "did you mean" in error.suggestion and "payload.mass" in error.suggestion
    assert isinstance(error, ValueError) and isinstance(error, twinchute.Error)
    # Word for word what the program says.
    assert str(error) == program("rom", wrong)[2].rstrip("\n")


def test_an_error_names_the_parts_of_its_complaint(c9):
    with pytest.raises(twinchute.SceneError) as caught:
        twinchute.Scene.load(c9, {"payload.mass": "160 m"})
    error = caught.value
    assert (error.file, error.line, error.column, error.key) == ("--set", None, None, "payload.mass")
    assert str(error) == f"--set: payload.mass: {error.problem} ({error.why}), {error.suggestion}"


def test_lines_of_a_dict_are_not_named():
    with pytest.raises(twinchute.SceneError) as caught:
        twinchute.Scene.from_dict({"schema": 1, "name": "x", "payload": {"mas": 1}})
    assert (caught.value.file, caught.value.line, caught.value.key) == ("<dict>", None, "payload.mas")
    assert str(caught.value).startswith("<dict>: payload.mas: ")


def test_set_that_fails_changes_nothing(c9):
    scene = twinchute.Scene.load(c9)
    with pytest.raises(twinchute.SceneError):
        scene.set("payload.mass", -1)
    assert scene == twinchute.Scene.load(c9)


def test_series():
    path = SOURCE / "data/scenes/c9-inflation-speeds.toml"
    series = twinchute.Scene.load(path)
    with open(path, "rb") as stream:
        cases = tomllib.load(stream)["case"]
    assert series.cases == tuple(case["name"] for case in cases)
    one = series.case(cases[1]["name"])
    # What the case sets is what it has.
    key, value = next(iter(cases[1]["set"].items()))
    assert one == one.with_values({key: value})
    assert one != series.case(cases[0]["name"])
    with pytest.raises(twinchute.UsageError, match=f"a series of {len(cases)} cases"):
        twinchute.rom(series)
    with pytest.raises(twinchute.UsageError, match="there is no case 'x'"):
        series.case("x")


def test_pickle(c9):
    scene = twinchute.Scene.load(c9, {"payload.mass": 150})
    assert pickle.loads(pickle.dumps(scene)) == scene
