// The cell that a particle is sorted into; outside the window, where a run is about to be rolled
// back, the nearest one.
fn clamped_cell(first: vec3<i32>) -> vec3<u32> {
    return vec3<u32>(clamp(first, vec3<i32>(0), vec3<i32>(params.blocks * 4u) - vec3<i32>(1)));
}
