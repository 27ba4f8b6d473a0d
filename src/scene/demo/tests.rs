//! The built-in scene is what its spec says, and the same every time.

use super::super::{floaters, guess_up, select};
use super::*;
use std::sync::LazyLock;

static SCENE: LazyLock<Gaussians> = LazyLock::new(|| gaussians(1));

fn vase_of(g: &Gaussians) -> Gaussians {
    g.subset(&select(g, &[], &spec().objects[0].select))
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_does_not() {
    assert!(gaussians(1) == *SCENE);
    assert!(vase::vase(2, Vec3::ZERO) != vase::vase(1, Vec3::ZERO));
}

#[test]
fn it_is_of_the_promised_size_and_place() {
    let g = &*SCENE;
    assert!((20_000..=60_000).contains(&g.len()), "{}", g.len());
    assert_eq!((g.sh_degree, g.sh.len()), (3, g.len() * 48));
    let (low, high) = g.bounds();
    assert!(low.z.abs() < 1e-3 && high.z > 0.9 && high.z < 1.2, "{low} {high}");
    assert!(g.sh.iter().chain(&g.opacity).all(|x| x.is_finite()));
    assert!(g.scale.iter().all(|s| s.is_finite() && s.min_element() > 0.0 && s.max_element() < 0.1));
    assert_eq!(guess_up(g).axis, Axis::PlusZ);
}

/// Means over all Gaussians that change when the picture does; wide enough for another libm.
#[test]
fn its_look_is_pinned() {
    let g = &*SCENE;
    let mean = |channel: usize| g.sh.iter().skip(channel).step_by(48).map(|&c| f64::from(c)).sum::<f64>() / g.len() as f64;
    let found = [mean(0), mean(1), mean(2), g.scale.iter().map(|s| f64::from(s.x)).sum::<f64>() / g.len() as f64 * 1e3];
    let pinned = [-0.1223, -0.2394, -0.4040, 5.6017];
    assert!(found.iter().zip(pinned).all(|(f, p)| (f - p).abs() < 2e-3), "{found:?}");
}

#[test]
fn the_vase_stands_on_the_table_and_nothing_else_is_of_it() {
    let g = &*SCENE;
    let vase = vase_of(g);
    let (low, high) = vase.bounds();
    assert!((low.z - table::TOP_M).abs() < 1e-6, "{low}");
    assert!(high.z - low.z > 0.5 && high.z - low.z < 0.7, "{high}");
    let standing = vase::vase(1, Vec3::ZERO).len() + bouquet::bouquet(1, Vec3::ZERO).len();
    assert_eq!(vase.len(), standing);
    let ColliderShape::Box(top) = spec().colliders[0].shape else { panic!("the table is a box") };
    assert!(spec().validate().is_ok());
    assert!((top.centre_m[2] + top.size_m[2] / 2.0 - f64::from(table::TOP_M)).abs() < 1e-6);
    let astray = floaters(&vase).iter().filter(|&&f| f).count();
    assert!(astray * 500 < vase.len(), "{astray} floaters");
}

#[test]
fn a_coat_is_matched_where_it_is_seen() {
    let normal = Vec3::new(0.3, -0.5, 0.8).normalize();
    let sent = |view: Vec3| Vec3::new(0.2 + 0.5 * view.dot(normal).max(0.0).powi(4), 0.5, 0.3 + 0.2 * view.x);
    let views: Vec<Vec3> = light::spread(200, -0.2).collect();
    let sh = light::Fit::new(normal, &views).coefficients(&sent);
    for view in light::spread(50, 0.1).map(|d| light::about(normal, d)) {
        let basis = light::basis(-view);
        let colour = sh.iter().zip(basis).fold(Vec3::splat(0.5), |c, (s, b)| c + *s * b);
        assert!((colour - sent(view)).abs().max_element() < 0.04, "{view} {colour} {}", sent(view));
    }
}

#[test]
fn a_sheet_has_its_two_colours_on_its_two_sides() {
    let (normal, front, back) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.9, 0.2, 0.1), Vec3::new(0.3, 0.1, 0.0));
    let sh = light::two_sided(front, back, normal);
    let seen = |view: Vec3| sh.iter().zip(light::basis(-view)).fold(Vec3::splat(0.5), |c, (s, b)| c + *s * b);
    assert!((seen(normal) - front).abs().max_element() < 1e-5);
    assert!((seen(-normal) - back).abs().max_element() < 1e-5);
}

#[test]
fn shade_falls_behind_things_and_not_before_them() {
    let table = shade::Boxes(table::solids());
    use shade::Shade;
    assert_eq!(table.passes(Vec3::new(0.0, 0.0, 0.0), Vec3::Z), 0.0);
    assert_eq!(table.passes(Vec3::new(0.0, 0.0, table::TOP_M), Vec3::Z), 1.0);
    assert_eq!(table.passes(Vec3::new(1.0, 0.0, 0.0), Vec3::Z), 1.0);
    let vase = vase::vase(1, Vec3::ZERO);
    let fog = shade::Fog::of(&vase);
    let side = Vec3::new(0.0895, 0.0, 0.122);
    let (out, through) = (fog.passes(side, Vec3::X), fog.passes(side, -Vec3::X));
    assert!(out > 0.9 && through < 0.65, "{out} {through}");
}
