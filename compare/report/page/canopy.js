// The opening in three dimensions: fabric coloured by stress or wrinkling, lines, payload; z up, the payload at rest.
"use strict";
(function () {
    const stage = document.getElementById("stage"), canvas = document.getElementById("canopy");
    if (!stage) return;
    let renderer;
    try {
        if (!document.createElement("canvas").getContext("webgl")) return;  // asked before, so that nothing is logged
        stage.hidden = false;
        renderer = new THREE.WebGLRenderer({canvas: canvas, antialias: true, alpha: true});
    } catch (error) {
        stage.hidden = true;
        return;
    }
    document.getElementById("no-canopy").remove();

    const shape = readFrames(Uint8Array.from(atob(document.getElementById("report-frames").textContent), (c) => c.charCodeAt(0)));
    const zero = report.data.frameZero, times = shape.frames.map((frame) => frame.time - zero);
    const first = times[0], last = times[times.length - 1];
    const count = shape.triangles.length / 3;
    const place = new Float32Array(3 * shape.nodes);  // now

    // Fabric: each triangle has its own corners, so that it has its own colour; normals are those of the nodes.
    const fabric = new THREE.BufferGeometry();
    const corners = new Float32Array(9 * count), normals = new Float32Array(9 * count), colours = new Float32Array(9 * count);
    const nodeNormals = new Float32Array(3 * shape.nodes);
    fabric.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    fabric.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    fabric.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    const fabricMesh = new THREE.Mesh(fabric, new THREE.MeshLambertMaterial({
        vertexColors: THREE.VertexColors, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}));
    const tapeKinds = 3, staticLine = 5;  // kinds of cables: docs/guide/frames.md
    function segments(wanted, opacity) {
        const ends = shape.cables.filter((cable) => wanted(cable.kind));
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(6 * ends.length), 3));
        const drawn = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({transparent: true, opacity: opacity}));
        drawn.userData.ends = ends;
        return drawn;
    }
    const tapes = segments((kind) => kind < tapeKinds, 0.35), lines = segments((kind) => kind >= tapeKinds, 0.8);
    // What the view has room for: all frames, but for a static line that leads far away.
    const low = [0, 0, 0], high = [0, 0, 0], drawn = new Set(shape.triangles);
    for (const cable of shape.cables) if (cable.kind !== staticLine) drawn.add(cable.from).add(cable.to);
    for (const frame of shape.frames)
        for (const node of drawn)
            for (let k = 0; k < 3; ++k) {
                low[k] = Math.min(low[k], frame.place[3 * node + k]);
                high[k] = Math.max(high[k], frame.place[3 * node + k]);
            }
    const reach = Math.max(1, Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]));
    const payload = new THREE.Mesh(new THREE.SphereGeometry(0.014 * reach, 24, 16), new THREE.MeshLambertMaterial({color: 0x555b61}));
    const scene = new THREE.Scene();
    const sky = new THREE.HemisphereLight(0xffffff, 0x8a8f96, 0.85), sun = new THREE.DirectionalLight(0xffffff, 0.35);
    for (const part of [fabricMesh, tapes, lines, payload]) { part.frustumCulled = false; scene.add(part); }
    scene.add(sky);
    const camera = new THREE.PerspectiveCamera(32, 2, 0.05 * reach, 40 * reach);
    camera.up.set(0, 0, 1);
    camera.add(sun);
    scene.add(camera);
    sky.position.set(0, 0, 1);
    sun.position.set(-0.6, 0.8, 0.4);
    const orbit = new THREE.OrbitControls(camera, canvas);
    orbit.enableKeys = false;
    orbit.minDistance = 0.2 * reach;
    orbit.maxDistance = 8 * reach;
    orbit.addEventListener("change", draw);
    // The wheel scrolls the page; with a key held, or on a focused canvas, it comes closer.
    orbit.enableZoom = false;
    canvas.addEventListener("focus", () => { orbit.enableZoom = true; });
    canvas.addEventListener("blur", () => { orbit.enableZoom = false; });

    // Dark blue over teal to yellow: rising in lightness for every kind of colour vision, and in grey.
    const ramp = [[0.15, 0.2, 0.42], [0.15, 0.44, 0.56], [0.24, 0.64, 0.5], [0.66, 0.79, 0.3], [0.99, 0.9, 0.35]];
    const foldColours = [[0.62, 0.65, 0.69], [0.9, 0.62, 0.0], [0.0, 0.45, 0.7]];
    const foldNames = ["slack", "wrinkled", "taut"];
    // The largest stress of all frames but for its last half per cent: a single spike would turn all else blue.
    const most = (function () {
        let all = [];
        for (const frame of shape.frames) {
            const sorted = Uint8Array.from(frame.stress).sort();
            all.push(frame.stressStep * sorted[Math.floor(0.995 * (sorted.length - 1))]);
        }
        return Math.max(...all, 1e-9);
    })();
    function stressColour(share) {
        const x = Math.min(1, Math.max(0, share)) * (ramp.length - 1), i = Math.min(ramp.length - 2, Math.floor(x)), w = x - i;
        return [0, 1, 2].map((k) => (1 - w) * ramp[i][k] + w * ramp[i + 1][k]);
    }

    let colouring = "stress", now = first, playing = false, begun = 0, from = 0;

    // Wrinkling by triangles; stress as means at the nodes, since it is constant in a triangle and jumps between them.
    const nodeStress = new Float32Array(shape.nodes), touching = new Float32Array(shape.nodes);
    for (const node of shape.triangles) ++touching[node];
    function paint(a, b, w) {
        if (colouring === "folds") {
            const folds = (w < 0.5 ? a : b).folds;
            for (let c = 0; c < colours.length; ++c) colours[c] = foldColours[folds[Math.floor(c / 9)]][c % 3];
            return;
        }
        nodeStress.fill(0);
        shape.triangles.forEach((node, k) => {
            const t = Math.floor(k / 3);
            nodeStress[node] += ((1 - w) * a.stressStep * a.stress[t] + w * b.stressStep * b.stress[t]) / touching[node];
        });
        shape.triangles.forEach((node, k) => colours.set(stressColour(nodeStress[node] / most), 3 * k));
    }

    function shapeAt(time) {
        const i = Math.min(shared.placeOf(times, time), times.length - 2), low = Math.max(0, i);
        const a = shape.frames[low], b = shape.frames[Math.min(low + 1, shape.frames.length - 1)];
        const span = b.time - a.time, w = span > 0 ? Math.min(1, Math.max(0, (time - times[low]) / span)) : 0;
        for (let n = 0; n < place.length; ++n) place[n] = (1 - w) * a.place[n] + w * b.place[n];
        nodeNormals.fill(0);
        const t = shape.triangles;
        for (let k = 0; k < t.length; k += 3) {
            const p = 3 * t[k], q = 3 * t[k + 1], r = 3 * t[k + 2];
            const ux = place[q] - place[p], uy = place[q + 1] - place[p + 1], uz = place[q + 2] - place[p + 2];
            const vx = place[r] - place[p], vy = place[r + 1] - place[p + 1], vz = place[r + 2] - place[p + 2];
            const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
            for (const node of [p, q, r]) { nodeNormals[node] += nx; nodeNormals[node + 1] += ny; nodeNormals[node + 2] += nz; }
        }
        for (let k = 0; k < t.length; ++k) {
            const node = 3 * t[k], at = 3 * k;
            const size = Math.hypot(nodeNormals[node], nodeNormals[node + 1], nodeNormals[node + 2]) || 1;
            for (let c = 0; c < 3; ++c) {
                corners[at + c] = place[node + c];
                normals[at + c] = nodeNormals[node + c] / size;
            }
        }
        paint(a, b, w);
        for (const name of ["position", "normal", "color"]) fabric.attributes[name].needsUpdate = true;
        for (const drawn of [tapes, lines]) {
            const array = drawn.geometry.attributes.position.array;
            drawn.userData.ends.forEach((cable, k) => {
                for (let c = 0; c < 3; ++c) {
                    array[6 * k + c] = place[3 * cable.from + c];
                    array[6 * k + 3 + c] = place[3 * cable.to + c];
                }
            });
            drawn.geometry.attributes.position.needsUpdate = true;
        }
    }

    function draw() { renderer.render(scene, camera); }
    const scrub = document.getElementById("scrub"), words = document.getElementById("scrub-time");
    function setTime(time, source) {
        now = Math.min(last, Math.max(first, time));
        shapeAt(now);
        draw();
        scrub.value = last > first ? Math.round(1000 * (now - first) / (last - first)) : 0;
        const text = now.toFixed(2).replace("-", "\u2212") + " s";
        words.textContent = text;
        scrub.setAttribute("aria-valuetext", text);
        if (source !== "charts") report.setTime(now, "canopy");
    }

    const play = document.getElementById("play"), pace = document.getElementById("pace");
    // It plays the opening: from the snatch (or line stretch), zero of the clock, until all of it is seen; then,
    // or from wherever the reader has put the time, to the end.
    const snatch = Math.min(last, Math.max(first, 0)), opened = Math.min(last, Math.max(snatch, report.data.openingEnd));
    let chosen = false, until = opened;
    function setPlaying(wanted) {
        playing = wanted;
        play.textContent = playing ? "Pause" : "Play";
        play.setAttribute("aria-pressed", String(playing));
        if (!playing) return;
        if (!chosen || now >= last) now = snatch;
        chosen = true;
        until = now < opened ? opened : last;
        begun = performance.now();
        from = now;
        requestAnimationFrame(step);
    }
    function step(time) {
        if (!playing) return;
        const then = Math.min(until, from + Math.max(0, time - begun) / 1000 * Number(pace.value));
        setTime(then, "play");
        if (then >= until) setPlaying(false); else requestAnimationFrame(step);
    }
    play.addEventListener("click", () => setPlaying(!playing));
    pace.addEventListener("change", () => { begun = performance.now(); from = now; });
    scrub.addEventListener("input", () => { setPlaying(false); chosen = true; setTime(first + (last - first) * scrub.value / 1000, "scrub"); });
    report.onTime((time, source) => { if (source === "charts") { setPlaying(false); chosen = true; setTime(time, "charts"); } });

    const legend = document.getElementById("legend");
    function setColouring(wanted) {
        colouring = wanted;
        legend.textContent = "";
        if (colouring === "stress") {
            const bar = document.createElement("span"), ends = document.createElement("span");
            bar.className = "ramp";
            bar.style.background = "linear-gradient(90deg," + ramp.map((c) => "rgb(" + c.map((x) => Math.round(255 * x)) + ")") + ")";
            ends.className = "ends";
            for (const end of ["0", shared.readable(Number((most * report.data.stress.factor).toPrecision(2)), report.data.stress.unit)]) ends.append(Object.assign(document.createElement("span"), {textContent: end}));
            legend.append("first principal stress resultant", bar, ends);
        } else {
            foldNames.forEach((name, i) => {
                const swatch = document.createElement("span");
                swatch.className = "swatch";
                swatch.style.background = "rgb(" + foldColours[i].map((x) => Math.round(255 * x)) + ")";
                legend.append(swatch, name);
            });
        }
        shapeAt(now);
        draw();
    }
    const colour = document.getElementById("colour");
    colour.addEventListener("change", () => setColouring(colour.value));

    // Seen from a little above.
    function home() {
        const middle = [0, 1, 2].map((k) => 0.5 * (low[k] + high[k]));
        const height = Math.max(high[2] - low[2], Math.hypot(high[0] - low[0], high[1] - low[1]) / Math.max(1, camera.aspect));
        const distance = 0.55 * height / Math.tan(camera.fov * Math.PI / 360) + 0.2 * height;
        orbit.target.set(...middle);
        camera.position.set(middle[0] + 0.35 * distance, middle[1] - 0.9 * distance, middle[2] + 0.22 * distance);
        orbit.update();
    }
    function turn(around, up) {
        const arm = camera.position.clone().sub(orbit.target), spherical = new THREE.Spherical().setFromVector3(new THREE.Vector3(arm.x, arm.z, -arm.y));
        spherical.theta += around;
        spherical.phi = Math.min(Math.PI - 0.05, Math.max(0.05, spherical.phi + up));
        const turned = new THREE.Vector3().setFromSpherical(spherical);
        camera.position.set(turned.x, -turned.z, turned.y).add(orbit.target);
        orbit.update();
        draw();
    }
    function closer(factor) {
        camera.position.sub(orbit.target).multiplyScalar(factor).add(orbit.target);
        orbit.update();
        draw();
    }
    const keys = {ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1),
                  "+": () => closer(0.9), "=": () => closer(0.9), "-": () => closer(1.1), " ": () => setPlaying(!playing)};
    canvas.addEventListener("keydown", (event) => {
        if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        keys[event.key]();
    });
    document.getElementById("home").addEventListener("click", () => { home(); draw(); });

    function fit() {
        const width = canvas.clientWidth, height = canvas.clientHeight;
        if (!width || !height) return;
        renderer.setPixelRatio(window.devicePixelRatio);
        renderer.setSize(width, height, false);
        camera.aspect = width / height;
        camera.updateProjectionMatrix();
        draw();
    }
    new ResizeObserver(fit).observe(canvas);
    report.onScheme(() => {
        const line = new THREE.Color(shared.colour("line")), ink = new THREE.Color(shared.colour("ink"));
        lines.material.color = line;
        tapes.material.color = ink;
        payload.material.color = ink;
        draw();
    });
    setColouring("stress");
    fit();
    home();
    setTime(report.time === undefined ? first : report.time, "charts");
    report.canopy = {draw: draw, setTime: setTime, first: first, last: last, snatch: snatch, opened: opened, canvas: canvas};
})();
