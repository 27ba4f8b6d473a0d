// Mass and momentum of a block's particles, in fixed point, summed in the tile and then added to the grid.
// Each contribution is rounded alone, dithered (a rounding to nearest would brake what moves slowly) by a
// number that depends on particle, node and substep, so that no sum depends on who comes first.

// Momentum x, y, z and mass of each node. Apart, so that one check of the index does for all.
var<workgroup> heap_x: array<atomic<i32>, TILE_NODES>;
var<workgroup> heap_y: array<atomic<i32>, TILE_NODES>;
var<workgroup> heap_z: array<atomic<i32>, TILE_NODES>;
var<workgroup> heap_mass: array<atomic<i32>, TILE_NODES>;
// Contact marks of each node: of the ground, of the other colliders.
var<workgroup> touched_ground: array<atomic<u32>, TILE_NODES>;
var<workgroup> touched_solid: array<atomic<u32>, TILE_NODES>;

// What a particle hands to the grid.
struct Load {
    // Momentum in quanta of 2^shift.x fixed-point units, and its change along each axis, a cell.
    pull: vec3<f32>,
    spread: mat3x3<f32>,
    // In quanta of 2^shift.w units.
    mass: f32,
    // Units in a quantum of momentum and of mass, and what brings a rounded number of quanta to zero.
    quantum: vec2<i32>,
    zero: vec2<i32>,
    seed: u32,
    ground: Near,
    solid: Near,
}

// Bits to spare so that at most half of this lies under 2^22.
fn quantum(most: f32) -> u32 {
    return max(bitcast<u32>(most) >> 23u, 149u) - 149u;
}

fn load_of(x: vec3<f32>, mass: f32, v: vec3<f32>, affine: mat3x3<f32>, label: vec4<f32>, shears: bool, unit: f32, time: u32) -> Load {
    let seed = hash(bitcast<u32>(label.x) ^ hash(time ^ params.seed));
    let ground = nearest(0u, params.has_ground, x, label.z, shears);
    let solid = nearest(params.has_ground, params.collider_count, x, label.z, shears);
    let pull = v * (mass * unit);
    let spread = affine * (unit * params.cell_m);
    let units = mass * params.mass_units;
    // No node gets half as much.
    let sizes = abs(pull) + abs(spread[0]) + abs(spread[1]) + abs(spread[2]);
    let widest = max(max(sizes.x, sizes.y), sizes.z);
    // A number that is none is not under the limit either.
    if (!(max(widest, units) < SUM_LIMIT)) {
        atomicStore(&control.overflow, 1u);
    }
    let shift = vec2<u32>(quantum(widest), quantum(units)) & vec2<u32>(31u);
    let per_quantum = bitcast<vec2<f32>>((vec2<u32>(127u) - shift) << vec2<u32>(23u));
    let quanta = vec2<i32>(1) << shift;
    return Load(pull * per_quantum.x, spread * per_quantum.x, units * per_quantum.y, quanta, quanta * -0x4b400000, seed, ground, solid);
}

// From a node's noise to that of the next in its row.
const NEXT_NOISE: u32 = 0x9e3779b1u;
// And to that of the one after.
const THIRD_NOISE: u32 = 0xffe6cc61u;

// Noise for the first node of one of the nine rows: an odd multiple of one that is even over all numbers is too.
fn noise_at(seed: u32, number: u32) -> u32 {
    return seed * (2u * number * 0x9e3779b9u + 1u);
}

// To a whole number of quanta, up or down by chance so that the mean is right. 1.5 * 2^23 has no room for
// a fraction: what is added to it is rounded and stands in its lowest bits, without a conversion.
fn rounded(l: Load, pull: vec3<f32>, weight: f32, noise: u32) -> vec4<i32> {
    let dither = bitcast<f32>((noise & 0x7fffffu) | 0x3f800000u) - 1.5;
    let amount = vec4<f32>(pull, l.mass) * weight + vec4<f32>(dither);
    return bitcast<vec4<i32>>(amount + vec4<f32>(params.rounder)) * l.quantum.xxxy + l.zero.xxxy;
}

fn drop_node(l: Load, node: u32, pull: vec3<f32>, weight: f32, noise: u32) {
    let whole = rounded(l, pull, weight, noise);
    atomicAdd(&heap_x[node], whole.x);
    atomicAdd(&heap_y[node], whole.y);
    atomicAdd(&heap_z[node], whole.z);
    atomicAdd(&heap_mass[node], whole.w);
}

// A row of three nodes along x, of which `first` is what the particle's momentum is there.
fn drop_row(l: Load, node: u32, first: vec3<f32>, weights: vec3<f32>, number: u32) {
    let noise = noise_at(l.seed, number);
    drop_node(l, node, first, weights.x, noise);
    drop_node(l, node + 1u, first + l.spread[0], weights.y, noise * NEXT_NOISE);
    drop_node(l, node + 2u, first + 2.0 * l.spread[0], weights.z, noise * THIRD_NOISE);
}

// A slab of three rows.
fn drop_slab(l: Load, node: u32, first: vec3<f32>, w: Weights, share: f32, number: u32) {
    drop_row(l, node, first, w.x * (w.y.x * share), number);
    drop_row(l, node + TILE_ROW, first + l.spread[1], w.x * (w.y.y * share), number + 1u);
    drop_row(l, node + 2u * TILE_ROW, first + 2.0 * l.spread[1], w.x * (w.y.z * share), number + 2u);
}

fn mark_node(l: Load, node: u32, d: vec3<f32>) {
    let ground = mark_on(l.ground, d);
    let solid = mark_on(l.solid, d);
    if (ground != 0u) {
        atomicMax(&touched_ground[node], ground);
    }
    if (solid != 0u) {
        atomicMax(&touched_solid[node], solid);
    }
}

// Marks on a row of three nodes along x, of which the first lies `d` from the particle.
fn mark_row(l: Load, node: u32, d: vec3<f32>) {
    mark_node(l, node, d);
    mark_node(l, node + 1u, d + vec3<f32>(1.0, 0.0, 0.0));
    mark_node(l, node + 2u, d + vec3<f32>(2.0, 0.0, 0.0));
}

// Written out: a loop stays a loop.
fn drop_in_tile(l: Load, place: vec3<f32>, start: u32) {
    let w = spline(place);
    let first = l.pull - l.spread * place;
    drop_slab(l, start, first, w, w.z.x, 0u);
    drop_slab(l, start + TILE_SLAB, first + l.spread[2], w, w.z.y, 3u);
    drop_slab(l, start + 2u * TILE_SLAB, first + 2.0 * l.spread[2], w, w.z.z, 6u);
    if ((l.ground.mark | l.solid.mark) == 0u) {
        return;
    }
    for (var k = 0u; k < 9u; k++) {
        let y = k % 3u;
        let z = k / 3u;
        mark_row(l, start + z * TILE_SLAB + y * TILE_ROW, vec3<f32>(0.0, f32(y), f32(z)) - place);
    }
}

fn add_to_grid(node: u32, whole: vec4<i32>, ground: u32, solid: u32) {
    atomicAdd(&sums[4u * node], whole.x);
    atomicAdd(&sums[4u * node + 1u], whole.y);
    atomicAdd(&sums[4u * node + 2u], whole.z);
    atomicAdd(&sums[4u * node + 3u], whole.w);
    if (ground != 0u) {
        atomicMax(&marks[2u * node], ground);
    }
    if (solid != 0u) {
        atomicMax(&marks[2u * node + 1u], solid);
    }
}

fn drop_on_grid(l: Load, s: Stencil) {
    let first = l.pull - l.spread * s.place;
    for (var k = 0u; k < 27u; k++) {
        let r = row(s, k / 3u);
        let x = k % 3u;
        let steps = vec3<f32>(vec3<u32>(x, k / 3u % 3u, k / 9u));
        let pull = ((first + steps.z * l.spread[2]) + steps.y * l.spread[1]) + steps.x * l.spread[0];
        let noise = noise_at(l.seed, k / 3u) * select(select(THIRD_NOISE, NEXT_NOISE, x == 1u), 1u, x == 0u);
        let whole = rounded(l, pull, pick(r.weights, x), noise);
        let d = steps - s.place;
        add_to_grid(pick_offset(r.nodes, x), whole, mark_on(l.ground, d), mark_on(l.solid, d));
    }
}

// A particle that left the tile adds to the grid itself.
fn hand_over(item: Item, x: vec3<f32>, tag: u32, l: Load) {
    let base = base_node(x);
    let first = base - params.origin;
    if (tile_holds(item, first, tag)) {
        drop_in_tile(l, x * params.per_m - vec3<f32>(base), tile_start(item, first));
    } else if (in_window(first)) {
        drop_on_grid(l, in_layer(stencil(x, base, vec3<u32>(first)), layer_of(tag)));
    } else {
        atomicStore(&control.window, 1u);
    }
}

// To be called by all, after a barrier: the tile onto the grid.
fn unload(lane: u32) {
    for (var k = lane; k < 512u; k += TILE_LANES) {
        let at = in_tile(k);
        let whole = vec4<i32>(atomicLoad(&heap_x[at]), atomicLoad(&heap_y[at]), atomicLoad(&heap_z[at]), atomicLoad(&heap_mass[at]));
        let ground = atomicLoad(&touched_ground[at]);
        let solid = atomicLoad(&touched_solid[at]);
        if (any(whole != vec4<i32>(0)) || (ground | solid) != 0u) {
            add_to_grid(stored_in_tile(k), whole, ground, solid);
        }
    }
}
