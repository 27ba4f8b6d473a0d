// Thick liquids stick to walls: along them, speed grows in a straight line from 0 on the wall itself to
// what it is at the first node that stands clear of every wall. The nodes before that one, and those
// behind the wall, take their place on the line, as far as they are held (w of their velocity).

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> colliders: array<Collider>;
@group(0) @binding(3) var<storage, read_write> velocity: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place >= active_blocks[0]) {
        return;
    }
    hold(node_of(place, lane));
}

fn hold(node: Node) {
    let moving = velocity[node.index];
    if (moving.w <= 0.0) {
        return;
    }
    let x = position_of(node);
    let wall = nearest_wall(x);
    let normal = wall.normal;
    var on_line = vec3<f32>(0.0);
    for (var k = 1; k <= 3; k++) {
        let other = Node(0u, node.cell + wall.outward * k, node.layer);
        let at = position_of(other);
        if (clear_of_walls(at)) {
            let share = wall.distance_m / touch(colliders[wall.collider], at).distance_m;
            on_line = velocity[beside(node, wall.outward * k)].xyz * clamp(share, -2.0, 1.0);
            break;
        }
    }
    let across = normal * dot(moving.xyz, normal);
    let along = mix(moving.xyz - across, on_line - normal * dot(on_line, normal), moving.w);
    velocity[node.index] = vec4<f32>(across + along, 0.0);
}
