//! What the rule promises, of its twin; the device against the twin is in `skin::tests`.

use super::twin::{Drawn, all_drawn, drawn, principal};
use super::{ASTRAY, BESIDE, DROP, FLAT, FREE_M, Filling, GRAIN, GRAINS, LOOSEST, OPACITY, RADIUS, SH_FIRST, TONE};
use crate::scene::Gaussians;
use glam::{Mat3, Vec3};

const SIZE_M: f32 = 0.01;
/// Display-referred.
const DARK: f32 = 0.2;
const BRIGHT: f32 = 0.8;

fn lattice(counts: [usize; 3], spacing_m: f32) -> Vec<Vec3> {
    let at = |i: usize| Vec3::new((i % counts[0]) as f32, (i / counts[0] % counts[1]) as f32, (i / counts[0] / counts[1]) as f32);
    (0..counts.iter().product()).map(|i| at(i) * spacing_m).collect()
}

/// One captured Gaussian at each particle, the left half dark, the right half bright.
fn filling(rest_m: &[Vec3]) -> Filling {
    let count = rest_m.len();
    let middle = rest_m.iter().map(|p| p.x).sum::<f32>() / count as f32;
    let gaussians = Gaussians {
        mean: rest_m.to_vec(),
        scale: vec![Vec3::splat(0.003); count],
        rotation: vec![[1.0, 0.0, 0.0, 0.0]; count],
        opacity: vec![0.9; count],
        sh_degree: 0,
        sh: rest_m.iter().flat_map(|p| [if p.x < middle { -1.0 } else { 1.0 }; 3]).collect(),
    };
    Filling::new(&gaussians, &vec![0; count], rest_m, &vec![SIZE_M.powi(3); count], &vec![0; count])
}

/// Particles that were far from each other and have come to `places`, dark and bright by turns: all have parted.
fn poured(places: &[Vec3], flow: u32) -> Vec<Drawn> {
    let mut filling = filling(&places.iter().map(|&p| p * 0.1).collect::<Vec<_>>());
    filling.spacing_m = SIZE_M;
    for (i, tint) in filling.tint.iter_mut().enumerate() {
        let tone = [DARK, BRIGHT][i % 2];
        *tint = [tone, tone, tone, SIZE_M];
    }
    filling.dye = filling.tint.clone();
    filling.rest_m.iter_mut().for_each(|p| *p = Vec3::ZERO);
    let far: Vec<u32> = (0..places.len()).flat_map(|i| [((i + places.len() / 2) % places.len()) as u32; BESIDE as usize]).collect();
    filling.beside = far;
    (0..places.len()).map(|i| drawn(&filling, places, &vec![flow; places.len()], i).unwrap()).collect()
}

/// Lengths of the axes over the particle's radius, descending, and the least one.
fn axes(drawn: &Drawn) -> ([f32; 3], Vec3) {
    let [xx, xy, xz, yy, yz, zz] = [drawn.0[4], drawn.0[5], drawn.0[6], drawn.0[7], drawn.0[8], drawn.0[9]];
    let (values, _, least) = principal(Mat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]));
    (values.map(|v| v.sqrt() / (RADIUS * SIZE_M)), least)
}

#[test]
fn nothing_is_drawn_until_particles_part() {
    let rest = lattice([6, 6, 6], SIZE_M);
    let filling = filling(&rest);
    let turn = Mat3::from_rotation_x(1.0);
    for map in [Mat3::IDENTITY, turn, turn * 1.1] {
        let places: Vec<Vec3> = rest.iter().map(|&p| map * p).collect();
        assert!((0..rest.len()).all(|i| drawn(&filling, &places, &[3; 216], i).is_none()));
    }
    let places: Vec<Vec3> = rest.iter().map(|&p| p * 3.0).collect();
    assert!((0..rest.len()).all(|i| drawn(&filling, &places, &[3; 216], i).is_some_and(|(record, _)| record[3] > 0.3)));
    assert!((0..rest.len()).all(|i| drawn(&filling, &places, &[0; 216], i).is_none()), "what keeps its shape is not drawn as particles");
}

#[test]
fn colours_and_sizes_come_from_what_is_nearest() {
    let filling = filling(&lattice([5, 5, 5], SIZE_M));
    assert!((filling.spacing_m - SIZE_M).abs() < 1e-6 && filling.tint.iter().all(|tint| (tint[3] - SIZE_M).abs() < 1e-6));
    for (i, tint) in filling.tint.iter().enumerate() {
        let side = (i % 5) as f32 - 2.0;
        assert!((tint[0] - 0.5) * side >= 0.1 * side.abs() - 1e-6, "{i}: {tint:?}");
        let beside = &filling.beside[i * BESIDE as usize..(i + 1) * BESIDE as usize];
        assert!(beside.iter().all(|&j| j != i as u32));
    }
}

#[test]
fn a_body_is_even_inside_and_has_a_skin() {
    let places = lattice([11, 11, 11], SIZE_M);
    let all = poured(&places, 3);
    let ([a, _, c], _) = axes(&all[5 * 121 + 60]);
    assert!(a < 1.05 && c > 0.95, "inside it is a ball: {a} {c}");
    let top = &all[10 * 121 + 60];
    let normal = Vec3::from_slice(&top.0[12..]);
    assert!(normal.z > 0.9, "the way out: {normal}");
    let ([a, b, c], least) = axes(top);
    assert!(a < 1.3 && b > 1.1 && c < 0.9 && least.z.abs() > 0.99, "flat along the surface: {a} {b} {c}");
    assert!(Vec3::from_slice(&all[5 * 121 + 60].0[12..]).length() < 0.1, "inside there is no way out");
    // Black and white are stirred together.
    let seen = all[5 * 121 + 60].1 * SH_FIRST + 0.5;
    // Dark and bright by turns, seen from afar.
    let evenly = (0.5 * (DARK * DARK + BRIGHT * BRIGHT)).sqrt();
    assert!((seen.x - evenly).abs() < 0.03, "{seen} of {evenly}");
    // And what is drawn is as large as what is there: where a Gaussian falls to a half.
    let half = (2.0 * (f64::from(OPACITY) / 0.5).ln()).sqrt() * f64::from(RADIUS);
    let ball = 4.0 / 3.0 * std::f64::consts::PI * half.powi(3);
    assert!((ball - 1.0).abs() < 0.06, "a ball of {ball} volumes");
}

#[test]
fn a_sheet_that_spreads_stays_covered_and_thins_until_it_breaks_into_drops() {
    for stretch in [1.0, 1.3, 1.6, 2.2] {
        let places = lattice([15, 15, 1], SIZE_M * stretch);
        let ([a, b, c], least) = axes(&poured(&places, 3)[112]);
        assert!((a / (stretch * FLAT) - 1.0).abs() < 0.2 && b > 0.95 * a, "stretched by {stretch}: {a} {b} {c}");
        assert!(a * b * c < 1.6 && least.z.abs() > 0.99, "no matter is made: {a} {b} {c}");
    }
    let ([a, _, c], _) = axes(&poured(&lattice([15, 15, 1], SIZE_M * 6.0), 3)[112]);
    assert!(a < 1.01 && c > 0.99, "drops: {a} {c}");
}

#[test]
fn a_thread_is_long_and_thin() {
    for stretch in [1.0, 1.4] {
        let ([a, b, c], _) = axes(&poured(&lattice([15, 1, 1], SIZE_M * stretch), 3)[7]);
        assert!((a / stretch - 1.0).abs() < 0.25 && a * b * c < 1.2 && b < 1.01, "stretched by {stretch}: {a} {b} {c}");
    }
}

#[test]
fn grains_stay_round_and_themselves() {
    let all = poured(&lattice([7, 7, 7], SIZE_M), 1);
    for (i, grain) in all.iter().enumerate() {
        let ([a, _, c], _) = axes(grain);
        assert!((a / c - 1.0).abs() < 1e-3 && (GRAINS[0] - 1e-3..GRAINS[1] + 1e-3).contains(&(a / GRAIN)), "{a} {c}");
        let astray = Vec3::from_slice(&grain.0) - lattice([7, 7, 7], SIZE_M)[i];
        assert!(astray.length() <= 3.0f32.sqrt() * ASTRAY * LOOSEST * SIZE_M + 1e-6, "{astray}");
        let tone = (grain.1.x * SH_FIRST + 0.5) / [DARK, BRIGHT][i % 2];
        assert!(grain.0[11] == 1.0 && (tone - 1.0).abs() <= TONE + 1e-4, "a grain keeps its colour, but for a tone, and does not shine: {tone}");
    }
}

#[test]
fn several_grains_of_a_particle_have_its_volume_together() {
    let places = lattice([7, 7, 7], SIZE_M);
    let mut filling = filling(&places);
    filling.rest_m.iter_mut().for_each(|p| *p = Vec3::ZERO);
    let volume = |filling: &Filling| -> f32 {
        let all = (0..places.len()).flat_map(|i| all_drawn(filling, &places, &vec![1; places.len()], i));
        all.map(|grain| axes(&grain).0[0].powi(3)).sum()
    };
    let one = volume(&filling);
    filling.grains = 3;
    assert!((volume(&filling) / one - 1.0).abs() < 0.05);
    let grains = all_drawn(&filling, &places, &vec![1; places.len()], 171);
    assert!(grains.len() == 3 && grains.iter().all(|a| grains.iter().filter(|b| a.0[..3] == b.0[..3]).count() == 1), "each at a place of its own");
}

#[test]
fn a_clear_liquid_dims_by_its_depth() {
    // As deep at every spacing: what passes through all layers of a block is the same.
    for finer in [1, 2] {
        let size_m = SIZE_M / finer as f32;
        let places = lattice([5 * finer, 5 * finer, 5 * finer], size_m);
        let mut filling = filling(&places);
        filling.spacing_m = size_m;
        filling.rest_m.iter_mut().for_each(|p| *p = Vec3::ZERO);
        filling.tint.iter_mut().for_each(|tint| tint[3] = size_m);
        filling.dye.iter_mut().for_each(|dye| dye[3] = 1.0);
        let middle = places.len() / 2;
        let (record, _) = drawn(&filling, &places, &vec![3; places.len()], middle).unwrap();
        assert!((record[3] - (1.0 - (-size_m / FREE_M).exp())).abs() < 0.02 * record[3], "{}", record[3]);
        let spray: Vec<Vec3> = places.iter().map(|&p| p * 6.0).collect();
        let (drop, colour) = drawn(&filling, &spray, &vec![3; places.len()], middle).unwrap();
        assert!((drop[3] - DROP[0]).abs() < 1e-4 && colour.min_element() * SH_FIRST + 0.5 > 0.7, "a drop is bright: {colour}");
    }
}

#[test]
fn a_thick_liquid_that_lies_loosely_closes() {
    let at = |apart: f32| axes(&poured(&lattice([9, 9, 9], SIZE_M * apart), 3)[364]).0;
    let ([a, _, c], [d, _, f]) = (at(1.0), at(1.4));
    assert!((a - 1.0).abs() < 0.1 && (c - 1.0).abs() < 0.1 && d > 1.3 && f > 1.3, "{a} {c} {d} {f}");
}

#[test]
fn what_has_little_volume_covers_what_lies_between() {
    let places = lattice([7, 7, 7], SIZE_M);
    let mut filling = filling(&places);
    filling.tint.iter_mut().for_each(|tint| tint[3] = 0.5 * SIZE_M);
    filling.rest_m.iter_mut().for_each(|p| *p = Vec3::ZERO);
    let all_of = |places: &[Vec3], i| axes(&drawn(&filling, places, &vec![3; places.len()], i).unwrap()).0;
    let [a, _, c] = all_of(&places, 171);
    assert!((a - 1.0).abs() < 0.05 && (c - 1.0).abs() < 0.05, "in a body as if it were full: {a} {c}");
    let spray: Vec<Vec3> = places.iter().map(|&p| p * 6.0).collect();
    let [a, _, c] = all_of(&spray, 171);
    assert!((a - 0.5).abs() < 0.01 && (c - 0.5).abs() < 0.01, "alone a drop of its own volume: {a} {c}");
}
