#!/usr/bin/env python3
"""Takes the picture of a report for the README: its first screen and its curves, as Chromium shows them.

usage: report.py REPORT.html PICTURE.png
"""

import os
import pathlib
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tests/browser"))
from chromium import Chromium

with Chromium(60) as page:
    page.open(pathlib.Path(sys.argv[1]).resolve().as_uri(), width=1120, height=900)
    end = page.ask("document.getElementById('events').getBoundingClientRect().y + scrollY")
    page.screenshot(sys.argv[2], (0, 0, 1120, end))
