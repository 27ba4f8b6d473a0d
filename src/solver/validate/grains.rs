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
        Particles { density_kg_m3: vec![1600.0; body.len()], substances, ..body }
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

/// A layer on a rough plane that is tilted by an angle: the speed of its upper half, in its middle,
/// at two times.
fn tilted(gpu: &Gpu, friction_angle_deg: f32, tilt_deg: f32, at_s: [f64; 2]) -> Result<[f64; 2], SolverError> {
    let (length_m, height_m) = (1.2f32, 0.12f32);
    let column =
        Column { length_m, height_m, round: false, friction_angle_deg, ground_friction: 10.0, spacing_m: 0.015, until_s: 0.0, face_deg: 90.0 };
    let particles = column.particles();
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
    let [early, late] = tilted(gpu, friction_deg, tilt_deg, at_s)?;
    let (sin, cos) = f64::from(tilt_deg).to_radians().sin_cos();
    let slides = (late - early) / (at_s[1] - at_s[0]);
    let angle_deg = (sin / cos - slides / (9.81 * cos)).atan().to_degrees();
    let check = Check::new("V13 angle of friction of a sliding layer", "tan f = tan t - a / (g cos t); 1 degree of it", "Coulomb", "degrees");
    Ok(vec![check.compare(friction_deg.into(), angle_deg, 1.0 / f64::from(friction_deg))])
}

/// A low heap beside a wall, whose face has a slope, on ground as rough as itself.
fn heap(friction_angle_deg: f32, face_deg: f32, length_m: f32, until_s: f64) -> Column {
    let ground_friction = friction_angle_deg.to_radians().tan();
    Column { length_m, height_m: 0.24, round: false, friction_angle_deg, ground_friction, spacing_m: 0.015, until_s, face_deg }
}

/// A heap with a face at its angle of friction stands; one whose face was upright slides, and ends flatter than that.
pub(super) fn repose(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let slope = |column: Column| Ok::<f64, SolverError>(column.deposit(gpu)?.slope_deg(0.2, 0.8).into());
    let stands = |name, angle_deg: f32, length_m: f32| {
        let check = Check::new(name, "its slope a fiftieth of a second after it was made; a degree of it", "Coulomb", "degrees");
        let (before, after) = (slope(heap(angle_deg, angle_deg, length_m, 0.02))?, slope(heap(angle_deg, angle_deg, length_m, 1.2))?);
        Ok::<Check, SolverError>(check.compare(before, after, 1.0 / before))
    };
    // It slides until its speed is spent, past the slope at which forces balance: by 4 degrees from an upright face, by
    // 2.5 from one of 35 degrees at 25. As far with cells of 30, 20 and 15 mm.
    let slid = |name, friction_angle_deg: f32| {
        let check = Check::new(name, "the angle of friction, or up to 5 degrees less by its momentum", "Coulomb's slope", "degrees");
        let measured = slope(heap(friction_angle_deg, 90.0, 0.6, 1.2))?;
        Ok::<Check, SolverError>(check.compare(friction_angle_deg.into(), measured, 5.0 / f64::from(friction_angle_deg)))
    };
    Ok(vec![
        stands("V13 heap at 25 degrees stands", 25.0, 0.8)?,
        stands("V13 heap at 32 degrees stands", 32.0, 0.7)?,
        slid("V13 slope after a slide, 25 degrees", 25.0)?,
        slid("V13 slope after a slide, 32 degrees", 32.0)?,
    ])
}

/// Collapse of a slab as high as it is long: glass beads, and sand.
pub(super) fn slab(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let column = |friction_angle_deg: f32, ground_friction: f32, spacing_m: f32| {
        Column { length_m: 0.4, height_m: 0.4, round: false, friction_angle_deg, ground_friction, spacing_m, until_s: 1.2, face_deg: 90.0 }
            .deposit(gpu)
    };
    let runout = |deposit: &Deposit| f64::from(deposit.reach_m() / 0.4 - 1.0);
    let beads = column(22.2, 0.466, 0.02)?;
    let sand = column(31.0, 0.45, 0.0133)?;
    let glass = "Kumar 2015, grains of glass beads as in Lajeunesse et al. 2005, a = 1";
    Ok(vec![
        Check::new("V14 slab of glass beads", "(L - L0) / L0 = 1.67 a", glass, "1").compare(1.67, runout(&beads), 0.2),
        Check::new("V14 slab of sand", "(L - L0) / L0 = 1.2 a", "Lube et al. 2005, a = 1", "1").compare(1.2, runout(&sand), 0.2).with_plot(Plot {
            caption: "Where a slab of sand, as high as it was long, comes to rest: the dots; the line is the slab before, and the reach that experiments found"
                .to_owned(),
            x: "distance from the wall, m",
            y: "height, m",
            expected: vec![[0.0, 0.4], [0.4, 0.4], [0.4, 0.0], [0.88, 0.0]],
            measured: sand.profile().iter().map(|p| p.map(f64::from)).collect(),
        }),
    ])
}

/// Collapse of a cylinder as high as its radius.
pub(super) fn cylinder(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let column = Column {
        length_m: 0.3,
        height_m: 0.3,
        round: true,
        friction_angle_deg: 30.0,
        ground_friction: 0.45,
        spacing_m: 0.0125,
        until_s: 1.0,
        face_deg: 90.0,
    };
    let deposit = column.deposit(gpu)?;
    let (reach, height) = (f64::from(deposit.reach_m() / 0.3), f64::from(deposit.height_m() / 0.3));
    Ok(vec![
        Check::new("V15 cylinder, reach", "(R - R0) / R0 = 1.24 a", "Lube et al. 2004, a = 1", "1").compare(1.24, reach - 1.0, 0.2),
        Check::new("V15 cylinder, height", "H / R0 = 0.74", "Lajeunesse et al. 2004, a over 0.74", "1").compare(0.74, height, 0.2),
    ])
}
