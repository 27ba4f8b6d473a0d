//! Particles to motion.
//!
//! MLS-MPM with quadratic splines and APIC. Particles are kept in the order of their cells; each
//! substep is three passes over them and the grid blocks that they reach (`p2g`, `grid`, `g2p`), and
//! every few substeps a sort. A run is cut into segments that end at frames and at changes of its
//! surroundings; nothing is read back inside one, each is watched, and rolled back if it fails.

// First, for the macro that the sets of passes are written with.
#[macro_use]
mod passes;

mod advance;
mod bench;
mod budget;
mod change;
mod checkpoint;
mod constants;
mod core;
mod encounter;
mod fields;
mod grid;
mod grip;
mod impact;
mod kept;
mod laws;
mod leave;
mod liquid;
mod mend;
mod obstacles;
mod prestress;
mod record;
mod retry;
mod retry_budget;
mod rigid;
mod sph;
mod state;
mod stored;
mod substance;
mod support;
mod transfer;
mod types;
pub mod validate;
mod volume;
mod wary;
mod watch;

use crate::gpu::{Gpu, KernelSource};

#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;

pub use bench::{BenchReport, bench_mixture, bench_sph, bench_sph_second, bench_substep};
pub use budget::shortest_substep_s;
pub use change::Moduli;
pub use checkpoint::Checkpoint;
pub use core::Solver;
pub use fields::velocity_change;
pub use impact::Sight;
pub use obstacles::is_inside;
pub use substance::{Activation, Flow, Substance, liquid_bulk_pa};
pub use types::{
    Advance, Collider, Field, Left, ObjectForce, Particles, PinRegion, Placement, Plane, PrestressReport, Settings, Softened, SolverError, Taut,
};

/// Every pass of the solver, for validation and keys.
pub fn kernels() -> Vec<KernelSource> {
    let mut all = passes::kernels();
    all.extend(laws::kernels());
    all.extend(transfer::kernels());
    all.extend(encounter::kernels());
    all.extend(fields::kernels());
    all.extend(liquid::kernels());
    all.extend(volume::kernels());
    all.extend(sph::kernels());
    all.extend(rigid::all_kernels());
    all
}

/// Compiles the passes that every solver asks for.
pub fn prepare(gpu: &Gpu) {
    gpu.prepare(&[passes::kernels(), transfer::usual(gpu)].concat());
}

/// Shader text of all passes, for the keys of stages.
pub fn shader_text() -> String {
    kernels().iter().map(KernelSource::wgsl).collect()
}

/// Raised whenever the same input gives other bits.
pub const VERSION: u32 = 41;
