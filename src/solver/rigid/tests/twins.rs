//! Each pass over bodies against its twin.

use super::{CELL_M, Settings, advance, bodies_of, floating, incline, moving, solver};
use crate::gpu::{Gpu, Recording};
use crate::solver::advance::Substep;
use crate::solver::rigid::body::{self, Contact, Manifold};
use crate::solver::rigid::twin::{self, World};
use crate::solver::tests::twins::{Stored, node_count};
use crate::solver::twin::{self as solver_twin, Surroundings};
use crate::solver::validate::{ball, block, joined, rigid_body as rigid};
use crate::solver::{Collider, Field, Particles, Substance, obstacles};
use crate::spec::expression::{Kind, Program, parse};
use crate::spec::{ColliderShape, SphereShape};
use glam::{IVec3, Quat, Vec3};

#[test]
fn contacts_impulses_and_places_are_those_of_the_twin() {
    let cube = rigid(block(Vec3::new(0.0, 0.0, 0.0), Vec3::splat(0.1), 0.0125, 1e5, 0.3), 0.4, 0.3);
    let stone = rigid(ball(Vec3::new(0.06, 0.04, 0.16), 0.05, 0.0125), 0.3, 0.1);
    let knob = SphereShape { centre_m: [0.02, 0.0, -0.02], radius_m: 0.04 };
    let colliders = vec![Collider { shape: ColliderShape::Sphere(knob), friction: 0.5, restitution: 0.0 }];
    let settings = Settings { colliders, ..incline(0.1, 0.4) };
    let particles = joined(cube, stone);
    let mut solver = solver(settings.clone(), &particles);
    let mut tilted = moving(Vec3::new(0.1, 0.0, -0.5), Vec3::new(1.0, 2.0, -0.5), Vec3::new(0.05, 0.05, 0.05));
    tilted.rotation = Quat::from_rotation_y(0.1);
    solver.place(0, &tilted).expect("a placement");
    advance(&mut solver, 0.04);

    let gpu = Gpu::shared_for_tests().expect("a device");
    let rigid = solver.rigid.clone().expect("rigid bodies");
    let read = || {
        let manifolds: Vec<Manifold> = gpu.read(&rigid.manifolds.live, body::slots(2)).expect("manifolds");
        let contacts: Vec<Contact> = gpu.read(&rigid.contacts.live, 4 * body::slots(2)).expect("contacts");
        (manifolds, contacts)
    };
    let colliders = obstacles::colliders(&settings);
    let states = crate::solver::state::initial(&particles, &colliders, settings.cell_m).expect("states");
    let all = body::assemble(&states, &particles.substances, &colliders, settings.cell_m).expect("bodies").expect("some");
    let dt_s = 5e-4;
    let world = World {
        all: &all,
        substances: &particles.substances,
        colliders: &colliders,
        gravity_m_s2: settings.gravity_m_s2,
        accelerations: &[Vec3::ZERO; 2],
        dt_s,
        speed_most_m_s: f32::INFINITY,
    };
    let substep = Substep { dt_s, dt_next_s: dt_s, index: 80, job: 0, since_s: 0.0, lag: 0 };
    let bound = solver.bind_both().expect("bound");
    let bound = bound[solver.current].rigid.as_ref().expect("rigid passes");
    let run = |add: &dyn Fn(&mut Recording)| {
        let mut recording = Recording::default();
        add(&mut recording);
        gpu.submit(&recording);
    };

    let mut bodies = bodies_of(&solver);
    let (mut manifolds, mut contacts) = read();
    world.contacts(&bodies, &mut manifolds, &mut contacts);
    run(&|r| r.dispatch_with(&rigid.passes.rigid_contacts, &bound.contacts, &substep, [2, 1, 1]));
    let (got_manifolds, got_contacts) = read();
    assert!(manifolds.iter().filter(|m| m.count > 0).count() >= 3, "{manifolds:?}");
    for (m, (want, got)) in manifolds.iter().zip(&got_manifolds).enumerate() {
        assert_eq!((want.count, if want.count > 0 { want.other } else { 0 }), (got.count, if got.count > 0 { got.other } else { 0 }), "manifold {m}");
        for k in (4 * m..4 * m + 4).take(want.count as usize) {
            let (want, got) = (&contacts[k], &got_contacts[k]);
            // Where surfaces face each other flatly rounding moves the place, and hardly the gap.
            assert!(twin::apart(&want.local, &got.local) < 1e-4 && (want.local[3] - got.local[3]).abs() < 1e-6, "{want:?} {got:?}");
            assert!(twin::apart(&want.normal, &got.normal) < 1e-3 && twin::apart(&want.impulse, &got.impulse) < 1e-5, "{want:?} {got:?}");
        }
    }

    // From the same contacts on.
    let (manifolds, mut contacts) = (got_manifolds, got_contacts);
    world.solve(&mut bodies, &manifolds, &mut contacts, &[(Vec3::ZERO, Vec3::ZERO); 2]);
    run(&|r| r.dispatch_with(&rigid.passes.rigid_solve, &bound.solve, &substep, [1, 1, 1]));
    for (want, got) in bodies.iter().zip(&bodies_of(&solver)) {
        assert!(twin::apart(&want.centre_m, &got.centre_m) < 1e-6, "{want:?} {got:?}");
        assert!(twin::apart(&want.turn, &got.turn) < 1e-5, "{want:?} {got:?}");
        assert!(twin::apart(&want.velocity_m_s, &got.velocity_m_s) < 1e-3, "{want:?} {got:?}");
        assert!(twin::apart(&want.angular_momentum, &got.angular_momentum) < 1e-4, "{want:?} {got:?}");
    }

    let bodies = bodies_of(&solver);
    run(&|r| r.dispatch_with(&rigid.passes.rigid_place, &bound.place, &substep, [particles.len().div_ceil(128) as u32, 1, 1]));
    for got in solver.states().expect("states") {
        let anchor = all.anchors[got.index as usize];
        let b = anchor[3].to_bits() as usize;
        let mut want = got;
        twin::place(&mut want, &bodies[b], &all.shapes[b], Vec3::from_slice(&anchor));
        assert!((want.position_m - got.position_m).length() < 1e-6 && (want.velocity_m_s - got.velocity_m_s).length() < 1e-4);
        assert!((want.f().x_axis - got.f().x_axis).length() < 1e-5);
        assert!(want.affine.iter().zip(&got.affine).all(|(a, b)| (a - b).abs() < 1e-5));
    }
}

#[test]
fn what_millions_of_members_bring_is_summed_exactly() {
    // Their low words have all but filled one, to the other side of zero, when the present few add theirs.
    let tree = parse("vec3(0)", Kind::Vector).expect("an expression");
    let acceleration = Program::of(&tree).expect("a program");
    let fields = vec![Field { name: "none".to_owned(), object: 0, from_s: 0.0, to_s: f64::INFINITY, acceleration }];
    let particles = rigid(block(Vec3::ZERO, Vec3::splat(0.1), 0.025, 1e5, 0.3), 0.3, 0.0);
    let mut solver = solver(Settings { fields, ..floating() }, &particles);
    advance(&mut solver, 0.001);
    solver.edit(|s| s.velocity_m_s += Vec3::new(1e-3, 0.0, -1e-3)).expect("an edit");
    let (gpu, rigid) = (solver.gpu.clone(), solver.rigid.clone().expect("a body"));
    let zero = [(1u32 << 20).wrapping_neg(), u32::MAX - 100];
    gpu.upload(&rigid.driven, &[0, 1].map(|_| [[zero[0]; 3], [zero[1]; 3]]));
    solver.start_segment();
    let bound = solver.bind_both().expect("bound");
    let bound = bound[solver.current].rigid.as_ref().expect("rigid passes");
    let substep = Substep { dt_s: 1e-4, dt_next_s: 0.0, index: solver.substep, job: 0, since_s: 0.0, lag: 0 };
    let mut recording = Recording::default();
    rigid.record_substep(bound, &substep, particles.len() as u32, &mut recording);
    gpu.submit(&recording);
    let motion = solver.motions().expect("motions")[0];
    assert!((motion.velocity_m_s - Vec3::new(1e-3, 0.0, -1e-3)).length() < 1e-7, "{motion:?}");
    assert!(motion.spin_rad_s.length() < 1e-5, "{motion:?}");
}

#[test]
fn the_exchange_with_soft_matter_is_that_of_the_twin() {
    exchange_is_that_of_the_twin(1.0, Substance::default());
}

#[test]
fn the_exchange_with_what_flows_is_that_of_the_twin() {
    exchange_is_that_of_the_twin(1.0, Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 0.0 });
    exchange_is_that_of_the_twin(1.0, Substance::Liquid { viscosity_pa_s: 0.1, surface_tension_n_m: 0.0 });
}

#[test]
fn the_exchange_of_grains_with_soft_matter_is_that_of_the_twin() {
    // Inertia of 1e-17 kg m^2: its cube is no number of f32.
    exchange_is_that_of_the_twin(1e-3, Substance::default());
}

/// At a scale of length; all rates are the same.
fn exchange_is_that_of_the_twin(scale: f32, soft: Substance) {
    // What is loose hangs on no body; what has no shear modulus slides along it.
    let loose = !soft.is_plain();
    // A soft block with a rigid end, and a ball that presses into it.
    let whole = block(Vec3::ZERO, scale * Vec3::new(0.3, 0.15, 0.15), scale * 0.025, scale * scale * 5e4, 0.3);
    let substance = whole.position_m.iter().map(|p| u16::from(p.x > scale * 0.2)).collect();
    let substances = vec![soft, Substance::Rigid { friction: 0.3, restitution: 0.0 }];
    let mut particles = joined(
        Particles { substance, substances, ..whole },
        rigid(ball(scale * Vec3::new(0.08, 0.07, 0.185), scale * 0.05, scale * 0.0125), 0.4, 0.0),
    );
    for (i, (v, p)) in particles.velocity_m_s.iter_mut().zip(&particles.position_m).enumerate() {
        let away = if particles.object[i] == 1 { Vec3::new(0.5, 0.0, -3.0) } else { Vec3::ZERO };
        *v = scale * away + Vec3::new(1.0, 2.0, -0.5).cross(*p - Vec3::splat(scale * 0.1));
    }
    let settings = Settings { gravity_m_s2: Vec3::ZERO, cell_m: scale * CELL_M, ..incline(0.0, 0.4) };
    let mut solver = solver(settings.clone(), &particles);
    let seen = solver.look().expect("a look");
    solver.fit_window(seen.low, seen.high, 4).expect("a window");
    solver.set_surroundings();
    solver.start_segment();
    let (mut states, bodies) = (solver.states().expect("states"), bodies_of(&solver));

    let gpu = Gpu::shared_for_tests().expect("a device");
    let rigid = solver.rigid.clone().expect("rigid bodies");
    let meeting = rigid.meeting.clone().expect("soft matter");
    let dt_s = 4e-4;
    let substep = Substep { dt_s, dt_next_s: dt_s, index: 0, job: 0, since_s: 0.0, lag: 0 };
    let (passes, groups) = (solver.passes.clone(), solver.particle_groups());
    let mut recording = Recording::default();
    let bound = solver.bind_both().expect("bound");
    solver.record_sort(&bound[solver.current], &mut recording);
    solver.current = 1 - solver.current;
    let b = &bound[solver.current];
    recording.dispatch_with(&passes.stress, &b.stress, &substep, groups);
    solver.record_p2g(b, &substep, &mut recording);
    rigid.record_meeting(b.rigid.as_ref().expect("rigid passes"), &substep, groups, &mut recording);
    gpu.submit(&recording);

    let colliders = obstacles::colliders(&settings);
    let substances = solver.laws.substances.clone();
    let none = [Vec3::ZERO; 2];
    let around = Surroundings { params: solver.params, colliders: &colliders, pins: &[], accelerations: &none, substances: &substances };
    let all = body::assemble(&states, &particles.substances, &colliders, settings.cell_m).expect("bodies").expect("some");
    let world = World {
        all: &all,
        substances: &particles.substances,
        colliders: &colliders,
        gravity_m_s2: Vec3::ZERO,
        accelerations: &none,
        dt_s,
        speed_most_m_s: f32::INFINITY,
    };
    solver_twin::stress(&mut states, &around, dt_s);
    let mut grid = solver_twin::p2g(&states, &around);
    let want = world.exchange(&bodies, &states, &mut grid, &solver.params);
    let bonded = want.meetings.values().filter(|m| m.normal == Vec3::ZERO).count();
    assert!((bonded > 20) != loose && want.meetings.len() > bonded + 5, "{bonded} bonded of {}", want.meetings.len());

    // What it leaves on the grid, in units of some power of two.
    let stored = Stored::of(&solver);
    let sums: Vec<[i32; 4]> = gpu.read(&solver.grid.as_ref().expect("a grid").sums, node_count(&solver)).expect("sums");
    let left = |node: &[i32; 3]| IVec3::from_slice(&sums[stored.node(node, 0)]).as_dvec3();
    let (counted, summed) = grid.iter().fold((0.0, 0.0), |(a, b), (node, value)| (a + left(node).length(), b + value.momentum.length()));
    let unit = (counted / summed).log2().round().exp2();
    let strongest = grid.values().map(|value| value.momentum.length()).fold(0.0, f64::max);
    for (node, value) in &grid {
        let got = left(node) / unit;
        assert!((got - value.momentum).length() < 1e-3 * strongest, "node {node:?}: {got} and {} of {strongest}", value.momentum);
    }

    let predicted: Vec<[f32; 4]> = gpu.read(&meeting.predicted, 4).expect("velocities");
    let given: Vec<[f32; 4]> = gpu.read(&rigid.given, 2 * all.owners.len()).expect("impulses");
    for (b, (shape, (velocity, omega))) in all.shapes.iter().zip(&want.predicted).enumerate() {
        let close = |got: &[f32; 4], want: glam::DVec3, size: f64| (Vec3::from_slice(got).as_dvec3() - want).length() < 1e-3 * size;
        assert!(close(&predicted[2 * b], *velocity, f64::from(scale)), "{:?} {velocity}", predicted[2 * b]);
        assert!(close(&predicted[2 * b + 1], *omega, 10.0), "{:?} {omega}", predicted[2 * b + 1]);
        let chunks = shape.first_chunk as usize..(shape.first_chunk + shape.chunks) as usize;
        let sum = |row: usize| chunks.clone().map(|k| Vec3::from_slice(&given[2 * k + row])).sum::<Vec3>().extend(0.0).to_array();
        let size = want.given[b].0.length();
        assert!(size > 1e-4 * f64::from(scale).powi(4) && close(&sum(0), want.given[b].0, size), "{:?} {:?}", sum(0), want.given[b]);
        assert!(close(&sum(1), want.given[b].1, 0.1 * f64::from(scale) * size + want.given[b].1.length()), "{:?} {:?}", sum(1), want.given[b]);
    }
}
