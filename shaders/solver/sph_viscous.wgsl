// Viscosity between particles, and of walls.

// Keeps couplings of what lies close together finite, cells squared.
const SOFT_DISTANCE: f32 = 0.01;

// Of a pair, Pa s; a solid has none of its own and takes the liquid's.
fn couple_viscosity(a: f32, b: f32) -> f32 {
    return select(a + b, 0.5 * (a + b), a > 0.0 && b > 0.0);
}

// Eddies that are too small to be seen brake what shears at the scale of particles (Smagorinsky 1963). No substep
// takes more than all of what particles approach by: without that bound what lands flat would fly apart.
fn eddies(approach: f32, dt_s: f32) -> f32 {
    return params.cell_m * min(EDDIES * abs(approach), EDDIES_MOST * params.cell_m / dt_s);
}

// Integral of the pair's coupling over a half-space at a distance, in which the velocity goes on as
// it falls off towards the wall, so that it is 0 on the wall (Morris et al. 1997).
fn wall_drag(s: f32) -> f32 {
    let q = clamp(s, 0.125, 1.0);
    let rest = 1.0 - q;
    let q2 = q * q;
    let q4 = q2 * q2;
    let r4 = rest * rest * rest * rest;
    let logarithm = 3.0 * q4 * log(q);
    let far = r4 * (0.5 - 0.4 * rest) - 0.05 + 2.0 * q2 * q + logarithm - q4 * (0.75 + 1.2 * q);
    let near_by = 0.04375 - (0.5 * q2 + q4 * (1.908883 - 2.4 * q) + logarithm);
    return (8.0 * WALL_VISCOUS / VISCOUS) * max(select(far, near_by, q < 0.5), 0.0) / q;
}
