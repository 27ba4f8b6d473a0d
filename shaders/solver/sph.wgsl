// Smoothed particles: the kernel, what stands in for walls, and the lists of neighbours.
//
// Lengths are in cells, for the kernel's support is one cell. A particle's volume v weighs the kernel,
// so that sum v_j W_ij is 1 where particles fill space as they should, whatever they weigh.

const PI: f32 = 3.14159265;
// Cubic spline of unit support in three dimensions (Monaghan 1992): this times 2 (1 - q)^3 - 8 (1/2 - q)^3,
// the second only where q < 1/2.
const SPLINE: f32 = 8.0 / PI;

// W.
fn weight(q: f32) -> f32 {
    let rest = 1.0 - q;
    let inner = max(0.5 - q, 0.0);
    return SPLINE * (2.0 * rest * rest * rest - 8.0 * inner * inner * inner);
}

// W' / q, so that the gradient is this times the distance vector.
fn steepness(q: f32) -> f32 {
    let rest = 1.0 - q;
    return SPLINE * select(-6.0 * rest * rest / max(q, 0.5), 18.0 * q - 12.0, q <= 0.5);
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

// W summed over a plane at a distance.
fn plane(s: f32) -> f32 {
    let a = min(abs(s), 1.0);
    let rest = 1.0 - a;
    let inner = max(0.5 - a, 0.0);
    let r2 = rest * rest;
    let i2 = inner * inner;
    return 16.0 * (r2 * r2 * (0.5 - 0.4 * rest) - i2 * i2 * (1.0 - 1.6 * inner));
}

// What a wall at a distance adds to the density: as if the liquid went on behind it in layers half a cell
// apart, each smeared over its plane. It is as much of the integral of -x dW/dx for x along the wall, which
// is 1: the share of a slope along the wall that particles on this side do not see.
fn wall_density(s: f32) -> f32 {
    return 0.5 * (plane(s + 0.25) + plane(s + 0.75));
}

// Minus its derivative.
fn wall_slope(s: f32) -> f32 {
    let a = abs(s + 0.25);
    let b = abs(s + 0.75);
    return PI * (a * weight(min(a, 1.0)) + b * weight(min(b, 1.0)));
}

// A push, with what is missing of it along walls. Walls are what `density` has of them.
fn along_walls(push: vec3<f32>, walls: vec4<f32>) -> vec3<f32> {
    let across = walls.xyz * (dot(push, walls.xyz) / max(dot(walls.xyz, walls.xyz), 1e-12));
    return push + walls.w * (push - across);
}

// Entries of a particle's list: liquid neighbours from its front, solid ones from its back, four at a time.
// What is left of the last four names the particle itself, which is at no distance and so does nothing.
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
