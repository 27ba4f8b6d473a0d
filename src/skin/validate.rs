//! Skinning against the maps that it has to carry exactly: V27.

use super::{Skinner, Splats, bind, twin};
use crate::gpu::{Gpu, Recording};
use crate::scene::Gaussians;
use crate::solver::SolverError;
use crate::solver::validate::{Case, Check};
use crate::spec::{Skin, Weights};
use glam::{Mat3, Quat, Vec3};

/// The cases of this room.
pub const CASES: &[Case] = &[Case::new("V27", true, affine)];

/// Places that look random and are always the same, in a cube of `size_m`.
fn scattered(count: usize, size_m: f32, salt: usize) -> Vec<Vec3> {
    let of = |i: usize, axis: usize| ((i * 7_919 + salt * 104_729 + axis * 15_485_863) * 2_654_435_761 % 1_000_003) as f32 / 1_000_003.0;
    (0..count).map(|i| Vec3::new(of(i, 1), of(i, 2), of(i, 3)) * size_m).collect()
}

/// V27: quarter and half turns, and a shear with a stretch; halves hold their entries exactly, so
/// that what is measured is skinning. Then any turn, whose entries halves hold to 2^-11.
fn affine(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let turns = [Mat3::from_cols(Vec3::Y, Vec3::NEG_X, Vec3::Z), Mat3::from_cols(Vec3::NEG_X, Vec3::Y, Vec3::NEG_Z)];
    let shear = Mat3::from_cols_array(&[1.25, 0.125, 0.0, -0.5, 0.75, 0.25, 0.0, -0.125, 1.5]);
    let exact = carried(gpu, &[turns[0], turns[1], shear])?;
    let any = [(Vec3::new(1.0, 2.0, 3.0), 2.1), (Vec3::new(-3.0, 1.0, 0.5), 0.4), (Vec3::new(0.2, -0.7, 0.1), 3.0)];
    let rounded = carried(gpu, &any.map(|(axis, angle)| Mat3::from_axis_angle(axis.normalize(), angle)))?;
    // All nine entries off by 2^-11 turn what is 0.06 m from its particle by 3 2^-11 of that.
    let off = 3.0 / 2048.0;
    let row = |name, formula, source, unit| Check::new(name, formula, source, unit);
    let (source, halves) = ("exact under affine maps by construction", "exact but for the rounding of halves, 2^-11 an entry: IEEE 754");
    Ok(vec![
        row("V27 centres", "A c + b", source, "m").compare(0.0, exact[0], 1e-5),
        row("V27 covariances", "A S A^T, largest difference as a share", source, "").compare(0.0, exact[1], 1e-5),
        row("V27 directions of colour", "R^-1 of the view, unchanged", source, "").compare(0.0, exact[2], 1e-4),
        row("V27 centres, any rotation", "R c + b", halves, "m").compare(0.0, rounded[0], 0.06 * off),
        row("V27 covariances, any rotation", "R S R^T, largest difference as a share", halves, "").compare(0.0, rounded[1], 2.0 * off),
        row("V27 directions of colour, any rotation", "R^-1 of the view, unchanged", halves, "").compare(0.0, rounded[2], off),
    ])
}

/// The largest errors of centres, covariances and directions among Gaussians that some maps carry.
fn carried(gpu: &Gpu, maps: &[Mat3]) -> Result<[f64; 3], SolverError> {
    let (particles, mean) = (scattered(600, 0.3, 1), scattered(1500, 0.3, 2));
    let count = mean.len();
    let scene = Gaussians {
        scale: scattered(count, 0.02, 3).iter().map(|s| *s + 0.002).collect(),
        rotation: scattered(count, 1.0, 4).iter().map(|q| [0.5, q.x - 0.5, q.y, q.z]).collect(),
        opacity: vec![0.5; count],
        sh_degree: 0,
        sh: vec![0.1; 3 * count],
        mean,
    };
    let splats = Splats::new(gpu, &scene, Quat::IDENTITY, &vec![0; count])?;
    let skin = Skin { neighbours: 8, weights: Weights::Exact };
    let bound = bind(&scene.mean, &vec![0; count], &particles, &vec![0; particles.len()], &skin);
    let skinner = Skinner::new(gpu, &splats, &bound, &particles, Weights::Exact)?;
    let (mut centre, mut shape, mut view) = (0.0f64, 0.0f64, 0.0f64);
    for &map in maps {
        let offset = Vec3::new(0.1, 0.2, 0.3);
        let motion: Vec<_> = particles.iter().map(|&p| twin::pack_motion(map * p + offset, map - Mat3::IDENTITY)).collect();
        let mut recording = Recording::default();
        skinner.record(&gpu.storage_from("validate.motion", &motion)?, &mut recording);
        gpu.submit(&recording);
        let drawn: Vec<[f32; 16]> = gpu.read(&splats.geometry, count)?;
        let rotation = twin::polar_rotation(map);
        for (g, drawn) in drawn.iter().enumerate() {
            centre = centre.max(f64::from((Vec3::from_slice(drawn) - (map * scene.mean[g] + offset)).length()));
            let [xx, xy, xz, yy, yz, zz] = [drawn[4], drawn[5], drawn[6], drawn[7], drawn[8], drawn[9]];
            let wanted = map * scene.covariance(g) * map.transpose();
            let off = Mat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]) - wanted;
            shape = shape.max(f64::from(norm(off) / norm(wanted)));
            // A camera that goes along looks spherical harmonics up where it did before.
            let ahead = Vec3::new(0.6, -0.64, 0.48);
            view = view.max(f64::from((Quat::from_slice(&drawn[12..]).inverse() * (rotation * ahead) - ahead).length()));
        }
    }
    Ok([centre, shape, view])
}

fn norm(m: Mat3) -> f32 {
    m.to_cols_array().iter().map(|v| v * v).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn v27_affine_maps() {
        let gpu = Gpu::shared_for_tests().unwrap();
        for case in CASES {
            for check in case.run(&gpu).unwrap() {
                assert!(check.held, "{check:?}");
            }
        }
    }
}
