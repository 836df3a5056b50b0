"""Parachutes at two fidelities, and the gap between them.

    import twinchute
    scene = twinchute.Scene.load("data/scenes/c9-inflation.toml")
    print(twinchute.rom(scene)["peak_force"], "N")

All numbers are SI unless text with a unit is given.
"""

import numpy as _numpy


class Error(Exception):
    """Base of all errors of this package."""


class SceneError(Error, ValueError):
    """Something is wrong with a scene. str() reads "file:line:column: key: problem (why), suggestion"."""

    file = line = column = key = problem = why = suggestion = None


class UsageError(Error, ValueError):
    """Something is wrong with what is asked for. str() reads "problem (why), suggestion"."""


class RecordError(Error, ValueError):
    """A record cannot be read."""

    file = line = column = None


class WriteError(Error, OSError):
    """Results cannot be written; what was there before is there still."""


class RunError(Error, RuntimeError):
    """The numbers of a run failed. `record` holds what was computed until then."""

    def __init__(self, text, record):
        super().__init__(text)
        self.record = record
        self.status = record.status
        self.detail = record.detail


from ._core import (  # noqa: E402  the errors come first: it raises them
    Calibration,
    Comparison,
    Event,
    Gap,
    Metric,
    Progress,
    Record,
    RunWarning,
    Scene,
    Sizing,
    __version__,
    calibrate,
    campaign,
    compare,
    full,
    rom,
    size,
    statuses,
)
from ._core import rom_batch as _rom_batch  # noqa: E402


class Batch(dict):
    """Arrays of metrics by name, NaN where a run has none.

    status: code of each run, an index into `twinchute.statuses`
    units: SI unit of each metric
    refusal: why the first run was refused whose inputs the scene must not have, or None
    """

    def __init__(self, columns, status, units, refusal):
        super().__init__(columns)
        self.status = status
        self.units = units
        self.refusal = refusal


def rom_batch(scene, inputs, metrics=("peak_force",), threads=None):
    """Runs the reduced-order model at each row of some inputs.

    inputs: arrays (or numbers) by key, in SI, which are broadcast to one length
    metrics: names, e.g. ["peak_force", "max_deceleration"]
    threads: None: as many as there are processors; the answer is the same

    Returns a Batch. A run whose inputs are out of range has the status 'refused' and NaN. Other threads of Python go
    on meanwhile; Ctrl-C ends it. Raises SceneError where no row can be run, UsageError for an unknown metric.
    """
    if isinstance(metrics, str):
        metrics = [metrics]
    columns = []
    for key, values in inputs.items():
        array = _numpy.asarray(values)
        if array.dtype.kind not in "fiu":
            raise UsageError(f"inputs: {key} is no array of numbers (numbers in SI vary here), leave units out")
        columns.append(array.astype(float))
    if not columns:
        raise UsageError("inputs: nothing varies, e.g. {'payload.mass': numpy.linspace(140, 160, 100)}")
    try:
        columns = _numpy.broadcast_arrays(*(_numpy.atleast_1d(array) for array in columns))
    except ValueError:
        sizes = ", ".join(f"{key}: {_numpy.size(values)}" for key, values in inputs.items())
        raise UsageError(f"inputs: arrays of different lengths ({sizes}), give one value a run") from None
    if columns[0].ndim != 1 or columns[0].size == 0:
        raise UsageError(f"inputs: arrays of shape {columns[0].shape} (one dimension and one run at least are wanted), flatten them")
    return Batch(*_rom_batch(scene, list(zip(inputs, columns)), list(metrics), threads))


# Named, shown and pickled as what they are here, not as parts of _core.
for _name in ("Calibration", "Comparison", "Event", "Gap", "Metric", "Progress", "Record", "RunWarning", "Scene", "Sizing"):
    globals()[_name].__module__ = __name__

__all__ = [
    "Batch",
    "Calibration",
    "Comparison",
    "Error",
    "Event",
    "Gap",
    "Metric",
    "Progress",
    "Record",
    "RecordError",
    "RunError",
    "RunWarning",
    "Scene",
    "SceneError",
    "Sizing",
    "UsageError",
    "WriteError",
    "__version__",
    "calibrate",
    "campaign",
    "compare",
    "full",
    "rom",
    "rom_batch",
    "size",
    "statuses",
]
