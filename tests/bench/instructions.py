#!/usr/bin/env python3
"""Counts the instructions of fixed runs with callgrind and compares them with the committed figures.

Times differ from machine to machine and from hour to hour; the number of instructions does not, as long as
compiler and libraries are the same. So the test finds a change that makes a run more expensive on any machine.

    instructions.py check PROGRAM FIGURES    ends with 1 where a count is more than 2 % off, 77 where
                                             the figures do not apply
    instructions.py renew PROGRAM FIGURES    writes the current counts into FIGURES
"""

import contextlib
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile

TOLERANCE = 0.02  # [-] of the committed count; repeated counts agree to 0.05 %, those of the start to 0.4 %
SKIPPED = 77  # what ctest takes for "skipped"

# Meshes are spelled out: the default may change without any change of cost per element.
# Few gores: valgrind takes fused multiply-adds one at a time, a hundred times slower than the rest.
MESH = ["full.mesh.gore_columns=2", "full.mesh.gore_rows=17", "full.mesh.line_elements=31", "parachute.gores=8"]
SMALL_MESH = ["full.mesh.gore_columns=1", "full.mesh.gore_rows=6", "full.mesh.line_elements=4", "parachute.gores=4"]
# On a busy machine a run lasts long enough for a checkpoint, which is not always counted then.
UNINTERRUPTED = ["full.checkpoint_interval='0 s'"]
INFLATION = "data/scenes/c9-inflation.toml"
CRANE_DROP = "data/scenes/paper/crane-drop.toml"

# What is run, and why: command, scene, keys, and the function that is counted where it is not the whole program.
RUNS = {
    "inflation": ("full", INFLATION, MESH + UNINTERRUPTED + ["stop.time=0.01"], "twinchute::fullsim::run_fullsim*"),  # finite elements, pressure, lines
    "deployment": ("full", CRANE_DROP, MESH + UNINTERRUPTED + ["stop.time=0.04"], "twinchute::fullsim::run_fullsim*"),  # springs, static line, fabric drag
    "stages": ("full", CRANE_DROP, SMALL_MESH + UNINTERRUPTED + ["stop.time=3.3"], "twinchute::fullsim::run_fullsim*"),  # all: snatch, switch, ramp
    "rom": ("rom", INFLATION, [], "twinchute::rom::run_rom*"),
    "start": ("rom", INFLATION, [], None),  # libraries, unit database, scene
}

TREE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


class Skip(Exception):
    """The figures do not apply here, for this reason."""


@contextlib.contextmanager
def workplace(program):
    """A directory with all that a run needs: the length of a path would be counted."""
    with tempfile.TemporaryDirectory(dir="/tmp") as directory:
        shutil.copytree(os.path.join(TREE, "data"), os.path.join(directory, "data"))
        shutil.copy(program, os.path.join(directory, "twinchute"))
        yield directory


def run(directory, name, prefix):
    """Runs a fixed run in a workplace: the summary that it prints as JSON."""
    command, scene, keys, _ = RUNS[name]
    words = prefix + ["./twinchute", command, scene, "--json"]
    if command == "full":
        words += ["--out", "out"]
    for key in keys:
        words += ["--set", key]
    # An environment of its own: its size moves the stack, and with it alignment.
    environment = {"LC_ALL": "C", "PATH": os.defpath, "TWINCHUTE_DATA": "data"}
    ended = subprocess.run(words, cwd=directory, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if ended.returncode != 0:
        sys.exit(f"{name}: {' '.join(words)} ended with {ended.returncode}:\n{ended.stderr[-2000:]}")
    return json.loads(ended.stdout)


def measure(program, name):
    """Instructions and steps of a fixed run."""
    words = [shutil.which("valgrind"), "--tool=callgrind", "--callgrind-out-file=counts"]
    if RUNS[name][3]:
        words.append(f"--toggle-collect={RUNS[name][3]}")
    with workplace(program) as directory:
        summary = run(directory, name, words)
        with open(os.path.join(directory, "counts")) as file:
            total = re.search(r"^(?:summary|totals): (\d+)", file.read(), re.MULTILINE)
    return int(total.group(1)), summary["cost"]["steps"]


def made_with(program):
    """What the count depends on besides the sources, as the figures name it."""
    with workplace(program) as directory:
        made = run(directory, "rom", [])["provenance"]
    return {"compiler": made["compiler"], "libc": " ".join(platform.libc_ver()), "flags": made["flags"]}


def check_machine():
    if platform.machine() != "x86_64":
        raise Skip(f"the counts are of x86_64, this is {platform.machine()}")
    with open("/proc/cpuinfo") as file:
        if not re.search(r"^flags\b.*\bavx2\b", file.read(), re.MULTILINE):
            raise Skip("the counts are of the AVX2 clones, which this processor cannot run")
    if not shutil.which("valgrind"):
        raise Skip("there is no valgrind (Debian: apt-get install valgrind)")


def check_flags(flags):
    words = flags.split()
    level = [w for w in words if re.fullmatch(r"-O\w*", w)]
    if level[-1:] != ["-O3"] or "-DNDEBUG" not in words:
        raise Skip(f"the counts are of a release build, this one has '{flags}'")
    for word in words:
        if re.match(r"-fsanitize|--coverage|-march|-flto|-pg|-fstack-protector|-D_FORTIFY_SOURCE|-D_GLIBCXX", word):
            raise Skip(f"the counts are of a plain release build, this one has {word}")


def read_figures(path):
    """{"compiler": ..., "libc": ...} and {run: (instructions, steps)}."""
    made, counts = {}, {}
    with open(path) as file:
        for line in file:
            words = line.split("#")[0].split()
            if not words:
                continue
            if words[0] in ("compiler", "libc"):
                made[words[0]] = " ".join(words[1:])
            else:
                counts[words[0]] = (int(words[1].replace("_", "")), int(words[2]))
    return made, counts


def write_figures(path, made, counts):
    rows = "".join(f"{name:12}{f'{ir:_}':>15}{steps:9}\n" for name, (ir, steps) in counts.items())
    with open(path, "w") as file:
        file.write("# Instructions of fixed runs (instructions.py), counted by callgrind; the test bench.instructions compares.\n"
                   "# Renewed by `cmake --build <build> --target renew-instructions`, with a commit that says why.\n"
                   f"compiler  {made['compiler']}\nlibc      {made['libc']}\n\n"
                   f"# run        instructions    steps\n{rows}")


def judge(name, committed, counted):
    """Whether a count is within tolerance of its figure, and the line that says so."""
    change = counted[0] / committed[0] - 1.0
    line = f"{name:12}{f'{counted[0]:_}':>15} instructions, committed {committed[0]:_}: {100 * change:+.2f} %"
    if counted[1] != committed[1]:
        line += f"; {counted[1]} steps, committed {committed[1]}: {100 * (counted[1] / committed[1] - 1):+.2f} %"
    if change > TOLERANCE:
        return False, line + f"\n    DEARER than the {100 * TOLERANCE:g} % allowed. Look at what became slower (callgrind_annotate)."
    if change < -TOLERANCE:
        return False, line + f"\n    CHEAPER by more than {100 * TOLERANCE:g} %: lower the figure, so that the gain is kept."
    return True, line


def check(program, path, measured):
    made, committed = read_figures(path)
    if set(committed) != set(RUNS):
        print(f"{path} has figures for {sorted(committed)}, the runs are {sorted(RUNS)}")
        return 1
    here = made_with(program)
    for what in made:
        if made[what] != here[what]:
            raise Skip(f"the counts are of {made[what]}, this is {here[what]}")
    check_flags(here["flags"])
    good = True
    for name in RUNS:
        passed, line = judge(name, committed[name], measured(program, name))
        print(line, flush=True)
        good = good and passed
    if not good:
        print(f"\nA change that is meant: cmake --build <build> --target renew-instructions\n"
              f"and commit {os.path.relpath(path, TREE)} with the reason for it.")
    return 0 if good else 1


def renew(program, path, measured):
    here = made_with(program)
    check_flags(here["flags"])
    write_figures(path, here, {name: measured(program, name) for name in RUNS})
    with open(path) as file:
        print(file.read(), end="")
    return 0


def main(arguments, measured=measure):
    actions = {"check": check, "renew": renew}
    if len(arguments) != 3 or arguments[0] not in actions:
        print(__doc__)
        return 2
    try:
        check_machine()
        return actions[arguments[0]](os.path.abspath(arguments[1]), os.path.abspath(arguments[2]), measured)
    except Skip as reason:
        print(f"skipped: {reason}")
        return SKIPPED


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
