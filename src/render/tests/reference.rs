//! A slow renderer in f64: every Gaussian against every pixel it may reach, no bins, no sort keys.

use crate::render::{Profile, View};
use crate::scene::Gaussians;
use glam::{DMat3, DQuat, DVec3};

/// One pixel of the reference.
#[derive(Clone, Copy)]
pub struct Pixel {
    pub colour: DVec3,
    pub transmittance: f64,
    /// Sum of w z.
    pub depth: f64,
    /// Largest weight, and the Gaussian that has it.
    pub heaviest: (f64, u32),
    /// How close any decision of this pixel came to going the other way: smallest distance of an
    /// alpha to its cut, or of a transmittance to the stop, relative.
    pub margin: f64,
    ended: bool,
}

impl Pixel {
    /// Colour over a background, as bytes.
    pub fn bytes(&self, background: DVec3) -> [u8; 3] {
        let rgb = (self.colour + self.transmittance * background).clamp(DVec3::ZERO, DVec3::ONE) * 255.0;
        [rgb.x, rgb.y, rgb.z].map(|c| (c + 0.5).floor() as u8)
    }
}

struct Projected {
    index: u32,
    centre: [f64; 2],
    z: f64,
    conic: [f64; 3],
    reach: [f64; 2],
    opacity: f64,
    colour: DVec3,
}

/// Draws Gaussians whose spherical harmonics are turned by `world_from_sh`, with the opacity-aware
/// extent (profiles Gsplat and Antialiased).
pub fn draw(gaussians: &Gaussians, world_from_sh: DQuat, view: &View, profile: Profile) -> Vec<Pixel> {
    let c = profile.constants();
    let mut projected: Vec<Projected> = (0..gaussians.len()).filter_map(|i| project(gaussians, i, world_from_sh, view, profile)).collect();
    projected.sort_by(|a, b| a.z.total_cmp(&b.z).then(a.index.cmp(&b.index)));
    let fresh = Pixel { colour: DVec3::ZERO, transmittance: 1.0, depth: 0.0, heaviest: (0.0, u32::MAX), margin: f64::INFINITY, ended: false };
    let mut pixels = vec![fresh; (view.width * view.height) as usize];
    for p in &projected {
        let span = |axis: usize, limit: u32| {
            let low = (p.centre[axis] - p.reach[axis] - 2.0).clamp(0.0, f64::from(limit)) as u32;
            let high = (p.centre[axis] + p.reach[axis] + 2.0).clamp(0.0, f64::from(limit)) as u32;
            low..high
        };
        for y in span(1, view.height) {
            for x in span(0, view.width) {
                let pixel = &mut pixels[(y * view.width + x) as usize];
                let (dx, dy) = (f64::from(x) + 0.5 - p.centre[0], f64::from(y) + 0.5 - p.centre[1]);
                let power = 0.5 * (p.conic[0] * dx * dx + p.conic[2] * dy * dy) + p.conic[1] * dx * dy;
                let alpha = (p.opacity * (-power).exp()).min(f64::from(c.opacity_cap));
                blend(pixel, p, alpha, f64::from(c.alpha_min), f64::from(c.stop));
            }
        }
    }
    pixels
}

fn blend(pixel: &mut Pixel, p: &Projected, alpha: f64, alpha_min: f64, stop: f64) {
    if pixel.ended {
        return;
    }
    pixel.margin = pixel.margin.min((alpha / alpha_min - 1.0).abs());
    if alpha < alpha_min {
        return;
    }
    let next = pixel.transmittance * (1.0 - alpha);
    pixel.margin = pixel.margin.min((next / stop - 1.0).abs());
    if next <= stop {
        pixel.ended = true;
        return;
    }
    let weight = pixel.transmittance * alpha;
    pixel.colour += weight * p.colour;
    pixel.depth += weight * p.z;
    if weight > pixel.heaviest.0 {
        pixel.heaviest = (weight, p.index);
    }
    pixel.transmittance = next;
}

fn project(g: &Gaussians, i: usize, world_from_sh: DQuat, view: &View, profile: Profile) -> Option<Projected> {
    let c = profile.constants();
    let camera = view.world_to_camera.as_dmat4();
    let mean = g.mean[i].as_dvec3();
    let at = camera.transform_point3(mean);
    if at.z <= 0.01 {
        return None;
    }
    let [fx, fy, cx, cy] = [view.fx, view.fy, view.cx, view.cy].map(f64::from);
    let [w, h] = [view.width, view.height].map(f64::from);
    let tangent = |t: f64, centre: f64, size: f64, f: f64| t.clamp(-(centre / f + 0.15 * size / f), (size - centre) / f + 0.15 * size / f);
    let (tx, ty) = (tangent(at.x / at.z, cx, w, fx), tangent(at.y / at.z, cy, h, fy));

    let [qw, qx, qy, qz] = g.rotation[i].map(f64::from);
    let half = DMat3::from_quat(DQuat::from_xyzw(qx, qy, qz, qw).normalize()) * DMat3::from_diagonal(g.scale[i].as_dvec3());
    let half = DMat3::from_mat4(camera) * half;
    let sigma = half * half.transpose();
    let to_x = DVec3::new(fx / at.z, 0.0, -fx * tx / at.z);
    let to_y = DVec3::new(0.0, fy / at.z, -fy * ty / at.z);
    let (a, b, d) = (to_x.dot(sigma * to_x), to_x.dot(sigma * to_y), to_y.dot(sigma * to_y));
    let dilation = f64::from(c.dilation);
    let (xx, yy) = (a + dilation, d + dilation);
    let det = xx * yy - b * b;
    let mut opacity = f64::from(g.opacity[i]);
    if c.compensation_floor > 0.0 {
        opacity *= ((a * d - b * b).max(0.0) / det).sqrt().max(f64::from(c.compensation_floor));
    }
    if opacity < f64::from(c.alpha_min) {
        return None;
    }
    let reach = (2.0 * (opacity / f64::from(c.alpha_min)).ln()).sqrt();
    let eye = camera.inverse().transform_point3(DVec3::ZERO);
    Some(Projected {
        index: i as u32,
        centre: [fx * at.x / at.z + cx, fy * at.y / at.z + cy],
        z: at.z,
        conic: [yy / det, -b / det, xx / det],
        reach: [reach * xx.sqrt(), reach * yy.sqrt()],
        opacity,
        colour: colour(g, i, world_from_sh.inverse() * (mean - eye).normalize()),
    })
}

/// Real spherical harmonics, degrees 0 to 3, written out as polynomials.
fn colour(g: &Gaussians, i: usize, d: DVec3) -> DVec3 {
    let DVec3 { x, y, z } = d;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let basis = [
        0.28209479177387814,
        -0.4886025119029199 * y,
        0.4886025119029199 * z,
        -0.4886025119029199 * x,
        1.0925484305920792 * x * y,
        -1.0925484305920792 * y * z,
        0.31539156525252005 * (2.0 * zz - xx - yy),
        -1.0925484305920792 * x * z,
        0.5462742152960396 * (xx - yy),
        -0.5900435899266435 * y * (3.0 * xx - yy),
        2.890611442640554 * x * y * z,
        -0.4570457994644658 * y * (4.0 * zz - xx - yy),
        0.3731763325901154 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy),
        -0.4570457994644658 * x * (4.0 * zz - xx - yy),
        1.445305721320277 * z * (xx - yy),
        -0.5900435899266435 * x * (xx - 3.0 * yy),
    ];
    let coefficients = g.sh_coefficients();
    let mine = &g.sh[3 * coefficients * i..3 * coefficients * (i + 1)];
    let sum: DVec3 =
        (0..coefficients).map(|k| basis[k] * DVec3::new(f64::from(mine[3 * k]), f64::from(mine[3 * k + 1]), f64::from(mine[3 * k + 2]))).sum();
    (sum + 0.5).max(DVec3::ZERO)
}
