//! The passes of the smoothed particles: all pairs, derivatives of the kernel by differences, f64.

use super::Surroundings;
use crate::solver::constants::*;
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// W of unit support.
pub fn weight(q: f64) -> f64 {
    let inner = (1.0 - 2.0 * q).max(0.0).powi(3);
    // Monaghan's form: (2 - r)^3 - 4 (1 - r)^3 over 4 pi, with r = 2 q and the support's cube.
    8.0 / (4.0 * PI) * ((2.0 - 2.0 * q).max(0.0).powi(3) - 4.0 * inner)
}

/// W between a liquid and a solid particle.
pub fn solid_weight(q: f64) -> f64 {
    f64::from(SOLID_STRENGTH) * PI / 8.0 * weight(q).powi(2)
}

fn derivative(f: impl Fn(f64) -> f64, at: f64) -> f64 {
    let step = 1e-6;
    (f(at + step) - f(at - step)) / (2.0 * step)
}

/// W integrated over a plane at a distance from the particle, by the rule of midpoints.
pub fn plane(s: f64) -> f64 {
    let (s, parts) = (s.abs().min(1.0), 500);
    let step = (1.0 - s) / f64::from(parts);
    (0..parts).map(|k| s + (f64::from(k) + 0.5) * step).map(|r| 2.0 * PI * r * weight(r) * step).sum()
}

/// Layers half a cell thick behind a wall.
pub fn wall_density(s: f64) -> f64 {
    [0.25, 0.75].iter().map(|behind| 0.5 * plane(s + behind)).sum()
}

/// The pull between two particles.
pub fn pull(q: f64) -> f64 {
    f64::from(PULL) * (1.0 - q).powi(2) * (q - f64::from(PULL_ZERO))
}

/// And of all behind a wall.
pub fn wall_pull(s: f64) -> f64 {
    let (s, parts) = (s.clamp(0.0, 1.0), 2000);
    let step = (1.0 - s) / f64::from(parts);
    (0..parts).map(|k| s + (f64::from(k) + 0.5) * step).map(|q| PI * pull(q) * (q * q - s * s) * step).sum::<f64>() * f64::from(WETTING)
}

/// Viscous coupling to a wall over which the velocity goes on linearly to 0 on it.
pub fn wall_drag(s: f64) -> f64 {
    let s = s.max(0.125);
    let parts = 120;
    let layer = |z: f64| {
        let step = (1.0 - z) / f64::from(parts);
        let ring = |r: f64| PI * r * (r * r - z * z) * -derivative(weight, r) / (r * r * r) * step;
        (0..parts).map(|k| ring(z + (f64::from(k) + 0.5) * step)).sum::<f64>()
    };
    let step = (1.0 - s) / f64::from(parts);
    (0..parts).map(|k| s + (f64::from(k) + 0.5) * step).map(|z| z * layer(z) * step).sum::<f64>() / s * f64::from(WALL_VISCOUS / VISCOUS)
}

/// A particle as the passes see it, in the order of the sort.
#[derive(Clone, Debug)]
pub struct Particle {
    pub x: DVec3,
    /// Cells.
    pub volume: f64,
    pub liquid: bool,
    /// 1 / density.
    pub lightness: f64,
    pub viscosity: f64,
    pub tension: f64,
    pub object: usize,
    pub v: DVec3,
    /// Sums over neighbours.
    pub neighbours: Vec<usize>,
    pub gradient: DVec3,
    pub density: f64,
    /// What walls have of that.
    pub wall: DVec3,
    /// Of liquid alone, and by how much walls stand in for it.
    pub inward: f64,
    /// Growth of a push along them.
    pub hidden: f64,
    pub answer: f64,
    pub viscous: f64,
    /// How much too dense it may be, once it noted that.
    pub allowed: Option<f64>,
}

impl Particle {
    /// `sph_begin.wgsl`: notes how much too dense it may be.
    pub fn begin(&mut self) {
        self.allowed.get_or_insert((self.density - 1.0).max(0.0));
    }

    /// Its density as the correction sees it.
    pub fn seen(&self) -> f64 {
        self.density - self.allowed.unwrap_or(0.0)
    }
}

/// `sph_place.wgsl` and `sph_near.wgsl`, of particles that may be so much too dense.
pub fn near(states: &[ParticleState], allowed: &[Option<f64>], around: &Surroundings) -> Vec<Particle> {
    let cell = f64::from(around.params.cell_m);
    let place = |(s, &allowed): (&ParticleState, &Option<f64>)| {
        let (liquid, viscosity, tension) = match around.substances[s.substance()] {
            Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m } => (true, f64::from(viscosity_pa_s), f64::from(surface_tension_n_m)),
            _ => (false, 0.0, 0.0),
        };
        let stretch = if liquid { 1.0 } else { f64::from(s.f().determinant()).clamp(0.1, 10.0) };
        let volume = f64::from(s.volume_m3) * stretch;
        Particle {
            x: s.position_m.as_dvec3(),
            volume: volume / cell.powi(3),
            liquid,
            lightness: volume / f64::from(s.mass_kg),
            viscosity,
            tension,
            object: s.object() as usize,
            v: s.velocity_m_s.as_dvec3(),
            neighbours: Vec::new(),
            gradient: DVec3::ZERO,
            density: 0.0,
            wall: DVec3::ZERO,
            inward: 0.0,
            hidden: 0.0,
            answer: 0.0,
            viscous: 0.0,
            allowed: if liquid { allowed } else { Some(0.0) },
        }
    };
    let mut all: Vec<Particle> = states.iter().zip(allowed).map(place).collect();
    for i in 0..all.len() {
        let mut me = all[i].clone();
        me.density = if me.liquid { me.volume * weight(0.0) } else { 0.0 };
        let mut inward = DVec3::ZERO;
        for (j, other) in all.iter().enumerate() {
            let y = (me.x - other.x) / cell;
            let q = y.length();
            if j == i || q >= 1.0 || !(me.liquid || other.liquid) {
                continue;
            }
            me.neighbours.push(j);
            let (felt, slope) = felt(&me, other, q);
            me.density += other.volume * felt;
            me.gradient += y / q * (other.volume * slope);
            inward += y / q * (other.volume * slope * if other.liquid { 1.0 } else { 0.5 });
            me.answer += me.volume * other.volume * slope * slope * other.lightness;
            me.viscous += 2.0 * pair_viscosity(&me, other) * other.volume * -derivative(weight, q) * q / (q * q + 0.01);
        }
        if me.liquid {
            walls(&mut me, around);
            me.inward = (inward + me.wall).length();
            let change = me.gradient.dot(along_walls(&me, me.gradient)) * me.lightness;
            me.answer = 1.0 / ((me.answer + change) * me.density.max(1.0)).max(1e-3 * me.lightness);
        }
        me.viscous *= f64::from(VISCOUS) * me.lightness / (cell * cell);
        (all[i].neighbours, all[i].density, all[i].gradient) = (me.neighbours, me.density, me.gradient);
        (all[i].wall, all[i].hidden, all[i].answer, all[i].viscous) = (me.wall, me.hidden, me.answer, me.viscous);
        all[i].inward = me.inward;
    }
    all
}

/// W and W' of the kernel that two feel each other by.
fn felt(a: &Particle, b: &Particle, q: f64) -> (f64, f64) {
    if a.liquid == b.liquid { (weight(q), derivative(weight, q)) } else { (solid_weight(q), derivative(solid_weight, q)) }
}

fn pair_viscosity(a: &Particle, b: &Particle) -> f64 {
    let sum = a.viscosity + b.viscosity;
    if a.viscosity > 0.0 && b.viscosity > 0.0 { 0.5 * sum } else { sum }
}

/// Distance in cells, normal and whether it holds, of each wall in reach.
fn walls_near(x: DVec3, around: &Surroundings) -> Vec<(f64, DVec3, bool)> {
    let of = |c: &crate::solver::obstacles::ColliderRecord| {
        let touch = c.touch(x.as_vec3());
        let s = f64::from(touch.distance_m / around.params.cell_m);
        (s < 1.0).then(|| (s, c.normal(touch.face, x.as_vec3()).as_dvec3(), c.surface[0] > 0.0))
    };
    around.colliders.iter().filter_map(of).collect()
}

fn walls(me: &mut Particle, around: &Surroundings) {
    let near = walls_near(me.x, around);
    let open =
        |but: Option<usize>| -> f64 { near.iter().enumerate().filter(|&(l, _)| Some(l) != but).map(|(_, w)| 1.0 - wall_density(w.0)).product() };
    for (k, &(s, normal, holds)) in near.iter().enumerate() {
        me.wall += normal * (derivative(wall_density, s) * open(Some(k)));
        me.viscous += if holds { me.viscosity * wall_drag(s) } else { 0.0 };
    }
    let density = 1.0 - open(None);
    me.density += density;
    me.gradient += me.wall * 2.0;
    me.hidden = density.min(0.5) / (1.0 - density.min(0.5));
}

fn along_walls(me: &Particle, push: DVec3) -> DVec3 {
    push + (push - me.wall * (push.dot(me.wall) / me.wall.length_squared().max(1e-12))) * me.hidden
}

/// `sph_push.wgsl`: change of each velocity by pressures, over `dt_s`.
pub fn pushed(all: &[Particle], pressure: &[f64], cell: f64, dt_s: f64) -> Vec<DVec3> {
    let of = |(i, me): (usize, &Particle)| {
        let mut sum = if me.liquid { me.gradient * pressure[i] } else { DVec3::ZERO };
        for &j in me.neighbours.iter().filter(|&&j| all[j].liquid) {
            let y = (me.x - all[j].x) / cell;
            sum += y.normalize() * (all[j].volume * pressure[j] * felt(me, &all[j], y.length()).1);
        }
        along_walls(me, sum) * (-dt_s * me.lightness / cell)
    };
    all.iter().enumerate().map(of).collect()
}

/// `sph_correct.wgsl`: the error that a liquid particle is left with.
pub fn error(all: &[Particle], i: usize, corrected: &[DVec3], cell: f64, dt_s: f64) -> f64 {
    let me = &all[i];
    let mut rate = me.gradient.dot(corrected[i]);
    for &j in &me.neighbours {
        let y = (me.x - all[j].x) / cell;
        rate -= all[j].volume * felt(me, &all[j], y.length()).1 * corrected[j].dot(y.normalize());
    }
    let excess = me.seen() - 1.0;
    let drift = if excess < 0.0 { excess } else { (f64::from(DRIFT_SHARE) * excess).min(f64::from(THIN_OUT) * dt_s) };
    drift + rate / cell * dt_s
}

/// How much too dense a particle may be after a substep, and how fast that changes (`sph_advance.wgsl`).
pub fn eased(much: f64, rate: f64, cell: f64, dt_s: f64) -> [f64; 2] {
    let stiffness = f64::from(EASE_OUT_M_S2) / cell;
    // x' = x + dt v', v' = v - dt (k x' + 2 sqrt(k) v').
    let next = (rate - dt_s * stiffness * much) / (1.0 + 2.0 * stiffness.sqrt() * dt_s + stiffness * dt_s * dt_s);
    [(much + dt_s * next).max(0.0), next]
}

/// Share of its depth by which a surface lets out in a substep what stands inside it.
pub fn out_of_walls(cell: f64, dt_s: f64) -> f64 {
    (dt_s * (f64::from(EASE_OUT_M_S2) / cell).sqrt()).min(1.0)
}

/// How far a particle belongs to the surface.
fn on_surface(p: &Particle) -> f64 {
    let share = ((p.inward - f64::from(SURFACE_FROM)) / f64::from(SURFACE_TO - SURFACE_FROM)).clamp(0.0, 1.0);
    if p.liquid { share * share * (3.0 - 2.0 * share) } else { 0.0 }
}

fn tug(q: f64) -> f64 {
    q * (1.0 - q)
}

/// `sph_skin.wgsl`: what each pulls with, and how far it belongs to the surface.
pub fn skin(all: &[Particle], cell: f64) -> Vec<[f64; 2]> {
    let of = |me: &Particle| {
        let lever = |&&j: &&usize| {
            let q = (me.x - all[j].x).length() / cell;
            on_surface(&all[j]) * tug(q) * q
        };
        let levers: f64 = me.neighbours.iter().filter(|&&j| all[j].liquid).map(|j| lever(&j)).sum();
        let strength = f64::from(TENSION) * me.tension * me.volume * me.inward * on_surface(me) / levers.max(f64::from(LEVERS_LEAST));
        [strength, on_surface(me)]
    };
    all.iter().map(of).collect()
}

/// What the friction of walls leaves of a velocity.
pub fn braked(me: &Particle, v: DVec3, around: &Surroundings, dt_s: f64) -> DVec3 {
    let full = (me.seen() - me.hidden / (1.0 + me.hidden)).clamp(0.3, 1.0);
    let brake = |u: DVec3, (s, normal, holds): (f64, DVec3, bool)| {
        let across = normal * u.dot(normal);
        let rate = f64::from(WALL_FRICTION) * (u - across).length() * 2.0 * (1.0 - s.max(0.0)) / f64::from(around.params.cell_m) / full;
        if holds { across + (u - across) / (1.0 + dt_s * rate) } else { u }
    };
    walls_near(me.x, around).into_iter().fold(v, brake)
}

/// `sph_forces.wgsl`: velocities after weight, tension and, where `viscous`, viscosity, but without pressures.
pub fn forces(all: &[Particle], around: &Surroundings, dt_s: f64, viscous: bool) -> Vec<DVec3> {
    let cell = f64::from(around.params.cell_m);
    let skin = skin(all, cell);
    let of = |(i, me): (usize, &Particle)| {
        let mut sum = DVec3::ZERO;
        for &j in &me.neighbours {
            let other = &all[j];
            let y = (me.x - other.x) / cell;
            let (q, along) = (y.length(), y.normalize());
            let ([strength, member], [its, there]) = (skin[i], skin[j]);
            let alike = me.liquid && other.liquid;
            let wetted = f64::from(WETTING) * (me.tension + other.tension) * other.volume * pull(q);
            sum -= along * if alike { (strength * there + its * member) * tug(q) / me.volume } else { wetted };
            let calm = f64::from(SKIN_CALM) * ((me.tension + other.tension) * cell / (me.lightness + other.lightness)).sqrt();
            let approach = (me.v - other.v).dot(along);
            let eddy = cell * (f64::from(EDDIES) * approach.abs()).min(f64::from(EDDIES_MOST) * cell / dt_s) * 2.0 / (me.lightness + other.lightness);
            let eta = eddy + if alike { calm * member * there } else { 0.0 } + if viscous { pair_viscosity(me, other) } else { 0.0 };
            sum += along * (f64::from(VISCOUS) * eta * other.volume * derivative(weight, q) * approach * q / (q * q + 0.01));
        }
        if me.liquid {
            for (s, normal, holds) in walls_near(me.x, around) {
                sum -= normal * (me.tension * wall_pull(s));
                let along = me.v - normal * me.v.dot(normal);
                sum -= if holds && viscous { along * (f64::from(VISCOUS) * me.viscosity * wall_drag(s)) } else { DVec3::ZERO };
            }
        }
        let weight_m_s2 = (Vec3::from(around.params.gravity_m_s2) + around.accelerations[me.object]).as_dvec3();
        me.v + (weight_m_s2 + sum * (me.lightness / (cell * cell))) * dt_s
    };
    all.iter().enumerate().map(of).collect()
}

/// `sph_implicit.wgsl`, with an exact answer: (1 - dt L) v = v*, by Gauss and Seidel.
pub fn implicit(all: &[Particle], wanted: &[DVec3], around: &Surroundings, dt_s: f64) -> Vec<DVec3> {
    let cell = f64::from(around.params.cell_m);
    let mut v = wanted.to_vec();
    for _ in 0..200 {
        for (i, me) in all.iter().enumerate() {
            let common = dt_s * f64::from(VISCOUS) * me.lightness / (cell * cell);
            let (mut matrix, mut right) = (glam::DMat3::IDENTITY, wanted[i]);
            for &j in &me.neighbours {
                let y = (me.x - all[j].x) / cell;
                let (q, along) = (y.length(), y.normalize());
                let coupling = common * pair_viscosity(me, &all[j]) * all[j].volume * -derivative(weight, q) * q / (q * q + 0.01);
                matrix += outer(along, along) * coupling;
                right += along * (coupling * v[j].dot(along));
            }
            for (s, normal, holds) in walls_near(me.x, around) {
                if me.liquid && holds {
                    matrix += (glam::DMat3::IDENTITY - outer(normal, normal)) * (common * me.viscosity * wall_drag(s));
                }
            }
            v[i] = matrix.inverse() * right;
        }
    }
    v
}

fn outer(a: DVec3, b: DVec3) -> glam::DMat3 {
    glam::DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
