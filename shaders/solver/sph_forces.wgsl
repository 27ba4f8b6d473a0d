// Forces that do not depend on pressure: weight, what drives the object, surface tension, viscosity
// where it is not stiff.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> solve: Solve;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> objects: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> colliders: array<Collider>;
@group(0) @binding(5) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> nature: array<vec2<f32>>;
@group(0) @binding(7) var<storage, read> neighbours: array<u32>;
@group(0) @binding(8) var<storage, read> near: array<u32>;
@group(0) @binding(9) var<storage, read> surface: array<vec4<f32>>;
@group(0) @binding(10) var<storage, read> motion: array<vec4<f32>>;
@group(0) @binding(11) var<storage, read_write> predicted: array<vec4<f32>>;
var<immediate> substep: Substep;

// Surface tension between a pair, over the particle's volume and a common factor.
//
// The energy of a surface is that of the gradient n of what is filled, E = sum of V k |n|^2 / 2, of which
// this is the exact derivative: it smooths, and keeps momentum and spin. Alone it would spread; a pull
// between particles beyond KEEP_APART and a push between nearer ones hold it together.
fn tension(y: vec3<f32>, q: f32, mine: vec4<f32>, other: vec4<f32>, volume: f32, own_volume: f32) -> vec3<f32> {
    let steep = steepness(q);
    let along = y / max(q, 1e-6);
    let pull = mine.w * mine.xyz - other.w * other.xyz;
    let hessian = steep * pull + ((bend(q) - steep) * dot(pull, along)) * along;
    let rest = 1.0 - q;
    let held = COHESION * rest * rest * max(q - KEEP_APART, 0.0);
    // As between two of the eight particles of a full cell; lighter ones at an edge weigh in with their share.
    let share = 8.0 * min(volume / own_volume, 1.0);
    let apart = (KEEP_APART_STRENGTH * max(1.0 - q / KEEP_APART, 0.0) - held) * 0.5 * (mine.w + other.w) * share;
    return apart * along - (TENSION * volume) * hessian;
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
    let mine = place[i];
    let own = nature[i];
    let v = motion[i];
    let shape = surface[i];
    var tense = vec3<f32>(0.0);
    var viscous = vec3<f32>(0.0);
    var turbulent = vec3<f32>(0.0);
    let count = list.liquids + list.solids;
    for (var k = 0u; k < count; k++) {
        let liquid = k < list.liquids;
        let j = neighbours[select(solve.columns - 1u - (k - list.liquids), k, liquid) * n + i];
        let other = place[j];
        let y = (mine.xyz - other.xyz) * params.per_m;
        let q = length(y);
        let volume = abs(other.w);
        tense += tension(y, q, shape, surface[j], volume, abs(mine.w));
        let u = motion[j];
        let approach = dot(v.xyz - u.xyz, y);
        let factor = (volume * steepness(q) * approach / (q * q + SOFT_DISTANCE)) * y;
        viscous += couple_viscosity(v.w, u.w) * factor;
        let lightest = 2.0 / (own.x + nature[j].x);
        turbulent += (eddies(approach / max(q, 1e-6)) * lightest) * factor;
    }
    if (list.liquid) {
        for (var c = 0u; c < params.collider_count; c++) {
            let t = touch(colliders[c], mine.xyz);
            let s = t.distance_m * params.per_m;
            if (s >= 1.0) {
                continue;
            }
            let normal = surface_normal(colliders[c], t.face, mine.xyz);
            tense += (TENSION * own.y * dot(shape.xyz, normal) * wall_bend(s)) * normal;
            // A wall without friction lets the liquid slip.
            let drag = select(0.0, v.w * wall_drag(s), colliders[c].surface.x > 0.0);
            viscous -= drag * (v.xyz - normal * dot(v.xyz, normal));
        }
    }
    let object = bitcast<u32>(matter[3u * n + i].y) & 0xffffu;
    let weight_m_s2 = params.gravity_m_s2 + objects[object].xyz;
    let per_area = params.per_m * params.per_m * own.x;
    let viscous_now = select(vec3<f32>(0.0), viscous, substep.job == 0u);
    predicted[i] = vec4<f32>(v.xyz + substep.dt_s * (weight_m_s2 + per_area * (tense + VISCOUS * (viscous_now + turbulent))), v.w);
}
