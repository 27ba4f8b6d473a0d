// A Gaussian on the screen. Its exponent at pixel p, in powers of two, is
//   e(p) = log2 opacity - log2(e) * (a dx^2 / 2 + b dx dy + c dy^2 / 2),   d = p - centre,
// with (a, b; b, c) the inverse of its covariance in pixels; alpha = 2^e.

struct Splat {
    shape: vec4<f32>,   // centre x, centre y, a log2(e) / 2, b log2(e)
    weight: vec4<f32>,  // c log2(e) / 2, log2 opacity, -b / c, -b / a
    colour: vec4<f32>,  // red, green, blue, camera z
}

fn exponent(shape: vec4<f32>, weight: vec4<f32>, p: vec2<f32>) -> f32 {
    let d = p - shape.xy;
    return weight.y - (shape.z * d.x * d.x + weight.x * d.y * d.y + shape.w * d.x * d.y);
}

// The largest exponent in a rectangle of pixel centres. A convex form is smallest, over a box that
// does not hold its centre, on a side that faces the centre: one candidate a side is exact.
fn largest_exponent(shape: vec4<f32>, weight: vec4<f32>, first: vec2<f32>, last: vec2<f32>) -> f32 {
    let nearest = clamp(shape.xy, first, last);
    let d = nearest - shape.xy;
    let on_column = vec2<f32>(nearest.x, clamp(shape.y + weight.z * d.x, first.y, last.y));
    let on_row = vec2<f32>(clamp(shape.x + weight.w * d.y, first.x, last.x), nearest.y);
    return max(exponent(shape, weight, on_column), exponent(shape, weight, on_row));
}
