// The canopy of a full run as it opens: each frame as it comes, seen from the side, drawn by hand; z up, the payload at rest.
"use strict";
serve.shape = (function () {
    const section = document.getElementById("shape"), canvas = document.getElementById("shape-canvas"), slider = document.getElementById("shape-time");
    const staticLine = 5, lines = 3;  // kinds of cables: docs/guide/frames.md
    const shades = 5;
    let shape = null, around = 0.5, up = 0.15, follows = true, drawn = [];

    // Bounds of all frames so far, but for a static line that leads far away.
    function extent() {
        let radius = 0.1, low = 0, high = 0.1;
        for (const frame of shape.frames)
            for (const node of drawn) {
                radius = Math.max(radius, Math.hypot(frame.place[3 * node], frame.place[3 * node + 1]));
                low = Math.min(low, frame.place[3 * node + 2]);
                high = Math.max(high, frame.place[3 * node + 2]);
            }
        return {radius: radius, low: low, high: high};
    }

    function draw() {
        if (!shape || section.hidden) return;
        const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
        canvas.width = Math.round(ratio * width);
        canvas.height = Math.round(ratio * height);
        const frame = shape.frames[Number(slider.value)], context = canvas.getContext("2d"), bounds = extent();
        const reach = Math.max(bounds.high - bounds.low, 2 * bounds.radius), middle = 0.5 * (bounds.high + bounds.low);
        const scale = 0.92 * Math.min(width / Math.max(2 * bounds.radius, 0.4 * reach), height / reach);
        const [ca, sa, cu, su] = [Math.cos(around), Math.sin(around), Math.cos(up), Math.sin(up)];
        const x = new Float32Array(shape.nodes), y = new Float32Array(shape.nodes), near = new Float32Array(shape.nodes);
        for (let n = 0; n < shape.nodes; ++n) {
            const east = frame.place[3 * n], north = frame.place[3 * n + 1], height_of = frame.place[3 * n + 2] - middle;
            const away = north * ca - east * sa;
            x[n] = 0.5 * width + scale * (east * ca + north * sa);
            y[n] = 0.5 * height - scale * (height_of * cu + away * su);
            near[n] = height_of * su - away * cu;
        }
        context.scale(ratio, ratio);
        context.clearRect(0, 0, width, height);
        const t = shape.triangles, order = [];
        for (let k = 0; k < t.length; k += 3) order.push([near[t[k]] + near[t[k + 1]] + near[t[k + 2]], k]);
        order.sort((a, b) => a[0] - b[0]);
        const fabric = Array.from({length: shades}, (_, i) => shared.colour("fabric-" + i));
        // Lines hang below the fabric, which hides their upper ends from most sides: they are drawn first.
        context.strokeStyle = shared.colour("line");
        context.lineWidth = 0.8;
        context.beginPath();
        for (const cable of shape.cables) {
            if (cable.kind < lines) continue;
            context.moveTo(x[cable.from], y[cable.from]);
            context.lineTo(x[cable.to], y[cable.to]);
        }
        context.stroke();
        for (const [, k] of order) {
            const [a, b, c] = [t[k], t[k + 1], t[k + 2]];
            // Lit from the eye: the share of its area that is seen says how it is turned.
            const seen = Math.abs((x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])) / (scale * scale);
            const u = [0, 1, 2].map((i) => frame.place[3 * b + i] - frame.place[3 * a + i]), v = [0, 1, 2].map((i) => frame.place[3 * c + i] - frame.place[3 * a + i]);
            const area = Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) || 1;
            context.fillStyle = context.strokeStyle = fabric[Math.min(shades - 1, Math.floor(shades * seen / area))];
            context.lineWidth = 0.5;
            context.beginPath();
            context.moveTo(x[a], y[a]);
            context.lineTo(x[b], y[b]);
            context.lineTo(x[c], y[c]);
            context.closePath();
            context.fill();
            context.stroke();  // no seams of background between triangles
        }
        context.fillStyle = shared.colour("ink");
        context.beginPath();
        context.arc(x[shape.payload], y[shape.payload], 4, 0, 2 * Math.PI);
        context.fill();
        const words = frame.time.toFixed(2) + " s";
        document.getElementById("shape-words").textContent = words + " since release";
        slider.setAttribute("aria-valuetext", words);
    }

    slider.addEventListener("input", () => { follows = Number(slider.value) === Number(slider.max); draw(); });
    const turn = (sideways, upward) => { around += sideways; up = Math.min(1.5, Math.max(-1.5, up + upward)); draw(); };
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => { if (event.buttons) turn(-0.01 * event.movementX, 0.01 * event.movementY); });
    const keys = {ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]};
    canvas.addEventListener("keydown", (event) => {
        if (!keys[event.key]) return;
        event.preventDefault();
        turn(...keys[event.key]);
    });
    new ResizeObserver(draw).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);

    return {
        // The shapes of a run so far; null: there are none to show.
        set(made) {
            shape = made && made.frames.length ? made : null;
            section.hidden = !shape;
            if (!shape) { follows = true; return; }
            const nodes = new Set(shape.triangles);
            for (const cable of shape.cables) if (cable.kind !== staticLine) nodes.add(cable.from).add(cable.to);
            drawn = [...nodes];
            slider.max = shape.frames.length - 1;
            if (follows) slider.value = slider.max;
            draw();
        },
        frames: () => (shape ? shape.frames.length : 0),
    };
})();
