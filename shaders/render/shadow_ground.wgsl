// For whoever draws the plain ground: the factor on its colour. The pass that includes this declares
// `ground_map`, the buffer of the contact shadow.

fn ground_shade(p: vec2<f32>) -> f32 {
    let s = (p - vec2(ground_map[0], ground_map[1])) * ground_map[2];
    if any(s < vec2(1.0)) || any(s > vec2(f32(SIDE) - 1.0)) {
        return 1.0;
    }
    // A spline: smooth enough that no texel shows, however near the camera is.
    let cell = vec2<i32>(floor(s));
    let f = s - floor(s) - 0.5;
    var sum = 0.0;
    for (var k = 0; k < 9; k++) {
        let tap = vec2(k % 3, k / 3);
        let p = vec2<u32>(clamp(cell + tap - 1, vec2(0), vec2(i32(SIDE) - 1)));
        sum += spline(f.x, tap.x) * spline(f.y, tap.y) * ground_map[4u + p.y * SIDE + p.x];
    }
    return sum;
}
