//! Rigid bodies: V9, V10, V12, and among soft matter V24, V25.

use super::Check;
use super::bodies::{angular_momentum, ball, block, joined, rigid};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::rigid::Motion;
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use crate::solver::types::{Particles, PinRegion, Plane, Settings, SolverError};
use crate::spec::{ColliderShape, PlaneShape};
use glam::{DVec3, Vec3};

const GRAVITY_M_S2: f32 = 9.81;
const CELL_M: f32 = 0.05;
const RADIUS_M: f32 = 0.1;
const SPACING_M: f32 = 0.0125;
/// Where the coefficient of restitution comes from.
const IMPACT: &str = "Newton 1687, scholium to the laws: impact";
const CONSERVED: &str = "Newton 1687, corollary 3 to the laws";

/// Level ground under a slanted gravity, so that things slide along x.
fn slope(angle_rad: f32, friction: f32) -> Settings {
    let gravity_m_s2 = GRAVITY_M_S2 * Vec3::new(angle_rad.sin(), 0.0, -angle_rad.cos());
    Settings { ground: Some(Plane { height_m: 0.0, friction, restitution: 0.0 }), gravity_m_s2, ..Settings::new(CELL_M) }
}

fn floating() -> Settings {
    Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }
}

fn advance(solver: &mut Solver, to_s: f64) -> Result<Vec<Motion>, SolverError> {
    solver.advance(to_s, &Stop::default())?;
    solver.motions()
}

/// V9: each bounce reaches e^2 of the height before.
pub(super) fn bounce(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (e, height_m) = (0.8f32, 0.5f32);
    let particles = rigid(ball(Vec3::new(0.0, 0.0, RADIUS_M + height_m), RADIUS_M, SPACING_M), 0.3, e);
    let mut solver = Solver::new(gpu, slope(0.0, 0.3), &particles)?;
    let (mut tops_m, mut top_m, mut rising) = (Vec::new(), 0.0, false);
    for frame in 1..=76 {
        let ball = &advance(&mut solver, f64::from(frame) * 0.02)?[0];
        if rising && ball.velocity_m_s.z <= 0.0 {
            tops_m.push(top_m);
        }
        rising = ball.velocity_m_s.z > 0.0;
        // Where this arc ends, from height and speed.
        top_m = f64::from(ball.centre_m.z - RADIUS_M + 0.5 * ball.velocity_m_s.z.powi(2) / GRAVITY_M_S2);
    }
    let names = ["V9 first bounce", "V9 second bounce", "V9 third bounce"];
    let bounces = names.into_iter().zip(tops_m.into_iter().chain(std::iter::repeat(f64::NAN))).enumerate();
    let mut checks: Vec<Check> = bounces
        .map(|(n, (name, top_m))| {
            let expected = f64::from(height_m) * f64::from(e).powi(2 * n as i32 + 2);
            Check::new(name, "e^(2n) h0", IMPACT, "m").compare(expected, top_m, 0.02)
        })
        .collect();
    checks.push(stop_time(gpu)?);
    Ok(checks)
}

/// Until when a ball bounces that is let go at a height: it has bounced its last once a hundredth of a millimetre is
/// all that it can rise: half a per cent of the time before it comes to rest.
fn stop_time(gpu: &Gpu) -> Result<Check, SolverError> {
    let (e, height_m) = (0.5f32, 0.4f32);
    let particles = rigid(ball(Vec3::new(0.0, 0.0, RADIUS_M + height_m), RADIUS_M, SPACING_M), 0.3, e);
    let mut solver = Solver::new(gpu, slope(0.0, 0.3), &particles)?;
    let expected = f64::from((1.0 + e) / (1.0 - e) * (2.0 * height_m / GRAVITY_M_S2).sqrt());
    let mut rises = Vec::new();
    for k in 1..=300 {
        let time_s = 1.5 * expected * f64::from(k) / 300.0;
        let ball = &advance(&mut solver, time_s)?[0];
        rises.push((time_s, ball.centre_m.z + 0.5 * ball.velocity_m_s.z.powi(2) / GRAVITY_M_S2));
    }
    let rest_m = rises.last().map_or(f32::NAN, |r| r.1);
    let stopped = rises.iter().rfind(|(_, rise)| rise - rest_m >= 1e-5).map_or(f64::NAN, |r| r.0);
    Ok(Check::new("V9 the ball stops", "(1 + e) / (1 - e) sqrt(2 h0 / g)", IMPACT, "s").compare(expected, stopped, 0.02))
}

/// V10: a block slides by g (sin - mu cos) or stays; a ball rolls by 5/7 g sin.
pub(super) fn incline(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let brick = |friction| rigid(block(Vec3::ZERO, Vec3::new(0.2, 0.2, 0.1), SPACING_M, 1e5, 0.3), friction, 0.0);
    let gain = |particles: &Particles, angle: f32, friction: f32| -> Result<(f64, f32), SolverError> {
        let mut solver = Solver::new(gpu, slope(angle, friction), particles)?;
        let early = advance(&mut solver, 0.2)?[0].velocity_m_s.x;
        let late = advance(&mut solver, 0.5)?[0].velocity_m_s;
        Ok((f64::from(late.x - early) / 0.3, late.length()))
    };
    let (steep, sliding) = (30f32.to_radians(), 0.3);
    let slides = gain(&brick(sliding), steep, sliding)?.0;
    let threshold = 0.4f32.atan();
    let (_, creep) = gain(&brick(0.4), threshold - 1f32.to_radians(), 0.4)?;
    let past = threshold + 1f32.to_radians();
    let (starts, _) = gain(&brick(0.4), past, 0.4)?;
    let rolls = gain(&rigid(ball(Vec3::Z * RADIUS_M, RADIUS_M, SPACING_M), 0.5, 0.0), 20f32.to_radians(), 0.5)?.0;
    // Friction of two surfaces is the root of the product of theirs.
    let mixed = {
        let mut solver = Solver::new(gpu, slope(steep, 0.45), &brick(0.2))?;
        let early = advance(&mut solver, 0.2)?[0].velocity_m_s.x;
        f64::from(advance(&mut solver, 0.5)?[0].velocity_m_s.x - early) / 0.3
    };
    let (slips, spins) = slipping_ball(gpu)?;
    let expected = |angle: f32, friction: f32| f64::from(GRAVITY_M_S2 * (angle.sin() - friction * angle.cos()));
    let check = |name, formula, unit| Check::new(name, formula, "Coulomb 1785: friction mu N", unit);
    Ok(vec![
        check("V10 block slides", "g (sin a - mu cos a)", "m/s^2").compare(expected(steep, sliding), slides, 0.02),
        check("V10 block stays a degree below", "0", "m/s").compare(0.0, f64::from(creep), 1e-3),
        check("V10 block starts a degree above", "g (sin a - mu cos a)", "m/s^2").compare(expected(past, 0.4), starts, 0.02),
        check("V10 block of mu = 0.2 on a slope of 0.45", "g (sin a - sqrt(mu1 mu2) cos a)", "m/s^2").compare(expected(steep, sliding), mixed, 0.02),
        check("V10 ball rolls", "5/7 g sin a", "m/s^2").compare(5.0 / 7.0 * expected(20f32.to_radians(), 0.0), rolls, 0.02),
        check("V10 ball slips where mu < 2/7 tan a", "g (sin a - mu cos a)", "m/s^2").compare(expected(SLIPPERY.0, SLIPPERY.1), slips, 0.02),
        check("V10 slipping ball turns ever faster", "5/2 mu g cos a / R", "1/s^2").compare(
            f64::from(2.5 * SLIPPERY.1 * GRAVITY_M_S2 * SLIPPERY.0.cos() / RADIUS_M),
            spins,
            0.02,
        ),
    ])
}

/// Angle and friction of a slope on which a ball slips: mu = 2/7 tan a would be 0.2.
const SLIPPERY: (f32, f32) = (0.61, 0.1);

/// How fast a slipping ball gains speed, and spin.
fn slipping_ball(gpu: &Gpu) -> Result<(f64, f64), SolverError> {
    let particles = rigid(ball(Vec3::Z * RADIUS_M, RADIUS_M, SPACING_M), SLIPPERY.1, 0.0);
    let mut solver = Solver::new(gpu, slope(SLIPPERY.0, SLIPPERY.1), &particles)?;
    let early = advance(&mut solver, 0.1)?[0];
    let late = advance(&mut solver, 0.4)?[0];
    Ok((f64::from(late.velocity_m_s.x - early.velocity_m_s.x) / 0.3, f64::from(late.spin_rad_s.y - early.spin_rad_s.y) / 0.3))
}

/// Speeds of a row of four balls once the first has run into it, before any meets another a second time: each
/// hands (1 + e) / 2 of its own on and keeps the rest.
fn handed_on(e: f64) -> [f64; 4] {
    let (on, kept) = ((1.0 + e) / 2.0, (1.0 - e) / 2.0);
    [kept, on * kept, on * on * kept, on.powi(3)]
}

/// V12: Newton's cradle without its strings.
pub(super) fn cradle(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    const BALLS: [(f32, [&str; 4], &str); 2] = [
        (1.0, ["V12 first ball, e = 1", "V12 second ball, e = 1", "V12 third ball, e = 1", "V12 last ball, e = 1"], "V12 momentum, e = 1"),
        (0.5, ["V12 first ball, e = 0.5", "V12 second ball, e = 0.5", "V12 third ball, e = 0.5", "V12 last ball, e = 0.5"], "V12 momentum, e = 0.5"),
    ];
    const FORMULAS: [&str; 4] = ["(1 - e) / 2 v", "(1 + e) / 2 (1 - e) / 2 v", "((1 + e) / 2)^2 (1 - e) / 2 v", "((1 + e) / 2)^3 v"];
    let mut checks = Vec::new();
    let radius_m = 0.05;
    for (e, names, whole) in BALLS {
        let one = |i: i32| rigid(ball(Vec3::X * (i as f32 * (2.0 * radius_m + 2e-3)), radius_m, SPACING_M), 0.0, e);
        let mut particles = one(0);
        particles.velocity_m_s.fill(Vec3::X);
        for i in 1..4 {
            particles = joined(particles, one(i));
        }
        let mut solver = Solver::new(gpu, floating(), &particles)?;
        let momentum = |balls: &[Motion]| balls.iter().map(|b| b.velocity_m_s.as_dvec3() * f64::from(b.mass_kg)).sum::<DVec3>();
        let before = momentum(&solver.motions()?);
        let balls = advance(&mut solver, 0.02)?;
        for (k, expected) in handed_on(e.into()).into_iter().enumerate() {
            let check = Check::new(names[k], FORMULAS[k], IMPACT, "m/s");
            checks.push(check.compare(expected, f64::from(balls[k].velocity_m_s.x), 1e-4));
        }
        let lost = (momentum(&balls) - before).length() / before.length();
        checks.push(Check::new(whole, "share lost: 0", CONSERVED, "1").compare(0.0, lost, 1e-4));
    }
    Ok(checks)
}

/// Ten boxes on each other stand for two seconds.
pub(super) fn stack(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let one = |i: i32| rigid(block(Vec3::new(-0.05, -0.05, 0.002 + 0.104 * i as f32), Vec3::splat(0.1), SPACING_M, 1e5, 0.3), 0.5, 0.0);
    let particles = (1..10).fold(one(0), |below, i| joined(below, one(i)));
    let mut solver = Solver::new(gpu, slope(0.0, 0.5), &particles)?;
    let early = advance(&mut solver, 0.5)?;
    let late = advance(&mut solver, 2.0)?;
    let crept = early.iter().zip(&late).map(|(a, b)| (b.centre_m - a.centre_m).length()).fold(0.0, f32::max);
    let aside = late.iter().map(|b| b.centre_m.truncate().length()).fold(0.0, f32::max);
    let apart: Vec<f32> = late.windows(2).map(|pair| pair[1].centre_m.z - pair[0].centre_m.z).collect();
    let pressed = apart.iter().copied().fold(0.0, f32::max) - apart.iter().copied().fold(1.0, f32::min);
    let check = |name, formula| Check::new(name, formula, "Newton 1687, law 1: forces balance", "m");
    Ok(vec![
        check("stack of ten creeps, 0.5 s to 2 s", "0").compare(0.0, f64::from(crept), 1e-3),
        check("stack of ten leans", "0").compare(0.0, f64::from(aside), 2e-3),
        check("stack of ten presses its lowest boxes together more than its top ones", "0").compare(0.0, f64::from(pressed), 2e-3),
    ])
}

/// Momentum, and angular momentum about the origin, of all that is soft and of all bodies.
pub(in crate::solver) fn momenta(solver: &Solver) -> Result<(DVec3, DVec3), SolverError> {
    let soft: Vec<ParticleState> = solver.states()?.into_iter().filter(|s| !s.is_rigid()).collect();
    let mut linear: DVec3 = soft.iter().map(|s| s.velocity_m_s.as_dvec3() * f64::from(s.mass_kg)).sum();
    let mut angular = angular_momentum(&soft, DVec3::ZERO, solver.settings.cell_m);
    for body in solver.motions()? {
        let p = body.velocity_m_s.as_dvec3() * f64::from(body.mass_kg);
        linear += p;
        angular += body.centre_m.as_dvec3().cross(p) + body.angular_momentum.as_dvec3();
    }
    Ok((linear, angular))
}

/// V24: a ball thrown into jelly in free space; whatever either loses the other gains.
pub(super) fn into_jelly(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let jelly = block(Vec3::new(-0.15, -0.15, -0.2), Vec3::new(0.3, 0.3, 0.2), 0.025, 3e4, 0.3);
    let soft = jelly.len();
    let mut particles = joined(jelly, rigid(ball(Vec3::new(0.04, 0.0, 0.09), 0.075, 0.025), 0.4, 0.0));
    particles.velocity_m_s[soft..].fill(Vec3::new(0.3, 0.0, -2.0));
    let mut solver = Solver::new(gpu, floating(), &particles)?;
    let before = momenta(&solver)?;
    let ball = &advance(&mut solver, 0.08)?[0];
    let after = momenta(&solver)?;
    let lost = (after.0 - before.0).length() / before.0.length();
    // The scale of angular momentum: all momentum, at the radius of the ball.
    let turned = (after.1 - before.1).length() / (before.0.length() * 0.075);
    let check = |name, formula| Check::new(name, formula, CONSERVED, "1");
    Ok(vec![
        check("V24 momentum into jelly", "share lost: 0").compare(0.0, lost, 1e-3),
        check("V24 angular momentum into jelly", "share of p r lost: 0").compare(0.0, turned, 1e-2),
        check("V24 the jelly takes its part", "half of the speed or more is given").compare(
            1.0,
            f64::from(u8::from(ball.velocity_m_s.z > -1.0)),
            0.0,
        ),
    ])
}

/// The same particles, those below a height a rigid part of their object.
fn rigid_below(particles: Particles, height_m: f32) -> Particles {
    let substance = particles.position_m.iter().map(|p| u16::from(p.z < height_m)).collect();
    Particles { substance, substances: vec![Substance::default(), Substance::Rigid { friction: 0.3, restitution: 0.0 }], ..particles }
}

/// V25: a rigid weight on a soft rod swings; the joint stays shut.
pub(super) fn joint(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (size_m, spacing_m) = (Vec3::new(0.1, 0.1, 0.5), 0.025);
    let mut particles = rigid_below(block(Vec3::ZERO, size_m, spacing_m, 1e6, 0.3), 0.15);
    for (v, p) in particles.velocity_m_s.iter_mut().zip(&particles.position_m) {
        *v = Vec3::X * (0.45 - p.z).max(0.0);
    }
    let top = PlaneShape { point_m: [0.0, 0.0, 0.45], normal: [0.0, 0.0, -1.0] };
    let pins =
        vec![PinRegion { object: 0, shape: ColliderShape::Plane(top), low_m: Vec3::ZERO, high_m: size_m, from_s: 0.0, to_s: 10.0, path: Vec::new() }];
    let mut solver = Solver::new(gpu, Settings { pins, ..Settings::new(CELL_M) }, &particles)?;
    let start = solver.motions()?.swap_remove(0);
    let joint: Vec<usize> = (0..particles.len()).filter(|&i| (particles.position_m[i].z - 0.1625).abs() < 0.01).collect();
    let mut widest_m = 0f32;
    for frame in 1..=250 {
        let body = advance(&mut solver, f64::from(frame) * 0.02)?.swap_remove(0);
        let states = solver.states()?;
        for &i in &joint {
            let held = body.turn * (particles.position_m[i] - start.centre_m) + body.centre_m;
            widest_m = widest_m.max(held.distance(states[i].position_m));
        }
    }
    let gap = Check::new("V25 joint of a rigid weight and a soft rod", "gap: 0", "one body: its parts share their velocity at the joint", "cells");
    Ok(vec![gap.compare(0.0, f64::from(widest_m / CELL_M), 0.02)])
}
