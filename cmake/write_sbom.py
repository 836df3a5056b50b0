#!/usr/bin/env python3
"""Writes what a binary was made of, as a CycloneDX bill of materials.

    write_sbom.py BUILD BINARY NAME VERSION OUTPUT

Ninja knows every header, archive and script that BINARY was made of, and the file itself the shared libraries that it
asks for; dpkg knows their packages with versions, and its copyright files the licences. A file of no package is named
on standard error. SOURCE_DATE_EPOCH is the time in it.
"""

import datetime
import json
import os
import re
import subprocess
import sys

# Debian's names of licences, without regard to case, and those of SPDX. Others stand as Debian has them.
SPDX = {"apache-2.0": "Apache-2.0", "bsd-3-clause": "BSD-3-Clause", "bsl-1.0": "BSL-1.0", "expat": "MIT", "gpl-2": "GPL-2.0-only",
        "gpl-3+": "GPL-3.0-or-later", "lgpl-3+": "LGPL-3.0-or-later", "mpl-2": "MPL-2.0", "zlib": "Zlib"}
HOW = ("dynamic", "static", "embedded", "headers")  # of several the first says most


def lines(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


def used_files(build, binary):
    """Files of the system in the binary, each with how it is used."""
    target = os.path.relpath(binary, build)
    link = set(lines("ninja", "-C", build, "-t", "commands", "-s", target)[-1].split())  # of objects and libraries
    modules = {re.sub(r"^lib|\.a$", "", os.path.basename(path)) for path in link if path.endswith(".a")}
    used = {path: "static" for path in link if path.startswith("/") and path.endswith(".a")}
    used |= {path: "embedded" for path in lines("ninja", "-C", build, "-t", "inputs", target) if re.match("/.*\\.js$", path)}
    own = False
    for line in lines("ninja", "-C", build, "-t", "deps"):
        if line and not line.startswith(" "):
            made = line.split(":")[0]
            own = made in link or re.search(r"CMakeFiles/([^/]*)\.dir/", made)[1] in modules
        elif own and line.strip().startswith("/"):
            used[os.path.normpath(line.strip())] = "headers"
    needed = {line.split()[1] for line in lines("objdump", "-p", binary) if line.strip().startswith("NEEDED")}
    for line in lines("ldd", binary):
        if (found := re.match(r"\s+(\S+)(?: => (\S+))? \(", line)) and os.path.basename(found[1]) in needed:
            used[found[2] or found[1]] = "dynamic"
    return used


def packages_of(used, source):
    """Packages of these files, each with how it is used."""
    names = {}
    for path, how in used.items():
        if not path.startswith(source + "/"):
            # Also as dpkg knows them: before links, and before /lib became /usr/lib.
            for name in {path, os.path.realpath(path), os.path.realpath(path).removeprefix("/usr")}:
                names[name] = path
    owners, found = {}, set()
    listed = subprocess.run(["dpkg", "-S", *sorted(names)], capture_output=True, text=True).stdout  # fails where one is of no package
    for line in listed.splitlines():
        package, _, name = line.rpartition(": ")
        if name in names and not package.startswith("diversion by"):
            found.add(names[name])
            owners.setdefault(package.split(",")[0], set()).add(used[names[name]])
    for path in sorted(set(names.values()) - found):
        print(f"write_sbom.py: {path} is of no package", file=sys.stderr)
    return {package: min(hows, key=HOW.index) for package, hows in owners.items()}


def licence(package):
    """Licence of most of a package, as its copyright file names it: none where that has no such line."""
    try:
        with open(f"/usr/share/doc/{package}/copyright", encoding="utf-8", errors="replace") as file:
            found = re.search(r"^Files:\s*\*.*?^License: *([^\n]+)", file.read(), re.MULTILINE | re.DOTALL)
    except FileNotFoundError:
        found = None
    if not found:
        return []
    name = found[1].strip()
    return [{"license": {"id": SPDX[name.lower()]} if name.lower() in SPDX else {"name": name}}]


def component(package, how):
    form = "${Package}\t${Version}\t${Architecture}\t${source:Package}"
    name, version, architecture, source = lines("dpkg-query", "-W", "-f", form, package)[0].split("\t")
    purl = f"pkg:deb/debian/{name}@{version.replace(':', '%3A').replace('+', '%2B')}?arch={architecture}"
    entry = {"type": "library", "bom-ref": purl, "name": name, "version": version, "purl": purl, "licenses": licence(name),
             "properties": [{"name": "linked", "value": how}, {"name": "source", "value": source}]}
    return {key: value for key, value in entry.items() if value}


def main(build, binary, name, version, output):
    source = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    packages = packages_of(used_files(build, binary), source)
    components = [component(package, packages[package]) for package in sorted(packages)]
    time = datetime.datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH") or datetime.datetime.now().timestamp()), datetime.timezone.utc)
    bill = {
        "bomFormat": "CycloneDX", "specVersion": "1.4", "version": 1,
        "metadata": {
            "timestamp": time.strftime("%Y-%m-%dT%H:%M:%SZ"),
            "component": {"type": "application", "bom-ref": name, "name": name, "version": version, "licenses": [{"license": {"id": "GPL-3.0-or-later"}}]},
        },
        "components": components,
        "dependencies": [{"ref": name, "dependsOn": [each["bom-ref"] for each in components]}],
    }
    os.makedirs(os.path.dirname(os.path.abspath(output)), exist_ok=True)
    with open(output, "w", encoding="utf-8") as file:
        json.dump(bill, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
