// Numbers that passes hand on to each other and to the watch at the end of a segment.

struct Control {
    // Bits of the largest measure of momentum of any particle at the start of a substep, for four of them in turn.
    momentum: array<atomic<u32>, 4>,
    // Bits of the largest speed since the watch was reset.
    speed: atomic<u32>,
    // 1 where a fixed-point sum came near its range.
    overflow: atomic<u32>,
    // 1 where a particle came near the window's edge.
    window: atomic<u32>,
    // Particles that are not finite, at the end of the segment.
    nonfinite: atomic<u32>,
    // Smallest and largest determinant of F, order-preserving bits, at the end of the segment.
    j_low: atomic<u32>,
    j_high: atomic<u32>,
    // Objects with a particle that is not finite or inverted, bit object & 31.
    suspects: atomic<u32>,
    // Lattice bounds of the stencils' first nodes, at the end of the segment.
    low_x: atomic<i32>,
    low_y: atomic<i32>,
    low_z: atomic<i32>,
    high_x: atomic<i32>,
    high_y: atomic<i32>,
    high_z: atomic<i32>,
    // Bits of the largest speed at the end of the segment.
    final_speed: atomic<u32>,
    // Bits of the largest speed that bounds a substep, at the end of the segment.
    wave_speed: atomic<u32>,
    // 1 where a list of neighbours was too short.
    crowded: atomic<u32>,
    // Most blocks that the grid was asked to store.
    blocks: atomic<u32>,
    // 1 where a body touched more things than it has slots for.
    unmet: atomic<u32>,
    // Particles, at the end of the segment, that are inside out under a law that does not follow it.
    inside_out: atomic<u32>,
}

// Power of two that brings the momenta of a substep to `momentum_bits`. Where the sums are made before all
// of them are known, those of the substep before have to do, with `lag` bits to spare.
fn momentum_units(time: u32, lag: u32) -> f32 {
    let largest = bitcast<f32>(atomicLoad(&control.momentum[(time - lag) & 3u]));
    let exponent = (bitcast<u32>(max(largest, params.momentum_floor)) >> 23u) + 1u + lag;
    return bitcast<f32>((254u + params.momentum_bits - min(exponent, 254u)) << 23u);
}
