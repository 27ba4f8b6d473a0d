// One thread a sorted particle: its Gaussian. Where it lies among others its shape follows how they lie (after Yu and Turk
// 2013): a disc along a surface, wider and thinner where a sheet spreads, longer and thinner in a thread; alone it is a drop.
// What lies loosely is widened until it closes; a clear liquid lets the more light through the less of it there is.

@group(0) @binding(0) var<storage, read> keys: array<u32>;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> spans: array<u32>;
@group(0) @binding(3) var<storage, read> sorted: array<vec4<u32>>;
/// Of each sorted particle, the mean light of what it has come to, and the middle of what lies around it.
@group(0) @binding(4) var<storage, read> blended: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> geometry: array<vec4<f32>>;
/// The first plane of spherical harmonics.
@group(0) @binding(6) var<storage, read_write> sh: array<vec4<f32>>;

// What lies around a particle, each by its volume and by how near it is. Lengths in reaches, of as many cells as were looked through.
struct Around {
    volume: f32,
    // Mean place, from the particle.
    middle: vec3<f32>,
    // Mean of d d^T about that.
    spread: mat3x3<f32>,
    colour: vec3<f32>,
    // Mean of the middles of what lies around them, in reaches of one cell: away from a surface.
    lean: vec3<f32>,
}

fn around(x: vec3<f32>, cells: i32) -> Around {
    let home = cell_of(x);
    let reach_m = f32(cells) * params.reach_m;
    let side = 2 * cells + 1;
    var volume = 0.0;
    var first = vec3(0.0);
    var square = vec3(0.0);
    var mixed = vec3(0.0);
    var light = vec3(0.0);
    var lit = 0.0;
    var lean = vec3(0.0);
    for (var c = 0; c < side * side * side; c++) {
        let cell = home + vec3(c % side, c / side % side, c / (side * side)) - vec3(cells);
        let key = key_of(cell);
        let start = spans[2u * key];
        let end = min(spans[2u * key + 1u], start + CROWD);
        for (var k = start; k < end; k++) {
            let there = bitcast<vec4<f32>>(sorted[2u * k]);
            let d = (there.xyz - x) / reach_m;
            let apart2 = dot(d, d);
            // Another cell may have the same key.
            if apart2 >= 1.0 || any(cell_of(there.xyz) != cell) {
                continue;
            }
            let w = cubed(1.0 - apart2) * cubed(there.w / reach_m);
            volume += w;
            first += w * d;
            square += w * d * d;
            mixed += w * d.yzx * d.zxy;
            let shines = (1.0 - apart2) * cubed(there.w / reach_m);
            light += shines * blended[2u * k].xyz;
            lit += shines;
            lean += w * blended[2u * k + 1u].xyz;
        }
    }
    let per = 1.0 / max(volume, 1e-20);
    let mean = first * per;
    let d = square * per - mean * mean;
    let o = mixed * per - mean.yzx * mean.zxy;
    return Around(volume, mean, mat3x3(d.x, o.z, o.y, o.z, d.y, o.x, o.y, o.x, d.z), sqrt(light / max(lit, 1e-20)), lean * per);
}

// What a particle looks like.
struct Look {
    // Square metres, of a radius of 1 m.
    covariance: mat3x3<f32>,
    // The way out, as long as it is sure.
    normal: vec3<f32>,
    // By how much it is drawn in, metres.
    inward: vec3<f32>,
    // Over that of a drop.
    thickness: f32,
    // Its radius over that of its volume.
    full: f32,
    // How many times farther apart than where they fill the room those of a body lie.
    loose: f32,
    // 0 alone.
    joined: f32,
    colour: vec3<f32>,
}

fn looked(size_m: f32, here: Around, cells: f32) -> Look {
    let reach_m = cells * params.reach_m;
    let own = cubed(size_m / reach_m) / here.volume;
    let axes = principal(here.spread);
    let joined = 1.0 - smoothstep(ALONE_LOW, ALONE_HIGH, own);
    // 0 in a thread, 1 in a sheet or a body.
    let broad = smoothstep(BROAD_LOW, BROAD_HIGH, sqrt(max(axes.values.y, 0.0) / max(axes.values.x, 1e-12)));
    let sheet = (1.0 - smoothstep(THIN_LOW, THIN_HIGH, max(axes.values.z, 0.0) / max(axes.values.y, 1e-12))) * broad * joined;

    // The way out: away from where what is around lies; in a sheet, across it.
    let off = length(here.middle);
    let leaning = length(here.lean);
    let outward = -here.lean / max(leaning, 1e-6);
    let skin = smoothstep(LEAN_LOW, LEAN_HIGH, leaning) * joined;
    let across = axes.least * select(-1.0, 1.0, dot(axes.least, outward) >= 0.0);
    let n = normalize(mix(outward, across, sheet) + vec3(1e-9, 0.0, 0.0));

    // What was thin has less volume than lies between its particles: among others each covers that. And how many times farther
    // apart they lie, along the thread or the sheet.
    let spare = max(params.spacing_m / size_m, 1.0);
    let apart = mix(THREAD * cells * own, cells * sqrt(SHEET * own), broad);
    let held = min(mix(1.0, max(apart, 1.0) * spare, mix(joined, sheet, broad)), WIDEST);
    let full = mix(1.0, spare, joined * (1.0 - sheet) * broad);
    // Half of the room around what is at a surface is empty.
    let gaps = clamp(cells * pow(BALL * own * (1.0 - 0.5 * skin), 1.0 / 3.0), 1.0, LOOSEST);
    let flat = 1.0 + (FLAT - 1.0) * max(skin, sheet);
    let across_r = mix(inverseSqrt(held), held, broad) * flat * full;
    let thickness = max(mix(inverseSqrt(held), 1.0 / (held * held), broad), THINNEST);
    let thin_r = thickness * full / flat;
    let t = axes.most;
    let along = mat3x3(t * t.x, t * t.y, t * t.z);
    let through = mat3x3(n * n.x, n * n.y, n * n.z);
    let unit = mat3x3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let longer = max(held * held - across_r * across_r, 0.0) * (1.0 - broad) * joined;
    let c = unit * (across_r * across_r) - through * (across_r * across_r - thin_r * thin_r) + along * longer;
    let inward = here.middle * (reach_m * EVEN * max(1.0 - SKIN / max(off, 1e-6), 0.0) * joined);
    return Look(c, n * max(skin, sheet), inward, thickness, full, mix(1.0, gaps, joined * (1.0 - sheet) * broad), joined, here.colour);
}

// Where few are near, those that are farther off count too, the more the fewer are near: a sheet one particle thick
// stays one while they part.
fn look(x: vec3<f32>, size_m: f32) -> Look {
    let here = around(x, 1);
    let near = looked(size_m, here, 1.0);
    let few = smoothstep(FEW_LOW, FEW_HIGH, cubed(size_m / params.reach_m) / here.volume);
    if few == 0.0 {
        return near;
    }
    let far = looked(size_m, around(x, 2), 2.0);
    return Look(
        near.covariance * (1.0 - few) + far.covariance * few,
        mix(near.normal, far.normal * select(-1.0, 1.0, dot(near.normal, far.normal) >= 0.0), few),
        mix(near.inward, far.inward, few),
        mix(near.thickness, far.thickness, few),
        mix(near.full, far.full, few),
        mix(near.loose, far.loose, few),
        mix(near.joined, far.joined, few),
        mix(near.colour, far.colour, few),
    );
}

// Of what is seen of a particle, the Gaussian `slot`.
fn put(g: u32, slot: u32, x: vec3<f32>, opacity: f32, c: mat3x3<f32>, normal: vec3<f32>, gloss: f32, colour: vec3<f32>) {
    let at = g + slot * params.count;
    geometry[4u * at] = vec4(x, opacity);
    geometry[4u * at + 1u] = vec4(c[0].x, c[0].y, c[0].z, c[1].y);
    geometry[4u * at + 2u] = vec4(c[1].z, c[2].z, 1.0, 1.0 + gloss);
    geometry[4u * at + 3u] = vec4(normal, 0.0);
    sh[at] = vec4((colour - 0.5) / SH_FIRST, 0.0);
}

fn hide(g: u32, first: u32, x: vec3<f32>) {
    for (var slot = first; slot < params.grains; slot++) {
        geometry[4u * (g + slot * params.count)] = vec4(x, 0.0);
    }
}

// Grains stay round and do not mix. Each is a little lighter or darker, larger or smaller than the next, and none lies on a
// lattice: those of a particle lie around it, as far as its neighbours are, and along a surface.
fn put_grains(i: u32, own: vec4<f32>, colour: vec3<f32>, seen: Look, radius_m: f32, parted: f32, opacity: f32) {
    let apart = max(seen.loose, inverseSqrt(seen.thickness));
    let share = pow(f32(params.grains), -1.0 / 3.0);
    for (var slot = 0u; slot < params.grains; slot++) {
        let word = i + slot * params.count;
        let size = mix(GRAINS_LOW, GRAINS_HIGH, chance(stirred(word + 0x9e3779b9u)));
        var astray = vec3(chance(stirred(3u * word)), chance(stirred(3u * word + 1u)), chance(stirred(3u * word + 2u))) * 2.0 - 1.0;
        astray -= seen.normal * dot(seen.normal, astray);
        let r = GRAIN * share * size * seen.full * radius_m;
        let c = mat3x3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0) * (r * r);
        let tone = 1.0 + TONE * (2.0 * chance(stirred(word)) - 1.0);
        put(params.first + i, slot, own.xyz + astray * (ASTRAY * apart * own.w * parted), opacity, c, seen.normal, 0.0, colour * tone);
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if k >= params.count {
        return;
    }
    let g = params.first + order[k];
    if keys[k] > params.mask {
        hide(g, 0u, vec3(0.0));
        return;
    }
    let own = bitcast<vec4<f32>>(sorted[2u * k]);
    let mine = bitcast<vec3<f32>>(sorted[2u * k + 1u].xyz);
    let state = unpack2x16float(sorted[2u * k + 1u].w);
    if state.x <= 0.0 {
        hide(g, 0u, own.xyz);
        return;
    }
    let kind = u32(state.y + 0.25);
    let clear = clamp(2.0 * (state.y - 3.0), 0.0, 1.0);
    let seen = look(own.xyz, own.w);
    let radius_m = RADIUS * own.w * mix(YOUNG, 1.0, state.x);
    // What is wholly seen is wholly mixed.
    let shown = smoothstep(0.0, SEEN, state.x);
    if kind == 1u {
        put_grains(order[k], own, mine, seen, radius_m, state.x, OPACITY * shown);
        return;
    }
    // A clear one is wide, so that many lie over each other and none shows; alone it is a small bright drop.
    let wide = mix(seen.loose, mix(DROP_SIZE, WIDER, seen.joined), clear);
    let dimmed = 1.0 - exp(-own.w * seen.thickness / FREE_M);
    let opacity = shown * mix(OPACITY, mix(DROP_OPACITY, dimmed, seen.joined), clear);
    // What is mirrored adds to what passes, however little of the rest is seen.
    let gloss = mix(select(GLOSS_LIQUID, GLOSS_PASTE, kind == 2u), GLOSS_CLEAR / (1.0 - exp(-LAYERED * dimmed)), clear);
    let colour = mix(mix(mine, seen.colour, shown), vec3(1.0), clear * mix(DROP_PALE, PALE, seen.joined));
    put(g, 0u, own.xyz + seen.inward, opacity, seen.covariance * (radius_m * radius_m * wide * wide), seen.normal, gloss, colour);
    hide(g, 1u, own.xyz);
}
