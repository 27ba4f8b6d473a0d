//! Solids of synthetic captures against formulas, and of real ones where they are at hand.

use super::*;
use std::f32::consts::PI;
use std::path::PathBuf;

/// Round Gaussians of one size and opacity at the given points.
fn skin(points: Vec<Vec3>, size_m: f32) -> Gaussians {
    let count = points.len();
    Gaussians {
        mean: points,
        scale: vec![Vec3::splat(size_m); count],
        rotation: vec![[1.0, 0.0, 0.0, 0.0]; count],
        opacity: vec![0.9; count],
        sh_degree: 0,
        sh: vec![0.0; count * 3],
    }
}

/// Points spread evenly over a sphere (Fibonacci lattice).
fn sphere(radius_m: f32, centre: Vec3, count: usize) -> Vec<Vec3> {
    let golden = PI * (3.0 - 5.0f32.sqrt());
    let point = |i: usize| {
        let z = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
        let (sin, cos) = (golden * i as f32).sin_cos();
        centre + radius_m * Vec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z)
    };
    (0..count).map(point).collect()
}

/// Points on the side of an upright tube.
fn tube(radius_m: f32, foot: Vec3, height_m: f32, apart_m: f32) -> Vec<Vec3> {
    let (rings, around) = ((height_m / apart_m) as usize, (2.0 * PI * radius_m / apart_m).ceil() as usize);
    let point = |ring: usize, i: usize| {
        let (sin, cos) = (2.0 * PI * i as f32 / around as f32).sin_cos();
        foot + Vec3::new(radius_m * cos, radius_m * sin, height_m * ring as f32 / rings as f32)
    };
    (0..=rings).flat_map(|ring| (0..around).map(move |i| point(ring, i))).collect()
}

/// Points on a level disc.
fn disc(radius_m: f32, centre: Vec3, apart_m: f32) -> Vec<Vec3> {
    let reach = (radius_m / apart_m) as i32;
    let cells = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| Vec3::new(x as f32, y as f32, 0.0) * apart_m));
    cells.filter(|p| p.length() <= radius_m).map(|p| centre + p).collect()
}

fn solid(gaussians: &Gaussians, ground_m: f32, cell_m: f32, kind: ProxyKind) -> Solid {
    build(&ProxyRequest { gaussians, ground_m, cell_m, kind, stands: true, seed: 1 }).unwrap()
}

fn auto(gaussians: &Gaussians, density_kg_m3: f64) -> YoungAuto {
    young_auto(&solid(gaussians, 0.0, 0.05, ProxyKind::Voxel).stance, density_kg_m3)
}

/// Draft and full of an object one metre long.
const CELLS_M: [f32; 2] = [1.0 / 32.0, 1.0 / 64.0];

/// The captured scenes, where this machine has them.
fn scenes() -> Option<PathBuf> {
    let shared = std::env::var_os("PHYSTALK_SHARED").map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let scenes = shared.join("scenes");
    if scenes.join("vase.splat").exists() {
        return Some(scenes);
    }
    println!("{} has no captured scenes: only synthetic ones are tested", scenes.display());
    None
}

/// Particles in a box.
fn inside(solid: &Solid, low: Vec3, high: Vec3) -> usize {
    solid.position_m.iter().filter(|p| p.cmpge(low).all() && p.cmple(high).all()).count()
}

/// Groups of particles that are joined by steps of at most `reach_m`, largest first.
fn groups(points: &[Vec3], reach_m: f32) -> Vec<usize> {
    let key = |p: Vec3| (p / reach_m).floor().as_ivec3().to_array();
    let mut cells: std::collections::BTreeMap<[i32; 3], Vec<usize>> = Default::default();
    points.iter().enumerate().for_each(|(i, &p)| cells.entry(key(p)).or_default().push(i));
    let mut seen = vec![false; points.len()];
    let mut sizes = Vec::new();
    for seed in 0..points.len() {
        let (mut size, mut stack) = (0, if seen[seed] { Vec::new() } else { vec![seed] });
        seen[seed] = true;
        while let Some(i) = stack.pop() {
            size += 1;
            let [x, y, z] = key(points[i]);
            for near in (0..27).filter_map(|n| cells.get(&[x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1])).flatten() {
                if !seen[*near] && points[*near].distance(points[i]) <= reach_m {
                    seen[*near] = true;
                    stack.push(*near);
                }
            }
        }
        if size > 0 {
            sizes.push(size);
        }
    }
    sizes.sort_unstable_by_key(|&s| std::cmp::Reverse(s));
    sizes
}

#[test]
fn a_closed_shell_is_filled() {
    let shell = skin(sphere(0.5, Vec3::Z, 4000), 0.012);
    // the skin stops half of the light a little outside its centres
    let ball = 4.0 / 3.0 * PI * (0.5f32 + 0.012).powi(3);
    for cell_m in CELLS_M {
        let solid = solid(&shell, 0.0, cell_m, ProxyKind::Voxel);
        assert!((solid.volume_total_m3 / ball - 1.0).abs() < 0.06, "{} of {ball}", solid.volume_total_m3);
        assert!(solid.fill_ratio > 0.7, "{}", solid.fill_ratio);
        let centre = solid.position_m.iter().zip(&solid.volume_m3).map(|(&p, &v)| p * v).sum::<Vec3>() / solid.volume_total_m3;
        assert!(centre.distance(Vec3::Z) < 0.005, "{centre}");
    }
}

#[test]
fn volumes_add_up_and_particles_fill_eight_to_a_cell() {
    let shell = skin(sphere(0.5, Vec3::Z, 4000), 0.012);
    let solid = solid(&shell, 0.0, CELLS_M[0], ProxyKind::Voxel);
    let sum: f64 = solid.volume_m3.iter().map(|&v| f64::from(v)).sum();
    assert!((sum / f64::from(solid.volume_total_m3) - 1.0).abs() < 1e-5);
    let cell = CELLS_M[0].powi(3);
    for (&inner, &volume) in solid.inner.iter().zip(&solid.volume_m3) {
        assert!(volume > 0.0 && volume < 2.0 * cell / 8.0);
        assert!(!inner || (volume * 8.0 / cell - 1.0).abs() < 0.05, "{volume}");
    }
    let order = morton_order(&solid.position_m);
    assert!(order.iter().enumerate().all(|(i, &o)| i == o as usize), "not in Morton order");
}

#[test]
fn an_open_cup_stays_hollow() {
    let mut points = tube(0.25, Vec3::ZERO, 0.6, 0.01);
    points.extend(disc(0.25, Vec3::ZERO, 0.01));
    let cup = skin(points, 0.006);
    for cell_m in CELLS_M {
        let solid = solid(&cup, 0.0, cell_m, ProxyKind::Voxel);
        assert_eq!(inside(&solid, Vec3::new(-0.1, -0.1, 0.1), Vec3::new(0.1, 0.1, 0.6)), 0);
        assert!(solid.volume_total_m3 < 0.4 * PI * 0.25 * 0.25 * 0.6, "{}", solid.volume_total_m3);
    }
}

#[test]
fn what_is_open_below_is_sealed_at_the_ground() {
    let mut points = tube(0.25, Vec3::new(0.0, 0.0, 0.01), 0.5, 0.01);
    points.extend(disc(0.25, Vec3::new(0.0, 0.0, 0.51), 0.01));
    points.push(Vec3::new(0.25, 0.0, 0.0));
    let bell = skin(points, 0.006);
    let cylinder = PI * 0.25 * 0.25 * 0.51;
    let solid = solid(&bell, 0.0, CELLS_M[0], ProxyKind::Voxel);
    assert!((solid.volume_total_m3 / cylinder - 1.0).abs() < 0.12, "{} of {cylinder}", solid.volume_total_m3);
    assert!(solid.position_m.iter().all(|p| p.z > 0.0), "particles below the ground");
}

#[test]
fn holes_are_closed_by_a_radius_of_the_spacing() {
    // a ball with a hole twice as wide as its skin's spacing, and one with a hole of half its width
    let holed = |hole_m: f32| {
        let points = sphere(0.4, Vec3::new(0.0, 0.0, 0.4), 6000);
        skin(points.into_iter().filter(|p| Vec3::new(0.4, 0.0, 0.4).distance(*p) > hole_m / 2.0).collect(), 0.009)
    };
    let core = |solid: &Solid| inside(solid, Vec3::new(-0.1, -0.1, 0.3), Vec3::new(0.1, 0.1, 0.5));
    assert!(core(&solid(&holed(0.05), 0.0, CELLS_M[0], ProxyKind::Voxel)) > 1000);
    assert_eq!(core(&solid(&holed(0.4), 0.0, CELLS_M[0], ProxyKind::Voxel)), 0);
}

/// A block with six thin stems on it that carry a plate.
fn bouquet() -> (Gaussians, Vec<Vec3>) {
    let feet: Vec<Vec3> = (0..6).map(|i| 0.12 * Vec3::new((i as f32).cos(), (i as f32).sin(), 0.0) + Vec3::Z * 0.4).collect();
    let mut points: Vec<Vec3> = feet.iter().flat_map(|&foot| (0..40).map(move |k| foot + Vec3::Z * 0.01 * k as f32)).collect();
    points.extend(tube(0.2, Vec3::ZERO, 0.4, 0.01));
    points.extend(disc(0.2, Vec3::Z * 0.4, 0.01));
    points.extend(disc(0.2, Vec3::Z * 0.8, 0.01));
    (skin(points, 0.004), feet)
}

#[test]
fn stems_neither_vanish_nor_web_together_at_draft_and_full() {
    let (bouquet, feet) = bouquet();
    let [draft, full] = CELLS_M.map(|cell_m| solid(&bouquet, 0.0, cell_m, ProxyKind::Voxel));
    assert!((draft.volume_total_m3 / full.volume_total_m3 - 1.0).abs() < 1e-6, "draft and full differ in mass");
    assert!((draft.fill_ratio - full.fill_ratio).abs() < 0.1, "{} {}", draft.fill_ratio, full.fill_ratio);
    for (solid, cell_m) in [(&draft, CELLS_M[0]), (&full, CELLS_M[1])] {
        let middle = inside(solid, Vec3::new(-0.06, -0.06, 0.45), Vec3::new(0.06, 0.06, 0.75));
        assert_eq!(middle, 0, "the stems web together");
        for &foot in &feet {
            let stem: Vec<Vec3> =
                solid.position_m.iter().copied().filter(|p| (*p - foot).truncate().length() < 0.04 && p.z > 0.35 && p.z < 0.85).collect();
            assert_eq!(groups(&stem, cell_m).len(), 1, "a gap wider than a cell in a stem");
            assert!(stem.len() >= (0.4 / cell_m) as usize, "{} particles in a stem", stem.len());
        }
        assert_eq!(groups(&solid.position_m, cell_m).len(), 1);
    }
}

#[test]
fn loose_pieces_are_joined_or_dropped() {
    let ball = || sphere(0.3, Vec3::new(0.0, 0.0, 0.3), 3000);
    let mut near = ball();
    near.extend(sphere(0.03, Vec3::new(0.0, 0.0, 0.67), 40));
    let joined = solid(&skin(near, 0.008), 0.0, CELLS_M[1], ProxyKind::Voxel);
    assert_eq!(groups(&joined.position_m, CELLS_M[1]).len(), 1);
    assert!(joined.warnings.is_empty(), "{:?}", joined.warnings);
    let mut far = ball();
    far.extend(sphere(0.04, Vec3::new(0.0, 0.9, 0.9), 60));
    let dropped = solid(&skin(far, 0.008), 0.0, CELLS_M[1], ProxyKind::Voxel);
    assert_eq!(inside(&dropped, Vec3::new(-1.0, 0.7, 0.0), Vec3::ONE), 0);
    assert!(dropped.warnings[0].contains("loose"), "{:?}", dropped.warnings);
}

#[test]
fn a_large_piece_far_away_stays_a_body_of_its_own() {
    let mut pair = sphere(0.3, Vec3::new(0.0, 0.0, 0.3), 3000);
    pair.extend(sphere(0.3, Vec3::new(1.0, 0.0, 0.3), 3000));
    let solid = solid(&skin(pair, 0.008), 0.0, CELLS_M[0], ProxyKind::Voxel);
    let sizes = groups(&solid.position_m, CELLS_M[0]);
    assert_eq!(sizes.len(), 2);
    assert!(sizes[0] < sizes[1] + sizes[1] / 10);
}

#[test]
fn the_hull_is_convex_and_has_its_volume() {
    let (bouquet, _) = bouquet();
    let hull = solid(&bouquet, 0.0, CELLS_M[0], ProxyKind::Hull);
    let cylinder = PI * 0.2 * 0.2 * 0.8;
    assert!((hull.volume_total_m3 / cylinder - 1.0).abs() < 0.05, "{} of {cylinder}", hull.volume_total_m3);
    assert!(inside(&hull, Vec3::new(-0.06, -0.06, 0.45), Vec3::new(0.06, 0.06, 0.75)) > 500);
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let (bouquet, _) = bouquet();
    let make = |seed| build(&ProxyRequest { gaussians: &bouquet, ground_m: 0.0, cell_m: 0.03, kind: ProxyKind::Voxel, stands: true, seed }).unwrap();
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (many, one) = (make(7), alone.install(|| make(7)));
    assert_eq!(many, one);
    assert_ne!(many.position_m, make(8).position_m);
}

#[test]
fn degenerate_input_is_a_small_solid_or_a_clear_error() {
    let at = |points: Vec<Vec3>, size_m: f32| skin(points, size_m);
    let request = |gaussians: &Gaussians, kind| build(&ProxyRequest { gaussians, ground_m: -1.0, cell_m: 0.02, kind, stands: true, seed: 1 });
    let voxel = |gaussians: &Gaussians| request(gaussians, ProxyKind::Voxel);

    let one = voxel(&at(vec![Vec3::ZERO], 0.1)).unwrap();
    assert!(one.position_m.len() > 10 && one.volume_total_m3 < 0.1, "{one:?}");
    assert!(matches!(voxel(&at(vec![Vec3::ZERO; 50], 0.0)), Err(ProxyError::NoExtent { .. })));
    assert!(voxel(&at(vec![Vec3::ZERO; 50], 0.05)).is_ok());
    let line = at((0..200).map(|i| Vec3::X * 0.005 * i as f32).collect(), 0.004);
    assert!(voxel(&line).unwrap().position_m.len() > 40);
    assert!(matches!(request(&line, ProxyKind::Hull), Err(ProxyError::FlatHull { .. })));
    let sheet = at(disc(0.5, Vec3::ZERO, 0.01), 0.006);
    assert!(voxel(&sheet).unwrap().position_m.len() > 1000);
    assert!(matches!(request(&sheet, ProxyKind::Hull), Err(ProxyError::FlatHull { .. })));

    let mut far = sphere(0.5, Vec3::ZERO, 2000);
    far.push(Vec3::X * 1e6);
    assert!(matches!(voxel(&at(far, 0.01)), Err(ProxyError::TooSparse { .. })));
    let mut wide = at(sphere(0.5, Vec3::ZERO, 2000), 0.01);
    wide.scale[7] = Vec3::splat(1e7);
    assert!(voxel(&wide).unwrap().warnings[0].contains("wider"));
    let mut haze = at(sphere(0.5, Vec3::ZERO, 2000), 0.01);
    haze.opacity.fill(0.01);
    assert!(matches!(voxel(&haze), Err(ProxyError::Invisible { .. })));
    assert!(matches!(voxel(&Gaussians::default()), Err(ProxyError::Invisible { .. })));
    assert!(matches!(voxel(&at(vec![Vec3::NEG_Z * 5.0; 3], 0.1)), Err(ProxyError::BelowGround { .. })));
    let ball = at(sphere(0.5, Vec3::ZERO, 2000), 0.01);
    for cell_m in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-6] {
        let built = build(&ProxyRequest { gaussians: &ball, ground_m: -1.0, cell_m, kind: ProxyKind::Voxel, stands: true, seed: 1 });
        assert!(matches!(built, Err(ProxyError::Cell { .. })), "{cell_m}");
    }
    // any scale: the solid only scales
    for metres in [1e-6, 1e6] {
        let scaled = at(sphere(0.5 * metres, Vec3::ZERO, 2000), 0.02 * metres);
        let solid =
            build(&ProxyRequest { gaussians: &scaled, ground_m: -metres, cell_m: metres / 32.0, kind: ProxyKind::Voxel, stands: true, seed: 1 })
                .unwrap();
        assert!((solid.volume_total_m3 / metres.powi(3) / 0.55 - 1.0).abs() < 0.2, "{}", solid.volume_total_m3);
    }
}

#[test]
fn automatic_stiffness_follows_greenhill() {
    // a column 1 m high of radius 0.1 m: 4 * 4 rho g / (7.84 * 0.01)
    let column = |radius_m: f32, height_m: f32| {
        let mut points = tube(radius_m, Vec3::ZERO, height_m, 0.01);
        points.extend(disc(radius_m, Vec3::Z * height_m, 0.01));
        skin(points, 0.004)
    };
    let bound = |radius: f64, height: f64| 16.0 * 1000.0 * 9.81 * height.powi(3) / (7.84 * radius * radius);
    let stiff = auto(&column(0.1, 0.5), 1000.0);
    assert!((stiff.value_pa / bound(0.1, 0.5) - 1.0).abs() < 0.2, "{} for {}", stiff.value_pa, bound(0.1, 0.5));
    assert!(stiff.local.iter().all(|&e| e == stiff.value_pa as f32));
    assert!(stiff.warnings.is_empty(), "{:?}", stiff.warnings);
    // Up to its top it bears its weight as at its foot.
    assert!(stiff.needs_pa.iter().all(|&e| e > 0.9 * stiff.value_pa as f32), "{:?}", stiff.needs_pa.iter().fold(f32::MAX, |a, &b| a.min(b)));
    // a flat one gives way across: rho g A h^3 / (7.84 I), I = a b^3 / 12
    let flat = (0..30 * 10 * 50).map(|i| Vec3::new((i % 30) as f32, (i / 30 % 10) as f32, (i / 300) as f32) * 0.01 + Vec3::splat(0.005));
    let flat = auto(&skin(flat.collect(), 0.004), 1000.0);
    let across = 4.0 * 1000.0 * 9.81 * 12.0 * 0.5f64.powi(3) / (7.84 * 0.1 * 0.1);
    assert!((flat.value_pa / across - 1.0).abs() < 0.25, "{} for {across}", flat.value_pa);
    // twice as dense, twice as stiff; stocky and slender stay within the range
    let dense = auto(&column(0.1, 0.5), 2000.0);
    assert!((dense.value_pa / stiff.value_pa - 2.0).abs() < 1e-6);
    assert_eq!(auto(&column(0.3, 0.3), 1000.0).value_pa, 5e4);
    let mast = auto(&column(0.03, 1.0), 1000.0);
    assert_eq!(mast.value_pa, 8e5);
    assert!(!mast.warnings.is_empty());
}

#[test]
fn stems_are_stiffer_than_what_they_stand_on() {
    let (bouquet, feet) = bouquet();
    let young = auto(&bouquet, 1000.0);
    let value = young.value_pa as f32;
    for (i, p) in bouquet.mean.iter().enumerate() {
        assert!(young.local[i] >= value && young.local[i] <= 2e6);
        if p.z < 0.3 {
            assert_eq!(young.local[i], value);
        } else if p.z > 0.5 && p.z < 0.7 {
            assert!(young.local[i] > 1.5 * value, "{} of {value}", young.local[i]);
        }
    }
    let stems = nearest(&bouquet, &feet.iter().map(|&f| f + Vec3::Z * 0.2).collect::<Vec<_>>());
    assert!(stems.iter().zip(&feet).all(|(&i, &foot)| bouquet.mean[i as usize].distance(foot + Vec3::Z * 0.2) < 0.01));
    assert!(young.notes.iter().any(|n| n.contains("slender")), "{:?}", young.notes);
}

#[test]
fn nearest_of_points_that_coincide_is_one_of_them() {
    let same = skin(vec![Vec3::ONE; 500], 0.1);
    assert!(nearest(&same, &[Vec3::ZERO, Vec3::ONE]).iter().all(|&i| i < 500));
    assert_eq!(nearest(&Gaussians::default(), &[Vec3::ONE]), [0]);
}

#[test]
fn captured_things_come_out_solid_at_draft_and_full() {
    let Some(scenes) = scenes() else { return };
    for (name, core, young) in [
        ("vase", [Vec3::new(-0.03, 0.0, -0.55), Vec3::new(0.06, 0.15, -0.2)], 1e5..=8e5),
        ("bulldozer", [Vec3::new(-0.6, 0.1, -0.35), Vec3::new(-0.4, 0.2, -0.25)], 1e5..=8e5),
    ] {
        let gaussians = crate::scene::read(&scenes.join(format!("{name}.splat"))).unwrap().gaussians;
        let (low, high) = gaussians.bounds();
        let longest = (high - low).max_element();
        let built = [32.0, 64.0].map(|cells| solid(&gaussians, low.z, longest / cells, ProxyKind::Voxel));
        let [draft, full] = &built;
        assert!((draft.volume_total_m3 / full.volume_total_m3 - 1.0).abs() < 0.1);
        for solid in &built {
            assert!(solid.fill_ratio > 0.35, "{name}: {}", solid.fill_ratio);
            assert_eq!(groups(&solid.position_m, 3.0 * solid.spacing_m).len(), 1, "{name} falls into pieces");
            let whole = (core[1] - core[0]).element_product() / solid.spacing_m.powi(3);
            let found = inside(solid, core[0], core[1]) as f32;
            assert!(found > 0.85 * whole, "{name}: {found} of {whole} particles in its core");
        }
        let auto = young_auto(&draft.stance, 1000.0);
        assert!(young.contains(&auto.value_pa), "{name}: {}", auto.value_pa);
    }
}

/// A pot that a stout stem and a long thin tendril reach out from, Gaussians 8 mm apart; the tendril's are the last ones.
pub(crate) fn pot_with_a_tendril() -> (Gaussians, usize) {
    let mut points = tube(0.1, Vec3::ZERO, 0.12, 0.008);
    points.extend(disc(0.1, Vec3::Z * 0.12, 0.008));
    let stem = (0..40 * 16).map(|i| Vec3::new(-0.03 + 0.006 * (i % 4) as f32, -0.009 + 0.006 * (i / 4 % 4) as f32, 0.12 + 0.004 * (i / 16) as f32));
    points.extend(stem);
    let start = points.len();
    // Up, over, and sideways out of its plane.
    let along = (0..180).map(|i| i as f32 / 180.0);
    points.extend(along.map(|t| Vec3::new(0.03 + 0.25 * t, 0.1 * (4.0 * t).sin() * t, 0.12 + 0.12 * (3.0 * t).sin())));
    (skin(points, 0.004), start)
}

#[test]
fn threads_that_no_stiffness_holds_are_no_matter_and_follow_what_they_hang_on() {
    let (pot, start) = pot_with_a_tendril();
    let [draft, full] = [0.03, 0.015].map(|cell_m| solid(&pot, 0.0, cell_m, ProxyKind::Voxel));
    for solid in [&draft, &full] {
        assert_eq!(inside(solid, Vec3::new(0.13, -0.3, 0.0), Vec3::ONE), 0, "the tendril is matter: {:?}", solid.warnings);
        assert!(inside(solid, Vec3::new(-0.05, -0.03, 0.2), Vec3::new(0.0, 0.03, 0.3)) > 10, "the stem is none");
        assert!(solid.warnings.iter().any(|w| w.starts_with("1 stems or threads")), "{:?}", solid.warnings);
    }
    assert_eq!(draft.hung, full.hung);
    let hung: Vec<u32> = draft.hung.iter().map(|h| h.0).collect();
    assert!((start as u32 + 20..start as u32 + 180).all(|i| hung.contains(&i)) && hung.iter().all(|&i| i as usize >= start - 5), "{hung:?}");
    assert!(draft.hung.iter().all(|h| h.1.distance(Vec3::new(0.035, 0.0, 0.13)) < 0.03), "{:?}", draft.hung[0]);
    // What flows has no need to stand.
    let poured = build(&ProxyRequest { gaussians: &pot, ground_m: 0.0, cell_m: 0.015, kind: ProxyKind::Voxel, stands: false, seed: 1 }).unwrap();
    assert!(poured.hung.is_empty() && inside(&poured, Vec3::new(0.13, -0.3, 0.0), Vec3::ONE) > 10);
    // What stays can be made to stand, and a hull holds everything.
    let auto = young_auto(&full.stance, 1000.0);
    assert!(auto.local.iter().all(|&e| e <= 2e6));
    let whole = solid(&pot, 0.0, 0.015, ProxyKind::Hull);
    assert!(whole.hung.is_empty() && whole.warnings.is_empty(), "{:?}", whole.warnings);
}
