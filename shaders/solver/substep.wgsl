struct Substep {
    // Length of this substep, seconds.
    dt_s: f32,
    // Length of the next one; 0 at the end of a segment.
    dt_next_s: f32,
    // Counts from the start of the run.
    index: u32,
    unused: u32,
}
