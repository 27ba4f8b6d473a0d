// What the grid's velocity does to a particle: moves it, deforms it, and prepares the stress that the next
// substep hands to the grid.

// F of what was torn from its neighbours grows without end. Scaled down it gives up energy, never
// gains any; what deforms as a whole never comes near.
fn held_together(f: mat3x3<f32>) -> mat3x3<f32> {
    let size2 = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]);
    return f * min(1.0, F_MOST * inverseSqrt(size2));
}

struct Moved {
    x: vec3<f32>,
    v: vec3<f32>,
    affine: mat3x3<f32>,
    // How large a momentum it may hand to a node, and its speed; 0 of what the grid does not carry.
    momentum: f32,
    speed: f32,
    carried: bool,
}

// What is known of a particle before the grid is asked: read early, so that the wait is shared.
struct Matter {
    position: vec4<f32>,
    label: vec4<f32>,
    f: mat3x3<f32>,
    mu: f32,
    lambda: f32,
    volume: f32,
}

fn matter_of(i: u32) -> Matter {
    let n = params.count;
    let rows = mat3x4<f32>(matter[i], matter[n + i], matter[2u * n + i]);
    let f = transpose(mat3x3<f32>(rows[0].xyz, rows[1].xyz, rows[2].xyz));
    return Matter(kinematics[i], matter[3u * n + i], f, rows[0].w, rows[1].w, rows[2].w);
}

// Writes all but the motion; `alive` is false of threads beyond the last particle.
fn moved(i: u32, m: Matter, gathered: Gathered, alive: bool) -> Moved {
    let position = m.position;
    let label = m.label;
    let n = params.count;
    let tag = bitcast<u32>(label.y);
    let gradient = gathered.gradient * (4.0 * params.per_m);
    let along = held_back(gathered.v);
    var x = position.xyz + substep.dt_s * along;
    var v = along + substep.dt_s * objects[tag & 0xffffu].xyz;

    // Whatever got behind a surface is put back on it and keeps no inward velocity; what was there before comes out little
    // by little. Liquid that stands nearer to one than it rests comes no nearer. The ground has the last word: where
    // surfaces leave no room between them nothing passes it.
    let rest_m = min(label.z, 0.0);
    let slips = m.mu == 0.0;
    for (var k = params.collider_count; k > 0u; k--) {
        let c = k - 1u;
        let t = touch(colliders[c], x);
        if (t.distance_m >= max(label.z, 0.0)) {
            continue;
        }
        let before_m = touch(colliders[c], position.xyz).distance_m;
        let nearest_m = select(rest_m, clamp(before_m, 0.0, max(label.z, 0.0)), slips);
        if (t.distance_m < nearest_m) {
            let normal = surface_normal(colliders[c], t.face, x);
            x += normal * min(nearest_m - t.distance_m, max(dot(position.xyz - x, normal), 0.0) + params.push_m);
            v -= normal * min(dot(v, normal), 0.0);
        }
    }
    v = held_back(v);

    let row = row_of(tag);
    let substance = substances[row];
    let flow = Flow(substep.dt_s, gradient, activation(row, substep.index + 1u));
    let answer = respond(substance, held_together(m.f + substep.dt_s * (gradient * m.f)), label.w, m.mu, m.lambda, flow);
    let weight = substep.dt_next_s * 4.0 * params.per_m * params.per_m * m.volume;
    let affine = position.w * gradient - weight * answer.tau;
    // A liquid beside the grid moves by itself, and what is rigid with its body.
    let carried = substance.kind != SPH_LIQUID && !is_rigid(tag);
    let momentum = select(0.0, momentum_measure(position.w, v, affine), carried);
    let speed = select(0.0, length(v), carried);
    if (alive && carried) {
        kinematics[i] = vec4<f32>(x, position.w);
        let rows = transpose(answer.f);
        matter[i] = vec4<f32>(rows[0], m.mu);
        matter[n + i] = vec4<f32>(rows[1], m.lambda);
        matter[2u * n + i] = vec4<f32>(rows[2], m.volume);
        remember(i, substance, answer, flow);
    }
    return Moved(x, v, affine, momentum, speed, carried);
}

// Bits of floats that are not negative are ordered as they are; those of a NaN are above all.
fn ordered_bits(value: f32) -> u32 {
    return bitcast<u32>(value) & 0x7fffffffu;
}

// Notes the largest momentum and speed of a subgroup.
fn note(momentum: u32, speed: u32, lane: u32) {
    let momentum_most = subgroupMax(momentum);
    let speed_most = subgroupMax(speed);
    if (lane == 0u) {
        let slot = (substep.index + 1u) & 3u;
        if (momentum_most > atomicLoad(&control.momentum[slot])) {
            atomicMax(&control.momentum[slot], momentum_most);
        }
        if (speed_most > atomicLoad(&control.speed)) {
            atomicMax(&control.speed, speed_most);
        }
    }
}
