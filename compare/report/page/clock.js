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
    // Called now and whenever the reader's system turns light or dark.
    onScheme(listener) {
        listener();
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", listener);
    },
};
