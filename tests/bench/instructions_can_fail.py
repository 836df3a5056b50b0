#!/usr/bin/env python3
"""Shows that instructions.py finds what it looks for: doctored figures, files and builds, and no valgrind run.

Usage: instructions_can_fail.py
"""

import contextlib
import io
import os
import sys
import tempfile
import unittest
from unittest import mock

sys.dont_write_bytecode = True  # the source tree stays as it is
import instructions

COUNTED = {name: (1_000_000 + 7 * k, 100) for k, name in enumerate(instructions.RUNS)}
RELEASE = {"compiler": "GNU 12.2.0", "libc": "glibc 2.36", "flags": "-O3 -DNDEBUG -ffp-contract=off"}


class TheGate(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.figures = os.path.join(directory.name, "instructions.txt")

    def ask(self, committed=None, made=RELEASE, here=RELEASE, action="check", counted=COUNTED):
        """Exit code and output, with counts that nobody had to wait for."""
        if committed is not None:
            instructions.write_figures(self.figures, made, committed)
        out = io.StringIO()
        with contextlib.redirect_stdout(out), mock.patch.object(instructions, "check_machine"), \
                mock.patch.object(instructions, "made_with", lambda program: here):
            code = instructions.main([action, "program", self.figures], lambda program, name: counted[name])
        return code, out.getvalue()

    def doctored(self, name, factor, steps=100):
        return COUNTED | {name: (round(factor * COUNTED[name][0]), steps)}

    def test_passes_on_its_own_figures(self):
        code, out = self.ask(COUNTED)
        self.assertEqual(code, 0, out)
        self.assertEqual(out.count("+0.00 %"), len(COUNTED))

    def test_passes_within_the_tolerance(self):
        for factor in (0.985, 1.015):
            self.assertEqual(self.ask(self.doctored("inflation", factor))[0], 0)

    def test_every_run_can_be_too_dear(self):
        for name in COUNTED:
            code, out = self.ask(self.doctored(name, 1 / 1.03))
            self.assertEqual(code, 1)
            line = next(line for line in out.splitlines() if line.startswith(name))
            self.assertIn("+3.00 %", line)
            self.assertIn("DEARER", out)
            self.assertIn("renew-instructions", out)

    def test_a_gain_asks_for_a_lower_figure(self):
        code, out = self.ask(self.doctored("rom", 1 / 0.97))
        self.assertEqual(code, 1)
        self.assertIn("-3.00 %", out)
        self.assertIn("lower the figure", out)

    def test_says_when_it_was_the_number_of_steps(self):
        code, out = self.ask(self.doctored("stages", 1 / 1.1, steps=80))
        self.assertEqual(code, 1)
        self.assertIn("100 steps, committed 80: +25.00 %", out)

    def test_a_run_without_a_figure_fails(self):
        code, out = self.ask({name: c for name, c in COUNTED.items() if name != "rom"})
        self.assertEqual(code, 1)
        self.assertIn("rom", out)

    def test_another_compiler_or_build_is_skipped_with_the_reason(self):
        for here, reason in (
            (RELEASE | {"compiler": "GNU 13.1.0"}, "GNU 13.1.0"),
            (RELEASE | {"libc": "glibc 2.40"}, "glibc 2.40"),
            (RELEASE | {"flags": "-Og -g"}, "-Og"),
            (RELEASE | {"flags": "-O3 -ffp-contract=off"}, "release"),
            (RELEASE | {"flags": "-O3 -DNDEBUG -fsanitize=address"}, "-fsanitize"),
            (RELEASE | {"flags": "-O3 -DNDEBUG --coverage"}, "--coverage"),
            (RELEASE | {"flags": "-O3 -DNDEBUG -march=x86-64-v3"}, "-march"),
        ):
            code, out = self.ask(COUNTED, here=here)
            self.assertEqual(code, instructions.SKIPPED)
            self.assertIn(reason, out)

    def test_renewed_figures_pass(self):
        self.assertEqual(self.ask(action="renew")[0], 0)
        self.assertEqual(self.ask()[0], 0)

    def test_the_committed_figures_are_of_these_runs(self):
        committed = os.path.join(os.path.dirname(os.path.abspath(__file__)), "instructions.txt")
        made, counts = instructions.read_figures(committed)
        self.assertEqual(set(made), {"compiler", "libc"})
        self.assertEqual(set(counts), set(instructions.RUNS))


if __name__ == "__main__":
    unittest.main()
