//! Bodies that fields drive: drag, a fall's terminal speed, a spring, a swirl, the same bits again.

use super::bodies::{block, centre_m, momentum};
use super::repeat::differing;
use super::{Check, Plot};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::types::{Field, Particles, Settings, SolverError};
use crate::spec::{Acceleration, Auto, Drag, FieldFacts, Force, Spring, Until, Vortex};
use glam::{DVec3, Vec3};

/// A block of a tenth of a metre about a point.
pub(super) fn body(centre: Vec3, velocity: Vec3) -> Particles {
    let mut particles = block(centre - Vec3::splat(0.05), Vec3::splat(0.1), 0.025, 5e4, 0.3);
    particles.velocity_m_s.fill(velocity);
    particles
}

/// What a force that is a field does to an object.
pub(super) fn field(force: &Force, object: u32) -> Result<Field, SolverError> {
    let refused = |what: String| SolverError::Input { what, expected: "a force that is a field".to_owned() };
    let program = force.program(&FieldFacts::default()).map_err(|fault| refused(fault.to_string()))?;
    let acceleration = program.ok_or_else(|| refused("a constant".to_owned()))?;
    Ok(Field { name: force.name.clone(), object, from_s: force.from_s, to_s: force.ends_s(), acceleration })
}

pub(super) fn under(gpu: &Gpu, particles: &Particles, gravity_m_s2: f32, fill: impl FnOnce(&mut Force)) -> Result<Solver, SolverError> {
    let mut force = Force::new("field", "body", 0.0, Until::End);
    fill(&mut force);
    let settings = Settings { gravity_m_s2: Vec3::new(0.0, 0.0, -gravity_m_s2), fields: vec![field(&force, 0)?], ..Settings::new(0.05) };
    Solver::new(gpu, settings, particles)
}

pub(super) fn velocity(solver: &Solver) -> Result<DVec3, SolverError> {
    let states = solver.states()?;
    let mass: f64 = states.iter().map(|s| f64::from(s.mass_kg)).sum();
    Ok(momentum(&states) / mass)
}

/// Linear drag slows as an exponential; a fall against quadratic drag ends at its terminal speed.
pub(super) fn drag(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let stop = Stop::default();
    let linear = |force: &mut Force| force.drag = Some(Drag { linear_per_s: 5.0, quadratic_per_m: 0.0 });
    let mut slowed = under(gpu, &body(Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0)), 0.0, linear)?;
    let mut plot = Plot { caption: "Speed under a drag of 5 /s".to_owned(), x: "t, s", y: "v, m/s", expected: Vec::new(), measured: Vec::new() };
    for frame in 0..=20 {
        let time_s = 0.02 * f64::from(frame);
        slowed.advance(time_s, &stop)?;
        plot.expected.push([time_s, 2.0 * (-5.0 * time_s).exp()]);
        plot.measured.push([time_s, velocity(&slowed)?.x]);
    }
    let linear = Check::new("drag, linear", "v0 e^(-k t)", "Stokes 1851: drag by speed", "m/s");
    let linear = linear.compare(2.0 * (-2.0f64).exp(), velocity(&slowed)?.x, 0.01).with_plot(plot);
    let quadratic = |force: &mut Force| force.drag = Some(Drag { linear_per_s: 0.0, quadratic_per_m: 2.5 });
    let mut falling = under(gpu, &body(Vec3::ZERO, Vec3::ZERO), 9.81, quadratic)?;
    falling.advance(1.5, &stop)?;
    let terminal = Check::new("drag, terminal speed", "sqrt(g / c)", "Newton 1687, book 2: drag by its square", "m/s");
    Ok(vec![linear, terminal.compare((9.81f64 / 2.5).sqrt(), -velocity(&falling)?.z, 0.02)])
}

/// A spring to a point keeps its period over several swings.
pub(super) fn spring(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (stop, stiffness, step_s) = (Stop::default(), 144.0, 0.01);
    let to = Some([-0.1, 0.0, 0.0]);
    let drawn = |force: &mut Force| force.spring = Some(Spring { to_m: to, path_m: vec![], stiffness_per_s2: stiffness, damping_per_s: 0.0 });
    let mut solver = under(gpu, &body(Vec3::ZERO, Vec3::ZERO), 0.0, drawn)?;
    let (mut crossings, mut before) = (Vec::new(), 0.1);
    for k in 1..=160 {
        let time_s = step_s * f64::from(k);
        solver.advance(time_s, &stop)?;
        let now = centre_m(&solver.states()?).x + 0.1;
        if before * now < 0.0 {
            crossings.push(time_s - step_s * now / (now - before));
        }
        before = now;
    }
    let swings = crossings.len().saturating_sub(1).max(1) as f64;
    let period_s = match (crossings.first(), crossings.last()) {
        (Some(first), Some(last)) => 2.0 * (last - first) / swings,
        _ => f64::NAN,
    };
    let check = Check::new("spring period", "2 pi / sqrt(k)", "Hooke 1678: x'' = -k x", "s");
    Ok(vec![check.compare(std::f64::consts::TAU / f64::sqrt(stiffness), period_s, 0.02)])
}

/// What floats in a swirl stays on its circle and keeps its speed.
pub(super) fn vortex(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let swirl = Vortex { centre_m: Auto::Value([0.0; 3]), axis: [0.0, 0.0, 1.0], speed_m_s: 3.0, radius_m: 1.0, lift_m_s: 0.0, drag_per_s: 1.0 };
    let mut solver = under(gpu, &body(Vec3::X, Vec3::new(0.0, 3.0, 0.0)), 0.0, |force| force.vortex = Some(swirl))?;
    solver.advance(1.0, &Stop::default())?;
    let check = |name, unit| Check::new(name, "unchanged after half a turn", "Huygens 1673: a steady circle, carried by the flow", unit);
    Ok(vec![
        check("swirl, speed of what floats in it", "m/s").compare(3.0, velocity(&solver)?.length(), 0.02),
        check("swirl, radius of its circle", "m").compare(1.0, centre_m(&solver.states()?).length(), 0.03),
    ])
}

/// An expression with noise, twice and from a checkpoint.
pub(super) fn same_bits(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let stop = Stop::default();
    let text = "vec3(3 * sin(20 * t), noise(10 * x), random(seed)) - 2 * v - 400 * (x - x0)";
    let wild = |force: &mut Force| force.acceleration_m_s2 = Some(Acceleration::Expression(text.to_owned()));
    let particles = body(Vec3::ZERO, Vec3::new(1.0, 0.0, 0.5));
    let start = || under(gpu, &particles, 9.81, wild);
    let mut first = start()?;
    first.advance(0.04, &stop)?;
    let kept = first.checkpoint()?;
    first.advance(0.08, &stop)?;
    let end = first.checkpoint()?;
    let (mut second, mut third) = (start()?, start()?);
    second.advance(0.08, &stop)?;
    third.restore(&kept)?;
    third.advance(0.08, &stop)?;
    let check = |name| Check::new(name, "bytes that differ", "IEEE 754: each particle by itself", "bytes");
    Ok(vec![
        check("fields, a second run").compare(0.0, differing(&end, &second.checkpoint()?), 0.0),
        check("fields, from a checkpoint").compare(0.0, differing(&end, &third.checkpoint()?), 0.0),
    ])
}
