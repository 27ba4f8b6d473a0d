//! What was captured standing still goes on standing still, and comes back to its shape.

use super::Check;
use super::bodies::{block, keep};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::types::{Particles, Placement, Plane, Settings, SolverError};
use glam::{Quat, Vec3};

const CELL_M: f32 = 0.05;
const SPACING_M: f32 = 0.025;
/// Height of the body.
const HEIGHT_M: f64 = 0.87;

/// A pot on the ground that carries two stems which bend outwards and end in heads: the kin of a vase
/// of flowers. Stems are two cells thick.
pub(in crate::solver) fn stems(young_pa: f32) -> Particles {
    let inside = |p: Vec3| {
        let pot = p.z < 0.25 && p.truncate().length() < 0.16;
        let arm = |side: f32| {
            let t = (p.z - 0.2) / 0.6;
            let axis = Vec3::new(side * (0.06 + 0.2 * t.max(0.0).powi(2)), 0.02 * side, p.z);
            let stem = (0.0..1.0).contains(&t) && p.distance(axis) < 0.05;
            stem || p.distance(Vec3::new(side * 0.26, 0.02 * side, 0.8)) < 0.07
        };
        pot || arm(1.0) || arm(-1.0)
    };
    keep(&block(Vec3::new(-0.4, -0.2, 0.0), Vec3::new(0.8, 0.4, 0.9), SPACING_M, young_pa, 0.3), inside)
}

fn standing(gpu: &Gpu) -> Result<(Solver, Particles), SolverError> {
    let particles = stems(2e6);
    let mut settings = Settings::new(CELL_M);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.15, restitution: 0.0 });
    let mut solver = Solver::new(gpu, settings, &particles)?;
    solver.prestress(&[0], &Stop::default(), &mut |_| {})?;
    Ok((solver, particles))
}

/// Left alone for two seconds: how far the particle that moved most has moved.
pub(super) fn left_alone(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (mut solver, particles) = standing(gpu)?;
    let mut farthest_m = 0.0;
    for k in 1..=10 {
        solver.advance(0.2 * f64::from(k), &Stop::default())?;
        let moved = solver.states()?.iter().zip(&particles.position_m).map(|(s, p)| s.position_m.distance(*p)).fold(0.0, f32::max);
        farthest_m = f64::max(farthest_m, f64::from(moved));
    }
    let check = Check::new("left alone for 2 s, as captured", "0, within 1 % of its height", "Newton 1687, law 1: what stands is in balance", "m");
    Ok(vec![check.compare(0.0, farthest_m, 0.01 * HEIGHT_M)])
}

/// How the heads of what is dropped lie against its pot, less how they lay when it was captured.
struct Dropped {
    solver: Solver,
    particles: Particles,
}

impl Dropped {
    /// From 0.15 m.
    fn new(gpu: &Gpu) -> Result<Dropped, SolverError> {
        let (mut solver, particles) = standing(gpu)?;
        let placement = Placement {
            rotation: Quat::IDENTITY,
            centre_m: Vec3::ZERO,
            offset_m: Vec3::new(0.0, 0.0, 0.15),
            velocity_m_s: Vec3::ZERO,
            spin_rad_s: Vec3::ZERO,
        };
        solver.place(0, &placement)?;
        Ok(Dropped { solver, particles })
    }

    /// At a later time.
    fn bent_m(&mut self, time_s: f64) -> Result<Vec3, SolverError> {
        self.solver.advance(time_s, &Stop::default())?;
        let (states, at_rest) = (self.solver.states()?, &self.particles.position_m);
        let of = |at: &dyn Fn(usize) -> Vec3, keep: &dyn Fn(Vec3) -> bool| {
            let picked: Vec<usize> = (0..at_rest.len()).filter(|&i| keep(at_rest[i])).collect();
            picked.iter().map(|&i| at(i)).sum::<Vec3>() / picked.len() as f32
        };
        let pose = |at: &dyn Fn(usize) -> Vec3| of(at, &|p| p.z > 0.75 && p.x > 0.0) - of(at, &|p| p.z < 0.2);
        let across = |at: &dyn Fn(usize) -> Vec3| of(at, &|p| p.z < 0.2 && p.x > 0.1) - of(at, &|p| p.z < 0.2 && p.x < -0.1);
        // It lands turned by a degree on its foot, which friction lets it keep: its shape is seen turned back.
        let turn = |at: &dyn Fn(usize) -> Vec3| across(at).y.atan2(across(at).x);
        let (now, captured) = (|i: usize| states[i].position_m, |i: usize| at_rest[i]);
        Ok(Quat::from_rotation_z(turn(&captured) - turn(&now)) * pose(&now) - pose(&captured))
    }
}

/// Dropped: how far off its heads are when all is quiet again.
pub(super) fn dropped(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (mut dropped, mut late) = (Dropped::new(gpu)?, Vec::new());
    for k in 101..=150 {
        late.push(dropped.bent_m(0.02 * f64::from(k))?);
    }
    // The mean of the last second: what still trembles does not count.
    let off_m = (late.iter().sum::<Vec3>() / late.len() as f32).length();
    let back = Check::new("dropped, comes back", "0, within 1 % of its height", "Hooke 1678: what is elastic returns", "m");
    Ok(vec![back.compare(0.0, f64::from(off_m), 0.01 * HEIGHT_M)])
}

/// Dropped: how far its heads swing in the half second in which it lands.
#[cfg(test)]
pub(in crate::solver) fn swings_m(gpu: &Gpu) -> Result<f32, SolverError> {
    let (mut dropped, mut farthest_m) = (Dropped::new(gpu)?, 0f32);
    for k in 1..=25 {
        farthest_m = farthest_m.max(dropped.bent_m(0.02 * f64::from(k))?.length());
    }
    Ok(farthest_m)
}
