"""Batches, sizing, calibration, campaigns."""

import json

import numpy
import pytest

import twinchute
from conftest import SOURCE

C9_TO_THE_PEAK = {"stop.at": "peak-force"}


def singles(scene, inputs, metric):
    """One run each."""
    rows = zip(*inputs.values())
    return numpy.array([twinchute.rom(scene.with_values(dict(zip(inputs, map(float, row)))))[metric] for row in rows])


def test_batch_is_single_runs(c9):
    """One by one where the scene takes no lanes: the same bits."""
    scene = twinchute.Scene.load(c9)
    rng = numpy.random.default_rng(1)
    inputs = {"payload.mass": rng.uniform(140, 160, 30), "parachute.fill_time.n": rng.uniform(3, 5, 30)}
    batch = twinchute.rom_batch(scene, inputs, metrics=["peak_force", "descent_rate"])
    for metric in ("peak_force", "descent_rate"):
        numpy.testing.assert_array_equal(batch[metric], singles(scene, inputs, metric))
    assert batch.units == {"peak_force": "N", "descent_rate": "m/s"}
    assert {twinchute.statuses[code] for code in batch.status} == {"completed"}
    assert batch.refusal is None


def test_batch_in_lanes_is_single_runs_within_the_tolerance(c9):
    """A run to its peak goes in batches of 64, whose answers are those of single runs within the integrator's
    relative tolerance: 1e-6 by default, ten times that here, since a force follows from a velocity squared and an
    acceleration."""
    scene = twinchute.Scene.load(c9, C9_TO_THE_PEAK)
    rng = numpy.random.default_rng(2)
    inputs = {"payload.mass": rng.uniform(120, 180, 100), "release.speed": rng.uniform(18, 30, 100)}
    batch = twinchute.rom_batch(scene, inputs)
    numpy.testing.assert_allclose(batch["peak_force"], singles(scene, inputs, "peak_force"), rtol=1e-5)


def test_batch_is_the_same_for_any_number_of_threads(c9):
    scene = twinchute.Scene.load(c9, C9_TO_THE_PEAK)
    masses = numpy.linspace(120, 180, 9000)  # more than one part of a thread
    one = twinchute.rom_batch(scene, {"payload.mass": masses}, threads=1)
    three = twinchute.rom_batch(scene, {"payload.mass": masses}, threads=3)
    numpy.testing.assert_array_equal(one["peak_force"], three["peak_force"])
    assert numpy.all(numpy.diff(one["peak_force"]) > 0)  # a heavier payload pulls more


def test_batch_refuses_run_by_run(c9):
    scene = twinchute.Scene.load(c9)
    batch = twinchute.rom_batch(scene, {"payload.mass": [150.0, -1.0, numpy.nan, 150.0]})
    assert [twinchute.statuses[code] for code in batch.status] == ["completed", "refused", "refused", "completed"]
    assert numpy.isnan(batch["peak_force"]).tolist() == [False, True, True, False]
    assert batch["peak_force"][0] == batch["peak_force"][3] == twinchute.rom(scene.with_values({"payload.mass": 150}))["peak_force"]
    assert "payload.mass" in batch.refusal and "run 1" in batch.refusal
    with pytest.raises(twinchute.SceneError, match="payload.mass"):
        twinchute.rom_batch(scene, {"payload.mass": [-1.0, -2.0]})


def test_batch_broadcasts_numbers(c9):
    scene = twinchute.Scene.load(c9)
    batch = twinchute.rom_batch(scene, {"payload.mass": [150, 151], "release.speed": 25}, metrics="peak_force")
    wanted = singles(scene, {"payload.mass": [150, 151], "release.speed": [25, 25]}, "peak_force")
    numpy.testing.assert_array_equal(batch["peak_force"], wanted)


@pytest.mark.parametrize(
    "inputs, metrics, error, words",
    [
        ({"payload.mas": [1.0]}, ["peak_force"], twinchute.SceneError, "payload.mass"),
        ({"payload.mass": [150.0]}, ["peak_forc"], twinchute.UsageError, "did you mean 'peak_force'"),
        ({"payload.mass": ["150 kg"]}, ["peak_force"], twinchute.UsageError, "payload.mass"),
        ({"payload.mass": [1.0, 2.0], "release.speed": [1.0, 2.0, 3.0]}, ["peak_force"], twinchute.UsageError, "different lengths"),
        ({"payload.mass": []}, ["peak_force"], twinchute.UsageError, "one run at least"),
        ({}, ["peak_force"], twinchute.UsageError, "nothing varies"),
    ],
)
def test_batch_says_what_is_wrong(c9, inputs, metrics, error, words):
    with pytest.raises(error, match=words):
        twinchute.rom_batch(twinchute.Scene.load(c9), inputs, metrics)


def test_size(program):
    path = SOURCE / "data/scenes/sizing/rocket-main.toml"
    sizing = twinchute.size(twinchute.Scene.load(path))
    assert sizing.summary == json.loads(program("size", path, "--json")[1])
    assert sizing.meets
    # Its own run meets the limits that it was sized for.
    sized = twinchute.rom(sizing.scene)
    assert sized["descent_rate"] <= sizing.scene.inputs["size.max_descent_rate"] * (1 + 1e-6)
    with pytest.raises(twinchute.UsageError, match=r"\[size\]"):
        twinchute.size(twinchute.Scene.load(SOURCE / "data/scenes/c9-inflation.toml"))


def test_calibrate(program, tmp_path):
    data = SOURCE / "data/calibration"
    program("calibrate", data / "c9-drop.toml", "--to", data / "c9-drop-a.toml", "--out", tmp_path / "cli", "--quiet")
    theirs = json.loads((tmp_path / "cli/calibration.json").read_text())
    calibration = twinchute.calibrate(twinchute.Scene.load(data / "c9-drop.toml"), to=data / "c9-drop-a.toml")
    ours = calibration.summary
    assert ours["parameters"] == theirs["parameters"]
    # The answer is known: make_drops.py ran the model with n = 5.5.
    n = calibration.parameters["parachute.fill_time.n"]
    assert n["low"] < 5.5 < n["high"] and n["identified"]
    assert calibration.consistent
    calibration.to_dir(tmp_path / "ours")
    assert sorted(p.name for p in (tmp_path / "ours").iterdir()) == sorted(p.name for p in (tmp_path / "cli").iterdir())
    calibrated = twinchute.Scene.load(tmp_path / "ours/calibrated.toml")
    assert calibrated.inputs["parachute.fill_time.n"] == n["estimate"]
    with pytest.raises(twinchute.UsageError, match="no test"):
        twinchute.calibrate(twinchute.Scene.load(data / "c9-drop.toml"), to=[])


def test_campaign(program, tmp_path):
    text = (SOURCE / "data/campaigns/c9-overload.toml").read_text().replace("runs   = 20000", "runs   = 256")
    assert "runs   = 256" in text
    (tmp_path / "small.toml").write_text(text)
    code, out, error = program("campaign", tmp_path / "small.toml", "--out", tmp_path / "cli", "--json", "--threads", "1")
    if "is not in this build" in error:
        pytest.skip("this build has no campaigns")
    assert code in (0, 1), error
    ours = twinchute.campaign(tmp_path / "small.toml", out=tmp_path / "ours", threads=1)
    assert ours["answers"] == json.loads(out)["answers"]
    assert (tmp_path / "ours/report.html").exists()
    with pytest.raises(twinchute.UsageError, match="--resume"):
        twinchute.campaign(tmp_path / "small.toml", out=tmp_path / "ours")
    again = twinchute.campaign(tmp_path / "small.toml", out=tmp_path / "ours", resume=True)
    assert again["answers"] == ours["answers"]
