#!/usr/bin/env python3
"""Takes the picture of the page of `twinchute serve`: a heavier payload than the scene's, and the full model beside it.

usage: serve.py TWINCHUTE SCENE PICTURE.png [WIDTH HEIGHT SCHEME [TEST...]]
TEST: files of a drop test, which are dropped on the page instead.
"""

import json
import os
import pathlib
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tests/browser"))
from chromium import Chromium

tests = [pathlib.Path(name) for name in sys.argv[7:]]
width, height, scheme = (int(sys.argv[4]), int(sys.argv[5]), sys.argv[6]) if len(sys.argv) > 4 else (1400, 900, "light")
server = subprocess.Popen([sys.argv[1], "serve", sys.argv[2]], stdout=subprocess.PIPE, text=True)


def until(page, what):
    while not page.ask(f"Boolean({what})"):
        time.sleep(0.1)


try:
    with Chromium(120) as page:
        page.open(server.stdout.readline().strip(), width=width, height=height, scheme=scheme)
        until(page, "serve.idle()")
        if tests:
            files = [{"name": test.name, "text": test.read_text(encoding="utf-8")} for test in tests]
            page.ask("(() => { const carried = new DataTransfer(); for (const one of " + json.dumps(files) + ") carried.items.add(new File([one.text], one.name));"
                     "document.body.dispatchEvent(new DragEvent('drop', {bubbles: true, dataTransfer: carried})); })()")
            until(page, "!document.getElementById('calibration').hidden")
            page.ask("[...document.querySelectorAll('#calibration-body button')][0].click()")
            until(page, "serve.idle()")
            time.sleep(1)
            page.screenshot(sys.argv[3])
            sys.exit()
        page.ask("""(() => { const k = serve.knobs.knobs.get('payload.mass'); k.slider.value = serve.knobs.placeAt(k.slide, 200);
            for (const kind of ['input', 'change']) k.slider.dispatchEvent(new Event(kind)); })()""")
        until(page, "serve.idle()")
        page.ask("document.getElementById('run-full').click()")
        until(page, "serve.runs.runs.full && serve.runs.runs.full.whole")
        time.sleep(1)
        page.screenshot(sys.argv[3])
finally:
    server.terminate()
    server.wait()
