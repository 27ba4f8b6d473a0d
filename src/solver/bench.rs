//! How long a substep takes: the drop of an elastic cube.

use super::advance::Plan;
use super::core::Solver;
use super::substance::Substance;
use super::types::{Particles, Plane, Settings, SolverError};
use crate::gpu::{Gpu, PassTime, Recording, Tier};
use glam::Vec3;

/// One benchmark's figure.
#[derive(Clone, Debug)]
pub struct BenchReport {
    /// What was timed.
    pub label: String,
    /// How many particles it came to.
    pub particles: usize,
    /// Median, least and most over whole recordings, sorts included.
    pub substep_seconds: [f64; 3],
    /// Each pass timed alone, which adds some microseconds to each; for shares.
    pub passes: Vec<PassTime>,
}

/// Edge of the cube.
const EDGE_M: f32 = 0.5;
/// Height that it falls from.
const DROP_M: f32 = 0.3;

/// Times substeps of a cube of about `particles` particles, E = 1e5 Pa, nu = 0.3, 1000 kg/m^3, that
/// falls onto a plane. The queue is kept full: many substeps make one recording, timed whole.
pub fn bench_substep(gpu: &Gpu, particles: usize) -> Result<BenchReport, SolverError> {
    let body = cube(particles);
    let spacing_m = EDGE_M / (particles as f32).cbrt();
    let mut settings = Settings::new(1.0 / (0.5 / spacing_m).round().max(32.0));
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    let mut solver = Solver::new(gpu, settings, &body)?;
    let (substeps, recordings) = match gpu.tier {
        Tier::Cpu => (16, 5),
        Tier::Gpu => (64, 15),
    };
    let plan = solver.bench_plan(substeps * (recordings + 2) + substeps)?;
    let mut step = 0;
    let mut record = |solver: &mut Solver, count: u32| -> Result<Recording, SolverError> {
        let recording = solver.bench_recording(&plan, step..step + count)?;
        step += count;
        Ok(recording)
    };
    // The first ones compile, and bring the clock up.
    for _ in 0..2 {
        let warm = record(&mut solver, substeps)?;
        gpu.submit(&warm);
    }
    let mut seconds = Vec::new();
    for _ in 0..recordings {
        let recording = record(&mut solver, substeps)?;
        seconds.push(gpu.time(&recording)? / f64::from(substeps));
    }
    seconds.sort_by(f64::total_cmp);
    let last = record(&mut solver, plan.sort_every)?;
    let passes = gpu.profile(&last)?;
    Ok(BenchReport {
        label: format!("mpm substep, {} particles", body.len()),
        particles: body.len(),
        substep_seconds: [seconds[seconds.len() / 2], seconds[0], seconds[seconds.len() - 1]],
        passes,
    })
}

fn cube(particles: usize) -> Particles {
    let side = (particles as f32).cbrt().round().max(2.0) as u32;
    let spacing_m = EDGE_M / side as f32;
    let low = Vec3::new(-0.5 * EDGE_M, -0.5 * EDGE_M, DROP_M);
    let place = |i: u32| low + (Vec3::new((i % side) as f32, (i / side % side) as f32, (i / side / side) as f32) + 0.5) * spacing_m;
    let n = side.pow(3) as usize;
    Particles {
        position_m: (0..side.pow(3)).map(place).collect(),
        velocity_m_s: vec![Vec3::ZERO; n],
        volume_m3: vec![spacing_m.powi(3); n],
        density_kg_m3: vec![1000.0; n],
        young_pa: vec![1e5; n],
        poisson: vec![0.3; n],
        substance: vec![0; n],
        substances: vec![Substance::default()],
        object: vec![0; n],
    }
}

impl Solver {
    /// A plan of `substeps` equal substeps, as a run would take them, and a window that holds the fall.
    fn bench_plan(&mut self, substeps: u32) -> Result<Plan, SolverError> {
        let seen = self.look()?;
        let acceleration = self.set_surroundings();
        let frame_s = self.settings.frame_s;
        let plan = Plan { substeps, ..self.plan(&seen, frame_s, frame_s, acceleration, 0) };
        self.fit_window(seen.low, seen.high, 4 + (DROP_M / self.settings.cell_m) as i32)?;
        self.start_segment();
        Ok(plan)
    }

    fn bench_recording(&mut self, plan: &Plan, steps: std::ops::Range<u32>) -> Result<Recording, SolverError> {
        let bound = self.bind_both()?;
        let mut recording = Recording::default();
        for step in steps {
            self.record_substep(plan, step, &bound, &mut recording);
        }
        Ok(recording)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_benchmark_runs_the_drop_and_names_its_passes() {
        let gpu = Gpu::shared_for_tests().expect("a device");
        let report = bench_substep(&gpu, 1000).expect("a report");
        assert_eq!(report.particles, 1000);
        let [median, least, most] = report.substep_seconds;
        assert!(0.0 < least && least <= median && median <= most);
        for label in ["solver.p2g", "solver.grid", "solver.g2p", "solver.order"] {
            assert!(report.passes.iter().any(|p| p.label == label), "{label}");
        }
    }
}
