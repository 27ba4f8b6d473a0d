//! One prepared scene alive on the device: step a frame, apply an event, checkpoint, restore,
//! picture, measure.

mod alive;
pub mod ballistics;
pub mod bodies;
pub mod camera;
mod event;
mod facts;
mod figure;
mod impact;
pub mod measure;
mod occupied;
mod prepared;
mod region;
mod resolve;
mod scale;
mod seam;
mod settings;
mod spread;
mod stuff;
mod vain;

pub use alive::{Checkpoint, Step, World};
pub use event::{Effect, TimedEvent};
pub use facts::{Facts, ObjectFacts};
pub use figure::Figure;
pub use prepared::{Prepared, support_below};
pub use resolve::{CELLS_ACROSS_DRAFT, CELLS_ACROSS_FULL, Resolved, resolve};
pub use scale::{ScaleError, check as check_scale};
pub use seam::{Mark, Seam};
pub use stuff::Stuff;
pub use vain::said as asked_in_vain;

/// Raised whenever a spec and its solids give other matter, settings or course of events, or the same motion other pictures.
pub const VERSION: u32 = 1;
