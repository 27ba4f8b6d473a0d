//! Gaussians on the device, as the renderer reads them and skinning writes them.

use crate::gpu::{Gpu, GpuError};
use crate::scene::Gaussians;
use glam::Quat;

/// Buffers of one scene's Gaussians. `geometry` is four vec4 a Gaussian, interleaved:
/// (mean, opacity), (cov xx, xy, xz, yy), (cov yz, zz, shade, 0), (quaternion x, y, z, w that turns
/// the frame of the spherical harmonics into the world). World frame, metres. `shade` is the factor
/// of the contact shadow, 1 where there is none. Particles that are drawn themselves have in place of that 0 one more than how much
/// they shine, and in place of the quaternion the way out of their surface, longer the more it is one, to 1.
#[derive(Clone, Debug)]
pub struct Splats {
    /// How many.
    pub count: u32,
    /// The captured pose, never written.
    pub rest: wgpu::Buffer,
    /// The pose to draw; equals `rest` until skinning writes it.
    pub geometry: wgpu::Buffer,
    /// Spherical harmonics in planes of vec4: float f of Gaussian g is component f % 4 of `sh[(f / 4) * count + g]`.
    pub sh: wgpu::Buffer,
    /// Their degree, 0 to 3.
    pub sh_degree: u32,
    /// Index of the object each Gaussian belongs to, `u32::MAX` where it is static.
    pub object: wgpu::Buffer,
}

impl Splats {
    /// Uploads Gaussians of the world's frame whose spherical harmonics are turned by `world_from_sh`. What `object` has past
    /// them is room for more, which are not seen until something writes them.
    pub fn new(gpu: &Gpu, gaussians: &Gaussians, world_from_sh: Quat, object: &[u32]) -> Result<Splats, GpuError> {
        let mut geometry: Vec<[f32; 16]> = (0..gaussians.len()).map(|i| record(gaussians, i, world_from_sh)).collect();
        geometry.resize(object.len().max(gaussians.len()), [0.0; 16]);
        Ok(Splats {
            count: geometry.len() as u32,
            rest: gpu.storage_from("splats.rest", &geometry)?,
            geometry: gpu.storage_from("splats.geometry", &geometry)?,
            sh: gpu.storage_from("splats.sh", &planes(gaussians, geometry.len()))?,
            sh_degree: gaussians.sh_degree,
            object: gpu.storage_from("splats.object", object)?,
        })
    }
}

/// The four vec4 of one Gaussian.
fn record(gaussians: &Gaussians, index: usize, turn: Quat) -> [f32; 16] {
    let (m, s) = (gaussians.mean[index], gaussians.covariance(index));
    let (cx, cy, cz) = (s.x_axis, s.y_axis, s.z_axis);
    [m.x, m.y, m.z, gaussians.opacity[index], cx.x, cx.y, cx.z, cy.y, cy.z, cz.z, 1.0, 0.0, turn.x, turn.y, turn.z, turn.w]
}

/// Interleaved coefficients to planes of vec4, so that neighbouring lanes read neighbouring words.
fn planes(gaussians: &Gaussians, count: usize) -> Vec<[f32; 4]> {
    let floats = gaussians.sh_coefficients() * 3;
    let mut planes = vec![[0.0; 4]; floats.div_ceil(4) * count];
    for (g, coefficients) in gaussians.sh.chunks_exact(floats).enumerate() {
        for (f, value) in coefficients.iter().enumerate() {
            planes[(f / 4) * count + g][f % 4] = *value;
        }
    }
    planes
}
