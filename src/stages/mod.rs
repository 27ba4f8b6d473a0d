//! What to do and what to skip: keys, plan with reasons, cache, resume, progress.
//!
//! The stages are few and always these five: `scene`, `proxy`, `bind`, `simulate`, `picture`. Each is
//! a pure function of its declared inputs; its key is a hash of those inputs, the stage's version and
//! its shader text. Equal key, equal bytes on the same device.

mod delivery;
mod derive;
mod engine;
mod error;
pub mod fuzz;
mod keeper;
mod keys;
mod look;
mod metrics;
mod motion;
mod pack;
mod plan;
mod player;
mod reasons;
mod run;
mod segments;
mod still;
mod summary;
#[cfg(test)]
mod tests;

pub use derive::lookup;
pub use engine::{Engine, Report};
pub use error::EngineError;
pub use metrics::{EventMetrics, ExpectationResult, LeftMetrics, MemoryMetrics, Metrics, ObjectMetrics, SolverMetrics, SubstepRange};
pub use plan::{Action, Plan, PlannedStage, Quality, RunOptions, StageName};
pub use player::Player;
pub use still::BUILTIN_DEMO;
