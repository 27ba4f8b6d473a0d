// Room that walls leave around a node.

// Integral of the quadratic B-spline from minus infinity to t cells.
fn spline_before(t: f32) -> f32 {
    let a = abs(t);
    let far = max(1.5 - a, 0.0);
    let beyond = select(far * far * far * (1.0 / 6.0), 0.5 - a * (0.75 - a * a * (1.0 / 3.0)), a < 0.5);
    return select(beyond, 1.0 - beyond, t > 0.0);
}

// Share of a node's spline on the free side of all walls, or of all but one.
fn room_beside(x: vec3<f32>, but: u32) -> f32 {
    var room = 1.0;
    for (var c = 0u; c < params.collider_count; c++) {
        if (c != but) {
            room *= spline_before(touch(colliders[c], x).distance_m * params.per_m);
        }
    }
    return room;
}
