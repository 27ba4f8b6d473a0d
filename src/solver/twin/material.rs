//! `material.wgsl`, by iterations that are run until they stand still, in f64.

use glam::{DMat3, DQuat};

/// Rotation of the polar decomposition; of an inverted matrix, the proper rotation nearest to it.
pub fn polar(f: DMat3) -> DMat3 {
    if f.determinant() > 1e-3 {
        return (0..60).fold(f, |r, _| 0.5 * (r + r.inverse().transpose()));
    }
    let mut r = DMat3::IDENTITY;
    // From a rotation that a half turn about no axis leaves stuck.
    for start in [DQuat::from_rotation_x(0.3), DQuat::from_rotation_y(1.9), DQuat::from_rotation_z(-2.2)] {
        let candidate = turned_towards(f, DMat3::from_quat(start));
        if alignment(candidate, f) > alignment(r, f) {
            r = candidate;
        }
    }
    r
}

fn alignment(r: DMat3, f: DMat3) -> f64 {
    (r.transpose() * f).col(0).x + (r.transpose() * f).col(1).y + (r.transpose() * f).col(2).z
}

fn turned_towards(f: DMat3, start: DMat3) -> DMat3 {
    (0..4000).fold(start, |r, _| {
        let turn = (0..3).map(|c| r.col(c).cross(f.col(c))).sum::<glam::DVec3>();
        let omega = turn / (alignment(r, f).abs() + 1e-9);
        if omega.length() < 1e-12 { r } else { DMat3::from_axis_angle(omega.normalize(), omega.length()) * r }
    })
}

/// Kirchhoff stress of either energy.
pub fn kirchhoff(f: DMat3, mu: f64, lambda: f64, neo_hookean: bool) -> DMat3 {
    let j = f.determinant();
    if neo_hookean {
        let floor = f64::from(crate::solver::constants::J_FLOOR);
        return (f * f.transpose() - DMat3::IDENTITY) * mu + DMat3::IDENTITY * (lambda * j.max(floor).ln());
    }
    (f - polar(f)) * f.transpose() * (2.0 * mu) + DMat3::IDENTITY * (lambda * j * (j - 1.0))
}
