// Lists the neighbours of each particle, and sums what depends on places alone: density, its gradient,
// how much a pressure of one pascal does, and the stiffest viscous coupling.
//
// A liquid particle lists all within the support, a solid one the liquid among them. The order is that
// of the cells and of the particles in them, so that every later sum repeats to the bit.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> motion: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> nature: array<vec2<f32>>;
@group(0) @binding(4) var<storage, read> cell_start: array<u32>;
@group(0) @binding(5) var<storage, read> cell_end: array<u32>;
@group(0) @binding(6) var<storage, read> colliders: array<Collider>;
@group(0) @binding(7) var<storage, read> solve: Solve;
@group(0) @binding(8) var<storage, read_write> neighbours: array<u32>;
@group(0) @binding(9) var<storage, read_write> near: array<u32>;
// Gradient of the density, times the cell; density over that at rest.
@group(0) @binding(10) var<storage, read_write> density: array<vec4<f32>>;
// Gradient of what is filled with liquid, solid or wall; surface tension.
@group(0) @binding(11) var<storage, read_write> surface: array<vec4<f32>>;
// 1 over the change of density that a pressure makes.
@group(0) @binding(12) var<storage, read_write> answer: array<f32>;
@group(0) @binding(13) var<storage, read_write> control: Control;
@group(0) @binding(14) var<storage, read_write> errors: array<atomic<u32>>;

struct Walls {
    density: f32,
    gradient: vec3<f32>,
    // Gradient of the share of the kernel that is behind them. What lies behind two counts once, as if they
    // were perpendicular.
    surface: vec3<f32>,
    drag: f32,
}

fn walls(x: vec3<f32>) -> Walls {
    var open = 1.0;
    var sums = Walls(0.0, vec3<f32>(0.0), vec3<f32>(0.0), 0.0);
    for (var c = 0u; c < params.collider_count; c++) {
        let t = touch(colliders[c], x);
        let s = t.distance_m * params.per_m;
        if (s >= 1.0) {
            continue;
        }
        let normal = surface_normal(colliders[c], t.face, x);
        let share = wall_share(s);
        sums.density += wall_density(s);
        sums.gradient -= wall_push(s) * normal;
        sums.surface = sums.surface * (1.0 - share) - (wall_slope(s) * open) * normal;
        sums.drag += select(0.0, wall_drag(s), colliders[c].surface.x > 0.0);
        open *= 1.0 - share;
    }
    return sums;
}

struct Sums {
    near: Near,
    density: f32,
    gradient: vec3<f32>,
    surface: vec3<f32>,
    // sum of v_j |grad W|^2 / rho_j
    answer: f32,
    // sum of the viscous couplings, without their common factor
    viscous: f32,
}

fn take(sums: ptr<function, Sums>, i: u32, j: u32, mine: vec4<f32>, viscosity: f32) {
    let other = place[j];
    let y = (mine.xyz - other.xyz) * params.per_m;
    let q2 = dot(y, y);
    let liquid = other.w > 0.0;
    if (q2 >= 1.0 || j == i || !((*sums).near.liquid || liquid)) {
        return;
    }
    let q = sqrt(q2);
    let volume = abs(other.w);
    let steep = steepness(q);
    let alike = liquid == (*sums).near.liquid;
    let felt = select(solid_steepness(q), steep, alike);
    (*sums).density += volume * select(solid_weight(q), weight(q), alike);
    (*sums).gradient += (volume * felt) * y;
    (*sums).surface += (volume * steep) * y;
    (*sums).answer += volume * felt * felt * q2 * nature[j].x;
    (*sums).viscous += couple_viscosity(viscosity, motion[j].w) * volume * -steep * q2 / (q2 + SOFT_DISTANCE);
    if ((*sums).near.liquids + (*sums).near.solids == solve.columns) {
        atomicStore(&control.crowded, 1u);
    } else if (liquid) {
        neighbours[(*sums).near.liquids * params.count + i] = j;
        (*sums).near.liquids += 1u;
    } else {
        (*sums).near.solids += 1u;
        neighbours[(solve.columns - (*sums).near.solids) * params.count + i] = j;
    }
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let i = min(id.x, params.count - 1u);
    let mine = place[i];
    let own = nature[i];
    let viscosity = motion[i].w;
    var sums = Sums(Near(0u, 0u, mine.w > 0.0), 0.0, vec3<f32>(0.0), vec3<f32>(0.0), 0.0, 0.0);
    let cell = clamp(clamped_cell(base_node(mine.xyz) - params.origin), vec3<u32>(1u), params.blocks * 4u - vec3<u32>(2u));
    for (var k = 0u; k < 27u; k++) {
        let index = stored(cell + vec3<u32>(k % 3u, (k / 3u) % 3u, k / 9u) - vec3<u32>(1u), 0u);
        let end = cell_end[index];
        for (var j = cell_start[index]; j < end; j++) {
            take(&sums, i, j, mine, viscosity);
        }
    }
    var stiffness = 0.0;
    if (sums.near.liquid) {
        let wall = walls(mine.xyz);
        let gradient = sums.gradient + wall.gradient;
        let change = dot(gradient, gradient) * own.x + mine.w * sums.answer;
        if (id.x < params.count) {
            density[i] = vec4<f32>(gradient, sums.density + mine.w * weight(0.0) + wall.density);
            surface[i] = vec4<f32>(sums.surface + wall.surface, own.y);
            answer[i] = 1.0 / max(change, 1e-3 * own.x);
        }
        stiffness = 2.0 * sums.viscous + viscosity * wall.drag;
    } else {
        stiffness = 2.0 * sums.viscous;
        if (id.x < params.count) {
            density[i] = vec4<f32>(0.0);
            surface[i] = vec4<f32>(0.0);
        }
    }
    if (id.x < params.count) {
        near[i] = pack_near(sums.near);
    }
    let stiffest = subgroupMax(bitcast<u32>(max(VISCOUS * params.per_m * params.per_m * own.x * stiffness, 0.0)));
    if (lane == 0u && stiffest > atomicLoad(&errors[STIFFEST])) {
        atomicMax(&errors[STIFFEST], stiffest);
    }
}
