// The page of `twinchute serve`: what is edited, what was before, and who is told of it.
"use strict";
(function () {
    const get = (id) => document.getElementById(id);
    const most_undone = 200;
    let file = "", undone = [], past = [], gesture = null, waiting = false, asking = false, changed = 0;
    let result = null, before = null, kept = null, opened = "";

    serve.state = {text: "", set: {}};
    serve.request = () => ({
        text: serve.state.text,
        set: Object.entries(serve.state.set).map(([path, words]) => path + "=" + serve.knobs.toml(path, words)),
    });

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
            sessionStorage.setItem(memory, JSON.stringify({state: serve.state, added: [...serve.knobs.added], asked: serve.runs.asked(), kept: kept}));
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
        if (waiting) return;
        waiting = true;
        requestAnimationFrame(() => { waiting = false; send(); });
    }
    async function send() {
        if (asking) return;
        asking = true;
        const since = changed;
        if (text_known !== serve.state.text) await readScene();
        const asked = serve.request(), started = performance.now();
        const answer = await serve.ask("POST", "rom", asked);
        asking = false;
        if (changed !== since && !waiting) ask_again();
        take(answer, performance.now() - started, since);
    }
    const ask_again = () => { waiting = true; requestAnimationFrame(() => { waiting = false; send(); }); };

    // The values of the text alone: what fields go back to.
    async function readScene() {
        const text = serve.state.text, answer = await serve.ask("POST", "rom", {text: text, set: []});
        text_known = text;
        if (answer.status === 200) serve.knobs.setOwn(answer.data.summary.inputs);
    }

    let last_error = null;
    function showError() {
        serve.knobs.clearErrors();
        const above = get("scene-error");
        above.hidden = true;
        document.body.classList.toggle("stale", Boolean(last_error && result));
        if (!last_error) return;
        const error = last_error.data && last_error.data.error, words = serve.words(last_error);
        if (!get("values").hidden && error && error.key && serve.knobs.showError(error.key, words)) return;
        above.textContent = words;
        above.hidden = false;
    }
    serve.refused = (answer) => {
        if (answer.status === 422) { last_error = answer; showError(); }
        serve.say(serve.words(answer));
    };

    function take(answer, took, since) {
        if (answer.status !== 200) {
            last_error = answer;
            showError();
            serve.say(result ? "not run: curves and figures are those of the last values that ran" : "not run");
            return;
        }
        last_error = null;
        result = answer.data;
        const summary = result.summary;
        get("scene-name").textContent = summary.scene.name;
        document.title = summary.scene.name + " - twinchute";
        serve.knobs.setInputs(summary.inputs);
        serve.knobs.show();
        showError();
        draw();
        const cost = summary.cost && serve.isNumber(summary.cost.wall_s) ? "run in " + serve.number(1000 * summary.cost.wall_s, 2) + " ms, " : "";
        serve.say("reduced-order model: " + summary.status.code.replaceAll("_", " ") + ", " + cost + "answered in " + serve.number(took, 2) + " ms");
        document.dispatchEvent(new CustomEvent("redrawn", {detail: {since: since, took: performance.now() - since}}));
    }

    // The full model's values are those shown where its request was the same, or its record says so.
    const values = (summary) => JSON.stringify(Object.entries(summary.inputs).map(([key, input]) => [key, input.value]).sort());
    function fullRun() {
        const run = serve.runs.runs.full;
        if (!run || !run.info) return null;
        const summary = run.info.summary, is_same = serve.runs.same(run) || Boolean(!run.asked && summary && result && values(summary) === values(result.summary));
        return {summary: run.info.state === "done" ? summary : null, same: is_same, history: run.history};
    }

    function draw() {
        if (!result) return;
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
        serve.results.showAlerts(result.summary, result.cases);
        get("keep").disabled = false;
    }
    serve.showRuns = () => {
        serve.runs.show();
        const run = serve.runs.runs.compare, done = run && run.info && run.info.state === "done" && run.info.gap;
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
        const inputs = serve.knobs.inputs(), tables = new Map(), parachutes = [];
        const named = [];  // in the order of the scene
        for (const path of Object.keys(inputs)) {
            const match = /^parachute\.([^.]+)\.name$/.exec(path);
            if (match) named.push(match[1]);
        }
        const put = (to, path, words) => to.set(path, serve.knobs.toml(path, words));
        const lists = new Set();
        for (const path of paths) {
            const parts = path.split("."), at = parts.findIndex((part, i) => /^\d+$/.test(part) && i > 1);
            const index = parts[0] === "parachute" && named.includes(parts[1]) ? named.indexOf(parts[1]) : parts[0] === "parachute" && /^\d+$/.test(parts[1]) ? Number(parts[1]) - 1 : 0;
            if (at > 0) { lists.add(JSON.stringify([index, parts.slice(0, at).join(".")])); continue; }
            if (parts[0] === "parachute") {
                while (parachutes.length <= index) parachutes.push([]);
                const below = named.includes(parts[1]) || /^\d+$/.test(parts[1]) ? parts.slice(2) : parts.slice(1);
                parachutes[index].push(below.join(".") + " = " + serve.knobs.toml(path, serve.state.set[path]));
            } else if (parts.length === 1) {
                put(tables, path, serve.state.set[path]);
            } else {
                put(tables, path, serve.state.set[path]);
            }
        }
        // A list is written whole: its members are not laid over those of the base.
        for (const json of lists) {
            const [index, head] = JSON.parse(json), members = new Map();
            for (const [path, input] of Object.entries(inputs)) {
                if (!path.startsWith(head + ".") || (input.origin !== "given" && serve.state.set[path] === undefined)) continue;
                const [number, ...below] = path.slice(head.length + 1).split("."), row = serve.knobs.rowOf(path);
                const si = typeof input.value === "number" ? String(input.value) + (row.unit && row.unit !== "1" ? " " + row.unit : "") : String(input.value);
                if (!members.has(number)) members.set(number, []);
                members.get(number).push((below.length ? below.join(".") + " = " : "") + serve.knobs.toml(path, serve.state.set[path] || si));
            }
            const parts = head.split("."), below = parts.slice(named.includes(parts[1]) ? 2 : 1).join(".");
            while (parachutes.length <= index) parachutes.push([]);
            parachutes[index].push(below + " = [" + [...members.values()].map((one) => (one.length > 1 || one[0].includes(" = ") ? "{ " + one.join(", ") + " }" : one[0])).join(", ") + "]");
        }
        let text = [...tables].map(([path, value]) => path + " = " + value + "\n").join("");
        for (const keys of parachutes) text += "\n[[parachute]]\n" + keys.map((line) => line + "\n").join("");
        return text;
    }
    function sceneOnTop(base) {
        const name = get("scene-name").textContent;
        return "# Saved by twinchute serve: the values changed there, on top of " + base + ".\n" +
            "base = " + JSON.stringify(base) + "\nname = " + JSON.stringify(name + ", changed") + "\n" + nested(Object.keys(serve.state.set));
    }
    async function write(name, text) {
        const answer = await serve.ask("POST", "save", Object.assign({name: name, text: text}, get("overwrite").checked && !get("save-over").hidden ? {overwrite: true} : {}));
        if (answer.status >= 200 && answer.status < 300) return null;
        return answer;
    }
    get("save").addEventListener("submit", async (event) => {
        event.preventDefault();
        const wanted = get("save-name").value.trim(), name = wanted.endsWith(".toml") ? wanted : wanted + ".toml";
        const message = get("save-message"), edited = serve.state.text !== opened, changes = Object.keys(serve.state.set).length;
        const say = (words, bad) => { message.textContent = words; message.classList.toggle("good", !bad); };
        if (last_error) { say("Not saved: these values do not run", true); return; }
        const stem = name.replace(/\.toml$/, ""), texts = [];
        if (changes && edited) texts.push([stem + "-text.toml", serve.state.text], [name, sceneOnTop(stem + "-text.toml")]);
        else if (changes) texts.push([name, sceneOnTop(file)]);
        else texts.push([name, serve.state.text]);
        for (const [to, text] of texts) {
            const refused = await write(to, text);
            if (!refused) continue;
            get("save-over").hidden = !(refused.status === 409 && to === file && !changes);
            say(serve.words(refused), true);
            return;
        }
        get("save-over").hidden = true;
        get("overwrite").checked = false;
        say("Saved: " + texts.map(([to]) => to).join(" and "), false);
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
    for (const id of ["keep", "run-full", "run-compare"]) get(id).disabled = true;

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
        for (const path of memory.added || []) serve.knobs.added.add(path);
        get("scene-text").value = serve.state.text;
        get("file-name").textContent = file;
        get("save-name").value = file.replace(/\.toml$/, "") + "-changed.toml";
        past = [{text: opened, set: {}}];
        serve.commit();
        await readScene();
        await send();
        for (const id of ["run-full", "run-compare"]) get(id).disabled = false;
        serve.runs.find(memory.asked || {});
        if (kept) showKept();
        history_buttons();
    })();
})();
