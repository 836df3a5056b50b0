#!/usr/bin/env python3
"""A report as a reader meets it: opens the page of a comparison in headless Chromium and uses it.

usage: report_in_browser.py TWINCHUTE SCENE WORK [AXE]
AXE: axe.min.js of axe-core, which then looks at each page too. Exit code 77 where there is no Chromium.
"""

import os
import pathlib
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from chromium import Chromium, axe_core, barriers, program

failures = []


def expect(right, what):
    if not right:
        failures.append(what)
        print("not so:", what)


def centre(page, selector):
    return page.ask(f"(() => {{ const e = document.querySelector('{selector}'); e.scrollIntoView({{block: 'center', behavior: "
                    "'instant'}); const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()")


def readouts(page):
    return page.ask("[...document.querySelectorAll('.readout')].map(e => e.textContent)")


# The share of pixels that differ from the corner, drawn and read in one go: a canvas forgets.
PIXELS = """(() => { report.canopy.draw(); const c = report.canopy.canvas, t = document.createElement('canvas');
t.width = c.width; t.height = c.height; const x = t.getContext('2d'); x.drawImage(c, 0, 0);
const d = x.getImageData(0, 0, c.width, c.height).data; let other = 0; const colours = new Set();
for (let i = 0; i < d.length; i += 4) if (d[i] !== d[0] || d[i + 1] !== d[1] || d[i + 2] !== d[2] || d[i + 3] !== d[3]) {
  ++other; colours.add((d[i] >> 4) * 256 + (d[i + 1] >> 4) * 16 + (d[i + 2] >> 4)); }
return {share: 4 * other / d.length, colours: colours.size}; })()"""


def cursor_is_linked(page):
    before = readouts(page)
    x, y = centre(page, "[data-channel=force] .curve")
    page.move_mouse(x - 60, y)
    after = readouts(page)
    expect(len(before) >= 3, "force, speed and drag area have read-outs")
    expect(all(a != b for a, b in zip(before, after)), f"pointing at one curve moves every read-out: {before} {after}")
    rows = page.ask("report.graphs.map(g => g.getSelection())")
    expect(len(set(rows)) == 1 and rows[0] > 0, f"all curves show one instant: {rows}")
    value = page.ask("(() => { const c = report.data.channels[0]; return shared.readable(c.values[1][report.row], c.unit); })()")
    expect(value in after[0], f"the read-out is the value there: {value} in {after[0]}")
    page.ask("document.getElementById('cursor').focus()")
    page.press("ArrowRight", 39)
    expect(page.ask("report.row") == rows[0] + 1, "an arrow key moves the cursor by one")


def curves_zoom_together(page):
    opening = page.ask("report.graphs.map(g => g.xAxisRange().join())")
    page.ask("document.querySelector('[data-window=all]').click()")
    whole = page.ask("report.graphs.map(g => g.xAxisRange().join())")
    expect(len(set(opening)) == 1 and len(set(whole)) == 1 and opening[0] != whole[0], f"one window for all: {opening} {whole}")


def canopy_plays(page):
    expect(not page.ask("document.getElementById('stage').hidden"), "the canopy's stage is shown")
    centre(page, "#canopy")
    page.ask("report.canopy.setTime(report.canopy.first)")
    first = page.ask(PIXELS)
    page.ask("report.canopy.setTime(report.canopy.last)")
    last = page.ask(PIXELS)
    for when, seen in (("first", first), ("last", last)):
        expect(0.002 < seen["share"] < 0.9 and seen["colours"] > 20, f"the {when} frame is drawn: {seen}")
    expect(last["share"] > 1.3 * first["share"], f"an open canopy covers more than a closed one: {first} {last}")
    page.ask("document.getElementById('colour').value = 'folds'; document.getElementById('colour').dispatchEvent(new Event('change'))")
    expect(page.ask(PIXELS)["colours"] != last["colours"], "wrinkling is coloured otherwise than stress")
    page.ask("report.canopy.setTime(report.canopy.first); document.getElementById('play').click()")
    expect(page.ask("document.getElementById('play').getAttribute('aria-pressed')") == "true", "playing is announced")
    page.ask("new Promise(done => setTimeout(done, 600))")
    expect(page.ask("report.time > report.canopy.first"), "playing moves the page's time")
    page.ask("document.getElementById('play').click()")
    stopped = page.ask("report.time")
    page.ask("new Promise(done => setTimeout(done, 150))")
    expect(page.ask("report.time") == stopped, "pause stops it")
    page.ask("document.getElementById('canopy').focus()")
    before = page.ask("(report.canopy.draw(), report.canopy.canvas.toDataURL())")
    page.press("ArrowLeft", 37)
    expect(page.ask("(report.canopy.draw(), report.canopy.canvas.toDataURL())") != before, "an arrow key turns the canopy")


def playback_shows_the_opening(page):
    expect(page.ask("report.time > report.canopy.snatch + 0.1"), "the page opens at the peak force")
    page.ask("document.getElementById('pace').value = '0.1'; document.getElementById('play').click()")
    page.ask("new Promise(done => setTimeout(done, 300))")
    begun = page.ask("[report.time, report.canopy.snatch, report.canopy.opened, report.canopy.first]")
    expect(begun[1] <= begun[0] < begun[1] + 0.3 * (begun[2] - begun[1]), f"it plays from the snatch on: {begun}")
    expect(begun[3] < begun[1] - 0.5, f"not from the pack: {begun}")
    page.ask("document.getElementById('pace').value = '1'; document.getElementById('pace').dispatchEvent(new Event('change'))")
    page.ask("new Promise(done => setTimeout(done, 1000 * (report.canopy.opened - report.canopy.snatch) + 1500))")
    ended = page.ask("[report.time, report.canopy.opened, document.getElementById('play').getAttribute('aria-pressed')]")
    expect(ended[0] == ended[1] and ended[2] == "false", f"and stops where the canopy is open: {ended}")


def spikes_do_not_flatten(page):
    largest = page.ask("Math.max(...report.data.channels[0].values.flat().filter(v => v !== null))")
    peak = page.ask("(() => { const e = report.data.events.find(e => e.name === 'peak-force' && e.side === 1); "
                    "return report.data.channels[0].values[1][shared.placeOf(report.data.clock, e.time)]; })()")
    top = page.ask("report.graphs[0].yAxisRange()[1]")
    expect(largest > 1.5 * peak, f"the snatch is a spike here: {largest} {peak}")
    expect(peak < top < 1.5 * peak, f"the plot has room for the peak, not for the spike: {peak} {top} {largest}")
    mark = page.ask("document.querySelector('[data-channel=force] .cut').textContent")
    expect(page.ask(f"shared.readable({largest}, 'N')") in mark, f"the plot says how high the spike is: {mark}")
    page.ask("document.getElementById('full-range').click()")
    expect(page.ask("report.graphs[0].yAxisRange()[1]") >= largest, "all of it is shown on request")
    page.ask("document.getElementById('full-range').click()")
    expect(page.ask("report.graphs[0].yAxisRange()[1]") == top, "and cut off again")


def differences_are_full_minus_rom(page):
    wrong = page.ask("""(() => { const c = report.data.channels[0], g = report.graphs[1]; let worst = 0;
        for (let i = 0; i < g.numRows(); ++i) { const d = g.getValue(i, 1), a = c.values[0][i], b = c.values[1][i];
          if (d !== null) worst = Math.max(worst, Math.abs(d - (b - a))); } return worst; })()""")
    expect(wrong == 0, f"the curve below is full minus rom: {wrong}")


def fits_a_telephone(page):
    small = page.ask("""[...document.querySelectorAll('svg text')].filter(t => t.getClientRects().length && !t.closest('.still'))
        .map(t => parseFloat(getComputedStyle(t).fontSize) * t.getScreenCTM().a).filter(size => size < 11)""")
    expect(small == [], f"words in drawings are 11 px at least: {small[:5]}")
    small = page.ask("""[...document.querySelectorAll('main *')].filter(e => e.getClientRects().length && !e.closest('svg') && e.textContent.trim())
        .map(e => parseFloat(getComputedStyle(e).fontSize)).filter(size => size < 11)""")
    expect(small == [], f"and so are all others: {small[:5]}")
    plain = page.ask("""[...document.querySelectorAll('main .scroll')].filter(e => e.scrollWidth > e.clientWidth + 1)
        .map(e => getComputedStyle(e).backgroundImage).filter(b => !b.includes('gradient')).length""")
    wide = page.ask("[...document.querySelectorAll('main .scroll')].filter(e => e.scrollWidth > e.clientWidth + 1).length")
    expect(wide > 1 and plain == 0, f"what scrolls shows it: {wide} {plain}")
    over = page.ask("""(() => { const a = document.getElementById('legend').getBoundingClientRect(), b = document.getElementById('canopy').getBoundingClientRect();
        return a.top < b.bottom && b.top < a.bottom; })()""")
    expect(not over, "the legend does not lie on the canopy")


def ladder_is_shown(page):
    expect(page.ask("document.querySelectorAll('#ladder tbody tr').length") > 20, "the ladder has its levels")
    centre(page, "#ladder svg")
    size = page.ask("(() => { const r = document.querySelector('#ladder svg').getBoundingClientRect(); return [r.width, r.height]; })()")
    expect(size[0] > 600 and size[1] > 300, f"the plot of the ladder is large enough to be read: {size}")
    seen = page.ask("(() => { const t = document.querySelector('#ladder svg text'); return [getComputedStyle(t).fill, getComputedStyle(t).fontSize]; })()")
    expect(seen == ["rgb(34, 34, 34)", "16px"], f"its words are as dark and as large as the plot has them: {seen}")
    expect(page.ask("[...document.querySelectorAll('nav a')].some(a => a.hash === '#ladder')"), "the navigation leads to it")


def is_accessible(page):
    nameless = page.ask("""[...document.querySelectorAll('button, input, select, canvas, a, [role=img], [role=region]')].filter(e =>
        !e.parentElement.closest('[role=img]') && !(e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || (e.labels && e.labels.length) || e.textContent.trim()))
        .map(e => e.outerHTML.slice(0, 80))""")
    expect(nameless == [], f"everything that can be used has a name: {nameless}")
    levels = page.ask("[...document.querySelectorAll('h1, h2, h3')].map(e => +e.tagName[1])")
    expect(levels[0] == 1 and all(b <= a + 1 for a, b in zip(levels, levels[1:])), f"no level of heading is skipped: {levels}")
    doubled = page.ask("(() => { const ids = [...document.querySelectorAll('[id]')].map(e => e.id); return ids.filter((x, i) => ids.indexOf(x) !== i); })()")
    expect(doubled == [], f"every id is there once: {doubled}")
    expect(page.ask("document.documentElement.scrollWidth <= innerWidth"), "nothing sticks out to the right")
    page.press("Tab", 9)
    expect("skip" in (page.ask("document.activeElement.className") or ""), "the first stop of the keyboard skips the navigation")


def a_run_alone_is_drawn(page, style):
    expect(page.ask("report.data.sides.length") == 1, "one side")
    expect(page.ask("report.graphs.length") == page.ask("report.data.channels.length"), "a plot a history, and none of differences")
    before = readouts(page)
    x, y = centre(page, "[data-channel=force] .curve")
    page.move_mouse(x - 60, y)
    after = readouts(page)
    expect(len(before) >= 3 and all(a != b for a, b in zip(before, after)), f"pointing at one curve moves every read-out: {before} {after}")
    expect(all("difference" not in words for words in after), f"a run alone differs from nothing: {after}")
    expect(page.ask("report.graphs[0].getColors()[0] === shared.colour('%s')" % style), f"the colour is that of {style}")


AXE = None  # source of axe-core, where it is there


def axe_finds_nothing(page, where):
    found = barriers(page, AXE)
    expect(found == [], f"axe-core finds nothing on {where}: {found}")


def made(twinchute, work, name, command, *words, page="report.html"):
    """The address of the page that a command leaves, or brings its ladder to."""
    out = pathlib.Path(work) / name
    done = subprocess.run([twinchute, command, *words, "--quiet", "--out", str(out)], check=False)
    expect(done.returncode in (0, 1), f"{command} ended with {done.returncode}")
    return (out / page).resolve().as_uri()


def main():
    global AXE
    twinchute, scene, work = sys.argv[1:4]
    AXE = axe_core(sys.argv[4:])
    if not program():
        print("skipped: Chromium is not there (Debian: apt-get install chromium), so nothing opened the HTML report")
        return 77
    coarse = ["--set", "full.mesh.gore_columns=1", "--set", "full.mesh.gore_rows=6"]
    whole = made(twinchute, work, "whole", "compare", scene, *coarse)
    # A quarter of a second: a ladder of the whole opening takes longer than all else here.
    short = [scene, *coarse, "--set", "full.mesh.line_elements=4", "--set", "stop.time=1.7"]
    made(twinchute, work, "short", "ladder", *short, "--quick")
    with_ladder = made(twinchute, work, "short", "compare", *short)
    packed = made(twinchute, work, "packed", "compare", str(pathlib.Path(scene).parent / "paper" / "crane-drop.toml"),
                  "--set", "full.mesh.gore_columns=1", "--set", "full.mesh.gore_rows=8")
    rom = made(twinchute, work, "rom", "rom", scene, page="run.html")
    full = made(twinchute, work, "full", "full", *short, page="run.html")
    scenes = pathlib.Path(scene).parent
    series = made(twinchute, work, "series", "rom", str(scenes / "paper" / "altitude.toml"), page="series-rom.html")
    sizing = pathlib.Path(work) / "sizing.html"
    subprocess.run([twinchute, "size", str(scenes / "sizing" / "cargo-drop.toml"), "--quiet", "--report", str(sizing)], check=True)
    sizing = sizing.resolve().as_uri()
    drops = scenes.parent / "calibration"
    calibration = made(twinchute, work, "calibration", "calibrate", str(drops / "c9-drop.toml"), "--to", str(drops / "c9-drop-a.toml"))
    with Chromium(300) as page:
        for url, style in ((rom, "candidate"), (full, "reference")):
            page.open(url, width=1000, height=800)
            is_accessible(page)
            axe_finds_nothing(page, f"the page of a run, {style}")
            a_run_alone_is_drawn(page, style)
        canopy_plays(page)
        page.open(packed, width=1000, height=800)
        playback_shows_the_opening(page)
        spikes_do_not_flatten(page)
        differences_are_full_minus_rom(page)
        page.open(packed, width=400, height=700, scheme="dark")
        fits_a_telephone(page)
        page.open(series, width=1000, height=800)
        axe_finds_nothing(page, "the page of a series")
        page.open(sizing, width=1000, height=800)
        axe_finds_nothing(page, "the page of a sizing")
        page.open(calibration, width=1000, height=800, scheme="dark")
        axe_finds_nothing(page, "the page of a calibration in the dark")
        page.open(whole, width=1000, height=800)
        is_accessible(page)
        axe_finds_nothing(page, "a comparison")
        cursor_is_linked(page)
        curves_zoom_together(page)
        canopy_plays(page)
        page.open(whole, width=360, height=700, scheme="dark")
        expect(page.ask("document.documentElement.scrollWidth <= innerWidth"), "nothing sticks out of a telephone")
        light = page.ask("getComputedStyle(document.body).backgroundColor")
        expect(light != "rgb(255, 255, 255)", f"dark is dark: {light}")
        page.open(with_ladder, width=360, height=700, scheme="dark")
        is_accessible(page)
        axe_finds_nothing(page, "a comparison in the dark, with a ladder")
        ladder_is_shown(page)
        expect(page.log == [], f"the page logs no error and no warning: {page.log}")
        expect(set(page.requests) == {whole, with_ladder, packed, rom, full, series, sizing, calibration}, f"nothing is fetched: {page.requests}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
