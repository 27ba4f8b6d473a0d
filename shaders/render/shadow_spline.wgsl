// The quadratic B-spline: weights of three neighbours that add up to 1 and have no kink.

/// Weight of tap 0, 1 or 2 where the point lies `f` beyond the middle of tap 1, within half a texel.
fn spline(f: f32, tap: i32) -> f32 {
    let d = abs(f - f32(tap - 1));
    return select(0.75 - d * d, 0.5 * (1.5 - d) * (1.5 - d), d > 0.5);
}
