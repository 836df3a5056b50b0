// Studies of the scene: tests and campaigns come as files, dropped on the page or chosen; what was found is shown.
"use strict";
serve.studies = (function () {
    const get = (id) => document.getElementById(id);
    const is_campaign = /^\s*\[\s*campaign\s*\]/m;
    let calibration = null, campaign = null;  // that are shown

    const interval = (pair, unit, scale) => pair.map((value) => shared.readable(value === null ? null : value * (scale || 1), "")).join(" to ") + (unit ? "\u00a0" + unit : "");
    const unit_of = (unit) => (unit && unit !== "1" ? unit : "");
    const table = (caption, head, rows) => serve.element("div", {className: "scroll", role: "region", "aria-label": caption, tabIndex: 0},
        serve.element("table", {}, serve.element("caption", {}, caption), head, serve.element("tbody", {}, ...rows)));
    const row = (name, ...cells) => serve.element("tr", {}, serve.element("th", {scope: "row"}, name), ...cells);
    const alert = (words) => serve.element("p", {className: "alert"}, words);
    const list = (notes) => serve.element("ul", {className: "quiet"}, ...notes.map((note) => serve.element("li", {}, note)));

    // -- calibration
    // Readings under the conditions of the scene, on its clock: points of the curves.
    function measured(study) {
        const rows = [];
        study.residuals.histories.forEach((history) => {
            const test = study.tests.findIndex((one) => one.name === history.test);
            if (study.tests[test].conditions.length) return;
            const clock = study.parameters["clock_offset." + (test + 1)] || study.parameters.clock_offset;
            const offset = study.tests[test].clock === "fitted" && clock ? clock.estimate : 0;
            history.time.forEach((time, i) => rows.push({time: time - offset, [history.history]: history.measured[i]}));
        });
        rows.sort((a, b) => a.time - b.time);
        const all = {time: rows.map((one) => one.time)};
        for (const channel of ["force", "speed", "altitude"])
            if (rows.some((one) => channel in one)) all[channel] = rows.map((one) => (channel in one ? one[channel] : null));
        return Object.keys(all).length > 1 ? all : null;
    }

    const found = (study) => Object.entries(study.parameters).filter(([label, one]) => !one.held && !label.startsWith("clock_offset"));

    function remark(one) {
        if (one.held) return "held" + (one.why ? ": " + one.why : "");
        return one.identified ? "" : "not identified" + (one.why ? ": " + one.why : "");
    }

    function showCalibration(run, actions) {
        const study = run ? run.info.study : null, section = get("calibration"), body = get("calibration-body"), results = serve.results;
        section.hidden = !study;
        calibration = study;
        if (!study) return;
        const findings = study.findings.map((one) => alert(one.what + " (" + one.why + "), " + one.suggestion +
            (one.explains.length ? ". Which explains: " + one.explains.join("; ") : "")));
        const use = serve.element("button", {type: "button"}, "Use the values found");
        use.addEventListener("click", () => actions.use(found(study)));
        const save = run.info.scene_text ? serve.element("button", {type: "button"}, "Save the calibrated scene") : null;
        const said = serve.element("span", {role: "status", className: "quiet"}, run.info.scene_text ? "" : "The calibrated scene with its uncertainty can be saved where the scene's text is that of its file.");
        if (save) save.addEventListener("click", async () => { said.textContent = await actions.save(run.info.scene_text); });
        const inputs = Object.entries(study.parameters).map(([label, one]) => row(label,
            results.cell(shared.readable(one.scene, unit_of(one.unit))), results.cell(serve.element("strong", {}, shared.readable(one.estimate, unit_of(one.unit)))),
            results.cell(one.held ? "\u2013" : interval(one.interval_95, unit_of(one.unit))), results.cell(remark(one), "")));
        const next = Object.entries(study.predictive).map(([key, band]) => {
            const metric = serve.metric(key);
            return row(metric.words, results.cell(shared.readable(band.before, metric.unit)), results.cell(serve.element("strong", {}, shared.readable(band.estimate, metric.unit))),
                results.cell(interval(band.interval_95, metric.unit)));
        });
        const names = study.tests.map((test) => test.name + (test.conditions.length ? " (with " + test.conditions.join(", ") + "; not among the points of the curves)" : ""));
        body.replaceChildren(...findings,
            table("Inputs that explain " + names.join(", "), results.head("Input", "scene", "found", "95 %", "remark"), inputs),
            ...(next.length ? [table("The scene itself, dropped again", results.head("Figure", "before", "now", "95 %"), next)] : []),
            list(study.notes), serve.element("div", {className: "controls"}, use, save, said));
    }

    // -- campaign
    const verdicts = {met: true, exceeded: false};
    function showCampaign(run) {
        const study = run ? run.info.study : null, section = get("campaign"), body = get("campaign-body"), results = serve.results;
        section.hidden = !study;
        campaign = study;
        if (!study) return;
        const of_both = study.both ? Object.fromEntries(study.both.answers.map((one) => [one.name, one])) : {};
        const answers = study.answers.map((one) => {
            const paired = of_both[one.name] || one, scale = one.kind === "probability" ? 100 : 1, unit = one.kind === "probability" ? "%" : unit_of(one.unit);
            const verdict = paired.verdict;
            return row(serve.element("span", {}, one.name, serve.element("span", {className: "note"}, one.kind + (one.level ? " of " + shared.number(100 * one.level) + "\u00a0%" : "") + ", " + one.asked)),
                results.cell(serve.element("strong", {}, shared.readable(paired.estimate === null ? null : paired.estimate * scale, unit))),
                results.cell(interval(paired.interval_95, unit, scale)), results.cell(serve.isNumber(one.limit) ? shared.readable(one.limit * scale, unit) : "\u2013"),
                results.cell(verdict in verdicts ? results.chip(verdicts[verdict], verdict) : verdict, ""));
        });
        const runs = study.runs, notes = [shared.number(runs.complete, 9) + " of " + shared.number(runs.wanted, 9) + " runs came to their end, in " + shared.readable(study.cost.wall_s, "s") + ", " + study.engine];
        for (const [status, failed] of Object.entries(study.failures))
            notes.push(shared.number(failed.runs, 9) + " ended with " + status.replaceAll("_", " ") + ", run " + failed.first.slice(0, 3).join(", ") + (failed.first.length > 3 ? ", ..." : ""));
        const metrics = Object.keys(study.sensitivity), rows = study.inputs.map((input) => row(input.key, results.cell(input.distribution, ""), ...metrics.map((metric) => {
            const index = study.sensitivity[metric][input.key], shown = index && (index.total || index.first_order);
            return results.cell(shown ? shared.readable(shown.estimate, "") : "\u2013");
        })));
        const kept = metrics.length ? [table("Share of each answer's variance that an input explains", results.head("Input", "distribution", ...metrics.map((key) => serve.metric(key).words)), rows)] : [];
        body.replaceChildren(...(study.status === "complete" ? [] : [alert("The campaign is " + study.status)]),
            table("Answers with 95 % intervals, of " + study.campaign.name + " over the scene of this page", results.head("Question", "answer", "95 %", "limit", "verdict"), answers), ...kept, list(notes));
    }

    // -- files
    async function take(files) {
        const all = [];
        for (const file of files) all.push({name: file.name, text: await file.text()});
        if (!all.length) return;
        const plans = all.filter((file) => file.name.endsWith(".toml") && is_campaign.test(file.text));
        if (plans.length && all.length > 1) serve.runs.refuse("A campaign and other files at once, drop them one after the other");
        else if (plans.length) serve.runs.start("campaign", {campaign: plans[0].text, name: plans[0].name});
        else serve.runs.start("calibrate", {files: all});
    }
    for (const kind of ["calibrate", "campaign"]) {
        const chooser = get(kind + "-files");
        get("run-" + kind).addEventListener("click", () => chooser.click());
        chooser.addEventListener("change", async () => {
            await take(chooser.files);
            chooser.value = "";  // the same file again is a change, too
        });
    }
    const carries_files = (event) => event.dataTransfer && [...event.dataTransfer.types].includes("Files");
    let leaving;
    addEventListener("dragover", (event) => {
        if (!carries_files(event)) return;
        event.preventDefault();
        clearTimeout(leaving);
        document.body.classList.add("dropping");
        leaving = setTimeout(() => document.body.classList.remove("dropping"), 300);
    });
    addEventListener("drop", (event) => {
        if (!carries_files(event)) return;
        event.preventDefault();
        document.body.classList.remove("dropping");
        take(event.dataTransfer.files);
    });

    return {
        measured: () => (calibration ? measured(calibration) : null),
        // Shows the newest ones; actions: what their buttons do.
        show(runs, actions) {
            const done = (kind) => (runs[kind] && runs[kind].info && runs[kind].info.study ? runs[kind] : null);
            const one = done("calibrate"), other = done("campaign");
            if ((one ? one.info.study : null) !== calibration) showCalibration(one, actions);
            if ((other ? other.info.study : null) !== campaign) showCampaign(other);
        },
    };
})();
