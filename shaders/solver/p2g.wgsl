// Particles to grid: mass and momentum, in fixed point.
//
// Particles lie in the order of their cells, so lanes beside each other mostly share a stencil. They
// are summed in f32 along the subgroup first; the last lane of each run rounds once, dithered (a
// rounding to nearest would brake what moves slowly), and adds to the grid. Integer sums do not
// depend on who comes first.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> colliders: array<Collider>;
// Momentum x, y, z and mass of each node.
@group(0) @binding(4) var<storage, read_write> sums: array<atomic<i32>>;
// Contact marks of each node: of the ground, of the other colliders.
@group(0) @binding(5) var<storage, read_write> marks: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> control: Control;
var<immediate> substep: Substep;

// PCG hash (Jarzynski and Olano 2020).
fn hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

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

struct Near {
    mark: u32,
    normal: vec3<f32>,
}

// The mark of the nearest of a span of colliders, 0 where none is in reach.
fn nearest(first: u32, end: u32, i: u32, x: vec3<f32>) -> Near {
    var near = Near(0u, vec3<f32>(0.0));
    for (var c = first; c < end; c++) {
        let t = touch(colliders[c], x);
        if (t.distance_m > params.reach_m + REST_CELLS_MAX * params.cell_m) {
            continue;
        }
        let gap_m = t.distance_m - matter[3u * params.count + i].z;
        if (gap_m < params.reach_m) {
            let mark = pack_mark(gap_m, c * 8u + t.face);
            if (mark > near.mark) {
                near = Near(mark, surface_normal(colliders[c], t.face, x));
            }
        }
    }
    return near;
}

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(subgroup_invocation_id) lane: u32,
    @builtin(subgroup_size) lanes: u32,
) {
    let alive = id.x < params.count;
    let i = min(id.x, params.count - 1u);
    let n = params.count;
    let position = kinematics[i];
    let x = position.xyz;
    let v = kinematics[n + i].xyz;
    let affine = read_affine(i);
    let base = base_node(x);
    let first = base - params.origin;
    let inside = in_window(first);
    if (!inside) {
        atomicStore(&control.window, 1u);
    }
    let counts = alive && inside;

    let momentum_unit = momentum_units(bitcast<f32>(atomicLoad(&control.momentum[substep.index & 1u])));
    let mass = select(0.0, position.w, counts);
    let pull = mass * v * select(0.0, momentum_unit, counts);
    let spread = affine * select(0.0, momentum_unit * params.cell_m, counts);
    let mass_units = mass * params.mass_units;
    let offset = x * params.per_m - vec3<f32>(base);
    var w = spline(offset);

    let cell = vec3<u32>(max(first, vec3<i32>(0)));
    var place = array<vec3<u32>, 3>(axis_offsets(cell), axis_offsets(cell + vec3<u32>(1u)), axis_offsets(cell + vec3<u32>(2u)));
    let key = select(0xffffffffu, place[0].x + place[0].y + place[0].z, counts);
    let starts = subgroupBallot(lane == 0u || subgroupShuffleUp(key, 1u) != key);
    let behind = lane - run_start(starts, lane);
    let longest = subgroupMax(behind);
    let last = lane + 1u == lanes || ((starts[(lane + 1u) >> 5u] >> ((lane + 1u) & 31u)) & 1u) != 0u;
    let adds = last && counts;

    var ground = Near(0u, vec3<f32>(0.0));
    var solid = Near(0u, vec3<f32>(0.0));
    if (counts) {
        ground = nearest(0u, params.has_ground, i, x);
        solid = nearest(params.has_ground, params.collider_count, i, x);
    }
    var noise = hash(i ^ hash(substep.index ^ params.seed));
    var widest = 0.0;
    for (var k = 0u; k < 27u; k++) {
        let at = vec3<u32>(k % 3u, (k / 3u) % 3u, k / 9u);
        let weight = w[at.x].x * w[at.y].y * w[at.z].z;
        let d = vec3<f32>(at) - offset;
        var sum = vec4<f32>(pull + spread * d, mass_units) * weight;
        for (var step = 1u; step <= longest; step <<= 1u) {
            let before = subgroupShuffleUp(sum, step);
            sum += select(vec4<f32>(0.0), before, behind >= step);
        }
        let node = place[at.x].x + place[at.y].y + place[at.z].z;
        if (adds) {
            noise = hash(noise);
            let other = hash(noise ^ 0x9e3779b9u);
            let dither = vec4<f32>(vec4<u32>(noise & 0xffffu, noise >> 16u, other & 0xffffu, other >> 16u)) * (1.0 / 65536.0);
            let whole = vec4<i32>(floor(sum + dither));
            widest = max(widest, max(max(abs(sum.x), abs(sum.y)), max(abs(sum.z), sum.w)));
            atomicAdd(&sums[4u * node], whole.x);
            atomicAdd(&sums[4u * node + 1u], whole.y);
            atomicAdd(&sums[4u * node + 2u], whole.z);
            atomicAdd(&sums[4u * node + 3u], whole.w);
        }
        // Only the nodes beside and below the particle carry its contact: those above it are the
        // body's own, and the layer that they would stiffen is half a cell thinner without them.
        if (ground.mark != 0u && dot(ground.normal, d) <= 0.5) {
            atomicMax(&marks[2u * node], ground.mark);
        }
        if (solid.mark != 0u && dot(solid.normal, d) <= 0.5) {
            atomicMax(&marks[2u * node + 1u], solid.mark);
        }
    }
    if (!(widest < SUM_LIMIT)) {
        atomicStore(&control.overflow, 1u);
    }
}
