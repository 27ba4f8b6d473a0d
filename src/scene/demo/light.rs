//! The light of the scene, baked: a bright room, a large soft window to the viewer's left, a cool
//! glow behind. Each dab receives it past what stands in the way, and what its finish sends
//! to each side becomes spherical harmonics.

use super::super::Gaussians;
use super::dab::{Dab, Finish};
use super::random::smooth;
use super::shade::Shade;
use glam::Vec3;
use rayon::prelude::*;

/// Towards the window.
const WINDOW: Vec3 = Vec3::new(-0.62, 0.36, 0.70);
/// Irradiance of a surface that faces the window.
const WINDOW_LIGHT: Vec3 = Vec3::new(1.95, 1.80, 1.56);
/// Towards the glow behind.
const GLOW: Vec3 = Vec3::new(0.66, -0.52, 0.54);
/// Irradiance of a surface that faces the glow.
const GLOW_LIGHT: Vec3 = Vec3::new(0.34, 0.40, 0.50);
/// Directions over the sphere that gather the light of the room.
const ROOM_RAYS: usize = 60;
/// Directions over the window, for soft shadows.
const WINDOW_RAYS: usize = 14;
/// Views from which a coat is looked at.
const VIEWS: usize = 48;
/// How much the higher harmonics are held back.
const STIFFNESS: f32 = 1.2e-4;

/// Radiance of the room itself from a direction: bright ceiling, dimmer walls, the floor's warm return.
fn room(d: Vec3) -> Vec3 {
    let (up, down) = (smooth(-0.1, 0.9, d.z), smooth(0.1, -0.6, d.z));
    let wall = Vec3::new(0.40, 0.41, 0.45);
    let ceiling = Vec3::new(0.70, 0.75, 0.84);
    let floor = Vec3::new(0.24, 0.20, 0.17);
    wall.lerp(ceiling, up).lerp(floor, down)
}

/// The room with its two lights as a coat of some roughness mirrors it.
fn mirrored(d: Vec3, roughness: f32) -> Vec3 {
    let sharpness = 4.0 + 22.0 * (1.0 - roughness) * (1.0 - roughness);
    let lobe = |towards: Vec3| (sharpness * (d.dot(towards.normalize()) - 1.0)).exp();
    room(d) + WINDOW_LIGHT * (lobe(WINDOW) * 0.28 * sharpness) + GLOW_LIGHT * (lobe(GLOW) * 0.16 * sharpness)
}

/// Evenly spread directions (Fibonacci lattice) within a polar range of +z: cosines from 1 down to `lowest`.
pub(super) fn spread(count: usize, lowest: f32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let z = 1.0 - (1.0 - lowest) * (i as f32 + 0.5) / count as f32;
        let turn = i as f32 * 2.399_963_2;
        let side = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(side * turn.cos(), side * turn.sin(), z)
    })
}

/// Directions about an axis instead of +z.
pub(super) fn about(axis: Vec3, d: Vec3) -> Vec3 {
    let (a, b) = axis.any_orthonormal_pair();
    a * d.x + b * d.y + axis * d.z
}

/// Rays that every dab sends.
struct Rays {
    room: Vec<Vec3>,
    window: Vec<Vec3>,
    glow: Vec3,
    views: Vec<Vec3>,
}

impl Rays {
    fn new() -> Rays {
        let window = WINDOW.normalize();
        Rays {
            room: spread(ROOM_RAYS, -1.0).collect(),
            window: spread(WINDOW_RAYS, 0.965).map(|d| about(window, d)).collect(),
            glow: GLOW.normalize(),
            views: spread(VIEWS, -0.2).collect(),
        }
    }

    /// Irradiance over pi of the front of a surface and, where asked for, of its back.
    fn gather(&self, point: Vec3, normal: Vec3, shade: &dyn Shade, back_too: bool) -> [Vec3; 2] {
        let mut light = [Vec3::ZERO; 2];
        let mut add = |d: Vec3, radiance: Vec3| {
            let cosine = d.dot(normal);
            if cosine > 0.0 || back_too {
                light[usize::from(cosine < 0.0)] += radiance * (cosine.abs() * shade.passes(point, d));
            }
        };
        self.room.iter().for_each(|&d| add(d, room(d) * (4.0 / ROOM_RAYS as f32)));
        self.window.iter().for_each(|&d| add(d, WINDOW_LIGHT / WINDOW_RAYS as f32));
        add(self.glow, GLOW_LIGHT);
        light
    }
}

/// Lights dabs past what shades them and adds them to the scene, spherical harmonics of degree 3.
pub fn bake(dabs: &[Dab], shade: &(dyn Shade + Sync), g: &mut Gaussians) {
    let rays = Rays::new();
    let lit: Vec<[Vec3; 16]> = dabs.par_iter().map_init(|| Fit::new(Vec3::Z, &rays.views), |fit, dab| harmonics(dab, shade, &rays, fit)).collect();
    for (dab, sh) in dabs.iter().zip(lit) {
        let q = dab.quat();
        g.mean.push(dab.centre);
        g.scale.push(dab.sigma);
        g.rotation.push([q.w, q.x, q.y, q.z]);
        g.opacity.push(dab.paint.opacity);
        g.sh.extend(sh.iter().flat_map(|c| c.to_array()));
    }
}

/// What a dab sends to each side, as coefficients. `fit` is kept from dab to dab: flat faces share a normal.
fn harmonics(dab: &Dab, shade: &dyn Shade, rays: &Rays, fit: &mut Fit) -> [Vec3; 16] {
    let (n, albedo) = (dab.normal, dab.paint.albedo);
    match dab.paint.finish {
        Finish::Sheet { translucency } => {
            let [front, back] = rays.gather(dab.centre, n, shade, true);
            let front_colour = display(albedo * (front + translucency * back));
            let back_colour = display(albedo * (back + translucency * front));
            two_sided(front_colour, back_colour, n)
        }
        Finish::Coated { reflectance, roughness } => {
            let [light, _] = rays.gather(dab.centre, n, shade, false);
            let diffuse = albedo * light;
            // A coat mirrors what is not hidden: as much of it as reaches the surface.
            let open = (light.element_sum() / 3.0 / 1.1).clamp(0.1, 1.0);
            if fit.normal != n {
                *fit = Fit::new(n, &rays.views);
            }
            fit.coefficients(&|view: Vec3| {
                let cosine = view.dot(n).max(0.08);
                let fresnel = reflectance + (1.0 - reflectance) * (1.0 - cosine).powi(5) * (1.0 - roughness);
                display(diffuse * (1.0 - fresnel) + mirrored(2.0 * cosine * n - view, roughness) * (fresnel * open))
            })
        }
    }
}

/// Linear light to what a display shows: a shoulder that keeps highlights, then the sRGB curve.
fn display(light: Vec3) -> Vec3 {
    let exposed = light * 0.70;
    // Narkowicz's fit of the ACES curve, 2015.
    let c = (exposed * (2.51 * exposed + 0.03)) / (exposed * (2.43 * exposed + 0.59) + 0.14);
    let encode = |c: f32| if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    Vec3::from_array(c.clamp(Vec3::ZERO, Vec3::ONE).to_array().map(encode))
}

const C1: f32 = 0.488_602_5;

/// The real spherical harmonics of a direction, signs as INRIA's.
pub(super) fn basis(d: Vec3) -> [f32; 16] {
    let Vec3 { x, y, z } = d;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    [
        super::super::SH_C0,
        -C1 * y,
        C1 * z,
        -C1 * x,
        1.092_548_4 * x * y,
        -1.092_548_4 * y * z,
        0.315_391_57 * (2.0 * zz - xx - yy),
        -1.092_548_4 * x * z,
        0.546_274_2 * (xx - yy),
        -0.590_043_6 * y * (3.0 * xx - yy),
        2.890_611_4 * x * y * z,
        -0.457_045_8 * y * (4.0 * zz - xx - yy),
        0.373_176_33 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy),
        -0.457_045_8 * x * (4.0 * zz - xx - yy),
        1.445_305_7 * z * (xx - yy),
        -0.590_043_6 * x * (xx - 3.0 * yy),
    ]
}

/// One colour in front, another behind, a straight ramp of the cosine between.
pub(super) fn two_sided(front: Vec3, back: Vec3, normal: Vec3) -> [Vec3; 16] {
    let (mean, slope) = ((front + back) / 2.0, (front - back) / 2.0 / C1);
    let mut sh = [Vec3::ZERO; 16];
    sh[0] = (mean - 0.5) / super::super::SH_C0;
    // The renderer's direction runs from the eye to the Gaussian, against the view of it.
    sh[1] = slope * normal.y;
    sh[2] = -slope * normal.z;
    sh[3] = slope * normal.x;
    sh
}

/// The coefficients that come closest to a colour over the views in front of a surface. Behind it
/// nothing is ever seen, which leaves them free to be sharper in front; a little stiffness keeps them tame.
pub(super) struct Fit {
    normal: Vec3,
    /// Directions from the surface to the eye, and the harmonics of the opposite.
    views: Vec<(Vec3, [f32; 16])>,
    /// Cholesky's lower triangle of the normal equations.
    lower: [[f32; 16]; 16],
}

impl Fit {
    pub(super) fn new(normal: Vec3, views: &[Vec3]) -> Fit {
        let views: Vec<(Vec3, [f32; 16])> = views.iter().map(|&local| about(normal, local)).map(|view| (view, basis(-view))).collect();
        let mut lower = [[0.0_f32; 16]; 16];
        for (_, y) in &views {
            for i in 0..16 {
                for j in 0..=i {
                    lower[i][j] += y[i] * y[j];
                }
            }
        }
        for i in 0..16 {
            let degree = (i as f32).sqrt().floor();
            lower[i][i] += views.len() as f32 * (2e-6 + STIFFNESS * degree * degree);
            for j in 0..=i {
                let dot: f32 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
                lower[i][j] = if i == j { (lower[i][j] - dot).max(1e-9).sqrt() } else { (lower[i][j] - dot) / lower[j][j] };
            }
        }
        Fit { normal, views, lower }
    }

    pub(super) fn coefficients(&self, sent: &dyn Fn(Vec3) -> Vec3) -> [Vec3; 16] {
        let mut b = [Vec3::ZERO; 16];
        for (view, y) in &self.views {
            let colour = sent(*view) - 0.5;
            b.iter_mut().zip(y).for_each(|(b, y)| *b += colour * *y);
        }
        let lower = &self.lower;
        for i in 0..16 {
            let known = (0..i).fold(Vec3::ZERO, |s, k| s + b[k] * lower[i][k]);
            b[i] = (b[i] - known) / lower[i][i];
        }
        for i in (0..16).rev() {
            let known = (i + 1..16).fold(Vec3::ZERO, |s, k| s + b[k] * lower[k][i]);
            b[i] = (b[i] - known) / lower[i][i];
        }
        b
    }
}
