// Grid: momentum to velocity, gravity, contact, pins, still or moving. One workgroup for each active block. Leaves the
// sums and marks that it read zeroed for the next substep.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> colliders: array<Collider>;
@group(0) @binding(3) var<storage, read> pins: array<Pin>;
@group(0) @binding(4) var<storage, read_write> sums: array<vec4<i32>>;
@group(0) @binding(5) var<storage, read_write> marks: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> velocity: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> control: Control;
// Mass of each node where there are several layers, in units of the sums; negative where it is pinned.
@group(0) @binding(8) var<storage, read_write> masses: array<f32>;
var<immediate> substep: Substep;

// A node may approach as far as the nearest of its particles has room; then the normal part goes, or
// comes back by the restitution, and friction takes from the rest what Coulomb grants.
fn respond(v: vec3<f32>, mark: u32, x: vec3<f32>) -> vec3<f32> {
    let feature = mark & 1023u;
    let c = colliders[feature >> 3u];
    let normal = surface_normal(c, feature & 7u, x);
    let approach = dot(v, normal);
    let allowed = -mark_gap_m(mark) / substep.dt_s;
    if (approach >= allowed) {
        return v;
    }
    // Speeds that weight alone brings within a few substeps do not bounce.
    let resting = 4.0 * length(params.gravity_m_s2) * substep.dt_s;
    let bounced = c.surface.y * max(0.0, -approach - resting);
    let leaving = max(allowed, bounced);
    let sliding = v - normal * approach;
    let speed = length(sliding);
    let grip = select(c.surface.x, 0.0, (mark & SLIPS) != 0u) * (leaving - approach);
    let kept = select(0.0, 1.0 - grip / max(speed, 1e-20), speed > grip);
    return normal * leaving + sliding * kept;
}

fn weigh(node: u32, mass: f32) {
    if (params.layers > 1u) {
        masses[node] = mass;
    }
}

fn settle(at: Node) {
    let node = at.index;
    let sum = sums[node];
    // Before it is asked whether there is anything: a sum that wrapped looks like none.
    if (any(abs(sum) > vec4<i32>(1 << 30))) {
        atomicStore(&control.overflow, 1u);
    }
    if (sum.w <= 0) {
        if (any(sum != vec4<i32>(0))) {
            sums[node] = vec4<i32>(0);
        }
        marks[node] = vec2<u32>(0u);
        velocity[node] = vec4<f32>(0.0);
        weigh(node, 0.0);
        return;
    }
    let mark = marks[node];
    sums[node] = vec4<i32>(0);
    marks[node] = vec2<u32>(0u);
    let momentum_unit = momentum_units(substep.index, substep.lag);
    var v = vec3<f32>(sum.xyz) * (params.mass_units / momentum_unit) / f32(sum.w);
    let x = position_of(at);
    v += substep.dt_s * (params.gravity_m_s2 + liquid_pull(at).xyz);
    var held = 0.0;
    var mass = f32(sum.w);
    if (mark.y != 0u) {
        v = braked(respond(v, mark.y, x), mark.y, x, at);
        held = max(held, held_by(mark.y, x, at));
    }
    if (mark.x != 0u) {
        v = braked(respond(v, mark.x, x), mark.x, x, at);
        held = max(held, held_by(mark.x, x, at));
    }
    if (params.pin_count > 0u) {
        let pin = pinned(x, at.layer);
        v = select(v, pin.xyz, pin.w > 0.0);
        held = select(held, 0.0, pin.w > 0.0);
        mass = select(mass, -mass, pin.w > 0.0);
    }
    // Walls along which liquid sticks are the next pass's.
    velocity[node] = vec4<f32>(v, held);
    weigh(node, mass);
}

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place == 0u && lane == 0u) {
        atomicStore(&control.momentum[(substep.index + 1u) & 3u], 0u);
    }
    if (place >= active_blocks[0]) {
        return;
    }
    settle(node_of(place, lane));
}
