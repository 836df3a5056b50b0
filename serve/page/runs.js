// Runs on the server: a full run whose rows are drawn as they come, a comparison. Their ids outlive a reload.
"use strict";
serve.runs = (function () {
    const interval = 300;  // [ms] between two questions
    const shape_interval = 600;  // [ms] between two for the shapes, which come whole
    const titles = {full: "Full model", compare: "Comparison", calibrate: "Calibration", campaign: "Campaign"};
    const files = {full: "summary.json", compare: "summary.json", calibrate: "calibration.json", campaign: "campaign.json"};
    const isStudy = (kind) => kind === "calibrate" || kind === "campaign";
    const box = document.getElementById("runs");
    const runs = {};  // kind: {id, asked: {text, set}, info, history, shape, timer}
    let shape = null;  // that is shown

    const same = (run) => Boolean(run && run.asked && JSON.stringify(run.asked) === JSON.stringify(serve.request()));

    function keep() {
        const hash = Object.keys(titles).filter((kind) => runs[kind]).map((kind) => kind + "=" + runs[kind].id).join("&");
        history.replaceState(null, "", location.pathname + location.search + (hash ? "#" + hash : ""));
        serve.remember();
    }

    const isOver = (run) => run.info && run.info.state !== "running";

    function words(run) {
        const info = run.info;
        if (!info) return "starting";
        if (info.state === "running") {
            const share = serve.isNumber(info.share) ? Math.round(100 * info.share) + " %" : "";
            return ["running", info.stage, serve.isNumber(info.time) ? shared.readable(info.time, "s") : "", share].filter(Boolean).join(", ");
        }
        const error = info.error ? ": " + (info.error.message || info.error) : "";
        const status = info.summary && info.summary.status && info.summary.status.code !== "completed" ? ", " + info.summary.status.code.replaceAll("_", " ") : "";
        return info.state + status + error;
    }

    const address = (run, what) => "/api/runs/" + run.id + "/" + what + "?token=" + encodeURIComponent(serve.token);
    const reportLink = (run, text) => serve.element("a", {href: address(run, "report"), target: "_blank", rel: "noopener"}, text);
    const download = (run, what, name) => serve.element("a", {href: address(run, what), download: name}, name);

    function panel(kind) {
        const run = runs[kind];
        if (!run) { if (box.querySelector("[data-run=" + kind + "]")) box.querySelector("[data-run=" + kind + "]").remove(); return; }
        if (!run.box || !run.box.isConnected) {
            run.bar = serve.element("progress", {max: 1, "aria-label": titles[kind] + ", share done"});
            run.says = serve.element("span", {className: "says", role: "status"});
            run.cancel = serve.element("button", {type: "button"}, "Cancel");
            run.cancel.addEventListener("click", () => serve.runs.cancel(kind));
            run.dismiss = serve.element("button", {type: "button"}, "Dismiss");
            run.dismiss.addEventListener("click", () => { drop(kind); document.getElementById("run-" + kind).focus(); });
            run.links = serve.element("span", {className: "links"});
            run.box = serve.element("div", {className: "run"}, serve.element("strong", {}, titles[kind]), run.bar, run.says, run.links, run.cancel, run.dismiss);
            run.box.dataset.run = kind;
            box.append(run.box);
        }
        const over = isOver(run), good = run.info && run.info.state === "done";
        run.box.dataset.state = run.info ? run.info.state : "running";
        run.bar.hidden = over;
        if (run.info && serve.isNumber(run.info.share)) run.bar.value = Math.min(1, Math.max(0, run.info.share)); else run.bar.removeAttribute("value");
        const text = words(run) + (same(run) ? "" : " (of other values than those shown)");
        if (run.says.textContent !== text) run.says.textContent = text;
        run.cancel.hidden = over;
        run.dismiss.hidden = !over;
        if (good && !run.links.children.length) {
            run.links.append(reportLink(run, "Report"), " ", download(run, "summary", files[kind]));
            if (!isStudy(kind)) run.links.append(" ", download(run, "history.csv", "history.csv"));
        }
    }

    function drop(kind) {
        if (runs[kind]) {
            clearTimeout(runs[kind].timer);
            if (runs[kind].box) runs[kind].box.remove();
        }
        delete runs[kind];
        keep();
        serve.showRuns();
    }

    async function poll(kind) {
        const run = runs[kind], known = run.history ? run.history.time.length : 0;
        const answer = await serve.ask("GET", "runs/" + run.id + "?from=" + known);
        if (runs[kind] !== run) return;
        if (answer.status === 404) {
            drop(kind);
            serve.say(titles[kind] + ": the server knows this run no more");
            return;
        }
        if (answer.status === 200) {
            run.info = answer.data;
            const rows = run.info.rows;
            if (rows.time.length && !run.whole) {
                const before = run.history || {time: [], force: [], speed: []};
                run.history = {};
                for (const channel of Object.keys(before)) run.history[channel] = before[channel].concat(rows[channel]);
            }
            const now = performance.now();
            if (isStudy(kind)) run.whole = true;
            else if (run.info.state === "done" ? !run.whole : now - (run.shaped || 0) > shape_interval) {
                run.shaped = now;
                const bytes = await serve.bytes("runs/" + run.id + "/frames");
                if (runs[kind] !== run) return;
                if (bytes && bytes.length) run.shape = readFrames(bytes);
            }
            if (run.info.state === "done" && !run.whole) {
                const found = await serve.ask("GET", "runs/" + run.id + "/history");
                if (runs[kind] !== run) return;
                if (found.status === 200) run.history = found.data.history || found.data;
                run.whole = true;
            }
        } else {
            serve.say(serve.words(answer));
        }
        serve.showRuns();
        if (!isOver(run)) run.timer = setTimeout(() => poll(kind), interval);
    }

    function follow(kind, id, asked) {
        if (runs[kind]) {
            clearTimeout(runs[kind].timer);
            if (runs[kind].box) runs[kind].box.remove();
        }
        runs[kind] = {id: id, asked: asked};
        keep();
        serve.showRuns();
        poll(kind);
    }

    return {
        runs: runs,
        same: same,
        reportLink: reportLink,
        show() {
            // The run that goes on, else the full one.
            const shown = [runs.full, runs.compare].filter((run) => run && run.shape).sort((a, b) => Number(isOver(a)) - Number(isOver(b)))[0];
            if ((shown ? shown.shape : null) !== shape) serve.shape.set(shape = shown ? shown.shape : null);
            for (const kind of Object.keys(titles)) {
                panel(kind);
                document.getElementById("run-" + kind).disabled = Boolean(runs[kind] && !isOver(runs[kind]));
            }
        },
        refuse(words) { serve.refused({data: {error: words}}); },
        // `more`: of a study, its files.
        async start(kind, more) {
            const asked = serve.request(), button = document.getElementById("run-" + kind);
            button.disabled = true;
            serve.refused(null);
            const answer = await serve.ask("POST", kind, Object.assign({}, asked, more));
            button.disabled = false;
            if (answer.status === 202) follow(kind, answer.data.id, asked);
            else serve.refused(answer);
        },
        async cancel(kind) {
            const run = runs[kind];
            run.cancel.disabled = true;
            const answer = await serve.ask("DELETE", "runs/" + run.id);
            if (answer.status >= 400 || answer.status === 0) serve.say(serve.words(answer));
            run.cancel.disabled = false;
            clearTimeout(run.timer);
            poll(kind);
        },
        // Requests to remember, and the runs of the address or of the memory again.
        asked() { return Object.fromEntries(Object.entries(runs).map(([kind, run]) => [run.id, run.asked])); },
        find(remembered) {
            const named = new URLSearchParams(location.hash.slice(1));
            for (const kind of Object.keys(titles)) {
                const id = named.get(kind);
                if (id && /^[\w-]+$/.test(id)) follow(kind, id, remembered[id] || null);
            }
        },
    };
})();
