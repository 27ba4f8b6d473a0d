//! `liquid_*.wgsl`: what is poured on the nodes and what follows from it, by sums over all nodes.

use super::{Grid, Surroundings, stencil};
use crate::solver::constants::{CALM, FILM_RESOLVED, FULL, LIQUID_J_LEAST, LIQUID_J_LOOSE, ROOM_LEAST, SURFACE_LEAST};
use crate::solver::obstacles::ColliderRecord;
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// What a node holds of liquid.
#[derive(Clone, Copy, Debug, Default)]
pub struct Poured {
    /// Rest volume, in volumes of a cell.
    pub volume: f64,
    /// That volume's mean surface tension over density.
    pub tension_m3_s2: f64,
    /// Its mean kinematic viscosity.
    pub viscosity_m2_s: f64,
}

/// Nodes that any particle reaches.
pub type Pool = BTreeMap<[i32; 3], Poured>;

/// `liquid_fill.wgsl`, with means in place of sums.
pub fn pool(states: &[ParticleState], around: &Surroundings) -> Pool {
    let mut pool = Pool::new();
    for s in states {
        let (viscosity_pa_s, surface_tension_n_m) = match around.substances[s.substance()] {
            Substance::Liquid { viscosity_pa_s, surface_tension_n_m } => (viscosity_pa_s, surface_tension_n_m),
            Substance::Viscoplastic { viscosity_pa_s, .. } if viscosity_pa_s > 0.0 => (viscosity_pa_s, 0.0),
            _ => continue,
        };
        let density = f64::from(s.mass_kg / s.volume_m3);
        for (node, weight, _) in stencil(s.position_m, &around.params) {
            let amount = f64::from(weight) * f64::from(s.volume_m3) * f64::from(around.params.per_m).powi(3);
            let node = pool.entry(node).or_default();
            node.volume += amount;
            node.tension_m3_s2 += amount * f64::from(surface_tension_n_m) / density;
            node.viscosity_m2_s += amount * f64::from(viscosity_pa_s) / density;
        }
    }
    for node in pool.values_mut() {
        node.tension_m3_s2 /= node.volume;
        node.viscosity_m2_s /= node.volume;
    }
    pool
}

/// Share of the quadratic spline before t, by summing slices of it.
fn spline_before(t: f64) -> f64 {
    let slices = 3000;
    let width = 3.0 / f64::from(slices);
    let spline = |x: f64| if x.abs() < 0.5 { 0.75 - x * x } else { 0.5 * (1.5 - x.abs()).max(0.0).powi(2) };
    (0..slices).map(|k| -1.5 + (f64::from(k) + 0.5) * width).filter(|&x| x < t).map(|x| spline(x) * width).sum()
}

/// The fields over the nodes of active blocks; the others are empty.
pub struct Fields<'a> {
    around: &'a Surroundings<'a>,
    /// What each node of a particle's stencil holds.
    pub pool: Pool,
    full: BTreeMap<[i32; 3], Option<f64>>,
    slopes: BTreeMap<[i32; 3], DVec3>,
}

impl<'a> Fields<'a> {
    /// `active` lists the nodes of active blocks.
    pub fn new(states: &[ParticleState], around: &'a Surroundings, active: &[[i32; 3]]) -> Fields<'a> {
        let mut fields = Fields { around, pool: pool(states, around), full: BTreeMap::new(), slopes: BTreeMap::new() };
        // How full the room around a node is, none where there is no room.
        fields.full = active.iter().map(|&node| (node, fields.fullness(node))).collect();
        fields.slopes = active.iter().map(|&node| (node, fields.gradient(node))).collect();
        fields
    }

    /// Share of a node's spline on the free side of all walls, or of all but one.
    fn room(&self, node: [i32; 3], but: Option<&ColliderRecord>) -> f64 {
        let walls = self.around.colliders.iter().filter(|c| but.is_none_or(|but| !std::ptr::eq(*c, but)));
        walls.map(|c| spline_before(f64::from(c.touch(place(node, self.around)).distance_m * self.around.params.per_m))).product()
    }

    /// `liquid_share.wgsl`.
    fn fullness(&self, node: [i32; 3]) -> Option<f64> {
        let room = self.room(node, None);
        (room > f64::from(ROOM_LEAST)).then(|| self.pool.get(&node).map_or(0.0, |n| n.volume) / room)
    }

    /// How full the room around a node is.
    pub fn full(&self, node: [i32; 3]) -> Option<f64> {
        self.full.get(&node).copied().unwrap_or(Some(0.0))
    }

    /// `liquid_slope.wgsl`: gradient of the fullness, per metre.
    fn gradient(&self, node: [i32; 3]) -> DVec3 {
        let Some(here) = self.full(node) else { return DVec3::ZERO };
        let [x, y, z] = differences(|by| DVec3::splat(self.full(step(node, by)).unwrap_or(here)));
        DVec3::new(x.x, y.x, z.x) * f64::from(self.around.params.per_m)
    }

    /// Cells times the gradient of fullness.
    pub fn steepness(&self, node: [i32; 3]) -> f64 {
        self.slopes.get(&node).map_or(0.0, |g| g.length() * f64::from(self.around.params.cell_m))
    }

    fn normal(&self, node: [i32; 3]) -> Option<DVec3> {
        let gradient = self.slopes.get(&node)?;
        (self.steepness(node) >= f64::from(SURFACE_LEAST)).then(|| gradient.normalize())
    }

    /// `liquid_tension.wgsl`: acceleration by surface tension, m/s^2.
    pub fn pull(&self, node: [i32; 3]) -> DVec3 {
        let (Some(here), Some(own)) = (self.full(node), self.normal(node)) else { return DVec3::ZERO };
        let cell_m = f64::from(self.around.params.cell_m);
        let [x, y, z] = differences(|by| self.normal(step(node, by)).unwrap_or(own));
        let curved = (-(x.x + y.y + z.z)).clamp(-1.0, 1.0) / cell_m;
        let gradient = self.slopes[&node];
        let depth_m = ((here - 0.5) / gradient.length()).clamp(-1.5 * cell_m, 1.5 * cell_m);
        let tension = self.pool.get(&node).map_or(0.0, |n| n.tension_m3_s2);
        gradient * (2.0 * tension * curved / (1.0 + 0.5 * curved * depth_m).max(0.3))
    }

    /// `liquid_density.wgsl`: the J of a particle after `span_s`.
    pub fn density(&self, s: &ParticleState, span_s: f64) -> f64 {
        let params = &self.around.params;
        let seen: Vec<_> =
            stencil(s.position_m, params).into_iter().filter_map(|(node, weight, _)| Some((self.full(node)?, f64::from(weight)))).collect();
        let j = f64::from(s.f().determinant());
        let really = seen.iter().map(|(_, w)| w).sum::<f64>() / seen.iter().map(|(f, w)| f * w).sum::<f64>();
        let really = really.clamp(f64::from(LIQUID_J_LEAST), f64::from(LIQUID_J_LOOSE));
        let most = seen.iter().map(|&(f, _)| f).fold(0.0, f64::max);
        if seen.iter().any(|&(f, _)| f < f64::from(FULL) * most.min(1.0)) && really >= j {
            return j;
        }
        let sound_m_s = f64::from(s.lambda_pa * s.volume_m3 / s.mass_kg).sqrt();
        j + (f64::from(CALM) * sound_m_s * f64::from(params.per_m) * span_s).min(0.5) * (really - j).clamp(-0.1, 0.1)
    }
}

/// Steps to the neighbours of a node, as coordinates x, y, z.
fn steps() -> impl Iterator<Item = [i32; 3]> {
    (0..27).map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1])
}

fn step(node: [i32; 3], by: [i32; 3]) -> [i32; 3] {
    [node[0] + by[2], node[1] + by[1], node[2] + by[0]]
}

/// Central differences of a field, smoothed across, per cell.
fn differences(of: impl Fn([i32; 3]) -> DVec3) -> [DVec3; 3] {
    let mut sums = [DVec3::ZERO; 3];
    for by in steps() {
        for (axis, sum) in sums.iter_mut().enumerate() {
            let across: f64 = (0..3).filter(|&a| a != axis).map(|a| [0.5, 1.0, 0.5][(by[a] + 1) as usize]).product();
            *sum += of(by) * (f64::from(by[axis]) * across / 8.0);
        }
    }
    sums
}

/// The walls that hold liquid.
fn rough<'a>(around: &'a Surroundings) -> impl Iterator<Item = &'a ColliderRecord> {
    around.colliders.iter().filter(|c| c.surface[0] > 0.0)
}

/// A node's nearest wall, its normal, and the step away from it along the lattice.
fn beside_wall<'a>(node: [i32; 3], around: &'a Surroundings) -> (&'a ColliderRecord, Vec3, [i32; 3]) {
    let x = place(node, around);
    let wall = rough(around).min_by(|a, b| a.touch(x).distance_m.abs().total_cmp(&b.touch(x).distance_m.abs())).expect("a wall");
    let normal = wall.normal(wall.touch(x).face, x);
    (wall, normal, normal.to_array().map(|n| if n.abs() == normal.abs().max_element() { n.signum() as i32 } else { 0 }))
}

fn place(node: [i32; 3], around: &Surroundings) -> Vec3 {
    Vec3::new(node[2] as f32, node[1] as f32, node[0] as f32) * around.params.cell_m
}

impl Fields<'_> {
    /// `liquid_film.wgsl`: metres of liquid that the wall brakes, and again where that is a film.
    pub fn film_m(&self, node: [i32; 3]) -> [f64; 2] {
        let cell_m = self.around.params.cell_m;
        let (wall, _, away) = beside_wall(node, self.around);
        let distance_m = |n: [i32; 3]| wall.touch(place(n, self.around)).distance_m;
        if distance_m(node) > 1.5 * cell_m {
            return [0.0; 2];
        }
        let column = || (-3..=3).map(|k| step(node, away.map(|a| a * k)));
        let across_m = f64::from(cell_m) / self.room(node, Some(wall)).max(f64::from(ROOM_LEAST));
        let poured = |n: [i32; 3]| self.pool.get(&n).map_or(0.0, |p| p.volume) * across_m;
        let full = |n: [i32; 3]| self.full(n).unwrap_or(-1.0);
        let at_wall = || column().filter(|&n| distance_m(n) <= 0.5 * cell_m);
        let clear = column().find(|&n| distance_m(n) > 0.5 * cell_m).map_or(0.0, full);
        let thin = clear < f64::from(FILM_RESOLVED) * at_wall().map(full).fold(0.0, f64::max);
        let braked = |of: f64| [of, if thin { of } else { 0.0 }];
        if thin { braked(column().map(poured).sum()) } else { braked(at_wall().map(poured).sum()) }
    }
}

/// `liquid_wall.wgsl`: the velocity of a node, from those that the grid's pass left.
pub fn wall(grid: &Grid, node: [i32; 3], around: &Surroundings) -> Vec3 {
    let cell_m = around.params.cell_m;
    let (wall, normal, away) = beside_wall(node, around);
    let (here, value) = (wall.touch(place(node, around)), &grid[&node]);
    let is_clear = |n: &[i32; 3]| rough(around).all(|c| c.touch(place(*n, around)).distance_m > 0.5 * cell_m);
    let on_line = (1..=3).map(|k| step(node, away.map(|a| a * k))).find(is_clear).map_or(Vec3::ZERO, |clear| {
        let share = here.distance_m / wall.touch(place(clear, around)).distance_m;
        grid.get(&clear).map_or(Vec3::ZERO, |n| n.velocity) * share.clamp(-2.0, 1.0)
    });
    let along = |v: Vec3| v - normal * v.dot(normal);
    value.velocity - along(value.velocity) * value.held + along(on_line) * value.held
}
