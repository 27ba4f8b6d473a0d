// How full of liquid the room around each node is. Behind a wall there is no room: what the spline
// reaches on the free side counts as the whole, so that liquid at a wall is as dense as elsewhere, and
// its surface meets the wall at a right angle. Leaves the fill zeroed.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> colliders: array<Collider>;
@group(0) @binding(3) var<storage, read_write> fill: array<i32>;
// Rest volume over room, negative where there is no room; surface tension over density, m^3/s^2;
// kinematic viscosity, m^2/s; in active blocks 1 and the rest volume in volumes of a cell.
@group(0) @binding(4) var<storage, read_write> share: array<vec4<f32>>;
// Acceleration by surface tension, m/s^2; kinematic viscosity, m^2/s.
@group(0) @binding(5) var<storage, read_write> pull: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place >= active_blocks[0]) {
        return;
    }
    let node = node_of(place, lane);
    if (node.layer != 0u) {
        return;
    }
    let k = 3u * node.index;
    let poured = vec3<f32>(vec3<i32>(fill[k], fill[k + 1u], fill[k + 2u]));
    fill[k] = 0;
    fill[k + 1u] = 0;
    fill[k + 2u] = 0;
    let x = position_of(node);
    let room = room_beside(x, params.collider_count);
    let full = poured.x / FILL_UNITS;
    let of_liquid = select(0.0, 1.0 / full, poured.x > 0.0);
    let tension = poured.y * of_liquid / max(params.tension_units, 1e-30);
    let viscosity = poured.z * of_liquid / max(params.viscosity_units, 1e-30);
    share[node.index] = vec4<f32>(select(-1.0, full / room, room > ROOM_LEAST), tension, viscosity, 1.0 + full);
    pull[node.index] = vec4<f32>(0.0, 0.0, 0.0, viscosity);
}
