// The wall that is nearest to a place, and the way from it along the lattice. Walls without friction let any
// liquid slip, and do not count.

struct Wall {
    collider: u32,
    distance_m: f32,
    normal: vec3<f32>,
    // Step along the axis of the lattice that its normal is nearest to; several where they are equally near.
    outward: vec3<i32>,
}

fn nearest_wall(x: vec3<f32>) -> Wall {
    var collider = 0u;
    var nearest = Touch(1e30, 0u);
    for (var c = 0u; c < params.collider_count; c++) {
        let t = touch(colliders[c], x);
        if (colliders[c].surface.x > 0.0 && abs(t.distance_m) < abs(nearest.distance_m)) {
            collider = c;
            nearest = t;
        }
    }
    let normal = surface_normal(colliders[collider], nearest.face, x);
    let size = abs(normal);
    let most = max(size.x, max(size.y, size.z));
    let outward = vec3<i32>(select(vec3<f32>(0.0), sign(normal), size == vec3<f32>(most)));
    return Wall(collider, nearest.distance_m, normal, outward);
}

// Whether a node is farther than half a cell from all walls: none brakes it.
fn clear_of_walls(x: vec3<f32>) -> bool {
    for (var c = 0u; c < params.collider_count; c++) {
        if (colliders[c].surface.x > 0.0 && touch(colliders[c], x).distance_m <= 0.5 * params.cell_m) {
            return false;
        }
    }
    return true;
}
