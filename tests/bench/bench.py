#!/usr/bin/env python3
"""Runs the benchmarks, writes their results as JSON, and prints the tables of docs/generated/benchmarks.md.

    bench.py run PROGRAM JSON [OPTIONS]    runs PROGRAM with Google Benchmark's OPTIONS
    bench.py table JSON                    the tables of an earlier run
"""

import json
import os
import subprocess
import sys

STAGES = ["deployment", "springs", "ramp", "flight"]


def best_of(benchmarks):
    """The fastest repetition of each benchmark. The minimum estimates the uncontended time."""
    best = {}
    for run in benchmarks:
        if run.get("run_type") == "aggregate" or run.get("error_occurred"):
            continue
        # What was asked for in particular stands in the name: "run/x/iterations:1/repeats:3".
        name = "/".join(part for part in run["name"].split("/") if ":" not in part and part != "manual_time")
        if name not in best or run["cpu_time"] < best[name]["cpu_time"]:
            best[name] = run
    return best


def table(head, rows):
    """Markdown, with columns that line up; the first to the left, the others to the right."""
    rows = [head] + rows
    width = [max(len(row[k]) for row in rows) for k in range(len(head))]
    line = lambda row: "| " + " | ".join(
        cell.ljust(w) if k == 0 else cell.rjust(w) for k, (cell, w) in enumerate(zip(row, width))) + " |"
    rule = "| " + " | ".join("-" * w if k == 0 else "-" * (w - 1) + ":" for k, w in enumerate(width)) + " |"
    return "\n".join([line(rows[0]), rule] + [line(row) for row in rows[1:]])


def number(value, digits=3):
    """With so many digits, and no exponent."""
    if value is None:
        return ""
    whole = len(str(int(abs(value))))
    return f"{value:.{max(0, digits - whole)}f}"


def machine(context):
    cache = ", ".join(f"L{c['level']} {c['size'] // 1024} kB" for c in context["caches"] if c["type"] != "Instruction")
    load = " ".join(number(x, 2) for x in context["load_avg"])
    return (f"{context['cpu']}, {context['num_cpus']} cores, {cache}; instruction set {context['instruction_set']}; "
            f"{context['compiler']}, {context['flags']}; commit {context['commit']}; {context['date'][:16]}; "
            f"load at the start {load or 'unknown'}")


def ceilings(best):
    rows = []
    for name, run in best.items():
        if name.startswith("ceiling/"):
            unit = "GFLOP/s" if "GFLOP_per_s" in run else "GB/s"
            rows.append([name[len("ceiling/"):].replace("/", ", "), number(run.get("GFLOP_per_s", run.get("GB_per_s"))), unit])
    return table(["ceiling of one core", "", "unit"], rows) if rows else ""


def elements(best):
    found = {}  # {block: {size: run}}
    for name, run in best.items():
        if name.startswith("element/"):
            _, block, size = name.split("/")
            found.setdefault(block, {})[size] = run
    if not found:
        return ""
    sizes = sorted({size for runs in found.values() for size in runs}, key=int)
    row = lambda name, block, counter, scale=1.0: [name] + [
        number(scale * found[block][s][counter]) if s in found[block] else "" for s in sizes]
    rows = [row(block.replace("-", " "), block, "ns_per_element") for block in found if block != "step"]
    if "step" in found:
        rows += [row("whole step", "step", "ns_per_element"),
                 row("whole step [us]", "step", "us_per_step"),
                 row("million element-steps a second", "step", "element_steps_per_s", 1e-6),
                 row("memory per triangle [B]", "step", "B_per_triangle"),
                 row("the same, unstructured [B]", "step", "B_per_triangle_indexed")]
    if "membrane" in found:
        rows += [row(f"triangles {state} [%]", "membrane", state + "_percent") for state in ("taut", "wrinkled", "slack")]
    return table(["ns per element, on a mesh of"] + [f"{int(s):,}".replace(",", " ") for s in sizes], rows)


def roofline(best):
    """Loops of the gore-batched layout with the widest instructions: their time beside what ceilings allow."""
    ceiling = lambda name: best.get("ceiling/" + name)
    peaks = [run["GFLOP_per_s"] for name, run in best.items() if name.startswith("ceiling/multiply-add/")]
    caches = [ceiling("read/" + level) for level in ("L1", "L2", "L3")]
    memory = ceiling("copy/memory")
    if not peaks or None in caches or memory is None:
        return ""
    parts = {}  # {(size, part): run}, with the first set of each, the widest
    for name, run in best.items():
        if ",-gores-" in name and "operations" in run:
            part, size = name[len("element/"):].split(",-gores-")[0], int(name.rsplit("/", 1)[1])
            if size in (2000, 120000):
                parts.setdefault((size, part), run)
    rows = []
    for (size, part), run in sorted(parts.items(), key=lambda entry: entry[0][0]):
        nodes = run["B_of_nodes"]
        home = next((c for c in caches if 1e3 * c["kB_of_cache"] >= nodes * run["elements"]), memory)
        least = {"arithmetic": run["operations"] / max(peaks), "L1": run["B_of_accesses"] / caches[0]["GB_per_s"],
                 home["name"].split("/")[2].split("_")[0]: nodes / home["GB_per_s"]}
        bound = max(least, key=least.get)
        rows.append([f"{part.replace('-', ' ')}, {size // 1000} 000", number(run["operations"]), number(run["B_of_accesses"]),
                     number(nodes), number(run["ns_per_element"]), number(run["operations"] / run["ns_per_element"]),
                     number(least[bound]), bound, f"{100.0 * least[bound] / run['ns_per_element']:.0f}"])
    return table(["loop, on a mesh of", "operations", "accesses [B]", "nodes [B]", "ns", "GFLOP/s", "bound [ns]", "by", "reached [%]"],
                 rows) if rows else ""


def methods(best):
    found = {}  # {problem: {solver: {digits: run}}}
    for name, run in best.items():
        if name.startswith("method/"):
            _, problem, solver, digits = name.split("/")
            found.setdefault(problem, {}).setdefault(solver, {})[digits] = run
    text = []
    for problem, solvers in found.items():
        digits = sorted({d for runs in solvers.values() for d in runs}, key=int)
        cell = lambda run: f"{number(run['cpu_time'])}, {number(run['calls'], 1)}, {run['error']:.0e}" if run else ""
        rows = [[solver] + [cell(runs.get(d)) for d in digits] for solver, runs in solvers.items()]
        text.append(table([f"{problem}: us, calls, error"] + [f"1e-{d}" for d in digits], rows))
    return "\n\n".join(text)


def runs(best):
    rows = []
    for name, run in best.items():
        if not name.startswith("run/full/"):
            continue
        for stage in STAGES:
            if stage + "_steps" in run:
                rows.append([f"{name[len('run/full/'):]}: {stage}", number(run[stage + "_steps"]),
                             number(run[stage + "_us_per_step"]), number(run[stage + "_cpu_s"])])
        rows.append([f"{name[len('run/full/'):]}: all", number(run["steps"]), number(run["us_per_step"]), number(run["cpu_s"])])
    text = [table(["full run", "steps", "us/step", "s"], rows)] if rows else []
    rows = [[name[len("run/"):].replace("/", ", "), number(run["cpu_time"]), run["time_unit"]]
            for name, run in best.items() if name.startswith(("run/rom/", "run/read-scene/"))]
    text += [table(["in one process", "", "unit"], rows)] if rows else []
    rows = [[name[len("start/"):], number(run["min_ms"]), number(run["median_ms"])]
            for name, run in best.items() if name.startswith("start/")]
    text += [table(["a whole process", "least [ms]", "median [ms]"], rows)] if rows else []
    return "\n\n".join(text)


def show(path):
    with open(path) as file:
        measured = json.load(file)
    best = best_of(measured["benchmarks"])
    failed = [b["name"] for b in measured["benchmarks"] if b.get("error_occurred")]
    print("\n\n".join(part for part in (machine(measured["context"]), ceilings(best), elements(best), roofline(best), methods(best), runs(best)) if part))
    if failed or not best:
        print(f"not measured: {', '.join(failed) or 'anything'}")
    return 1 if failed or not best else 0


def main(arguments):
    if len(arguments) >= 3 and arguments[0] == "run":
        program, path, options = arguments[1], arguments[2], arguments[3:]
        if os.path.exists(path):
            os.remove(path)  # what is shown below is of this run or of none
        code = subprocess.run([program, f"--benchmark_out={path}", "--benchmark_out_format=json"] + options).returncode
        if code != 0:
            return code
        print()
        return show(path)
    if len(arguments) == 2 and arguments[0] == "table":
        return show(arguments[1])
    print(__doc__)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
