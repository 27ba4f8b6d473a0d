//! How long a substep takes: the drop of an elastic cube, and of one of liquid.

use super::advance::Plan;
use super::core::Solver;
use super::substance::{Activation, Substance};
use super::types::{Collider, Particles, Plane, Settings, SolverError};
use crate::Stop;
use crate::gpu::{Gpu, PassTime, Recording, Tier};
use crate::spec::{BoxShape, CapsuleShape, ColliderShape, ElasticModel, SphereShape};
use glam::Vec3;
use std::time::Instant;

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
    let mut solver = Solver::new(gpu, onto_ground(particles), &cube(particles))?;
    let label = format!("mpm substep, {} particles", solver.particle_count());
    time_substeps(&mut solver, repeats(gpu), label)
}

/// Times substeps of the same cube cut into slabs of eight laws, liquid among them, each an object of its
/// own, that falls onto a plane, a box, a ball and a rod.
pub fn bench_mixture(gpu: &Gpu, particles: usize) -> Result<BenchReport, SolverError> {
    let mut body = cube(particles);
    body.substances = vec![
        Substance::Elastic(ElasticModel::Corotated),
        Substance::Muscle { model: ElasticModel::NeoHookean, fibre: Vec3::X, activation: Activation::Curve(vec![(0.0, 0.5)]) },
        Substance::Plastic { yield_stress_pa: 4e3, hardening_pa: 2e4 },
        Substance::Viscoplastic { yield_stress_pa: 2e3, viscosity_pa_s: 30.0 },
        Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 0.0 },
        Substance::Snow { theta_c: 2.5e-2, theta_s: 7.5e-3, hardening: 10.0 },
        Substance::Liquid { viscosity_pa_s: 1.0, surface_tension_n_m: 0.07 },
        Substance::Elastic(ElasticModel::NeoHookean),
    ];
    let slab = |x: &Vec3| ((x.x / EDGE_M + 0.5) * body.substances.len() as f32) as u16;
    body.substance = body.position_m.iter().map(slab).collect();
    body.object = body.substance.iter().map(|&s| u32::from(s)).collect();
    let mut settings = onto_ground(particles);
    let cube = BoxShape { centre_m: [-0.2, 0.0, 0.1], size_m: [0.1, 0.1, 0.2] };
    let ball = SphereShape { centre_m: [0.0, 0.1, 0.1], radius_m: 0.1 };
    let rod = CapsuleShape { from_m: [0.15, -0.3, 0.2], to_m: [0.15, 0.3, 0.2], radius_m: 0.05 };
    let shapes = [ColliderShape::Box(cube), ColliderShape::Sphere(ball), ColliderShape::Capsule(rod)];
    settings.colliders = shapes.into_iter().map(|shape| Collider { shape, friction: 0.3, restitution: 0.1 }).collect();
    let mut solver = Solver::new(gpu, settings, &body)?;
    // Until it has landed.
    solver.advance(0.28, &Stop::default())?;
    let (substeps, recordings) = repeats(gpu);
    time_substeps(&mut solver, (substeps, recordings / 3), format!("mpm substep, {} particles of eight laws", body.len()))
}

/// The room that the cube falls in.
fn onto_ground(particles: usize) -> Settings {
    let spacing_m = EDGE_M / (particles as f32).cbrt();
    let mut settings = Settings::new(1.0 / (0.5 / spacing_m).round().max(32.0));
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    settings
}

/// Substeps of a recording, and recordings.
fn repeats(gpu: &Gpu) -> (u32, u32) {
    match gpu.tier {
        Tier::Cpu => (16, 5),
        Tier::Gpu => (64, 15),
    }
}

/// Times substeps of the same drop of water, as smoothed particles, while it spreads on the ground.
pub fn bench_sph(gpu: &Gpu, particles: usize) -> Result<BenchReport, SolverError> {
    let mut solver = drop_of_water(gpu, particles)?;
    solver.advance(0.3, &Stop::default())?;
    let repeats = match gpu.tier {
        Tier::Cpu => (2, 3),
        Tier::Gpu => (16, 9),
    };
    let count = solver.particle_count();
    time_substeps(&mut solver, repeats, format!("sph substep, {count} particles"))
}

/// How long one simulated second of that drop takes, seconds; what is read back at each frame counts too.
pub fn bench_sph_second(gpu: &Gpu, particles: usize) -> Result<f64, SolverError> {
    // Another one compiles, and brings the clock up.
    drop_of_water(gpu, particles)?.advance(0.02, &Stop::default())?;
    let mut solver = drop_of_water(gpu, particles)?;
    gpu.wait()?;
    let start = Instant::now();
    solver.advance(1.0, &Stop::default())?;
    gpu.wait()?;
    Ok(start.elapsed().as_secs_f64())
}

fn drop_of_water(gpu: &Gpu, particles: usize) -> Result<Solver, SolverError> {
    let substances = vec![Substance::SphLiquid { viscosity_pa_s: 1e-3, surface_tension_n_m: 0.0728 }];
    let body = Particles { substances, ..cube(particles) };
    let spacing_m = EDGE_M / (body.len() as f32).cbrt();
    let mut settings = Settings::new(2.0 * spacing_m);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    Solver::new(gpu, settings, &body)
}

/// Times whole recordings of some substeps, some times over. Each is planned from the present state, as a frame is.
fn time_substeps(solver: &mut Solver, (substeps, recordings): (u32, u32), label: String) -> Result<BenchReport, SolverError> {
    let gpu = &solver.gpu.clone();
    // The first ones compile, and bring the clock up.
    for _ in 0..2 {
        let plan = solver.bench_plan(substeps)?;
        let warm = solver.bench_recording(&plan, substeps)?;
        gpu.submit(&warm);
    }
    let mut seconds = Vec::new();
    for _ in 0..recordings {
        let plan = solver.bench_plan(substeps)?;
        let recording = solver.bench_recording(&plan, substeps)?;
        seconds.push(gpu.time(&recording)? / f64::from(substeps));
    }
    seconds.sort_by(f64::total_cmp);
    let plan = solver.bench_plan(substeps)?;
    let passes = gpu.profile(&solver.bench_recording(&plan, plan.sort_every)?)?;
    Ok(BenchReport {
        label,
        particles: solver.particle_count() as usize,
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
        self.seen = None;
        let seen = self.look()?;
        let acceleration = self.set_surroundings();
        let end_s = self.time_s + self.settings.frame_s;
        let plan = Plan { substeps, ..self.plan(&seen, end_s, end_s, acceleration, 0) };
        let fresh = self.grid.is_none();
        self.fit_window(seen.low, seen.high, 4 + (DROP_M / self.settings.cell_m) as i32)?;
        if fresh {
            // Nobody watches: what splashes finds room.
            self.make_room(4 * self.grid.as_ref().map_or(0, |g| g.capacity), 0)?;
        }
        self.start_segment();
        Ok(plan)
    }

    fn bench_recording(&mut self, plan: &Plan, substeps: u32) -> Result<Recording, SolverError> {
        let bound = self.bind_both()?;
        let mut recording = Recording::default();
        for step in 0..substeps {
            self.record_substep(plan, step, &bound, &mut recording);
        }
        Ok(recording)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_liquid_benchmark_runs_the_drop_and_names_its_passes() {
        let gpu = Gpu::shared_for_tests().expect("a device");
        let report = bench_sph(&gpu, 216).expect("a report");
        assert_eq!(report.particles, 216);
        assert!(report.substep_seconds.iter().all(|s| *s > 0.0));
        for label in ["solver.order", "solver.sph_near", "solver.sph_press", "solver.sph_correct", "solver.sph_advance"] {
            assert!(report.passes.iter().any(|p| p.label == label), "{label}");
        }
        assert!(report.passes.iter().all(|p| !p.label.starts_with("solver.p2g") && p.label != "solver.fused"), "nothing is on the grid");
    }

    #[test]
    fn the_mixture_has_all_passes() {
        let gpu = Gpu::shared_for_tests().expect("a device");
        let report = bench_mixture(&gpu, 512).expect("a report");
        // By cell or by block.
        for label in ["solver.grid_wet", "solver.g2p", "solver.encounter", "solver.liquid_tension"] {
            assert!(report.passes.iter().any(|p| p.label.starts_with(label)), "{label}");
        }
    }

    #[test]
    fn the_benchmark_runs_the_drop_and_names_its_passes() {
        let gpu = Gpu::shared_for_tests().expect("a device");
        let report = bench_substep(&gpu, 1000).expect("a report");
        assert_eq!(report.particles, 1000);
        let [median, least, most] = report.substep_seconds;
        assert!(0.0 < least && least <= median && median <= most);
        for label in ["solver.p2g", "solver.grid", "solver.g2p", "solver.order"] {
            assert!(report.passes.iter().any(|p| p.label.starts_with(label)), "{label}");
        }
    }
}
