//! V26: the same bits again.

use super::Check;
use super::bodies::{append, block};
use super::driven::field;
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::{Activation, Substance};
use crate::solver::types::{Collider, Particles, PinRegion, Plane, Settings, SolverError};
use crate::spec::{Acceleration, BoxShape, ColliderShape, ElasticModel, Force, PlaneShape, SphereShape, Until};
use glam::Vec3;

/// A small block of each law, side by side; the last is nearly incompressible.
fn every_law() -> Particles {
    let wave = Activation::Wave { least: 0.0, most: 0.8, period_s: 0.05, phase: 0.1 };
    let curve = Activation::Curve(vec![(0.0, 0.0), (0.03, 0.4), (0.09, 0.1)]);
    let fibre = Vec3::new(1.0, 0.0, 1.0);
    let laws = [
        Substance::Muscle { model: ElasticModel::Corotated, fibre, activation: wave },
        Substance::Muscle { model: ElasticModel::NeoHookean, fibre, activation: curve },
        Substance::Plastic { yield_stress_pa: 1e3, hardening_pa: 5e3 },
        Substance::Plastic { yield_stress_pa: 1e3, hardening_pa: -5e3 },
        Substance::Viscoplastic { yield_stress_pa: 300.0, viscosity_pa_s: 20.0 },
        Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 10.0 },
        Substance::Snow { theta_c: 2.5e-2, theta_s: 7.5e-3, hardening: 10.0 },
        Substance::Elastic(ElasticModel::NeoHookean),
        Substance::Elastic(ElasticModel::NeoHookean),
    ];
    let last = laws.len();
    let body = |k: usize| {
        let low = Vec3::new(0.11 * (k % 5) as f32, 0.11 * (k / 5) as f32, 0.03);
        block(low, Vec3::splat(0.1), 0.025, 5e4, if k == last { 0.48 } else { 0.3 })
    };
    laws.into_iter().enumerate().fold(body(0), |mut all, (k, law)| {
        append(&mut all, body(k + 1), law);
        all
    })
}

/// Ground to fall on.
fn ground() -> Settings {
    Settings { ground: Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 }), ..Settings::new(0.05) }
}

/// With solids to fall on, the first block held by its top and led about, and a field that drives the second.
fn all_around() -> Result<Settings, SolverError> {
    let ball = SphereShape { centre_m: [0.16, 0.05, -0.02], radius_m: 0.06 };
    let cube = BoxShape { centre_m: [0.4, 0.15, 0.0], size_m: [0.1, 0.1, 0.08] };
    let solid = |shape| Collider { shape, friction: 0.4, restitution: 0.1 };
    let top = PlaneShape { point_m: [0.0, 0.0, 0.1], normal: [0.0, 0.0, -1.0] };
    let pin = PinRegion {
        object: 0,
        shape: ColliderShape::Plane(top),
        low_m: Vec3::ZERO,
        high_m: Vec3::splat(0.2),
        from_s: 0.02,
        to_s: 0.085,
        path: vec![[0.05, 0.01, 0.0, 0.01], [0.085, 0.0, 0.02, 0.0]],
    };
    let mut force = Force::new("gusts", "body", 0.0, Until::End);
    force.acceleration_m_s2 = Some(Acceleration::Expression("vec3(noise(10 * x), 3 * sin(20 * t), random(seed)) - 2 * v".to_owned()));
    Ok(Settings {
        colliders: vec![solid(ColliderShape::Sphere(ball)), solid(ColliderShape::Box(cube))],
        pins: vec![pin],
        fields: vec![field(&force, 1)?],
        ..ground()
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

/// Blocks that hit the ground at a slant, twice, and once more from checkpoints on the way.
pub(super) fn same_bits(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let cube = |young_pa| block(Vec3::new(0.0, 0.0, 0.06), Vec3::splat(0.2), 0.025, young_pa, 0.3);
    let elastic = runs(gpu, ground(), cube(5e4), kicked)?;
    let laws = runs(gpu, ground(), every_law(), kicked)?;
    let around = runs(gpu, all_around()?, every_law(), kicked)?;
    let coupled = runs(gpu, ground(), all_that_meets(), kicked)?;
    let sprung = runs(gpu, ground(), cube(1e6), sprung)?;
    let source = "IEEE 754; integer sums, fixed order";
    let check = |name, differing| Check::new(name, "bytes that differ: 0", source, "bytes").compare(0.0, differing, 0.0);
    let back = Check::new("V26 rolled back", "1 where any segment was", "a spring that no plan foresees", "1");
    Ok(vec![
        check("V26 a second run", elastic.second),
        check("V26 from a checkpoint", elastic.resumed),
        check("V26 from a later checkpoint", elastic.resumed_late),
        check("V26 every law, a second run", laws.second),
        check("V26 every law, from a checkpoint", laws.resumed),
        check("V26 every law, from a later checkpoint", laws.resumed_late),
        check("V26 every law among colliders, pin and field, a second run", around.second),
        check("V26 every law among colliders, pin and field, from a checkpoint", around.resumed),
        check("V26 every law among colliders, pin and field, from a later checkpoint", around.resumed_late),
        check("V26 bodies among all else, a second run", coupled.second),
        check("V26 bodies among all else, from a checkpoint", coupled.resumed),
        check("V26 bodies among all else, from a later checkpoint", coupled.resumed_late),
        back.compare(1.0, f64::from(sprung.retries.min(1)), 0.0),
        check("V26 rolled back, a second run", sprung.second),
        check("V26 rolled back, from a checkpoint before it", sprung.resumed),
        check("V26 rolled back, from a checkpoint after it", sprung.resumed_late),
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
    /// And that of one from a checkpoint before something happens, and from one after it.
    resumed: f64,
    resumed_late: f64,
    /// Segments that the first rolled back before the second of them.
    retries: u32,
}

/// Runs to a moment at which something happens, and on.
fn runs(
    gpu: &Gpu,
    settings: Settings,
    mut particles: Particles,
    happens: impl Fn(&mut Solver) -> Result<(), SolverError>,
) -> Result<Repeat, SolverError> {
    particles.velocity_m_s.fill(Vec3::new(0.7, 0.1, -2.0));
    let (stop, happens_s, later_s, end_s) = (Stop::default(), 0.06, 0.08, 0.1);
    let start = || Solver::new(gpu, settings.clone(), &particles);
    let mut first = start()?;
    first.advance(happens_s, &stop)?;
    let kept = first.checkpoint()?;
    happens(&mut first)?;
    let retries = first.advance(later_s, &stop)?.retries;
    let kept_late = first.checkpoint()?;
    first.advance(end_s, &stop)?;
    let end = first.checkpoint()?;

    let mut second = start()?;
    second.advance(happens_s, &stop)?;
    happens(&mut second)?;
    second.advance(end_s, &stop)?;
    let mut third = start()?;
    third.restore(&kept)?;
    happens(&mut third)?;
    third.advance(end_s, &stop)?;
    let mut fourth = start()?;
    fourth.restore(&kept_late)?;
    fourth.advance(end_s, &stop)?;

    let differs = |solver: &Solver| Ok::<f64, SolverError>(differing(&end, &solver.checkpoint()?));
    Ok(Repeat { second: differs(&second)?, resumed: differs(&third)?, resumed_late: differs(&fourth)?, retries })
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
