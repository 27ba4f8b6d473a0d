// The correction that a substep makes: of what would compress, and of the density that has drifted.

struct Solve {
    // Liquid particles.
    liquids: u32,
    // Entries of a list of neighbours, in fours.
    columns: u32,
    // Workgroups of a pass over all particles.
    groups: u32,
}

// Whether the error that the round before this one counted was small enough; errors are counted in sixteenths
// of the tolerance.
fn settled(round: u32, error: u32) -> bool {
    return round >= SPH_LEAST_ROUNDS && error <= 16u * solve.liquids;
}
