//! V26: the same bits again.

use super::Check;
use super::bodies::{append, block};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::{Activation, Substance};
use crate::solver::types::{Particles, Plane, Settings, SolverError};
use crate::spec::ElasticModel;
use glam::Vec3;

/// A small block of each law, side by side.
fn every_law() -> Particles {
    let laws = [
        Substance::Muscle {
            model: ElasticModel::Corotated,
            fibre: Vec3::new(1.0, 0.0, 1.0),
            activation: Activation::Wave { least: 0.0, most: 0.8, period_s: 0.05, phase: 0.1 },
        },
        Substance::Plastic { yield_stress_pa: 1e3, hardening_pa: 5e3 },
        Substance::Viscoplastic { yield_stress_pa: 300.0, viscosity_pa_s: 20.0 },
        Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 10.0 },
        Substance::Snow { theta_c: 2.5e-2, theta_s: 7.5e-3, hardening: 10.0 },
    ];
    let body = |k: usize| block(Vec3::new(0.11 * k as f32, 0.0, 0.03), Vec3::splat(0.1), 0.025, 5e4, 0.3);
    laws.into_iter().enumerate().fold(body(0), |mut all, (k, law)| {
        append(&mut all, body(k + 1), law);
        all
    })
}

/// Small blocks that fall onto each other: rigid, half rigid, elastic, and a liquid of each kind.
fn all_that_meets() -> Particles {
    let at = |k: usize| block(Vec3::new(0.11 * (k % 3) as f32, 0.02 * k as f32, 0.03 + 0.11 * (k / 3) as f32), Vec3::splat(0.1), 0.025, 5e4, 0.3);
    let stone = Substance::Rigid { friction: 0.4, restitution: 0.3 };
    let mut half = at(0);
    half.substance = half.position_m.iter().map(|p| u16::from(p.x > 0.05)).collect();
    half.substances.push(stone.clone());
    let (viscosity_pa_s, surface_tension_n_m) = (0.1, 0.05);
    let liquids = [Substance::Liquid { viscosity_pa_s, surface_tension_n_m }, Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m }];
    let others = liquids.into_iter().chain([stone.clone(), stone, Substance::default()]);
    others.enumerate().fold(half, |mut all, (k, substance)| {
        append(&mut all, at(k + 1), substance);
        all
    })
}

/// Blocks that hit the ground at a slant, twice, and once more from a checkpoint in the middle.
pub(super) fn same_bits(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let elastic = runs(gpu, block(Vec3::new(0.0, 0.0, 0.06), Vec3::splat(0.2), 0.025, 5e4, 0.3))?;
    let laws = runs(gpu, every_law())?;
    let coupled = runs(gpu, all_that_meets())?;
    let check = |name, differing| Check::new(name, "bytes that differ", "integer sums, fixed order", "bytes").compare(0.0, differing, 0.0);
    Ok(vec![
        check("V26 a second run", elastic[0]),
        check("V26 from a checkpoint", elastic[1]),
        check("V26 every law, a second run", laws[0]),
        check("V26 every law, from a checkpoint", laws[1]),
        check("V26 bodies among all else, a second run", coupled[0]),
        check("V26 bodies among all else, from a checkpoint", coupled[1]),
    ])
}

/// Bytes in which the end of a run differs from that of a second one, and of one from a checkpoint in
/// the middle.
fn runs(gpu: &Gpu, mut particles: Particles) -> Result<[f64; 2], SolverError> {
    particles.velocity_m_s.fill(Vec3::new(0.7, 0.1, -2.0));
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    let stop = Stop::default();
    let start = || Solver::new(gpu, settings.clone(), &particles);
    let mut first = start()?;
    first.advance(0.06, &stop)?;
    let kept = first.checkpoint()?;
    first.kick(0, Vec3::Y);
    first.advance(0.1, &stop)?;
    let end = first.checkpoint()?;

    let mut second = start()?;
    second.advance(0.06, &stop)?;
    second.kick(0, Vec3::Y);
    second.advance(0.1, &stop)?;
    let mut third = start()?;
    third.restore(&kept)?;
    third.kick(0, Vec3::Y);
    third.advance(0.1, &stop)?;

    let differing = |other: &[u8]| end.iter().zip(other).filter(|(a, b)| a != b).count() as f64;
    Ok([differing(&second.checkpoint()?), differing(&third.checkpoint()?)])
}
