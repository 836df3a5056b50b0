// Shared by report pages and the page of `serve`.
"use strict";
const shared = {
    colour(name) { return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim(); },
    // The last place in a rising list that is not above the value; 0 where all are.
    placeOf(list, value) {
        let low = 0, high = list.length - 1;
        while (low < high) {
            const middle = (low + high + 1) >> 1;
            if (list[middle] <= value) low = middle; else high = middle - 1;
        }
        return low;
    },
    number(value, digits) {
        const size = Math.abs(value);
        return size >= 1e6 || (size > 0 && size < 1e-3) ? value.toExponential(2) : String(Number(value.toPrecision(digits || 4)));
    },
    readable(value, unit) {
        if (typeof value !== "number" || !isFinite(value)) return "\u2013";
        return shared.number(value).replace("-", "\u2212") + (unit && unit !== "1" ? "\u00a0" + unit : "");
    },
    // A line across a plot of dygraphs at this time, in its own pixels; none where `slack` puts it outside.
    drawCursor(graph, time, slack) {
        const context = graph.canvas_ctx_, area = graph.getArea(), x = graph.toDomXCoord(time);
        if (x < area.x - slack || x > area.x + area.w + slack) return;
        context.save();
        context.strokeStyle = shared.colour("ink");
        context.beginPath();
        context.moveTo(x, area.y);
        context.lineTo(x, area.y + area.h);
        context.stroke();
        context.restore();
    },
};
