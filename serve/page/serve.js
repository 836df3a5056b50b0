// The page of `twinchute serve`: what is edited, what was before, and who is told of it.
"use strict";
(function () {
    const get = (id) => document.getElementById(id);
    const most_undone = 200;
    let file = "", undone = [], past = [], gesture = null, waiting = false, asking = false, changed = 0;
    let result = null, before = null, kept = null, opened = "", chosen = "";

    serve.state = {text: "", set: {}};
    const request = (set) => Object.assign({text: serve.state.text, set: set}, chosen ? {case: chosen} : {});
    serve.request = () => request(Object.entries(serve.state.set).map(([path, words]) => path + "=" + serve.knobs.toml(path, words)));

    // Announced once what changes comes to rest: nobody wants each position of a slider read out.
    let saying;
    serve.say = (words) => {
        clearTimeout(saying);
        saying = setTimeout(() => { get("status").textContent = words; }, 400);
    };

    // -- what is kept over a reload
    const memory = "twinchute " + serve.token;
    serve.remember = () => {
        try {
            sessionStorage.setItem(memory, JSON.stringify({state: serve.state, added: [...serve.knobs.added], asked: serve.runs.asked(), kept: kept, chosen: chosen}));
        } catch (full) { /* no memory: a reload begins anew */ }
    };
    function remembered() {
        try { return JSON.parse(sessionStorage.getItem(memory)) || {}; } catch (none) { return {}; }
    }

    // -- changes, back and forth
    const copy = () => ({text: serve.state.text, set: Object.assign({}, serve.state.set)});
    function history_buttons() {
        get("undo").disabled = past.length < 2 && !gesture;
        get("redo").disabled = !undone.length;
    }
    function begin(what) {
        if (gesture === what) return;
        serve.commit();
        gesture = what;
        before = result;
    }
    serve.change = (path, words) => {
        begin(path);
        if (words.trim() === "") delete serve.state.set[path]; else serve.state.set[path] = words.trim();
        ask();
    };
    serve.commit = () => {
        gesture = null;
        const now = JSON.stringify(copy());
        if (past.length && JSON.stringify(past[past.length - 1]) === now) return;
        past.push(JSON.parse(now));
        if (past.length > most_undone) past.shift();
        undone = [];
        history_buttons();
        serve.remember();
    };
    function go(state) {
        const other_text = state.text !== serve.state.text;
        before = result;
        serve.state = {text: state.text, set: Object.assign({}, state.set)};
        get("scene-text").value = state.text;
        for (const knob of serve.knobs.knobs.values()) knob.slide = null;
        serve.knobs.show(true);
        history_buttons();
        serve.remember();
        ask(other_text);
    }
    function undo() {
        serve.commit();
        if (past.length < 2) return;
        undone.push(past.pop());
        go(past[past.length - 1]);
    }
    function redo() {
        if (!undone.length) return;
        past.push(undone.pop());
        go(past[past.length - 1]);
    }

    // -- the run of the reduced-order model: one request at a time, and then the newest values
    let text_known = null;
    function ask() {
        changed = performance.now();
        serve.refused(null);
        if (waiting) return;
        waiting = true;
        requestAnimationFrame(() => { waiting = false; send(); });
    }
    async function send() {
        if (asking) return;
        asking = true;
        const since = changed;
        if (text_known !== serve.state.text) await readScene();
        const asked = serve.request(), set = copy().set, started = performance.now();
        const answer = await serve.ask("POST", "rom", asked);
        asking = false;
        if (answer.status === 400 && chosen) {  // the text has lost this case
            chosen = "";
            ask();
            return;
        }
        if (changed !== since && !waiting) ask_again();
        take(answer, performance.now() - started, since, set);
    }
    const ask_again = () => { waiting = true; requestAnimationFrame(() => { waiting = false; send(); }); };

    serve.idle = () => !waiting && !asking && result !== null;

    // The values of the text alone: what fields go back to.
    async function readScene() {
        const text = serve.state.text, answer = await serve.ask("POST", "rom", request([]));
        text_known = text;
        if (answer.status === 200) serve.knobs.setOwn(answer.data.summary.inputs);
    }

    let last_error = null;
    function showError() {
        serve.knobs.clearErrors();
        const above = get("scene-error");
        above.hidden = true;
        get("stale").hidden = !(last_error && result);
        document.body.classList.toggle("stale", !get("stale").hidden);
        if (!last_error) return;
        const error = last_error.data && last_error.data.error, words = serve.words(last_error);
        if (!get("values").hidden && error && error.key && serve.knobs.showError(error.key, words)) return;
        above.textContent = words;
        above.hidden = false;
    }
    // A run that was not started; the words stand until something changes.
    serve.refused = (answer) => {
        get("run-error").textContent = answer ? serve.words(answer) : "";
        get("run-error").hidden = !answer;
    };

    function take(answer, took, since, set) {
        if (answer.status !== 200) {
            last_error = answer;
            showError();
            serve.say("not run");
            return;
        }
        last_error = null;
        result = answer.data;
        const summary = result.summary;
        get("scene-name").textContent = summary.scene.name;
        document.title = summary.scene.name + " - twinchute";
        serve.knobs.setInputs(summary.inputs, set);
        serve.knobs.show();
        showError();
        showCases(result.cases || []);
        draw();
        const cost = summary.cost && serve.isNumber(summary.cost.wall_s) ? "run in " + shared.number(1000 * summary.cost.wall_s, 2) + " ms, " : "";
        serve.say("reduced-order model: " + summary.status.code.replaceAll("_", " ") + ", " + cost + "answered in " + shared.number(took, 2) + " ms");
        document.dispatchEvent(new CustomEvent("redrawn", {detail: {since: since, took: performance.now() - since}}));
    }

    // A series has one case shown at a time; the text may lose the chosen one.
    function showCases(cases) {
        const select = get("case"), known = [...select.options].map((option) => option.value);
        get("series").hidden = cases.length < 2;
        if (JSON.stringify(known) === JSON.stringify(cases)) return;
        select.replaceChildren(...cases.map((name) => serve.element("option", {}, name)));
        select.value = chosen || cases[0] || "";
    }
    get("case").addEventListener("change", () => {
        serve.commit();
        before = null;
        chosen = get("case").value;
        text_known = null;
        ask();
    });

    // The full model's values are those shown where its request was the same, or its record says so.
    const values = (summary) => JSON.stringify(Object.entries(summary.inputs).map(([key, input]) => [key, input.value]).sort());
    function fullRun() {
        const run = serve.runs.runs.full;
        if (!run || !run.info) return null;
        const summary = run.info.summary, is_same = serve.runs.same(run) || Boolean(!run.asked && summary && result && values(summary) === values(result.summary));
        return {summary: run.info.state === "done" ? summary : null, same: is_same, history: run.history};
    }

    // -- sizing: an answer of the server, of the values that it was asked with
    let sizing = null;
    function useSized(one) {
        serve.commit();
        go({text: one.scene_text, set: {}});
        serve.commit();
        serve.say("The text is now the sized scene; Undo goes back");
    }
    get("run-size").addEventListener("click", async () => {
        const asked = serve.request();
        get("run-size").disabled = true;
        serve.refused(null);
        const answer = await serve.ask("POST", "size", asked);
        get("run-size").disabled = false;
        if (answer.status !== 200) { serve.refused(answer); return; }
        sizing = {data: answer.data, asked: JSON.stringify(asked)};
        serve.results.showSizing(sizing.data, useSized);
        draw();
        serve.say(answer.data.meets ? "Sized: the limits are met" : "Sized: no value meets the limits");
    });

    // -- calibration: its values become those of the form
    function useFound(found) {
        serve.commit();
        before = result;
        for (const [key, one] of found) {
            serve.state.set[key] = String(Number(one.estimate.toPrecision(6))) + (one.unit && one.unit !== "1" ? " " + one.unit : "");
            serve.knobs.added.add(key);
        }
        go(copy());
        serve.commit();
        serve.say("The values found stand in the form; Undo goes back");
    }
    async function saveCalibrated(text) {
        const name = get("save-name").value.replace(/(-changed)?\.toml$/, "") + "-calibrated.toml", answer = await write(name, text);
        return answer.status === 200 ? "Saved: " + name : serve.words(answer);
    }

    function draw() {
        if (!result) return;
        for (const [kind, id] of [["calibrate", "calibration-stale"], ["campaign", "campaign-stale"]])
            get(id).hidden = !serve.runs.runs[kind] || serve.runs.same(serve.runs.runs[kind]);
        const points = serve.studies.measured();
        serve.curves.set("measured", "measured", points);
        get("run-size").hidden = !Object.keys(result.summary.inputs).some((key) => key.startsWith("size."));
        get("sizing-stale").hidden = !sizing || sizing.asked === JSON.stringify(serve.request());
        const full = fullRun(), differs = before && before !== result && JSON.stringify(before.history) !== JSON.stringify(result.history);
        serve.curves.set("rom", "rom", result.history);
        serve.curves.set("before", "rom, before", differs ? before.history : null);
        serve.curves.set("kept", kept ? kept.name + " (kept)" : "", kept && kept.history);
        serve.curves.set("full", full && !full.same ? "full, of other values" : "full", full && full.history);
        serve.curves.draw();
        serve.results.showFigures({
            now: result.summary, before: differs ? before.summary : null, kept: kept && kept.summary, keptName: kept && kept.name + " (kept)",
            full: full && full.summary, fullIsSame: Boolean(full && full.same),
        }, "SI units. rom: the reduced-order model" + (differs ? "; before: ahead of the last change" : "") + ".");
        serve.results.showLimits(result.summary.inputs, result.summary, full && full.same ? full.summary : null);
        serve.results.showFormulas(result.summary);
        serve.results.showAlerts(result.summary);
        get("keep").disabled = false;
    }
    serve.showRuns = () => {
        serve.runs.show();
        const run = serve.runs.runs.compare, done = run && run.info && run.info.state === "done" && run.info.gap;
        serve.studies.show(serve.runs.runs, {use: useFound, save: saveCalibrated});
        serve.results.showGap(done || null, done ? serve.runs.reportLink(run, "Report of the comparison") : null, Boolean(done) && !serve.runs.same(run));
        draw();
    };

    // -- a scene kept beside
    function keptName() {
        const changes = Object.entries(serve.state.set).map(([path, words]) => path.split(".").pop().replaceAll("_", " ") + " " + words);
        return changes.length ? changes.slice(0, 2).join(", ") + (changes.length > 2 ? ", ..." : "") : "as opened";
    }
    function showKept() {
        get("kept").hidden = !kept;
        if (kept && document.activeElement !== get("kept-name")) get("kept-name").value = kept.name;
        serve.remember();
        draw();
    }
    get("keep").addEventListener("click", () => {
        if (!result || last_error) { serve.say("Nothing to keep: these values have not run"); return; }
        kept = {name: keptName(), state: copy(), summary: {metrics: result.summary.metrics}, history: result.history};
        showKept();
        serve.say("Kept: " + kept.name);
    });
    get("kept-name").addEventListener("input", () => { kept.name = get("kept-name").value || "kept"; showKept(); });
    get("kept-use").addEventListener("click", () => { serve.commit(); go(kept.state); serve.commit(); });
    get("kept-remove").addEventListener("click", () => { kept = null; showKept(); get("keep").focus(); });

    // -- saving: the text as it stands, or a scene based on the opened file with the changed values
    function nested(paths) {
        const inputs = serve.knobs.inputs(), names = serve.knobs.names(), lists = new Set();
        const tables = [], parachutes = [];
        // Place of the parachute that a key belongs to, and what follows its name.
        const split = (path) => {
            const parts = path.split("."), place = names.indexOf(parts[1]);
            return place < 0 ? [0, parts.slice(1)] : [place, parts.slice(2)];
        };
        const entry = (place, line) => {
            while (parachutes.length <= place) parachutes.push([]);
            parachutes[place].push(line);
        };
        for (const path of paths) {
            const value = serve.knobs.toml(path, serve.state.set[path]);
            if (!path.startsWith("parachute.")) { tables.push(path + " = " + value); continue; }
            const [place, below] = split(path), member = below.findIndex((part) => /^\d+$/.test(part));
            if (member < 0) entry(place, below.join(".") + " = " + value);
            else lists.add(path.split(".").slice(0, path.split(".").length - below.length + member).join("."));
        }
        // A list is written whole, as the run had it: one of a scene replaces that of its base.
        for (const head of lists) {
            const members = new Map();
            for (const [path, input] of Object.entries(inputs)) {
                if (!path.startsWith(head + ".") || input.origin !== "given") continue;
                const [number, ...below] = path.slice(head.length + 1).split("."), mine = serve.state.set[path];
                const words = mine !== undefined ? mine : serve.knobs.written(path, input);
                if (!members.has(number)) members.set(number, []);
                members.get(number).push((below.length ? below.join(".") + " = " : "") + serve.knobs.toml(path, words));
            }
            const [place, below] = split(head), of_tables = serve.knobs.isListOfTables(head);
            entry(place, below.join(".") + " = [" + [...members.values()].map((one) => (of_tables ? "{ " + one.join(", ") + " }" : one[0])).join(", ") + "]");
        }
        return tables.map((line) => line + "\n").join("") +
            parachutes.map((lines) => "\n[[parachute]]\n" + lines.map((line) => line + "\n").join("")).join("");
    }
    function sceneOnTop(base) {
        const name = get("scene-name").textContent;
        return "# Saved by twinchute serve: the values changed there, on top of " + base + ".\n" +
            "base = " + JSON.stringify(base) + "\nname = " + JSON.stringify(name + ", changed") + "\n" + nested(Object.keys(serve.state.set));
    }
    async function write(name, text) {
        const answer = await serve.ask("POST", "save", Object.assign({name: name, text: text}, get("overwrite").checked && !get("save-over").hidden ? {overwrite: true} : {}));
        return answer;
    }
    const folder = (path) => path.slice(0, path.lastIndexOf("/") + 1);
    get("save").addEventListener("submit", async (event) => {
        event.preventDefault();
        const wanted = get("save-name").value.trim(), name = wanted.endsWith(".toml") ? wanted : wanted + ".toml";
        const message = get("save-message"), edited = serve.state.text !== opened, changes = Object.keys(serve.state.set).length;
        const say = (words, bad) => { message.textContent = words; message.classList.toggle("good", !bad); };
        if (last_error) { say("Not saved: these values do not run", true); return; }
        const stem = name.replace(/\.toml$/, ""), saved = [];
        let elsewhere = false;
        const put = async (to, text) => {
            const answer = await write(to, text);
            if (answer.status === 200) {
                saved.push(to);
                elsewhere = folder(answer.data.file) !== folder(file);
                return answer.data.file;
            }
            get("save-over").hidden = !(answer.status === 409 && to === file.split("/").pop() && !changes);
            say(serve.words(answer), true);
            return null;
        };
        if (changes && result.cases && result.cases.length > 1) {
            say("Not saved: values of a series differ by case, change them in its text", true);
            return;
        }
        // The opened file is the base where it lies beside what is saved; otherwise its text is saved too.
        if (!changes) {
            if (await put(name, serve.state.text) === null) return;
            if (!elsewhere && name === file.split("/").pop()) opened = serve.state.text;
        } else {
            const beside = edited ? null : await put(name, sceneOnTop(file.split("/").pop()));
            if (!edited && beside === null) return;
            if (beside === null || elsewhere || !file.endsWith(".toml")) {
                saved.length = 0;
                const base = stem + "-text.toml";
                if (await put(base, serve.state.text) === null || await put(name, sceneOnTop(base)) === null) return;
            }
        }
        get("save-over").hidden = true;
        get("overwrite").checked = false;
        say("Saved: " + saved.join(" and ") + (elsewhere ? ". Files that the text names are looked for there too." : ""), false);
    });

    // -- tabs
    function tab(name, focus) {
        for (const one of ["values", "text"]) {
            get(one).hidden = one !== name;
            get("tab-" + one).setAttribute("aria-selected", String(one === name));
            get("tab-" + one).tabIndex = one === name ? 0 : -1;
        }
        if (focus) get("tab-" + name).focus();
        showError();
    }
    for (const name of ["values", "text"]) {
        get("tab-" + name).addEventListener("click", () => tab(name));
        get("tab-" + name).addEventListener("keydown", (event) => {
            if (event.key === "ArrowLeft" || event.key === "ArrowRight") tab(name === "values" ? "text" : "values", true);
        });
    }
    get("scene-text").addEventListener("input", () => {
        begin("the text");
        serve.state.text = get("scene-text").value;
        ask();
    });
    get("scene-text").addEventListener("change", () => serve.commit());

    get("undo").addEventListener("click", undo);
    get("redo").addEventListener("click", redo);
    document.addEventListener("keydown", (event) => {
        if (!(event.ctrlKey || event.metaKey) || event.altKey || event.target === get("scene-text")) return;
        const key = event.key.toLowerCase();
        if (key === "z" && !event.shiftKey) undo();
        else if ((key === "z" && event.shiftKey) || key === "y") redo();
        else return;
        event.preventDefault();
    });
    get("run-full").addEventListener("click", () => serve.runs.start("full"));
    get("run-compare").addEventListener("click", () => serve.runs.start("compare"));
    addEventListener("pagehide", () => serve.remember());
    for (const id of ["keep", "run-full", "run-compare", "run-calibrate", "run-campaign"]) get(id).disabled = true;

    (async function () {
        const [keys, scene] = await Promise.all([serve.ask("GET", "keys"), serve.ask("GET", "scene")]);
        for (const answer of [keys, scene])
            if (answer.status !== 200) {
                last_error = answer;
                showError();
                return;
            }
        serve.knobs.setRows(keys.data);
        file = scene.data.file;
        opened = scene.data.text;
        const memory = remembered();
        serve.state = memory.state || {text: opened, set: {}};
        kept = memory.kept || null;
        chosen = memory.chosen || "";
        for (const path of memory.added || []) serve.knobs.added.add(path);
        get("scene-text").value = serve.state.text;
        get("file-name").textContent = file;
        get("save-name").value = file.split("/").pop().replace(/\.toml$/, "").replace(/^\W+$/, "scene") + "-changed.toml";
        past = [{text: opened, set: {}}];
        serve.commit();
        await readScene();
        await send();
        for (const id of ["run-full", "run-compare", "run-calibrate", "run-campaign"]) get(id).disabled = false;
        serve.runs.find(memory.asked || {});
        if (kept) showKept();
        history_buttons();
    })();
})();
