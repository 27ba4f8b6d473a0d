// How much light reaches a point. Each layer above it hides the share of the cone of light that the
// layer covers where the cone passes: the layer, blurred by the cone's radius there. So contact is
// dark and tight, and what rises casts wide and faint.

fn level_start(level: u32) -> u32 {
    var start = 0u;
    for (var l = 0u; l < level; l++) {
        start += (SIDE >> l) * (SIDE >> l);
    }
    return start;
}

/// Coverage at a place, in texels of level 0, through a quadratic B-spline of one level's texels.
fn smooth_at(layer: u32, level: u32, place: vec2<f32>) -> f32 {
    let side = i32(SIDE >> level);
    let start = layer * PYRAMID_SIZE + level_start(level);
    let s = place / f32(1u << level);
    let cell = vec2<i32>(floor(s));
    let f = s - floor(s) - 0.5;
    var sum = 0.0;
    for (var k = 0; k < 9; k++) {
        let tap = vec2(k % 3, k / 3);
        let p = cell + tap - 1;
        if all(p >= vec2(0)) && all(p < vec2(side)) {
            sum += spline(f.x, tap.x) * spline(f.y, tap.y) * pyramid[start + u32(p.y * side + p.x)];
        }
    }
    return sum;
}

/// Coverage blurred to a standard deviation in texels. Level l has 2^l / sqrt(2) of it.
fn blurred(layer: u32, place: vec2<f32>, sigma: f32) -> f32 {
    let level = clamp(log2(max(sigma * 1.4142135, 1.0)), 0.0, f32(LEVELS - 1u));
    let lower = min(u32(level), LEVELS - 2u);
    return mix(smooth_at(layer, lower, place), smooth_at(layer, lower + 1u, place), level - f32(lower));
}

/// 1 where one cell of a slot's static surface lets light through to a height, 0 far below the surface.
fn cell_open(map: Map, slot: u32, cell: vec2<i32>, z: f32) -> f32 {
    if any(cell < vec2(0)) || any(cell >= vec2(i32(ROOF_SIDE))) {
        return 1.0;
    }
    let top = roof[(slot * ROOF_SIDE + u32(cell.y)) * ROOF_SIDE + u32(cell.x)];
    if top == 0u {
        return 1.0;
    }
    // Within a cell a surface is not level.
    let cell_m = map.texel * ROOF_TEXELS;
    return 1.0 - smoothstep(0.5, 1.0, (from_ordered(top) - z) / clamp(0.5 * map.height, 0.5 * cell_m, cell_m));
}

/// That of the four cells around a place, in cells.
fn slot_open(map: Map, slot: u32, place: vec2<f32>, z: f32) -> vec4<f32> {
    let cell = vec2<i32>(floor(place));
    return vec4(
        cell_open(map, slot, cell, z),
        cell_open(map, slot, cell + vec2(1, 0), z),
        cell_open(map, slot, cell + vec2(0, 1), z),
        cell_open(map, slot, cell + vec2(1, 1), z),
    );
}

/// The factor on the colour of a point: 1 in full light, 1 - DARKNESS where nothing of it arrives.
fn shade_at(map: Map, p: vec3<f32>) -> f32 {
    let place = (p.xy - map.origin) / map.texel;
    let edge = min(min(place.x, place.y), f32(SIDE) - max(place.x, place.y)) / (f32(SIDE) * MAP_EDGE);
    if edge <= 0.0 {
        return 1.0;
    }
    let cells = (p.xy - map.origin) / (map.texel * ROOF_TEXELS) - 0.5;
    let f = cells - floor(cells);
    let share = vec4(1.0 - f.x, f.x, 1.0 - f.x, f.x) * vec4(vec2(1.0 - f.y), vec2(f.y));
    // What lies below a static surface has lost the light of the layers above that already.
    var open = slot_open(map, 0u, cells, p.z);
    // Layers that hide different parts of the cone multiply; layers that hide the same part count
    // once. A thing's layers lie between the two, and so does the mean.
    var apart = 1.0;
    var together = 1.0;
    for (var layer = 0u; layer < LAYERS; layer++) {
        let bottom = boundary(map, layer);
        let top = boundary(map, layer + 1u);
        let above = clamp((top - p.z) / (top - bottom), 0.0, 1.0);
        if above <= 0.0 {
            continue;
        }
        open = min(open, slot_open(map, layer + 1u, cells, p.z));
        // The last level is one number: what the whole layer covers.
        if pyramid[(layer + 1u) * PYRAMID_SIZE - 1u] > 0.0 {
            let rise = 0.5 * (top + max(bottom, p.z)) - p.z;
            let passed = 1.0 - above * dot(open, share) * blurred(layer, place, SPREAD * rise / map.texel);
            apart *= passed;
            together = min(together, passed);
        }
    }
    let light = sqrt(apart * together);
    return 1.0 - DARKNESS * (1.0 - light) * smoothstep(0.0, 1.0, edge);
}
