#!/usr/bin/env python3
"""The page of `twinchute serve` as an engineer works in it: values, curves, a full run, a comparison, studies, in a headless browser.

usage: serve_in_browser.py chromium|firefox TWINCHUTE SCENE WORK [AXE]
AXE: axe.min.js of axe-core, which then looks at the page too.
Exit code 77 where there is no such browser, or twinchute was built without a server.
"""

import contextlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import urllib.parse

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import chromium
import firefox
from chromium import axe_core, barriers

failures = []

PEAK = "peak_force_N"


def expect(right, what):
    if not right:
        failures.append(what)
        print("not so:", what)


class Server:
    """`twinchute serve` and its address."""

    def __init__(self, twinchute, *words):
        self.process = subprocess.Popen([twinchute, "serve", *words], stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def end(self):
        self.process.terminate()
        self.process.wait(10)
        self.process.stdout.close()


def until(page, expression, what, seconds=60):
    """Waits until the page says so."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if page.ask(f"typeof serve !== 'undefined' && Boolean({expression})"):
            return True
        time.sleep(0.05)
    expect(False, what + ", in vain: " + expression)
    return False


def settled(page):
    """Waits until the page shows the answer to the last change."""
    page.ask("new Promise(done => setTimeout(done, 150))")
    until(page, "serve.idle()", "the page comes to rest")


def click(page, selector):
    page.ask(f"document.querySelector('{selector}').click()")


def field(key):
    return f"document.querySelector('[data-key=\"{key}\"] .entry').firstElementChild"


def type_in(page, key, words):
    """Key by key, as a hand does, and out of the field."""
    page.ask(f"(() => {{ const f = {field(key)}; f.focus(); f.select(); }})()")
    expect(page.ask(f"document.activeElement === {field(key)}"), f"the field of {key} can be typed in")
    if words:
        page.type(words)
    else:
        page.press("Delete", 46)
    page.press("Tab", 9)
    settled(page)


def control_z(page, shift=False):
    page.press("z", 90, control=True, shift=shift)
    settled(page)


def figure(page, metric, column):
    """A number of the table of key figures, by the title of its column; nan where it has none."""
    text = page.ask(f"""(() => {{ const titles = [...document.querySelectorAll('#figures-table thead th')].map(e => e.textContent);
        const cell = document.querySelector('[data-metric="{metric}"]').children[titles.indexOf('{column}')];
        return cell ? cell.textContent : ''; }})()""")
    found = re.match(r"[+\u2212\u00b1]?[0-9.]+(e-?\d+)?", text)
    return float(found[0].replace("\u2212", "-").replace("\u00b1", "")) if found else float("nan")


def columns(page):
    return page.ask("[...document.querySelectorAll('#figures-table thead th')].map(e => e.textContent)")


def of_command_line(twinchute, scene, *sets):
    words = [word for one in sets for word in ("--set", one)]
    done = subprocess.run([twinchute, "rom", str(scene), "--json", *words], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)["metrics"]


def shows_what_the_command_line_says(page, twinchute, scene):
    """Four digits of the page against the program's own answer to the same values."""
    type_in(page, "payload.mass", "300 lb")
    type_in(page, "parachute.fill_time.n", "6")
    metrics = of_command_line(twinchute, scene, "payload.mass='300 lb'", "parachute.fill_time.n=6")
    for metric in (PEAK, "filling_time_s", "descent_rate_m_s", "max_deceleration_g"):
        shown = figure(page, metric, "rom")
        expect(abs(shown - metrics[metric]) <= 5e-4 * abs(metrics[metric]), f"{metric} is that of the command line: {shown} {metrics[metric]}")
    drawn = page.ask("Math.max(...serve.curves.graphs[0].file_.map(row => row.at(-1)).filter(v => v !== null))")
    expect(abs(drawn - metrics[PEAK]) <= 0.01 * metrics[PEAK], f"the curve reaches the peak force: {drawn} {metrics[PEAK]}")
    type_in(page, "parachute.fill_time.n", "")
    expect(page.ask(field("parachute.fill_time.n") + ".value") == "4", "an empty field is the scene's value again")
    type_in(page, "payload.mass", "100")
    expect(page.ask(field("payload.mass") + ".value") == "100 kg", "a plain number is shown with the unit it was taken in")


def at_rest(look):
    """Looks until it sees the same twice: a page that still lays itself out moves under the mouse."""
    last, now = None, look()
    while now != last:
        last, now = now, look()
    return now


def slider_redraws(page):
    """Drags the mass from 100 to 200 kg. Returns the 95th percentile from input to picture [ms]."""
    page.ask("""window.took = []; window.inputs = [];
        document.addEventListener('input', (event) => inputs.push(event.timeStamp), true);
        document.addEventListener('redrawn', (event) => { const shown = inputs.filter((at) => at <= event.detail.since);
            inputs = inputs.filter((at) => at > event.detail.since);
            requestAnimationFrame(() => took.push(...shown.map((at) => performance.now() - at))); });""")
    x0, x1, y = at_rest(lambda: page.ask("""new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => {
        const k = serve.knobs.knobs.get('payload.mass'), e = k.slider; e.scrollIntoView({block: 'center', behavior: 'instant'});
        const r = e.getBoundingClientRect(), thumb = 16;
        done([100, 200].map(v => r.x + thumb / 2 + (r.width - thumb) * serve.knobs.placeAt(k.slide, v) / 1000).concat(r.y + r.height / 2)); })))"""))
    forces = set()
    page.mouse("pressed", x0, y)
    for i in range(41):
        page.mouse("moved", x0 + (x1 - x0) * i / 40, y)
        forces.add(page.ask("new Promise(done => setTimeout(() => done(document.querySelector('[data-metric=peak_force_N] strong').textContent), 60))"))
    page.mouse("released", x1, y)
    settled(page)
    took = sorted(page.ask("took"))
    mass = page.ask(field("payload.mass") + ".value")
    expect(abs(float(mass.split()[0]) - 200) < 4 and mass.endswith(" kg"), f"the slider ends at 200 kg, give or take two pixels: {mass}")
    expect(len(forces) > 30, f"figures change while it is dragged: {len(forces)} of 41")
    expect(len(took) > 30, f"every step is drawn: {len(took)} of 41")
    if not took:
        return
    worst = took[int(0.95 * (len(took) - 1))]
    print(f"from input to picture, 40 steps of the mass: median {took[len(took) // 2]:.0f} ms, 95th percentile {worst:.0f} ms")
    # Asked is 50 ms, of a machine that has nothing else to do; ten times that is noticed anywhere.
    expect(worst < 500, f"curves follow the slider: {worst} ms")


def undo_goes_back(page):
    mass, force = page.ask(field("payload.mass") + ".value"), figure(page, PEAK, "rom")
    before = figure(page, PEAK, "before")
    control_z(page)
    expect(page.ask(field("payload.mass") + ".value") == "100 kg", "one step back is the whole drag")
    expect(figure(page, PEAK, "rom") == before, "with the figures of then")
    control_z(page, shift=True)
    again = page.ask(field("payload.mass") + ".value")
    expect(again == mass and figure(page, PEAK, "rom") == force, f"and forth again: {again} {mass}")
    click(page, "#undo")
    settled(page)
    expect(page.ask(field("payload.mass") + ".value") == "100 kg", "the button does so too")


def bad_value_is_said_at_its_field(page):
    """In the words of the command line, which are those of the test of the server."""
    message = "document.querySelector('[data-key=\"payload.mass\"] .message')"
    type_in(page, "payload.mass", "9 kg")  # runs on the way to 9 ft, where each letter is a change
    force = figure(page, PEAK, "rom")
    type_in(page, "payload.mass", "9 ft")
    words = page.ask(message + ".textContent")
    expect("wrong kind of unit" in words and not page.ask(message + ".hidden"), f"the message stands at the field: {words!r}")
    expect(page.ask(field("payload.mass") + ".getAttribute('aria-invalid')") == "true", "the field is marked")
    expect(page.ask("document.getElementById('scene-error').hidden"), "and it stands nowhere else")
    expect(not page.ask("document.getElementById('stale').hidden") and figure(page, PEAK, "rom") == force, "figures are said to be of other values")
    type_in(page, "payload.mass", "120 kg")
    expect(page.ask(message + ".hidden") and page.ask("document.getElementById('stale').hidden"), "a good value removes it")
    expect(figure(page, PEAK, "rom") > force, "and runs")
    type_in(page, "payload.mass", "")
    # A key without a field gets one where the message is about it.
    page.ask("(() => { const f = " + field("parachute.deploy.by") + "; f.value = 'static-line'; f.dispatchEvent(new Event('change')); })()")
    settled(page)
    words = page.ask("[...document.querySelectorAll('[data-key=\"parachute.deploy.length\"] .message')].map(e => e.textContent)[0]")
    expect(words and "missing" in words, f"what is missing has its field: {words}")
    control_z(page)
    expect(page.ask("document.getElementById('stale').hidden"), "undo heals it")


def keys_are_found(page):
    page.ask("(() => { const s = document.getElementById('search'); s.focus(); s.value = 'wind horizontal'; s.dispatchEvent(new Event('input')); })()")
    click(page, "#found button")
    expect(page.ask("document.activeElement.closest('.knob').dataset.key") == "environment.wind.speed", "a key that is found gets its field")
    click(page, "[data-key=\"environment.wind.speed\"] .reset")
    expect(page.ask("!document.querySelector('[data-key=\"environment.wind.speed\"]')"), "and goes again")


def kept_scene_stands_beside(page):
    click(page, "#keep")
    expect("as opened (kept)" in columns(page), f"a kept scene has its column: {columns(page)}")
    force = figure(page, PEAK, "rom")
    type_in(page, "payload.mass", "200 kg")
    expect(figure(page, PEAK, "as opened (kept)") == force != figure(page, PEAK, "rom"), "its figures stay")
    expect(page.ask("[...document.querySelectorAll('#legend li')].map(e => e.textContent)") == ["rom", "as opened (kept)", "rom, before"], "its line is in the legend")
    page.ask("(() => { const e = document.getElementById('kept-name'); e.value = 'light'; e.dispatchEvent(new Event('input')); })()")
    expect("light (kept)" in columns(page), "it can be named")
    click(page, "#kept-use")
    settled(page)
    expect(figure(page, PEAK, "rom") == force, "its values can be taken up again")
    click(page, "#kept-remove")
    expect(page.ask("document.getElementById('kept').hidden") and "light (kept)" not in columns(page), "and it can be removed")


def text_is_edited(page):
    """The text itself; a name that would be markup stays text."""
    click(page, "#tab-text")
    name = "<img src=x onerror=console.error(1)> & <b>C-9</b>"
    edit = """(() => { const t = document.getElementById('scene-text'); window.as_opened = window.as_opened || t.value;
        t.value = as_opened.replace(/^name .*$/m, %s); t.dispatchEvent(new Event('input')); t.dispatchEvent(new Event('change')); })()"""
    page.ask(edit % json.dumps("name = '" + name + "'"))
    settled(page)
    expect(page.ask("document.getElementById('scene-name').textContent") == name, "the name is shown as it is written")
    expect(page.ask("document.querySelectorAll('img, h1 b').length") == 0, "and is no markup")
    page.ask(edit % json.dumps("name = 3"))
    settled(page)
    words = page.ask("document.getElementById('scene-error').textContent")
    expect(re.search(r":4:\d+: name: ", words), f"a mistake in the text is said with its line: {words!r}")
    click(page, "#undo")
    click(page, "#undo")
    settled(page)
    expect(page.ask("document.getElementById('scene-text').value === as_opened"), "undo takes back text too")
    click(page, "#tab-values")


# Share of the canvas that is drawn on, and a sum that another picture would not have.
SHAPE = """(() => { const c = document.createElement('canvas'), s = document.getElementById('shape-canvas'); c.width = s.width; c.height = s.height;
    const x = c.getContext('2d'); x.drawImage(s, 0, 0); const d = x.getImageData(0, 0, c.width, c.height).data; let drawn = 0, sum = 0;
    for (let i = 3; i < d.length; i += 4) if (d[i]) { ++drawn; sum = (31 * sum + i + d[i - 1]) % 1000003; } return {share: 4 * drawn / d.length, sum: sum}; })()"""


def canopy_opens(page, frames_while_it_ran):
    """After the run: all shapes of the record, the open canopy wider than the one at first, turned by keys."""
    frames = page.ask("serve.shape.frames()")
    expect(frames > frames_while_it_ran > 0, f"shapes come while it runs: {frames_while_it_ran} of {frames}")
    last = page.ask(SHAPE)
    page.ask("(() => { const s = document.getElementById('shape-time'); s.value = 0; s.dispatchEvent(new Event('input')); })()")
    first = page.ask(SHAPE)
    expect(0.001 < first["share"] < last["share"] < 0.9, f"the canopy opens: {first} {last}")
    expect("0.00 s since release" == page.ask("document.getElementById('shape-words').textContent"), "the slider says the time of the frame")
    page.ask("document.getElementById('shape-canvas').focus()")
    page.press("ArrowLeft", 37)
    expect(page.ask(SHAPE)["sum"] != first["sum"], "an arrow key turns it")


def full_run_is_followed(page):
    """Seven times the rows of the scene's own mesh, so that there is a middle."""
    page.ask("document.querySelector('[data-group=full]').open = true")
    type_in(page, "full.mesh.gore_rows", "60")
    click(page, "#run-full")
    until(page, "serve.runs.runs.full && serve.runs.runs.full.info && serve.runs.runs.full.info.share > 0", "the run says how far it is")
    until(page, "serve.curves.shown.full && serve.curves.shown.full.history.time.length > 20", "rows are drawn while it runs")
    early = page.ask("(({time, force}) => ({time: time, force: force}))(serve.curves.shown.full.history)")
    expect(all(a < b for a, b in zip(early["time"], early["time"][1:])), "each row comes once")
    until(page, "serve.shape.frames() > 0 && !document.getElementById('shape').hidden", "the canopy is drawn while it runs")
    shapes = page.ask("serve.runs.runs.full.info.state === 'running' ? serve.shape.frames() : 0")
    says = page.ask("[serve.runs.runs.full.info.state, document.querySelector('[data-run=full] progress').value, location.hash]")
    expect(says[0] == "running" and 0 < says[1] < 1, f"the bar is on its way: {says}")
    expect(says[2].startswith("#full="), f"its id is in the address: {says}")
    expect(page.ask("document.getElementById('run-full').disabled"), "no second one is started meanwhile")
    page.reload()
    until(page, "serve.runs.runs.full && serve.runs.runs.full.info", "the run is found again after a reload")
    found = page.ask("[serve.runs.runs.full.id, serve.runs.runs.full.info.state, serve.runs.same(serve.runs.runs.full)]")
    expect("#full=" + found[0] == says[2] and found[1] == "running" and found[2], f"the same, still running, of the same values: {found} {says}")
    expect(page.ask(field("full.mesh.gore_rows") + ".value") == "60", "changed values outlive a reload")
    until(page, "serve.runs.runs.full.info.state === 'done' && serve.runs.runs.full.whole", "it ends", 120)
    settled(page)
    expect(page.ask("serve.curves.shown.full.history.altitude.length > 100"), "the whole history is drawn")
    canopy_opens(page, shapes)
    whole = page.ask("(({time, force}) => ({time: time, force: force}))(serve.curves.shown.full.history)")
    at_end = dict(zip(whole["time"], whole["force"]))
    expect(all(at_end.get(time) == force for time, force in zip(early["time"], early["force"])), "rows drawn early are those of the record")
    rom, full, gap = (figure(page, PEAK, column) for column in ("rom", "full", "full minus rom"))
    expect(abs(gap - (full - rom)) <= 1.5, f"the difference is full minus rom, within the last digits shown: {gap} {full} {rom}")
    expect(0 < abs(full - rom) < 0.05 * rom, f"both models agree here within the scene's tolerance: {full} {rom}")
    type_in(page, "payload.mass", "200 kg")
    expect("full minus rom" not in columns(page) and "full, of other values" in columns(page), f"no difference of different values: {columns(page)}")
    type_in(page, "payload.mass", "")
    expect("full minus rom" in columns(page), "and with the values of the run again")


def full_run_is_cancelled(page):
    type_in(page, "full.mesh.gore_rows", "200")
    click(page, "#run-full")
    until(page, "document.querySelector('[data-run=full]').dataset.state === 'running' && !document.querySelector('[data-run=full] progress').hidden", "it starts")
    page.ask("[...document.querySelectorAll('[data-run=full] button')].find(e => e.textContent === 'Cancel').click()")
    until(page, "document.querySelector('[data-run=full]').dataset.state === 'cancelled'", "cancel ends it", 20)
    expect(not page.ask("document.getElementById('run-full').disabled"), "another may follow")
    page.ask("[...document.querySelectorAll('[data-run=full] button')].find(e => e.textContent === 'Dismiss').click()")
    type_in(page, "full.mesh.gore_rows", "")


def comparison_has_its_gap(page):
    click(page, "#run-compare")
    until(page, "!document.getElementById('gap').hidden", "the gap is shown", 120)
    strong = page.ask("document.querySelector('#gap .verdict strong').textContent")
    expect(strong == "within tolerance: 4 of 4 judged metrics", f"the verdict is that of the comparison: {strong}")
    rows = page.ask("[...document.querySelectorAll('#gap tbody tr')].map(row => [...row.children].map(e => e.textContent))")
    expect([row[0] for row in rows] == ["filling time", "peak force", "time to peak force", "descent rate"], f"judged metrics have their rows: {rows}")
    number = lambda text: float(re.match(r"[+\u2212\u00b1]?[0-9.]+", text)[0].replace("\u2212", "-").replace("\u00b1", ""))
    off = [row for row in rows if abs(number(row[3]) - (number(row[2]) - number(row[1]))) > 2e-3 * number(row[2])]
    expect(off == [], f"differences are full minus rom: {off}")
    href = page.ask("document.querySelector('#gap a').href")
    report = page.ask(f"fetch({json.dumps(href)}).then(a => a.text())")
    expect("id=\"summary\"" in report, f"the report is behind its link: {report[:200]}")


def saved_scene_runs_alike(page, twinchute, scene, out):
    type_in(page, "payload.mass", "300 lb")
    type_in(page, "parachute.fill_time.n", "6")
    page.ask("document.getElementById('save-name').value = 'changed.toml'; document.querySelector('#save button').click()")
    until(page, "document.getElementById('save-message').textContent.startsWith('Saved')", "the scene is saved")
    text = (out / "changed.toml").read_text()
    expect(f'base = "{scene.name}"' in text and '"300 lb"' in text, f"what is saved is the opened scene and the changes: {text}")
    metrics = of_command_line(twinchute, out / "changed.toml")
    expect(abs(figure(page, PEAK, "rom") - metrics[PEAK]) <= 5e-4 * metrics[PEAK], "and it runs alike")
    page.ask(f"document.getElementById('save-name').value = '{scene.name}'; document.querySelector('#save button').click()")
    until(page, "!document.getElementById('save-message').textContent.startsWith('Saved')", "the opened file is not replaced")
    expect(scene.read_text() == page.ask("document.getElementById('scene-text').value"), "nor changed")
    for key in ("payload.mass", "parachute.fill_time.n"):
        type_in(page, key, "")


def fits(page, width, height, scheme):
    scheme = scheme if scheme in page.SCHEMES else "light"
    page.resize(width, height, scheme)
    settled(page)
    expect(page.ask("document.documentElement.scrollWidth <= innerWidth"), f"nothing sticks out at {width} px")
    small = page.ask("""[...document.querySelectorAll('body *')].filter(e => e.getClientRects().length && e.textContent.trim() && !e.closest('script, style'))
        .map(e => parseFloat(getComputedStyle(e).fontSize)).filter(size => size < 11)""")
    expect(small == [], f"words are 11 px at least at {width} px: {small[:5]}")
    overlapping = page.ask("""(() => { const boxes = [...document.querySelectorAll('body > header, #inputs, .actions, .run, #figures, #legend, .history, #limits, #gap, #formulas')]
        .filter(e => e.getClientRects().length).map(e => [e.id || e.className, e.getBoundingClientRect()]); const found = [];
        boxes.forEach(([a, r], i) => boxes.slice(i + 1).forEach(([b, s]) => {
            if (r.left < s.right - 1 && s.left < r.right - 1 && r.top < s.bottom - 1 && s.top < r.bottom - 1) found.push(a + ' ' + b); }));
        return found; })()""")
    expect(overlapping == [], f"nothing overlaps at {width} px: {overlapping}")
    light = page.ask("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    expect(light == (scheme == "light"), f"{scheme} is {scheme}")


def is_accessible(page):
    nameless = page.ask("""[...document.querySelectorAll('button, input, select, textarea, progress, a, [role=img], [role=region], [role=tabpanel]')].filter(e =>
        getComputedStyle(e).display !== 'none' && !(e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || (e.labels && e.labels.length) || e.textContent.trim()))
        .map(e => e.outerHTML.slice(0, 80))""")
    expect(nameless == [], f"everything that can be used has a name: {nameless}")
    levels = page.ask("[...document.querySelectorAll('h1, h2, h3')].filter(e => !e.closest('[hidden]')).map(e => +e.tagName[1])")
    expect(levels[0] == 1 and all(b <= a + 1 for a, b in zip(levels, levels[1:])), f"no level of heading is skipped: {levels}")
    doubled = page.ask("(() => { const ids = [...document.querySelectorAll('[id]')].map(e => e.id); return ids.filter((x, i) => ids.indexOf(x) !== i); })()")
    expect(doubled == [], f"every id is there once: {doubled}")
    page.ask("document.getElementById('tab-values').focus()")
    page.press("ArrowRight", 39)
    expect(page.ask("document.activeElement.id") == "tab-text" and not page.ask("document.getElementById('text').hidden"), "arrow keys change the tab")
    page.press("ArrowLeft", 37)
    page.ask("document.querySelector('[data-key=\"payload.mass\"] input[type=range]').focus()")
    page.press("ArrowRight", 39)
    settled(page)
    expect(page.ask("'payload.mass' in serve.state.set"), "arrow keys move a slider")
    control_z(page)
    page.ask("document.getElementById('cursor').focus()")
    before = page.ask("document.querySelector('[data-channel=force] .readout').textContent")
    for _ in range(5):
        page.press("ArrowRight", 39)
    expect(page.ask("document.querySelector('[data-channel=force] .readout').textContent") != before, "and read the curves")


def series_shows_a_case(page, url):
    page.open(url, width=1000, height=800)
    until(page, "document.querySelector('[data-metric=snatch_speed_m_s], [data-metric=peak_force_N]')", "a series is opened")
    first = figure(page, PEAK, "rom")
    names = page.ask("[...document.getElementById('case').options].map(e => e.value)")
    expect(len(names) == 3 and not page.ask("document.getElementById('series').hidden"), f"its cases can be chosen: {names}")
    page.ask("(() => { const e = document.getElementById('case'); e.value = e.options[2].value; e.dispatchEvent(new Event('change')); })()")
    settled(page)
    expect(figure(page, PEAK, "rom") > 1.2 * first, "the fastest case pulls harder than the slowest")


def limits_have_their_margins(page, twinchute, scene, url):
    """Limits of [size] against the same run of the command line: the scene as it is exceeds one and keeps the other."""
    page.open(url, width=1000, height=800)
    until(page, "!document.getElementById('limits').hidden", "a scene with limits is opened")
    metrics = of_command_line(twinchute, scene)
    rows = page.ask("Object.fromEntries([...document.querySelectorAll('#limits tbody tr')].map(row => [row.dataset.limit, row.lastElementChild.textContent]))")
    for key, limit, metric in (("size.max_force", 25e3, "max_force_N"), ("size.max_descent_rate", 8.5, "descent_rate_m_s")):
        margin = 100 * (1 - metrics[metric] / limit)
        found = re.match(r"([\u2713\u2717]) ([0-9.]+) % (below|above)", rows[key])
        expect(found and found[1] == ("\u2713" if margin > 0 else "\u2717") and found[3] == ("below" if margin > 0 else "above")
               and abs(float(found[2]) - abs(margin)) <= 6e-3 * abs(margin), f"{key}: {rows[key]}, expected {margin} %")
    click(page, "#run-full")
    until(page, "!document.getElementById('run-error').hidden", "a scene that full cannot run is refused")
    expect("parachute.gores" in page.ask("document.getElementById('run-error').textContent"), "with what it needs")


def sizing_finds_what_the_command_line_finds(page, twinchute, scene, url):
    page.open(url, width=1000, height=800)
    until(page, "serve.idle() && !document.getElementById('run-size').hidden", "a scene with limits can be sized")
    click(page, "#run-size")
    until(page, "!document.getElementById('sizing').hidden", "the table of candidates is shown", 60)
    by_hand = json.loads(subprocess.run([twinchute, "size", str(scene), "--json"], stdout=subprocess.PIPE, check=True).stdout)["candidates"]
    rows = page.ask("[...document.querySelectorAll('#sizing-table tbody tr')].map(row => [row.children[0].textContent, row.children[1].textContent, row.className])")
    expect([row[0] for row in rows] == [one["type"] for one in by_hand], f"a row a candidate: {rows}")
    for row, one in zip(rows, by_hand):
        expect(abs(float(row[1].split()[0]) / one["varied"]["nominal_diameter"]["value"] - 1) < 1e-3, f"the diameter that the command line finds: {row}")
        expect((row[2] == "judged") == one["best"], f"the best stands out: {row}")
    before = page.ask("document.getElementById('scene-text').value")
    page.ask("document.querySelector('#sizing-table tr.judged button').click()")
    settled(page)
    best = next(one for one in by_hand if one["best"])
    for metric in ("descent_rate_m_s", PEAK):
        expect(abs(figure(page, metric, "rom") / best["metrics"][metric] - 1) < 1e-3, f"its scene runs as it was sized: {metric}")
    expect(not page.ask("document.getElementById('sizing-stale').hidden"), "the table says that it is of other values")
    page.ask("document.getElementById('undo').click()")
    settled(page)
    expect(page.ask("document.getElementById('scene-text').value") == before and page.ask("document.getElementById('sizing-stale').hidden"), "undo goes back")


def parachutes_are_told_apart(page, twinchute, scene, url):
    page.open(url, width=1000, height=800)
    until(page, "document.querySelector('[data-metric=main_filling_time_s]')", "each of two parachutes has its filling time")
    shown = page.ask(field("parachute.main.mass") + ".value")
    expect(shown == "15 oz", f"a value is shown in the unit of its file: {shown}")
    page.ask("(() => { const s = document.getElementById('search'); s.value = 'joint_efficiency'; s.dispatchEvent(new Event('input')); })()")
    found = page.ask("[...document.querySelectorAll('#found code')].map(e => e.textContent)")
    expect(found == ["parachute.drogue.joint_efficiency", "parachute.main.joint_efficiency"], f"a search finds a key of each: {found}")
    type_in(page, "parachute.main.mass", "3 lb")
    metrics = of_command_line(twinchute, scene, "parachute.main.mass='3 lb'")
    for metric in (PEAK, "main_filling_time_s", "landing_vertical_speed_m_s"):
        found = figure(page, metric, "rom")
        expect(abs(found - metrics[metric]) <= 5e-4 * abs(metrics[metric]), f"{metric} is that of the command line: {found} {metrics[metric]}")
    type_in(page, "parachute.main.mass", "")
    ends = page.ask("[...document.querySelectorAll('[data-key=\"parachute.main.mass\"] .ends span')].map(e => e.textContent)")
    expect(ends == ["5 oz", "45 oz"], f"its slider goes from a third to three times, in that unit: {ends}")


def drop(page, *files):
    """Files dragged onto the page and dropped there."""
    carried = [{"name": file.name, "text": file.read_text(encoding="utf-8")} for file in files]
    page.ask(f"""(() => {{ const carried = new DataTransfer();
        for (const one of {json.dumps(carried)}) carried.items.add(new File([one.text], one.name));
        for (const kind of ['dragover', 'drop'])
            document.body.dispatchEvent(new DragEvent(kind, {{bubbles: true, cancelable: true, dataTransfer: carried}})); }})()""")


def rows(page, selector):
    """Texts of the cells of a table's body."""
    return page.ask(f"[...document.querySelectorAll('{selector} tbody tr')].map(row => [...row.children].map(cell => cell.textContent))")


def dropped_test_is_fitted(page, data, url, work):
    """The truth is that of data/calibration/make_drops.py: n = 5.5, 39 m2, a ratio of 0.06; the interval of each holds it."""
    drops = data / "calibration"
    page.open(url, width=1400, height=1000)
    until(page, "document.querySelector('[data-metric]')", "the page of the scene that is calibrated shows a run")
    drop(page, drops / "c9-drop-a.toml")  # without its histories
    until(page, "!document.getElementById('run-error').hidden", "half a test is refused")
    expect("give both files together" in page.ask("document.getElementById('run-error').textContent"), "a test without its file says what is missing")
    drop(page, *(drops / ("c9-drop-" + name) for name in ("a.toml", "a.csv", "b.toml", "b.csv")))
    until(page, "!document.getElementById('calibration').hidden", "dropped tests are fitted")
    inputs = {row[0]: row for row in rows(page, "#calibration-body .scroll:first-of-type table")}
    for key, truth in (("parachute.fill_time.n", 5.5), ("parachute.drag_area", 39.0), ("parachute.initial_drag_area_ratio", 0.06)):
        low, high = map(float, re.findall(r"[0-9.]+", inputs[key][3])[:2])
        expect(low < truth < high, f"the interval of {key} holds the truth {truth}: {inputs[key]}")
    points = page.ask("serve.curves.shown.measured.history.force.filter(serve.isNumber).length")
    lines = (drops / "c9-drop-a.csv").read_text(encoding="utf-8").splitlines()
    expect(points == sum(line[0].isdigit() for line in lines), f"each reading under the scene's conditions is a point of the curves: {points}")
    predicted = rows(page, "#calibration-body .scroll:nth-of-type(2) table")
    peak = next(row for row in predicted if row[0] == "peak force")
    page.ask("[...document.querySelectorAll('#calibration-body button')].find(b => b.textContent.startsWith('Use')).click()")
    settled(page)
    # The values found have six digits in the form, the prediction four.
    now = figure(page, PEAK, "rom")
    expect(abs(now - float(re.match(r"[0-9.]+", peak[2])[0])) <= 1.0, f"with the values found the page's peak is the predicted one: {now}, {peak}")
    expect(not page.ask("document.getElementById('calibration-stale').hidden"), "a calibration from other values says so")
    control_z(page)
    expect(page.ask("document.getElementById('calibration-stale').hidden"), "after undo it is of the values shown")
    page.ask("[...document.querySelectorAll('#calibration-body button')].find(b => b.textContent.startsWith('Save')).click()")
    saved = work / "c9-drop-calibrated.toml"
    until(page, "document.querySelector('#calibration-body [role=status]').textContent.startsWith('Saved')", "the calibrated scene is saved")
    expect("[uncertainty]" in saved.read_text(encoding="utf-8"), "the saved scene has the uncertainty")
    page.reload()
    until(page, "!document.getElementById('calibration').hidden", "a reload finds the calibration")


def dropped_campaign_is_run(page, twinchute, data, scene, work, axe):
    """Over the same scene the page's answers are those of the command line, to the digits shown: same seed, same bits."""
    plan = work / "plan.toml"
    plan.write_text((data / "campaigns" / "c9-overload.toml").read_text(encoding="utf-8").replace("c9-inflation.toml", scene.name).replace("20000", "3000"), encoding="utf-8")
    said = subprocess.run([twinchute, "campaign", str(plan), "--json", "--set", "payload.mass=160 kg", "--out", str(work / "plan.out")],
                          capture_output=True, text=True, check=False)
    if "is not in this build" in said.stderr:
        print("without HDF5 or Random123 no campaign was dropped")
        return
    answers = {one["name"]: one for one in json.loads(said.stdout)["answers"]}
    type_in(page, "payload.mass", "160 kg") if page.ask("Boolean(document.querySelector('[data-key=\"payload.mass\"]'))") else page.ask(
        "serve.change('payload.mass', '160 kg')")
    settled(page)
    drop(page, plan)
    until(page, "!document.getElementById('campaign').hidden", "a dropped campaign is run")
    shown = {re.match("overload|design load|mean peak|descent", row[0])[0]: row for row in rows(page, "#campaign-body .scroll:first-of-type table")}
    expect(set(shown) == set(answers), f"every question has its row: {shown}")
    for name, one in answers.items():
        scale = 100 if one["kind"] == "probability" else 1
        expect(re.match(r"[-0-9.e]+", shown[name][1])[0] == page.ask(f"shared.number({one['estimate'] * scale!r})"), f"{name} is that of the command line: {shown[name]}")
    expect(shown["overload"][4] in ("\u2713 met", "\u2717 exceeded", "undecided"), f"a limit has its verdict: {shown['overload']}")
    drop(page, plan, scene)
    until(page, "!document.getElementById('run-error').hidden", "a campaign and something else at once are refused")
    found = barriers(page, axe)
    expect(found == [], f"axe-core finds nothing where studies are shown: {found}")
    for width, height, scheme in ((1400, 1000, "light"), (400, 800, "dark")):
        fits(page, width, height, scheme)
        page.ask("document.getElementById('calibration').scrollIntoView({behavior: 'instant'})")
        page.screenshot(str(work / f"studies-{width}.png"))


def main():
    twinchute, scene, work = sys.argv[2], pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[4])
    module, browser, package = {"chromium": (chromium, chromium.Chromium, "chromium"), "firefox": (firefox, firefox.Firefox, "firefox-esr")}[sys.argv[1]]
    if not module.program():
        print(f"skipped: {package} is not there (Debian: apt-get install {package}), so it did not open the page of twinchute serve")
        return 77
    axe = axe_core(sys.argv[5:])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    mine = work / scene.name
    shutil.copy(scene, mine)
    limited, two = scene.parent / "sizing" / "cargo-drop-reefed.toml", scene.parent / "rocket-dual-deploy.toml"
    sizable = scene.parent / "sizing" / "cargo-drop.toml"
    data = scene.parent.parent
    tested = work / "c9-drop.toml"  # by what it is based on, among the scenes of the data
    shutil.copy(data / "calibration" / tested.name, tested)
    others = [scene.parent / "c9-inflation-speeds.toml", limited, two, sizable, tested]
    with contextlib.ExitStack() as stack:
        server, *more = [stack.enter_context(Server(twinchute, str(one), "--dir", str(work))) for one in [mine, *others]]
        if not server.url.startswith("http://127.0.0.1:"):
            print("skipped: this twinchute has no server (Debian: apt-get install libcpp-httplib-dev, before the build)")
            return 77
        with browser(500) as page:
            page.open(server.url, width=1400, height=1000)
            until(page, "document.querySelector('[data-metric]')", "the page shows a run")
            shows_what_the_command_line_says(page, twinchute, mine)
            slider_redraws(page)
            undo_goes_back(page)
            bad_value_is_said_at_its_field(page)
            keys_are_found(page)
            kept_scene_stands_beside(page)
            text_is_edited(page)
            saved_scene_runs_alike(page, twinchute, mine, work)
            full_run_is_followed(page)
            full_run_is_cancelled(page)
            comparison_has_its_gap(page)
            is_accessible(page)
            for width, height, scheme in ((1400, 1000, "light"), (800, 900, "dark"), (400, 800, "light")):
                fits(page, width, height, scheme)
                found = barriers(page, axe)
                expect(found == [], f"axe-core finds nothing at {width} px: {found}")
                page.screenshot(str(work / f"serve-{width}.png"))
            series_shows_a_case(page, more[0].url)
            limits_have_their_margins(page, twinchute, limited, more[1].url)
            parachutes_are_told_apart(page, twinchute, two, more[2].url)
            sizing_finds_what_the_command_line_finds(page, twinchute, sizable, more[3].url)
            dropped_test_is_fitted(page, data, more[4].url, work)
            dropped_campaign_is_run(page, twinchute, data, tested, work, axe)
            # Lines that the browser itself writes about the refusals that were asked for above.
            log = [line for line in page.log if not re.search("status of (409|422) ", line)]
            expect(log == [], f"the page logs no error and no warning: {log}")
            ours = {urllib.parse.urlsplit(one.url).netloc for one in (server, *more)}
            elsewhere = [url for url in page.requests if not url.startswith("data:") and urllib.parse.urlsplit(url).netloc not in ours]
            expect(elsewhere == [], f"nothing is asked of anybody else: {elsewhere}")
            page.open(server.url, width=1000, height=800)
            until(page, "document.querySelector('[data-metric]')", "the page opens again")
            server.end()
            type_in(page, "payload.mass", "130 kg")
            words = page.ask("document.getElementById('scene-error').textContent")
            expect("does not answer" in words and not page.ask("document.getElementById('stale').hidden"), f"a server that has ended is said: {words!r}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
