// Tables of a run: key figures beside what they were, limits of the scene, handbook formulas, the gap.
"use strict";
serve.results = (function () {
    const standard_gravity = 9.80665;
    const figures = [
        ["peak_force_N", "Peak opening force", "N"], ["filling_time_s", "Filling time", "s"], ["descent_rate_m_s", "Descent rate", "m/s"],
        ["max_deceleration_g", "Maximum deceleration", "g"], ["landing_vertical_speed_m_s", "Vertical landing speed", "m/s"],
    ];
    // A limit of [size], its metric, what it is where a single canopy pulls, and the limit's unit in the metric's.
    const limits = [
        ["size.max_descent_rate", "Descent rate", "m/s", "descent_rate_m_s", "descent_rate_m_s", 1],
        ["size.max_force", "Maximum force", "N", "max_force_N", "max_force_N", 1],
        ["size.max_canopy_force", "Maximum force of one canopy", "N", "max_canopy_force_N", "max_force_N", 1],
        ["size.max_deceleration", "Maximum deceleration", "m/s^2", "max_deceleration_g", "max_deceleration_g", standard_gravity],
    ];
    const cell = (text, style) => serve.element("td", {className: style || "number"}, text);
    const head = (...titles) => serve.element("thead", {}, serve.element("tr", {}, ...titles.map((title, i) =>
        serve.element("th", {scope: "col", className: i ? "number" : ""}, title))));
    const chip = (good, words) => serve.element("span", {className: "chip " + (good ? "within" : "exceeded")}, (good ? "\u2713 " : "\u2717 ") + words);

    // Parachutes with names have their own peak force and filling time.
    function rowsOf(metrics) {
        const rows = [];
        for (const [key, title, unit] of figures) {
            const own = Object.keys(metrics).filter((name) => name.endsWith("_" + key) && !/^stage_\d/.test(name));
            if (serve.isNumber(metrics[key]) || !own.length) rows.push([key, title, unit]);
            if (key === "peak_force_N" || key === "filling_time_s")
                for (const name of own) rows.push([name, title + ", " + name.slice(0, -key.length - 1), unit]);
        }
        return rows;
    }

    // sides: {now, before, kept, full}, each a summary or null.
    function showFigures(sides, note) {
        const table = document.getElementById("figures-table"), now = sides.now, columns = ["Figure", "rom"];
        if (sides.full) columns.push(sides.fullIsSame ? "full" : "full, of other values");
        if (sides.full && sides.fullIsSame) columns.push("full minus rom");
        if (sides.before) columns.push("before", "change");
        if (sides.kept) columns.push(sides.keptName);
        const body = serve.element("tbody");
        for (const [key, title, unit] of rowsOf(now.metrics)) {
            const value = now.metrics[key], standing = now.standing && now.standing[key];
            const missing = (now.missing || []).find((one) => one.metric === key);
            const name = serve.element("th", {scope: "row"}, title);
            if (!serve.isNumber(value) && missing) name.append(serve.element("span", {className: "note"}, missing.why));
            else if (standing && standing.input_or_result === "input") name.append(serve.element("span", {className: "note"}, "of rom: an input" + (standing.note ? ", " + standing.note : "")));
            const row = serve.element("tr", {}, name, cell(serve.element("strong", {}, shared.readable(value, unit))));
            row.dataset.metric = key;
            if (sides.full) {
                const full = sides.full.metrics[key];
                row.append(cell(shared.readable(full, unit)));
                if (sides.fullIsSame) {
                    const gap = full - value;
                    row.append(cell(serve.isNumber(gap) ? serve.signed(gap, full, unit) + (full !== 0 ? " (" + serve.percent(gap / Math.abs(full)) + ")" : "") : "\u2013"));
                }
            }
            if (sides.before) {
                const before = sides.before.metrics[key];
                row.append(cell(shared.readable(before, unit), "number dim"));
                const change = serve.isNumber(value) && serve.isNumber(before) ? value - before : NaN;
                row.append(cell(serve.isNumber(change) && before !== 0 ? serve.percent(change / Math.abs(before)) : serve.signed(change, before, unit), "number dim"));
            }
            if (sides.kept) row.append(cell(shared.readable(sides.kept.metrics[key], unit)));
            body.append(row);
        }
        table.replaceChildren(head(...columns), body);
        document.getElementById("figures-note").textContent = note;
    }

    function showLimits(inputs, rom, full) {
        const body = serve.element("tbody");
        for (const [key, title, unit, metric, alone, factor] of limits) {
            const limit = inputs[key] && inputs[key].value;
            if (!serve.isNumber(limit)) continue;
            const row = serve.element("tr", {}, serve.element("th", {scope: "row"}, title), cell(shared.readable(limit, unit)));
            for (const summary of full ? [rom, full] : [rom]) {
                const found = serve.isNumber(summary.metrics[metric]) ? summary.metrics[metric] : summary.metrics[alone];
                const value = serve.isNumber(found) ? found * factor : NaN, margin = (limit - value) / limit;
                row.append(cell(shared.readable(value, unit)));
                row.append(cell(!serve.isNumber(value) ? "the run has none" : chip(margin >= 0,
                    margin >= 0 ? (100 * margin).toPrecision(3) + " % below" : (-100 * margin).toPrecision(3) + " % above"), ""));
            }
            row.dataset.limit = key;
            body.append(row);
        }
        document.getElementById("limits").hidden = !body.children.length;
        document.getElementById("limits-table").replaceChildren(
            head("Limit on", "limit", "rom", "margin", ...(full ? ["full", "margin"] : [])), body);
    }

    function showFormulas(summary) {
        const body = serve.element("tbody"), peak = summary.metrics.peak_force_N;
        for (const estimate of summary.estimates || []) {
            const row = serve.element("tr", {},
                serve.element("th", {scope: "row"}, estimate.title, serve.element("span", {className: "note"}, estimate.source)),
                cell(shared.readable(estimate.value, "N")), cell(serve.isNumber(peak) && peak > 0 ? serve.percent((estimate.value - peak) / peak) : "\u2013"),
                serve.element("td", {}, estimate.outside ? "\u2717 does not hold: " + estimate.outside : "\u2713 holds"));
            if (estimate.outside) row.className = "repeated";
            body.append(row);
        }
        document.getElementById("formulas").hidden = !body.children.length;
        document.getElementById("formulas-table").replaceChildren(serve.element("thead", {}, serve.element("tr", {},
            serve.element("th", {scope: "col"}, "Formula"), serve.element("th", {scope: "col", className: "number"}, "peak force"),
            serve.element("th", {scope: "col", className: "number"}, "against rom"), serve.element("th", {scope: "col"}, "holds here?"))), body);
    }

    function showAlerts(summary) {
        const list = [];
        if (summary.status && summary.status.code !== "completed")
            list.push(summary.status.code.replaceAll("_", " ") + (summary.status.detail ? ": " + summary.status.detail : ""));
        for (const warning of summary.warnings || [])
            list.push(warning.what + (warning.why ? " (" + warning.why + ")" : "") + (warning.suggestion ? ", " + warning.suggestion : ""));
        document.getElementById("alerts").replaceChildren(...list.map((words) => serve.element("p", {className: "alert"}, words)));
    }

    // gap: gap.json. Differences as in the report: full minus rom, as shares of full.
    function showGap(gap, report, stale) {
        const body = document.getElementById("gap-body"), section = document.getElementById("gap");
        section.hidden = !gap;
        body.textContent = "";
        if (!gap) return;
        const style = gap.verdict === "within" && gap.exit_code === 0 ? "within" : gap.verdict === "exceeded" || gap.exit_code === 1 ? "exceeded" : "";
        body.append(serve.element("div", {className: "verdict " + style},
            serve.element("span", {className: "sign", "aria-hidden": "true"}, style === "within" ? "\u2713" : style === "exceeded" ? "\u2717" : "\u2013"),
            serve.element("p", {}, serve.element("strong", {}, gap.summary), serve.element("span", {}, report))));
        if (stale) body.append(serve.element("p", {className: "alert"}, "Compared with other values than those shown above"));
        const rows = serve.element("tbody"), judged = Object.values(gap.metrics).filter((metric) => metric.verdict !== "not judged");
        for (const metric of judged) {
            const tolerance = metric.tolerance;
            rows.append(serve.element("tr", {}, serve.element("th", {scope: "row"}, metric.name.replaceAll("_", " ")),
                cell(shared.readable(metric.candidate, metric.unit)), cell(shared.readable(metric.reference, metric.unit)),
                cell(serve.signed(-metric.difference, metric.reference, metric.unit) + (serve.isNumber(metric.relative) ? " (" + serve.percent(-metric.relative) + ")" : "")),
                cell(tolerance ? "\u00b1" + (tolerance.relative ? shared.number(100 * tolerance.value) + "\u00a0%" : shared.readable(tolerance.value, metric.unit)) : "\u2013"),
                cell(["within", "exceeded"].includes(metric.verdict) ? chip(metric.verdict === "within", metric.verdict) : metric.verdict, "")));
        }
        const table = serve.element("table", {}, serve.element("caption", {}, "Differences are full minus rom; per cents are shares of full."),
            head("Metric", "rom", "full", "difference", "tolerance", "verdict"), rows);
        body.append(serve.element("div", {className: "scroll", role: "region", "aria-label": "Gap, table", tabIndex: 0}, table));
    }

    // Candidates that `size` found; `use` opens the scene of one.
    function showSizing(sized, use) {
        document.getElementById("sizing").hidden = !sized;
        if (!sized) return;
        const words = (name) => name.replaceAll("_", " "), found = sized.candidates.filter((one) => one.varied);
        const varied = found.length ? Object.keys(found[0].varied) : [], limited = found.length ? found[0].limits.map((limit) => limit.name) : [];
        const rows = serve.element("tbody");
        for (const one of sized.candidates) {
            const button = one.scene_text ? serve.element("button", {type: "button"}, "Use") : null;
            if (button) {
                button.setAttribute("aria-label", "Use the scene with " + (one.type || "its own canopy") + ", sized");
                button.addEventListener("click", () => use(one));
            }
            const limit = (name) => one.limits && one.limits.find((each) => each.name === name);
            rows.append(serve.element("tr", {className: one.best ? "judged" : ""}, serve.element("th", {scope: "row"}, one.type || "as in the scene"),
                ...varied.map((name) => cell(one.varied && one.varied[name] ? shared.readable(one.varied[name].value, one.varied[name].unit) : "\u2013")),
                ...limited.map((name) => cell(limit(name) ? shared.readable(limit(name).value, limit(name).unit) + ", " + shared.number(100 * limit(name).used, 3) + "\u00a0%" : "\u2013")),
                cell(shared.readable(one.parachute_mass_kg, "kg")),
                cell(chip(one.meets, one.meets ? (one.best ? "best" : "meets") : one.why_not ? "no: " + one.why_not : "no"), ""), serve.element("td", {}, button)));
        }
        document.getElementById("sizing-table").replaceChildren(
            serve.element("caption", {}, "By the reduced-order model, each limit with the share of it that is used. Mass is an estimate; the lightest that meets the limits is best."),
            head("Canopy", ...varied.map(words), ...limited.map((name) => words(name.replace("max_", ""))), "mass", "meets the limits", "scene"), rows);
        const notes = sized.candidates.flatMap((one) => (one.notes || []).map((note) => (sized.candidates.length > 1 ? (one.type || "scene") + ": " : "") + note));
        document.getElementById("sizing-notes").replaceChildren(...notes.map((note) => serve.element("li", {}, note)));
    }

    return {cell: cell, head: head, chip: chip, showSizing: showSizing, showFigures: showFigures, showLimits: showLimits, showFormulas: showFormulas, showAlerts: showAlerts, showGap: showGap};
})();
