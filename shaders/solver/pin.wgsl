// What pins hold, still or moving.
struct Pin {
    // As a collider's, in the captured pose of its object; w of `at`: 0 half-space, 1 box, 2 capsule or sphere.
    at: vec4<f32>,
    shape: vec4<f32>,
    // Box that it is limited to.
    low: vec4<f32>,
    high: vec4<f32>,
    // Where `centre` of the captured pose is at the start of the segment, how the object was turned about it to where it
    // started (columns), and the pin's velocity.
    shift: vec4<f32>,
    centre: vec4<f32>,
    turn: array<vec4<f32>, 3>,
    velocity: vec4<f32>,
}

// The velocity that a pin gives a node, and 1; zeros where none holds it.
fn pinned(x: vec3<f32>) -> vec4<f32> {
    for (var p = 0u; p < params.pin_count; p++) {
        let pin = pins[p];
        let way = x - (pin.shift.xyz + substep.since_s * pin.velocity.xyz);
        let place = vec3<f32>(dot(pin.turn[0].xyz, way), dot(pin.turn[1].xyz, way), dot(pin.turn[2].xyz, way)) + pin.centre.xyz;
        if (any(place < pin.low.xyz) || any(place > pin.high.xyz)) {
            continue;
        }
        if (touch(Collider(pin.at, pin.shape, vec4<f32>(0.0)), place).distance_m <= 0.0) {
            return vec4<f32>(pin.velocity.xyz, 1.0);
        }
    }
    return vec4<f32>(0.0);
}
