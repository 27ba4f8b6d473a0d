// The velocities that the correction starts from, after all that does not depend on pressure: weight, what drives
// the object, surface tension, viscosity where it is not stiff. The correction's first half round is made along
// with it, for its pressures are those of the last substep; stiff viscosity starts from there.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> solve: Solve;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> objects: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> colliders: array<Collider>;
@group(0) @binding(5) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> nature: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> neighbours: array<vec4<u32>>;
@group(0) @binding(8) var<storage, read> slopes: array<vec4<f32>>;
@group(0) @binding(9) var<storage, read> near: array<u32>;
@group(0) @binding(10) var<storage, read> density: array<vec4<f32>>;
@group(0) @binding(11) var<storage, read> pressure: array<f32>;
@group(0) @binding(12) var<storage, read> motion: array<vec4<f32>>;
@group(0) @binding(13) var<storage, read> skin: array<vec2<f32>>;
@group(0) @binding(14) var<storage, read_write> predicted: array<vec4<f32>>;
@group(0) @binding(15) var<storage, read_write> corrected: array<vec4<f32>>;
var<immediate> substep: Substep;

struct Own {
    at: vec4<f32>,
    nature: vec4<f32>,
    v: vec3<f32>,
    skin: vec2<f32>,
    // 1 where viscosity is explicit.
    viscous: f32,
    liquid: bool,
}

// Sums over neighbours, each without its common factor.
struct Pull {
    force: vec3<f32>,
    // What the pressures push.
    push: vec3<f32>,
}

// Viscosity of a surface of two that pulls: its particles would shake. A share of what a ripple as short as a cell
// is critically damped by.
fn calmed(me: Own, its: vec4<f32>) -> f32 {
    return SKIN_CALM * sqrt((me.nature.y + its.y) * params.cell_m / (me.nature.x + its.x));
}

fn meet(sums: ptr<function, Pull>, me: Own, j: u32, slope: f32, liquid: bool) {
    let other = place[j];
    let its = nature[j];
    let y = (me.at.xyz - other.xyz) * params.per_m;
    let q = length(y);
    // The particle itself, beyond the end of a list, has no slope.
    let volume = select(abs(other.w), 0.0, slope == 0.0);
    let steep = steepness(q);
    let alike = liquid && me.liquid;
    let along = y / max(q, 1e-6);
    let approach = dot(me.v - motion[j].xyz, y);
    let viscosity = me.viscous * couple_viscosity(me.nature.z, its.z) + eddies(approach / max(q, 1e-6), substep.dt_s) * (2.0 / (me.nature.x + its.x));
    var braking = viscosity;
    var tension = WETTING * (me.nature.y + its.y) * volume * pull(q);
    if (alike) {
        let other_skin = skin[j];
        tension = (me.skin.x * other_skin.y + other_skin.x * me.skin.y) * tug(q) / me.at.w;
        braking += calmed(me, its) * me.skin.y * other_skin.y;
    }
    (*sums).force += (VISCOUS * braking * volume * steep * approach / (q * q + SOFT_DISTANCE)) * y - tension * along;
    (*sums).push += (select(0.0, pressure[j], liquid) * slope) * y;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    let n = params.count;
    if (i >= n) {
        return;
    }
    let list = unpack_near(near[i]);
    if (!list.liquid && list.liquids == 0u) {
        return;
    }
    let v = motion[i];
    let me = Own(place[i], nature[i], v.xyz, skin[i], select(0.0, 1.0, substep.job == 0u), list.liquid);
    let wall = density[n + i];
    let gradient = density[i].xyz;
    var sums = Pull(vec3<f32>(0.0), pressure[i] * gradient);
    for (var k = 0u; k < list.liquids; k += 4u) {
        let entry = liquids_from(k, i);
        let j = neighbours[entry];
        let slope = slopes[entry];
        meet(&sums, me, j.x, slope.x, true);
        meet(&sums, me, j.y, slope.y, true);
        meet(&sums, me, j.z, slope.z, true);
        meet(&sums, me, j.w, slope.w, true);
    }
    for (var k = 0u; k < list.solids; k += 4u) {
        let entry = solids_from(k, i);
        let j = neighbours[entry];
        let slope = slopes[entry];
        meet(&sums, me, j.x, slope.x, false);
        meet(&sums, me, j.y, slope.y, false);
        meet(&sums, me, j.z, slope.z, false);
        meet(&sums, me, j.w, slope.w, false);
    }
    var force = sums.force;
    if (list.liquid) {
        for (var c = 0u; c < params.collider_count; c++) {
            let t = touch(colliders[c], me.at.xyz);
            let s = t.distance_m * params.per_m;
            if (s >= 1.0) {
                continue;
            }
            let normal = surface_normal(colliders[c], t.face, me.at.xyz);
            force -= (me.nature.y * wall_pull(s)) * normal;
            // A wall without friction lets the liquid slip.
            let drag = select(0.0, VISCOUS * me.viscous * me.nature.z * wall_drag(s), colliders[c].surface.x > 0.0);
            force -= drag * (v.xyz - normal * dot(v.xyz, normal));
        }
    }
    let object = bitcast<u32>(matter[3u * n + i].y) & 0xffffu;
    let weight_m_s2 = params.gravity_m_s2 + objects[object].xyz;
    let accelerated = substep.dt_s * (weight_m_s2 + (params.per_m * params.per_m * me.nature.x) * force);
    let factor = -substep.dt_s * params.per_m * me.nature.x;
    let free = v.xyz + accelerated;
    predicted[i] = vec4<f32>(free, v.w);
    corrected[i] = vec4<f32>(free + factor * along_walls(sums.push, wall), v.w);
}
