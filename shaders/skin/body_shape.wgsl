// One thread a sorted particle: its Gaussian. Where it lies among others its shape follows how they lie (after Yu and Turk
// 2013): a disc along a surface, wider and thinner where a sheet spreads, longer and thinner in a thread; alone it is a drop.
// None covers more than its volume.

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
            light += w * blended[2u * k].xyz;
            lean += w * blended[2u * k + 1u].xyz;
        }
    }
    let per = 1.0 / max(volume, 1e-20);
    let mean = first * per;
    let d = square * per - mean * mean;
    let o = mixed * per - mean.yzx * mean.zxy;
    return Around(volume, mean, mat3x3(d.x, o.z, o.y, o.z, d.y, o.x, o.y, o.x, d.z), sqrt(light * per), lean * per);
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
    colour: vec3<f32>,
}

fn looked(size_m: f32, here: Around, cells: f32) -> Look {
    let reach_m = cells * params.reach_m;
    let own = cubed(size_m / reach_m) / here.volume;
    let axes = principal(here.spread);
    // 0 alone.
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
    return Look(c, n * max(skin, sheet), inward, thickness, full, here.colour);
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
        mix(near.colour, far.colour, few),
    );
}

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if k >= params.count {
        return;
    }
    let g = params.first + order[k];
    if keys[k] > params.mask {
        geometry[4u * g] = vec4(0.0);
        return;
    }
    let own = bitcast<vec4<f32>>(sorted[2u * k]);
    let mine = bitcast<vec3<f32>>(sorted[2u * k + 1u].xyz);
    let state = unpack2x16float(sorted[2u * k + 1u].w);
    if state.x <= 0.0 {
        geometry[4u * g] = vec4(own.xyz, 0.0);
        return;
    }
    let kind = u32(state.y + 0.5);
    let seen = look(own.xyz, own.w);
    let radius_m = RADIUS * own.w * mix(YOUNG, 1.0, state.x);
    var x = own.xyz + seen.inward;
    var c = seen.covariance * (radius_m * radius_m);
    // What is wholly seen is wholly mixed.
    let shown = smoothstep(0.0, SEEN, state.x);
    var colour = mix(mine, seen.colour, shown);
    var gloss = GLOSS_PASTE;
    var opacity = OPACITY * shown;
    if kind == 3u {
        gloss = GLOSS_LIQUID;
        opacity *= 1.0 - CLEAR * max(1.0 - seen.thickness, 0.0);
    }
    if kind == 1u {
        // Grains stay round and do not mix. Each is a little lighter or darker, larger or smaller than the next, and none lies on a lattice.
        let i = order[k];
        let size = mix(GRAINS_LOW, GRAINS_HIGH, chance(stirred(i + 0x9e3779b9u)));
        let astray = vec3(chance(stirred(3u * i)), chance(stirred(3u * i + 1u)), chance(stirred(3u * i + 2u))) * 2.0 - 1.0;
        x = own.xyz + astray * (ASTRAY * own.w * state.x);
        let r = GRAIN * size * seen.full * radius_m;
        c = mat3x3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0) * (r * r);
        colour = mine * (1.0 + TONE * (2.0 * chance(stirred(i)) - 1.0));
        gloss = 0.0;
    }
    geometry[4u * g] = vec4(x, opacity);
    geometry[4u * g + 1u] = vec4(c[0].x, c[0].y, c[0].z, c[1].y);
    geometry[4u * g + 2u] = vec4(c[1].z, c[2].z, 1.0, 1.0 + gloss);
    geometry[4u * g + 3u] = vec4(seen.normal, 0.0);
    sh[g] = vec4((colour - 0.5) / SH_FIRST, 0.0);
}
