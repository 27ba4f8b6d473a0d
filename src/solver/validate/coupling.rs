//! What meets what: momentum between all kinds of matter, floating bodies (V23), thin colliders.

use super::Check;
use super::bodies::{block, joined, keep, pool, rigid, walls};
use super::rigid::momenta;
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::state::ParticleState;
use crate::solver::substance::{Substance, liquid_bulk_pa};
use crate::solver::types::{Collider, Particles, Plane, Settings, SolverError};
use crate::spec::{BoxShape, ColliderShape};
use glam::Vec3;

const GRAVITY_M_S2: f32 = 9.81;
const SPACING_M: f32 = 0.01;
const CELL_M: f32 = 2.0 * SPACING_M;
const LIQUID_KG_M3: f32 = 1000.0;

/// What a block is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Rigid,
    Elastic,
    /// On the grid.
    Liquid,
    /// The same, and its surface pulls.
    Taut,
    /// Of smoothed particles.
    Sph,
    Sand,
    Snow,
    /// Flows above a yield stress.
    Mud,
}

impl Kind {
    fn block(self, low_m: Vec3, size_m: Vec3, speed_m_s: f32) -> Particles {
        let (viscosity_pa_s, surface_tension_n_m) = (1e-3, if self == Kind::Taut { 1.0 } else { 0.0 });
        let of = |substance| Particles { substances: vec![substance], ..block(low_m, size_m, SPACING_M, 5e4, 0.3) };
        match self {
            Kind::Rigid => rigid(block(low_m, size_m, SPACING_M, 1e5, 0.3), 0.3, 0.0),
            Kind::Elastic => block(low_m, size_m, SPACING_M, 5e4, 0.3),
            Kind::Liquid | Kind::Taut => {
                let bulk_pa = liquid_bulk_pa(size_m.z, speed_m_s, GRAVITY_M_S2, LIQUID_KG_M3);
                pool(low_m, size_m, SPACING_M, LIQUID_KG_M3, bulk_pa, Substance::Liquid { viscosity_pa_s, surface_tension_n_m })
            }
            Kind::Sph => {
                let substances = vec![Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m }];
                Particles { substances, ..block(low_m, size_m, SPACING_M, 1.0, 0.0) }
            }
            Kind::Sand => of(Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 0.0 }),
            Kind::Snow => of(Substance::Snow { theta_c: 2.5e-2, theta_s: 7.5e-3, hardening: 10.0 }),
            Kind::Mud => of(Substance::Viscoplastic { yield_stress_pa: 300.0, viscosity_pa_s: 20.0 }),
        }
    }
}

/// Rows of a pair: momentum, angular momentum, what the one that is hit gains; then what it is, and what flies.
type Pair = ([&'static str; 3], Kind, Kind);

/// The three rows of a pair of that name.
macro_rules! rows {
    ($name:literal) => {
        [concat!("V24 pairs, momentum, ", $name), concat!("V24 pairs, angular momentum, ", $name), concat!("V24 pairs, what is hit gains, ", $name)]
    };
}

const PAIRS: [Pair; 16] = [
    (rows!("rigid on rigid"), Kind::Rigid, Kind::Rigid),
    (rows!("rigid on elastic"), Kind::Elastic, Kind::Rigid),
    (rows!("elastic on rigid"), Kind::Rigid, Kind::Elastic),
    (rows!("rigid on liquid"), Kind::Liquid, Kind::Rigid),
    (rows!("rigid on SPH liquid"), Kind::Sph, Kind::Rigid),
    (rows!("rigid on sand"), Kind::Sand, Kind::Rigid),
    (rows!("rigid on snow"), Kind::Snow, Kind::Rigid),
    (rows!("rigid on mud"), Kind::Mud, Kind::Rigid),
    (rows!("elastic on elastic"), Kind::Elastic, Kind::Elastic),
    (rows!("elastic on liquid"), Kind::Liquid, Kind::Elastic),
    (rows!("elastic on liquid with tension"), Kind::Taut, Kind::Elastic),
    (rows!("elastic on SPH liquid"), Kind::Sph, Kind::Elastic),
    (rows!("elastic on sand"), Kind::Sand, Kind::Elastic),
    (rows!("elastic on snow"), Kind::Snow, Kind::Elastic),
    (rows!("elastic on mud"), Kind::Mud, Kind::Elastic),
    (rows!("liquid on SPH liquid"), Kind::Sph, Kind::Liquid),
];

/// V24: a block flies into another in free space, for every pair of kinds; whatever one loses the other gains.
pub(super) fn pairs(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    for pair in &PAIRS {
        checks.extend(collide(gpu, pair)?);
    }
    Ok(checks)
}

fn collide(gpu: &Gpu, &(names, still, flying): &Pair) -> Result<[Check; 3], SolverError> {
    let (size_m, velocity_m_s) = (Vec3::splat(0.08), Vec3::new(0.4, 0.0, -2.0));
    let mut particles = joined(still.block(Vec3::ZERO, size_m, 2.0), flying.block(Vec3::new(0.013, 0.007, 0.1), size_m, 2.0));
    let first = particles.len() / 2;
    particles.velocity_m_s[first..].fill(velocity_m_s);
    let settings = Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) };
    let mut solver = Solver::new(gpu, settings, &particles)?;
    let before = momenta(&solver)?;
    solver.advance(0.06, &Stop::default())?;
    let (after, states) = (momenta(&solver)?, solver.states()?);
    let size = before.0.length();
    let source = "Newton 1687, corollary 3 to the laws";
    let linear = Check::new(names[0], "share lost: 0", source, "1").compare(0.0, (after.0 - before.0).length() / size, 1e-3);
    // The scale of angular momentum: all momentum, at half an edge.
    let turned = (after.1 - before.1).length() / (size * 0.5 * f64::from(size_m.z));
    let angular = Check::new(names[1], "share of p r lost: 0", "Euler 1776: moments balance", "1").compare(0.0, turned, 1e-2);
    let mass = |some: &[ParticleState]| some.iter().map(|s| f64::from(s.mass_kg)).sum::<f64>();
    let (hit, whole) = (mass(&states[..first]), mass(&states));
    let gained = states[..first].iter().map(|s| f64::from(s.mass_kg * s.velocity_m_s.z)).sum::<f64>() / hit;
    // Of what it would gain if both stuck together.
    let share = gained / (f64::from(velocity_m_s.z) * (whole - hit) / whole);
    Ok([linear, angular, gains(names[2], still, flying, share)])
}

/// What is hit gains m1 v / (m1 + m2) where both stick together, as bodies without restitution and snow do; up to twice
/// that where what is elastic gives back; and any of that but none where matter flies past.
fn gains(name: &'static str, still: Kind, flying: Kind, share: f64) -> Check {
    let [solid, sticky] = [[Kind::Rigid, Kind::Elastic], [Kind::Rigid, Kind::Snow]];
    let (formula, low, high) = if sticky.contains(&still) && sticky.contains(&flying) || still == Kind::Snow {
        ("m1 v / (m1 + m2): they stick, to 5 %", 0.95, 1.05)
    } else if solid.contains(&still) && solid.contains(&flying) {
        ("m1 v / (m1 + m2) to twice that", 1.0, 2.0)
    } else {
        ("0 <= dv <= 2 m1 v / (m1 + m2), and a tenth of that or more", 0.1, 2.0)
    };
    let middle = 0.5 * (low + high);
    Check::new(name, formula, "Huygens 1669: impact with 0 <= e <= 1", "of m1 v / (m1 + m2)").compare(middle, share, (high - low) / (high + low))
}

/// Cells along a cube's edges.
const CUBE_CELLS: f64 = 4.0;
/// Cells to which a cube floats as it should: where the surface of a body or of a liquid lies, a grid knows no better.
const AFLOAT_CELLS: f64 = 0.125;
/// Spacings along each axis of a pool, and along the edges of a cube.
const POOL: [u32; 3] = [20, 20, 15];
const CUBE: u32 = 8;

/// V23: how deep cubes float in a liquid on the grid.
pub(super) fn floating(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let cubes = [("V23 elastic cube", Kind::Elastic, 500.0), ("V23 rigid cube", Kind::Rigid, 500.0)];
    cubes.into_iter().map(|(name, cube, density)| floats(gpu, name, cube, density)).collect()
}

fn floats(gpu: &Gpu, name: &'static str, cube: Kind, density_kg_m3: f32) -> Result<Check, SolverError> {
    let share = submerged(gpu, cube, density_kg_m3)?;
    let check = Check::new(name, "submerged share = density over the liquid's", "Archimedes, On Floating Bodies, book 1, prop. 5", "");
    let expected = f64::from(density_kg_m3 / LIQUID_KG_M3);
    Ok(check.compare(expected, share, AFLOAT_CELLS / CUBE_CELLS / expected))
}

/// Mean submerged share of a cube that was let go near where it floats, over the end of a run.
fn submerged(gpu: &Gpu, cube: Kind, density_kg_m3: f32) -> Result<f64, SolverError> {
    let room_m = Vec3::from(POOL.map(|c| c as f32)) * SPACING_M;
    let edge_m = CUBE as f32 * SPACING_M;
    let level_m = room_m.z;
    let low_m = Vec3::new(0.5 * (room_m.x - edge_m), 0.5 * (room_m.y - edge_m), level_m - (0.5 * CUBE as f32).round() * SPACING_M);
    let mut floating = cube.block(low_m, Vec3::splat(edge_m), 0.0);
    floating.density_kg_m3.fill(density_kg_m3);
    let pool = keep(&Kind::Liquid.block(Vec3::ZERO, room_m, 0.0), |p| !inside(p, low_m, edge_m));
    let liquids = pool.len();
    let mut settings = Settings::new(CELL_M);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.0, restitution: 0.0 });
    settings.colliders = walls(Vec3::ZERO, room_m);
    let mut solver = Solver::new(gpu, settings, &joined(pool, floating))?;
    let (mut under, samples) = (0.0, 20);
    for k in 1..=40 {
        solver.advance(0.04 * f64::from(k), &Stop::default())?;
        let states = solver.states()?;
        let mean_z = |some: &[ParticleState]| some.iter().map(|s| s.position_m.z).sum::<f32>() / some.len() as f32;
        let bottom = mean_z(&states[liquids..]) - 0.5 * edge_m;
        // Where the surface stands: the mean height of a flat pool that the cube reaches into.
        let mean = mean_z(&states[..liquids]);
        let narrow = edge_m * edge_m / (room_m.x * room_m.y - edge_m * edge_m);
        let level = mean + (mean * mean + narrow * bottom * (2.0 * mean - bottom)).sqrt();
        under += if k > 40 - samples { f64::from((level - bottom) / edge_m) / f64::from(samples) } else { 0.0 };
    }
    Ok(under)
}

fn inside(p: Vec3, low_m: Vec3, edge_m: f32) -> bool {
    p.cmpgt(low_m).all() && p.cmplt(low_m + edge_m).all()
}

const ON_A_PLATE: [(&str, Kind); 7] = [
    ("thin plate under a rigid block", Kind::Rigid),
    ("thin plate under an elastic block", Kind::Elastic),
    ("thin plate under liquid", Kind::Liquid),
    ("thin plate under SPH liquid", Kind::Sph),
    ("thin plate under sand", Kind::Sand),
    ("thin plate under snow", Kind::Snow),
    ("thin plate under mud", Kind::Mud),
];

/// A plate a quarter of a cell thin holds what falls on it at 4 m/s: all of it stays on top, over the plate.
pub(super) fn plate(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (thick_m, width_m) = (0.25 * CELL_M, 4.0f32);
    let holds = |&(name, kind): &(&'static str, Kind)| {
        let mut particles = kind.block(Vec3::new(-0.05, -0.05, 0.02), Vec3::splat(0.1), 4.0);
        particles.velocity_m_s.fill(Vec3::new(0.0, 0.0, -4.0));
        let wide = f64::from(width_m);
        let shape = BoxShape { centre_m: [0.0, 0.0, f64::from(-0.5 * thick_m)], size_m: [wide, wide, f64::from(thick_m)] };
        let colliders = vec![Collider { shape: ColliderShape::Box(shape), friction: 0.3, restitution: 0.0 }];
        let mut solver = Solver::new(gpu, Settings { colliders, ..Settings::new(CELL_M) }, &particles)?;
        solver.advance(0.25, &Stop::default())?;
        // What is no number is nowhere, and so not on the plate.
        let on_top = |s: &&ParticleState| s.position_m.z >= -0.5 * thick_m && s.position_m.truncate().abs().max_element() < 0.5 * width_m;
        let states = solver.states()?;
        let share = states.iter().filter(on_top).count() as f64 / states.len() as f64;
        Ok(Check::new(name, "share that stays on top of it: 1", "a solid's surface bounds where anything can be", "1").compare(1.0, share, 0.0))
    };
    ON_A_PLATE.iter().map(holds).collect()
}
