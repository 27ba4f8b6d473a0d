// Particles to grid: mass and momentum, in fixed point.
//
// Particles lie in the order of their cells, so lanes beside each other mostly share a stencil. They
// are summed in f32 along the subgroup first; the last lane of each run rounds once, dithered (a
// rounding to nearest would brake what moves slowly), and adds to the grid. Integer sums do not
// depend on who comes first.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> colliders: array<Collider>;
// Momentum x, y, z and mass of each node.
@group(0) @binding(4) var<storage, read_write> sums: array<atomic<i32>>;
// Contact marks of each node: of the ground, of the other colliders.
@group(0) @binding(5) var<storage, read_write> marks: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> control: Control;
@group(0) @binding(7) var<storage, read> substances: array<Substance>;
var<immediate> substep: Substep;

// Lane in which the run of equal keys that this lane belongs to begins.
fn run_start(starts: vec4<u32>, lane: u32) -> u32 {
    var word = lane >> 5u;
    var bits = starts[word] & (0xffffffffu >> (31u - (lane & 31u)));
    while (bits == 0u && word > 0u) {
        word -= 1u;
        bits = starts[word];
    }
    return word * 32u + firstLeadingBit(max(bits, 1u));
}

// What a lane knows while it adds up its stencil.
struct Lane {
    pull: vec3<f32>,
    spread: mat3x3<f32>,
    mass_units: f32,
    // Lanes back to the start of its run, and the most of any lane.
    behind: u32,
    longest: u32,
    adds: bool,
    seed: u32,
    ground: Near,
    solid: Near,
}

fn behind_by(sum: vec4<f32>, step: u32, behind: u32) -> vec4<f32> {
    let before = subgroupShuffleUp(sum, step);
    return sum + select(vec4<f32>(0.0), before, behind >= step);
}

// Adds what the particle gives to one node, `d` cells away; the widest sum that it rounded.
fn deposit(l: Lane, node: u32, weight: f32, d: vec3<f32>, number: u32) -> f32 {
    var sum = vec4<f32>(l.pull + l.spread * d, l.mass_units) * weight;
    if (l.longest >= 1u) { sum = behind_by(sum, 1u, l.behind); }
    if (l.longest >= 2u) { sum = behind_by(sum, 2u, l.behind); }
    if (l.longest >= 4u) { sum = behind_by(sum, 4u, l.behind); }
    if (l.longest >= 8u) { sum = behind_by(sum, 8u, l.behind); }
    if (l.longest >= 16u) { sum = behind_by(sum, 16u, l.behind); }
    if (l.longest >= 32u) { sum = behind_by(sum, 32u, l.behind); }
    if (l.longest >= 64u) { sum = behind_by(sum, 64u, l.behind); }
    var widest = 0.0;
    if (l.adds) {
        let noise = hash(l.seed + number * 0x9e3779b9u);
        let dither = (vec4<f32>((vec4<u32>(noise) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u)) + vec4<f32>(0.5)) * (1.0 / 256.0);
        let whole = vec4<i32>(floor(sum + dither));
        atomicAdd(&sums[4u * node], whole.x);
        atomicAdd(&sums[4u * node + 1u], whole.y);
        atomicAdd(&sums[4u * node + 2u], whole.z);
        atomicAdd(&sums[4u * node + 3u], whole.w);
        widest = max(max(abs(sum.x), abs(sum.y)), max(abs(sum.z), sum.w));
    }
    let ground = mark_on(l.ground, d);
    let solid = mark_on(l.solid, d);
    if (ground != 0u) {
        atomicMax(&marks[2u * node], ground);
    }
    if (solid != 0u) {
        atomicMax(&marks[2u * node + 1u], solid);
    }
    return widest;
}

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(subgroup_invocation_id) lane: u32,
    @builtin(subgroup_size) lanes: u32,
) {
    let alive = id.x < params.count;
    let i = min(id.x, params.count - 1u);
    let position = kinematics[i];
    let x = position.xyz;
    let base = base_node(x);
    let first = base - params.origin;
    let inside = in_window(first);
    if (!inside && !has_left(i)) {
        atomicStore(&control.window, 1u);
    }
    let label = matter[3u * params.count + i];
    let tag = bitcast<u32>(label.y);
    let counts = alive && inside && on_grid(tag);
    let s = in_layer(stencil(x, base, vec3<u32>(max(first, vec3<i32>(0)))), layer_of(tag));
    let key = select(0xffffffffu, row(s, 0u).nodes.x, counts);
    let starts = subgroupBallot(lane == 0u || subgroupShuffleUp(key, 1u) != key);
    let last = lane + 1u == lanes || ((starts[(lane + 1u) >> 5u] >> ((lane + 1u) & 31u)) & 1u) != 0u;

    var l: Lane;
    let unit = select(0.0, momentum_units(substep.index, substep.lag), counts);
    l.pull = position.w * kinematics[params.count + i].xyz * unit;
    l.spread = read_affine(i) * (unit * params.cell_m);
    l.mass_units = select(0.0, position.w * params.mass_units, counts);
    l.behind = lane - run_start(starts, lane);
    l.longest = subgroupMax(l.behind);
    l.adds = last && counts;
    l.seed = hash(i ^ hash(substep.index ^ params.seed));
    l.ground = Near(0u, vec3<f32>(0.0));
    l.solid = Near(0u, vec3<f32>(0.0));
    if (counts) {
        let shears = matter[i].w != 0.0;
        l.ground = nearest(0u, params.has_ground, x, label.z, shears);
        l.solid = nearest(params.has_ground, params.collider_count, x, label.z, shears);
    }
    var widest = 0.0;
    for (var k = 0u; k < 9u; k++) {
        let r = row(s, k);
        let d = vec3<f32>(-s.place.x, r.dy, r.dz);
        widest = max(widest, deposit(l, r.nodes.x, r.weights.x, d, 3u * k));
        widest = max(widest, deposit(l, r.nodes.y, r.weights.y, d + vec3<f32>(1.0, 0.0, 0.0), 3u * k + 1u));
        widest = max(widest, deposit(l, r.nodes.z, r.weights.z, d + vec3<f32>(2.0, 0.0, 0.0), 3u * k + 2u));
    }
    // A number that is none is not under the limit either.
    if (!(widest < SUM_LIMIT)) {
        atomicStore(&control.overflow, 1u);
    }
}
