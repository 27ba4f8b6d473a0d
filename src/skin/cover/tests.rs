//! What the rule promises, of its twin; the device against the twin is in `skin::tests`.

use super::twin::{Cover, principal};
use super::{LEAST, MOST};
use glam::{Mat3, Vec3};

const SPAN_M: f32 = 0.01;
const RADIUS_M: f32 = 0.004;

/// A record of a disc that lies across `normal`.
fn disc(x: Vec3, normal: Vec3) -> [f32; 16] {
    let across = Mat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
    let c = (Mat3::IDENTITY - across * 0.99) * (RADIUS_M * RADIUS_M);
    let (a, b, d) = (c.x_axis, c.y_axis, c.z_axis);
    [x.x, x.y, x.z, 1.0, a.x, a.y, a.z, b.y, b.z, d.z, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
}

fn lattice(counts: [usize; 3], spacing_m: f32) -> Vec<Vec3> {
    let at = |i: usize| Vec3::new((i % counts[0]) as f32, (i / counts[0] % counts[1]) as f32, (i / counts[0] / counts[1]) as f32);
    (0..counts.iter().product()).map(|i| (at(i) + Vec3::new(0.13, 0.29, 0.41)) * spacing_m).collect()
}

/// Lengths of the axes, descending, and the least one, of a Gaussian in the middle of those that were moved by a map.
fn middle_of(rest: &[Vec3], map: impl Fn(Vec3) -> Vec3) -> ([f32; 3], Vec3) {
    let records: Vec<_> = rest.iter().map(|&x| disc(x, Vec3::Y)).collect();
    let moved: Vec<Vec3> = rest.iter().map(|&x| map(x)).collect();
    let cover = Cover::new(&records, Vec3::ZERO, SPAN_M);
    let shapes = cover.spaced(&moved, &vec![1.0; rest.len()]);
    let (values, least) = principal(shapes[rest.len() / 2]);
    (values.map(|v| v.sqrt() / RADIUS_M), least)
}

#[test]
fn a_sheet_that_spreads_stays_covered_and_flat() {
    let rest = lattice([31, 31, 1], 0.006);
    for stretch in [1.0, 1.7, 2.5, 3.5] {
        let (axes, least) = middle_of(&rest, |x| x * stretch);
        assert!((axes[0] / stretch - 1.0).abs() < 0.2, "stretched by {stretch}: {axes:?}");
        assert!(axes[1] > 0.999 * axes[0], "a needle: {axes:?}");
        assert!(axes[2] < 0.3 * axes[0] && least.z.abs() > 0.99, "across {least}: {axes:?}");
    }
    // No volume is made from the captured disc's, but for the least thickness.
    let (axes, _) = middle_of(&rest, |x| x * 1.7);
    assert!(axes.iter().product::<f32>() < 1.7f32.powi(3) * 0.2, "{axes:?}");
    let (axes, _) = middle_of(&rest, |x| x * 20.0);
    assert!(axes[0] < 1.01, "alone it is as large as it was: {axes:?}");
}

#[test]
fn a_heap_is_no_fog_and_a_drop_is_round() {
    let rest = lattice([21, 21, 5], 0.006);
    let (axes, _) = middle_of(&rest, |x| x * Vec3::new(0.3, 0.3, 2.0));
    assert!((LEAST - 0.01..=1.0).contains(&axes[0]), "{axes:?}");
    let (axes, _) = middle_of(&rest, |x| x * 40.0);
    assert!((axes[0] - 1.0).abs() < 0.01 && axes[2] > 0.99, "{axes:?}");
    let (axes, _) = middle_of(&rest, |x| x * 3.0);
    assert!(axes[0] <= MOST && axes[2] > 0.7 * axes[0], "{axes:?}");
}

#[test]
fn large_and_small_that_lie_together_are_of_one_size() {
    let places = lattice([31, 31, 1], 0.004);
    let records: Vec<_> =
        places.iter().enumerate().map(|(i, &x)| if i % 3 == 0 { disc(x, Vec3::Y) } else { scaled(disc(x, Vec3::X), 0.3) }).collect();
    let shapes = Cover::new(&records, Vec3::ZERO, SPAN_M).spaced(&places, &vec![1.0; places.len()]);
    let inner = |i: &usize| places[*i].x > 0.05 && places[*i].x < 0.08 && places[*i].y > 0.05 && places[*i].y < 0.08;
    let area = |i: usize| f64::from(principal(shapes[i]).0[0]);
    let areas: Vec<f64> = (0..places.len()).filter(inner).map(area).collect();
    let (least, most) = areas.iter().fold((f64::MAX, 0.0f64), |(l, m), a| (l.min(*a), m.max(*a)));
    let mean = (1.0 + 2.0 * 0.09) / 3.0 * f64::from(RADIUS_M * RADIUS_M);
    assert!(most < 1.6 * least && least > 0.7 * mean && most < 1.4 * mean, "{least} to {most} of {mean}");
}

/// A record whose axes are shorter or longer.
fn scaled(mut record: [f32; 16], by: f32) -> [f32; 16] {
    record[4..10].iter_mut().for_each(|c| *c *= by * by);
    record
}
