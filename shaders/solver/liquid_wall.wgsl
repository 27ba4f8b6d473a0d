// Thick liquids stick to walls: along them, speed grows in a straight line from 0 on the wall itself to
// what it is at the first node that stands clear of every wall. The nodes before that one, and those
// behind the wall, take their place on the line, as far as they are held (w of their velocity).

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> colliders: array<Collider>;
@group(0) @binding(3) var<storage, read_write> velocity: array<vec4<f32>>;

// Whether a node is farther than half a cell from all walls: no such node is changed here.
fn clear_of_walls(x: vec3<f32>) -> bool {
    for (var c = 0u; c < params.collider_count; c++) {
        if (touch(colliders[c], x).distance_m <= 0.5 * params.cell_m) {
            return false;
        }
    }
    return true;
}

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
    var wall = 0u;
    var nearest = Touch(1e30, 0u);
    for (var c = 0u; c < params.collider_count; c++) {
        let t = touch(colliders[c], x);
        if (abs(t.distance_m) < abs(nearest.distance_m)) {
            wall = c;
            nearest = t;
        }
    }
    let normal = surface_normal(colliders[wall], nearest.face, x);
    let size = abs(normal);
    let most = max(size.x, max(size.y, size.z));
    let inward = vec3<i32>(select(vec3<f32>(0.0), sign(normal), size == vec3<f32>(most)));
    var on_line = vec3<f32>(0.0);
    for (var k = 1; k <= 3; k++) {
        let other = Node(0u, node.cell + inward * k, node.layer);
        let at = position_of(other);
        if (clear_of_walls(at)) {
            let share = nearest.distance_m / touch(colliders[wall], at).distance_m;
            on_line = velocity[beside(node, inward * k)].xyz * clamp(share, -2.0, 1.0);
            break;
        }
    }
    let across = normal * dot(moving.xyz, normal);
    let along = mix(moving.xyz - across, on_line - normal * dot(on_line, normal), moving.w);
    velocity[node.index] = vec4<f32>(across + along, 0.0);
}
