//! The Gaussians of a scene, one array for each property.

use super::{SceneError, SceneFrame, memory};
use glam::{Mat3, Quat, Vec3};

/// Gaussians in one frame: the file's after reading, the world's after [`Gaussians::to_world`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gaussians {
    /// Centres.
    pub mean: Vec<Vec3>,
    /// Standard deviations along the local axes, linear, in the frame's units.
    pub scale: Vec<Vec3>,
    /// Quaternions w, x, y, z as the file stores them: not always of unit length.
    pub rotation: Vec<[f32; 4]>,
    /// 0 to 1.
    pub opacity: Vec<f32>,
    /// Degree of the spherical harmonics, 0 to 3.
    pub sh_degree: u32,
    /// `(degree + 1)^2` coefficients of three channels a Gaussian, channels innermost. The first is
    /// INRIA's f_dc: colour = 0.5 + 0.28209479 f_dc. Always in the file's frame, whatever the means are in.
    pub sh: Vec<f32>,
}

impl Gaussians {
    /// So many of no size and no opacity, for the file of a name to fill. An error where opening that file takes more memory
    /// than there is.
    pub(super) fn zeros(count: usize, sh_degree: u32, file: &str) -> Result<Gaussians, SceneError> {
        let coefficients = (sh_degree as usize + 1).pow(2);
        memory::probe(count as u64, coefficients as u64, file)?;
        Ok(Gaussians {
            mean: memory::filled(count, Vec3::ZERO, file)?,
            scale: memory::filled(count, Vec3::ZERO, file)?,
            rotation: memory::filled(count, [0.0; 4], file)?,
            opacity: memory::filled(count, 0.0, file)?,
            sh_degree,
            sh: memory::filled(count * coefficients * 3, 0.0, file)?,
        })
    }

    /// Keeps those of ascending indices, in place.
    pub(super) fn retain(&mut self, indices: &[u32]) {
        fn keep<T: Copy>(list: &mut Vec<T>, indices: &[u32], width: usize) {
            for (to, &from) in indices.iter().enumerate() {
                let from = from as usize * width;
                list.copy_within(from..from + width, to * width);
            }
            list.truncate(indices.len() * width);
        }
        let floats = self.sh_coefficients() * 3;
        keep(&mut self.mean, indices, 1);
        keep(&mut self.scale, indices, 1);
        keep(&mut self.rotation, indices, 1);
        keep(&mut self.opacity, indices, 1);
        keep(&mut self.sh, indices, floats);
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.mean.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.mean.is_empty()
    }

    /// Coefficients of each channel.
    pub fn sh_coefficients(&self) -> usize {
        ((self.sh_degree + 1) * (self.sh_degree + 1)) as usize
    }

    /// The rotation of one, of unit length; the identity where the file holds zeros.
    pub fn quat(&self, index: usize) -> Quat {
        let [w, x, y, z] = self.rotation[index];
        let quat = Quat::from_xyzw(x, y, z, w);
        if quat.length_squared() > 0.0 { quat.normalize() } else { Quat::IDENTITY }
    }

    /// Sigma = R S S^T R^T.
    pub fn covariance(&self, index: usize) -> Mat3 {
        let half = Mat3::from_quat(self.quat(index)) * Mat3::from_diagonal(self.scale[index]);
        half * half.transpose()
    }

    /// Smallest and largest corner of the centres; zeros where there are none.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let mut points = self.mean.iter().copied();
        let Some(first) = points.next() else { return (Vec3::ZERO, Vec3::ZERO) };
        points.fold((first, first), |(low, high), p| (low.min(p), high.max(p)))
    }

    /// Those with the given indices, in that order.
    pub fn subset(&self, indices: &[u32]) -> Gaussians {
        let floats = self.sh_coefficients() * 3;
        Gaussians {
            mean: indices.iter().map(|&i| self.mean[i as usize]).collect(),
            scale: indices.iter().map(|&i| self.scale[i as usize]).collect(),
            rotation: indices.iter().map(|&i| self.rotation[i as usize]).collect(),
            opacity: indices.iter().map(|&i| self.opacity[i as usize]).collect(),
            sh_degree: self.sh_degree,
            sh: indices.iter().flat_map(|&i| self.sh[i as usize * floats..(i as usize + 1) * floats].iter().copied()).collect(),
        }
    }

    /// The same Gaussians in the world's frame. Spherical harmonics stay in the file's: whoever
    /// draws them turns the view direction instead.
    pub fn to_world(&self, frame: &SceneFrame) -> Gaussians {
        let turn = frame.quat();
        let turned = |index: usize| {
            let quat = turn * self.quat(index);
            [quat.w, quat.x, quat.y, quat.z]
        };
        Gaussians {
            mean: self.mean.iter().map(|&p| frame.to_world(p)).collect(),
            scale: self.scale.iter().map(|&s| s * frame.metres_per_unit).collect(),
            rotation: (0..self.len()).map(turned).collect(),
            opacity: self.opacity.clone(),
            sh_degree: self.sh_degree,
            sh: self.sh.clone(),
        }
    }

    /// Indices along a Morton curve through the bounds, 21 bits an axis: neighbours in space become
    /// neighbours in memory.
    pub fn morton_order(&self) -> Vec<u32> {
        morton_order(&self.mean)
    }
}

/// Indices of points along a Morton curve through their bounds; equal codes keep their order.
pub fn morton_order(points: &[Vec3]) -> Vec<u32> {
    let (low, high) = points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    let scale = ((1u32 << 21) - 1) as f32 / (high - low).max_element().max(f32::MIN_POSITIVE);
    let code = |p: Vec3| {
        let cell = ((p - low) * scale).clamp(Vec3::ZERO, Vec3::splat(((1u32 << 21) - 1) as f32)).as_u64vec3();
        spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
    };
    let mut order: Vec<(u64, u32)> = points.iter().enumerate().map(|(i, &p)| (code(p), i as u32)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, index)| index).collect()
}

/// Moves each of 21 bits to every third place.
fn spread(bits: u64) -> u64 {
    let mut x = bits & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}
