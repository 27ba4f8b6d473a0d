//! What else acts on bodies: attractors, blasts, motors, pins, impacts foreseen, friction on the ground.

use super::Check;
use super::bodies::{block, centre_m};
use super::driven::{body, under, velocity};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::types::{PinRegion, Placement, Plane, Settings, SolverError};
use crate::spec::{Attractor, Auto, BoxShape, ColliderShape, Explosion, Motor};
use glam::{DVec3, Quat, Vec3};

const GRAVITY_M_S2: f64 = 9.81;
const CELL_M: f32 = 0.05;

/// A round orbit about an attractor as strong as the inverse square, whose point is blunt by a tenth of its radius.
pub(super) fn orbit(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (strength, blunt) = (4.0f64, 1.0 + 0.1f64.powi(2));
    let speed = (strength / blunt.powf(1.5)).sqrt();
    let pull = Attractor { centre_m: Auto::Value([0.0; 3]), strength_m_s2: strength, radius_m: 1.0, falloff: 2.0 };
    let mut solver = under(gpu, &body(Vec3::X, Vec3::Y * speed as f32), 0.0, |force| force.attractor = Some(pull))?;
    let time_s = 0.5 * std::f64::consts::PI / speed;
    solver.advance(time_s, &Stop::default())?;
    let at = centre_m(&solver.states()?);
    let check = |name, formula, unit| Check::new(name, formula, "Newton 1687, book 1, prop. 4; Plummer 1911: s R^2 r / (r^2 + b^2)^(3/2)", unit);
    Ok(vec![
        check("attractor, radius of an orbit", "v^2 / r = the pull: unchanged after a quarter turn", "m").compare(1.0, at.length(), 0.02),
        check("attractor, angle of an orbit", "v t / r, a quarter turn", "radians").compare(std::f64::consts::FRAC_PI_2, at.y.atan2(at.x), 0.02),
    ])
}

/// What a blast gives at twice its radius.
pub(super) fn blast(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let blast = Explosion { centre_m: Auto::Value([0.0; 3]), speed_m_s: 8.0, radius_m: 0.5 };
    let mut solver = under(gpu, &body(Vec3::X, Vec3::ZERO), 0.0, |force| {
        force.explosion = Some(blast);
    })?;
    solver.advance(0.05, &Stop::default())?;
    let check =
        Check::new("explosion, speed at twice its radius", "v0 / (1 + (r / R)^2), impulse over mass", "Newton 1687, law 2: its integral", "m/s");
    Ok(vec![check.compare(8.0 / 5.0, velocity(&solver)?.x, 0.03)])
}

/// How fast a block turns that a motor has driven for its own time.
pub(super) fn motor(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (spin, rate) = (6.0, 5.0);
    let motor = Motor { centre_m: Auto::Value([0.0; 3]), axis: [0.0, 0.0, 1.0], speed_rad_s: spin, rate_per_s: rate };
    // Many cells wide: what turns within a particle is not driven, which adds 3 over the square of their number to the inertia.
    let block = block(Vec3::splat(-0.2), Vec3::splat(0.4), 0.025, 1e6, 0.3);
    let mut solver = under(gpu, &block, 0.0, |force| force.motor = Some(motor))?;
    solver.advance(1.0 / rate, &Stop::default())?;
    let (mut turning, mut inertia) = (0.0, 0.0);
    for s in solver.states()? {
        let arm = s.position_m.as_dvec3().with_z(0.0);
        turning += arm.cross(s.velocity_m_s.as_dvec3()).z;
        inertia += arm.length_squared();
    }
    let check = Check::new("motor, speed after its time", "w (1 - e^(-k t)), k t = 1", "Stokes 1851: drag by the difference in speed", "rad/s");
    Ok(vec![check.compare(spin * (1.0 - (-1.0f64).exp()), turning / inertia, 0.05)])
}

/// A block that a pin carries along its path and lets go.
pub(super) fn pin(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let mut particles = body(Vec3::ZERO, Vec3::ZERO);
    // Short substeps: what falls by them is ahead by g t h / 2.
    particles.young_pa.fill(1e6);
    let shape = ColliderShape::Box(BoxShape { centre_m: [0.0; 3], size_m: [0.3; 3] });
    let (way, path_s, held_s) = (DVec3::new(0.1, -0.2, 0.3), 0.5, 0.3);
    let path = vec![[0.0; 4], [path_s, way.x, way.y, way.z]];
    let held = PinRegion { object: 0, shape, low_m: Vec3::splat(-0.05), high_m: Vec3::splat(0.05), from_s: 0.0, to_s: held_s, path };
    let mut solver = Solver::new(gpu, Settings { pins: vec![held], ..Settings::new(CELL_M) }, &particles)?;
    solver.advance(held_s, &Stop::default())?;
    let carried = centre_m(&solver.states()?);
    let free_s = 0.2;
    solver.advance(held_s + free_s, &Stop::default())?;
    let thrown = centre_m(&solver.states()?) - carried;
    let flight = way / path_s * free_s - DVec3::Z * 0.5 * GRAVITY_M_S2 * free_s * free_s;
    let carry = Check::new("pin, carried along its path", "|w t - x|: 0", "a clamp, by definition", "m");
    let throw = Check::new("pin, thrown where it lets go", "|v t - g t^2 / 2 - x|: 0, to 2 % of the way", "Galilei 1638", "m");
    Ok(vec![
        carry.compare(0.0, (carried - way * (held_s / path_s)).length(), 1e-3),
        throw.compare(0.0, (thrown - flight).length(), 0.02 * flight.length()),
    ])
}

/// When what falls is foreseen to arrive, and when it does.
pub(super) fn impact(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let height_m = 0.3f32;
    let particles = block(Vec3::new(0.0, 0.0, height_m), Vec3::splat(0.1), 0.025, 2e5, 0.3);
    let ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    let mut solver = Solver::new(gpu, Settings { ground, ..Settings::new(CELL_M) }, &particles)?;
    let arrives_s = (2.0 * f64::from(height_m) / GRAVITY_M_S2).sqrt();
    let times: Vec<f32> = (0..400).map(|k| 1e-3 * k as f32).collect();
    let sight = solver.sight()?;
    let foreseen_s = sight.soonest(0, &times, 0.0, &vec![true; sight.things()]).map_or(f64::NAN, |k| f64::from(times[k]));
    // It falls freely until then.
    solver.advance(arrives_s - 0.005, &Stop::default())?;
    let before = -velocity(&solver)?.z / (GRAVITY_M_S2 * (arrives_s - 0.005));
    solver.advance(arrives_s + 0.01, &Stop::default())?;
    let after = -velocity(&solver)?.z / (GRAVITY_M_S2 * (arrives_s + 0.01));
    let fall = Check::new("impact, foreseen", "sqrt(2 h / g)", "Galilei 1638", "s");
    let free = Check::new("impact, none 5 ms before", "speed over g t", "Galilei 1638", "1");
    let met = Check::new("impact, under way 10 ms after", "speed over g t: below 0.9", "Newton 1687, law 2", "1");
    let braked = if after < 0.9 { 0.9 } else { after };
    Ok(vec![fall.compare(arrives_s, foreseen_s, 5e-3), free.compare(1.0, before, 1e-3), met.compare(0.9, braked, 1e-9)])
}

/// What stands on rough ground and is set in motion slows by mu g.
pub(super) fn friction(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let particles = block(Vec3::new(0.0, 0.0, -0.005), Vec3::new(0.3, 0.3, 0.1), 0.025, 2e5, 0.3);
    let ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    let mut solver = Solver::new(gpu, Settings { ground, ..Settings::new(CELL_M) }, &particles)?;
    let stop = Stop::default();
    solver.prestress(&[0], &stop, &mut |_| {})?;
    let placement = Placement { rotation: Quat::IDENTITY, centre_m: Vec3::ZERO, offset_m: Vec3::ZERO, velocity_m_s: Vec3::X, spin_rad_s: Vec3::ZERO };
    solver.place(0, &placement)?;
    let span_s = 0.2;
    solver.advance(span_s, &stop)?;
    let check = Check::new("friction, what slides slows", "mu g", "Coulomb 1785: friction mu N", "m/s^2");
    Ok(vec![check.compare(0.3 * GRAVITY_M_S2, (1.0 - velocity(&solver)?.x) / span_s, 0.05)])
}
