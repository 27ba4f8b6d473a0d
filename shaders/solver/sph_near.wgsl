// Lists the neighbours of each particle, and sums what depends on places alone: density, its gradient,
// how much a pressure of one pascal does, and the stiffest viscous coupling.
//
// A liquid particle lists all within the support, a solid one the liquid among them. The order is that
// of the cells and of the particles in them, so that every later sum repeats to the bit.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> nature: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> cell_start: array<u32>;
@group(0) @binding(4) var<storage, read> cell_end: array<u32>;
@group(0) @binding(5) var<storage, read> colliders: array<Collider>;
@group(0) @binding(6) var<storage, read> solve: Solve;
@group(0) @binding(7) var<storage, read_write> neighbours: array<vec4<u32>>;
@group(0) @binding(8) var<storage, read_write> near: array<u32>;
// Two planes: gradient of the density, times the cell, walls twice, and density over that at rest; then the
// direction of walls, and by how much a push along them is to grow for what they hide of it.
@group(0) @binding(9) var<storage, read_write> density: array<vec4<f32>>;
// 1 over the change of density that a pressure makes.
@group(0) @binding(10) var<storage, read_write> answer: array<f32>;
@group(0) @binding(11) var<storage, read_write> control: Control;
@group(0) @binding(12) var<storage, read_write> errors: array<atomic<u32>>;

struct Walls {
    // What lies behind two counts once, as if they were perpendicular.
    density: f32,
    gradient: vec3<f32>,
    drag: f32,
}

fn walls(x: vec3<f32>) -> Walls {
    var open = 1.0;
    var sums = Walls(0.0, vec3<f32>(0.0), 0.0);
    for (var c = 0u; c < params.collider_count; c++) {
        let t = touch(colliders[c], x);
        let s = t.distance_m * params.per_m;
        if (s >= 1.0) {
            continue;
        }
        let normal = surface_normal(colliders[c], t.face, x);
        let share = wall_density(s);
        sums.gradient = sums.gradient * (1.0 - share) - (wall_slope(s) * open) * normal;
        sums.drag += select(0.0, wall_drag(s), colliders[c].surface.x > 0.0);
        open *= 1.0 - share;
    }
    sums.density = 1.0 - open;
    return sums;
}

// Neighbours of one kind, four at a time on their way to the list.
struct Queue {
    count: u32,
    last: vec4<u32>,
}

struct Sums {
    liquid: bool,
    liquids: Queue,
    solids: Queue,
    density: f32,
    gradient: vec3<f32>,
    // sum of v_j |grad W|^2 / rho_j
    answer: f32,
    // sum of the viscous couplings, without their common factor
    viscous: f32,
}

fn fours(count: u32) -> u32 {
    return (count + 3u) >> 2u;
}

fn take(sums: ptr<function, Sums>, i: u32, j: u32, mine: vec4<f32>, other: vec4<f32>, viscosity: f32) {
    let y = (mine.xyz - other.xyz) * params.per_m;
    let q2 = dot(y, y);
    let liquid = other.w > 0.0;
    if (q2 >= 1.0 || j == i || !((*sums).liquid || liquid)) {
        return;
    }
    let q = sqrt(q2);
    let its = nature[j];
    let volume = abs(other.w);
    let steep = steepness(q);
    let alike = liquid == (*sums).liquid;
    let felt = select(solid_steepness(q), steep, alike);
    (*sums).density += volume * select(solid_weight(q), weight(q), alike);
    (*sums).gradient += (volume * felt) * y;
    (*sums).answer += volume * felt * felt * q2 * its.x;
    (*sums).viscous += couple_viscosity(viscosity, its.z) * volume * -steep * q2 / (q2 + SOFT_DISTANCE);
    let liquids = (*sums).liquids.count;
    let solids = (*sums).solids.count;
    if (liquid && fours(liquids + 1u) + fours(solids) <= solve.columns) {
        (*sums).liquids = Queue(liquids + 1u, vec4<u32>((*sums).liquids.last.yzw, j));
        if ((liquids & 3u) == 3u) {
            neighbours[(liquids >> 2u) * params.count + i] = (*sums).liquids.last;
        }
    } else if (!liquid && fours(liquids) + fours(solids + 1u) <= solve.columns) {
        (*sums).solids = Queue(solids + 1u, vec4<u32>((*sums).solids.last.yzw, j));
        if ((solids & 3u) == 3u) {
            neighbours[(solve.columns - 1u - (solids >> 2u)) * params.count + i] = (*sums).solids.last;
        }
    } else {
        atomicStore(&control.crowded, 1u);
    }
}

// The last ones of a kind, as many of them as the count leaves over, then the particle itself.
fn rest_of(queue: Queue, i: u32) -> vec4<u32> {
    let last = queue.last;
    let few = select(vec4<u32>(last.zw, i, i), vec4<u32>(last.w, i, i, i), (queue.count & 3u) == 1u);
    return select(few, vec4<u32>(last.yzw, i), (queue.count & 3u) == 3u);
}

// Particles from one to before another, four at a time so that their loads do not wait for each other.
fn search(sums: ptr<function, Sums>, i: u32, begin: u32, end: u32, mine: vec4<f32>, viscosity: f32) {
    for (var j = begin; j < end; j += 4u) {
        let last = end - 1u;
        let a = place[j];
        let b = place[min(j + 1u, last)];
        let c = place[min(j + 2u, last)];
        let d = place[min(j + 3u, last)];
        take(sums, i, j, mine, a, viscosity);
        if (j + 1u < end) {
            take(sums, i, j + 1u, mine, b, viscosity);
        }
        if (j + 2u < end) {
            take(sums, i, j + 2u, mine, c, viscosity);
        }
        if (j + 3u < end) {
            take(sums, i, j + 3u, mine, d, viscosity);
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let n = params.count;
    let i = min(id.x, n - 1u);
    let mine = place[i];
    let own = nature[i];
    let none = Queue(0u, vec4<u32>(i));
    var sums = Sums(mine.w > 0.0, none, none, 0.0, vec3<f32>(0.0), 0.0, 0.0);
    let cell = clamp(clamped_cell(base_node(mine.xyz) - params.origin), vec3<u32>(1u), params.blocks * 4u - vec3<u32>(2u));
    // Rows of three cells along x. Those of one block follow each other, and so do their particles.
    let inner = (cell.x - 1u) & 3u;
    for (var k = 0u; k < 9u; k++) {
        let beside = vec3<u32>(cell.x, cell.y + k % 3u - 1u, cell.z + k / 3u - 1u);
        let first = stored(beside - vec3<u32>(1u, 0u, 0u), 0u);
        let last = stored(beside + vec3<u32>(1u, 0u, 0u), 0u);
        let whole = inner < 2u;
        search(&sums, i, cell_start[first], cell_end[select(first + 3u - inner, last, whole)], mine, own.z);
        if (!whole) {
            search(&sums, i, cell_start[last + 2u - inner], cell_end[last], mine, own.z);
        }
    }
    var stiffness = 2.0 * sums.viscous;
    var sum = vec4<f32>(0.0);
    var wall = vec4<f32>(0.0);
    if (sums.liquid) {
        let solid = walls(mine.xyz);
        sum = vec4<f32>(sums.gradient + 2.0 * solid.gradient, sums.density + mine.w * weight(0.0) + solid.density);
        let hidden = min(solid.density, 0.5);
        wall = vec4<f32>(solid.gradient, hidden / (1.0 - hidden));
        stiffness += own.z * solid.drag;
    }
    if (id.x < n) {
        if ((sums.liquids.count & 3u) != 0u) {
            neighbours[(sums.liquids.count >> 2u) * n + i] = rest_of(sums.liquids, i);
        }
        if ((sums.solids.count & 3u) != 0u) {
            neighbours[(solve.columns - 1u - (sums.solids.count >> 2u)) * n + i] = rest_of(sums.solids, i);
        }
        near[i] = pack_near(Near(sums.liquids.count, sums.solids.count, sums.liquid));
        density[i] = sum;
        density[n + i] = wall;
        let change = dot(sum.xyz, along_walls(sum.xyz, wall)) * own.x + mine.w * sums.answer;
        answer[i] = 1.0 / max(change, 1e-3 * own.x);
    }
    let stiffest = subgroupMax(bitcast<u32>(max(VISCOUS * params.per_m * params.per_m * own.x * stiffness, 0.0)));
    if (lane == 0u && stiffest > atomicLoad(&errors[STIFFEST])) {
        atomicMax(&errors[STIFFEST], stiffest);
    }
}
