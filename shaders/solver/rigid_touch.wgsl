// Which nodes meet a body, and how. Zeroes what the particles left.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> bodies: array<Body>;
@group(0) @binding(3) var<storage, read> shapes: array<Shape>;
@group(0) @binding(4) var<storage, read> field: array<f32>;
@group(0) @binding(5) var<storage, read> sums: array<vec4<i32>>;
@group(0) @binding(6) var<storage, read_write> nears: array<Near>;
@group(0) @binding(7) var<storage, read_write> meetings: array<Meeting>;
@group(0) @binding(8) var<storage, read_write> control: Control;
var<immediate> substep: Substep;

fn velocity_at(b: u32, x: vec3<f32>) -> vec3<f32> {
    let spin = spin_of(shapes[b].inverse, bodies[b].turn, bodies[b].angular_momentum.xyz);
    return bodies[b].velocity.xyz + cross(spin, x - bodies[b].centre.xyz);
}

fn settle(node: u32, x: vec3<f32>) {
    let near = nears[node];
    let sum = sums[node];
    if ((near.contact | near.bond) != 0u) {
        nears[node] = Near(0u, 0u, 0u, 0u);
    }
    meetings[node].rigid_kg = 0.0;
    if ((near.bonded | near.touched) == 0u || sum.w <= 0) {
        return;
    }
    let momentum_unit = momentum_units(substep.index, substep.lag);
    let soft_kg = f32(sum.w) / params.mass_units;
    let momentum = vec3<f32>(sum.xyz) / momentum_unit;
    // A node to which the body brings a good part of the mass moves with the body: these are the nodes up
    // to the joint. Fewer would leave the joint to the thin end of the soft particles' splines.
    if (near.bonded > 0u && near.bonded >= u32(sum.w) / 4u) {
        let rigid_kg = f32(near.bonded) / params.mass_units;
        meetings[node] = Meeting(vec3<f32>(0.0), 0.0, vec3<f32>(0.0), rigid_kg, momentum, soft_kg, near.bond - 1u);
        return;
    }
    if (near.touched == 0u) {
        return;
    }
    let b = near.contact & (SLIDES - 1u);
    let level = level_at(b, turned_back(bodies[b].turn, x - bodies[b].centre.xyz));
    let normal = turned(bodies[b].turn, level.gradient * inverseSqrt(max(dot(level.gradient, level.gradient), 1e-12)));
    // A gap may close; an overlap opens by a tenth in a substep, no faster than weight brings within a few of them: it makes
    // good what creeps, and what was put into a body is not shot out of it.
    let gap_m = near_gap_m(near.contact);
    let opening = 4.0 * length(params.gravity_m_s2) * substep.dt_s;
    let allowed = select(-gap_m / substep.dt_s, min(-0.1 * gap_m / substep.dt_s, opening), gap_m < 0.0);
    if (dot(momentum / soft_kg - velocity_at(b, x), normal) < allowed) {
        let rigid_kg = f32(near.touched) / params.mass_units;
        meetings[node] = Meeting(normal, allowed, vec3<f32>(0.0), rigid_kg, momentum, soft_kg, near.contact & 1023u);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place >= active_blocks[0]) {
        return;
    }
    let node = node_of(place, lane);
    settle(node.index, position_of(node));
}
