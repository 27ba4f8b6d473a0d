//! Skinning in plain Rust: what the two passes compute, one particle or Gaussian at a time.

use super::skinner::{PART, POLAR_STEPS, SMALLEST_DETERMINANT, STRETCH};
use super::{Bound, STATIC};
use crate::spec::Weights;
use glam::{Mat3, Quat, Vec3};
use half::f16;

/// What a particle's surroundings do beyond staying: x -> x + offset + linear (x - origin).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delta {
    /// G - I.
    pub linear: Mat3,
    /// Metres.
    pub offset: Vec3,
}

impl Delta {
    /// Rest.
    pub const ZERO: Delta = Delta { linear: Mat3::ZERO, offset: Vec3::ZERO };

    /// Where a point goes, less the point; `point` is relative to the origin.
    fn carry(self, point: Vec3) -> Vec3 {
        self.offset + self.linear * point
    }

    fn is_finite(self) -> bool {
        self.linear.is_finite() && self.offset.is_finite()
    }
}

/// What the deltas of a scene are relative to.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Metres, world.
    pub origin: Vec3,
    /// Metres.
    pub span_m: f32,
}

pub(super) fn smoothstep([low, high]: [f32; 2], value: f32) -> f32 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The eight words in which the solver gives a particle's motion: its position as f32, then G - I as
/// halves, rows first.
pub fn pack_motion(position: Vec3, linear: Mat3) -> [u32; 8] {
    let rows = linear.transpose().to_cols_array();
    let half = |i: usize| rows.get(i).map_or(0, |&v| u32::from(f16::from_f32(v).to_bits()));
    let [x, y, z] = position.to_array().map(f32::to_bits);
    let pair = |i: usize| half(i) | half(i + 1) << 16;
    [x, y, z, pair(0), pair(2), pair(4), pair(6), pair(8)]
}

/// Pass `skin.delta`: the map of one particle from its motion and its captured position.
pub fn delta(motion: [u32; 8], rest: Vec3, origin: Vec3, weights: Weights) -> Delta {
    let half = |i: usize| f16::from_bits((motion[3 + i / 2] >> (16 * (i % 2))) as u16).to_f32();
    let linear = Mat3::from_cols_array(&std::array::from_fn(half)).transpose();
    let position = Vec3::new(f32::from_bits(motion[0]), f32::from_bits(motion[1]), f32::from_bits(motion[2]));
    of(position, linear, rest, origin, weights)
}

/// The map of one particle from its position and G - I in full precision.
pub fn of(position: Vec3, linear: Mat3, rest: Vec3, origin: Vec3, weights: Weights) -> Delta {
    let from_origin = rest - origin;
    let moved = position - origin - from_origin;
    let offset = if weights == Weights::Paper { moved } else { moved - linear * from_origin };
    Delta { linear, offset }
}

/// Pass `skin.blend`: the record of one Gaussian (see [`super::Splats`]) from its rest's record.
///
/// `frame` has the point that deltas are relative to, and the span within which particles carry a
/// Gaussian together (see [`super::skinner::PART`]).
pub fn blend(rest: &[f32; 16], gaussian: usize, bound: &Bound, deltas: &[Delta], frame: Frame, weights: Weights) -> [f32; 16] {
    let origin = frame.origin;
    let k = bound.neighbours as usize;
    let index = &bound.index[gaussian * k..(gaussian + 1) * k];
    let weight = &bound.weight[gaussian * k..(gaussian + 1) * k];
    if index[0] == STATIC {
        return *rest;
    }
    let centre = Vec3::from_slice(rest);
    let held_at = bound.held_at(gaussian as u32).filter(|_| weights == Weights::Exact);
    let root = held_at.unwrap_or(centre) - origin;
    let nearest = deltas[index[0] as usize];
    let weighed = |weight: &[f32]| {
        index.iter().zip(weight).fold(Delta::ZERO, |sum, (&i, &w)| {
            let d = deltas[i as usize];
            Delta { linear: sum.linear + d.linear * w, offset: sum.offset + d.offset * w }
        })
    };
    let mut sum = weighed(weight);
    if weights == Weights::Exact
        && sum.is_finite()
        && let Some(kept) = parted(root, index, weight, deltas, frame)
    {
        let total: f32 = kept.iter().sum();
        let part = weighed(&kept);
        sum = Delta { linear: part.linear * (1.0 / total), offset: part.offset / total };
    }
    let d = [sum, nearest].into_iter().find(|d| d.is_finite()).unwrap_or(Delta::ZERO);
    let mut record = *rest;
    let mut moved = if weights == Weights::Paper { d.offset } else { d.carry(root) };
    if d.linear != Mat3::ZERO {
        let lever = held_at.map(|_| centre - origin - root);
        moved += deform(&mut record, d, nearest, weights, lever);
    }
    record[..3].copy_from_slice(&(centre + moved).to_array());
    record
}

/// The weights that particles which stay near the nearest one keep; none where all stay.
fn parted(c: Vec3, index: &[u32], weight: &[f32], deltas: &[Delta], frame: Frame) -> Option<Vec<f32>> {
    let there = deltas[index[0] as usize].carry(c);
    let spans = |i: u32| (deltas[i as usize].carry(c) - there).length() / frame.span_m;
    let parts = index.iter().zip(weight).any(|(&i, &w)| w > 0.0 && spans(i) > PART[0]);
    parts.then(|| index.iter().zip(weight).map(|(&i, w)| w * (1.0 - smoothstep(PART, spans(i)))).collect())
}

/// Turns and stretches a record's covariance and the frame of its spherical harmonics; what hangs on a thread only turns. How far
/// that carries the end of its lever.
fn deform(record: &mut [f32; 16], d: Delta, nearest: Delta, weights: Weights, lever: Option<Vec3>) -> Vec3 {
    let mut f = Mat3::IDENTITY + d.linear;
    let mut carried = Vec3::ZERO;
    if weights == Weights::Exact {
        let candidates = [f, Mat3::IDENTITY + nearest.linear];
        f = candidates.into_iter().find(|f| f.is_finite() && f.determinant() >= SMALLEST_DETERMINANT).unwrap_or(Mat3::IDENTITY);
        let r = polar_rotation(f);
        f = limited(f, r);
        if let Some(lever) = lever {
            f = r;
            carried = r * lever - lever;
        }
        let turn = (Quat::from_mat3(&r) * Quat::from_slice(&record[12..])).normalize();
        turn.write_to_slice(&mut record[12..]);
    }
    let c = f * covariance_of(record) * f.transpose();
    record[4..10].copy_from_slice(&[c.x_axis.x, c.x_axis.y, c.x_axis.z, c.y_axis.y, c.y_axis.z, c.z_axis.z]);
    carried
}

/// Of a record.
pub(super) fn covariance_of(record: &[f32; 16]) -> Mat3 {
    let [xx, xy, xz, yy, yz, zz] = [record[4], record[5], record[6], record[7], record[8], record[9]];
    Mat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
}

/// The rotation R of F = R S for a positive determinant, by Newton's iteration (Higham 1986).
pub fn polar_rotation(f: Mat3) -> Mat3 {
    let mut r = f;
    for _ in 0..POLAR_STEPS {
        let next = (r + r.inverse().transpose()) * 0.5;
        let change: f32 = (next - r).to_cols_array().iter().map(|v| v * v).sum();
        r = next;
        if change < 1e-12 {
            break;
        }
    }
    r
}

/// F with its principal stretches held within [`STRETCH`].
fn limited(f: Mat3, r: Mat3) -> Mat3 {
    let (stretch, axes) = eigen(r.transpose() * f);
    let held = stretch.clamp(Vec3::splat(STRETCH[0]), Vec3::splat(STRETCH[1]));
    if held == stretch { f } else { r * axes * Mat3::from_diagonal(held) * axes.transpose() }
}

/// Eigenvalues and vectors of a symmetric matrix, by Jacobi's method.
pub(super) fn eigen(matrix: Mat3) -> (Vec3, Mat3) {
    let mut s = (matrix + matrix.transpose()) * 0.5;
    let mut v = Mat3::IDENTITY;
    for step in 0..3 * super::skinner::JACOBI_SWEEPS {
        let (i, j) = [(0, 1), (0, 2), (1, 2)][step as usize % 3];
        let off = s.col(i)[j];
        if off.abs() < 1e-12 {
            continue;
        }
        let theta = (s.col(j)[j] - s.col(i)[i]) / (2.0 * off);
        let t = 1.0f32.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
        let c = 1.0 / (t * t + 1.0).sqrt();
        let mut turn = Mat3::IDENTITY;
        (turn.col_mut(i)[i], turn.col_mut(j)[j]) = (c, c);
        (turn.col_mut(j)[i], turn.col_mut(i)[j]) = (t * c, -t * c);
        s = turn.transpose() * s * turn;
        v *= turn;
    }
    (Vec3::new(s.x_axis.x, s.y_axis.y, s.z_axis.z), v)
}
