#!/usr/bin/env python3
"""Holds the bill of materials of a binary to what other tools find in it: bill.py SOURCE BUILD BINARY

dpkg-shlibdeps lists the packages of its shared libraries. Headers, scripts and archives are those of find_package in the
CMakeLists.txt.
"""

import json
import os
import re
import subprocess
import sys
import tempfile

source, build, binary = (os.path.abspath(path) for path in sys.argv[1:4])
with tempfile.TemporaryDirectory() as work:
    os.mkdir(f"{work}/debian")
    with open(f"{work}/debian/control", "w") as control:
        control.write("Source: x\n\nPackage: x\nArchitecture: any\n")
    depends = subprocess.run(["dpkg-shlibdeps", "-O", binary], cwd=work, check=True, capture_output=True, text=True).stdout
    subprocess.run([sys.executable, f"{source}/cmake/write_sbom.py", build, binary, "twinchute", "1.2.3", f"{work}/bill.json"], check=True)
    with open(f"{work}/bill.json") as file:
        bill = json.load(file)

how = {each["name"]: each["properties"][0]["value"] for each in bill["components"]}
shared = set(re.findall(r"(?:=|, )([\w.+-]+)(?: \(|,|$)", depends.strip()))
bad = [f"{name} is not named as a shared library" for name in shared if how.get(name) != "dynamic"]
bad += [f"{name} is named, and not asked for" for name in how if how[name] == "dynamic" and name not in shared]
bad += [f"{name} is {how.get(name)}, not {wanted}" for name, wanted in {"libeigen3-dev": "headers", "libhwy-dev": "headers", "libjs-dygraphs": "embedded",
                                                                         "libjs-three": "embedded", "nlohmann-json3-dev": "headers"}.items() if how.get(name) != wanted]
bad += [f"{name} belongs to the tests" for name in ("libgtest-dev", "pybind11-dev") if name in how]
for each in bill["components"]:
    version = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", each["name"]], capture_output=True, text=True).stdout
    if not version.startswith(each["version"]):
        bad.append(f"{each['name']} is {version}, not {each['version']}")
if not any("licenses" in each for each in bill["components"]) or len(shared) < 8:
    bad.append("no licences, or hardly a library")
print("\n".join(bad) or f"{len(how)} packages, {len(shared)} of them of shared libraries")
sys.exit(1 if bad else 0)
