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
    let elastic = runs(gpu, block(Vec3::new(0.0, 0.0, 0.06), Vec3::splat(0.2), 0.025, 5e4, 0.3), kicked)?;
    let laws = runs(gpu, every_law(), kicked)?;
    let coupled = runs(gpu, all_that_meets(), kicked)?;
    let sprung = runs(gpu, block(Vec3::new(0.0, 0.0, 0.06), Vec3::splat(0.2), 0.025, 1e6, 0.3), sprung)?;
    let check = |name, differing| Check::new(name, "bytes that differ", "integer sums, fixed order", "bytes").compare(0.0, differing, 0.0);
    let back = Check::new("V26 rolled back", "1 where any segment was", "a spring that no plan foresees", "1");
    Ok(vec![
        check("V26 a second run", elastic.second),
        check("V26 from a checkpoint", elastic.resumed),
        check("V26 every law, a second run", laws.second),
        check("V26 every law, from a checkpoint", laws.resumed),
        check("V26 bodies among all else, a second run", coupled.second),
        check("V26 bodies among all else, from a checkpoint", coupled.resumed),
        back.compare(1.0, f64::from(sprung.retries.min(1)), 0.0),
        check("V26 rolled back, a second run", sprung.second),
        check("V26 rolled back, from a checkpoint", sprung.resumed),
    ])
}

fn kicked(solver: &mut Solver) -> Result<(), SolverError> {
    solver.kick(0, Vec3::Y);
    Ok(())
}

/// As if it had been squeezed to a third, at rest: it flies apart faster than anything says beforehand.
fn sprung(solver: &mut Solver) -> Result<(), SolverError> {
    solver.edit(|s| s.set_f(s.f() * 0.3))
}

/// What runs have in common.
struct Repeat {
    /// Bytes in which the end of a second run differs from that of the first.
    second: f64,
    /// And that of one from a checkpoint in the middle.
    resumed: f64,
    /// Segments that the first rolled back.
    retries: u32,
}

/// Runs to a moment at which something happens, and on.
fn runs(gpu: &Gpu, mut particles: Particles, happens: impl Fn(&mut Solver) -> Result<(), SolverError>) -> Result<Repeat, SolverError> {
    particles.velocity_m_s.fill(Vec3::new(0.7, 0.1, -2.0));
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    let stop = Stop::default();
    let start = || Solver::new(gpu, settings.clone(), &particles);
    let mut first = start()?;
    first.advance(0.06, &stop)?;
    let kept = first.checkpoint()?;
    happens(&mut first)?;
    let retries = first.advance(0.1, &stop)?.retries;
    let end = first.checkpoint()?;

    let mut second = start()?;
    second.advance(0.06, &stop)?;
    happens(&mut second)?;
    second.advance(0.1, &stop)?;
    let mut third = start()?;
    third.restore(&kept)?;
    happens(&mut third)?;
    third.advance(0.1, &stop)?;

    Ok(Repeat { second: differing(&end, &second.checkpoint()?), resumed: differing(&end, &third.checkpoint()?), retries })
}

/// Bytes in which two checkpoints differ; what one lacks counts.
pub(super) fn differing(one: &[u8], other: &[u8]) -> f64 {
    (one.iter().zip(other).filter(|(a, b)| a != b).count() + one.len().abs_diff(other.len())) as f64
}

#[cfg(test)]
mod tests {
    use super::differing;

    #[test]
    fn a_shorter_checkpoint_is_not_the_same() {
        assert_eq!((differing(b"abcd", b"abcd"), differing(b"abcd", b"abxd"), differing(b"abcd", b"ab"), differing(b"", b"a")), (0.0, 1.0, 2.0, 1.0));
    }
}
