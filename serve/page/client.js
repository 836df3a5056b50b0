// Shared by all parts of the page: the server, numbers as text, elements.
"use strict";
const serve = {
    token: new URLSearchParams(location.search).get("token") || "",

    // Status and answer of the server; status 0 where there is none.
    async ask(method, path, body) {
        const options = {method: method, cache: "no-store", headers: {"X-Twinchute-Token": serve.token}};
        if (body !== undefined) {
            options.headers["Content-Type"] = "application/json";
            options.body = JSON.stringify(body);
        }
        try {
            const answer = await fetch("/api/" + path, options);
            return {status: answer.status, data: await answer.json().catch(() => null)};
        } catch (gone) {
            return {status: 0, data: {error: "The server does not answer (it may have ended), start twinchute serve again"}};
        }
    },
    // Bytes of an answer that is no JSON; null where there is none.
    async bytes(path) {
        try {
            const answer = await fetch("/api/" + path, {cache: "no-store", headers: {"X-Twinchute-Token": serve.token}});
            return answer.status === 200 ? new Uint8Array(await answer.arrayBuffer()) : null;
        } catch (gone) {
            return null;
        }
    },
    // The words of a refusal, whatever its form.
    words(answer) {
        const error = answer.data && answer.data.error;
        if (error && typeof error === "object") return String(error.message);
        return error ? String(error) : "The server answered " + answer.status;
    },

    element(tag, properties, ...children) {
        const made = document.createElement(tag);
        for (const [name, value] of Object.entries(properties || {})) {
            if (name in made) made[name] = value; else made.setAttribute(name, value);
        }
        made.append(...children.filter((child) => child !== null && child !== undefined));
        return made;
    },
    // Words and unit of a metric's key: peak_force_N.
    metric(key) {
        for (const [tail, unit] of [["_m_s", "m/s"], ["_N_s", "N s"], ["_N", "N"], ["_kPa", "kPa"], ["_m", "m"], ["_s", "s"], ["_g", "g"]])
            if (key.endsWith(tail)) return {words: key.slice(0, -tail.length).replaceAll("_", " "), unit: unit};
        return {words: key.replaceAll("_", " "), unit: ""};
    },
    isNumber(value) { return typeof value === "number" && isFinite(value); },
    // With its sign, to the digits that numbers of the size `of` are shown with.
    signed(value, of, unit) {
        if (!serve.isNumber(value)) return "\u2013";
        const places = of ? Math.max(0, 3 - Math.floor(Math.log10(Math.abs(of)))) : 3;
        const text = Math.abs(value).toFixed(Math.min(places, 9));
        const sign = Number(text) === 0 ? "\u00b1" : value < 0 ? "\u2212" : "+";
        return sign + text + (unit ? "\u00a0" + unit : "");
    },
    percent(share) {
        if (!serve.isNumber(share)) return "";
        const text = Math.abs(100 * share).toFixed(Math.abs(share) < 0.1 ? 1 : 0);
        return (Number(text) === 0 ? "\u00b1" : share < 0 ? "\u2212" : "+") + text + "\u00a0%";
    },
};
