//! The solver's passes in plain Rust, for the tests: the same formulas on a map of nodes, sums in f64.

pub mod encounter;
pub mod laws;
pub mod liquid;
pub mod material;
pub mod prestress;
pub mod sort;
pub mod sph;
pub mod volume;

use super::constants::{F_MOST, FILM_LEAST, GAP_STEPS, REST_CELLS_MAX, SLIPS, WALL_FRICTION, WALL_GRIP, WALL_SOON_S};
use super::core::Params;
use super::obstacles::{ColliderRecord, PinRecord};
use super::state::ParticleState;
use super::substance::Substance;
use glam::{DMat3, DVec3, IVec3, Mat3, Vec3};
use std::collections::BTreeMap;

/// What one node of the lattice holds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Node {
    pub momentum: DVec3,
    pub mass: f64,
    /// Contact marks of the ground and of the other colliders.
    pub marks: [u32; 2],
    pub velocity: Vec3,
    /// Of surface tension.
    pub pull_m_s2: Vec3,
    /// Kinematic, of liquid.
    pub viscosity_m2_s: f32,
    /// Thickness of the liquid that walls brake; the same again where that is a film as a whole.
    pub film_m: [f32; 2],
    /// How far walls hold it, 0 to 1.
    pub held: f32,
}

/// Occupied nodes by their lattice coordinates, z first.
pub type Grid = BTreeMap<[i32; 3], Node>;

/// Everything around the particles.
pub struct Surroundings<'a> {
    pub params: Params,
    pub colliders: &'a [ColliderRecord],
    pub pins: &'a [PinRecord],
    pub accelerations: &'a [Vec3],
    pub substances: &'a [Substance],
}

impl Surroundings<'_> {
    /// What the law of a particle lets stand of a trial F; a muscle is at half its strength.
    pub fn respond(&self, state: &ParticleState, trial: DMat3, gradient: DMat3, dt_s: f32) -> laws::Answer {
        let (mu, lambda, history) = (f64::from(state.mu_pa), f64::from(state.lambda_pa), f64::from(state.history));
        laws::respond(&self.substances[state.substance()], trial, &laws::Matter { mu, lambda, history, activation: 0.5, gradient }, f64::from(dt_s))
    }
}

/// First node of a particle's stencil.
pub fn base_node(x: Vec3, params: &Params) -> IVec3 {
    (x * params.per_m - Vec3::splat(0.5)).floor().as_ivec3()
}

/// The 27 nodes of a stencil: coordinates, weight, and distance from the particle in cells.
pub fn stencil(x: Vec3, params: &Params) -> Vec<([i32; 3], f32, Vec3)> {
    let base = base_node(x, params);
    let place = x * params.per_m - base.as_vec3();
    let weights =
        [0.5 * (Vec3::splat(1.5) - place).powf(2.0), Vec3::splat(0.75) - (place - Vec3::ONE).powf(2.0), 0.5 * (place - Vec3::splat(0.5)).powf(2.0)];
    let mut nodes = Vec::with_capacity(27);
    for k in 0..27usize {
        let at = [k % 3, k / 3 % 3, k / 9];
        let weight = weights[at[0]].x * weights[at[1]].y * weights[at[2]].z;
        let node = base + IVec3::new(at[0] as i32, at[1] as i32, at[2] as i32);
        let d = Vec3::new(at[0] as f32, at[1] as f32, at[2] as f32) - place;
        nodes.push(([node.z, node.y, node.x], weight, d));
    }
    nodes
}

fn affine(state: &ParticleState) -> DMat3 {
    Mat3::from_cols_array(&state.affine).transpose().as_dmat3()
}

/// `stress.wgsl`: A gets the stress of the first substep.
pub fn stress(states: &mut [ParticleState], around: &Surroundings, dt_s: f32) {
    let params = &around.params;
    for s in states {
        let tau = around.respond(s, s.f().as_dmat3(), DMat3::ZERO, 0.0).tau;
        let weight = f64::from(dt_s) * 4.0 * f64::from(params.per_m).powi(2) * f64::from(s.volume_m3);
        s.set_affine((affine(s) - tau * weight).as_mat3());
    }
}

/// `p2g.wgsl`: mass, momentum and contact marks.
pub fn p2g(states: &[ParticleState], around: &Surroundings) -> Grid {
    let (params, ground) = (&around.params, around.params.has_ground as usize);
    let mut grid = Grid::new();
    for s in states.iter().filter(|s| !s.is_rigid()) {
        let found = [nearest(s, &around.colliders[..ground], 0, params), nearest(s, &around.colliders[ground..], ground, params)];
        let a = affine(s) * f64::from(params.cell_m);
        for (node, weight, d) in stencil(s.position_m, params) {
            let (weight, node) = (f64::from(weight), grid.entry(node).or_default());
            node.momentum += (s.velocity_m_s.as_dvec3() * f64::from(s.mass_kg) + a * d.as_dvec3()) * weight;
            node.mass += f64::from(s.mass_kg) * weight;
            for (mark, found) in node.marks.iter_mut().zip(found) {
                let Some((value, normal)) = found else { continue };
                if normal.dot(d) <= 0.5 {
                    *mark = (*mark).max(value);
                } else if value & SLIPS != 0 || params.wet_layers != 0 {
                    *mark = (*mark).max(1 << 11 | (value & 2047));
                }
            }
        }
    }
    grid
}

/// The mark of the nearest collider in reach, and its normal.
fn nearest(s: &ParticleState, colliders: &[ColliderRecord], first: usize, params: &Params) -> Option<(u32, Vec3)> {
    let mut best: Option<(u32, Vec3)> = None;
    for (c, collider) in colliders.iter().enumerate() {
        let touch = collider.touch(s.position_m);
        let gap_m = touch.distance_m - s.rest_m;
        if touch.distance_m > params.reach_m + REST_CELLS_MAX * params.cell_m || gap_m >= params.reach_m {
            continue;
        }
        let slips = if s.mu_pa == 0.0 { SLIPS } else { 0 };
        let near = 1.0 - (gap_m / params.reach_m).clamp(0.0, 1.0);
        let mark = (((near * GAP_STEPS) as u32 + 1) << 11) | ((c + first) as u32 * 8 + touch.face) | slips;
        if best.is_none_or(|(most, _)| mark > most) {
            best = Some((mark, collider.normal(touch.face, s.position_m)));
        }
    }
    best
}

/// Metres between a marked node's nearest particle and its rest.
pub fn mark_gap_m(mark: u32, params: &Params) -> f32 {
    params.reach_m * (1.0 - ((mark >> 11) - 1) as f32 / GAP_STEPS)
}

/// `grid.wgsl`, on one layer: velocities after gravity, contact and pins.
pub fn grid(grid: &mut Grid, layer: u32, around: &Surroundings, dt_s: f32, since_s: f32) {
    for (node, value) in grid.iter_mut() {
        let x = Vec3::new(node[2] as f32, node[1] as f32, node[0] as f32) * around.params.cell_m;
        let mut v = (value.momentum / value.mass).as_vec3() + (Vec3::from(around.params.gravity_m_s2) + value.pull_m_s2) * dt_s;
        for mark in [value.marks[1], value.marks[0]] {
            if mark != 0 {
                v = braked(respond(v, mark, x, around, dt_s), mark, x, around, dt_s, value);
                value.held = value.held.max(held_by(mark, x, around, dt_s, value));
            }
        }
        if let Some(pin) = around.pins.iter().find(|pin| pinned(pin, layer, x, since_s)) {
            (v, value.held) = (Vec3::from_slice(&pin.velocity), 0.0);
        }
        value.velocity = v;
    }
}

pub fn pinned(pin: &PinRecord, layer: u32, x: Vec3, since_s: f32) -> bool {
    let way = x - (Vec3::from_slice(&pin.shift) + Vec3::from_slice(&pin.velocity) * since_s);
    let turn = Mat3::from_cols_array_2d(&pin.turn.map(|[x, y, z, _]| [x, y, z]));
    pin.layer == layer && pin.surrounds(turn.inverse() * way + Vec3::from_slice(&pin.centre))
}

fn respond(v: Vec3, mark: u32, x: Vec3, around: &Surroundings, dt_s: f32) -> Vec3 {
    let collider = &around.colliders[(mark & 1023) as usize >> 3];
    let [friction, restitution, ..] = collider.surface;
    let normal = collider.normal(mark & 7, x);
    let approach = v.dot(normal);
    let allowed = -mark_gap_m(mark, &around.params) / dt_s;
    if approach >= allowed {
        return v;
    }
    let resting = 4.0 * Vec3::from(around.params.gravity_m_s2).length() * dt_s;
    let leaving = allowed.max(restitution * (-approach - resting).max(0.0));
    let sliding = v - normal * approach;
    let friction = if mark & SLIPS == 0 { friction } else { 0.0 };
    let (speed, grip) = (sliding.length(), friction * (leaving - approach));
    normal * leaving + if speed > grip { sliding * (1.0 - grip / speed) } else { Vec3::ZERO }
}

/// Whether a wall brakes the liquid or paste of a node.
fn wets(mark: u32, x: Vec3, around: &Surroundings, node: &Node) -> bool {
    let collider = &around.colliders[(mark & 1023) as usize >> 3];
    let near = node.film_m[1] > 0.0 || collider.touch(x).distance_m <= 0.5 * around.params.cell_m;
    let paste = around.params.wet_layers != 0 && node.viscosity_m2_s > 0.0;
    near && (mark & SLIPS != 0 || paste) && collider.surface[0] > 0.0
}

/// What a wall's friction leaves of a liquid's velocity.
fn braked(v: Vec3, mark: u32, x: Vec3, around: &Surroundings, dt_s: f32, node: &Node) -> Vec3 {
    let collider = &around.colliders[(mark & 1023) as usize >> 3];
    if !wets(mark, x, around, node) {
        return v;
    }
    let normal = collider.normal(mark & 7, x);
    let sliding = v - normal * v.dot(normal);
    let thick_m = node.film_m[0].max(FILM_LEAST * around.params.cell_m);
    let laminar_m_s = if node.film_m[1] > 0.0 { 3.0 * node.viscosity_m2_s / thick_m } else { 0.0 };
    let rate = (laminar_m_s + WALL_FRICTION * sliding.length()) / thick_m;
    v - sliding * (dt_s * rate / (1.0 + dt_s * rate))
}

/// How far a wall holds what slides along it.
fn held_by(mark: u32, x: Vec3, around: &Surroundings, dt_s: f32, node: &Node) -> f32 {
    let rate = node.viscosity_m2_s * around.params.per_m.powi(2);
    let grip = dt_s * WALL_GRIP * rate * (1.0 + rate * WALL_SOON_S);
    if !wets(mark, x, around, node) || node.film_m[1] > 0.0 { 0.0 } else { grip / (1.0 + grip) }
}

/// Velocity and its gradient at a particle.
pub fn gather(grid: &Grid, x: Vec3, params: &Params) -> (DVec3, DMat3) {
    let (mut v, mut gradient) = (DVec3::ZERO, DMat3::ZERO);
    for (node, weight, d) in stencil(x, params) {
        let u = grid.get(&node).map_or(Vec3::ZERO, |n| n.velocity).as_dvec3() * f64::from(weight);
        let d = d.as_dvec3();
        v += u;
        gradient += DMat3::from_cols(u * d.x, u * d.y, u * d.z);
    }
    (v, gradient * (4.0 * f64::from(params.per_m)))
}

/// `g2p.wgsl`: moves and deforms the particles, and prepares the stress of the next substep.
pub fn g2p(states: &mut [ParticleState], grid: &Grid, around: &Surroundings, dt_s: f32, dt_next_s: f32) {
    let params = &around.params;
    for s in states.iter_mut().filter(|s| !s.is_rigid()) {
        let (v, gradient) = gather(grid, s.position_m, params);
        let held_back = |v: Vec3| v * (params.speed_most / v.length().max(1e-30)).min(1.0);
        let along = held_back(v.as_vec3());
        let mut x = s.position_m + along * dt_s;
        let mut v = along + around.accelerations[s.object() as usize] * dt_s;
        for collider in around.colliders.iter().rev() {
            let touch = collider.touch(x);
            let slipping_m = collider.touch(s.position_m).distance_m.clamp(0.0, s.rest_m.max(0.0));
            let behind_m = if s.mu_pa == 0.0 { slipping_m } else { s.rest_m.min(0.0) } - touch.distance_m;
            if behind_m > 0.0 {
                let normal = collider.normal(touch.face, x);
                x += normal * behind_m.min((s.position_m - x).dot(normal).max(0.0) + params.push_m);
                v -= normal * v.dot(normal).min(0.0);
            }
        }
        v = held_back(v);
        let trial = (DMat3::IDENTITY + gradient * f64::from(dt_s)) * s.f().as_dmat3();
        let size = trial.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
        let f = trial * (f64::from(F_MOST) / size).min(1.0);
        let answer = around.respond(s, f, gradient, dt_s);
        let weight = f64::from(dt_next_s) * 4.0 * f64::from(params.per_m).powi(2) * f64::from(s.volume_m3);
        s.set_affine((gradient * f64::from(s.mass_kg) - answer.tau * weight).as_mat3());
        s.set_f(answer.f.as_mat3());
        s.history = answer.history as f32;
        s.position_m = x;
        s.velocity_m_s = v;
    }
}

/// `frame.wgsl`: nine entries of G - I by rows, rounded, and det G.
pub fn frame(state: &ParticleState, unstressed: Mat3) -> ([f32; 9], f32) {
    let g = state.f() * unstressed;
    let tidy = |value: f32| (value * 16384.0).round_ties_even() / 16384.0;
    ((g - Mat3::IDENTITY).transpose().to_cols_array().map(tidy), g.determinant())
}
