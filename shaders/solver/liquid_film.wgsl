// How thick the liquid is that a wall's friction is shared among: all of a film that is too thin for the grid
// to resolve how it shears, so that it does not roll; else what the nodes at the wall have. A column of nodes
// is followed along the axis nearest to the wall's normal, as far as the spline of what lies on it reaches.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> colliders: array<Collider>;
@group(0) @binding(3) var<storage, read> share: array<vec4<f32>>;
// Metres of liquid that the wall brakes; the same again where that is a film, else 0.
@group(0) @binding(4) var<storage, read_write> film: array<vec2<f32>>;

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
    let wall = nearest_wall(position_of(node));
    if (wall.distance_m > 1.5 * params.cell_m) {
        film[node.index] = vec2<f32>(0.0);
        return;
    }
    var braked = 0.0;
    var all = 0.0;
    var fullest = 0.0;
    var clear = 0.0;
    var first = true;
    for (var k = -3; k <= 3; k++) {
        let step = wall.outward * k;
        let at = Node(0u, node.cell + step, 0u);
        let here = share[beside(node, step)];
        let poured = max(here.w - 1.0, 0.0);
        all += poured;
        if (touch(colliders[wall.collider], position_of(at)).distance_m <= 0.5 * params.cell_m) {
            braked += poured;
            fullest = max(fullest, here.x);
        } else if (first) {
            clear = here.x;
            first = false;
        }
    }
    let thin = clear < FILM_RESOLVED * fullest;
    // Beside another wall the column is narrower.
    let across = params.cell_m / max(room_beside(position_of(node), wall.collider), ROOM_LEAST);
    film[node.index] = select(vec2<f32>(braked, 0.0), vec2<f32>(all), thin) * across;
}
