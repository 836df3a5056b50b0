#!/usr/bin/env python3
"""Makes the generated tables of docs/ anew, each between its markers, with commit, compiler and machine.

    docs_tables.py make DOCS PROGRAM WORK TESTS [BLOCK ...]   all blocks, or those named; use an idle machine
    docs_tables.py short DOCS PROGRAM WORK TESTS              the quick ones on a coarse mesh, in a copy of DOCS; for a test
    docs_tables.py check DOCS                                 fails where a block has no markers or does not name its source

PROGRAM, WORK and TESTS are twinchute, work_precision and verification_tests.
"""

import concurrent.futures
import csv
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib

TREE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DEMO = os.path.join(TREE, "data", "scenes", "c9-inflation.toml")
COARSE = ["--quick"] + [word for key in ("gore_columns=1", "gore_rows=4", "line_elements=4")
                        for word in ("--set", "full.mesh." + key)] + ["--set", "stop.time=2"]
SERIES = ["froude-low", "froude-high", "operational-froude", "altitude"]  # of the paper, Figs 8 to 11
WORK_ROM = {"crane-drop": "crane drop", "descent-100s": "100 s of descent", "elastic-snatch": "elastic snatch",
            "two-stage-opening": "opening in two stages"}


class Tools:
    def __init__(self, docs, program, work, tests, short):
        self.docs, self.program, self.work, self.tests, self.short = docs, program, work, tests, short

    def run(self, words, good=(0,)):
        ended = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if ended.returncode not in good:
            sys.exit(f"{' '.join(words)} ended with {ended.returncode}:\n{(ended.stderr or ended.stdout)[-2000:]}")
        return ended.stdout

    def provenance(self):
        return json.loads(self.run([self.program, "rom", DEMO, "--json"]))["provenance"]

    def made(self, command):
        """The line that every block begins with."""
        p = self.provenance()
        return f"Made by `{command}`: commit {p['commit']}, {p['compiler']}, {p['host_cpu']}, {p['date'][:10]}.\n\n"


def table(head, rows, left=1):
    """Markdown; the first `left` columns to the left."""
    rule = ["---" if k < left else "---:" for k in range(len(head))]
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, rule] + rows) + "\n"


def share(value):
    return f"{100 * value:.2g} %" if value >= 1e-4 else f"{value:.1e}"


def duration(seconds):
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if seconds >= size:
            break
    return f"{seconds / size:.3g} {unit}"


def ladder(tools):
    with tempfile.TemporaryDirectory() as directory:
        words = [tools.program, "ladder", DEMO, "--out", directory, "--json"]
        measured = json.loads(tools.run(words + (COARSE if tools.short else [])))
    rows = []
    for level in measured["rungs"]:
        if level["family"] not in ("closed form", "rom", "full") or "wall_s" not in level:
            continue
        error, estimate = level.get("error"), level.get("error_estimate")
        name = level["name"] + (", as given" if level["as_given"] else "") + (": reference" if level["is_reference"] else "")
        text = share(error["value"]) if error else f"estimate {share(estimate['value'])}" if estimate else ""
        rows.append([name, duration(level["wall_s"]), text, (error or estimate or {"metric": ""})["metric"].replace("_", " ")])
    return tools.made("twinchute ladder data/scenes/c9-inflation.toml") + table(["level", "time", "error", "in"], rows)


def stability(tools):
    with tempfile.TemporaryDirectory() as directory:
        # Ending with 1 means that a cell failed: the table says so.
        tools.run([tools.program, "stability", "--quiet", "--out", directory] + (["--quick"] if tools.short else []), (0, 1))
        with open(os.path.join(directory, "stability.md")) as file:
            return file.read().removeprefix("# Stability\n\n")


def work_curves(tools, model, name):
    """{(method, family): [row]} of a study, whose files are made anew first."""
    pictures = os.path.join(tools.docs, "pictures")
    tools.run([tools.work, model, pictures] + (["--quick"] if tools.short else []))
    curves = {}
    for study in name if isinstance(name, list) else [name]:
        with open(os.path.join(pictures, f"work-{study}.csv")) as file:
            for row in csv.DictReader(line for line in file if not line.startswith("#")):
                curves.setdefault(row["method"], {}).setdefault(study, []).append(row)
    return curves


def work_rom(tools):
    curves = work_curves(tools, "rom", list(WORK_ROM))
    rows = []
    for method, studies in curves.items():
        cells = []
        for study in WORK_ROM:
            found = [r for r in studies.get(study, []) if r["setting"] == ("1e-5" if tools.short else "1e-8")]
            cells.append(f"{found[0]['evaluations']} ({float(found[0]['error']):.0e})" if found else "")
        rows.append([method] + cells)
    return (tools.made("cmake --build --preset bench --target docs-tables")
            + table(["evaluations (error) at 1e-8"] + list(WORK_ROM.values()), rows))


def work_full(tools):
    study = "full-quick" if tools.short else "full-beginning"
    rows = [[method, r["setting"], r["evaluations"], f"{float(r['error']):.1e}", f"{float(r['other_error']):.1e}"]
            for method, studies in work_curves(tools, "full", study).items() for r in studies[study]]
    return (tools.made("cmake --build --preset bench --target docs-tables")
            + table(["method", "at", "evaluations", "error of place, over D0", "of the opening force"], rows, left=2))


def work_opening(tools):
    """Three studies of whole openings below each other; at what is theirs."""
    names = [f"opening-quick-{kind}" if tools.short else f"opening-{kind}" for kind in ("time", "mesh", "pack")]
    curves = work_curves(tools, "opening", names)
    rows = [[words, method, r["setting"], duration(float(r["seconds"])), f"{float(r['element_steps']):.1e}",
             f"{float(r['peak_force_N']):.1f}"] + [f"{float(r[key]):.1e}" for key in ("error", "other_error", "filling_error")]
            for name, words in zip(names, ("time", "mesh", "pack"))
            for method, studies in curves.items() for r in studies.get(name, [])]
    return (tools.made("cmake --build --preset bench --target docs-tables")
            + table(["against", "method", "at", "time", "elements evaluated", "peak force [N]", "error of it", "of its time",
                     "of the filling time"], rows, left=3))


def bound(tools):
    said = tools.run([tools.tests, "--gtest_filter=StepBound.*"])
    rows = [list(found) for found in re.findall(r"^bound over true limit, (.*): ([\d.]+ to [\d.]+)$", said, re.MULTILINE)]
    return tools.made("verification_tests --gtest_filter=StepBound.*") + table(["state", "bound over true limit"], rows)


def order(tools):
    said = tools.run([tools.tests, "--gtest_filter=TimeIntegration.*"])
    rows = [[name, "2", found] for name, found in re.findall(r"^(order of .*): ([-\d., ]+)$", said, re.MULTILINE)]
    return tools.made("verification_tests --gtest_filter=TimeIntegration.*") + table(["quantity", "expected", "found"], rows)


def series(tools):
    """The paper's series at both fidelities: their tables, and their pictures anew."""
    text = tools.made("twinchute compare data/scenes/paper/SERIES.toml")
    for name in SERIES:
        with tempfile.TemporaryDirectory() as directory:
            scene = os.path.join(TREE, "data", "scenes", "paper", name + ".toml")
            # Ending with 1 means that some gap is beyond its tolerance: the table says how large it is.
            tools.run([tools.program, "compare", "--quiet", "--out", directory, scene], (0, 1))
            picture = os.path.join(tools.docs, "pictures", f"series-{name}.svg")
            shutil.copy(os.path.join(directory, "series.svg"), picture)
            with open(os.path.join(directory, "series.md")) as file:
                made = file.read()
        made = made.replace("(series.svg)", f"(../pictures/series-{name}.svg)").replace("# ", "### ", 1)
        text += made.split("\nWhere two numbers stand", 1)[0] + "\n"
    return text + "Where two numbers stand: rom / full.\n"


def validation(tools):
    """The report of `twinchute validate`, and its pictures anew."""
    with tempfile.TemporaryDirectory() as directory:
        # Ending with 1 means that some row is beyond its tolerance: the report says so.
        tools.run([tools.program, "validate", "--quiet", "--out", directory], (0, 1))
        for picture in glob.glob(os.path.join(directory, "scatter-*.svg")):
            shutil.copy(picture, os.path.join(tools.docs, "pictures"))
        with open(os.path.join(directory, "report.md")) as file:
            return file.read().removeprefix("# Validation\n\n").replace("](scatter-", "](../pictures/scatter-").rstrip("\n") + "\n"


def why(scene):
    def block(tools):
        with tempfile.TemporaryDirectory() as directory:
            words = [tools.program, "compare", os.path.join(TREE, scene), "--why", "--out", directory]
            said = tools.run(words + (COARSE[1:] + ["--seeds", "2"] if tools.short else []), (0, 1)).splitlines()
        begin = next(k for k, line in enumerate(said) if line.startswith("from rom to full"))
        end = max(k for k, line in enumerate(said) if line.startswith("why "))
        return tools.made(f"twinchute compare {scene} --why") + "```text\n" + "\n".join(said[begin:end + 1]) + "\n```\n"
    return block


def quantile(values, share):
    """Linear between the values in their order."""
    values = sorted(values)
    at = share * (len(values) - 1)
    low = min(int(at), len(values) - 2)
    return values[low] + (at - low) * (values[low + 1] - values[low])


def crane_seeds(tools):
    """What seeds of the noise do to the crane drop."""
    scene, seeds = "data/scenes/paper/crane-drop.toml", range(1, 4 if tools.short else 101)
    shown = [("snatch speed [m/s]", "snatch_speed_m_s", 2), ("snatch force [kN]", "snatch_force_N", 1),
             ("peak force ratio X_p", "peak_force_ratio", 2), ("filling time [s]", "filling_time_s", 2),
             ("descent rate [m/s]", "descent_rate_m_s", 3)]

    def run(words):
        with tempfile.TemporaryDirectory() as directory:
            said = tools.run([tools.program, words[0], os.path.join(TREE, scene), "--json", "--out", directory] + words[1:])
        return json.loads(said)["metrics"]

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(run, [["full", "--set", f"full.noise.seed={k}"] + (COARSE[1:-1] + ["stop.time=4"] if tools.short else [])
                                    for k in seeds]))
    rom = run(["rom"])
    rows = []
    for words, key, digits in shown:
        values = [metrics[key] for metrics in found if key in metrics]
        scale = 1000.0 if "[kN]" in words else 1.0
        cells = [quantile(values, share) if len(values) > 1 else float("nan") for share in (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)]
        rows.append([words] + [f"{x / scale:.{digits}f}" for x in cells + [rom.get(key, float("nan"))]])
    return (tools.made(f"twinchute full {scene} --set full.noise.seed=1 to {len(found)}")
            + table([f"{len(found)} seeds", "least", "5 %", "25 %", "median", "75 %", "95 %", "largest", "rom"], rows))


PREDICTED = "data/scenes/c9-predicted.toml"


def flown(tools, runs):
    """Summaries and histories of runs, each given by its model, scene and `--set`s; beside each other."""
    coarse = COARSE[1:] if tools.short else []

    def fly(words):
        model, scene, *sets = words
        with tempfile.TemporaryDirectory() as directory:
            said = tools.run([tools.program, model, os.path.join(TREE, scene), "--json", "--out", directory] + coarse
                             + [word for each in sets for word in ("--set", each)], (0, 1, 3))
            with open(os.path.join(directory, "history.csv")) as file:
                rows = list(csv.DictReader(file))[1:]
        return json.loads(said), rows

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(fly, runs))


def metric(summary, key, digits):
    """Of a run that has it; else how it ended, or a dash."""
    if key in summary["metrics"]:
        return f"{summary['metrics'][key]:.{digits}f}"
    return summary["status"]["code"] if summary["status"]["code"] != "completed" else "-"


def over_inflation(summary, rows):
    """Largest projected area over the steady one."""
    areas = [float(row["projected_area"]) for row in rows]
    return f"{max(areas) / areas[-1]:.2f}" if summary["status"]["code"] == "completed" else "-"


def filling_mouth(tools):
    """What the initial mouth does to a predicted opening, in both models."""
    mouths = [0.002, 0.005, 0.01, 0.02, 0.04]
    sets = [f"parachute.filling.initial_mouth={mouth}" for mouth in mouths]
    rom = flown(tools, [("rom", PREDICTED, word) for word in sets])
    full = flown(tools, [("full", PREDICTED, word) for word in sets])
    rows = [[str(mouth)] + [metric(run[0], key, digits) for key, digits in (("fill_constant", 2), ("peak_force_ratio", 1), ("descent_rate_m_s", 3))
                            for run in (r, f)] + [metric(f[0], "projected_diameter_ratio", 3), over_inflation(*f), share(abs(f[0]["energy"]["residual_fraction"]))]
            for mouth, r, f in zip(mouths, rom, full)]
    return (tools.made(f"twinchute rom|full {PREDICTED} --set parachute.filling.initial_mouth=...")
            + table(["initial mouth", "n, rom", "n, full", "X_p, rom", "X_p, full", "descent, rom [m/s]", "full", "D_p/D0", "largest S_p over steady",
                     "energy residual"], rows))


def filling_varied(tools):
    """What steps, meshes and assumptions do to a predicted opening of the full model."""
    varied = [("as shipped", [])]
    varied += [(f"step factor {f}", [f"full.time_step_factor={f}"]) for f in (0.475, 0.2375)]
    varied += [(f"{a} x {b} elements a gore", [f"full.mesh={{gore_columns={a}, gore_rows={b}, line_elements={c}}}"]) for a, b, c in ((6, 14, 51), (8, 18, 68), (10, 22, 85))]
    varied += [(f"breathing damping k = {k}", [f"aerodynamics.breathing_damping.k={k}"]) for k in (0, 0.1, 1)]
    varied += [(f"release at {v} m/s", [f"release.speed={v}"]) for v in (45, 90, 150)]
    varied += [("entrance loss 1", ["parachute.filling.entrance_loss=1"])]
    runs = flown(tools, [("full", PREDICTED, *sets) for _, sets in (varied[:5] if tools.short else varied)])
    rows = [[name, metric(s, "fill_constant", 3), metric(s, "peak_force_ratio", 2), over_inflation(s, h), metric(s, "descent_rate_m_s", 3), f"{s['cost']['steps']}"]
            for (name, _), (s, h) in zip(varied, runs)]
    return tools.made(f"twinchute full {PREDICTED} --set ...") + table(["varied", "n", "X_p", "largest S_p over steady", "descent [m/s]", "steps"], rows)


def filling_reefed(tools):
    """The drag area behind a reefing line, which both models predict."""
    scene = "data/scenes/c9-reefed.toml"
    shares = [0.1, 0.3] if tools.short else [0.03, 0.05, 0.1, 0.2, 0.3, 0.5, 0.6, 0.8]
    sets = [("parachute.filling={model='predicted', initial_mouth=0.02}", f"parachute.reefing.1.drag_area_ratio={share}") for share in shares]
    rows = []
    for model in ("rom", "full"):
        found = [s for s, _ in flown(tools, [(model, scene, *each) for each in sets])]
        whole = found[0]["inputs"]["parachute.drag_area"]["value"]
        rows.append([model] + [f"{s['metrics']['stage_1_drag_area_m2'] / whole:.3f}" if "stage_1_drag_area_m2" in s["metrics"]
                               else s["status"]["code"] for s in found])
    return tools.made(f"twinchute rom|full {scene} --set parachute.filling=... --set parachute.reefing.1.drag_area_ratio=...") + table(["share"] + [str(share) for share in shares], rows)


def filling_packed(tools):
    """The packed crane drop with a filling that is predicted, over mouths and seeds."""
    scene, seeds = "data/scenes/paper/crane-drop.toml", range(1, 2 if tools.short else 9)
    mouths = [0.02] if tools.short else [0.002, 0.005, 0.01, 0.02, 0.04]
    runs = flown(tools, [("full", scene, f"parachute.filling={{model='predicted', initial_mouth={mouth}}}", f"full.noise.seed={seed}")
                         for mouth in mouths for seed in seeds])
    rows = []
    for k, mouth in enumerate(mouths):
        of = [s for s, _ in runs[k * len(seeds):(k + 1) * len(seeds)]]
        opened = [s["metrics"] for s in of if "fill_constant" in s["metrics"]]
        ended = sorted({s["status"]["code"] for s in of if "fill_constant" not in s["metrics"]})

        def spread(key, scale, digits):
            values = [m[key] / scale for m in opened if key in m]
            return f"{min(values):.{digits}f} to {max(values):.{digits}f}" if values else "-"
        rows.append([str(mouth), f"{len(opened)} of {len(of)}", ", ".join(ended) or "-", spread("fill_constant", 1, 2), spread("peak_force_N", 1000, 1),
                     spread("time_to_15_percent_drag_area_s", 1, 2), spread("time_to_98_percent_drag_area_s", 1, 2),
                     share(max(abs(s["energy"]["residual_fraction"]) for s in of))])
    return (tools.made(f"twinchute full {scene} --set parachute.filling=... --set full.noise.seed=1 to {len(seeds)}")
            + table(["initial mouth", "opens", "the others", "n", "peak force [kN]", "15 % [s]", "98 % [s]", "largest energy residual"], rows))


# Of data/parachutes/annular-example.toml, where vent lines leave no alike sectors.
OPEN_MIDDLE = ["parachute.vent_diameter='5.212 m'", "parachute.line_length='10.66 m'", "parachute.projected_diameter_ratio=0.94",
               "parachute.vent_lines.length='2.721 m'", "parachute.vent_lines.joint='1.706 m'"]

# Two elements across leave the ring wound up in three drops of five; it opens later than a whole canopy.
PACKED_RING = ["full.mesh.gore_columns=4", "full.mesh.gore_rows=9", "environment.ground='-120 m'"]


# data/parachutes/cross-example.toml in the C-9's size, with as many lines.
CROSS = ["parachute.design='cross-example'", "parachute.nominal_diameter='8.53 m'", "parachute.gores=28", "full.contact='none'"]

# Its descent is steady later.
PACKED_CROSS = ["environment.ground='-120 m'"]


def canopies(tools):
    """Each type that the full model meshes, in the C-9's size: finer meshes, and drops from the pack."""
    demo, crane, seeds = "data/scenes/c9-inflation.toml", "data/scenes/paper/crane-drop.toml", range(1, 6)
    meshes = [(9, 2), (18, 4), (36, 8)]
    types = {}
    for path in sorted(glob.glob(os.path.join(TREE, "data", "parachutes", "types", "*.toml"))):
        with open(path, "rb") as file:
            content = tomllib.load(file)
        if content.get("full_model", {}).get("canopy") == "own":
            types[os.path.basename(path)[:-5]] = content
    opened, stressed, packed, runs = [], [], [], []
    for name, content in types.items():
        sets = [f"parachute.type='{name}'"]
        if content["full_model"].get("slots") == "smeared":
            sets.append("parachute.geometric_porosity=0.15")
        shapes, drop = sets + ["full.symmetry='sector'"], []
        if content["full_model"].get("middle") == "open":  # its vent lines and proportions, in D0 of 8.53 m
            sets += OPEN_MIDDLE
            shapes = sets
            drop = PACKED_RING
        if "arm_ratio" in content["full_model"]:
            sets = shapes = CROSS
            drop = PACKED_CROSS
        runs += [("full", demo, *shapes, f"full.mesh.gore_rows={rows}", f"full.mesh.gore_columns={columns}")
                 for rows, columns in meshes]
        runs += [("full", crane, *sets, *drop, f"full.noise.seed={seed}") for seed in seeds]
    found = iter([summary for summary, _ in flown(tools, runs)])
    for name, content in types.items():
        fine, drops = [next(found) for _ in meshes], [next(found) for _ in seeds]
        ratio = content.get("projected_diameter_ratio", {"grade": "R"})
        book = "-" if ratio["grade"] == "R" else " to ".join(sorted({f"{ratio[end]:.2f}" for end in ("low", "high")}))
        # The equal-area diameter leaves an open middle out, the handbook's does not.
        width = "seam_diameter_ratio" if content["full_model"].get("middle") == "open" else "projected_diameter_ratio"
        opened.append([name] + [metric(s, width, 4) for s in fine]
                      + [book, metric(fine[-1], "canopy_depth_ratio", 3)]
                      + [metric(s, "peak_force_N", 0) for s in fine])
        stressed.append([name] + [metric(s, key, 0) for key in ("membrane_stress_p90_N_m", "max_membrane_stress_N_m") for s in fine])
        peaks = [s["metrics"]["peak_force_ratio"] for s in drops if "peak_force_ratio" in s["metrics"]]
        ends = [s["status"]["code"] for s in drops]
        packed.append([name, ", ".join(f"{ends.count(code)} {code}" for code in sorted(set(ends))),
                       f"{min(peaks):.2f} to {max(peaks):.2f}" if peaks else "-",
                       metric(drops[0], width, 4), metric(drops[0], "descent_rate_m_s", 2)])
    names = [f"{rows} x {columns}" for rows, columns in meshes]
    return (tools.made(f"twinchute full {demo} --set parachute.type=...`, `twinchute full {crane} --set full.noise.seed=1 to {len(seeds)}")
            + table(["from line stretch"] + [f"D_p/D0, {n}" for n in names] + ["handbook", "depth over D_p"]
                    + [f"peak [N], {n}" for n in names], opened)
            + "\n" + table(["fabric, from line stretch"] + [f"90th percentile [N/m], {n}" for n in names]
                           + [f"largest [N/m], {n}" for n in names], stressed)
            + "\n" + table(["from the pack", f"{len(seeds)} seeds", "X_p", "D_p/D0", "descent [m/s]"], packed))


# Page of a block, the function that makes it, and whether it is quick enough for a test.
BLOCKS = {
    "ladder": ("generated/ladder.md", ladder, True),
    "stability": ("generated/stability.md", stability, False),
    "work-rom": ("generated/integrators.md", work_rom, True),
    "work-full": ("generated/integrators.md", work_full, True),
    "work-opening": ("generated/integrators.md", work_opening, True),
    "step-bound": ("stability.md", bound, False),
    "step-order": ("verification.md", order, True),
    "canopies": ("generated/canopies.md", canopies, False),
    "series": ("generated/series.md", series, False),
    "validation": ("generated/validation.md", validation, False),
    "gap-demo": ("guide/gap.md", why("data/scenes/c9-inflation.toml"), True),
    "gap-crane-drop": ("guide/gap.md", why("data/scenes/paper/crane-drop.toml"), False),
    "crane-seeds": ("theory/deployment.md", crane_seeds, True),
    "filling-mouth": ("theory/filling.md", filling_mouth, False),
    "filling-varied": ("theory/filling.md", filling_varied, True),
    "filling-reefed": ("theory/filling.md", filling_reefed, False),
    "filling-packed": ("theory/filling.md", filling_packed, False),
}


def markers(block):
    return f"<!-- begin of what docs-tables makes: {block} -->\n", f"<!-- end of what docs-tables makes: {block} -->\n"


def parts(docs, block):
    """Path, and the text before, between and after its markers."""
    path = os.path.join(docs, BLOCKS[block][0])
    with open(path) as file:
        text = file.read()
    begin, end = markers(block)
    if text.count(begin) != 1 or text.count(end) != 1 or text.index(begin) > text.index(end):
        sys.exit(f"{path}: the block '{block}' has not one begin and one end, each on a line of its own")
    head, rest = text.split(begin)
    body, tail = rest.split(end)
    return path, head + begin, body, end + tail


def make(tools, blocks):
    for block in blocks:
        path, before, _, after = parts(tools.docs, block)
        body = BLOCKS[block][1](tools)
        with open(path, "w") as file:
            file.write(before + body + after)
        print(f"{path}: {block}", flush=True)
    return 0


def check(docs, commit="[0-9a-f]{7,}"):
    """`commit`: what blocks may say of theirs, a pattern."""
    bad = 0
    for block in BLOCKS:
        path, _, body, _ = parts(docs, block)
        if not re.search(rf"^Made by `.*`:.* commit (?:{commit})", body, re.MULTILINE) or (body.count("\n|") < 4 and "```" not in body):
            print(f"{path}: the block '{block}' does not say what made it, of which commit, or has no table")
            bad += 1
    return 1 if bad else 0


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "check":
        return check(arguments[1])
    if len(arguments) >= 5 and arguments[0] == "make":
        tools = Tools(*arguments[1:5], short=False)
        if tools.provenance()["commit"] == "unknown":
            sys.exit("the program does not know its commit (it was made of a source archive), and tables have to name one: build it in a clone")
        return make(tools, arguments[5:] or BLOCKS)
    if len(arguments) == 5 and arguments[0] == "short":
        with tempfile.TemporaryDirectory() as directory:
            docs = shutil.copytree(arguments[1], os.path.join(directory, "docs"))
            tools = Tools(docs, *arguments[2:], short=True)
            code = make(tools, [b for b in BLOCKS if BLOCKS[b][2]])
            # A program made of a source archive knows no commit: its tables say so, those that are kept name one.
            return code or check(docs, "[0-9a-f]{7,}|" + re.escape(tools.provenance()["commit"]))
    print(__doc__)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
