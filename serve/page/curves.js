// Force, speed and altitude over the time since release: what was before, what is kept, both models.
"use strict";
serve.curves = (function () {
    const channels = [["force", "Force on the payload", "N"], ["speed", "Speed of the payload", "m/s"], ["altitude", "Altitude", "m"]];
    // Drawn in this order: the last lies on top. Where the full model is there, rom is dashed, as in reports.
    const lines = [
        {id: "measured", colour: "dim", pattern: null, width: 0, points: true},
        {id: "before", colour: "faint", pattern: null, width: 3},
        {id: "kept", colour: "up", pattern: [2, 3], width: 2.2},
        {id: "full", colour: "reference", pattern: null, width: 2},
        {id: "rom", colour: "candidate", pattern: null, width: 2},
    ];
    const nothing = [[0, ...lines.map(() => null)]];
    const shown = {};  // line: {label, history}
    const graphs = [], box = document.getElementById("histories"), cursor = document.getElementById("cursor");
    let times = [], at = -1;

    // All times of all lines, each once.
    function union() {
        const all = [];
        for (const line of lines) if (shown[line.id]) all.push(...shown[line.id].history.time);
        all.sort((a, b) => a - b);
        return all.filter((time, i) => i === 0 || time !== all[i - 1]);
    }
    // Rows of a plot: a line has a value at its own times and is joined across others.
    function rowsOf(channel) {
        const rows = times.map((time) => [time, ...lines.map(() => null)]);
        lines.forEach((line, column) => {
            const history = shown[line.id] && shown[line.id].history, values = history && history[channel];
            if (!values) return;
            let row = 0;
            for (let i = 0; i < history.time.length; ++i) {
                while (times[row] < history.time[i]) ++row;
                rows[row][column + 1] = serve.isNumber(values[i]) ? values[i] : NaN;
            }
        });
        return rows;
    }

    const tick = (value) => String(Number(value.toPrecision(5))).replace("-", "\u2212");
    const pattern = (line) => (line.id === "rom" && shown.full ? [7, 4] : line.pattern);
    function styles() {
        const found = {};
        for (const line of lines) found[line.id] = {strokePattern: pattern(line), strokeWidth: line.width, drawPoints: Boolean(line.points), pointSize: 1.8};
        return found;
    }
    function colours() {
        return {colors: lines.map((line) => shared.colour(line.colour)), gridLineColor: shared.colour("grid"), axisLineColor: shared.colour("rule")};
    }

    function select(row) {
        if (!times.length) return;
        at = Math.min(Math.max(row, 0), times.length - 1);
        const time = times[at];
        cursor.value = at;
        const words = shared.readable(time, "s");
        cursor.setAttribute("aria-valuetext", words);
        document.getElementById("cursor-time").textContent = words;
        for (const [graph, readout, channel, unit] of graphs) {
            graph.setSelection(at);
            if (graph.getSelection() < 0) graph.canvas_ctx_.clearRect(0, 0, graph.width_, graph.height_);
            shared.drawCursor(graph, time, 0);
            readout.textContent = "";
            for (const line of [...lines].reverse()) {
                const history = shown[line.id] && shown[line.id].history, values = history && history[channel];
                if (!values || !history.time.length || time > history.time[history.time.length - 1]) continue;
                const label = serve.element("span", {className: "side line-" + line.id}, shown[line.id].label + " ");
                readout.append(serve.element("span", {}, label, shared.readable(values[shared.placeOf(history.time, time)], unit)));
            }
        }
    }

    function zoom(range) {
        for (const [graph] of graphs) graph.updateOptions({dateWindow: range});
        document.getElementById("whole").hidden = range === null;
        if (at >= 0) select(at);
    }

    for (const [channel, title, unit] of channels) {
        const readout = serve.element("span", {className: "readout"}), plot = serve.element("div", {className: "curve"});
        const figure = serve.element("figure", {className: "history"}, serve.element("figcaption", {}, title + ", " + unit, readout), plot);
        figure.dataset.channel = channel;
        plot.setAttribute("role", "img");
        plot.setAttribute("aria-label", title + " over time; the time slider above reads it");
        box.append(figure);
        const graph = new Dygraph(plot, nothing, Object.assign({
            labels: ["time", ...lines.map((line) => line.id)], legend: "never", labelsKMB: false, xRangePad: 0, yRangePad: 6,
            axisLabelFontSize: 12, highlightCircleSize: 3.5, connectSeparatedPoints: true, animatedZooms: false,
            includeZero: channel !== "altitude", xlabel: "time since release, s", series: styles(),
            highlightCallback: (event, x, points, row) => select(row),
            zoomCallback: (from, to) => zoom([Math.max(from, times[0]), Math.min(to, times[times.length - 1])]),
            axes: {x: {axisLabelFormatter: tick, pixelsPerLabel: 60}, y: {axisLabelFormatter: tick, axisLabelWidth: 52, pixelsPerLabel: 34}},
        }, colours()));
        graph.resetZoom = () => zoom(null);
        graphs.push([graph, readout, channel, unit]);
    }

    function legend() {
        const list = document.getElementById("legend");
        list.textContent = "";
        for (const line of [...lines].reverse()) {
            if (!shown[line.id]) continue;
            const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), stroke = document.createElementNS(svg.namespaceURI, "line");
            for (const [name, value] of Object.entries({width: 34, height: 10, "aria-hidden": "true"})) svg.setAttribute(name, value);
            for (const [name, value] of Object.entries({x1: 1, x2: 33, y1: 5, y2: 5, "stroke-width": line.width})) stroke.setAttribute(name, value);
            if (pattern(line)) stroke.setAttribute("stroke-dasharray", pattern(line).join(" "));
            stroke.setAttribute("class", "stroke-" + line.id);
            if (line.points)
                for (const [name, value] of Object.entries({"stroke-width": 4, "stroke-linecap": "round", "stroke-dasharray": "0.1 8"})) stroke.setAttribute(name, value);
            svg.append(stroke);
            list.append(serve.element("li", {}, svg, shown[line.id].label));
        }
    }

    cursor.addEventListener("input", () => select(Number(cursor.value)));
    document.getElementById("whole").addEventListener("click", () => zoom(null));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
        for (const [graph] of graphs) graph.updateOptions(colours());
    });

    let described = "";
    return {
        graphs: graphs.map(([graph]) => graph),
        shown: shown,
        // history: times and channels; undefined takes the line away.
        set(id, label, history) {
            if (history && history.time && history.time.length) shown[id] = {label: label, history: history};
            else delete shown[id];
        },
        draw() {
            // First at the largest force: what everybody looks for.
            const first = shown.rom && shown.rom.history, time = at >= 0 ? times[at] : first ? first.time[first.force.indexOf(Math.max(...first.force))] : 0;
            times = union();
            const words = JSON.stringify(lines.map((line) => shown[line.id] && shown[line.id].label));
            const restyled = words !== described;
            for (const [graph, , channel] of graphs)
                graph.updateOptions(Object.assign({file: times.length ? rowsOf(channel) : nothing}, restyled ? {series: styles()} : {}));
            if (restyled) legend();
            described = words;
            cursor.max = Math.max(0, times.length - 1);
            if (times.length) select(shared.placeOf(times, time));
        },
        resize() { for (const [graph] of graphs) graph.resize(); },
    };
})();
