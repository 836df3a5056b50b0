// Curves of one run or of both models over one clock, the difference below, a cursor through all of them.
"use strict";
(function () {
    const data = report.data, clock = data.clock, style = data.styles;
    if (!clock.length) return;
    const graphs = [];
    const opening = [clock[0], data.openingEnd], whole = [clock[0], clock[clock.length - 1]];
    let shown = opening, drawing = false;

    // A plot's range in a window of time, so that a spike of a few milliseconds does not flatten the rest: where
    // the largest magnitude is more than 1.5 times that of all but 2 % of the time, what lies beyond 1.25 times
    // the latter is cut off. A peak of the opening force never is. null: the range of all values.
    function robustRange(lists, window, kept) {
        const inside = [], weights = [];
        let largest = 0, total = 0;
        for (const list of lists)
            for (let i = 0; i < clock.length; ++i) {
                if (list[i] === null || clock[i] < window[0] || clock[i] > window[1]) continue;
                const weight = (clock[Math.min(i + 1, clock.length - 1)] - clock[Math.max(i - 1, 0)]) / 2;
                inside.push([Math.abs(list[i]), weight]);
                total += weight;
                largest = Math.max(largest, Math.abs(list[i]));
            }
        inside.sort((a, b) => b[0] - a[0]);
        let rest = 0.02 * total, usual = 0;
        for (const [size, weight] of inside) { rest -= weight; usual = size; if (rest <= 0) break; }
        usual = Math.max(usual, kept);
        if (!(usual > 0) || !(largest > 1.5 * usual)) return null;
        const bound = 1.25 * usual;
        let low = 0, high = 0, cut = 0;
        for (const list of lists)
            for (let i = 0; i < clock.length; ++i) {
                if (list[i] === null || clock[i] < window[0] || clock[i] > window[1]) continue;
                low = Math.min(low, Math.max(list[i], -bound));
                high = Math.max(high, Math.min(list[i], bound));
                if (Math.abs(list[i]) > Math.abs(cut)) cut = list[i];
            }
        return {range: [low < 0 ? 1.06 * low : 0, high > 0 ? 1.06 * high : 0], cut: cut};
    }

    // Ranges of all plots for the window shown; how high a cut-off spike is stands at the edge of its plot.
    const ranged = [];
    let fullRange = false;
    function setRanges(window) {
        let any = false;
        for (const one of ranged) {
            one.robust = robustRange(one.lists, window, one.kept);
            any = any || one.robust !== null;
            one.graph.updateOptions({valueRange: one.robust && !fullRange ? one.robust.range : null});
            one.mark.hidden = !one.robust || fullRange;
            one.mark.textContent = one.robust
                ? "spike cut off: " + shared.readable(one.robust.cut, one.unit) : "";
        }
        document.getElementById("full-range").hidden = !any;
        document.getElementById("cut-off").hidden = !any;
    }

    function tick(value, granularity, options, graph) {
        return String(Number(value.toPrecision(5))).replace("-", "\u2212");
    }

    // Zero, and the largest round number on either side of it that has room.
    function aroundZero(low, high) {
        const most = 0.9 * Math.max(Math.abs(low), Math.abs(high));
        if (!(most > 0)) return [{v: 0, label: "0"}];
        const unit = Math.pow(10, Math.floor(Math.log10(most)));
        const step = unit * (most >= 5 * unit ? 5 : most >= 2 * unit ? 2 : 1);
        return [-step, 0, step].filter((v) => v >= low && v <= high).map((v) => ({v: v, label: tick(v)}));
    }

    // Thin lines where something happened, in the colour of the side where it did.
    function drawEvents(context, area, graph) {
        context.save();
        context.setLineDash([2, 3]);
        for (const event of data.events) {
            const x = graph.toDomXCoord(event.time);
            if (x < area.x || x > area.x + area.w) continue;
            context.strokeStyle = shared.colour(style[event.side]);
            context.globalAlpha = 0.55;
            context.beginPath();
            context.moveTo(x, area.y);
            context.lineTo(x, area.y + area.h);
            context.stroke();
        }
        context.restore();
    }

    // The cursor is a line through plot and difference alike.
    function drawCursor(graph) {
        if (report.row !== undefined) shared.drawCursor(graph, clock[report.row], 1);
    }

    function select(row) {
        report.row = row;
        for (const graph of graphs) {
            graph.setSelection(row);
            if (graph.getSelection() < 0) graph.canvas_ctx_.clearRect(0, 0, graph.width_, graph.height_);
            drawCursor(graph);
        }
        const cursor = document.getElementById("cursor"), words = clock[row].toFixed(3).replace("-", "\u2212") + " s";
        cursor.value = row;
        cursor.setAttribute("aria-valuetext", words);
        document.getElementById("cursor-time").textContent = words;
        for (const channel of data.channels) {
            const readout = document.getElementById("readout-" + channel.id), values = channel.values;
            const say = (kind, name, value) => {
                const item = document.createElement("span"), label = document.createElement("span");
                label.className = kind;
                label.textContent = name + " ";
                item.append(label, shared.readable(value, channel.unit));
                readout.append(item);
            };
            readout.textContent = "";
            for (const side of [0, 1]) if (values[side]) say("side " + style[side], data.sides[side], values[side][row]);
            if (channel.test && channel.test[row] !== null) say("", "test", channel.test[row]);
            if (!values[0] || !values[1]) continue;
            const gap = values[0][row] === null || values[1][row] === null ? null : values[1][row] - values[0][row];
            say("", "difference", gap);
        }
    }

    function point(row, source) {
        select(row);
        report.setTime(clock[row], source || "charts");
    }

    function show(window) {
        shown = window;
        drawing = true;
        for (const graph of graphs) graph.updateOptions({dateWindow: window.slice()});
        setRanges(window);
        drawing = false;
        for (const button of document.querySelectorAll("[data-window]")) {
            const its = button.dataset.window === "all" ? whole : opening;
            button.setAttribute("aria-pressed", String(its[0] === window[0] && its[1] === window[1]));
        }
        if (report.row !== undefined) for (const graph of graphs) drawCursor(graph);
    }

    function draw(element, rows, options) {
        const graph = new Dygraph(element, rows, Object.assign({
            dateWindow: shown.slice(), legend: "never", labelsKMB: false, xRangePad: 0, yRangePad: 6,
            axisLabelFontSize: 12, strokeWidth: 1.8, highlightCircleSize: 3.5, rollPeriod: 1,
            connectSeparatedPoints: false, animatedZooms: false, showRangeSelector: false,
            highlightCallback: (event, x, points, row) => point(row),
            underlayCallback: drawEvents,
            drawCallback: (drawn, first) => {
                if (first || drawing) return;
                const range = drawn.xAxisRange();
                show([Math.max(range[0], whole[0]), Math.min(range[1], whole[1])]);
            },
            axes: {x: {axisLabelFormatter: tick, pixelsPerLabel: 60},
                   y: {axisLabelFormatter: tick, axisLabelWidth: 52, pixelsPerLabel: 34}},
        }, options));
        // Back to the opening, not to the extremes of the data.
        graph.resetZoom = () => show(opening);
        graphs.push(graph);
        return graph;
    }

    function paint(graph, colours) {
        graph.updateOptions({
            colors: colours.map(shared.colour), gridLineColor: shared.colour("grid"), axisLineColor: shared.colour("rule"),
        });
    }

    for (const channel of data.channels) {
        const figure = document.querySelector('[data-channel="' + CSS.escape(channel.id) + '"]');
        const there = [0, 1].filter((side) => channel.values[side]);
        const rows = clock.map((t, row) => [t].concat(there.map((side) => channel.values[side][row])));
        const series = {};
        // The dashed one is drawn last: it lies on the other where they agree, and both are seen.
        const order = there.slice().reverse();
        for (const side of there) series[data.sides[side]] = side === 0 && data.sides.length > 1 ? {strokePattern: [7, 4]} : {};
        const dots = channel.test ? [channel.test] : [];
        if (channel.test) series.test = {strokeWidth: 0, drawPoints: true, pointSize: 2.2, highlightCircleSize: 2.2};
        const ordered = clock.map((t, row) => [t].concat(
            order.map((side) => channel.values[side][row]), dots.map((values) => values[row])));
        const graph = draw(figure.querySelector(".curve"), ordered, {
            labels: ["time"].concat(order.map((side) => data.sides[side]), dots.map(() => "test")), series: series,
            includeZero: true,
            xlabel: there.length === 1 ? data.clockLabel : "",
        });
        report.onScheme(() => paint(graph, order.map((side) => style[side]).concat(dots.map(() => "ink"))));
        // The peaks of the opening force, as they are events: the spike before them is the snatch.
        const peaks = channel.id !== "force" ? [] : data.events.filter((event) => event.name === "peak-force" && channel.values[event.side])
            .map((event) => channel.values[event.side][shared.placeOf(clock, event.time)] || 0);
        const marked = (element) => element.parentNode.insertBefore(
            Object.assign(document.createElement("p"), {className: "cut", hidden: true}), element);
        const keep = (of, element, lists, kept) => ranged.push({graph: of, lists: lists, kept: kept, unit: channel.unit, mark: marked(element)});
        keep(graph, figure.querySelector(".curve"), there.map((side) => channel.values[side]), Math.max(0, ...peaks));
        if (there.length < 2) continue;
        const gaps = rows.map((row) => [row[0], row[1] === null || row[2] === null ? null : row[2] - row[1]]);
        const below = draw(figure.querySelector(".difference"), gaps, {
            labels: ["time", "difference"], fillGraph: true, fillAlpha: 0.12, strokeWidth: 1.4, includeZero: true,
            xlabel: data.clockLabel, yRangePad: 2, axes: {
                x: {axisLabelFormatter: tick, pixelsPerLabel: 60}, y: {ticker: aroundZero, axisLabelWidth: 52}},
        });
        report.onScheme(() => paint(below, ["dim"]));
        keep(below, figure.querySelector(".difference"), [gaps.map((row) => row[1])], 0);
    }

    for (const button of document.querySelectorAll("[data-window]"))
        button.addEventListener("click", () => show(button.dataset.window === "all" ? whole : opening));
    const cursor = document.getElementById("cursor");
    cursor.max = clock.length - 1;
    cursor.addEventListener("input", () => point(Number(cursor.value)));
    report.onTime((time, source) => { if (source !== "charts") select(shared.placeOf(clock, time)); });
    report.graphs = graphs;
    const wholeSpikes = document.getElementById("full-range");
    wholeSpikes.addEventListener("click", () => {
        fullRange = !fullRange;
        wholeSpikes.setAttribute("aria-pressed", String(fullRange));
        show(shown);
    });
    show(opening);

    // First at the reference's peak force: what everybody looks for.
    const peak = data.events.filter((event) => event.name === "peak-force").sort((a, b) => b.side - a.side)[0];
    point(peak ? shared.placeOf(clock, peak.time) : 0);
})();
