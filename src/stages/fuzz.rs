//! Random specs from the whole schema, run whole: V28. Nothing that a spec can say may end in numbers
//! that are none, pass the ground, or make energy of nothing.

use super::{Engine, EngineError, Metrics, RunOptions};
use crate::gpu::{DeviceRequest, Gpu};
use crate::scene::{self, Gaussians};
use crate::solver::SolverError;
use crate::solver::validate::{Case, Check};
use crate::spec::random::{self, Size};
use crate::spec::{Material, Rest, Spec};
use crate::store::Store;
use crate::{Discard, Stop};
use glam::Vec3;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The cases of this room.
pub const CASES: &[Case] = &[Case::new("V28", true, |gpu| checks(gpu, Size::Small, 0..QUICK, &mut |_| ()))];
/// How many specs a test run draws.
const QUICK: u64 = 200;
/// The file that every spec is of, in a folder of its own.
const SCENE: &str = "block.ply";
/// Share of all specs that has to be run: what is refused proves nothing.
const RUN_LEAST: f64 = 0.8;
/// And whose energy has a bound: the others do work that nobody sums.
const JUDGED_LEAST: f64 = 0.1;
/// Bytes of results that are kept meanwhile.
const STORE_BYTES: u64 = 256 << 20;

/// What came of one spec.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// It is drawn from this alone.
    pub seed: u64,
    /// In one word and, where it is bad, what was seen.
    pub kind: Kind,
    /// Whether what drives it has a bound by which its energy was judged.
    pub energy_judged: bool,
    /// What it took.
    pub cost: Cost,
}

/// What running one spec took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Wall seconds.
    pub seconds: f64,
    /// Particles.
    pub particles: u64,
    /// Substeps that were kept.
    pub substeps: u64,
    /// Segments that were run again.
    pub retries: u32,
    /// Times that something was softened.
    pub softened: usize,
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Cost { seconds, particles, substeps, retries, softened } = self.cost;
        let (seed, kind, judged) = (self.seed, &self.kind, if self.energy_judged { "energy judged, " } else { "" });
        write!(
            f,
            "seed {seed}: {kind:?}, {judged}{seconds:.2} s, {particles} particles, {substeps} substeps, {retries} retries, softened {softened} times"
        )
    }
}

/// See [`Outcome`].
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Ran, and all held.
    Held,
    /// Refused with a reason before anything moved.
    Refused(String),
    /// Given up on the way, with a reason.
    GivenUp(String),
    /// Values that are no numbers.
    Nonfinite(String),
    /// Something below the ground.
    Escaped(String),
    /// More energy than was put in.
    Energy(String),
}

/// Draws and runs one spec after another; `told` hears of each.
pub fn survive(gpu: &Gpu, size: Size, seeds: Range<u64>, told: &mut dyn FnMut(&Outcome)) -> Result<Vec<Outcome>, EngineError> {
    let folder = Folder::new(seeds.start)?;
    let mut outcomes = Vec::new();
    let mut engine = None;
    for seed in seeds {
        let engine = match &mut engine {
            Some(engine) => engine,
            none => none.insert(open(gpu, &folder.0)?),
        };
        let clock = Instant::now();
        let outcome = match random::spec(seed, SCENE, size) {
            Err(error) => Outcome { seed, kind: Kind::Refused(error.to_string()), energy_judged: false, cost: Cost::default() },
            Ok(spec) => run(engine, seed, &spec, &folder.0),
        };
        let outcome = Outcome { cost: Cost { seconds: clock.elapsed().as_secs_f64(), ..outcome.cost }, ..outcome };
        told(&outcome);
        outcomes.push(outcome);
    }
    Ok(outcomes)
}

/// The comparisons of V28 over a range of seeds.
pub fn checks(gpu: &Gpu, size: Size, seeds: Range<u64>, told: &mut dyn FnMut(&Outcome)) -> Result<Vec<Check>, SolverError> {
    let outcomes = survive(gpu, size, seeds.clone(), told)
        .map_err(|e| SolverError::Input { what: e.to_string(), expected: "a folder for its results".to_owned() })?;
    let among = |of: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|o| of(o)).count() as f64 / outcomes.len().max(1) as f64;
    let share = |of: fn(&Kind) -> bool| among(&|o| of(&o.kind));
    let row = |name, formula| Check::new(name, formula, "random specs from the whole schema", "of all");
    let none = |name, formula, of| row(name, formula).compare(0.0, share(of), 0.0);
    let least = |name, formula, measured, least: f64| row(name, formula).compare(1.0, measured, 1.0 - least);
    let asked = seeds.end.saturating_sub(seeds.start) as f64;
    Ok(vec![
        Check::new("V28 drawn", "all that were asked for", "random specs from the whole schema", "specs").compare(asked, outcomes.len() as f64, 0.0),
        least("V28 run", "at least 80 %, the others refused with a reason", share(|k| !matches!(k, Kind::Refused(_))), RUN_LEAST),
        none("V28 no numbers", "0", |k| matches!(k, Kind::Nonfinite(_))),
        none("V28 through the ground", "0", |k| matches!(k, Kind::Escaped(_))),
        none("V28 energy of nothing", "sqrt(2 E / m) <= sqrt(2 E0 / m) + pushes + a t", |k| matches!(k, Kind::Energy(_))),
        least(
            "V28 energy judged",
            "at least 10 %: no field, muscle or path drives, none starts inside a surface",
            among(&|o| o.energy_judged),
            JUDGED_LEAST,
        ),
        row("V28 given up", "at most 0.5 %, each with a reason").compare(0.0, share(|k| matches!(k, Kind::GivenUp(_))), 0.005),
    ])
}

fn open(gpu: &Gpu, folder: &Path) -> Result<Engine, EngineError> {
    let store = Store::open(&folder.join("store"))?.with_cap(STORE_BYTES);
    let mut engine = Engine::new(store, DeviceRequest::default());
    engine.gpu = Some(gpu.clone());
    Ok(engine)
}

fn run(engine: &mut Engine, seed: u64, spec: &Spec, folder: &Path) -> Outcome {
    let options = RunOptions { render: false, ..RunOptions::default() };
    tracing::debug!("{}", spec.to_toml());
    match engine.run(spec, folder, &options, None, &mut Discard, &Stop::default()) {
        Ok(report) => {
            let solver = &report.metrics.solver;
            let (particles, substeps, retries, softened) = (solver.particles, solver.substeps, solver.retries, solver.softened.len());
            let energy_judged = bound(spec, &report.metrics).is_some();
            Outcome { seed, kind: judge(spec, &report.metrics), energy_judged, cost: Cost { particles, substeps, retries, softened, seconds: 0.0 } }
        }
        Err(error) => Outcome { seed, kind: ended(&error), energy_judged: false, cost: Cost::default() },
    }
}

/// What an error makes of a spec: refused, or given up where anything had moved.
fn ended(error: &EngineError) -> Kind {
    let moved = match error {
        EngineError::TooLarge { time_s, .. } => *time_s > 0.0,
        EngineError::Unstable(_) | EngineError::Gpu(_) | EngineError::Store(_) => true,
        _ => false,
    };
    if moved { Kind::GivenUp(error.to_string()) } else { Kind::Refused(error.to_string()) }
}

fn judge(spec: &Spec, metrics: &Metrics) -> Kind {
    let series = || metrics.objects.values().flat_map(|o| o.kinetic_j.iter().chain(&o.low_m).chain(&o.speed_m_s));
    if metrics.solver.nonfinite > 0 || !series().all(|v| v.is_finite()) {
        return Kind::Nonfinite(format!("{} particles", metrics.solver.nonfinite));
    }
    for (name, object) in &metrics.objects {
        let (speed_m_s, kinetic_j, stretch, gap_m) = (&object.speed_m_s, &object.kinetic_j, &object.stretch_max, &object.gap_m);
        tracing::debug!(name, object.mass_kg, ?speed_m_s, ?kinetic_j, ?stretch, ?gap_m, ?object.com_m, ?object.spin_rad_s, "moved");
        // Frame 0 stands where the spec puts it, under the ground if it says so; what is rigid comes out of it in its own time.
        let lowest = object.gap_m.iter().skip(1).copied().fold(f64::INFINITY, f64::min);
        if lowest < object.gap_m.first().map_or(0.0, |first| first.min(0.0)) - metrics.solver.cell_m {
            return Kind::Escaped(format!("{name} is {:.2} cells below", -lowest / metrics.solver.cell_m));
        }
    }
    match energy(spec, metrics) {
        Some(text) => Kind::Energy(text),
        None => Kind::Held,
    }
}

/// What bounds the root of the energy of all: how fast it may be at the start, and how much faster each second, m/s and m/s2.
struct Bound {
    start_m_s: f64,
    driven_m_s2: f64,
}

/// Work is force times speed, so that the root of the energy of all grows no faster than what drives it:
/// sqrt(2 E / m) <= sqrt(2 E0 / m) + pushes + a t. Static contact does no work. None where something drives without a bound.
fn bound(spec: &Spec, metrics: &Metrics) -> Option<Bound> {
    // What starts inside a surface is pushed out of it, whatever that takes.
    if metrics.objects.values().any(|o| o.gap_m.first().is_some_and(|gap| *gap < -0.1 * metrics.solver.cell_m)) {
        return None;
    }
    let norm = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let driven_m_s2 = norm(&spec.world.gravity_m_s2) + constant_forces(spec)?;
    let pushes = spec.events.iter().map(|e| e.push_m_s.as_ref().map_or(0.0, norm) + e.velocity_m_s.as_ref().map_or(0.0, norm)).sum::<f64>();
    // A particle that turns holds energy of its own, about that of a ball a cell wide: 1/2 m (w cell)^2 / 2 (Jiang et al. 2015).
    let spin_rad_s = spec.objects.iter().map(|o| norm(&o.spin_rad_s)).fold(0.0, f64::max);
    // And a surface what its tension can give: 2 sigma A / m.
    let side_m = f64::from(spec.solver.cells_across.unwrap_or(0)) * metrics.solver.cell_m;
    let surface = 2.0 * tension_n_m(spec) * 6.0 * side_m.powi(2) * spec.objects.len() as f64 / mass_kg(metrics);
    let start_m_s =
        (energy_m_s(metrics, 0).powi(2) + 0.5 * (spin_rad_s * metrics.solver.cell_m).powi(2) + surface + unloaded(spec, metrics, side_m)).sqrt();
    Some(Bound { start_m_s: start_m_s + pushes, driven_m_s2 })
}

fn mass_kg(metrics: &Metrics) -> f64 {
    metrics.objects.values().map(|o| o.mass_kg).sum()
}

/// The root of the kinetic energy of all at a frame, sqrt(2 E / m).
fn energy_m_s(metrics: &Metrics, frame: usize) -> f64 {
    let kinetic_j = metrics.objects.values().map(|o| o.kinetic_j.get(frame).copied().unwrap_or(0.0)).sum::<f64>();
    (2.0 * kinetic_j / mass_kg(metrics)).sqrt()
}

/// Says where there is more energy than its bound.
fn energy(spec: &Spec, metrics: &Metrics) -> Option<String> {
    let Bound { start_m_s, driven_m_s2 } = bound(spec, metrics)?;
    (1..metrics.frames as usize).find_map(|frame| {
        let most = start_m_s + driven_m_s2 * frame as f64 / f64::from(metrics.fps);
        let (now, slack) = (energy_m_s(metrics, frame), 0.05 * most + 0.02);
        (now > most + slack).then(|| format!("{now:.3} m/s at frame {frame}, where at most {most:.3} was put in"))
    })
}

/// What the captured pose stores under its weight and gives back where it is lifted or turned, 2 W / m: its stress is at most
/// rho g h, and acts along the strain that is then seen, which is measured to a step of its rounding.
fn unloaded(spec: &Spec, metrics: &Metrics, height_m: f64) -> f64 {
    const STRAIN_STEP: f64 = 1.0 / 16384.0;
    let stands = spec.objects.iter().any(|o| o.rest == Rest::AsCaptured);
    let strains = metrics.objects.values().flat_map(|o| &o.stretch_max).map(|stretch| stretch - 1.0 + STRAIN_STEP);
    let gravity_m_s2 = spec.world.gravity_m_s2.iter().map(|c| c * c).sum::<f64>().sqrt();
    if stands { gravity_m_s2 * height_m * strains.fold(0.0, f64::max) } else { 0.0 }
}

/// The most surface tension of anything.
fn tension_n_m(spec: &Spec) -> f64 {
    let own = spec.objects.iter().flat_map(|o| std::iter::once(&o.material).chain(o.parts.iter().map(|p| &p.material)));
    let all = own.chain(spec.events.iter().filter_map(|e| e.material.as_ref()));
    all.map(|m| if let Material::Liquid(liquid) = m { liquid.surface_tension_n_m } else { 0.0 }).fold(0.0, f64::max)
}

/// The sum of all constant accelerations; none where something drives that has no such bound.
fn constant_forces(spec: &Spec) -> Option<f64> {
    let value = serde_json::to_value(spec).ok()?;
    let drives = |o: &serde_json::Value| o.to_string().contains("activation");
    if value.get("object").is_some_and(drives) || value.get("event").is_some_and(drives) {
        return None;
    }
    let list = |name: &str| value.get(name).and_then(|v| v.as_array()).cloned().unwrap_or_default();
    if list("pin").iter().any(|p| p.get("path").is_some_and(|v| !v.is_null())) {
        return None;
    }
    list("force").iter().try_fold(0.0, |sum, force| {
        let vector: Option<Vec<f64>> = force.get("acceleration_m_s2")?.as_array()?.iter().map(serde_json::Value::as_f64).collect();
        Some(sum + vector?.iter().map(|c| c * c).sum::<f64>().sqrt())
    })
}

/// A folder that goes when it is dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(first: u64) -> Result<Folder, EngineError> {
        let folder = std::env::temp_dir().join(format!("phystalk-random-{}-{first}", std::process::id()));
        // A folder that cannot be made shows when the scene is written.
        let _ = std::fs::create_dir_all(&folder);
        let made = Folder(folder);
        scene::write(&made.0.join(SCENE), &block())?;
        Ok(made)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // What cannot be removed is in the folder for temporary things.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A block of Gaussians, 0.5 x 0.4 x 0.6 units, standing on z = 0 about x = 0.
fn block() -> Gaussians {
    let mut block = Gaussians::default();
    for i in 0..10 * 8 * 12 {
        let cell = Vec3::new((i % 10) as f32, (i / 10 % 8) as f32, (i / 80) as f32);
        block.mean.push((cell - Vec3::new(4.5, 3.5, 0.0)) * 0.05);
        block.scale.push(Vec3::splat(0.022));
        block.rotation.push([1.0, 0.0, 0.0, 0.0]);
        block.opacity.push(0.9);
        block.sh.extend([0.1; 3]);
    }
    block
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ends_on_its_way_is_given_up_and_what_never_moved_is_refused() {
        let large = || SolverError::TooFast { time_s: 0.3, speed_m_s: 9e9, cell_m: 0.01, substeps: 1 << 30 };
        assert!(matches!(ended(&EngineError::at(large(), 0.3)), Kind::GivenUp(_)));
        assert!(matches!(ended(&EngineError::at(large(), 0.0)), Kind::Refused(_)));
        assert!(matches!(ended(&EngineError::from(large())), Kind::Refused(_)));
    }

    /// A quarter of them: the threads of a test run share the whole.
    fn survived(quarter: u64) {
        let gpu = Gpu::shared_for_tests().unwrap();
        let mut told = Vec::new();
        let seeds = quarter * QUICK / 4..(quarter + 1) * QUICK / 4;
        let checks = checks(&gpu, Size::Small, seeds, &mut |o| told.push(o.clone())).unwrap();
        let bad: Vec<_> = told.iter().filter(|o| !matches!(o.kind, Kind::Held | Kind::Refused(_))).collect();
        assert!(bad.is_empty(), "{bad:#?}");
        let refused: Vec<_> = told.iter().filter(|o| o.kind != Kind::Held).collect();
        assert!(checks.iter().all(|c| c.held), "{checks:#?} {refused:#?}");
    }

    #[test]
    fn v28_random_specs_are_survived() {
        survived(0);
    }

    #[test]
    fn v28_random_specs_are_survived_in_the_second_quarter() {
        survived(1);
    }

    #[test]
    fn v28_random_specs_are_survived_in_the_third_quarter() {
        survived(2);
    }

    #[test]
    fn v28_random_specs_are_survived_in_the_last_quarter() {
        survived(3);
    }

    /// Whole specs that were given up once, or gained energy: pushes of rigid bodies faster than anything is followed, overlaps
    /// that opened as fast as a large scene allows, heavy stuff beside light bodies, a liquid of one particle, what was crushed and
    /// turned to sand, a liquid with a corner in a wall.
    const MENDED: [u64; 10] = [200_978, 36_265, 208_157, 20_002, 200_407, 200_512, 30_083, 74_029, 406_525, 205_903];

    #[test]
    fn v28_specs_that_failed_once_are_survived() {
        let gpu = Gpu::shared_for_tests().unwrap();
        let mut told = Vec::new();
        for seed in MENDED {
            survive(&gpu, Size::Whole, seed..seed + 1, &mut |o| told.push(o.clone())).unwrap();
        }
        let bad: Vec<_> = told.iter().filter(|o| o.kind != Kind::Held).collect();
        assert!(bad.is_empty(), "{bad:#?}");
    }
}
