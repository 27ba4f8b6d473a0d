// Surface tension as a pull between particles: they pull each other when farther apart than PULL_ZERO
// and push when nearer, so that a liquid holds together and its surface is as small as it can be.
//
// Of a pair, sigma V_i V_j pull(q) over cell, in cells. A sharp surface of a liquid without structure
// then has the tension sigma (Fowler 1937): (pi / 8) int q^4 pull dq = 1.

fn pull(q: f32) -> f32 {
    let rest = max(1.0 - q, 0.0);
    return PULL * rest * rest * (q - PULL_ZERO);
}

// Tension of a pair. A solid has none of its own and pulls by a share of the liquid's, so that the angle of
// contact has 1 + cos = 2 WETTING (Young and Dupré).
fn couple_tension(a: f32, b: f32, liquid: bool) -> f32 {
    return select(WETTING * (a + b), 0.5 * (a + b), liquid);
}

// All of a half-space's pull on a particle at a distance: pi int_s^1 pull (q^2 - s^2) dq.
fn wall_pull(s: f32) -> f32 {
    let c = clamp(s, 0.0, 1.0);
    let r = 1.0 - c;
    let a = 1.0 - PULL_ZERO;
    let b = 1.0 + c;
    let all = a * r * b / 3.0 + r * (-(a * r + a * b + r * b) / 4.0 + r * ((a + r + b) / 5.0 - r / 6.0));
    return PI * PULL * WETTING * r * r * r * all;
}
