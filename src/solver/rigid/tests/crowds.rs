//! Many contacts at one time, and sharp ones.

use super::{Settings, advance, bodies_of, centre, floating, incline, solver, velocity};
use crate::gpu::Recording;
use crate::solver::advance::Substep;
use crate::solver::constants::RIGID_SLOTS;
use crate::solver::rigid::body::{self, Contact, Manifold};
use crate::solver::validate::{block, joined, rigid_body as rigid};
use crate::solver::{Collider, Particles};
use crate::spec::{BoxShape, ColliderShape, SphereShape};
use glam::Vec3;

fn stone(low_m: Vec3, size_m: Vec3) -> Particles {
    rigid(block(low_m, size_m, 0.025, 1e5, 0.3), 0.4, 0.0)
}

fn post(centre_m: [f64; 3], size_m: [f64; 3]) -> Collider {
    Collider { shape: ColliderShape::Box(BoxShape { centre_m, size_m }), friction: 0.4, restitution: 0.0 }
}

#[test]
fn a_plank_rests_on_more_posts_than_it_has_slots() {
    // The first dozen alone would let it tip.
    let posts = (0..25).map(|k| post([0.04 + 0.08 * f64::from(k), 0.05, 0.1], [0.02, 0.2, 0.2])).collect();
    let mut solver = solver(Settings { colliders: posts, ..incline(0.0, 0.4) }, &stone(Vec3::new(0.0, 0.0, 0.2), Vec3::new(2.0, 0.1, 0.05)));
    let mut start = None;
    let mut unmet = false;
    for frame in 1..=20 {
        unmet |= solver.advance(0.02 * f64::from(frame), &crate::Stop::default()).expect("an advance").unmet;
        let plank = bodies_of(&solver)[0];
        let start_m = *start.get_or_insert(centre(&plank));
        assert!((centre(&plank) - start_m).length() < 5e-4, "it moved from {start_m} to {}", centre(&plank));
        assert!(glam::Quat::from_array(plank.turn).to_scaled_axis().length() < 1e-3, "it tips: {:?}", plank.turn);
    }
    assert!(unmet, "that not all were followed is told");
}

#[test]
fn every_bar_of_a_pile_lies_on_the_one_below() {
    // Four by four long bars, all within each other's reach. So thin ones are round, 5.64 cm across.
    let bar = |k: u32| stone(Vec3::new(0.0, 0.07 * (k % 4) as f32, 0.004 + 0.0575 * (k / 4) as f32), Vec3::new(0.5, 0.05, 0.05));
    let mut solver = solver(incline(0.0, 0.4), &(1..16).map(bar).fold(bar(0), joined));
    // Whatever is not held falls by two centimetres.
    advance(&mut solver, 0.065);
    let bars = bodies_of(&solver);
    for (k, (below, above)) in bars.iter().zip(&bars[4..]).enumerate() {
        let apart_m = centre(above).z - centre(below).z;
        assert!(apart_m > 0.055, "bar {} is {apart_m} m above bar {k}", k + 4);
    }
}

#[test]
fn what_is_thinner_than_the_points_of_a_face_are_apart_does_not_pass_through() {
    // Points of the slab's faces are some 3.5 cm apart.
    let mut slab = stone(Vec3::new(-0.15, -0.15, 0.001), Vec3::new(0.3, 0.3, 0.1));
    slab.velocity_m_s.fill(Vec3::new(0.0, 0.0, -1.0));
    for k in 0..8 {
        let [x, y] = [0.011 * f64::from(k) - 0.04, 0.023 - 0.0073 * f64::from(k)];
        let nail = ColliderShape::Sphere(SphereShape { centre_m: [x, y, -0.004], radius_m: 0.004 });
        for (name, met) in [("nail", Collider { shape: nail, friction: 0.4, restitution: 0.0 }), ("post", post([x, y, -0.1], [0.006, 0.006, 0.2]))] {
            let mut solver = solver(Settings { colliders: vec![met], ..floating() }, &slab);
            advance(&mut solver, 0.02);
            let slab = bodies_of(&solver)[0];
            assert!(velocity(&slab).z > -0.5, "the {name} at {x:.3} {y:.3} goes in at {}", velocity(&slab));
        }
    }
}

#[test]
fn more_contacts_than_colours_all_count() {
    // Twelve stones with twelve contacts each come down on a plate that is held: the last would find no colour.
    let stones = 12;
    let one = |k: u32| stone(Vec3::new(0.2 * k as f32, 0.0, 0.0), Vec3::splat(0.05));
    let mut solver = solver(floating(), &(1..=stones).map(one).fold(one(0), joined));
    advance(&mut solver, 0.001);
    let (gpu, rigid) = (solver.gpu.clone(), solver.rigid.clone().expect("rigid bodies"));
    let mut bodies = bodies_of(&solver);
    bodies.iter_mut().for_each(|b| b.velocity_m_s = [0.0, 0.0, -1.0, 0.0]);
    bodies[0].velocity_m_s = [0.0, 0.0, 0.0, 1.0];
    let slots = body::slots(bodies.len());
    let count = |m: usize| u32::from(m >= RIGID_SLOTS as usize);
    let manifolds: Vec<Manifold> = (0..slots).map(|m| Manifold { other: 0, count: count(m), friction: 0.4, ..Default::default() }).collect();
    let contact = Contact { normal: [0.0, 0.0, 1.0, 0.0], ..Default::default() };
    gpu.upload(&rigid.bodies.live, &bodies);
    gpu.upload(&rigid.manifolds.live, &manifolds);
    gpu.upload(&rigid.contacts.live, &vec![contact; 4 * slots]);
    let bound = solver.bind_both().expect("bound");
    let bound = bound[solver.current].rigid.as_ref().expect("rigid passes");
    let substep = Substep { dt_s: 1e-4, dt_next_s: 1e-4, index: solver.substep, job: 0, since_s: 0.0, lag: 0 };
    let mut recording = Recording::default();
    recording.dispatch_with(&rigid.passes.rigid_solve, &bound.solve, &substep, [1, 1, 1]);
    gpu.submit(&recording);
    for (k, body) in bodies_of(&solver).iter().enumerate().skip(1) {
        assert!(velocity(body).length() < 1e-4, "stone {k} goes on at {}", velocity(body));
    }
}
