// End of a substep: the last pressures, and the liquid moves. Solids take what the liquid gave them
// into their velocity; the grid adds their weight and moves them.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> solve: Solve;
@group(0) @binding(2) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> nature: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> neighbours: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> slopes: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> near: array<u32>;
@group(0) @binding(7) var<storage, read> density: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read> pressure: array<f32>;
@group(0) @binding(9) var<storage, read> base: array<vec4<f32>>;
@group(0) @binding(10) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(11) var<storage, read> objects: array<vec4<f32>>;
@group(0) @binding(12) var<storage, read> colliders: array<Collider>;
@group(0) @binding(13) var<storage, read_write> kinematics: array<vec4<f32>>;
// Pressure, how much too dense it may be, and how fast that changes, in the original order.
@group(0) @binding(14) var<storage, read_write> kept: array<vec4<f32>>;
@group(0) @binding(15) var<storage, read_write> control: Control;
var<immediate> substep: Substep;

// What the friction of walls leaves of a velocity: rough turbulent flow is braked by f / 8 rho v^2 (Darcy and
// Weisbach), shared among what is within a cell of the wall, by 2 (1 - s), and the more the thinner the liquid is spread
// there. By backward Euler, which can but brake. Along a wall without friction any liquid slips.
fn braked(x: vec3<f32>, v: vec3<f32>, full: f32) -> vec3<f32> {
    var u = v;
    for (var c = 0u; c < params.collider_count; c++) {
        let t = touch(colliders[c], x);
        let s = max(t.distance_m * params.per_m, 0.0);
        if (s < 1.0 && colliders[c].surface.x > 0.0) {
            let normal = surface_normal(colliders[c], t.face, x);
            let across = normal * dot(u, normal);
            let sliding = u - across;
            let rate = WALL_FRICTION * length(sliding) * 2.0 * (1.0 - s) * params.per_m / full;
            u = across + sliding / (1.0 + substep.dt_s * rate);
        }
    }
    return u;
}

// Moves what got behind a surface on its way back onto it, behind the ground last; it keeps no inward velocity. What was there
// before comes out as slowly as what is too dense thins out: neighbours feel how fast it comes, for they keep the density.
fn kept_out(from_x: vec3<f32>, x: vec3<f32>, v: vec3<f32>, rest_m: f32) -> array<vec3<f32>, 2> {
    var outside = x;
    var u = v;
    let eased_share = min(substep.dt_s * sqrt(EASE_OUT_M_S2 * params.per_m), 1.0);
    for (var k = params.collider_count; k > 0u; k--) {
        let c = k - 1u;
        let t = touch(colliders[c], outside);
        if (t.distance_m < rest_m) {
            let normal = surface_normal(colliders[c], t.face, outside);
            let depth_m = rest_m - t.distance_m;
            outside += normal * min(depth_m, max(dot(from_x - outside, normal), 0.0) + eased_share * depth_m);
            u -= normal * min(dot(u, normal), 0.0);
        }
    }
    return array<vec3<f32>, 2>(outside, u);
}

// How much too dense it may be after the substep, and how fast that changes: it goes as what a critically damped spring
// pulls, which starts without a jerk. By backward Euler.
fn eased(much: f32, rate: f32) -> vec2<f32> {
    let omega = sqrt(EASE_OUT_M_S2 * params.per_m);
    let step = omega * substep.dt_s;
    let next = (rate - omega * step * much) / ((1.0 + step) * (1.0 + step));
    return vec2<f32>(max(much + substep.dt_s * next, 0.0), next);
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let n = params.count;
    let i = min(id.x, n - 1u);
    let list = unpack_near(near[i]);
    let tag = matter[3u * n + i];
    let concerned = id.x < n && (list.liquid || list.liquids > 0u);
    var speed = 0.0;
    var momentum = 0.0;
    if (concerned) {
        var v = held_back(base[i].xyz + pushed(i, list));
        let position = kinematics[i];
        if (list.liquid) {
            // The density of liquid alone: walls hide hidden / (1 + hidden).
            let hidden = density[n + i].w;
            v = braked(position.xyz, v, clamp(density[i].w - hidden / (1.0 + hidden), 0.3, 1.0));
            let moved = kept_out(position.xyz, position.xyz + substep.dt_s * v, v, min(tag.z, 0.0));
            v = moved[1];
            kinematics[i] = vec4<f32>(moved[0], position.w);
            kinematics[n + i] = vec4<f32>(v, kinematics[n + i].w);
            let index = bitcast<u32>(tag.x);
            kept[index] = vec4<f32>(pressure[i], eased(nature[i].w, kept[index].z), 0.0);
            speed = length(v);
        } else {
            v -= substep.dt_s * (params.gravity_m_s2 + objects[bitcast<u32>(tag.y) & 0xffffu].xyz);
            kinematics[n + i] = vec4<f32>(v, kinematics[n + i].w);
            momentum = momentum_measure(position.w, v, read_affine(i));
        }
    }
    let momentum_most = subgroupMax(bitcast<u32>(momentum) & 0x7fffffffu);
    let speed_most = subgroupMax(bitcast<u32>(speed) & 0x7fffffffu);
    if (lane == 0u) {
        if (momentum_most > atomicLoad(&control.momentum[substep.index & 3u])) {
            atomicMax(&control.momentum[substep.index & 3u], momentum_most);
        }
        if (speed_most > atomicLoad(&control.speed)) {
            atomicMax(&control.speed, speed_most);
        }
    }
}
