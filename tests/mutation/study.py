#!/usr/bin/env python3
"""Breaks a law of physics on purpose and checks that a gate or a test notices.

Each mutation is made in a copy of the tree. In one fidelity alone, the gate of a shipped scene has to close (`twinchute compare`
exits 1) and the attribution has to name the effect: its term is the largest of a metric whose tolerance is exceeded, with the
sign of that gap. In lib, both fidelities agree: the law's own tests have to fail, and `twinchute compare --baseline` has to find
that the scene has moved from the results of the sound program.

usage: study.py SOURCE BUILD [--only WORDS] [--keep]
       study.py SOURCE --check

SOURCE: the tree. BUILD: a folder for the copy and what is built of it; made when it is not there, used again when it is.
--check: runs nothing and looks only whether each mutation still finds, once, what it replaces.
Exits 1 where a mutation gets through. The table of what each gave goes to standard output, a row as soon as it is
known; docs/guide/gap.md keeps it.
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
from dataclasses import dataclass, field


@dataclass
class Mutation:
    name: str
    where: str  # fullsim, rom or lib
    file: str
    old: str
    new: str
    # the shipped scene whose gate has to close; of one fidelity: the piece that it has to be laid to
    scene: str = ""
    piece: str = ""
    # of lib: the tests that have to fail
    tests: list = field(default_factory=list)


RADIUS = "added-mass radius x 1.5"
WIND = "sign of the wind"
PHASE = "t from t_s in Eq. 14"
DEMO = "data/scenes/c9-inflation.toml"
CROSSWIND = "data/scenes/c9-crosswind.toml"

MUTATIONS = [
    Mutation(RADIUS, "fullsim", "fullsim/simulation.cpp",
             "rho, steady_radius(chute),", "rho, 1.5 * steady_radius(chute),",
             scene=DEMO, piece="added-mass"),
    # The mass goes with the cube of the radius.
    Mutation(RADIUS, "rom", "rom/rigid_composite.hpp",
             "const ValueAndRate mass = canopies->added_mass(*added_mass, t, now.density);",
             "ValueAndRate mass = canopies->added_mass(*added_mass, t, now.density); mass.value *= 3.375; mass.rate *= 3.375;",
             scene=DEMO, piece="added-mass"),
    Mutation(RADIUS, "lib", "lib/models/added_mass.cpp",
             "return filled((2.0 / 3.0) * pi, rho, radius, ramp);",
             "return filled((2.0 / 3.0) * pi * 3.375, rho, radius, ramp);", scene=DEMO, tests=["AddedMass.*"]),
    Mutation(WIND, "fullsim", "fullsim/time/aero_reference.cpp",
             "air.wind = environment.wind->at(", "air.wind = -environment.wind->at(",
             scene=CROSSWIND, piece="wind"),
    Mutation(WIND, "rom", "rom/motion.hpp",
             "return velocity - wind->at(altitude);", "return velocity + wind->at(altitude);",
             scene=CROSSWIND, piece="wind"),
    Mutation(WIND, "lib", "lib/models/wind.cpp",
             "return {-speed * std::sin(from), -speed * std::cos(from), 0.0};",
             "return {speed * std::sin(from), speed * std::cos(from), 0.0};", scene=CROSSWIND, tests=["Wind.*"]),
    Mutation(PHASE, "fullsim", "fullsim/simulation.cpp",
             "inflation_.drag_area_ratio(s.phase, s.time).value",
             "inflation_.drag_area_ratio(s.phase, s.time + (s.phase == Phase::filling ? "
             "inflation_.initial_time : 0.0)).value",
             scene=DEMO, piece="initial-phase"),
    Mutation(PHASE, "rom", "rom/rigid_composite.hpp",
             ": canopies->drag_area(t);",
             ": canopies->drag_area(t + (canopies->all().front().phase == Phase::filling ? "
             "canopies->all().front().inflation.initial_time : 0.0));",
             scene=DEMO, piece="initial-phase"),
    Mutation(PHASE, "lib", "lib/models/inflation.cpp",
             "(time - snatch - initial_time) / duration", "(time - snatch) / duration",
             scene=DEMO, tests=["Inflation.*"]),
]


class Tree:
    """A copy of the sources, and a build of it."""

    def __init__(self, source, build):
        self.source = pathlib.Path(source).resolve()
        self.top = pathlib.Path(build).resolve()
        self.built = self.top / "build" / "mutation"

    def begin(self, *targets):
        self.top.mkdir(parents=True, exist_ok=True)
        for entry in sorted(self.source.iterdir()):
            if entry.name in ("build", ".git") or entry.name.endswith(".out"):
                continue
            target = self.top / entry.name
            if entry.is_dir():
                # Files that are the same keep their times, so that nothing of them is built again.
                shutil.copytree(entry, target, dirs_exist_ok=True, copy_function=copy_if_changed)
            else:
                copy_if_changed(entry, target)
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        self.run(["cmake", "-S", self.top, "-B", self.built, "-DCMAKE_BUILD_TYPE=Release", "-DTWINCHUTE_TESTS=ON",
                  "-DTWINCHUTE_WERROR=ON", *generator])
        self.build(*targets)

    def run(self, words):
        done = subprocess.run([str(w) for w in words], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace")
        if done.returncode != 0:
            sys.exit(f"study.py: '{' '.join(map(str, words))}' failed\n" + done.stdout[-4000:])

    def build(self, *targets):
        self.run(["cmake", "--build", self.built, "--parallel", os.cpu_count() or 1, "--target", *targets])

    def mutate(self, mutation):
        file = self.top / mutation.file
        text = file.read_text(encoding="utf-8")
        if mutation.old not in text:
            sys.exit(f"study.py: {mutation.file} no longer holds '{mutation.old}': mend the row of this mutation")
        file.write_text(text.replace(mutation.old, mutation.new), encoding="utf-8")
        return text


def copy_if_changed(source, target):
    source, target = pathlib.Path(source), pathlib.Path(target)
    if not target.exists() or source.read_bytes() != target.read_bytes():
        shutil.copyfile(source, target)
        shutil.copymode(source, target)
    return target


def baseline_of(tree, scene):
    """Where the comparison by the sound program is kept."""
    return tree.built / "baselines" / pathlib.Path(scene).stem


def compare(tree, scene, *options, out=None):
    """Exit code and gap of a shipped scene."""
    out = out or tree.built / "study.out"
    shutil.rmtree(out, ignore_errors=True)
    done = subprocess.run([str(tree.built / "twinchute"), "compare", str(tree.top / scene), *map(str, options), "--json",
                           "--out", str(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode > 1:
        return done.returncode, None, done.stderr.strip()
    return done.returncode, json.loads(done.stdout), ""


def largest_terms(gap):
    """Of each exceeded metric: its name, piece and effect of the largest term, its gap."""
    found = []
    for key, metric in gap["metrics"].items():
        attributed = gap["attribution"]["metrics"].get(key)
        if metric["verdict"] != "exceeded" or attributed is None:
            continue
        term = max(attributed["terms"], key=lambda t: abs(t["effect"]))
        found.append((metric["name"], term["name"], term["effect"], -metric["difference"], metric.get("unit", "")))
    return found


def look_at_gate(tree, mutation):
    tree.build("twinchute")
    code, gap, error = compare(tree, mutation.scene, "--why")
    scene = pathlib.Path(mutation.scene).name
    if gap is None:
        # A run that breaks off closes the gate, too, but lays it to nothing.
        return False, f"{scene}: exit {code}, {error}"
    terms = largest_terms(gap)
    words = "; ".join(f"{name}: gap {gap_:+.4g} {unit}, largest term {piece} {effect:+.4g} {unit}".rstrip()
                      for name, piece, effect, gap_, unit in terms)
    # A term against the gap does not make it: what does is the interaction.
    caught = code == 1 and any(piece == mutation.piece and effect * gap_ > 0 for _, piece, effect, gap_, _ in terms)
    return caught, f"{scene}: exit {code}; {words or 'nothing exceeded'}"


def look_at_trend(tree, mutation):
    """Whether --baseline catches it, and the metric that has moved most."""
    scene = pathlib.Path(mutation.scene).name
    code, gap, error = compare(tree, mutation.scene, "--baseline", baseline_of(tree, mutation.scene))
    if gap is None:
        return False, f"{scene} --baseline: exit {code}, {error}"
    trend = gap["trend"]
    beyond = [change for change in trend["changes"] if change["verdict"] == "exceeded"]
    words = ", ".join(f"{c['fidelity']} {c['metric']} {100 * c['relative']:+.3g} %" for c in beyond[:1] if "relative" in c)
    return code == 1 and bool(beyond), f"{scene} --baseline: exit {code}; {len(beyond)} moved too far, most {words or '-'}"


def look_at_tests(tree, mutation):
    tree.build("twinchute", "unit_tests")
    caught, words = look_at_trend(tree, mutation)
    words = [words]
    for tests in mutation.tests:
        done = subprocess.run([str(tree.built / "tests" / "unit_tests"), f"--gtest_filter={tests}", "--gtest_brief=1"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
        failed = sorted({line.split()[3].rstrip(",") for line in done.stdout.splitlines()
                         if line.startswith("[  FAILED  ] ") and "." in line.split()[3]})
        caught = caught and done.returncode == 1 and bool(failed)
        words.append(f"{tests}: {', '.join(failed) or 'all pass'}")
    return caught, "; ".join(words)


def lost(source):
    """Rows whose text does not stand once in its file, and why."""
    for mutation in MUTATIONS:
        count = (pathlib.Path(source) / mutation.file).read_text(encoding="utf-8").count(mutation.old)
        if count != 1:
            yield f"{mutation.name}, {mutation.where}: {mutation.file} holds '{mutation.old}' {count} times, not once"


def sound(tree, mutations):
    """Without any mutation every gate is open: otherwise a closed one would say nothing."""
    for scene in sorted({m.scene for m in mutations if m.scene}):
        code, gap, error = compare(tree, scene, out=baseline_of(tree, scene))
        if code != 0:
            sys.exit(f"study.py: {scene} exits {code} without any mutation {error or gap['summary']}")


def commit_of(source):
    done = subprocess.run(["git", "-C", str(source), "describe", "--always", "--dirty"], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True)
    return done.stdout.strip() or "unknown"


def main():
    parser = argparse.ArgumentParser(description="breaks laws of physics and looks who notices")
    parser.add_argument("source")
    parser.add_argument("build", nargs="?")
    parser.add_argument("--check", action="store_true", help="only look whether the mutations still find their place")
    parser.add_argument("--only", default="", help="mutations with this in 'name, place', e.g. 'wind, rom'")
    parser.add_argument("--keep", action="store_true", help="leave the copy and its build where they are")
    options = parser.parse_args()
    if options.check:
        found = list(lost(options.source))
        print("\n".join(found) or f"{len(MUTATIONS)} mutations find their place")
        sys.exit(1 if found else 0)
    if options.build is None:
        parser.error("BUILD is missing")
    mutations = [m for m in MUTATIONS if options.only in f"{m.name}, {m.where}"]
    tree = Tree(options.source, options.build)
    tree.begin("twinchute", *(["unit_tests"] if any(m.tests for m in mutations) else []))
    sound(tree, mutations)
    through = 0
    print("| mutation | made in | caught | what was seen |\n| --- | --- | --- | --- |", flush=True)
    for mutation in mutations:
        text = tree.mutate(mutation)
        try:
            caught, words = (look_at_tests if mutation.tests else look_at_gate)(tree, mutation)
        finally:
            (tree.top / mutation.file).write_text(text, encoding="utf-8")
        through += not caught
        print(f"| {mutation.name} | `{mutation.where}` | {'yes' if caught else '**no**'} | {words} |", flush=True)
    print(f"\ncommit {commit_of(tree.source)}: {len(mutations) - through} of {len(mutations)} caught", flush=True)
    if not options.keep:
        shutil.rmtree(tree.top)
    sys.exit(1 if through else 0)


if __name__ == "__main__":
    main()
