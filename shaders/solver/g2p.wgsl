// Grid to particles: gathers velocity and its gradient, moves, deforms, and prepares the stress that
// the next substep hands to the grid.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> velocity: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> colliders: array<Collider>;
// Acceleration of each object, beside gravity.
@group(0) @binding(5) var<storage, read> objects: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> control: Control;
@group(0) @binding(7) var<storage, read> substances: array<Substance>;
var<immediate> substep: Substep;

// F of what was torn from its neighbours grows without end. Scaled down it gives up energy, never
// gains any; what deforms as a whole never comes near.
fn held_together(f: mat3x3<f32>) -> mat3x3<f32> {
    let size2 = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]);
    return f * min(1.0, F_MOST * inverseSqrt(size2));
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let n = params.count;
    let i = min(id.x, n - 1u);
    let position = kinematics[i];
    var x = position.xyz;
    let base = base_node(x);
    let first = base - params.origin;
    let cell = vec3<u32>(clamp(first, vec3<i32>(0), vec3<i32>(params.blocks * 4u) - vec3<i32>(3)));
    let tag = matter[3u * n + i];
    let object = bitcast<u32>(tag.y);
    let gathered = gather(in_layer(stencil(x, base, cell), object));
    var v = gathered.v;
    let gradient = gathered.gradient * (4.0 * params.per_m);
    x += substep.dt_s * v;
    v += substep.dt_s * objects[object & 0xffffu].xyz;

    // Whatever got behind a surface is put back on it and keeps no inward velocity.
    // Liquid that stands nearer to one than it rests comes no nearer.
    let rest_m = min(tag.z, 0.0);
    let slips = matter[i].w == 0.0;
    for (var c = 0u; c < params.collider_count; c++) {
        let t = touch(colliders[c], x);
        let before_m = touch(colliders[c], position.xyz).distance_m;
        let nearest_m = select(rest_m, clamp(before_m, 0.0, max(tag.z, 0.0)), slips);
        if (t.distance_m < nearest_m) {
            let normal = surface_normal(colliders[c], t.face, x);
            x += normal * (nearest_m - t.distance_m);
            v -= normal * min(dot(v, normal), 0.0);
        }
    }

    let old = read_deformation(i);
    let row = row_of(object);
    let substance = substances[row];
    let flow = Flow(substep.dt_s, gradient, activation(row, substep.index + 1u));
    let answer = respond(substance, held_together(old + substep.dt_s * (gradient * old)), tag.w, matter[i].w, matter[n + i].w, flow);
    let weight = substep.dt_next_s * 4.0 * params.per_m * params.per_m * matter[2u * n + i].w;
    let affine = position.w * gradient - weight * answer.tau;
    // A liquid beside the grid moves by itself, and what is rigid with its body.
    let carried = substance.kind != SPH_LIQUID && !is_rigid(object);
    let momentum = select(0.0, momentum_measure(position.w, v, affine), carried);
    let speed = select(0.0, length(v), carried);
    if (id.x < n && carried) {
        kinematics[i] = vec4<f32>(x, position.w);
        write_motion(i, v, affine);
        let rows = transpose(answer.f);
        matter[i] = vec4<f32>(rows[0], matter[i].w);
        matter[n + i] = vec4<f32>(rows[1], matter[n + i].w);
        matter[2u * n + i] = vec4<f32>(rows[2], matter[2u * n + i].w);
        remember(i, substance, answer, flow);
    }
    // Bits of floats that are not negative are ordered as they are; those of a NaN are above all.
    let momentum_most = subgroupMax(bitcast<u32>(momentum) & 0x7fffffffu);
    let speed_most = subgroupMax(bitcast<u32>(speed) & 0x7fffffffu);
    if (lane == 0u) {
        let slot = (substep.index + 1u) & 1u;
        if (momentum_most > atomicLoad(&control.momentum[slot])) {
            atomicMax(&control.momentum[slot], momentum_most);
        }
        if (speed_most > atomicLoad(&control.speed)) {
            atomicMax(&control.speed, speed_most);
        }
    }
}
