// Smoothed particles: the kernel, what stands in for walls, and the lists of neighbours.
//
// Lengths are in cells, for the kernel's support is one cell. A particle's volume v weighs the kernel,
// so that sum v_j W_ij is 1 where particles fill space as they should, whatever they weigh.

const PI: f32 = 3.14159265;
// Cubic spline of unit support in three dimensions (Monaghan 1992).
const SPLINE: f32 = 8.0 / PI;

// W.
fn weight(q: f32) -> f32 {
    let rest = 1.0 - q;
    return SPLINE * select(2.0 * rest * rest * rest, 6.0 * q * q * (q - 1.0) + 1.0, q <= 0.5);
}

// W' / q, so that the gradient is this times the distance vector.
fn steepness(q: f32) -> f32 {
    let rest = 1.0 - q;
    return SPLINE * select(-6.0 * rest * rest / max(q, 0.5), 18.0 * q - 12.0, q <= 0.5);
}

// W''.
fn bend(q: f32) -> f32 {
    return SPLINE * select(12.0 * (1.0 - q), 36.0 * q - 12.0, q <= 0.5);
}

// The same between a liquid particle and a solid one. A pressure acts on a boundary as on the liquid, with
// both sides' areas, if the boundary's part of the gradient is twice what is missing of the liquid's; that
// of the density stays what is missing. A narrower kernel has both.
fn solid_weight(q: f32) -> f32 {
    let w = weight(q);
    return SOLID_STRENGTH / SPLINE * w * w;
}

fn solid_steepness(q: f32) -> f32 {
    return 2.0 * SOLID_STRENGTH / SPLINE * weight(q) * steepness(q);
}

// What a wall at a distance adds to the density, likewise, and minus its derivative.
fn wall_density(s: f32) -> f32 {
    let depth = max(1.0 - s / WALL_REACH, 0.0);
    return WALL_STRENGTH * depth * depth;
}

fn wall_push(s: f32) -> f32 {
    return 2.0 * WALL_STRENGTH / WALL_REACH * max(1.0 - s / WALL_REACH, 0.0);
}

// Integral of W over a half-space that begins at a signed distance.
fn wall_share(s: f32) -> f32 {
    let a = min(abs(s), 1.0);
    let rest = 1.0 - a;
    let r5 = rest * rest * rest * rest * rest;
    let a3 = a * a * a;
    let far = 16.0 * r5 * (0.1 - rest / 15.0);
    let near_by = 0.5 - 16.0 * (0.0875 * a + a3 * (-1.0 / 6.0 + a * a * (0.3 - 0.2 * a)));
    let share = select(far, near_by, a < 0.5);
    return select(share, 1.0 - share, s < 0.0);
}

// Minus its derivative: W summed over a plane at that distance.
fn wall_slope(s: f32) -> f32 {
    let a = min(abs(s), 1.0);
    let rest = 1.0 - a;
    let r4 = rest * rest * rest * rest;
    let a2 = a * a;
    return 16.0 * select(r4 * (0.5 - 0.4 * rest), 0.0875 + a2 * (-0.5 + a2 * (1.5 - 1.2 * a)), a < 0.5);
}

// Derivative of that.
fn wall_bend(s: f32) -> f32 {
    let a = min(abs(s), 1.0);
    let rest = 1.0 - a;
    let slope = 16.0 * select(-2.0 * rest * rest * rest * (1.0 - rest), a * (-1.0 + 6.0 * a * a * (1.0 - a)), a < 0.5);
    return select(slope, -slope, s < 0.0);
}

// Entries of a particle's list: liquid neighbours from its front, solid ones from its back.
struct Near {
    liquids: u32,
    solids: u32,
    liquid: bool,
}

fn pack_near(n: Near) -> u32 {
    return n.liquids | (n.solids << 12u) | select(0u, 1u << 31u, n.liquid);
}

fn unpack_near(word: u32) -> Near {
    return Near(word & 0xfffu, (word >> 12u) & 0xfffu, (word >> 31u) != 0u);
}
