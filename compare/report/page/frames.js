// Reads shapes over time: the bytes of frames.bin, docs/guide/frames.md.
"use strict";
function readFrames(bytes) {
    const view = new DataView(bytes.buffer);
    let at = 8;  // the magic
    const word = () => { const value = view.getUint32(at, true); at += 4; return value; };
    const number = () => { const value = view.getFloat64(at, true); at += 8; return value; };
    if (word() !== 1) throw new Error("frames of an unknown version");
    const shape = {nodes: word(), frames: []};
    const triangles = word(), cables = word(), frames = word();
    shape.payload = word();
    shape.triangles = new Uint32Array(3 * triangles);
    for (let i = 0; i < shape.triangles.length; ++i) shape.triangles[i] = word();
    shape.cables = [];
    for (let i = 0; i < cables; ++i) shape.cables.push({from: word(), to: word(), kind: view.getUint8(at++)});
    for (let i = 0; i < frames; ++i) {
        const frame = {time: number(), corner: [number(), number(), number()]};
        const step = number();
        frame.stressStep = number();
        // Relative to the payload: that is where the eye stays.
        const place = new Float32Array(3 * shape.nodes), origin = [];
        for (let k = 0; k < 3; ++k) origin.push(step * view.getUint16(at + 6 * shape.payload + 2 * k, true));
        for (let n = 0; n < place.length; ++n, at += 2) place[n] = step * view.getUint16(at, true) - origin[n % 3];
        frame.place = place;
        frame.stress = bytes.subarray(at, at += triangles);
        frame.folds = new Uint8Array(triangles);
        for (let t = 0; t < triangles; ++t) frame.folds[t] = bytes[at + (t >> 2)] >> (2 * (t & 3)) & 3;
        at += (triangles + 3) >> 2;
        shape.frames.push(frame);
    }
    return shape;
}
