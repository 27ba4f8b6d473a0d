//! Dabs of paint: the flat Gaussians that surfaces are made of, before they are lit.

use super::random::Random;
use glam::{Mat3, Quat, Vec3};

/// How a surface answers light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finish {
    /// Opaque with a coat: reflectance at normal incidence, and how broad the reflection is (0 a mirror, 1 none to see).
    Coated {
        /// Schlick's F0.
        reflectance: f32,
        /// 0..1.
        roughness: f32,
    },
    /// A thin sheet lit from both sides; this share of the light on one side shows on the other.
    Sheet {
        /// 0..1.
        translucency: f32,
    },
}

/// What to put at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// Linear RGB.
    pub albedo: Vec3,
    /// How it shines.
    pub finish: Finish,
    /// 0..1.
    pub opacity: f32,
}

/// A flat Gaussian on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dab {
    /// Metres, world.
    pub centre: Vec3,
    /// Along the first axis, unit.
    pub along: Vec3,
    /// Outwards, unit, across `along`.
    pub normal: Vec3,
    /// Standard deviations along, across, and through the surface.
    pub sigma: Vec3,
    /// Its material.
    pub paint: Paint,
}

impl Dab {
    /// Stands on a surface with these two derivatives; sizes in metres.
    pub fn on(centre: Vec3, du: Vec3, dv: Vec3, sigma: Vec3, paint: Paint) -> Dab {
        let along = du.normalize_or(Vec3::X);
        let normal = along.cross(dv).normalize_or(along.any_orthonormal_vector());
        Dab { centre, along, normal, sigma, paint }
    }

    /// Local axes (along, across, normal) to world.
    pub fn quat(&self) -> Quat {
        Quat::from_mat3(&Mat3::from_cols(self.along, self.normal.cross(self.along), self.normal))
    }
}

/// Standard deviation of a dab in spacings of its neighbours: no holes between them, little blur beyond them.
pub const OVERLAP: f32 = 0.62;

/// Thickness of a dab in widths.
const FLATNESS: f32 = 0.22;

/// Covers a surface, 0..1 by 0..1, with `cells[0]` by `cells[1]` dabs. The normal is du x dv.
/// `jitter` moves each by up to that share of a cell.
pub fn cover(
    dabs: &mut Vec<Dab>,
    cells: [usize; 2],
    jitter: f32,
    random: &mut Random,
    surface: &dyn Fn(f32, f32) -> Vec3,
    paint: &mut dyn FnMut(f32, f32, Vec3) -> Option<Paint>,
) {
    let step = [1.0 / cells[0] as f32, 1.0 / cells[1] as f32];
    for i in 0..cells[0] {
        for j in 0..cells[1] {
            let u = (i as f32 + 0.5 + random.about(jitter)) * step[0];
            let v = (j as f32 + 0.5 + random.about(jitter)) * step[1];
            let centre = surface(u, v);
            if let Some(paint) = paint(u, v, centre) {
                let du = surface(u + 0.25 * step[0], v) - surface(u - 0.25 * step[0], v);
                let dv = surface(u, v + 0.25 * step[1]) - surface(u, v - 0.25 * step[1]);
                dabs.push(cell_dab(centre, du * 2.0, dv * 2.0, paint));
            }
        }
    }
}

/// The dab of one cell whose edges are the vectors `du` and `dv`.
pub fn cell_dab(centre: Vec3, du: Vec3, dv: Vec3, paint: Paint) -> Dab {
    let across = dv - du * (dv.dot(du) / du.length_squared().max(1e-12));
    let (a, b) = (du.length() * OVERLAP, across.length() * OVERLAP);
    Dab::on(centre, du, dv, Vec3::new(a, b, (a.min(b) * FLATNESS).max(2e-4)), paint)
}

/// Linear RGB of a display colour 0xrrggbb (IEC 61966-2-1).
pub fn linear(hex: u32) -> Vec3 {
    let channel = |shift: u32| {
        let c = ((hex >> shift) & 255) as f32 / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::new(channel(16), channel(8), channel(0))
}
