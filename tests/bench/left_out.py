#!/usr/bin/env python3
"""Holds the cost of absent physics at zero: compares the instructions of a run whose force blocks are chosen from all
rows of the registry with those of the same run with its own rows alone.

    left_out.py PROGRAM    ends with 1 where it costs more than 0.1 %, 77 where there is no valgrind
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile

LIMIT = 1e-3  # [-] what all pieces together may cost that are not there; repeated counts agree to 1e-5
SKIPPED = 77


def count(program, rows, start):
    """Instructions of building and flying, and what the program printed."""
    with tempfile.TemporaryDirectory() as directory:
        counts = os.path.join(directory, "counts")
        words = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={counts}",
                 "--toggle-collect=twinchute::bench::fly*", program, rows, start]
        environment = {"LC_ALL": "C", "PATH": os.environ["PATH"]}
        ended = subprocess.run(words, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if ended.returncode != 0:
            sys.exit(f"{' '.join(words)} ended with {ended.returncode}:\n{ended.stderr[-2000:]}")
        with open(counts) as file:
            total = re.search(r"^(?:summary|totals): (\d+)", file.read(), re.MULTILINE)
    return int(total.group(1)), ended.stdout


def main(arguments):
    if len(arguments) != 1:
        print(__doc__)
        return 2
    if not shutil.which("valgrind"):
        print("skipped: there is no valgrind (Debian: apt-get install valgrind)")
        return SKIPPED
    good = True
    for start in ("line-stretch", "packed"):
        every, said_all = count(arguments[0], "all", start)
        own, said_own = count(arguments[0], "own", start)
        more = every / own - 1.0
        rows = [int(said.split()[0]) for said in (said_all, said_own)]
        same = said_all.split(",")[1] == said_own.split(",")[1]
        print(f"{start}: {every:_} instructions with {rows[0]} rows, {own:_} with {rows[1]}: {100 * more:+.4f} %"
              + ("" if same else "; THE ANSWERS DIFFER"))
        good = good and same and rows[1] < rows[0] and every > 1_000_000 and more <= LIMIT
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
