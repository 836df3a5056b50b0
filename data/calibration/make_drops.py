#!/usr/bin/env python3
"""Makes the synthetic drops of this folder: make_drops.py TWINCHUTE

Truth: n = 5.5, C_D S = 39 m^2, initial drag-area ratio 0.06. The reduced-order model runs with it, a filter
of first order (50 Hz) smooths it, normal noise of 3 % of the peak is added to every 5 ms.
"""
import bisect
import csv
import math
import pathlib
import random
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
TRUTH = ["parachute.fill_time.n=5.5", "parachute.drag_area=39 m^2", "parachute.initial_drag_area_ratio=0.06"]
STEP, EVERY, BANDWIDTH, NOISE, LENGTH = 1e-4, 50, 50.0, 0.03, 3.0


def history(program, sets):
    """Time and opening force of the model."""
    with tempfile.TemporaryDirectory() as folder:
        words = [program, "rom", str(HERE / "c9-drop.toml"), "--quiet", "--out", folder + "/truth"]
        for key in TRUTH + sets + ["rom.rtol=1e-13"]:
            words += ["--set", key]
        subprocess.run(words, check=True)
        with open(folder + "/truth/history.csv", encoding="ascii") as file:
            names, _, *lines = list(csv.reader(file))
    column = names.index("force")
    return [float(line[0]) for line in lines], [float(line[column]) for line in lines]


def readings(time, value, offset, seed):
    """Readings of an instrument: filtered, noisy, on a clock of its own."""

    def at(t):
        right = min(max(1, bisect.bisect_right(time, t)), len(time) - 1)
        gap = time[right] - time[right - 1]
        share = (t - time[right - 1]) / gap if gap > 0 else 0.0
        return value[right - 1] + share * (value[right] - value[right - 1])

    noise = random.Random(seed)
    decay = 1 - math.exp(-2 * math.pi * BANDWIDTH * STEP)
    now, peak = at(0.0), max(value)
    for step in range(int(LENGTH / STEP)):
        now += (at(step * STEP) - now) * decay
        if step % EVERY == 0:
            yield offset + step * STEP, now + noise.gauss(0.0, NOISE * peak)


def main():
    program = sys.argv[1]
    time, force = history(program, [])
    with open(HERE / "c9-drop-a.csv", "w", encoding="ascii") as file:
        file.write("# SYNTHETIC, made by make_drops.py\ntime,force\ns,N\n")
        for t, f in readings(time, force, 0.0, 1):
            file.write(f"{t:.4f},{f:.1f}\n")
    mass = 140.0
    time, force = history(program, ["release.speed=26 m/s", f"payload.mass={mass} kg"])
    specific = [f / mass / 9.80665 for f in force]  # the payload has no drag of its own
    with open(HERE / "c9-drop-b.csv", "w", encoding="ascii") as file:
        file.write("# SYNTHETIC, made by make_drops.py\n\"Time [s]\";\"Specific force [g]\"\n")
        for t, a in readings(time, specific, 0.4, 2):
            file.write(f"{t:.4f};{a:.4f}\n".replace(".", ","))
        file.write("\n")


if __name__ == "__main__":
    main()
