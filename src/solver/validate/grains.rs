//! Sand that falls and comes to rest: V13 to V15.

use super::bodies::{block, keep, mean_of};
use super::{Check, Plot};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::Substance;
use crate::solver::types::{Collider, Particles, Plane, Settings, SolverError};
use crate::spec::{ColliderShape, PlaneShape};
use glam::Vec3;

/// A column that is let go beside smooth walls.
#[derive(Clone, Copy, Debug)]
struct Column {
    /// Its length or radius.
    length_m: f32,
    /// Its height.
    height_m: f32,
    /// Slope of the face that is let go, degrees; 90 for an upright one.
    face_deg: f32,
    /// Quarter of a cylinder between two walls; else a slab between three.
    round: bool,
    /// Slope of its rest.
    friction_angle_deg: f32,
    /// Coulomb coefficient of the ground.
    ground_friction: f32,
    /// Between particles; cells are twice that.
    spacing_m: f32,
    /// When it is looked at.
    until_s: f64,
}

const DENSITY_KG_M3: f32 = 1600.0;
/// Width of a slab in cells.
const SLAB_CELLS: f32 = 3.0;

impl Column {
    fn particles(&self) -> Particles {
        let s = self.spacing_m;
        let width_m = if self.round { self.length_m } else { SLAB_CELLS * 2.0 * s };
        let whole = block(Vec3::ZERO, Vec3::new(self.length_m, width_m, self.height_m), s, 5e5, 0.3);
        let out = |p: Vec3| if self.round { p.truncate().length() } else { p.x };
        let cot = 1.0 / self.face_deg.to_radians().tan();
        let body = keep(&whole, |p| out(p) + p.z * cot < self.length_m);
        let substances = vec![Substance::Sand { friction_angle_deg: self.friction_angle_deg, cohesion_pa: 0.0 }];
        Particles { density_kg_m3: vec![DENSITY_KG_M3; body.len()], substances, ..body }
    }

    fn settings(&self) -> Settings {
        let wall = |point_m: [f64; 3], normal: [f64; 3]| Collider {
            shape: ColliderShape::Plane(PlaneShape { point_m, normal }),
            friction: 0.0,
            restitution: 0.0,
        };
        let mut settings = Settings::new(2.0 * self.spacing_m);
        settings.ground = Some(Plane { height_m: 0.0, friction: self.ground_friction, restitution: 0.0 });
        settings.colliders = vec![wall([0.0; 3], [1.0, 0.0, 0.0]), wall([0.0; 3], [0.0, 1.0, 0.0])];
        if !self.round {
            let width_m = f64::from(SLAB_CELLS * 2.0 * self.spacing_m);
            settings.colliders.push(wall([0.0, width_m, 0.0], [0.0, -1.0, 0.0]));
        }
        settings
    }

    /// Where its particles come to rest.
    fn deposit(&self, gpu: &Gpu) -> Result<Deposit, SolverError> {
        let mut solver = Solver::new(gpu, self.settings(), &self.particles())?;
        solver.advance(self.until_s, &Stop::default())?;
        let states = solver.states()?;
        let out = |p: Vec3| if self.round { p.truncate().length() } else { p.x };
        let places = states.iter().map(|s| [out(s.position_m), s.position_m.z]).collect();
        Ok(Deposit { places, spacing_m: self.spacing_m })
    }
}

/// Particles at rest: how far out, how high.
struct Deposit {
    places: Vec<[f32; 2]>,
    spacing_m: f32,
}

impl Deposit {
    /// Height of the surface over bins of two cells: that of the highest particle and half a spacing.
    fn profile(&self) -> Vec<[f32; 2]> {
        let bin_m = 2.0 * self.spacing_m;
        let bins = (self.places.iter().fold(0f32, |a, p| a.max(p[0])) / bin_m) as usize + 1;
        let mut heights = vec![0f32; bins];
        for [x, z] in &self.places {
            let bin = (x / bin_m) as usize;
            heights[bin] = heights[bin].max(z + 0.5 * self.spacing_m);
        }
        heights.iter().enumerate().map(|(k, &z)| [(k as f32 + 0.5) * bin_m, z]).collect()
    }

    /// How far the deposit reaches without a gap: grains that lie alone do not count.
    fn reach_m(&self) -> f32 {
        let profile = self.profile();
        let covered = profile.iter().take_while(|p| p[1] > 0.0).count();
        covered as f32 * 2.0 * self.spacing_m
    }

    /// Highest particle and half a spacing.
    fn height_m(&self) -> f32 {
        self.places.iter().fold(0f32, |a, p| a.max(p[1])) + 0.5 * self.spacing_m
    }

    /// Slope of the surface between two shares of the height, degrees, by least squares.
    fn slope_deg(&self, low: f32, high: f32) -> f32 {
        let top = self.height_m();
        let profile = self.profile();
        let first = profile.iter().rposition(|p| p[1] > high * top).unwrap_or(0);
        let flank: Vec<[f32; 2]> = profile[first..].iter().copied().filter(|p| p[1] > low * top && p[1] <= high * top).collect();
        let n = flank.len() as f32;
        let mean = flank.iter().fold([0.0; 2], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n]);
        let (mut xx, mut xz) = (0f32, 0f32);
        for p in &flank {
            xx += (p[0] - mean[0]).powi(2);
            xz += (p[0] - mean[0]) * (p[1] - mean[1]);
        }
        (-xz / xx).atan().to_degrees()
    }
}

/// Thickness of a layer on a slope.
const LAYER_M: f32 = 0.12;

/// A layer on a rough plane that is tilted by an angle: the speed of its upper half, in its middle,
/// at two times.
fn tilted(gpu: &Gpu, friction_angle_deg: f32, cohesion_pa: f32, tilt_deg: f32, at_s: [f64; 2]) -> Result<[f64; 2], SolverError> {
    let (length_m, height_m) = (1.2f32, LAYER_M);
    let column =
        Column { length_m, height_m, round: false, friction_angle_deg, ground_friction: 10.0, spacing_m: 0.015, until_s: 0.0, face_deg: 90.0 };
    let mut particles = column.particles();
    particles.substances = vec![Substance::Sand { friction_angle_deg, cohesion_pa }];
    let mut settings = column.settings();
    settings.colliders.remove(0);
    let tilt = tilt_deg.to_radians();
    settings.gravity_m_s2 = Vec3::new(tilt.sin(), 0.0, -tilt.cos()) * 9.81;
    let picked: Vec<usize> = (0..particles.len())
        .filter(|&i| particles.position_m[i].z > 0.5 * height_m && (particles.position_m[i].x - 0.5 * length_m).abs() < 0.2 * length_m)
        .collect();
    let mut solver = Solver::new(gpu, settings, &particles)?;
    let mut speeds = [0.0; 2];
    for (speed, at_s) in speeds.iter_mut().zip(at_s) {
        solver.advance(at_s, &Stop::default())?;
        *speed = mean_of(&solver, &picked, |s| f64::from(s.velocity_m_s.x))?;
    }
    Ok(speeds)
}

/// V13: a layer slides down what is steeper than its angle of friction by g (sin t - tan f cos t).
pub(super) fn incline(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (friction_deg, tilt_deg) = (30.0f32, 38.0f32);
    let at_s = [0.15, 0.35];
    let [early, late] = tilted(gpu, friction_deg, 0.0, tilt_deg, at_s)?;
    let (sin, cos) = f64::from(tilt_deg).to_radians().sin_cos();
    let slides = (late - early) / (at_s[1] - at_s[0]);
    let angle_deg = (sin / cos - slides / (9.81 * cos)).atan().to_degrees();
    let check = Check::new(
        "V13 angle of friction of a sliding layer",
        "tan f = tan t - a / (g cos t); 1 degree of it",
        "Coulomb 1776, infinite slope",
        "degrees",
    );
    Ok(vec![check.compare(friction_deg.into(), angle_deg, 1.0 / f64::from(friction_deg))])
}

/// A layer that holds together: it stands where c >= rho g h (sin t - tan f cos t), and slides where less does.
pub(super) fn cohesion(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (friction_deg, tilt_deg) = (30.0f32, 38.0f32);
    let (sin, cos) = f64::from(tilt_deg).to_radians().sin_cos();
    let pull_pa = f64::from(DENSITY_KG_M3) * f64::from(LAYER_M) * 9.81;
    let needed_pa = pull_pa * (sin - f64::from(friction_deg).to_radians().tan() * cos);
    // What it gains over a while, as a share of what would hold it: gravity, there at once, first lets it slip a little.
    let at_s = [0.3, 0.5];
    let lacking = |share: f64| -> Result<f64, SolverError> {
        let [early, late] = tilted(gpu, friction_deg, (share * needed_pa) as f32, tilt_deg, at_s)?;
        Ok((late - early) / (at_s[1] - at_s[0]) * pull_pa / 9.81 / needed_pa)
    };
    let source = "Coulomb 1776, infinite slope with cohesion";
    let stands = Check::new("V13 cohesion, layer of 1.2 c stands", "rho h a / c: 0, c = rho g h (sin t - tan f cos t)", source, "1");
    let slides = Check::new("V13 cohesion, layer of 0.8 c slides", "0.8 + rho h a / c = 1, a > 0", source, "1");
    let left = lacking(0.8)?;
    let slid = slides.compare(1.0, if left > 0.0 { 0.8 + left } else { f64::NAN }, 0.2);
    Ok(vec![stands.compare(0.0, lacking(1.2)?, 0.05), slid])
}

/// A low heap beside a wall, whose face has a slope, on ground as rough as itself.
fn heap(friction_angle_deg: f32, face_deg: f32, length_m: f32) -> Column {
    let ground_friction = friction_angle_deg.to_radians().tan();
    Column { length_m, height_m: 0.24, round: false, friction_angle_deg, ground_friction, spacing_m: 0.015, until_s: 1.2, face_deg }
}

/// Heaps with a face at their angle of friction stand; those a little steeper come to it, to 3 degrees.
pub(super) fn repose(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let slope = |name, formula, column: Column| {
        let phi = f64::from(column.friction_angle_deg);
        let check = Check::new(name, formula, "Coulomb 1776: the slope of repose is that of friction, to 3 degrees", "degrees");
        Ok::<Check, SolverError>(check.compare(phi, column.deposit(gpu)?.slope_deg(0.2, 0.8).into(), 3.0 / phi))
    };
    let (stays, ends) = ("f, from a face of f", "f, from a face of f + 3");
    let cone = |face_deg| Column { round: true, ..heap(32.0, face_deg, 0.45) };
    Ok(vec![
        slope("V13 heap at 25 degrees stands", stays, heap(25.0, 25.0, 0.8))?,
        slope("V13 heap at 32 degrees stands", stays, heap(32.0, 32.0, 0.7))?,
        slope("V13 heap at 25 degrees, from a face of 28", ends, heap(25.0, 28.0, 0.75))?,
        slope("V13 heap at 32 degrees, from a face of 35", ends, heap(32.0, 35.0, 0.65))?,
        slope("V13 heap at 32 degrees, from a cone of 35", "atan(h / r) = f, from f + 3", cone(35.0))?,
    ])
}

/// How far a column runs out, as a share of its length, and how high it is left.
fn collapse(gpu: &Gpu, column: Column) -> Result<(f64, f64, Deposit), SolverError> {
    let deposit = column.deposit(gpu)?;
    let share = |of_m: f32| f64::from(of_m / column.length_m);
    Ok((share(deposit.reach_m()) - 1.0, share(deposit.height_m()), deposit))
}

/// Collapse of slabs beside a wall: glass beads, and sand.
pub(super) fn slab(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let column = |friction_angle_deg: f32, ground_friction: f32, aspect: f32, spacing_m: f32| Column {
        length_m: 0.4,
        height_m: 0.4 * aspect,
        round: false,
        friction_angle_deg,
        ground_friction,
        spacing_m,
        until_s: 1.2 * f64::from(aspect).sqrt(),
        face_deg: 90.0,
    };
    let beads = collapse(gpu, column(22.2, 0.466, 1.0, 0.02))?;
    let sand = collapse(gpu, column(31.0, 0.45, 1.0, 0.0133))?;
    let tall = collapse(gpu, Column { length_m: 0.2, ..column(31.0, 0.45, 1.5, 0.01) })?;
    let glass = "Kumar 2015, ch. 4, grains of glass beads as in Lajeunesse et al. 2005";
    let lube = "Lube et al. 2005 (from memory)";
    Ok(vec![
        Check::new("V14 slab of glass beads", "(L - L0) / L0 = 1.67 a, a = 1", glass, "1").compare(1.67, beads.0, 0.2),
        Check::new("V14 slab of sand", "(L - L0) / L0 = 1.2 a, a = 1", lube, "1").compare(1.2, sand.0, 0.2).with_plot(Plot {
            caption: "Where a slab of sand, as high as it was long, comes to rest: the dots; the line is the slab before, and the reach that experiments found"
                .to_owned(),
            x: "distance from the wall, m",
            y: "height, m",
            expected: vec![[0.0, 0.4], [0.4, 0.4], [0.4, 0.0], [0.88, 0.0]],
            measured: sand.2.profile().iter().map(|p| p.map(f64::from)).collect(),
        }),
        Check::new("V14 slab of sand, height", "H / L0 = a^(1/3), a = 1", "Lajeunesse et al. 2005, a over 0.7", "1").compare(1.0, sand.1, 0.2),
        Check::new("V14 slab of sand three times as high as long", "(L - L0) / L0 = 1.9 a^(2/3), a = 3", lube, "1").compare(1.9 * 3f64.powf(2.0 / 3.0), tall.0, 0.2),
    ])
}

/// Collapse of quarters of cylinders as high as their radius, between two walls: how far they reach. How high they are
/// left is not among the rows: 0.68 of the radius for sand and 0.54 for glass beads, where Lube et al. 2004 found 1 and
/// Lajeunesse et al. 2005 0.74. The cone of Drucker and Prager is a circle around the mean stress, made for plane shear: what is pressed
/// along one axis and gives way along two holds as if its angle were 25 degrees in place of 30.
pub(super) fn cylinder(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let reach = |name, formula, source, expected: f64, friction_angle_deg: f32| {
        let (length_m, spacing_m) = (0.3, 0.0125);
        let column =
            Column { length_m, height_m: length_m, round: true, friction_angle_deg, ground_friction: 0.45, spacing_m, until_s: 1.0, face_deg: 90.0 };
        Ok::<Check, SolverError>(Check::new(name, formula, source, "1").compare(expected, collapse(gpu, column)?.0, 0.2))
    };
    let (lube, lajeunesse) = ("Lube et al. 2004, as quoted by Kumar 2015, ch. 2", "Lajeunesse et al. 2005, as quoted by Kumar 2015, ch. 2");
    Ok(vec![
        reach("V15 cylinder of sand", "(R - R0) / R0 = 1.24 a, a = 1", lube, 1.24, 30.0)?,
        reach("V15 cylinder of glass beads", "(R - R0) / R0 = 2 sqrt(a), a = 1", lajeunesse, 2.0, 22.2)?,
    ])
}
