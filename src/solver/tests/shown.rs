//! What is seen of matter whose F forgets, and how fast its waves run.

use super::laws::all_laws;
use super::{block, solver};
use crate::Stop;
use crate::gpu::{Gpu, Recording};
use crate::solver::constants::BREATHING;
use crate::solver::substance::Substance;
use crate::solver::validate::append;
use crate::solver::{Flow, Moduli, Placement, Plane, Settings, Solver};
use glam::{Mat3, Quat, Vec3};

/// G and the volume ratio of each particle, as a frame has them.
fn frame(solver: &Solver) -> Vec<(Mat3, f32)> {
    for (m, state) in motion(solver).iter().zip(solver.states().expect("states")) {
        let flow = solver.laws.substances[state.substance()].flow().map_or(0.0, |flow| flow as u32 as f32);
        assert_eq!(m[7] >> 16, u32::from(half::f16::from_f32(flow).to_bits()));
    }
    framed(solver)
}

fn motion(solver: &Solver) -> Vec<[u32; 8]> {
    let gpu = Gpu::shared_for_tests().expect("a device");
    let mut recording = Recording::default();
    solver.record_frame(&mut recording);
    gpu.submit(&recording);
    gpu.read(solver.motion(), solver.particle_count() as usize).expect("motion")
}

fn framed(solver: &Solver) -> Vec<(Mat3, f32)> {
    let gpu = Gpu::shared_for_tests().expect("a device");
    let motion = motion(solver);
    let n = solver.particle_count() as usize;
    let velocity: Vec<[f32; 4]> = gpu.read(solver.velocity(), n).expect("velocity");
    let half = |m: &[u32; 8], k: usize| half::f16::from_bits((m[3 + k / 2] >> (16 * (k % 2))) as u16).to_f32();
    let g = |m: &[u32; 8]| Mat3::from_cols_array(&std::array::from_fn(|k| half(m, k))).transpose() + Mat3::IDENTITY;
    motion.iter().zip(&velocity).map(|(m, v)| (g(m), v[3])).collect()
}

/// A small block of each law, an object each, side by side.
fn side_by_side(laws: &[Substance], settings: Settings) -> Solver {
    let body = |k: usize| block(Vec3::new(0.25 * k as f32, 0.0, 0.05), Vec3::splat(0.1), 0.025, 2e4, 0.3);
    let mut particles = body(0);
    particles.substances = vec![laws[0].clone()];
    for (k, law) in laws.iter().enumerate().skip(1) {
        append(&mut particles, body(k), law.clone());
    }
    solver(settings, &particles)
}

fn weightless() -> Settings {
    Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(0.05) }
}

#[test]
fn what_is_shown_turns_with_the_body_and_volume_counts_what_the_law_remembers() {
    let dent = Mat3::from_cols_array(&[1.1, 0.1, 0.0, 0.0, 0.9, 0.05, -0.1, 0.0, 1.02]);
    let laws = all_laws();
    let mut solver = side_by_side(&laws, weightless());
    solver.edit(|s| s.history += 0.1).expect("an edit");
    solver.edit_shown(|_, _| dent).expect("an edit");
    let turn = Quat::from_rotation_y(0.7);
    for object in 0..laws.len() as u32 {
        let placement = Placement { rotation: turn, centre_m: Vec3::ZERO, offset_m: Vec3::X, velocity_m_s: Vec3::ZERO, spin_rad_s: Vec3::ZERO };
        solver.place(object, &placement).expect("a placement");
    }
    for (state, (g, ratio)) in solver.states().expect("states").iter().zip(frame(&solver)) {
        let substance = &laws[state.substance()];
        let seen = if substance.shown_stretch().is_some() { dent } else { Mat3::IDENTITY };
        let volume = match substance {
            Substance::Sand { .. } => 0.1f32.exp(),
            Substance::Snow { .. } => 1.1,
            _ => 1.0,
        };
        assert!(g.abs_diff_eq(Mat3::from_quat(turn) * seen, 2e-3), "{substance:?}: {g}");
        assert!((ratio - volume).abs() < 1e-5, "{substance:?}: {ratio}");
    }
}

#[test]
fn waves_run_faster_where_a_law_stiffens() {
    let laws = all_laws();
    let mut solver = side_by_side(&laws, weightless());
    let snow = laws.len() - 1;
    let modulus = |law: &Substance| {
        // 3 lambda + 2 mu = E / (1 - 2 nu).
        let passive = BREATHING * 2e4 / 0.4;
        match law {
            Substance::Snow { hardening, .. } => passive * (hardening * 0.2).exp(),
            Substance::Muscle { .. } => passive + BREATHING * 4e4,
            _ => passive,
        }
    };
    // The fastest of all is the packed snow; without it the muscle.
    for (packing, fastest) in [(0.8, snow), (1.2, 2)] {
        solver.edit(|s| s.history = if s.substance() == snow { packing } else { 0.0 }).expect("an edit");
        let seen = solver.look().expect("a look").wave_speed_m_s;
        assert!((seen / (modulus(&laws[fastest]) / 1000.0).sqrt() - 1.0).abs() < 1e-4, "{:?}: {seen} m/s", laws[fastest]);
    }
}

#[test]
fn matter_of_any_law_thrown_hard_at_the_ground_stays_finite() {
    let extremes = [
        Substance::Plastic { yield_stress_pa: 0.0, hardening_pa: 0.0 },
        Substance::Plastic { yield_stress_pa: 1e3, hardening_pa: -1e9 },
        Substance::Plastic { yield_stress_pa: 1e3, hardening_pa: 1e9 },
        Substance::Viscoplastic { yield_stress_pa: 0.0, viscosity_pa_s: 0.0 },
        Substance::Viscoplastic { yield_stress_pa: 0.0, viscosity_pa_s: 1e6 },
        Substance::Sand { friction_angle_deg: 1.0, cohesion_pa: 0.0 },
        Substance::Sand { friction_angle_deg: 85.0, cohesion_pa: 1e5 },
    ];
    let laws: Vec<Substance> = all_laws().into_iter().chain(extremes).collect();
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    let mut solver = side_by_side(&laws, settings);
    solver.edit(|s| s.velocity_m_s = Vec3::new(3.0, 0.0, -12.0)).expect("an edit");
    solver.advance(0.06, &Stop::default()).expect("an advance");
    for (s, (g, _)) in solver.states().expect("states").iter().zip(frame(&solver)) {
        let substance = &laws[s.substance()];
        assert!(s.position_m.is_finite() && s.velocity_m_s.is_finite() && s.f().is_finite() && s.history.is_finite(), "{substance:?}");
        assert!(s.position_m.z >= -1e-6, "{substance:?}: {}", s.position_m);
        let (stretch, _) = crate::solver::twin::laws::stretches(g.as_dmat3());
        let within = |[least, most]: [f32; 2]| stretch.z > f64::from(least) - 0.01 && stretch.x < f64::from(most) + 0.01;
        assert!(substance.shown_stretch().is_none_or(within), "{substance:?}: {stretch}");
    }
}

#[test]
fn what_froze_out_of_a_liquid_is_seen_as_what_it_was() {
    let water = Substance::Liquid { viscosity_pa_s: 1e-3, surface_tension_n_m: 0.0 };
    let sand = Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 0.0 };
    let mut solver = side_by_side(&[water, sand, Substance::default()], weightless());
    let flows = |solver: &Solver| -> Vec<f32> { motion(solver).iter().map(|m| half::f16::from_bits((m[7] >> 16) as u16).to_f32()).collect() };
    let before = flows(&solver);
    for (object, poured) in [(0, Flow::Liquid), (1, Flow::Grains)] {
        let ice = Substance::Frozen { model: crate::spec::ElasticModel::Corotated, poured };
        solver.freeze(object, None, Some(&ice), Moduli::Young { young_pa: 1e5, poisson: 0.3 }).expect("a change");
    }
    assert_eq!(flows(&solver), before);
    assert!([0.0, 1.0, 3.0].iter().all(|flow| before.contains(flow)));
}
