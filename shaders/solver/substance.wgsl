// What particles are made of: a row of the table for each substance, named by bits 16 to 30 of a
// particle's tag. Moduli and density are the particle's own.

struct Substance {
    // ELASTIC and so on.
    kind: u32,
    // Of what is elastic: 1 neo-Hookean, 0 fixed corotated.
    model: u32,
    // Bounds of the stretch that its Gaussians show; the upper one is 0 where they show F.
    shown_least: f32,
    shown_most: f32,
    // The law's own numbers, in the order of `src/solver/substance.rs`.
    values: array<f32, 5>,
    // How it flows for the eye: 1 for grains, 2 for pastes, 3 for liquids, 0 for what keeps its shape. What froze goes on as it
    // was. See `Flow` in Rust.
    flow: f32,
}

fn row_of(tag: u32) -> u32 {
    return (tag >> 16u) & 0x7fffu;
}

// How a substep deforms a particle.
struct Flow {
    // 0 where nothing but the stress of a present state is asked for.
    dt_s: f32,
    // Of velocity, 1/s.
    gradient: mat3x3<f32>,
    // Of a muscle, 0 to 1.
    activation: f32,
}

// What the law makes of a trial F: the elastic part that stays, what it remembers, its Kirchhoff stress.
struct Answer {
    f: mat3x3<f32>,
    history: f32,
    tau: mat3x3<f32>,
}

// Young's modulus from Lame's two.
fn young(mu: f32, lambda: f32) -> f32 {
    return mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
}

// What bounds a substep: dt <= cfl cell / (sqrt(this / density) + |v|). More where a law stiffens.
//
// A particle alone on its nodes swings fastest when it breathes, with the square of the angular frequency
// 4 (3 lambda + 2 mu) / (density cell^2); many particles swing no faster than the fastest of them would alone (Irons
// and Treharne 1971). So dt <= cell sqrt(density / (3 lambda + 2 mu)) is stable, of which BREATH is taken.
fn step_modulus(s: Substance, history: f32, mu: f32, lambda: f32) -> f32 {
    let passive = BREATHING * (3.0 * lambda + 2.0 * mu);
    switch (s.kind) {
        case SNOW: { return passive * snow_stiffening(s, history); }
        // A fibre that pulls with E a adds twice that to the stiffness along it; a is at most 1.
        case MUSCLE: { return passive + 2.0 * BREATHING * young(mu, lambda); }
        // Shear that relaxes within a substep hardly stiffens.
        case LIQUID: { return lambda * (1.0 + 4.0 / 3.0 * s.values[0] / (s.values[0] + lambda * USUAL_STEP_S)); }
        default: { return passive; }
    }
}

// As much as capillary waves of the length of a cell run on: dt <= 0.4 sqrt(rho cell^3 / (2 pi sigma))
// is the acoustic bound of 2 pi sigma / cell (Brackbill et al. 1992).
fn capillary_modulus(s: Substance, per_m: f32) -> f32 {
    return select(0.0, 6.2831853 * s.values[1] * per_m, s.kind == LIQUID);
}

// Stomakhin et al. 2013: what is packed is stiffer, as far as substeps follow. `packing` is the plastic part of det F.
fn snow_stiffening(s: Substance, packing: f32) -> f32 {
    return min(exp(s.values[2] * (1.0 - packing)), s.values[3]);
}
