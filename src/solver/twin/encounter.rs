//! `encounter.wgsl`: contact between the layers of the grid.

use super::{Grid, Surroundings, pinned};
use crate::solver::constants::{FAINT_SLOPE, FAR_SLOPE, MEETING_ROUNDS, SURFACE_SLOPE};
use glam::{DVec3, Vec3};

/// One layer at one node.
struct Side {
    layer: usize,
    v: DVec3,
    mass: f64,
    /// 1 / mass, 0 where it is pinned.
    ease: f64,
    /// Gradient of mass, a cell.
    slope: DVec3,
}

/// Lets the layers meet, after [`super::grid`].
pub fn encounter(layers: &mut [Grid], surfaces: &[[f32; 2]], around: &Surroundings, dt_s: f32) {
    let mut nodes: Vec<[i32; 3]> = layers.iter().flat_map(|grid| grid.keys().copied()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    for node in nodes {
        let x = Vec3::new(node[2] as f32, node[1] as f32, node[0] as f32) * around.params.cell_m;
        let side = |(layer, grid): (usize, &Grid)| {
            let found = grid.get(&node)?;
            let held = around.pins.iter().any(|pin| pinned(pin, layer as u32, x, 0.0));
            let ease = if held { 0.0 } else { 1.0 / found.mass };
            Some(Side { layer, v: found.velocity.as_dvec3(), mass: found.mass, ease, slope: slope(grid, node) })
        };
        let mut sides: Vec<Side> = layers.iter().enumerate().filter_map(side).collect();
        for _ in 0..if sides.len() == 2 { 1 } else { MEETING_ROUNDS } {
            for j in 1..sides.len() {
                let (before, rest) = sides.split_at_mut(j);
                // In the order of the shader: each pair once a round, by its first side.
                for a in before.iter_mut() {
                    meet(a, &mut rest[0], surfaces, f64::from(around.params.cell_m), f64::from(dt_s));
                }
            }
        }
        for side in sides {
            if let Some(found) = layers[side.layer].get_mut(&node) {
                found.velocity = side.v.as_vec3();
            }
        }
    }
}

fn slope(grid: &Grid, node: [i32; 3]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for k in 0..27 {
        let step = [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1];
        let mass = grid.get(&[node[0] + step[2], node[1] + step[1], node[2] + step[0]]).map_or(0.0, |n| n.mass);
        let weight = |axis: usize| if step[axis] == 0 { 2.0 } else { 1.0 };
        let of = |axis: usize| f64::from(step[axis]) * mass * weight((axis + 1) % 3) * weight((axis + 2) % 3) / 32.0;
        sum += DVec3::new(of(0), of(1), of(2));
    }
    sum
}

/// Cells to the surface of a half-space.
pub fn ahead(relative: f64) -> f64 {
    let r = relative.max(0.08) / f64::from(SURFACE_SLOPE);
    if r < 1.0 { 0.76 * r.ln() } else { 1.5 - 3.0 / (1.0 + r.powf(0.7225)) }
}

fn between(a: &Side, b: &Side, by_a: bool) -> DVec3 {
    let (larger, own, other) = if by_a { (a, -a.slope, b.slope) } else { (b, b.slope, -a.slope) };
    let deep = own.length() < f64::from(FAINT_SLOPE) * larger.mass;
    if deep { other } else { own }.normalize_or_zero()
}

fn meet(a: &mut Side, b: &mut Side, surfaces: &[[f32; 2]], cell_m: f64, dt_s: f64) {
    let ease = a.ease + b.ease;
    let normal = between(a, b, surfaces[a.layer][1] > surfaces[b.layer][1]);
    let far = |s: &Side| s.slope.length() > f64::from(FAR_SLOPE) * s.mass;
    if ease == 0.0 || far(a) || far(b) || normal == DVec3::ZERO {
        return;
    }
    let friction = (f64::from(surfaces[a.layer][0]) * f64::from(surfaces[b.layer][0])).sqrt();
    let gap_m = cell_m * (ahead(-a.slope.dot(normal) / a.mass) + ahead(b.slope.dot(normal) / b.mass));
    let relative = a.v - b.v;
    let approach = relative.dot(normal);
    let stopped = approach - gap_m.max(0.0) / dt_s;
    if stopped > 0.0 {
        let sliding = relative - normal * approach;
        let held = (friction * stopped / sliding.length().max(1e-20)).min(1.0);
        let impulse = (normal * stopped + sliding * held) / ease;
        a.v -= impulse * a.ease;
        b.v += impulse * b.ease;
    }
}
