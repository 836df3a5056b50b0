#!/usr/bin/env python3
"""Checks a CI file as far as that is possible without its service: YAML without doubled keys, the structure that the service
requires, shell commands that parse, and that it runs the gate, publishes and keeps its results. Exit code 77: no PyYAML."""

import subprocess
import sys

try:
    import yaml
except ImportError:
    print("PyYAML is not installed")
    sys.exit(77)


class Loader(yaml.SafeLoader):
    """Refuses a key that stands twice, of which YAML parsers take the last."""


def mapping(loader, node):
    keys = [loader.construct_object(key) for key, _ in node.value]
    for key in keys:
        if keys.count(key) > 1:
            raise yaml.YAMLError(f"the key {key!r} stands twice")
    return yaml.SafeLoader.construct_mapping(loader, node, deep=True)


Loader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, mapping)


def require(right, what):
    if not right:
        raise ValueError(what)


def require_shell(script):
    require(isinstance(script, str) and script.strip(), "an empty command")
    checked = subprocess.run(["bash", "-n"], input=script, text=True, capture_output=True, check=False)
    require(checked.returncode == 0, f"the shell does not parse {script!r}: {checked.stderr}")


def require_gate(commands):
    gates = [c for c in commands if "compare-scenes" in c]
    require(len(gates) == 1, "the scenes are compared once")
    lines = gates[0].strip().splitlines()
    require("compare-scenes" in lines[-1] and "||" not in gates[0], "the gate's exit code is the step's")


def check_github(content):
    # YAML 1.1 reads the bare word on as true.
    require(set(content) <= {"name", True, "permissions", "env", "jobs"} and "jobs" in content, "keys of a workflow")
    require({"push", "pull_request"} <= set(content[True]), "runs on pushes and pull requests")
    commands, uses = [], []
    for name, job in content["jobs"].items():
        require(isinstance(job.get("runs-on"), str) and job.get("steps"), f"job {name} has a machine and steps")
        for step in job["steps"]:
            known = {"name", "if", "uses", "with", "run", "shell", "working-directory", "env"}
            require(set(step) <= known, f"unknown keys {set(step) - known}")
            require(("run" in step) != ("uses" in step), f"step {step.get('name')} either runs or uses")
            if "run" in step:
                require_shell(step["run"])
                commands.append(step["run"])
            else:
                require("@" in step["uses"], "an action has a version")
                uses.append(step)
    require_gate(commands)
    require(any("GITHUB_STEP_SUMMARY" in c for c in commands), "publishes a summary")
    uploads = [s for s in uses if s["uses"].startswith("actions/upload-artifact@")]
    require(uploads and all(s.get("if") == "always()" for s in uploads), "keeps results of a gate that failed")


def check_gitlab(content):
    jobs = {k: v for k, v in content.items() if k not in {"variables", "stages", "default", "include"}}
    require(len(jobs) == 1, "one job")
    (job,) = jobs.values()
    require(set(job) <= {"image", "timeout", "script", "artifacts", "stage", "rules"}, "keys of a job")
    for line in job["script"]:
        require_shell(line)
    require_gate(job["script"])
    require("compare-scenes" in job["script"][-1], "nothing comes after the gate")
    artifacts = job["artifacts"]
    require(artifacts["when"] == "always" and artifacts["paths"], "keeps results of a gate that failed")
    require(all(p.endswith("junit.xml") for p in artifacts["reports"]["junit"]), "publishes JUnit files")


def main():
    kind, file = sys.argv[1:]
    try:
        with open(file, encoding="utf-8") as stream:
            content = yaml.load(stream, Loader)
        {"github": check_github, "gitlab": check_gitlab}[kind](content)
    except (yaml.YAMLError, ValueError, KeyError, AttributeError, TypeError) as error:
        print(f"{file}: {error!r}")
        sys.exit(1)


main()
