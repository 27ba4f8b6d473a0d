//! Rigid bodies on a device: against formulas, against their twin, and among soft matter.

mod bodies;
mod change;
mod crowds;
mod soft;
mod twins;

use super::body::{Body, Contact, Manifold, Shape};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::tests::size_in_shader;
use crate::solver::{Particles, Placement, Plane, Settings, Solver};
use glam::{Quat, Vec3};

const CELL_M: f32 = 0.05;
const G: f32 = 9.81;

fn solver(settings: Settings, particles: &Particles) -> Solver {
    Solver::new(&Gpu::shared_for_tests().expect("a device"), settings, particles).expect("a solver")
}

fn bodies_of(solver: &Solver) -> Vec<Body> {
    solver.rigid.as_ref().expect("rigid bodies").bodies(&solver.gpu).expect("bodies")
}

fn velocity(body: &Body) -> Vec3 {
    Vec3::from_slice(&body.velocity_m_s)
}

fn centre(body: &Body) -> Vec3 {
    Vec3::from_slice(&body.centre_m)
}

fn floating() -> Settings {
    Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }
}

/// A ground under gravity that is tilted by an angle about y, so that things slide along x.
fn incline(angle_rad: f32, friction: f32) -> Settings {
    let ground = Some(Plane { height_m: 0.0, friction, restitution: 0.0 });
    Settings { ground, gravity_m_s2: G * Vec3::new(angle_rad.sin(), 0.0, -angle_rad.cos()), ..Settings::new(CELL_M) }
}

#[test]
fn bodies_have_the_layout_of_the_shaders() {
    let size = |name: &str| size_in_shader("solver.rigid_solve", name);
    assert_eq!(size("Body"), size_of::<Body>());
    assert_eq!(size("Shape"), size_of::<Shape>());
    assert_eq!(size("Manifold"), size_of::<Manifold>());
    assert_eq!(size("Contact"), size_of::<Contact>());
}

fn moving(velocity_m_s: Vec3, spin_rad_s: Vec3, centre_m: Vec3) -> Placement {
    Placement { rotation: Quat::IDENTITY, centre_m, offset_m: Vec3::ZERO, velocity_m_s, spin_rad_s }
}

fn advance(solver: &mut Solver, to_s: f64) {
    solver.advance(to_s, &Stop::default()).expect("an advance");
}
