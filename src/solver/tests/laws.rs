//! The laws and the singular values on the device, against twins in f64.

use crate::gpu::Access::{Read, Write};
use crate::gpu::{Gpu, KernelSource, Recording};
use crate::solver::Activation;
use crate::solver::constants;
use crate::solver::substance::{self, Substance};
use crate::solver::twin::laws::{Answer, Matter, outer, respond, stretches};
use crate::spec::ElasticModel;
use glam::{DMat3, DVec3, Mat3, Vec3};

/// Asks each law, with the deformations, histories and answers in buffers.
const PROBE: &str = "
@group(0) @binding(0) var<storage, read> trials: array<mat3x3<f32>>;
@group(0) @binding(1) var<storage, read> numbers: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> substances: array<Substance>;
@group(0) @binding(3) var<storage, read_write> answers: array<Answer>;
@group(0) @binding(4) var<storage, read_write> axes: array<Svd>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= arrayLength(&trials)) {
        return;
    }
    let v = numbers[id.x];
    let flow = Flow(v.w, mat3x3<f32>(), 0.5);
    answers[id.x] = respond(substances[id.x % arrayLength(&substances)], trials[id.x], v.z, v.x, v.y, flow);
    axes[id.x] = svd(trials[id.x]);
}
";

/// A matrix or an answer as the device lays it out: columns of vec4.
fn columns(m: DMat3) -> [[f32; 4]; 3] {
    [m.x_axis, m.y_axis, m.z_axis].map(|c| c.as_vec3().extend(0.0).into())
}

fn matrix(words: &[f32]) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(words[0].into(), words[1].into(), words[2].into()),
        DVec3::new(words[4].into(), words[5].into(), words[6].into()),
        DVec3::new(words[8].into(), words[9].into(), words[10].into()),
    )
}

struct Probed {
    f: DMat3,
    history: f64,
    tau: DMat3,
    u: DMat3,
    s: DVec3,
    v: DMat3,
}

fn probe(substances: &[Substance], trials: &[DMat3], numbers: &[[f32; 4]]) -> Vec<Probed> {
    let gpu = Gpu::shared_for_tests().expect("a device");
    let laws = crate::solver::kernels().into_iter().find(|k| k.label == "solver.prestress_gather_laws").expect("a pass");
    let of_laws = |name: &str| ["substance", "material", "svd", "hencky", "cube_root", "law"].iter().any(|part| name.contains(part));
    let mut parts: Vec<_> = laws.parts.into_iter().filter(|(name, _)| of_laws(name)).collect();
    parts.push(("tests/probe", PROBE));
    let source = KernelSource {
        label: "tests.probe",
        entry: "main",
        parts,
        constants: constants::all(),
        bindings: vec![Read, Read, Read, Write, Write],
        immediate_bytes: 0,
    };
    let kernel = gpu.kernel(&source);
    let n = trials.len();
    let columns: Vec<_> = trials.iter().map(|&m| columns(m)).collect();
    let answers = gpu.storage::<[f32; 28]>("answers", n).expect("room");
    let axes = gpu.storage::<[f32; 28]>("axes", n).expect("room");
    let bound = gpu.bind(
        &kernel,
        &[
            &gpu.storage_from("trials", &columns).expect("room"),
            &gpu.storage_from("numbers", numbers).expect("room"),
            &gpu.storage_from("substances", &substance::records(substances, &vec![f32::MAX; substances.len()])).expect("room"),
            &answers,
            &axes,
        ],
    );
    let mut recording = Recording::default();
    recording.dispatch(&kernel, &bound, [n.div_ceil(constants::WORKGROUP as usize) as u32, 1, 1]);
    gpu.submit(&recording);
    let answers: Vec<[f32; 28]> = gpu.read(&answers, n).expect("answers");
    let axes: Vec<[f32; 28]> = gpu.read(&axes, n).expect("axes");
    let of = |(a, x): (&[f32; 28], &[f32; 28])| Probed {
        f: matrix(&a[..12]),
        history: a[12].into(),
        tau: matrix(&a[16..]),
        u: matrix(&x[..12]),
        s: DVec3::new(x[12].into(), x[13].into(), x[14].into()),
        v: matrix(&x[16..]),
    };
    answers.iter().zip(&axes).map(of).collect()
}

fn entries(m: DMat3) -> f64 {
    m.to_cols_array().iter().fold(0.0, |a, b| a.max(b.abs()))
}

/// Deformations small and large, some of them inside out.
fn trials(count: usize, strength: &[f64]) -> Vec<DMat3> {
    let mut noise = super::twins::Noise(11);
    (0..count)
        .map(|k| {
            let strength = strength[k % strength.len()];
            let mut vec = || noise.vec().as_dvec3();
            let mut f = DMat3::IDENTITY + DMat3::from_cols(vec(), vec(), vec()) * strength;
            if k % 89 == 0 {
                f.x_axis = -f.x_axis;
            }
            let f = DMat3::from_rotation_z(k as f64) * DMat3::from_rotation_x(0.3 * k as f64) * f;
            // The device gets f32: the twin shall see the same.
            f.as_mat3().as_dmat3()
        })
        .collect()
}

#[test]
fn singular_values_hold_for_any_matrix() {
    let mut all = trials(3000, &[1e-5, 1e-3, 0.1, 0.5, 2.0]);
    let turn = Mat3::from_rotation_y(0.7).as_dmat3();
    for d in [
        [1.0, 1.0, 1.0],
        [2.0, 2.0, 0.5],
        [1.0, 1e-4, 1e-4],
        [3.0, 1e-7, 0.0],
        [0.0; 3],
        [1.0, 1.0, -1.0],
        [1e-3, 1e3, 1.0],
        [1.0, 1.0 + 1e-6, 1.0 - 1e-6],
    ] {
        let stretched = DMat3::from_diagonal(DVec3::from(d));
        all.extend([stretched, turn * stretched, turn * stretched * turn, stretched * turn.transpose()].map(|m| m.as_mat3().as_dmat3()));
    }
    let numbers = vec![[1e5, 1e5, 0.0, 0.0]; all.len()];
    for (m, got) in all.iter().zip(probe(&[Substance::default()], &all, &numbers)) {
        let scale = entries(*m).max(1e-30);
        let back = got.u * DMat3::from_diagonal(got.s) * got.v.transpose();
        assert!(entries(back - *m) < 2e-6 * scale, "{m}: {back}");
        for turn in [got.u, got.v] {
            assert!(entries(turn * turn.transpose() - DMat3::IDENTITY) < 2e-6 && turn.determinant() > 0.0, "{m}: {turn}");
        }
        assert!(got.s.x >= got.s.y - 1e-6 * scale && got.s.y >= got.s.z.abs() - 1e-6 * scale, "{m}: {}", got.s);
        let (want, _) = stretches(*m);
        assert!((got.s.abs() - want.abs()).abs().max_element() < 2e-6 * scale, "{m}: {} and {want}", got.s);
        let sign = m.determinant();
        assert!(sign.abs() < 1e-6 * scale.powi(3) || got.s.z * sign > 0.0, "{m}: {}", got.s);
    }
}

/// One of each law, with numbers at which a good share of the trials yields.
pub(in crate::solver) fn all_laws() -> Vec<Substance> {
    vec![
        Substance::Elastic(ElasticModel::Corotated),
        Substance::Elastic(ElasticModel::NeoHookean),
        Substance::Muscle { model: ElasticModel::NeoHookean, fibre: Vec3::new(1.0, 2.0, -1.0), activation: Activation::Curve(vec![(0.0, 0.5)]) },
        Substance::Plastic { yield_stress_pa: 4e3, hardening_pa: 2e4 },
        Substance::Plastic { yield_stress_pa: 4e3, hardening_pa: -1e4 },
        Substance::Viscoplastic { yield_stress_pa: 2e3, viscosity_pa_s: 30.0 },
        Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 0.0 },
        Substance::Sand { friction_angle_deg: 35.0, cohesion_pa: 1e3 },
        Substance::Snow { theta_c: 2.5e-2, theta_s: 7.5e-3, hardening: 10.0 },
    ]
}

/// A thin one and a thick one.
pub(super) fn liquids() -> [Substance; 2] {
    [1e-3, 100.0].map(|viscosity_pa_s| Substance::Liquid { viscosity_pa_s, surface_tension_n_m: 0.07 })
}

#[test]
fn each_law_answers_as_its_twin_does() {
    answers_agree(&all_laws());
}

#[test]
fn liquids_answer_as_their_twins_do() {
    answers_agree(&liquids());
}

fn answers_agree(substances: &[Substance]) {
    let all = trials(substances.len() * 400, &[1e-4, 5e-3, 3e-2, 0.1, 0.4]);
    let history = |k: usize| match &substances[k % substances.len()] {
        Substance::Snow { .. } => [0.7, 1.0, 1.1][k / substances.len() % 3],
        Substance::Sand { .. } => [0.0, 0.01, 0.2][k / substances.len() % 3],
        _ => [0.0, 0.05, 2.0][k / substances.len() % 3],
    };
    let numbers: Vec<[f32; 4]> = (0..all.len()).map(|k| [4e4, 6e4, history(k), 5e-4]).collect();
    let mut yielded = vec![0; substances.len()];
    for (k, (trial, got)) in all.iter().zip(probe(substances, &all, &numbers)).enumerate() {
        let [mu, lambda, history, dt_s] = numbers[k].map(f64::from);
        let substance = &substances[k % substances.len()];
        let want: Answer = respond(substance, *trial, &Matter { mu, lambda, history, activation: 0.5, gradient: DMat3::ZERO }, dt_s);
        yielded[k % substances.len()] += usize::from(want.f != *trial);
        let name = format!("{substance:?}, F = {trial}");
        assert!(got.tau.is_finite() && got.f.is_finite() && got.history.is_finite(), "{name}");
        // Inside out with two stretches of nearly one size, one of them negative: which is it?
        let (s, _) = stretches(*trial);
        if s.z < 0.0 && s.y + s.z < 0.1 * s.y {
            continue;
        }
        // The rotation of what is inside out is found by turns that come to it slowly.
        let flat = trial.determinant() < f64::from(constants::FLAT);
        // An exponential of ten times the packing makes ten times its error.
        let exact = if matches!(substance, Substance::Snow { .. }) { 4e-4 } else { 4e-5 };
        let (tolerance, scale) = (if flat { 5e-3 } else { exact }, entries(want.tau).max(0.1 * mu));
        assert!(entries(got.tau - want.tau) < tolerance * scale, "{name}: tau is {} and by the twin {}", got.tau, want.tau);
        assert!(entries(got.f - want.f) < tolerance * entries(*trial).max(1.0), "{name}: F is {} and by the twin {}", got.f, want.f);
        assert!((got.history - want.history).abs() < 2e-5 * want.history.abs().max(1.0), "{name}: history {} and {}", got.history, want.history);
    }
    for (substance, count) in substances.iter().zip(yielded) {
        // All shear of a liquid yields.
        if substance.is_liquid() {
            assert_eq!(count, 400);
            continue;
        }
        let solid = substance.is_plain() || matches!(substance, Substance::Muscle { .. });
        assert!(if solid { count == 0 } else { (60..400).contains(&count) }, "{substance:?}: {count} yielded");
    }
}

#[test]
fn a_return_is_where_it_goes() {
    // What has yielded does not yield again without more strain, and what is outer is symmetric.
    let substances: Vec<_> = all_laws().into_iter().chain(liquids()).collect();
    let all = trials(substances.len() * 50, &[3e-2, 0.1]);
    for (k, trial) in all.iter().enumerate() {
        let substance = &substances[k % substances.len()];
        let matter = Matter { mu: 4e4, lambda: 6e4, history: f64::from(substance.first_history()), activation: 0.5, gradient: DMat3::ZERO };
        let first = respond(substance, *trial, &matter, 5e-4);
        let again = respond(substance, first.f, &Matter { history: first.history, ..matter }, 0.0);
        assert!(entries(again.tau - first.tau) < 1e-6 * entries(first.tau).max(1.0), "{substance:?}");
        assert!(entries(first.tau - first.tau.transpose()) < 1e-9 * entries(first.tau).max(1.0));
    }
    assert_eq!(outer(DVec3::X, DVec3::Y).col(1), DVec3::X);
}
