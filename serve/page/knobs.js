// The form of values: one field for each key that the scene sets, with a slider where it is a number. Rows come
// from the program's own list of keys; values are those that the last run was made with.
"use strict";
serve.knobs = (function () {
    const steps = 1000;      // positions of a slider
    const reach = 3;         // it goes from a third of the value to three times
    const most_found = 12;   // keys shown by a search
    // Never a value to turn: what a scene is made of, other files, and studies.
    const never = /^(schema|name|base|case|series|uncertainty|fabric|cord|compare\.tolerance)(\.|$)/;
    const closed = ["full", "rom", "compare"];
    // Units of which one may stand in the text: the SI unit, and how much of it that is.
    const known_units = {
        lb: ["kg", 0.45359237], lbm: ["kg", 0.45359237], oz: ["kg", 0.028349523125], g: ["kg", 1e-3],
        ft: ["m", 0.3048], "in": ["m", 0.0254], km: ["m", 1e3], cm: ["m", 1e-2], mm: ["m", 1e-3],
        "ft^2": ["m^2", 0.09290304], "in^2": ["m^2", 6.4516e-4],
        "ft/s": ["m/s", 0.3048], fps: ["m/s", 0.3048], mph: ["m/s", 0.44704], "km/h": ["m/s", 1 / 3.6],
        kN: ["N", 1e3], lbf: ["N", 4.4482216152605], ms: ["s", 1e-3], min: ["s", 60], deg: ["rad", Math.PI / 180],
    };
    const rows = new Map(), knobs = new Map(), added = new Set();
    const box = document.getElementById("knobs"), search = document.getElementById("search");
    let inputs = {}, ran = {}, own = {}, count = 0;

    // Names of the parachutes where there are several, as keys have them: parachute.drogue.mass.
    const names = () => Object.keys(own).map((path) => /^parachute\.([^.]+)\.name$/.exec(path)).filter(Boolean).map((found) => found[1]);
    const isOfNamed = (path) => path.startsWith("parachute.") && names().includes(path.split(".")[1]);
    // The row of a key: members of lists and parachutes with names share theirs.
    function rowOf(path) {
        const parts = path.split(".");
        if (isOfNamed(path)) parts.splice(1, 1);
        return rows.get(parts.filter((part) => !/^\d+$/.test(part)).join("."));
    }

    function bounds(row) {
        const found = /(>=?) (\S+)(?: and (<=?) (\S+))?( deg)?$/.exec(row.range);
        if (!found) return null;
        const scale = found[5] ? Math.PI / 180 : 1;
        const strictly = (sign, value, inside) => (sign.length === 1 ? value + inside * Math.abs(value) : value);
        return {
            low: strictly(found[1], Number(found[2]), 1e-3) * scale,
            high: found[4] ? strictly(found[3], Number(found[4]), -1e-3) * scale : Infinity,
        };
    }
    const wordsOf = (row) => row.range.split(" | ").filter((word) => /^[\w.-]+$/.test(word));
    const isWord = (row) => !row.range.startsWith("a list") && !bounds(row) && wordsOf(row).length > 0;
    const isWhole = (row) => bounds(row) !== null && row.unit === "";

    const escaped = (text) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
    const plain = (value) => String(Number(value.toPrecision(12)));

    // A value in the unit of the scene's text where that says the same number, otherwise in SI, angles in degrees.
    function written(path, input, row) {
        if (typeof input.value !== "number") return String(input.value);
        const leaf = path.split(".").pop();
        const pattern = new RegExp(escaped(leaf) + "\\s*=\\s*(?:\\{\\s*value\\s*=\\s*)?[\"']([-+0-9.eE]+)\\s*([^\"']+)[\"']", "g");
        for (const [, number, unit] of serve.state.text.matchAll(pattern)) {
            const known = known_units[unit.trim()];
            if (known && known[0] === row.unit && Math.abs(Number(number) * known[1] - input.value) <= 1e-9 * Math.abs(input.value))
                return number + " " + unit.trim();
        }
        if (row.unit === "rad") return plain(input.value * 180 / Math.PI) + " deg";
        return plain(input.value) + (row.unit && row.unit !== "1" ? " " + row.unit : "");
    }

    // Value for --set: numbers as they are, words in quotes.
    function toml(words, row) {
        if (/^[[{"']/.test(words)) return words;
        if (row.range.startsWith("a list")) return "[" + words.split(",").map((word) => JSON.stringify(word.trim())).join(", ") + "]";
        return bounds(row) && /^[+-]?\d+(\.\d+)?([eE][+-]?\d+)?$/.test(words) ? words : JSON.stringify(words);
    }

    // The slider of a value: its ends in SI, the unit it writes, and how much of SI that is. null: none makes sense.
    function slideOf(row, words, value) {
        const limits = bounds(row), parts = /^\s*([-+]?[0-9.]+(?:[eE][-+]?\d+)?)\s*(.*?)\s*$/.exec(words);
        if (!limits || !parts || !serve.isNumber(value)) return null;
        const unit = parts[2], known = known_units[unit];
        const factor = known && known[0] === row.unit ? known[1] : Number(parts[1]) !== 0 ? value / Number(parts[1]) : 1;
        if (!(factor > 0)) return null;
        const tail = unit ? " " + unit : "", whole = isWhole(row);
        if (row.unit === "rad") return {low: limits.low, high: limits.high, even: true, whole: false, factor: factor, tail: tail};
        if (value === 0) return null;
        const ends = value > 0 ? [value / reach, value * reach] : [value * reach, value / reach];
        const low = Math.max(whole ? Math.floor(ends[0]) : ends[0], limits.low), high = Math.min(whole ? Math.ceil(ends[1]) : ends[1], limits.high);
        if (!(low < high) || !(low * high > 0)) return null;
        return {low: low, high: high, even: false, whole: whole, factor: factor, tail: tail};
    }
    function valueAt(slide, place) {
        const share = place / steps;
        return slide.even ? slide.low + share * (slide.high - slide.low) : slide.low * Math.pow(slide.high / slide.low, share);
    }
    function placeAt(slide, value) {
        const share = slide.even ? (value - slide.low) / (slide.high - slide.low) : Math.log(value / slide.low) / Math.log(slide.high / slide.low);
        return Math.round(steps * Math.min(1, Math.max(0, share)));
    }
    // The shortest number within half a step of the slider.
    function wordsAt(slide, value) {
        const number = value / slide.factor;
        if (slide.whole) return String(Math.round(number)) + slide.tail;
        const half = 0.5 / steps * (slide.even ? (slide.high - slide.low) / slide.factor : Math.abs(number * Math.log(slide.high / slide.low)));
        let digits = 1;
        while (digits < 12 && Math.abs(Number(number.toPrecision(digits)) - number) > half) ++digits;
        return String(Number(number.toPrecision(digits))) + slide.tail;
    }

    const groupOf = (path) => {
        const parts = path.split(".");
        return isOfNamed(path) ? parts.slice(0, 2).join(".") : parts[0];
    };

    function groupBox(path) {
        const name = groupOf(path), there = box.querySelector('[data-group="' + CSS.escape(name) + '"]');
        if (there) return there;
        const is_changed = Object.keys(serve.state.set).some((key) => groupOf(key) === name);
        const made = serve.element("details", {className: "group", open: is_changed || !closed.includes(name)},
            serve.element("summary", {}, name.replace(".", " ")));
        made.dataset.group = name;
        box.append(made);
        return made;
    }

    function make(path) {
        const row = rowOf(path), id = "knob-" + ++count, label = path.slice(groupOf(path).length + 1);
        const knob = {path: path, row: row, slide: null, dragged: false};
        const words = wordsOf(row);
        knob.field = isWord(row)
            ? serve.element("select", {id: id}, serve.element("option", {value: "", hidden: true}, "(not set)"), ...words.map((word) => serve.element("option", {}, word)))
            : serve.element("input", {id: id, type: "text", autocomplete: "off", spellcheck: false, placeholder: row.default});
        if (!isWord(row) && words.length) {
            const list = serve.element("datalist", {id: id + "-words"}, ...words.map((word) => serve.element("option", {value: word})));
            knob.field.setAttribute("list", list.id);
            knob.list = list;
        }
        knob.slider = serve.element("input", {type: "range", min: 0, max: steps, step: 1, hidden: true, "aria-label": path + ", slider"});
        knob.ends = serve.element("span", {className: "ends", hidden: true, "aria-hidden": "true"}, serve.element("span"), serve.element("span"));
        knob.reset = serve.element("button", {type: "button", className: "reset", hidden: true});
        knob.message = serve.element("p", {id: id + "-message", className: "message", hidden: true, role: "alert"});
        knob.meaning = serve.element("p", {id: id + "-meaning", className: "meaning"}, row.meaning);
        knob.field.setAttribute("aria-describedby", id + "-meaning " + id + "-message");
        const unit = bounds(row) ? (row.unit === "rad" ? "deg, rad" : row.unit && row.unit !== "1" ? row.unit : isWhole(row) ? "whole number" : "no unit") : "";
        knob.box = serve.element("div", {className: "knob"},
            serve.element("div", {className: "head"},
                serve.element("label", {htmlFor: id}, serve.element("code", {}, label)), serve.element("span", {className: "unit"}, unit)),
            serve.element("div", {className: "entry"}, knob.field, knob.reset), knob.list, knob.slider, knob.ends, knob.message, knob.meaning);
        knob.box.dataset.key = path;

        knob.field.addEventListener(isWord(row) ? "change" : "input", () => serve.change(path, knob.field.value));
        knob.field.addEventListener("change", () => {
            // A plain number is one in SI, whatever unit stood there before.
            const value = knob.field.value.trim();
            if (/^[+-]?[0-9.]+([eE][+-]?\d+)?$/.test(value) && row.unit && row.unit !== "1" && bounds(row)) {
                knob.field.value = value + " " + row.unit;
                serve.change(path, knob.field.value);
            }
            knob.slide = null;
            serve.commit();
        });
        knob.field.addEventListener("blur", () => refresh(knob, true));
        knob.slider.addEventListener("input", () => {
            if (!knob.slide) return;
            knob.dragged = true;
            knob.field.value = wordsAt(knob.slide, valueAt(knob.slide, Number(knob.slider.value)));
            knob.slider.setAttribute("aria-valuetext", knob.field.value);
            serve.change(path, knob.field.value);
        });
        knob.slider.addEventListener("change", () => {
            knob.dragged = false;
            if (["0", String(steps)].includes(knob.slider.value)) knob.slide = null;  // goes on from here
            serve.commit();
        });
        knob.reset.addEventListener("click", () => {
            added.delete(path);
            knob.slide = null;
            serve.change(path, "");
            serve.commit();
            serve.knobs.show();
            if (knob.box.isConnected) knob.field.focus(); else search.focus();
        });
        knobs.set(path, knob);
        return knob;
    }

    // Field and slider of the values in use; what is being typed or dragged is left alone.
    function refresh(knob, force) {
        const path = knob.path, mine = serve.state.set[path], input = inputs[path];
        const initial = own[path] ? written(path, own[path], knob.row) : "";
        const words = mine !== undefined ? mine : initial || (input ? written(path, input, knob.row) : "");
        const typing = document.activeElement === knob.field && !isWord(knob.row);
        if (!knob.dragged && (force || !typing)) knob.field.value = words;
        knob.reset.hidden = mine === undefined && !added.has(path);
        const back = initial ? "back to " + initial : "remove";
        knob.reset.textContent = back;
        knob.reset.setAttribute("aria-label", path + ": " + back);
        knob.box.classList.toggle("changed", mine !== undefined);
        knob.box.classList.toggle("unused", !input && mine === undefined && Boolean(own[path]));
        const value = input ? input.value : undefined;
        if (knob.dragged || ran[path] !== mine) return;  // words and number belong together
        const slide = slideOf(knob.row, words, value);
        const outside = slide && knob.slide && (value < knob.slide.low || value > knob.slide.high);
        if (!slide || !knob.slide || outside || knob.slide.tail !== slide.tail) knob.slide = slide;
        knob.slider.hidden = knob.ends.hidden = !knob.slide;
        if (!knob.slide) return;
        knob.slider.value = placeAt(knob.slide, value);
        knob.slider.setAttribute("aria-valuetext", words);
        knob.ends.firstChild.textContent = wordsAt(knob.slide, knob.slide.low);
        knob.ends.lastChild.textContent = wordsAt(knob.slide, knob.slide.high);
    }

    // Keys that a search may find: each for every parachute, members of lists that are there.
    function candidates() {
        const several = names(), list = [];
        for (const [path, row] of rows) {
            if (never.test(path) || row.range === "a table" || row.range === "a list of tables") continue;
            const below = path.startsWith("parachute.") && several.length ? several.map((name) => "parachute." + name + path.slice(9)) : [path];
            for (const one of below) {
                if (!/\.reefing\./.test(one)) { list.push(one); continue; }
                const head = one.slice(0, one.indexOf(".reefing.") + 9), tail = one.slice(head.length);
                const members = new Set(Object.keys(own).filter((key) => key.startsWith(head)).map((key) => key.slice(head.length).split(".")[0]));
                for (const member of members) list.push(head + member + "." + tail);
            }
        }
        return list.filter((path) => !(own[path] && own[path].origin === "given") && !added.has(path));
    }

    function add(path) {
        added.add(path);
        serve.knobs.show();
        const knob = knobs.get(path);
        knob.box.closest("details").open = true;
        return knob;
    }

    function find() {
        const list = document.getElementById("found"), asked = search.value.toLowerCase().split(/\s+/).filter(Boolean);
        list.textContent = "";
        if (!asked.length) return;
        const found = candidates().filter((path) => asked.every((word) => (path + " " + rowOf(path).meaning).toLowerCase().includes(word)));
        for (const path of found.slice(0, most_found)) {
            const row = rowOf(path);
            const button = serve.element("button", {type: "button"}, serve.element("code", {}, path), " ", serve.element("span", {}, row.meaning));
            button.addEventListener("click", () => {
                search.value = "";
                find();
                add(path).field.focus();
            });
            list.append(serve.element("li", {}, button));
        }
        if (!found.length) list.append(serve.element("li", {className: "quiet"}, "No other key has these words."));
        if (found.length > most_found) list.append(serve.element("li", {className: "quiet"}, found.length - most_found + " more: write another word."));
    }
    search.addEventListener("input", find);

    return {
        toml: (path, words) => toml(words, rowOf(path)),
        rowOf: rowOf,
        added: added,
        knobs: knobs,
        wordsAt: wordsAt, valueAt: valueAt, placeAt: placeAt,
        setRows(list) { for (const row of list) rows.set(row.key, row); },
        // Values of the scene's own text, and those of the last run.
        setOwn(found) { own = found; for (const knob of knobs.values()) knob.slide = null; },
        // `set`: the words that they were made with.
        setInputs(found, set) { inputs = found; ran = set; },
        inputs: () => inputs,
        names: names,
        written: (path, input) => written(path, input, rowOf(path)),
        isListOfTables: (path) => rowOf(path).range === "a list of tables",
        show(force) {
            const wanted = [...new Set([
                ...Object.keys(own).filter((path) => own[path].origin === "given"), ...Object.keys(serve.state.set), ...added,
            ])].filter((path) => !never.test(path) && rowOf(path));
            for (const [path, knob] of knobs)
                if (!wanted.includes(path)) { knob.box.remove(); knobs.delete(path); }
            for (const path of wanted) {
                const there = knobs.get(path), knob = there || make(path);
                if (!there) groupBox(path).append(knob.box);
                refresh(knob, force);
            }
            for (const group of [...box.children]) if (!group.querySelector(".knob")) group.remove();
        },
        // The server's words at the field of their key; false where there is none.
        showError(path, words) {
            let knob = path ? knobs.get(path) : undefined;
            if (!knob && path && rows.size && candidates().includes(path)) knob = add(path);
            if (!knob) return false;
            knob.field.setAttribute("aria-invalid", "true");
            knob.message.textContent = words;
            knob.message.hidden = false;
            knob.box.closest("details").open = true;
            return true;
        },
        clearErrors() {
            for (const knob of knobs.values()) {
                knob.field.removeAttribute("aria-invalid");
                knob.message.hidden = true;
                knob.message.textContent = "";
            }
        },
    };
})();
