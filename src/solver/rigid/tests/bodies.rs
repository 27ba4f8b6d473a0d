//! Bodies on a device against formulas.

use super::{Body, CELL_M, G, Placement, advance, bodies_of, centre, floating, incline, moving, solver, velocity};
use crate::solver::validate::{ball, block, joined, keep, rigid_body as rigid};
use crate::solver::{Collider, Field, PinRegion, Settings};
use crate::spec::expression::{Kind, Program, parse};
use crate::spec::{BoxShape, ColliderShape};
use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

/// Orientation and angular velocity (body frame) of Euler's equations without torque, by small steps.
fn euler(inertia: DMat3, spin: DVec3, seconds: f64) -> DQuat {
    let momentum = inertia * spin;
    let rate = |q: DQuat| {
        let omega = q * (inertia.inverse() * (q.inverse() * momentum));
        DQuat::from_xyzw(omega.x, omega.y, omega.z, 0.0) * q * 0.5
    };
    let (mut q, steps) = (DQuat::IDENTITY, 20_000);
    let h = seconds / f64::from(steps);
    for _ in 0..steps {
        let a = rate(q);
        let b = rate(q + a * (h / 2.0));
        let c = rate(q + b * (h / 2.0));
        let d = rate(q + c * h);
        q = (q + (a + b * 2.0 + c * 2.0 + d) * (h / 6.0)).normalize();
    }
    q
}

#[test]
fn a_tumbling_box_follows_eulers_equations() {
    let size = Vec3::new(0.1, 0.2, 0.3);
    let particles = rigid(block(Vec3::new(1.0, 0.0, 0.0), size, 0.025, 1e5, 0.3), 0.3, 0.0);
    let mut solver = solver(floating(), &particles);
    let shape = solver.rigid.as_ref().expect("rigid").shapes_host[0];
    let expected = Vec3::new(size.y * size.y + size.z * size.z, size.x * size.x + size.z * size.z, size.x * size.x + size.y * size.y) * (6.0 / 12.0);
    let diagonal = Vec3::new(shape.inertia[0][0], shape.inertia[1][1], shape.inertia[2][2]);
    assert!(((diagonal / expected) - Vec3::ONE).abs().max_element() < 1e-4, "{diagonal} {expected}");
    // Nearly about the middle axis: it turns over.
    let omega = Vec3::new(0.2, 9.0, 0.1);
    solver.place(0, &moving(Vec3::X, omega, Vec3::new(1.05, 0.1, 0.15))).expect("a placement");
    let start = bodies_of(&solver)[0];
    advance(&mut solver, 1.5);
    let end = bodies_of(&solver)[0];
    let want = euler(shape.inertia().as_dmat3(), omega.as_dvec3(), 1.5);
    let got = Quat::from_array(end.turn).as_dquat();
    assert!(got.angle_between(want) < 5e-3, "{} rad apart", got.angle_between(want));
    assert_eq!(start.angular_momentum, end.angular_momentum);
    let travelled = centre(&end) - centre(&start);
    assert!((travelled - Vec3::X * 1.5).length() < 1e-5, "{travelled}");
    // Its particles are where it is, unstretched.
    for (s, p) in solver.states().expect("states").iter().zip(&particles.position_m) {
        let place = Quat::from_array(end.turn) * (*p - centre(&start)) + centre(&end);
        assert!((s.position_m - place).length() < 1e-5 && (s.f().determinant() - 1.0).abs() < 1e-5);
    }
}

#[test]
fn a_body_flies_on_wherever_it_is() {
    // Half a metre in a run past 2048 m, and creeping where f32 no longer sees the steps.
    let particles = rigid(block(Vec3::ZERO, Vec3::splat(0.1), 0.025, 1e5, 0.3), 0.3, 0.0);
    for (from_m, velocity_m_s) in [(Vec3::new(2047.9, -2048.1, 3000.0), Vec3::new(2.0, -2.0, 1.0)), (Vec3::new(3000.0, 0.0, -9e4), Vec3::splat(1e-3))]
    {
        let mut solver = solver(floating(), &particles);
        let placement = Placement { offset_m: from_m, ..moving(velocity_m_s, Vec3::ZERO, Vec3::splat(0.05)) };
        solver.place(0, &placement).expect("a placement");
        let place = |body: &Body| {
            let part = |k: usize| f64::from(body.metre[k]) + f64::from(body.whole[k]) / 1_048_576.0 + f64::from(body.low_m[k]);
            DVec3::new(part(0), part(1), part(2))
        };
        let start = bodies_of(&solver)[0];
        assert!((centre(&start) - from_m - 0.05).length() < 0.01, "{start:?}");
        advance(&mut solver, 0.25);
        let end = bodies_of(&solver)[0];
        let travelled = place(&end) - place(&start);
        assert!((travelled - 0.25 * velocity_m_s.as_dvec3()).length() < 1e-5 * f64::from(velocity_m_s.length()), "{travelled}");
        assert!((centre(&end).as_dvec3() - place(&end)).length() < 0.01, "{end:?}");
    }
}

#[test]
fn a_ball_rests_in_a_bowl() {
    let spacing = 0.02;
    let full = block(Vec3::new(-0.16, -0.16, 0.0), Vec3::new(0.32, 0.32, 0.16), spacing, 1e5, 0.3);
    let hollow = Vec3::new(0.0, 0.0, 0.2);
    let bowl = keep(&full, |p| p.distance(hollow) > 0.14);
    let stone = rigid(ball(Vec3::new(0.002, 0.0, 0.13), 0.05, 0.0125), 0.5, 0.0);
    let mut solver = solver(incline(0.0, 0.5), &joined(rigid(bowl, 0.5, 0.0), stone));
    advance(&mut solver, 1.0);
    let (bowl, stone) = (bodies_of(&solver)[0], bodies_of(&solver)[1]);
    assert!(velocity(&stone).length() < 0.1, "{:?}", velocity(&stone));
    let bottom = 0.2 - 0.14 + 0.05;
    assert!(centre(&stone).truncate().length() < 0.06 && (centre(&stone).z - bottom).abs() < 0.02, "{} {}", centre(&stone), centre(&bowl));
}

#[test]
fn what_starts_in_the_ground_is_driven_no_deeper() {
    // A grain of a millimetre under a hundred times its weight: a spring that is as soft as it may be for large bodies, and
    // pushes no faster than it may, would let it through.
    let scale = 1e-3;
    let size = scale * Vec3::new(0.2, 0.2, 0.3);
    let particles = rigid(block(Vec3::new(0.0, 0.0, -0.1 * scale), size, 0.025 * scale, 1e5, 0.3), 0.3, 0.0);
    let settings = Settings { gravity_m_s2: Vec3::new(0.0, 0.0, -1000.0), cell_m: CELL_M * scale, ..incline(0.0, 0.3) };
    let mut solver = solver(settings, &particles);
    let start_m = centre(&bodies_of(&solver)[0]).z;
    for frame in 1..=5 {
        advance(&mut solver, 0.002 * f64::from(frame));
        let z_m = centre(&bodies_of(&solver)[0]).z;
        assert!(z_m > start_m - 0.01 * scale, "sank by {} m", start_m - z_m);
    }
    assert!(velocity(&bodies_of(&solver)[0]).length() < 0.01);
}

#[test]
fn a_fast_body_does_not_pass_a_thin_wall() {
    let particles = rigid(block(Vec3::new(0.0, 0.0, 0.0), Vec3::splat(0.1), 0.025, 1e5, 0.3), 0.3, 0.0);
    let wall = BoxShape { centre_m: [0.6, 0.0, 0.0], size_m: [0.02, 2.0, 2.0] };
    let colliders = vec![Collider { shape: ColliderShape::Box(wall), friction: 0.3, restitution: 0.0 }];
    let mut solver = solver(Settings { colliders, ..floating() }, &particles);
    solver.set_velocity(0, Vec3::X * 200.0);
    assert_eq!(velocity(&bodies_of(&solver)[0]), Vec3::X * 200.0);
    advance(&mut solver, 0.02);
    let body = bodies_of(&solver)[0];
    // It has crossed the room up to the wall.
    assert!(centre(&body).x > 0.4 && centre(&body).x < 0.6 && velocity(&body).x < 1.0, "{} {}", centre(&body), velocity(&body));
}

#[test]
fn runs_repeat_and_resume_to_the_bit_and_pins_hold() {
    let pair = joined(
        rigid(block(Vec3::new(0.0, 0.0, 0.03), Vec3::splat(0.1), 0.025, 1e5, 0.3), 0.4, 0.2),
        rigid(ball(Vec3::new(0.05, 0.03, 0.25), 0.05, 0.0125), 0.4, 0.5),
    );
    let mut first = solver(incline(0.1, 0.4), &pair);
    first.place(1, &moving(Vec3::new(0.0, 0.2, -1.0), Vec3::new(3.0, 0.0, 1.0), Vec3::new(0.05, 0.03, 0.25))).expect("a placement");
    let start = first.checkpoint().expect("a checkpoint");
    advance(&mut first, 0.06);
    let kept = first.checkpoint().expect("a checkpoint");
    let before = velocity(&bodies_of(&first)[0]);
    first.kick(0, Vec3::Y);
    assert!((velocity(&bodies_of(&first)[0]) - before - Vec3::Y).length() < 1e-6);
    advance(&mut first, 0.12);
    let end = first.checkpoint().expect("a checkpoint");
    let mut second = solver(incline(0.1, 0.4), &pair);
    second.restore(&start).expect("a restore");
    for frame in 1..=3 {
        advance(&mut second, f64::from(frame) * 0.02);
    }
    assert!(kept == second.checkpoint().expect("a checkpoint"));
    let mut third = solver(incline(0.1, 0.4), &pair);
    third.restore(&kept).expect("a restore");
    third.kick(0, Vec3::Y);
    advance(&mut third, 0.12);
    assert!(end == third.checkpoint().expect("a checkpoint"), "a resumed run differs");

    let pin = BoxShape { centre_m: [0.05, 0.05, 0.12], size_m: [0.2, 0.2, 0.02] };
    let pins = vec![PinRegion {
        object: 0,
        shape: ColliderShape::Box(pin),
        low_m: Vec3::ZERO,
        high_m: Vec3::splat(0.2),
        from_s: 0.0,
        to_s: 0.1,
        path: Vec::new(),
    }];
    let mut held = solver(Settings { pins, ..Settings::new(CELL_M) }, &rigid(block(Vec3::splat(0.02), Vec3::splat(0.1), 0.025, 1e5, 0.3), 0.3, 0.0));
    advance(&mut held, 0.1);
    assert!((centre(&bodies_of(&held)[0]) - Vec3::splat(0.07)).length() < 1e-6);
    advance(&mut held, 0.2);
    let fallen = 0.07 - centre(&bodies_of(&held)[0]).z;
    assert!((fallen - 0.5 * G * 0.01).abs() < 1e-3, "{fallen}");
}

#[test]
fn a_ring_stays_on_its_peg() {
    let whole = block(Vec3::new(-0.1, -0.1, 0.002), Vec3::new(0.2, 0.2, 0.05), 0.0125, 1e5, 0.3);
    let mut ring = keep(&whole, |p| p.truncate().abs().max_element() > 0.05);
    ring.velocity_m_s.fill(Vec3::X);
    let peg = BoxShape { centre_m: [0.0, 0.0, 0.1], size_m: [0.06, 0.06, 0.2] };
    let colliders = vec![Collider { shape: ColliderShape::Box(peg), friction: 0.1, restitution: 0.0 }];
    let mut solver = solver(Settings { colliders, ..incline(0.0, 0.1) }, &rigid(ring, 0.1, 0.0));
    advance(&mut solver, 0.3);
    let body = bodies_of(&solver)[0];
    // The hole leaves it two centimetres each way.
    assert!((0.012..0.028).contains(&centre(&body).x) && centre(&body).z < 0.04, "{}", centre(&body));
}

#[test]
fn a_field_pushes_and_turns_a_body() {
    let tree = parse("vec3(2.0 - 3.0 * x0.y, 3.0 * x0.x, 0)", Kind::Vector).expect("an expression");
    let acceleration = Program::of(&tree).expect("a program");
    let fields = vec![Field { name: "push".to_owned(), object: 0, from_s: 0.0, to_s: f64::INFINITY, acceleration }];
    let particles = rigid(block(Vec3::splat(-0.1), Vec3::splat(0.2), 0.025, 1e5, 0.3), 0.3, 0.0);
    let mut solver = solver(Settings { fields, ..floating() }, &particles);
    advance(&mut solver, 0.1);
    let body = solver.motions().expect("motions")[0];
    // The particles' velocities are a substep ahead of what their body has taken in.
    assert!((body.velocity_m_s - Vec3::X * 0.2).length() < 0.003, "{}", body.velocity_m_s);
    assert!((body.spin_rad_s - Vec3::Z * 0.3).length() < 0.015, "{}", body.spin_rad_s);
    assert!((solver.states().expect("states")[0].velocity_m_s - body.velocity_m_s).length() < 0.1);
}
