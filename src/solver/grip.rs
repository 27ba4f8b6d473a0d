//! What pins hold: the part of an object that lay in a pin's shape when it was captured, wherever that part is when the
//! pin begins.

use super::core::Solver;
use super::obstacles;
use super::state::ParticleState;
use super::types::{PinRegion, SolverError};
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DQuat, DVec3, DVec4, Mat3, Vec3};

/// Squarings of the matrix whose largest eigenvector is sought: powers up to 2^30.
const SQUARINGS: u32 = 30;

/// How a part was moved from where it was captured: x' = turn (x - centre) + start.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Pose {
    /// Columns.
    pub turn: [[f32; 4]; 3],
    pub centre_m: [f32; 3],
    /// 1 from when the pin holds it.
    begun: u32,
    pub start_m: [f32; 3],
    padding: u32,
}

impl Pose {
    /// Where it was captured.
    pub const CAPTURED: Pose = Pose {
        turn: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        centre_m: [0.0; 3],
        begun: 0,
        start_m: [0.0; 3],
        padding: 0,
    };

    /// The rigid motion that comes nearest to a part's (Horn 1987: the rotation is the largest eigenvector of a matrix).
    fn nearest(captured_m: &[Vec3], now_m: &[Vec3]) -> Pose {
        if captured_m == now_m {
            return Pose::CAPTURED;
        }
        let mean = |of: &[Vec3]| of.iter().map(|x| x.as_dvec3()).sum::<DVec3>() / of.len() as f64;
        let (centre, start) = (mean(captured_m), mean(now_m));
        // Columns: the sum of captured times each component of now.
        let mut s = [DVec3::ZERO; 3];
        for (from, to) in captured_m.iter().zip(now_m) {
            let (from, to) = (from.as_dvec3() - centre, to.as_dvec3() - start);
            (s[0], s[1], s[2]) = (s[0] + from * to.x, s[1] + from * to.y, s[2] + from * to.z);
        }
        let [x, y, z] = s;
        let mut m = DMat4::from_cols(
            DVec4::new(x.x + y.y + z.z, z.y - y.z, x.z - z.x, y.x - x.y),
            DVec4::new(z.y - y.z, x.x - y.y - z.z, y.x + x.y, x.z + z.x),
            DVec4::new(x.z - z.x, y.x + x.y, y.y - x.x - z.z, z.y + y.z),
            DVec4::new(y.x - x.y, x.z + z.x, z.y + y.z, z.z - x.x - y.y),
        );
        let norm = |m: &DMat4| m.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt().max(1e-300);
        // No eigenvalue is negative, so that the largest is that of the largest power.
        m = m * (1.0 / norm(&m)) + DMat4::IDENTITY;
        for _ in 0..SQUARINGS {
            m = m * m;
            m *= 1.0 / norm(&m);
        }
        let columns = [m.x_axis, m.y_axis, m.z_axis, m.w_axis];
        let largest = columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(DVec4::X);
        let [w, i, j, k] = largest.normalize_or(DVec4::X).to_array();
        let turn = Mat3::from_quat(DQuat::from_xyzw(i, j, k, w).normalize().as_quat());
        Pose {
            turn: [turn.x_axis, turn.y_axis, turn.z_axis].map(|axis| axis.extend(0.0).into()),
            centre_m: centre.as_vec3().into(),
            start_m: start.as_vec3().into(),
            ..Pose::CAPTURED
        }
    }
}

/// A pin that has begun, as a checkpoint has it: whatever other pins there are, this one is found again.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Begun {
    /// Which pin it is.
    pin: u64,
    pose: Pose,
}

/// The part that one pin holds.
#[derive(Clone, Debug)]
pub(super) struct Grip {
    /// What the pin holds and from when, as a number: pins of which that is equal hold alike from then on.
    pin: u64,
    object: u32,
    members: Vec<u32>,
    captured_m: Vec<Vec3>,
    pub pose: Pose,
}

impl Grip {
    /// Of particles where they were captured.
    pub fn new(region: &PinRegion, states: &[ParticleState], cell_m: f32) -> Grip {
        let record = obstacles::pin(region, &Pose::CAPTURED, 0, cell_m, 0.0);
        let held = |s: &ParticleState| s.object() == region.object && record.surrounds(s.position_m);
        let (members, captured_m) = (0u32..).zip(states).filter(|(_, s)| held(s)).map(|(i, s)| (i, s.position_m)).unzip();
        Grip { pin: identity(region), object: region.object, members, captured_m, pose: Pose::CAPTURED }
    }

    /// What a checkpoint keeps of it; nothing before it begins.
    pub fn begun(&self) -> Option<Begun> {
        (self.pose.begun != 0).then_some(Begun { pin: self.pin, pose: self.pose })
    }

    /// Holds as it did in a checkpoint, or not yet.
    pub fn resume(&mut self, begun: &[Begun]) {
        self.pose = begun.iter().find(|kept| kept.pin == self.pin).map_or(Pose::CAPTURED, |kept| kept.pose);
    }

    /// Whether it holds anything of an object.
    pub fn holds_of(&self, object: u32) -> bool {
        self.object == object && !self.members.is_empty()
    }
}

/// Of what a pin holds and from when; how it moves and when it ends change nothing of how it began.
fn identity(region: &PinRegion) -> u64 {
    let whole = format!("{} {:?} {:?} {:?} {:?}", region.object, region.shape, region.low_m, region.high_m, region.from_s);
    let hash = blake3::hash(whole.as_bytes());
    hash.as_bytes().iter().take(8).fold(0, |number, byte| number << 8 | u64::from(*byte))
}

impl Solver {
    /// Finds the part that a pin holds, where it begins now.
    pub(super) fn begin_pins(&mut self) -> Result<(), SolverError> {
        let begins = |solver: &Solver, pin: usize| {
            let region = &solver.settings.pins[pin];
            solver.grips[pin].pose.begun == 0 && solver.in_force(region.from_s, region.to_s)
        };
        let new: Vec<usize> = (0..self.grips.len()).filter(|&pin| begins(self, pin)).collect();
        if new.is_empty() {
            return Ok(());
        }
        let states = self.states()?;
        for pin in new {
            let grip = &mut self.grips[pin];
            let now_m: Vec<Vec3> = grip.members.iter().map(|&i| states[i as usize].position_m).collect();
            grip.pose = Pose { begun: 1, ..Pose::nearest(&grip.captured_m, &now_m) };
        }
        Ok(())
    }

    /// Pins of an object that is put somewhere else begin anew.
    pub(super) fn let_go(&mut self, object: u32) {
        self.grips.iter_mut().filter(|grip| grip.object == object).for_each(|grip| grip.pose = Pose::CAPTURED);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn a_rigid_motion_is_found_again_whatever_the_part_looks_like() {
        let solid: Vec<Vec3> = (0..27).map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32 * 0.5, (i / 9) as f32 * 0.2 + 5.0)).collect();
        let flat: Vec<Vec3> = solid.iter().map(|x| x.with_z(0.0)).collect();
        let line: Vec<Vec3> = solid.iter().map(|x| Vec3::X * x.x).collect();
        for part in [solid, flat, line, vec![Vec3::ONE]] {
            for turn in [Quat::from_rotation_x(3.1), Quat::from_scaled_axis(Vec3::new(0.3, -1.2, 0.7)), Quat::IDENTITY] {
                let now: Vec<Vec3> = part.iter().map(|x| turn * (*x - Vec3::Y) + Vec3::new(10.0, -3.0, 0.5)).collect();
                let pose = Pose::nearest(&part, &now);
                let columns = pose.turn.map(|c| Vec3::from_slice(&c));
                let found = Mat3::from_cols(columns[0], columns[1], columns[2]);
                assert!((found.determinant() - 1.0).abs() < 1e-5);
                for (x, y) in part.iter().zip(&now) {
                    let got = found * (*x - Vec3::from(pose.centre_m)) + Vec3::from(pose.start_m);
                    assert!((got - *y).length() < 1e-5, "{x} went to {got}, not {y}");
                }
            }
        }
    }
}
