//! Solids of synthetic captures against formulas, and of real ones where they are at hand.

use super::*;

/// Gaussians of one size at the given points.
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
    let golden = std::f32::consts::PI * (3.0 - 5.0f32.sqrt());
    let point = |i: usize| {
        let z = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
        let (sin, cos) = (golden * i as f32).sin_cos();
        centre + radius_m * Vec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z)
    };
    (0..count).map(point).collect()
}

fn solid(gaussians: &Gaussians, ground_m: f32, cell_m: f32, kind: ProxyKind) -> Solid {
    build(&ProxyRequest { gaussians, ground_m, cell_m, kind, seed: 1 }).unwrap()
}

#[test]
fn a_closed_shell_is_filled() {
    let shell = skin(sphere(0.5, Vec3::Z, 8000), 0.008);
    let ball = 4.0 / 3.0 * std::f32::consts::PI * 0.125;
    for cell_m in [1.0 / 32.0, 1.0 / 64.0] {
        let solid = solid(&shell, 0.0, cell_m, ProxyKind::Voxel);
        assert!((solid.volume_total_m3 / ball - 1.0).abs() < 0.10, "{} of {ball}", solid.volume_total_m3);
        assert!(solid.fill_ratio > 0.7, "{}", solid.fill_ratio);
    }
}
