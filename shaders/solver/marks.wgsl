// What a particle gives to the grid beside mass and momentum: marks of what it touches.

struct Near {
    mark: u32,
    normal: vec3<f32>,
}

// The mark of the nearest of a span of colliders, 0 where none is in reach.
fn nearest(first: u32, end: u32, x: vec3<f32>, rest_m: f32, shears: bool) -> Near {
    var near = Near(0u, vec3<f32>(0.0));
    for (var c = first; c < end; c++) {
        let t = touch(colliders[c], x);
        if (t.distance_m > params.reach_m + REST_CELLS_MAX * params.cell_m) {
            continue;
        }
        let gap_m = t.distance_m - rest_m;
        if (gap_m < params.reach_m) {
            // Without a shear modulus there is no Coulomb friction either.
            let slips = select(SLIPS, 0u, shears);
            let mark = pack_mark(gap_m, (c * 8u + t.face) | slips);
            if (mark > near.mark) {
                near = Near(mark, surface_normal(colliders[c], t.face, x));
            }
        }
    }
    return near;
}

// The mark on a node `d` cells away. Only the nodes beside and below the particle carry its contact: those
// above it are the body's own, and the layer that they would stiffen is half a cell thinner without them.
// Those above a liquid or a paste are told that it is there: a mark from out of reach stops nothing.
fn mark_on(near: Near, d: vec3<f32>) -> u32 {
    if (near.mark == 0u || dot(near.normal, d) <= 0.5) {
        return near.mark;
    }
    let told = (near.mark & SLIPS) != 0u || params.wet_layers != 0u;
    return select(0u, pack_mark(params.reach_m, near.mark & 2047u), told);
}
