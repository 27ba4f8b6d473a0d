// Front to back blending for devices where barriers are dear: a thread owns 4 x 8 pixels, in eight rows
// of a vec4, and walks its bin's splats without a branch on any one pixel.
// A pixel that has ended keeps its transmittance with the sign turned.

struct Row {
    transmittance: vec4<f32>,
    red: vec4<f32>,
    green: vec4<f32>,
    blue: vec4<f32>,
    depth: vec4<f32>,
    weight: vec4<f32>,     // the largest so far, with WITH_ID
    heaviest: vec4<u32>,
}

fn fresh() -> Row {
    let zero = vec4<f32>(0.0);
    return Row(vec4<f32>(1.0), zero, zero, zero, zero, zero, vec4<u32>(NOTHING));
}

fn blend(row: ptr<function, Row>, shape: vec4<f32>, weight: vec4<f32>, colour: vec4<f32>, g: u32, x: vec4<f32>, y: f32) {
    let dx = x - shape.x;
    let dy = y - shape.y;
    let e = weight.y - (shape.z * dx * dx + weight.x * dy * dy + shape.w * dx * dy);
    let drawn = min(exp2(e), vec4<f32>(frame.opacity_cap));
    let alpha = select(vec4<f32>(0.0), drawn, e >= vec4<f32>(frame.alpha_min_log2));
    let t = (*row).transmittance;
    let next = t * (1.0 - alpha);
    let ended = next <= vec4<f32>(frame.stop);
    let w = select(t * alpha, vec4<f32>(0.0), ended);
    (*row).transmittance = select(next, -abs(t), ended);
    (*row).red += w * colour.x;
    (*row).green += w * colour.y;
    (*row).blue += w * colour.z;
    if (WITH_DEPTH) { (*row).depth += w * colour.w; }
    if (WITH_ID) {
        let heavier = w > (*row).weight;
        (*row).weight = select((*row).weight, w, heavier);
        (*row).heaviest = select((*row).heaviest, vec4<u32>(g), heavier);
    }
}

fn finish_row(row: Row, at: vec2<u32>) {
    for (var k = 0u; k < 4u; k++) {
        let colour = vec3<f32>(row.red[k], row.green[k], row.blue[k]);
        finish(at + vec2<u32>(k, 0u), colour, abs(row.transmittance[k]), row.depth[k], row.heaviest[k]);
    }
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let bin = group.y * frame.bins.x + group.x;
    let block = vec2<u32>(local % (BIN / 4u), local / (BIN / 4u));
    let at = group.xy * BIN + block * vec2<u32>(4u, 8u);
    let x = vec4<f32>(f32(at.x)) + vec4<f32>(0.5, 1.5, 2.5, 3.5);
    let y = f32(at.y) + 0.5;
    var r0 = fresh(); var r1 = fresh(); var r2 = fresh(); var r3 = fresh();
    var r4 = fresh(); var r5 = fresh(); var r6 = fresh(); var r7 = fresh();
    let end = starts[bin + 1u];
    for (var i = starts[bin]; i < end; i++) {
        let g = order[i];
        let shape = splats[g].shape;
        let weight = splats[g].weight;
        let colour = splats[g].colour;
        blend(&r0, shape, weight, colour, g, x, y);
        blend(&r1, shape, weight, colour, g, x, y + 1.0);
        blend(&r2, shape, weight, colour, g, x, y + 2.0);
        blend(&r3, shape, weight, colour, g, x, y + 3.0);
        blend(&r4, shape, weight, colour, g, x, y + 4.0);
        blend(&r5, shape, weight, colour, g, x, y + 5.0);
        blend(&r6, shape, weight, colour, g, x, y + 6.0);
        blend(&r7, shape, weight, colour, g, x, y + 7.0);
        let live = max(max(max(r0.transmittance, r1.transmittance), max(r2.transmittance, r3.transmittance)),
            max(max(r4.transmittance, r5.transmittance), max(r6.transmittance, r7.transmittance)));
        if (all(live < vec4<f32>(0.0))) { break; }
    }
    finish_row(r0, at);
    finish_row(r1, at + vec2<u32>(0u, 1u));
    finish_row(r2, at + vec2<u32>(0u, 2u));
    finish_row(r3, at + vec2<u32>(0u, 3u));
    finish_row(r4, at + vec2<u32>(0u, 4u));
    finish_row(r5, at + vec2<u32>(0u, 5u));
    finish_row(r6, at + vec2<u32>(0u, 6u));
    finish_row(r7, at + vec2<u32>(0u, 7u));
}
