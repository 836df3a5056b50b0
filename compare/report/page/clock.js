// One time for the whole page: curves and canopy show the same instant.
"use strict";
const report = {
    data: JSON.parse(document.getElementById("report-data").textContent),
    listeners: [],
    // Whoever shows time listens; whoever changes it says who it is, so as not to be told again.
    onTime(listener) { report.listeners.push(listener); },
    setTime(time, source) {
        report.time = time;
        for (const listener of report.listeners) listener(time, source);
    },
    colour(name) { return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim(); },
    // Called now and whenever the reader's system turns light or dark.
    onScheme(listener) {
        listener();
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", listener);
    },
    // The last place in a rising list that is not above the value; 0 where all are.
    placeOf(list, value) {
        let low = 0, high = list.length - 1;
        while (low < high) {
            const middle = (low + high + 1) >> 1;
            if (list[middle] <= value) low = middle; else high = middle - 1;
        }
        return low;
    },
    readable(value, unit) {
        if (value === null || value === undefined || !isFinite(value)) return "\u2013";
        const size = Math.abs(value);
        const text = size >= 1e6 || (size > 0 && size < 1e-3) ? value.toExponential(2)
            : String(Number(value.toPrecision(4)));
        return text.replace("-", "\u2212") + (unit ? "\u00a0" + unit : "");
    },
};
