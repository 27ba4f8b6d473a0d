struct Substep {
    // Length of this substep, seconds.
    dt_s: f32,
    // Length of the next one; 0 at the end of a segment.
    dt_next_s: f32,
    // Counts from the start of the run.
    index: u32,
    // Which job a pass that has several does; 0 in a run.
    job: u32,
    // Seconds from the start of the segment to the start of this substep.
    since_s: f32,
    // 1 where the pass that ended the substep before also summed for this one.
    lag: u32,
}
