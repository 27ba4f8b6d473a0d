//! Particles to motion: the elastic solver.
//!
//! MLS-MPM with quadratic splines and APIC. Particles are kept in the order of their cells; each
//! substep is three passes over them and the grid blocks that they reach (`p2g`, `grid`, `g2p`), and
//! every few substeps a sort. A run is cut into segments that end at frames and at changes of its
//! surroundings; nothing is read back inside one, each is watched, and rolled back if it fails.

mod advance;
mod bench;
mod checkpoint;
mod constants;
mod core;
mod grid;
mod obstacles;
mod passes;
mod prestress;
mod state;
mod types;
pub mod validate;
mod watch;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;

pub use bench::{BenchReport, bench_substep};
pub use core::Solver;
pub use passes::{kernels, shader_text};
pub use types::{Advance, Collider, ObjectForce, Particles, PinRegion, Placement, Plane, PrestressReport, Settings, Softened, SolverError};

/// Raised whenever the same input gives other bits.
pub const VERSION: u32 = 5;
