// Whether a splat is drawn anywhere in a bin. Used where bins are counted and where they are emitted.
fn reaches(splat: Splat, bin: vec2<u32>) -> bool {
    let first = vec2<f32>(bin << vec2<u32>(frame.bin_shift)) + 0.5;
    let last = first + f32((1u << frame.bin_shift) - 1u);
    return largest_exponent(splat.shape, splat.weight, first, last) >= frame.alpha_min_log2 - EXPONENT_SLACK;
}
