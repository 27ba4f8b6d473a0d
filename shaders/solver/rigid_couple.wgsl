// Nodes that meet a body respond to it as it will move: what is bonded moves with it, what touches
// it may leave but not enter, with Coulomb's friction. From here on their momentum is what they give the body.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> bodies: array<Body>;
@group(0) @binding(3) var<storage, read> shapes: array<Shape>;
@group(0) @binding(4) var<storage, read> predicted: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> meetings: array<Meeting>;

fn respond(node: u32, x: vec3<f32>) {
    let meeting = meetings[node];
    if (meeting.rigid_kg == 0.0) {
        return;
    }
    let b = meeting.body & (SLIDES - 1u);
    let v = meeting.momentum / meeting.soft_kg;
    let body_v = predicted[2u * b].xyz + cross(predicted[2u * b + 1u].xyz, x - bodies[b].centre.xyz);
    var after = body_v;
    if (any(meeting.normal != vec3<f32>(0.0))) {
        let u = v - body_v;
        let approach = dot(u, meeting.normal);
        if (approach >= meeting.allowed_m_s) {
            meetings[node].rigid_kg = 0.0;
            return;
        }
        let sliding = u - meeting.normal * approach;
        let speed = length(sliding);
        let grip = select(shapes[b].friction, 0.0, (meeting.body & SLIDES) != 0u) * (meeting.allowed_m_s - approach);
        let kept = select(0.0, 1.0 - grip / max(speed, 1e-20), speed > grip);
        after = body_v + meeting.normal * meeting.allowed_m_s + sliding * kept;
    }
    meetings[node].momentum = meeting.soft_kg * (v - after);
}

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place >= active_blocks[0]) {
        return;
    }
    let node = node_of(place, lane);
    respond(node.index, position_of(node));
}
