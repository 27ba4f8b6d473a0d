//! The forces of a spec, each as the solver moves it, against formulas.

use super::fields::{driven_by, go, mean_velocity, small};
use super::{centre_m, solver};
use crate::solver::{Field, Settings, Solver};
use crate::spec::{FieldFacts, Force, Until};
use glam::{DVec3, Vec3};

/// A force written as in a spec.
fn force(text: &str) -> Force {
    let spec = format!("format = 1\nscene.file = \"vase.splat\"\n[[object]]\n[[force]]\nname = \"f\"\nobject = \"vase\"\n{text}\n");
    crate::spec::Spec::from_toml(&spec).unwrap_or_else(|fault| panic!("{text}: {fault}")).forces.remove(0)
}

/// Nothing around but forces on a body whose centre is at the origin.
fn under(texts: &[&str]) -> Settings {
    let fields = texts.iter().map(|text| {
        let force = force(text);
        let acceleration = force.program(&FieldFacts::default()).expect("a program").expect("a field");
        Field { name: force.name.clone(), object: 0, from_s: force.from_s, to_s: force.ends_s(), acceleration }
    });
    Settings { fields: fields.collect(), ..driven_by(&[]) }
}

fn run(settings: Settings, velocity: Vec3, to_s: f64) -> Solver {
    let mut solver = solver(settings, &small(velocity));
    go(&mut solver, to_s);
    solver
}

#[test]
fn wind_carries_along_and_gusts_stay_about_it() {
    let still = run(under(&["wind = { velocity_m_s = [5, 0, 0], drag_per_s = 2 }"]), Vec3::ZERO, 0.5);
    let expected = 5.0 * (1.0 - (-1.0f64).exp());
    assert!((mean_velocity(&still).x / expected - 1.0).abs() < 0.01, "{}", mean_velocity(&still));
    let gusty = run(under(&["wind = { velocity_m_s = [5, 0, 0], drag_per_s = 2, gust = 0.3, turbulence = 0.3 }"]), Vec3::ZERO, 0.5);
    let v = mean_velocity(&gusty);
    assert!((v.x / expected - 1.0).abs() < 0.3 && v.x != mean_velocity(&still).x && v.y.abs() + v.z.abs() > 1e-3, "{v}");
}

#[test]
fn drag_of_both_kinds_follows_its_formula() {
    // |v|(t) = k v0 e^(-k t) / (k + c v0 (1 - e^(-k t))).
    let solver = run(under(&["drag = { linear_per_s = 3, quadratic_per_m = 2 }"]), Vec3::new(0.0, 4.0, 0.0), 0.3);
    let left = (-0.9f64).exp();
    let expected = 3.0 * 4.0 * left / (3.0 + 2.0 * 4.0 * (1.0 - left));
    assert!((mean_velocity(&solver).y / expected - 1.0).abs() < 0.01, "{}", mean_velocity(&solver));
}

#[test]
fn an_attractor_pulls_with_its_falloff() {
    for (falloff, share) in [(0.0, 1.0), (2.0, 0.25)] {
        let mut particles = small(Vec3::ZERO);
        particles.position_m.iter_mut().for_each(|x| x.z += 2.0);
        let text = format!("attractor = {{ centre_m = [0, 0, 0], strength_m_s2 = 4, falloff = {falloff} }}");
        let mut solver = solver(under(&[&text]), &particles);
        go(&mut solver, 0.1);
        let v = mean_velocity(&solver).z;
        assert!((v / (-0.4 * share) - 1.0).abs() < 0.02, "{falloff}: {v}");
    }
}

#[test]
fn an_explosion_gives_its_speed_away_from_its_centre() {
    let mut particles = small(Vec3::ZERO);
    particles.position_m.iter_mut().for_each(|x| x.y += 1.0);
    let mut solver = solver(under(&["from_s = 0.03\nexplosion = { centre_m = [0, 0, 0], speed_m_s = 8, radius_m = 1 }"]), &particles);
    go(&mut solver, 0.03);
    assert!(mean_velocity(&solver).length() < 1e-6, "nothing before");
    go(&mut solver, 0.06);
    let v = mean_velocity(&solver);
    assert!((v.y / 4.0 - 1.0).abs() < 0.03 && v.x.abs() + v.z.abs() < 1e-2, "half of its speed at its radius: {v}");
}

#[test]
fn a_spring_brings_the_body_to_its_place_and_along_a_path() {
    let solver = run(under(&["spring = { to_m = [0.3, 0, 0.1], stiffness_per_s2 = 200, damping_per_s = 28 }"]), Vec3::ZERO, 0.8);
    assert!((centre_m(&solver) - Vec3::new(0.3, 0.0, 0.1)).length() < 3e-3, "{}", centre_m(&solver));
    let path = "spring = { path_m = [[0, 0, 0, 0], [0.5, 0.5, 0, 0], [1, 0.5, 0.5, 0]], stiffness_per_s2 = 2000, damping_per_s = 90 }";
    let mut solver = run(under(&[path]), Vec3::ZERO, 0.4);
    assert!((centre_m(&solver) - Vec3::new(0.4, 0.0, 0.0)).length() < 0.02, "{}", centre_m(&solver));
    go(&mut solver, 1.2);
    assert!((centre_m(&solver) - Vec3::new(0.5, 0.5, 0.0)).length() < 0.01, "{}", centre_m(&solver));
}

#[test]
fn a_motor_turns_the_body_and_leaves_its_fall_alone() {
    let settings = Settings { gravity_m_s2: Vec3::new(0.0, 0.0, -9.81), ..under(&["motor = { speed_rad_s = 6, rate_per_s = 20 }"]) };
    let mut particles = small(Vec3::ZERO);
    particles.young_pa.fill(1e6);
    let mut solver = solver(settings, &particles);
    go(&mut solver, 0.4);
    let states = solver.states().expect("states");
    let centre = centre_m(&solver);
    let (mut turning, mut inertia) = (0.0, 0.0);
    for s in &states {
        let arm = s.position_m - centre;
        turning += arm.cross(s.velocity_m_s).z;
        inertia += arm.x * arm.x + arm.y * arm.y;
    }
    assert!((turning / inertia / 6.0 - 1.0).abs() < 0.05, "{} rad/s", turning / inertia);
    assert!((mean_velocity(&solver) - DVec3::new(0.0, 0.0, -9.81 * 0.4)).length() < 0.05, "{}", mean_velocity(&solver));
}

#[test]
fn every_form_of_every_force_has_a_program() {
    let texts = [
        "wind = { velocity_m_s = [0, 0, 0] }",
        "wind = { velocity_m_s = [1, 2, 3], gust = 1 }",
        "drag = { quadratic_per_m = 1 }",
        "vortex = { speed_m_s = -3, lift_m_s = 2 }",
        "attractor = { strength_m_s2 = -4, falloff = -1 }",
        "explosion = { speed_m_s = 8 }",
        "motor = { speed_rad_s = -6 }",
        "acceleration_m_s2 = \"-v\"",
    ];
    for text in texts {
        let program = force(text).program(&FieldFacts::default()).expect(text).expect(text);
        assert!(program.evaluate(&Default::default()).iter().all(|r| r.value.is_finite()), "{text}");
    }
    // The longest path that a spec may hold.
    let points: Vec<String> = (0..crate::spec::limits::PATH).map(|i| format!("[{i}, {}, 0, 0]", i % 2)).collect();
    let long = force(&format!("spring = {{ path_m = [{}] }}", points.join(", ")));
    let program = long.program(&FieldFacts::default()).expect("a program").expect("a field");
    let at = |time_s: f64| program.evaluate(&crate::spec::expression::Inputs { time_s, ..Default::default() })[0].value;
    assert!((at(2.5) - (40.0 * 0.5 + 4.0)).abs() < 1e-9 && (at(100.0) - 40.0).abs() < 1e-9);
    assert_eq!(force("to_s = 2\nexplosion = { speed_m_s = 8 }").ends_s(), 0.01);
    assert_eq!(force("drag = { linear_per_s = 1 }").to_s, Until::End);
}
