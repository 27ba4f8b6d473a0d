// What pins hold, still or moving.
struct Pin {
    // As a collider's, in the captured pose of its object; w of `at`: 0 half-space, 1 box, 2 capsule or sphere.
    at: vec4<f32>,
    shape: vec4<f32>,
    // Box that it is limited to; whom it holds: an object's bodies, and its layer of the grid.
    low: vec3<f32>,
    object: u32,
    high: vec3<f32>,
    layer: u32,
    // Where `centre` of the captured pose is at the start of the segment, how the part that is held was turned about it when
    // the pin began (columns), and the pin's velocity.
    shift: vec4<f32>,
    centre: vec4<f32>,
    turn: array<vec4<f32>, 3>,
    velocity: vec4<f32>,
}

// Whether a pin holds what is at a place.
fn holds(pin: Pin, x: vec3<f32>) -> bool {
    let way = x - (pin.shift.xyz + substep.since_s * pin.velocity.xyz);
    let place = vec3<f32>(dot(pin.turn[0].xyz, way), dot(pin.turn[1].xyz, way), dot(pin.turn[2].xyz, way)) + pin.centre.xyz;
    if (any(place < pin.low) || any(place > pin.high)) {
        return false;
    }
    return touch(Collider(pin.at, pin.shape, vec4<f32>(0.0)), place).distance_m <= 0.0;
}

// The velocity that a pin gives a node of a layer, and 1; zeros where none holds it.
fn pinned(x: vec3<f32>, layer: u32) -> vec4<f32> {
    for (var p = 0u; p < params.pin_count; p++) {
        if (pins[p].layer == layer && holds(pins[p], x)) {
            return vec4<f32>(pins[p].velocity.xyz, 1.0);
        }
    }
    return vec4<f32>(0.0);
}

// The same for a point of a body.
fn body_pinned(x: vec3<f32>, object: u32) -> vec4<f32> {
    for (var p = 0u; p < params.pin_count; p++) {
        if (pins[p].object == object && holds(pins[p], x)) {
            return vec4<f32>(pins[p].velocity.xyz, 1.0);
        }
    }
    return vec4<f32>(0.0);
}
