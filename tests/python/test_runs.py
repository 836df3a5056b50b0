"""Runs of both models: the numbers are those of the program, to the last bit."""

import filecmp
import json
import os
import signal
import subprocess
import sys
import threading
import time

import numpy
import pytest

import twinchute
from conftest import MOMENT, SOURCE, sets


def moment(c9, more=None):
    return twinchute.Scene.load(c9, {**MOMENT, **(more or {})})


def same_numbers(record, summary):
    assert {metric.key: metric.value for metric in record.metrics.values()} == summary["metrics"]
    assert record.status == summary["status"]["code"]


def history_of(directory):
    lines = (directory / "history.csv").read_text().splitlines()
    names, units = lines[0].split(","), lines[1].split(",")
    columns = numpy.array([[float(cell) for cell in line.split(",")] for line in lines[2:]]).T
    return dict(zip(names, columns)), dict(zip(names, units))


def same_history(record, directory):
    history, units = history_of(directory)
    assert record.units == units
    assert record.history.keys() == history.keys()
    for name, values in history.items():
        numpy.testing.assert_array_equal(record.history[name], values, err_msg=name)


def test_rom_is_that_of_the_program(c9, record_of):
    summary, directory = record_of("rom", c9)
    record = twinchute.rom(twinchute.Scene.load(c9))
    same_numbers(record, plain(summary))
    same_history(record, directory)
    assert record.fidelity == "rom"


def plain(summary):
    """Metrics as key and value, whatever else the file says of each."""
    metrics = {key: value["value"] if isinstance(value, dict) else value for key, value in summary["metrics"].items()}
    return {**summary, "metrics": metrics}


def test_full_is_that_of_the_program(c9, record_of):
    summary, directory = record_of("full", c9, *sets(MOMENT))
    record = twinchute.full(moment(c9))
    same_numbers(record, plain(summary))
    same_history(record, directory)
    # The answer is the same for any number of threads.
    same_history(twinchute.full(moment(c9), threads=2), directory)


def without_what_differs(directory):
    """summary.json less what no two runs have in common."""
    summary = json.loads((directory / "summary.json").read_text())
    for key in ("cost", "provenance", "sha256"):
        summary.pop(key, None)
    summary["scene"].pop("digest", None)  # of commands alone, for --resume
    return summary


@pytest.mark.parametrize("model", ["rom", "full"])
def test_to_dir_writes_the_files_of_the_program(c9, record_of, tmp_path, model):
    _, theirs = record_of(model, c9, *sets(MOMENT))
    record = getattr(twinchute, model)(moment(c9))
    ours = tmp_path / "ours"
    record.to_dir(ours)
    names = sorted(path.name for path in theirs.iterdir())
    assert sorted(path.name for path in ours.iterdir()) == names
    for name in names:
        if name not in ("summary.json", "run.html"):  # these hold dates and clocks
            assert filecmp.cmp(ours / name, theirs / name, shallow=False), name
    # The overrides say where they are from, the command line, on both sides.
    assert without_what_differs(ours) == without_what_differs(theirs)
    again = twinchute.Record.load(ours)
    assert again["peak_force"] == record["peak_force"] if "peak_force" in record.metrics else True
    same_history(again, theirs)


def test_to_dir_spares_what_is_not_its_own(c9, tmp_path):
    (tmp_path / "letter.txt").write_text("dear")
    with pytest.raises(twinchute.UsageError, match="not empty"):
        twinchute.rom(moment(c9)).to_dir(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]


def test_full_writes_fields_where_it_has_a_place(c9, tmp_path):
    scene = moment(c9, {"full.fields_rate": 20})
    with pytest.raises(twinchute.UsageError, match="full.fields_rate"):
        twinchute.full(scene)
    twinchute.full(scene, out=tmp_path / "out")
    # 0.25 s at 20 a second: 0, 0.05, ..., 0.25 s.
    assert len(list((tmp_path / "out/fields").glob("*.vtu"))) == 6
    assert (tmp_path / "out/fields.pvd").exists() and (tmp_path / "out/summary.json").exists()


def test_metrics(c9):
    record = twinchute.rom(twinchute.Scene.load(c9))
    force = record.metrics["peak_force"]
    assert (force.name, force.key, force.unit, force.title, force.kind) == ("peak_force", "peak_force_N", "N", "peak force", "result")
    assert float(force) == force.value == record["peak_force"] == record["peak_force_N"]
    assert record.metrics["filling_time"].kind == "input"
    with pytest.raises(TypeError):
        record.metrics["peak_force"] = 0.0
    with pytest.raises(KeyError, match="did you mean 'peak_force'"):
        record["peak_forc"]
    short = twinchute.rom(twinchute.Scene.load(c9, {"stop.at": "full-open"}))
    with pytest.raises(KeyError, match="descent_rate: the run has none .*stop"):
        short["descent_rate"]


def test_events_and_warnings(c9, record_of):
    summary, directory = record_of("rom", c9, "--set", "payload.mass=3000")
    record = twinchute.rom(twinchute.Scene.load(c9, {"payload.mass": 3000}))
    rows = [line.split(",") for line in (directory / "events.csv").read_text().splitlines()]
    rows = [row for row in rows[1:] if row[0] in {event.name for event in record.events}]
    assert [event.name for event in record.events] == [row[0] for row in rows]
    assert [event.time for event in record.events] == [float(row[1]) for row in rows]
    assert summary["warnings"], "a payload of 3 t was to give a warning"
    assert [(w.what, w.why, w.suggestion) for w in record.warnings] == [
        (w["what"], w.get("why", ""), w.get("suggestion", "")) for w in summary["warnings"]
    ]
    assert record.summary["warnings"] == summary["warnings"]


def test_history_copies_nothing_and_keeps_the_record(c9):
    record = twinchute.rom(twinchute.Scene.load(c9))
    first, second = record.history["force"], record.history["force"]
    assert numpy.shares_memory(first, second)
    assert not first.flags.owndata and not first.flags.writeable
    with pytest.raises(ValueError):
        first[0] = 1.0
    kept = first.copy()
    del record, second
    for _ in range(50):  # what had been freed would be used again
        twinchute.rom(twinchute.Scene.load(c9, {"payload.mass": 100}))
    numpy.testing.assert_array_equal(first, kept)


def test_frame(c9):
    pandas = pytest.importorskip("pandas")
    record = twinchute.rom(twinchute.Scene.load(c9))
    frame = record.frame()
    assert isinstance(frame, pandas.DataFrame) and frame.index.name == "time"
    numpy.testing.assert_array_equal(frame["force"].to_numpy(), record.history["force"])
    assert frame.attrs["units"]["force"] == "N"


def test_frame_without_pandas_says_so(c9, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="pandas"):
        twinchute.rom(twinchute.Scene.load(c9)).frame()


def test_progress_is_called_in_the_calling_thread(c9):
    seen = []
    twinchute.full(moment(c9, {"stop.time": 1.0}), progress=lambda p: seen.append((p, threading.get_ident())))
    assert seen, "never called"
    assert {thread for _, thread in seen} == {threading.get_ident()}
    times = [p.time for p, _ in seen]
    assert times == sorted(times) and times[-1] <= 1.0
    assert all(0.0 <= p.share <= 1.0 and p.stage for p, _ in seen)


def test_what_progress_raises_ends_the_run(c9):
    class Enough(Exception):
        pass

    def stop(progress):
        raise Enough

    start = time.monotonic()
    with pytest.raises(Enough):
        twinchute.full(twinchute.Scene.load(c9, LONG), progress=stop)
    assert time.monotonic() - start < 5.0  # of a run that takes minutes


# Minutes of a run: a fine mesh, an hour of fall.
LONG = {
    "stop": {"time": 3000},
    "release.height": 30000,
    "environment.atmosphere": {"density": 1.225},
    "full.mesh.gore_columns": 4,
    "full.mesh.gore_rows": 18,
}


def test_full_lets_other_threads_go_on(c9):
    scene = twinchute.Scene.load(c9)  # half a second and more
    counted = []
    done = threading.Event()

    def count():
        while not done.is_set():
            counted.append(time.monotonic())
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    start = time.monotonic()
    twinchute.full(scene)
    end = time.monotonic()
    done.set()
    counter.join()
    # Without the lock released none would fall inside; a tenth of a thousand a second allows for a busy machine.
    inside = [moment for moment in counted if start < moment < end]
    assert len(inside) > 100 * (end - start)


@pytest.mark.parametrize("progress", ["None", "lambda p: seen.append(p)"])
def test_ctrl_c_ends_a_full_run(c9, progress):
    """A KeyboardInterrupt, promptly, and Python goes on."""
    text = f"""
import twinchute
seen = []
scene = twinchute.Scene.load({str(c9)!r}, {LONG!r})
print("begins", flush=True)
try:
    twinchute.full(scene, progress={progress})
except KeyboardInterrupt:
    print("interrupted", twinchute.rom(scene.with_values({{"stop": {{"time": 1}}}})).status, flush=True)
"""
    with subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True) as process:
        try:
            process.stdout.readline()
            time.sleep(1.0)  # it runs
            start = time.monotonic()
            process.send_signal(signal.SIGINT)
            out, _ = process.communicate(timeout=30)
        finally:
            process.kill()
    assert out.splitlines()[-1] == "interrupted completed"
    assert process.returncode == 0
    assert time.monotonic() - start < 10.0  # of a run that takes minutes, on a busy machine


def test_a_run_that_fails_raises_with_its_record(c9):
    scene = moment(c9, {"full.time_step_factor": 0.9, "full.strain_limit": 1e-6})
    with pytest.raises(twinchute.RunError) as caught:
        twinchute.full(scene)
    error = caught.value
    assert error.status == error.record.status == "strain_limit"
    assert error.detail and error.detail in str(error)
    assert len(error.record.history["time"]) > 0


def test_physics_that_a_model_lacks(program):
    path = SOURCE / "data/scenes/cargo-cluster.toml"
    with pytest.raises(twinchute.UsageError) as caught:
        twinchute.full(twinchute.Scene.load(path))
    assert program("full", path)[2] == f"twinchute: {caught.value}\n"


def test_compare(c9, tmp_path, program):
    _, text, _ = program("compare", c9, *sets(MOMENT), "--json", "--out", tmp_path / "cli")
    theirs = json.loads(text)
    comparison = twinchute.compare(moment(c9))
    ours = comparison.summary
    assert ours.keys() == theirs.keys() and {"metrics", "histories", "verdict"} <= ours.keys()
    for key in ("metrics", "histories", "verdict"):
        assert ours[key] == theirs[key]
    both = [gap for gap in comparison.gaps.values() if gap.difference is not None]
    assert len(both) > 2
    for gap in both:
        assert (gap.rom, gap.full) == (comparison.rom[gap.name], comparison.full[gap.name])
        assert gap.difference == gap.rom - gap.full
        if gap.relative is not None and gap.full:
            assert gap.relative == pytest.approx(gap.difference / abs(gap.full), rel=1e-15)
    comparison.to_dir(tmp_path / "ours")
    assert sorted(p.name for p in (tmp_path / "ours").iterdir()) == sorted(p.name for p in (tmp_path / "cli").iterdir())


def test_compare_judges(c9):
    scene = moment(c9, {"compare.tolerance.max_force": "0.001 %"})
    comparison = twinchute.compare(scene)
    gap = comparison.gaps["max_force"]
    assert (gap.tolerance, gap.verdict, gap.within) == ("0.001 %", "exceeded", False)
    assert comparison.within is False
    wide = twinchute.compare(moment(c9, {"compare.tolerance.max_force": "1000 %"})).gaps["max_force"]
    assert wide.within is True


def test_environment_is_as_it_was(c9):
    """Signals of Python stay those of Python."""
    before = signal.getsignal(signal.SIGINT)
    twinchute.full(moment(c9))
    assert signal.getsignal(signal.SIGINT) is before
    with pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1)
