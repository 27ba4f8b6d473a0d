//! A free block that is strained by given steps, and the stress that its law answers with.

use super::bodies::block;
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::Substance;
use crate::solver::types::{Particles, Settings, SolverError};
use crate::spec::ElasticModel;
use glam::{Mat3, Vec3};

/// Long enough to be a substep, too short to change a strain.
const MOMENT_S: f64 = 1e-5;

/// All of it has one F; its corner sets off as fast as the stress says.
pub(super) struct Strained {
    solver: Solver,
    particles: Particles,
    time_s: f64,
    /// Speed of its corner along x for each pascal along x.
    per_pa: f64,
}

/// What a step left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    /// Kirchhoff stress along x.
    pub tau_pa: f64,
    pub history: f64,
}

impl Strained {
    /// Free of stress.
    pub fn new(gpu: &Gpu, substance: Substance, young_pa: f32, poisson: f32) -> Result<Strained, SolverError> {
        let whole = block(Vec3::ZERO, Vec3::splat(0.1), 0.025, young_pa, poisson);
        // What an elastic block does of which the stress is known.
        let mut known = Strained::of(gpu, Particles { substances: vec![Substance::Elastic(ElasticModel::Corotated)], ..whole.clone() })?;
        let (mu, lambda) = whole.lame_pa(0);
        let stretch = 1.01;
        let expected = f64::from((2.0 * mu + lambda) * stretch * (stretch - 1.0));
        let speed = known.stretch(Vec3::new(stretch, 1.0, 1.0))?.tau_pa;
        Ok(Strained { per_pa: speed / expected, ..Strained::of(gpu, Particles { substances: vec![substance], ..whole })? })
    }

    fn of(gpu: &Gpu, particles: Particles) -> Result<Strained, SolverError> {
        let settings = Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(0.05) };
        Ok(Strained { solver: Solver::new(gpu, settings, &particles)?, particles, time_s: 0.0, per_pa: 1.0 })
    }

    /// Stretches what there is of its elastic strain along the axes.
    pub fn stretch(&mut self, by: Vec3) -> Result<Answer, SolverError> {
        let places = &self.particles.position_m;
        self.solver.edit(|s| {
            s.position_m = places[s.index as usize];
            s.velocity_m_s = Vec3::ZERO;
            s.set_affine(Mat3::ZERO);
            s.set_f(Mat3::from_diagonal(by) * s.f());
        })?;
        self.time_s += MOMENT_S;
        self.solver.advance(self.time_s, &Stop::default())?;
        let corner = self.solver.states()?[0];
        Ok(Answer { tau_pa: f64::from(corner.velocity_m_s.x) / self.per_pa, history: f64::from(corner.history) })
    }
}
