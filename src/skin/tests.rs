//! V27: skinning under rigid and affine motion, at rest, and where the motion is broken; the
//! device against the twin.

use super::body::twin as body_twin;
use super::skinner::{FADES, PART, SMALLEST_DETERMINANT, centre, span_m};
use super::twin::covariance_of as covariance;
use super::*;
use crate::gpu::{Gpu, Recording};
use crate::scene::{Gaussians, morton_order};
use crate::spec::{Skin, Weights};
use glam::{Mat3, Quat, Vec3};

/// A body of particles on a jittered lattice of 3 cm, and Gaussians in and a little around it; every
/// tenth Gaussian is static.
struct Body {
    gpu: Gpu,
    particles: Vec<Vec3>,
    object: Vec<u32>,
    scene: Gaussians,
    splats: Splats,
}

const PLACE: Vec3 = Vec3::new(0.5, -0.25, 1.0);

fn noise(i: usize, salt: usize) -> f32 {
    let x = (i * 2_654_435_761 + salt * 40_503_773) % 1_000_003;
    ((x * x) % 1_000_003) as f32 / 1_000_003.0
}

fn body() -> Body {
    let gpu = Gpu::shared_for_tests().unwrap();
    let lattice = |i: usize| Vec3::new((i % 9) as f32, (i / 9 % 9) as f32, (i / 81) as f32) * 0.03;
    let particles: Vec<Vec3> = (0..729).map(|i| PLACE + lattice(i) + Vec3::new(noise(i, 1), noise(i, 2), noise(i, 3)) * 0.01).collect();
    let mut mean: Vec<Vec3> = (0..3000).map(|i| PLACE + Vec3::new(noise(i, 4), noise(i, 5), noise(i, 6)) * 0.28 - 0.01).collect();
    mean = morton_order(&mean).into_iter().map(|i| mean[i as usize]).collect();
    let count = mean.len();
    let scene = Gaussians {
        scale: (0..count).map(|i| Vec3::new(0.002 + 0.02 * noise(i, 7), 0.004, 0.01)).collect(),
        rotation: (0..count).map(|i| [noise(i, 8), noise(i, 9) - 0.5, 0.3, noise(i, 10)]).collect(),
        opacity: (0..count).map(|i| noise(i, 11)).collect(),
        sh_degree: 0,
        sh: vec![0.1; count * 3],
        mean,
    };
    let object: Vec<u32> = (0..count).map(|i| if i % 10 == 3 { STATIC } else { 0 }).collect();
    let splats = Splats::new(&gpu, &scene, Quat::from_rotation_x(0.4), &object).unwrap();
    Body { gpu, particles, object, scene, splats }
}

impl Body {
    fn bound(&self, neighbours: u32, weights: Weights) -> Bound {
        bind(&self.scene.mean, &self.object, &self.particles, &vec![0; self.particles.len()], &Skin { neighbours, weights })
    }

    fn rest(&self) -> Vec<[f32; 16]> {
        self.gpu.read(&self.splats.rest, self.scene.len()).unwrap()
    }

    /// What the device makes of a motion given for each particle.
    fn on_device(&self, bound: &Bound, weights: Weights, motion: &[[u32; 8]]) -> Vec<[f32; 16]> {
        let skinner = Skinner::new(&self.gpu, &self.splats, bound, &self.particles, weights).unwrap();
        let motion = self.gpu.storage_from("motion", motion).unwrap();
        let mut recording = Recording::default();
        skinner.record(&motion, &mut recording);
        self.gpu.submit(&recording);
        self.gpu.read(&self.splats.geometry, self.scene.len()).unwrap()
    }

    /// The same, ready for what keeps no shape: captured Gaussians, then those of the particles, and their colours.
    fn filled_on_device(&self, bound: &Bound, filling: &Filling, motion: &[[u32; 8]]) -> (Vec<[f32; 16]>, Vec<[f32; 4]>) {
        let object = [self.object.as_slice(), &vec![0; self.particles.len() * filling.grains as usize]].concat();
        let splats = Splats::new(&self.gpu, &self.scene, Quat::IDENTITY, &object).unwrap();
        let mut skinner = Skinner::new(&self.gpu, &splats, bound, &self.particles, Weights::Exact).unwrap();
        skinner.fill(&splats, filling).unwrap();
        let motion = self.gpu.storage_from("motion", motion).unwrap();
        let mut recording = Recording::default();
        // Twice: the keys are left as they were found.
        (0..2).for_each(|_| skinner.record(&motion, &mut recording));
        self.gpu.submit(&recording);
        (self.gpu.read(&splats.geometry, object.len()).unwrap(), self.gpu.read(&splats.sh, object.len()).unwrap())
    }

    fn filling(&self) -> Filling {
        let volume_m3: Vec<f32> = (0..self.particles.len()).map(|i| 2.7e-5 * (0.7 + 0.3 * noise(i, 12))).collect();
        Filling::new(&self.scene, &self.object, &self.particles, &volume_m3, &vec![0; self.particles.len()])
    }

    /// The same on the twin, from the same words.
    fn on_twin(&self, bound: &Bound, weights: Weights, motion: &[[u32; 8]]) -> Vec<[f32; 16]> {
        let origin = centre(&self.particles);
        let deltas: Vec<_> = motion.iter().zip(&self.particles).map(|(&m, &p)| twin::delta(m, p, origin, weights)).collect();
        self.rest().iter().enumerate().map(|(g, rest)| twin::blend(rest, g, bound, &deltas, self.frame(bound), weights)).collect()
    }

    fn frame(&self, bound: &Bound) -> twin::Frame {
        twin::Frame { origin: centre(&self.particles), span_m: span_m(bound, &self.particles) }
    }

    /// Every particle carried by x -> a x + b.
    fn affine(&self, a: Mat3, b: Vec3) -> Vec<[u32; 8]> {
        self.particles.iter().map(|&p| twin::pack_motion(a * p + b, a - Mat3::IDENTITY)).collect()
    }
}

fn largest_difference(a: &[[f32; 16]], b: &[[f32; 16]], floats: std::ops::Range<usize>) -> f32 {
    a.iter().zip(b).flat_map(|(a, b)| floats.clone().map(move |f| (a[f] - b[f]).abs())).fold(0.0, f32::max)
}

#[test]
fn at_rest_every_bit_is_the_captured_pose() {
    let body = body();
    let motion = body.affine(Mat3::IDENTITY, Vec3::ZERO);
    for (weights, k) in [(Weights::Exact, 8), (Weights::Paper, 8), (Weights::Exact, 5), (Weights::Exact, 16)] {
        let bound = body.bound(k, weights);
        // Something else first, so that what is found is written and not left over.
        body.on_device(&bound, weights, &body.affine(Mat3::from_rotation_z(0.5), Vec3::X));
        let drawn = body.on_device(&bound, weights, &motion);
        assert_eq!(bytemuck::cast_slice::<_, u32>(&drawn), bytemuck::cast_slice::<_, u32>(&body.rest()), "{weights:?} K = {k}");
    }
}

#[test]
fn carried_along_without_turning_shapes_stay_to_the_bit() {
    let body = body();
    let bound = body.bound(8, Weights::Exact);
    let drawn = body.on_device(&bound, Weights::Exact, &body.affine(Mat3::IDENTITY, Vec3::new(0.3, 2.0, -0.7)));
    for ((drawn, rest), object) in drawn.iter().zip(body.rest()).zip(&body.object) {
        assert_eq!(drawn[3..], rest[3..]);
        let moved = Vec3::from_slice(drawn) - Vec3::from_slice(&rest);
        let expected = if *object == STATIC { Vec3::ZERO } else { Vec3::new(0.3, 2.0, -0.7) };
        assert!((moved - expected).length() < 1e-6);
    }
}

/// V27 on the device, with maps that halves hold exactly, so that what is measured is skinning.
#[test]
fn v27_rotations_and_affine_maps_are_exact_on_the_device() {
    let body = body();
    let shear = Mat3::from_cols_array(&[1.25, 0.125, 0.0, -0.5, 0.75, 0.25, 0.0, -0.125, 1.5]);
    let quarter = Mat3::from_cols_array(&[0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let half = Mat3::from_cols_array(&[-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0]);
    let bound = body.bound(8, Weights::Exact);
    for a in [quarter, half, shear] {
        let b = Vec3::new(0.1, 0.2, 0.3);
        check_affine(&body, &body.on_device(&bound, Weights::Exact, &body.affine(a, b)), a, b);
    }
}

/// A thread goes with what it hangs on, and turns with it; what that stretches by does not tear it, however long the thread.
#[test]
fn threads_turn_with_what_holds_them_and_keep_their_shape() {
    let body = body();
    let held = PLACE + 0.1;
    let mut means = body.scene.mean.clone();
    let hung: Vec<(u32, Vec3)> = (0..3000).filter(|g| g % 10 == 7).map(|g| (g, held)).collect();
    hung.iter().for_each(|&(g, at)| means[g as usize] = at);
    let skin = Skin { neighbours: 8, weights: Weights::Exact };
    let bound = Bound { hung, ..bind(&means, &body.object, &body.particles, &vec![0; body.particles.len()], &skin) };
    let quarter = Mat3::from_cols_array(&[0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let stretch = Mat3::from_diagonal(Vec3::new(2.0, 0.5, 1.5));
    let motion = body.affine(quarter * stretch, Vec3::X);
    let drawn = body.on_device(&bound, Weights::Exact, &motion);
    let rest = body.rest();
    for &(g, _) in &bound.hung {
        let (drawn, rest) = (&drawn[g as usize], &rest[g as usize]);
        let expected = quarter * (stretch * held) + Vec3::X + quarter * (Vec3::from_slice(rest) - held);
        assert!((Vec3::from_slice(drawn) - expected).length() < 1e-5, "{} is not at {expected}", Vec3::from_slice(drawn));
        let turned = quarter * covariance(rest) * quarter.transpose();
        assert!((covariance(drawn) - turned).abs_diff_eq(Mat3::ZERO, 1e-8));
    }
    let twin = body.on_twin(&bound, Weights::Exact, &motion);
    assert!(largest_difference(&drawn, &twin, 0..3) < 1e-5 && largest_difference(&drawn, &twin, 4..10) < 1e-7);
}

/// V27 on the twin, with any rotation, the motion in full precision.
#[test]
fn v27_any_rotation_is_exact() {
    let body = body();
    let (bound, origin, rest) = (body.bound(8, Weights::Exact), centre(&body.particles), body.rest());
    for i in 0..12 {
        let axis = Vec3::new(noise(i, 20) - 0.5, noise(i, 21) - 0.5, noise(i, 22) - 0.5).normalize();
        let (a, b) = (Mat3::from_axis_angle(axis, 0.55 * i as f32), Vec3::new(noise(i, 23), 0.0, -1.0));
        let deltas: Vec<_> = body.particles.iter().map(|&p| twin::of(a * p + b, a - Mat3::IDENTITY, p, origin, Weights::Exact)).collect();
        let drawn: Vec<_> = (0..rest.len()).map(|g| twin::blend(&rest[g], g, &bound, &deltas, body.frame(&bound), Weights::Exact)).collect();
        check_affine(&body, &drawn, a, b);
    }
}

/// Centres to 1e-5 m, covariances to 1e-6 of their size, and the same colour from a camera that goes along.
fn check_affine(body: &Body, drawn: &[[f32; 16]], a: Mat3, b: Vec3) {
    let r = twin::polar_rotation(a);
    for ((drawn, rest), object) in drawn.iter().zip(body.rest()).zip(&body.object) {
        if *object == STATIC {
            assert_eq!(*drawn, rest);
            continue;
        }
        let c = Vec3::from_slice(&rest);
        let off = (Vec3::from_slice(drawn) - (a * c + b)).length();
        assert!(off < 1e-5, "centre {c} is off by {off}");
        let expected = a * covariance(&rest) * a.transpose();
        let scale = expected.to_cols_array().iter().fold(0.0f32, |m, v| m.max(v.abs()));
        assert!(covariance(drawn).abs_diff_eq(expected, 2e-6 * scale), "covariance at {c}");
        // The direction in which spherical harmonics are looked up does not change.
        let view = Vec3::new(0.6, -0.64, 0.48);
        let before = Quat::from_slice(&rest[12..]).inverse() * view;
        let after = Quat::from_slice(&drawn[12..]).inverse() * (r * view);
        assert!((before - after).length() < 2e-6, "view {before} became {after}");
    }
}

#[test]
fn the_papers_equations_are_as_printed() {
    let body = body();
    let bound = body.bound(8, Weights::Paper);
    let quarter = Mat3::from_cols_array(&[0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let drawn = body.on_device(&bound, Weights::Paper, &body.affine(quarter, Vec3::ZERO));
    let rest = body.rest();
    let mut farthest = 0.0f32;
    for g in (0..rest.len()).filter(|&g| body.object[g] != STATIC) {
        let c = Vec3::from_slice(&rest[g]);
        let displaced: Vec3 = (0..8)
            .map(|s| {
                let p = body.particles[bound.index[g * 8 + s] as usize];
                (quarter * p - p) * bound.weight[g * 8 + s]
            })
            .sum();
        assert!((Vec3::from_slice(&drawn[g]) - (c + displaced)).length() < 2e-6);
        assert!(covariance(&drawn[g]).abs_diff_eq(quarter * covariance(&rest[g]) * quarter.transpose(), 1e-9));
        farthest = farthest.max((Vec3::from_slice(&drawn[g]) - quarter * c).length());
    }
    // Where they are not exact: off by up to the offset between a Gaussian and its particles' mean.
    assert!(farthest > 1e-3, "{farthest}");
}

#[test]
fn the_device_agrees_with_the_twin() {
    let body = body();
    for (weights, k) in [(Weights::Exact, 8), (Weights::Paper, 8), (Weights::Exact, 3), (Weights::Exact, 13)] {
        let bound = body.bound(k, weights);
        let motion: Vec<_> = body
            .particles
            .iter()
            .map(|&p| {
                // A twist with squeezing beyond the limits of stretch in places.
                let a = Mat3::from_rotation_z(9.0 * (p.z - 1.0)) * Mat3::from_diagonal(Vec3::new(1.0 + 14.0 * (p.x - 0.5), 0.8, 1.1));
                twin::pack_motion(a * (p - PLACE) + PLACE, a - Mat3::IDENTITY)
            })
            .collect();
        let (device, twin) = (body.on_device(&bound, weights, &motion), body.on_twin(&bound, weights, &motion));
        let differences = [0..4, 4..12, 12..16].map(|floats| largest_difference(&device, &twin, floats));
        let allowed = [2e-6, 2e-7, 2e-5];
        assert!(differences.iter().zip(allowed).all(|(d, a)| *d < a), "{weights:?} K = {k}: {differences:?} of {allowed:?}");
    }
}

/// Cut in two, one half carried away: no Gaussian is left hanging between, and far from the cut all
/// goes as before.
#[test]
fn what_parts_takes_its_gaussians_along() {
    let body = body();
    let bound = body.bound(8, Weights::Exact);
    let away = Vec3::new(0.5, 0.0, 0.2);
    let cut_x = PLACE.x + 0.13;
    let shift = |p: Vec3| if p.x > cut_x { away } else { Vec3::ZERO };
    let motion: Vec<_> = body.particles.iter().map(|&p| twin::pack_motion(p + shift(p), Mat3::ZERO)).collect();
    let drawn = body.on_device(&bound, Weights::Exact, &motion);
    let rest = body.rest();
    for g in (0..rest.len()).filter(|&g| body.object[g] != STATIC) {
        let moved = Vec3::from_slice(&drawn[g]) - Vec3::from_slice(&rest[g]);
        let nearest = body.particles[bound.index[g * 8] as usize];
        assert!((moved - shift(nearest)).length() < 2e-6, "Gaussian {g} moved by {moved}");
    }
    assert!(away.length() > PART[1] * span_m(&bound, &body.particles));
    let twin = body.on_twin(&bound, Weights::Exact, &motion);
    assert!(largest_difference(&drawn, &twin, 0..16) < 2e-6);
}

#[test]
fn stretch_is_limited_and_rotation_stays_a_rotation() {
    let body = body();
    let bound = body.bound(8, Weights::Exact);
    let turn = Mat3::from_rotation_y(1.0);
    let flat = turn * Mat3::from_diagonal(Vec3::new(6.0, 0.02, 1.0));
    let drawn = body.on_device(&bound, Weights::Exact, &body.affine(flat, Vec3::ZERO));
    let held = turn * Mat3::from_diagonal(Vec3::new(3.0, 0.3, 1.0));
    for ((drawn, rest), _) in drawn.iter().zip(body.rest()).zip(&body.object).filter(|(_, object)| **object != STATIC) {
        let expected = held * covariance(&rest) * held.transpose();
        let size = expected.to_cols_array().iter().fold(0.0f32, |m, v| m.max(v.abs()));
        assert!(covariance(drawn).abs_diff_eq(expected, 2e-3 * size));
    }
}

#[test]
fn broken_motion_never_reaches_a_gaussian() {
    let body = body();
    let bound = body.bound(8, Weights::Exact);
    let mut motion = body.affine(Mat3::from_rotation_x(0.3), Vec3::ZERO);
    for (i, words) in motion.iter_mut().enumerate() {
        match i % 7 {
            0 => words[0] = f32::NAN.to_bits(),
            2 => words[4] = 0x7c00_7e01,
            4 => *words = twin::pack_motion(body.particles[i], Mat3::from_diagonal(Vec3::new(-2.0, 0.0, 0.0))),
            5 => *words = twin::pack_motion(body.particles[i], -Mat3::IDENTITY),
            _ => {}
        }
    }
    let drawn = body.on_device(&bound, Weights::Exact, &motion);
    assert!(drawn.iter().flatten().all(|v| v.is_finite()));
    assert!(drawn.iter().all(|r| (Quat::from_slice(&r[12..]).length() - 1.0).abs() < 1e-4));
    let flat = twin::polar_rotation(Mat3::from_diagonal(Vec3::new(SMALLEST_DETERMINANT, 1.0, 1.0)));
    assert!(flat.abs_diff_eq(Mat3::IDENTITY, 1e-5));
}

#[test]
fn a_scene_without_particles_is_left_alone() {
    let body = body();
    let bound = bind(&body.scene.mean, &body.object, &[], &[], &Skin::default());
    let skinner = Skinner::new(&body.gpu, &body.splats, &bound, &[], Weights::Exact).unwrap();
    let mut recording = Recording::default();
    skinner.record(&body.splats.rest, &mut recording);
    assert!(recording.steps.is_empty());
}

#[test]
fn shaders_are_valid_and_their_layouts_are_ours() {
    for source in kernels() {
        let module =
            naga::front::wgsl::parse_str(&source.wgsl()).unwrap_or_else(|e| panic!("{}: {}", source.label, e.emit_to_string(&source.wgsl())));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all()).validate(&module).unwrap();
        let size = |name: &str| {
            let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name));
            found.map(|(_, ty)| ty.inner.size(module.to_ctx()))
        };
        assert_eq!(size("Immediates"), Some(source.immediate_bytes));
        assert!(size("Delta").is_none_or(|bytes| bytes == 48));
    }
    assert!(shader_text().contains("skin/blend.wgsl"));
}

#[test]
fn the_benchmark_measures_something() {
    let samples = bench_skin(&Gpu::shared_for_tests().unwrap(), 2000, 300).unwrap();
    assert!(samples.windows(2).all(|pair| pair[0] <= pair[1]) && samples[0] > 0.0);
}

/// A body that pours: its lower half stays, its upper half flies apart and lands in a sheet.
#[test]
fn what_keeps_no_shape_follows_the_twin() {
    let body = body();
    let (bound, mut filling) = (body.bound(8, Weights::Exact), body.filling());
    filling.grains = 2;
    // Liquids of all kinds, from clear to thick.
    filling.dye.iter_mut().enumerate().for_each(|(i, dye)| dye[3] = [0.0, 0.5, 1.0][i % 3]);
    let poured = |i: usize, p: Vec3| {
        if p.z < PLACE.z + 0.12 { p } else { PLACE + Vec3::new(noise(i, 31) * 0.8, noise(i, 32) * 0.8, -0.02 + 0.01 * noise(i, 33)) }
    };
    let places: Vec<Vec3> = body.particles.iter().enumerate().map(|(i, &p)| poured(i, p)).collect();
    let mut motion: Vec<[u32; 8]> = places.iter().map(|&p| twin::pack_motion(p, Mat3::IDENTITY * 0.1)).collect();
    let captured = body.scene.len();
    let (plain, _) = body.filled_on_device(&bound, &filling, &motion);
    // What keeps its shape does so, whatever becomes of it, and its particles are not seen.
    assert!(plain[captured..].iter().all(|record| record[3] == 0.0));
    assert!(plain.iter().zip(&body.scene.opacity).all(|(record, opacity)| record[3] == *opacity));
    // Every fourth keeps its shape, the others flow in each of the three ways.
    let flow: Vec<u32> = (0..places.len() as u32).map(|i| i * 7 / 5 % 4).collect();
    for (words, flow) in motion.iter_mut().zip(&flow) {
        words[7] |= u32::from(half::f16::from_f32(*flow as f32).to_bits()) << 16;
    }
    let (drawn, colour) = body.filled_on_device(&bound, &filling, &motion);

    let (rest, mut gone) = (body.rest(), 0);
    for g in (0..captured).filter(|&g| body.object[g] != STATIC) {
        let nearest = bound.index[g * 8] as usize;
        let parted = if flow[nearest] > 0 { body_twin::parted(&filling, &places, flow[nearest], nearest) } else { 0.0 };
        let share = 1.0 - twin::smoothstep(FADES, parted);
        gone += usize::from(share == 0.0);
        assert!((drawn[g][3] - rest[g][3] * share).abs() < 1e-5 && drawn[g][4..12] == plain[g][4..12]);
    }
    let (mut seen, mut astray) = (0, 0);
    for i in 0..places.len() {
        let all = body_twin::all_drawn(&filling, &places, &flow, i);
        let slot = i % 2;
        let at = captured + slot * places.len() + i;
        let got = drawn[at];
        let Some(&(want, tint)) = all.get(slot) else {
            assert_eq!(got[3], 0.0);
            continue;
        };
        seen += 1;
        let size = want[4] + want[7] + want[9];
        assert!((0..4).all(|k| (got[k] - want[k]).abs() < [1e-5, 1e-3][k / 3]), "{i}: {got:?} instead of {want:?}");
        assert!(got[10] == want[10] && (got[11] / want[11] - 1.0).abs() < 1e-3 && Vec3::from_slice(&colour[at]).abs_diff_eq(tint, 1e-3), "{i}");
        // A sheet has two sides, neither of which is the front; where the way out lies in it, a hair decides which.
        let (way, wanted) = (Vec3::from_slice(&got[12..]), Vec3::from_slice(&want[12..]));
        let turned = (way - wanted).length().min((way + wanted).length()) > 5e-3;
        astray += usize::from(turned || (4..10).any(|k| (got[k] - want[k]).abs() > 2e-3 * size));
    }
    assert!(astray * 50 < seen, "{astray} of {seen} are astray");
    assert!(gone > 200 && seen > 150, "{gone} are gone, {seen} are seen");
}
