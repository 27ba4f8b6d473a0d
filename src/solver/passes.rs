//! The solver's kernels, and their compiled set.

/// Bytes of the immediates of a pass of the substep.
pub(super) const SUBSTEP: u32 = 24;
/// Bytes of the immediates of a kick.
const KICK: u32 = 32;

macro_rules! shader {
    ($name:literal) => {
        (concat!("solver/", $name, ".wgsl"), include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/solver/", $name, ".wgsl")))
    };
}

/// A set of compiled passes, a pass a line: name, parts after `common`, bindings, bytes of immediates.
macro_rules! passes {
    ($(#[$doc:meta])* $set:ident; $($name:ident: [$($part:literal),*] [$($access:expr),*] $immediate_bytes:expr;)*) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub(in crate::solver) struct $set {
            $(pub $name: $crate::gpu::Kernel,)*
        }

        impl $set {
            pub fn new(gpu: &$crate::gpu::Gpu) -> $set {
                gpu.prepare(&kernels());
                $set { $($name: gpu.kernel(&sources::$name()),)* }
            }
        }

        /// Every pass of the set, for validation and keys.
        pub(in crate::solver) fn kernels() -> Vec<$crate::gpu::KernelSource> {
            vec![$(sources::$name()),*]
        }

        mod sources {
            #[allow(unused_imports)]
            use super::*;
            use $crate::gpu::Access::{Read, Write};
            use $crate::gpu::KernelSource;
            use $crate::solver::constants;

            $(pub(super) fn $name() -> KernelSource {
                KernelSource {
                    label: concat!("solver.", stringify!($name)),
                    entry: "main",
                    parts: vec![shader!("common"), $(shader!($part)),*],
                    constants: constants::all(),
                    bindings: vec![$($access),*],
                    immediate_bytes: $immediate_bytes,
                }
            })*
        }
    };
}

passes! {
    /// The passes of MLS-MPM; [`super::transfer`] has those that depend on the device.
    Passes;
    bin: ["control", "cell", "particle", "bin"] [Read, Read, Read, Write, Write, Write] 0;
    scan_sums: ["chunk", "scan", "scan_sums"] [Read, Read, Write] 0;
    scan_blocks: ["control", "chunk", "scan", "scan_blocks"] [Write, Write, Read, Write, Write, Write, Write, Write] 0;
    count: ["cell", "count"] [Read, Read, Read, Write] 0;
    scan_cells: ["control", "scan", "scan_cells"] [Read, Read, Read, Read, Write, Write, Write] 0;
    scatter: ["cell", "scatter"] [Read, Read, Read, Write, Read, Write] 0;
    order: ["control", "hand_on", "order"] [Read, Read, Read, Read, Write, Write, Read, Read, Write, Read] 0;
    regroup: ["control", "cell", "hand_on", "regroup"] [Read, Read, Read, Write, Write, Read, Read, Write] 0;
    stress: ["control", "substep", "substance", "material", "elastic_only", "particle", "particle_write", "stress"] [Read, Write, Read, Write, Read] SUBSTEP;
    grid: ["control", "substep", "contact", "node", "pin", "grid_dry", "grid"] [Read, Read, Read, Read, Write, Write, Write, Write, Write] SUBSTEP;
    measure: ["control", "substance", "particle", "measure"] [Read, Read, Read, Write, Read] 0;
    kick: ["particle", "particle_write", "kick_of", "kick"] [Read, Write, Read] KICK;
    prestress_gather: ["control", "substep", "substance", "material", "elastic_only", "particle", "particle_write", "prestress", "gather", "prestress_gather"] [Read, Write, Write, Read, Write, Read] SUBSTEP;
    prestress_residual: ["control", "substep", "contact", "node", "pin", "prestress", "prestress_sum", "prestress_residual"] [Read, Read, Read, Read, Write, Write, Write, Write, Write, Write] SUBSTEP;
    prestress_product: ["control", "substep", "prestress", "prestress_sum", "prestress_product"] [Read, Read, Write, Write, Write, Write, Write] SUBSTEP;
    prestress_control: ["substep", "prestress", "prestress_sum", "prestress_control"] [Read, Read, Read, Write] SUBSTEP;
    prestress_update: ["substep", "prestress", "prestress_sum", "prestress_update"] [Read, Read, Read, Write, Write, Write] SUBSTEP;
    frame: ["substance", "particle", "frame"] [Read, Read, Read, Read, Write, Write, Read, Read] 0;
}
