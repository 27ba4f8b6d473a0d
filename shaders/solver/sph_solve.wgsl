// One of the two corrections that a substep makes: velocities that would compress (divergence), and
// what remains of density after the forces.

struct Solve {
    // Share of the density's own error in what is corrected: 1 or 0.
    of_density: f32,
    // Mean relative error that is small enough.
    tolerance: f32,
    // Rounds made in any case.
    least_rounds: u32,
    // Its first entry of `errors`.
    slot: u32,
    // Its first entry of `pressure`.
    pressure: u32,
    // Liquid particles.
    liquids: u32,
    // Entries of a list of neighbours.
    columns: u32,
}

// An error of density is small enough where it is that of a small share of a substep's free fall.
fn tolerated(dt_s: f32) -> f32 {
    let fall = max(length(params.gravity_m_s2), 1.0) * dt_s * dt_s * params.per_m;
    return clamp(SHARE_OF_FALL * fall, LEAST_ERROR, solve.tolerance);
}

// Where the round before this one counted its error.
fn slot_before(round: u32) -> u32 {
    return solve.slot + max(round, 1u) - 1u;
}

// Whether that error was small enough; errors are counted in sixteenths of the tolerance. A round that
// is left out counts none, so that those after it are left out too.
fn settled(round: u32, error: u32) -> bool {
    return round >= max(solve.least_rounds, 1u) && error <= 16u * solve.liquids;
}
