//! Liquids of smoothed particles in cases that no constant of theirs was set by. Not among them is a drop that spreads on a wall
//! without weight: half a ball of five cells comes to stand as high as a cap of 79 degrees, where the angle of contact is 60.

use super::Check;
use super::sph::{channel, mean_of};
use crate::gpu::Gpu;
use crate::solver::types::SolverError;

/// V20: a channel that has only begun to flow.
pub(super) fn viscous(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let source = "Fourier 1822; Poiseuille 1840, between planes: u_t = g + nu u''";
    let row = |(name, share)| {
        let [expected, measured] = channel(gpu, 20, 30.0, |w, nu| share * w * w / nu)?;
        let check = Check::new(name, "mean of g x (W - x) / (2 nu) less the modes still to come", source, "m/s");
        Ok(check.compare(mean_of(&expected), mean_of(&measured), 0.05))
    };
    [("V20 SPH held out, channel at nu t = 0.04 W^2", 0.04), ("V20 SPH held out, channel at nu t = 0.12 W^2", 0.12)].into_iter().map(row).collect()
}
