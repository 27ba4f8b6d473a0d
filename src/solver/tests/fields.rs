//! Fields: the device against the CPU, and what they do against formulas.

use super::{centre_m, solver};
use crate::Stop;
use crate::gpu::{Access, Gpu, KernelSource, Recording};
use crate::solver::advance::Substep;
use crate::solver::constants;
use crate::solver::core::Params;
use crate::solver::fields::{own_number, shapes, velocity_change, write};
use crate::solver::grid::params_buffer;
use crate::solver::types::{Field, ObjectForce};
use crate::solver::validate::block;
use crate::solver::{Advance, Particles, PinRegion, Settings, Solver};
use crate::spec::expression::tests::grown;
use crate::spec::expression::{Inputs, Kind, Program, parse};
use crate::spec::{ColliderShape, PlaneShape};
use glam::{DVec3, Vec3};

fn program(text: &str) -> Program {
    let tree = parse(text, Kind::Vector).unwrap_or_else(|fault| panic!("{text}: {fault}"));
    Program::of(&tree).expect("a program")
}

fn field(text: &str) -> Field {
    Field { name: "field".to_owned(), object: 0, from_s: 0.0, to_s: f64::INFINITY, acceleration: program(text) }
}

/// Nothing around but these fields.
pub(super) fn driven_by(texts: &[&str]) -> Settings {
    Settings { gravity_m_s2: Vec3::ZERO, fields: texts.iter().map(|t| field(t)).collect(), ..Settings::new(0.05) }
}

pub(super) fn small(velocity: Vec3) -> Particles {
    let mut particles = block(Vec3::new(-0.05, -0.05, -0.05), Vec3::splat(0.1), 0.025, 5e4, 0.3);
    particles.velocity_m_s.fill(velocity);
    particles
}

pub(super) fn go(solver: &mut Solver, to_s: f64) -> Advance {
    solver.advance(to_s, &Stop::default()).expect("an advance")
}

pub(super) fn mean_velocity(solver: &Solver) -> DVec3 {
    let states = solver.states().expect("states");
    states.iter().map(|s| s.velocity_m_s.as_dvec3()).sum::<DVec3>() / states.len() as f64
}

const PROBE: &str = "
@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> constants: array<f32>;
@group(0) @binding(2) var<storage, read> firsts: array<u32>;
@group(0) @binding(3) var<storage, read> places: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> results: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(workgroup_id) group: vec3<u32>) {
    let p = places[3u * id.x];
    let q = places[3u * id.x + 1u];
    let r = places[3u * id.x + 2u];
    let here = Here(p.xyz, q.xyz, r.xyz, p.w, q.w, r.w);
    for (var shape = 0u; shape < arrayLength(&firsts); shape++) {
        let pull = field(shape, firsts[shape], here);
        let at = 8u * (shape * arrayLength(&places) / 3u + id.x);
        results[at] = vec4<f32>(pull.a, 0.0);
        for (var k = 0u; k < 3u; k++) {
            results[at + 1u + k] = vec4<f32>(pull.by_x[k], 0.0);
            results[at + 4u + k] = vec4<f32>(pull.by_v[k], 0.0);
        }
        results[at + 7u] = vec4<f32>(driven(here.v, velocity_change(pull, 0.01)) - here.v, 0.0);
    }
}
";

/// What the device makes of programs at places: acceleration, six slopes, change of velocity over 0.01 s.
fn on_device(programs: &[Program], places: &[Inputs]) -> Vec<[[f32; 4]; 8]> {
    let gpu = Gpu::shared_for_tests().expect("a device");
    let fields: Vec<Field> =
        programs.iter().map(|p| Field { name: String::new(), object: 0, from_s: 0.0, to_s: 1.0, acceleration: p.clone() }).collect();
    let shapes = shapes(&fields);
    assert_eq!(shapes.len(), programs.len(), "the shapes differ");
    let mut sources: KernelSource = crate::solver::fields::kernels().remove(0);
    let wanted = ["common", "hash", "chance", "dual", "field"].map(|n| format!("solver/{n}.wgsl"));
    sources.parts.retain(|(path, _)| wanted.iter().any(|w| w == path));
    sources.parts.push(("probe", PROBE));
    sources.bindings = vec![Access::Read, Access::Read, Access::Read, Access::Read, Access::Write];
    sources.constants = constants::all();
    sources.immediate_bytes = 0;
    let kernel = gpu.kernel_with(&sources, &write::functions(&shapes));
    let mut constants: Vec<f32> = Vec::new();
    let mut firsts = Vec::new();
    for program in programs {
        firsts.push(constants.len() as u32);
        constants.extend(program.constants.iter().map(|c| *c as f32));
    }
    let single = |v: [f64; 3], w: f64| [v[0] as f32, v[1] as f32, v[2] as f32, w as f32];
    let packed: Vec<[f32; 4]> =
        places.iter().flat_map(|p| [single(p.position_m, p.time_s), single(p.velocity_m_s, p.mass_kg), single(p.rest_m, p.seed)]).collect();
    let count = programs.len() * places.len();
    let buffers = [
        params_buffer(&gpu, &Params { speed_most: f32::INFINITY, ..Params::default() }, 0).expect("a buffer"),
        gpu.storage_from("constants", &constants).expect("a buffer"),
        gpu.storage_from("firsts", &firsts).expect("a buffer"),
        gpu.storage_from("places", &packed).expect("a buffer"),
        gpu.storage::<[[f32; 4]; 8]>("results", count).expect("a buffer"),
    ];
    let bindings = gpu.bind(&kernel, &buffers.iter().collect::<Vec<_>>());
    let mut recording = Recording::default();
    recording.dispatch(&kernel, &bindings, [places.len() as u32 / 64, 1, 1]);
    gpu.submit(&recording);
    gpu.read(&buffers[4], count).expect("results")
}

/// Numbers that look random, below 2^16.
fn drawn(state: &mut u32) -> f64 {
    *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    f64::from(*state >> 16)
}

fn places(count: usize) -> Vec<Inputs> {
    let state = &mut 5u32;
    // Numbers that f32 holds exactly.
    let mut vector = |scale: f64| [0; 3].map(|_| f64::from(((drawn(state) / 32768.0 - 1.0) * scale) as f32));
    (0..count)
        .map(|k| Inputs {
            position_m: vector(2.0),
            velocity_m_s: vector(4.0),
            rest_m: vector(2.0),
            time_s: f64::from(0.137f32 * k as f32),
            mass_kg: f64::from(1e-2f32 * (1 + k % 7) as f32),
            seed: f64::from(own_number(k as u32, 1)),
        })
        .collect()
}

#[test]
fn steps_on_the_device_give_what_the_cpu_gives() {
    let state = &mut 11u32;
    let mut programs: Vec<Program> = write::SAMPLE.iter().map(|t| program(t)).collect();
    let mut texts: Vec<String> = write::SAMPLE.map(str::to_owned).into();
    while programs.len() < 40 {
        let choices: Vec<u32> = (0..24).map(|_| drawn(state) as u32).collect();
        let tree = grown(&mut choices.iter(), Kind::Vector, 4);
        let Ok(program) = Program::of(&tree) else { continue };
        if programs.iter().all(|p| p.instructions != program.instructions || p.results != program.results) {
            programs.push(program);
            texts.push(tree.to_string());
        }
    }
    let places = places(64);
    let got = on_device(&programs, &places);
    let (mut compared, mut undefined) = (0, 0);
    for (number, program) in programs.iter().enumerate() {
        for (k, here) in places.iter().enumerate() {
            let got = &got[number * places.len() + k];
            let want = program.evaluate(here);
            let value = DVec3::new(want[0].value, want[1].value, want[2].value);
            if !value.as_vec3().is_finite() {
                undefined += 1;
                assert!(!Vec3::from_slice(&got[0]).is_finite(), "{} at {here:?}: {got:?} where there is no number", texts[number]);
                continue;
            }
            // Where a hair's difference of the inputs shows, rounding does.
            let nudged = |by: f64| {
                let inputs = Inputs {
                    position_m: here.position_m.map(|x| x * (1.0 + by)),
                    velocity_m_s: here.velocity_m_s.map(|x| x * (1.0 - by)),
                    rest_m: here.rest_m.map(|x| x * (1.0 + 2.0 * by)),
                    time_s: here.time_s * (1.0 + by),
                    mass_kg: here.mass_kg * (1.0 - by),
                    seed: here.seed,
                };
                program.evaluate(&inputs)
            };
            let (up, down) = (nudged(1e-6), nudged(-1e-6));
            for c in 0..3 {
                let tame = |of: &dyn Fn(&crate::spec::expression::Dual) -> f64| {
                    let (a, b, w) = (of(&up[c]), of(&down[c]), of(&want[c]));
                    ((a - w).abs() + (b - w).abs() < 1e-4 * (1.0 + w.abs()) && w.abs() < 1e6).then_some(w)
                };
                if let Some(w) = tame(&|d| d.value) {
                    compared += 1;
                    let g = f64::from(got[0][c]);
                    assert!((g - w).abs() < 2e-4 * (1.0 + w.abs()), "{}, component {c} at {here:?}: {g} and {w}", texts[number]);
                }
                for by in 0..6 {
                    if let Some(w) = tame(&|d| d.slope[by]).filter(|_| (up[c].value - want[c].value).abs() < 1e-4) {
                        let g = f64::from(got[1 + by][c]);
                        assert!((g - w).abs() < 2e-3 * (1.0 + w.abs()), "{}, slope {by} of {c} at {here:?}: {g} and {w}", texts[number]);
                    }
                }
            }
        }
    }
    assert!(compared > 3000 && undefined > 10, "{compared} compared, {undefined} undefined");
}

#[test]
fn the_change_of_velocity_on_the_device_is_that_of_the_cpu() {
    let texts = [
        "-3.5 * v",
        "-1e7 * (v - vec3(1, 2, 3))",
        "-1e6 * (x - x0) - 10 * v",
        "cross(vec3(0, 0, 30), v) - 0.5 * length(v) * v",
        "-40 * x / pow(dot(x, x) + 0.01, 1.5)",
        "vec3(1e20, 0, 0)",
        "vec3(sin(t), noise(x), random(seed))",
    ];
    let programs: Vec<Program> = texts.iter().map(|t| program(t)).collect();
    let places = places(64);
    let got = on_device(&programs, &places);
    for (number, program) in programs.iter().enumerate() {
        for (k, here) in places.iter().enumerate() {
            let want = velocity_change([program], here, 0.01);
            let got = Vec3::from_slice(&got[number * places.len() + k][7]).as_dvec3();
            assert!((got - want).length() < 1e-4 * (0.1 + want.length()), "{}: {got} and {want} at {here:?}", texts[number]);
        }
    }
}

#[test]
fn the_pass_follows_its_twin() {
    let mut particles = small(Vec3::ZERO);
    particles.object.iter_mut().enumerate().for_each(|(i, o)| *o = i as u32 % 2);
    for (i, v) in particles.velocity_m_s.iter_mut().enumerate() {
        *v = Vec3::new(i as f32 * 0.1, 1.0, -2.0);
    }
    let texts = ["vec3(6 * sin(3 * t), 0, 0) - 20 * (x - x0)", "-2 * v", "vec3(0, random(seed), mass)", "vec3(ln(-t), 0, 0)"];
    let mut settings = driven_by(&texts);
    settings.fields[1].object = 1;
    settings.fields[2].from_s = 0.5;
    let programs: Vec<Program> = texts.iter().map(|t| program(t)).collect();
    let mut solver = solver(settings, &particles);
    let seen = solver.look().expect("a look");
    solver.fit_window(seen.low, seen.high, 4).expect("a window");
    solver.set_surroundings();
    solver.ask_fields_at(0.0);
    solver.start_segment();
    let before = solver.states().expect("states");
    let bound = solver.bind_both().expect("bound");
    let substep = Substep { dt_s: 1e-3, dt_next_s: 1e-3, index: 0, job: 0, since_s: 0.25, lag: 0 };
    let mut recording = Recording::default();
    solver.record_fields(&bound[solver.current], &substep, &mut recording);
    Gpu::shared_for_tests().expect("a device").submit(&recording);
    let after = solver.states().expect("states");
    for (b, a) in before.iter().zip(&after) {
        let here = Inputs {
            position_m: b.position_m.as_dvec3().into(),
            velocity_m_s: b.velocity_m_s.as_dvec3().into(),
            rest_m: particles.position_m[b.index as usize].as_dvec3().into(),
            time_s: 0.2505,
            mass_kg: f64::from(b.mass_kg),
            seed: f64::from(own_number(b.index, 1)),
        };
        let fields = if b.object() == 0 { &programs[..1] } else { &programs[1..2] };
        let want = b.velocity_m_s.as_dvec3() + velocity_change(fields, &here, 1e-3);
        assert!((a.velocity_m_s.as_dvec3() - want).length() < 1e-6, "{} and {want}", a.velocity_m_s);
        assert_eq!((a.position_m, a.affine, a.deformation), (b.position_m, b.affine, b.deformation));
    }
    let watch = solver.look().expect("a look");
    assert!(watch.driven_m_s > 0.0);
    let mut report = Advance::default();
    go(&mut solver, 0.02);
    solver.report_fields(&mut report);
    assert_eq!(report.undefined[0].0, "field");
}

#[test]
fn drag_slows_exponentially_and_however_strong() {
    for (rate, span_s, tolerance) in [(5.0, 0.4, 0.01), (200.0, 0.01, 0.01)] {
        let mut solver = solver(driven_by(&[&format!("-{rate} * v")]), &small(Vec3::new(2.0, 0.0, 0.0)));
        go(&mut solver, span_s);
        let (v, expected) = (mean_velocity(&solver).x, 2.0 * (-rate * span_s).exp());
        assert!((v / expected - 1.0).abs() < tolerance, "{rate}: {v} and {expected}");
    }
    let mut solver = solver(driven_by(&["-1e8 * (v - vec3(0, 1, 0))"]), &small(Vec3::new(2.0, 0.0, 0.0)));
    let report = go(&mut solver, 0.1);
    assert_eq!(report.retries, 0);
    assert!((mean_velocity(&solver) - DVec3::Y).length() < 1e-3);
}

/// Seconds between the first and the last crossing of zero, over the number of half periods.
fn half_period_s(solver: &mut Solver, until_s: f64, step_s: f64) -> f64 {
    let mut crossings = Vec::new();
    let (mut before, mut k) = (centre_m(solver).x, 0);
    while solver.time_s() < until_s {
        k += 1;
        go(solver, f64::from(k) * step_s);
        let now = centre_m(solver).x;
        if before * now < 0.0 {
            crossings.push(f64::from(k) * step_s - step_s * f64::from(now / (now - before)));
        }
        before = now;
    }
    (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64
}

#[test]
fn a_spring_keeps_its_period_and_its_energy() {
    let mut particles = small(Vec3::ZERO);
    particles.position_m.iter_mut().for_each(|x| x.x += 0.1);
    let omega = 12.0f64;
    let mut solver = solver(driven_by(&[&format!("-{} * (x - (x0 - vec3(0.1, 0, 0)))", omega * omega)]), &particles);
    let half_s = half_period_s(&mut solver, 1.6, 0.01);
    let expected = std::f64::consts::PI / omega;
    assert!((half_s / expected - 1.0).abs() < 0.02, "{half_s} and {expected}");
    let energy = 0.5 * mean_velocity(&solver).length_squared() + 0.5 * omega * omega * f64::from(centre_m(&solver).x).powi(2);
    let start = 0.5 * omega * omega * 0.01;
    assert!((energy / start - 1.0).abs() < 0.03, "{energy} J/kg of {start}");
}

#[test]
fn no_spring_is_too_stiff() {
    for (stiffness, damping) in [(1e6, 0.0), (1e10, 0.0), (1e12, 1e4)] {
        let mut particles = small(Vec3::ZERO);
        particles.position_m.iter_mut().for_each(|x| x.x += 0.02);
        let mut solver = solver(driven_by(&[&format!("-{stiffness} * (x - (x0 - vec3(0.02, 0, 0))) - {damping} * v")]), &particles);
        go(&mut solver, 0.06);
        let x = centre_m(&solver).x;
        assert!(x.abs() < 0.03, "{stiffness}: at {x}");
    }
}

#[test]
fn a_constant_expression_is_the_constant_force() {
    let particles = small(Vec3::new(0.1, 0.0, 0.0));
    let push = ObjectForce { object: 0, from_s: 0.013, to_s: 0.07, acceleration_m_s2: Vec3::new(3.0, -2.0, 1.0) };
    let mut plain = solver(Settings { forces: vec![push], ..driven_by(&[]) }, &particles);
    let mut settings = driven_by(&["vec3(3, -2, 1)"]);
    (settings.fields[0].from_s, settings.fields[0].to_s) = (0.013, 0.07);
    let mut same = solver(settings, &particles);
    go(&mut plain, 0.1);
    go(&mut same, 0.1);
    for (a, b) in plain.states().expect("states").iter().zip(&same.states().expect("states")) {
        assert!((a.velocity_m_s - b.velocity_m_s).length() < 1e-5 && (a.position_m - b.position_m).length() < 1e-6);
    }
    let expected = Vec3::new(0.1, 0.0, 0.0) + push.acceleration_m_s2 * 0.057;
    assert!((mean_velocity(&same).as_vec3() - expected).length() < 1e-4);
}

#[test]
fn an_attractor_between_equal_bodies_gives_no_momentum() {
    let mut particles = small(Vec3::ZERO);
    particles.position_m.iter_mut().for_each(|x| x.x += 0.2);
    let mut other = small(Vec3::ZERO);
    other.position_m.iter_mut().for_each(|x| x.x -= 0.2);
    particles.position_m.extend(&other.position_m);
    for list in [&mut particles.volume_m3, &mut particles.density_kg_m3, &mut particles.young_pa, &mut particles.poisson] {
        list.extend_from_within(..);
    }
    particles.velocity_m_s.extend_from_within(..);
    particles.substance.extend_from_within(..);
    particles.object.extend_from_within(..);
    let mut solver = solver(driven_by(&["-2 * x / pow(dot(x, x) + 0.01, 1.5)"]), &particles);
    go(&mut solver, 0.1);
    let states = solver.states().expect("states");
    let half = states.len() / 2;
    let one = states[..half].iter().map(|s| s.velocity_m_s.as_dvec3()).sum::<DVec3>() / half as f64;
    let both = mean_velocity(&solver);
    assert!(one.x < -0.3 && both.length() < 1e-4 * one.length(), "{one} and {both}");
}

#[test]
fn runs_with_fields_repeat_and_resume_to_the_same_bits_and_only_know_the_past() {
    let texts = ["-2 * v + vec3(3 * sin(20 * t), noise(x * 10), random(seed + floor(t * 100)))", "-900 * (x - x0)"];
    let mut settings = driven_by(&texts);
    settings.fields[1].from_s = 0.033;
    let particles = small(Vec3::new(1.0, 0.0, 0.5));
    let mut first = solver(settings.clone(), &particles);
    go(&mut first, 0.06);
    let kept = first.checkpoint().expect("a checkpoint");
    go(&mut first, 0.1);
    let end = first.checkpoint().expect("a checkpoint");
    let mut second = solver(settings.clone(), &particles);
    go(&mut second, 0.1);
    assert!(end == second.checkpoint().expect("a checkpoint"), "a second run differs");
    let mut third = solver(settings.clone(), &particles);
    third.restore(&kept).expect("a restore");
    go(&mut third, 0.1);
    assert!(end == third.checkpoint().expect("a checkpoint"), "a resumed run differs");
    // What begins at 0.06 s changes nothing before.
    settings.fields.push(Field { from_s: 0.06, ..field("vec3(100, 0, 0)") });
    let mut later = solver(settings, &particles);
    go(&mut later, 0.06);
    assert!(kept == later.checkpoint().expect("a checkpoint"), "the future shows");
}

#[test]
fn what_is_no_number_is_counted_and_what_is_too_fast_is_held() {
    let mut broken = solver(driven_by(&["vec3(1 / (x.x - x.x), 0, 0)", "vec3(0, 1, 0)"]), &small(Vec3::ZERO));
    let report = go(&mut broken, 0.02);
    assert_eq!(report.undefined, [("field".to_owned(), report.substeps * 64)]);
    assert!((mean_velocity(&broken).y - 0.02).abs() < 1e-5, "the other field acts");
    let mut wild = solver(driven_by(&["vec3(1e20, 0, 0)"]), &small(Vec3::ZERO));
    let report = go(&mut wild, 0.01);
    assert!(report.limited > 0 && mean_velocity(&wild).x <= 200.1, "{report:?}");
    let mut sudden = solver(driven_by(&["if(t > 0.013, vec3(1e5, 0, 0), vec3(0))"]), &small(Vec3::ZERO));
    go(&mut sudden, 0.014);
    assert!((mean_velocity(&sudden).x - 100.0).abs() < 10.0, "{}", mean_velocity(&sudden));
}

#[test]
fn a_pin_takes_its_part_along_a_path() {
    let plane = PlaneShape { point_m: [0.0, 0.0, -0.02], normal: [0.0, 0.0, 1.0] };
    let path = vec![[0.1, 0.05, 0.0, 0.0], [0.2, 0.05, 0.1, 0.0]];
    let pin = PinRegion {
        object: 0,
        shape: ColliderShape::Plane(plane),
        low_m: Vec3::splat(-0.05),
        high_m: Vec3::splat(0.05),
        from_s: 0.0,
        to_s: 1.0,
        path,
    };
    let particles = small(Vec3::ZERO);
    let mut solver = solver(Settings { pins: vec![pin], ..driven_by(&[]) }, &particles);
    let held: Vec<usize> = (0..particles.len()).filter(|&i| particles.position_m[i].z < -0.03).collect();
    for (time_s, expected) in [(0.06, Vec3::new(0.03, 0.0, 0.0)), (0.15, Vec3::new(0.05, 0.05, 0.0)), (0.3, Vec3::new(0.05, 0.1, 0.0))] {
        go(&mut solver, time_s);
        let states = solver.states().expect("states");
        for &i in &held {
            let moved = states[i].position_m - particles.position_m[i];
            assert!((moved - expected).length() < 1e-3, "{moved} and {expected} at {time_s} s");
        }
    }
    let top = centre_m(&solver);
    assert!((top - Vec3::new(0.05, 0.1, 0.0)).length() < 0.03, "the rest follows: {top}");
}
