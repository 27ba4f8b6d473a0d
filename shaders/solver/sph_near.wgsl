// Lists the neighbours of each particle, and sums what depends on places alone: density, its gradient,
// how much a pressure of one pascal does, and the stiffest viscous coupling.
//
// A liquid particle lists all within the support, a solid one the liquid among them. The order is that
// of the cells and of the particles in them, so that every later sum repeats to the bit. First all near by are
// looked at, one word each; those that may count are measured and written down; then these alone are summed.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> nature: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> cell_start: array<u32>;
@group(0) @binding(4) var<storage, read> cell_end: array<u32>;
@group(0) @binding(5) var<storage, read> colliders: array<Collider>;
@group(0) @binding(6) var<storage, read> solve: Solve;
@group(0) @binding(7) var<storage, read_write> neighbours: array<vec4<u32>>;
@group(0) @binding(8) var<storage, read_write> slopes: array<vec4<f32>>;
@group(0) @binding(9) var<storage, read_write> near: array<u32>;
// Two planes: gradient of the density, times the cell, walls twice, and density over that at rest, less what it may be
// too dense; then the direction of walls, and by how much a push along them is to grow for what they hide of it.
@group(0) @binding(10) var<storage, read_write> density: array<vec4<f32>>;
// 1 over the change of density that a pressure makes. Where particles crowd, neighbours answer along with
// each other: as many times more as it is dense.
@group(0) @binding(11) var<storage, read_write> answer: array<f32>;
@group(0) @binding(12) var<storage, read_write> control: Control;
@group(0) @binding(13) var<storage, read_write> errors: array<atomic<u32>>;
// Gradient of the density of liquid, times the cell, as if what is solid were liquid too.
@group(0) @binding(14) var<storage, read_write> inward: array<f32>;
// Places of 1 / COARSE_STEPS of a cell within four cells, ten bits an axis; above them whether it is liquid.
@group(0) @binding(15) var<storage, read> coarse: array<u32>;

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

// How many neighbours of each kind are on the list.
struct Listed {
    liquids: u32,
    solids: u32,
    // There was no room for one.
    crowded: bool,
}

// Where the list keeps an entry, in fours of either kind from its two ends.
fn entry_of(k: u32, liquid: bool, i: u32) -> u32 {
    return select(solve.columns - 1u - (k >> 2u), k >> 2u, liquid) * params.count + i;
}

// A particle that is looked for by: its place, and the coarse one with each axis at the top of a word.
struct Seeker {
    place: vec4<f32>,
    coarse: vec3<u32>,
}

fn axes(coarse: u32) -> vec3<u32> {
    return vec3<u32>(coarse << 22u, coarse << 12u, coarse << 2u) & vec3<u32>(0xffc00000u);
}

// Whether a coarse place may be within the support: none that is in it is farther by rounding.
fn may_count(me: Seeker, other: u32) -> bool {
    let steps = vec3<i32>(axes(other) - me.coarse) >> vec3<u32>(22u);
    return dot(steps, steps) < COARSE_REACH && (me.place.w > 0.0 || (other >> 30u) != 0u);
}

fn enlist(listed: ptr<function, Listed>, i: u32, j: u32, me: Seeker) {
    let other = place[j];
    let y = (me.place.xyz - other.xyz) * params.per_m;
    if (dot(y, y) >= 1.0) {
        return;
    }
    let liquid = other.w > 0.0;
    let k = select((*listed).solids, (*listed).liquids, liquid);
    let fours = (((*listed).liquids + 3u) >> 2u) + (((*listed).solids + 3u) >> 2u);
    if ((k & 3u) == 0u && fours >= solve.columns) {
        (*listed).crowded = true;
        return;
    }
    neighbours[entry_of(k, liquid, i)][k & 3u] = j;
    (*listed).liquids += select(0u, 1u, liquid);
    (*listed).solids += select(1u, 0u, liquid);
}

// Particles from one to before another, in runs of 32: a bit for each that may count, then those alone.
fn search(listed: ptr<function, Listed>, i: u32, begin: u32, end: u32, me: Seeker) {
    for (var first = begin; first < end; first += 32u) {
        var hits = 0u;
        for (var k = 0u; k < min(end - first, 32u); k++) {
            hits |= select(0u, 1u << k, may_count(me, coarse[first + k]));
        }
        hits &= ~select(0u, 1u << ((i - first) & 31u), i >= first && i - first < 32u);
        while (hits != 0u) {
            enlist(listed, i, first + firstTrailingBit(hits), me);
            hits &= hits - 1u;
        }
    }
}

// Rows of three cells along x. Those of one block follow each other, and so do their particles: of each row
// the part in the first block, then what lies in the next one.
fn listed_around(i: u32, mine: vec4<f32>) -> Listed {
    var listed = Listed(0u, 0u, false);
    let me = Seeker(mine, axes(coarse[i]));
    let cell = clamp(clamped_cell(base_node(mine.xyz) - params.origin), vec3<u32>(1u), params.blocks * 4u - vec3<u32>(2u));
    let inner = (cell.x - 1u) & 3u;
    let whole = inner < 2u;
    for (var k = 0u; k < select(18u, 9u, whole); k++) {
        let row = select(k >> 1u, k, whole);
        let beside = vec3<u32>(cell.x, cell.y + row % 3u - 1u, cell.z + row / 3u - 1u);
        let first = stored(beside - vec3<u32>(1u, 0u, 0u), 0u);
        let last = stored(beside + vec3<u32>(1u, 0u, 0u), 0u);
        let next = !whole && (k & 1u) != 0u;
        let from_cell = select(first, last + 2u - inner, next);
        let to_cell = select(first + 3u - inner, last, whole || next);
        search(&listed, i, cell_start[from_cell], cell_end[to_cell], me);
    }
    return listed;
}

struct Sums {
    density: f32,
    gradient: vec3<f32>,
    answer: f32,
    // sum of the viscous couplings, without their common factor
    viscous: f32,
}

// What one neighbour adds; V W' / q of the kernel that it is felt by. Beyond the list's end it is the
// particle itself, which adds nothing.
fn add(sums: ptr<function, Sums>, i: u32, j: u32, mine: vec4<f32>, viscosity: f32, alike: bool) -> f32 {
    let other = place[j];
    let its = nature[j];
    let y = (mine.xyz - other.xyz) * params.per_m;
    let q2 = dot(y, y);
    let q = sqrt(q2);
    let volume = select(abs(other.w), 0.0, j == i);
    let steep = volume * steepness(q);
    let slope = select(volume * solid_steepness(q), steep, alike);
    (*sums).density += volume * select(solid_weight(q), weight(q), alike);
    (*sums).gradient += slope * y;
    (*sums).answer += slope * slope / max(volume, 1e-12) * q2 * its.x;
    (*sums).viscous -= couple_viscosity(viscosity, its.z) * steep * q2 / (q2 + SOFT_DISTANCE);
    return slope;
}

// All of one kind: their slopes are written beside them, and the list's last four are filled up.
fn add_all(sums: ptr<function, Sums>, i: u32, count: u32, liquid: bool, mine: vec4<f32>, viscosity: f32) {
    let alike = liquid == (mine.w > 0.0);
    for (var k = 0u; k < count; k += 4u) {
        let entry = entry_of(k, liquid, i);
        let j = select(vec4<u32>(i), neighbours[entry], vec4<u32>(k, k + 1u, k + 2u, k + 3u) < vec4<u32>(count));
        let a = add(sums, i, j.x, mine, viscosity, alike);
        let b = add(sums, i, j.y, mine, viscosity, alike);
        let c = add(sums, i, j.z, mine, viscosity, alike);
        let d = add(sums, i, j.w, mine, viscosity, alike);
        neighbours[entry] = j;
        slopes[entry] = vec4<f32>(a, b, c, d);
    }
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let n = params.count;
    var stiffness = 0.0;
    if (id.x < n) {
        stiffness = look_around(id.x);
    }
    let stiffest = subgroupMax(bitcast<u32>(max(stiffness, 0.0)));
    if (lane == 0u && stiffest > atomicLoad(&errors[STIFFEST])) {
        atomicMax(&errors[STIFFEST], stiffest);
    }
}

// Lists and sums of one particle; how stiff its viscous couplings are, 1/s.
fn look_around(i: u32) -> f32 {
    let n = params.count;
    let mine = place[i];
    let own = nature[i];
    let liquid = mine.w > 0.0;
    let listed = listed_around(i, mine);
    if (listed.crowded) {
        atomicStore(&control.crowded, 1u);
    }
    var sums = Sums(0.0, vec3<f32>(0.0), 0.0, 0.0);
    add_all(&sums, i, listed.liquids, true, mine, own.z);
    let of_liquid = sums.gradient;
    add_all(&sums, i, listed.solids, false, mine, own.z);
    var stiffness = 2.0 * sums.viscous;
    var sum = vec4<f32>(0.0);
    var wall = vec4<f32>(0.0);
    if (liquid) {
        let solid = walls(mine.xyz);
        sum = vec4<f32>(sums.gradient + 2.0 * solid.gradient, sums.density + mine.w * weight(0.0) + solid.density);
        let hidden = min(solid.density, 0.5);
        wall = vec4<f32>(solid.gradient, hidden / (1.0 - hidden));
        stiffness += own.z * solid.drag;
        inward[i] = length(0.5 * (of_liquid + sums.gradient) + solid.gradient);
    }
    near[i] = pack_near(Near(listed.liquids, listed.solids, liquid));
    density[i] = sum - vec4<f32>(vec3<f32>(0.0), max(own.w, 0.0));
    density[n + i] = wall;
    let change = dot(sum.xyz, along_walls(sum.xyz, wall)) * own.x + mine.w * sums.answer;
    answer[i] = 1.0 / max(change * max(sum.w, 1.0), 1e-3 * own.x);
    return VISCOUS * params.per_m * params.per_m * own.x * stiffness;
}
