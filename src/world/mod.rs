//! One prepared scene alive on the device: step a frame, apply an event, checkpoint, restore,
//! picture, measure.

mod alive;
pub mod ballistics;
pub mod bodies;
pub mod camera;
mod facts;
mod figure;
pub mod measure;
mod prepared;
mod region;
mod resolve;
mod settings;
mod stuff;

pub use alive::{Effect, Step, TimedEvent, World};
pub use facts::{Facts, ObjectFacts};
pub use figure::Figure;
pub use prepared::{Prepared, support_below};
pub use resolve::{Resolved, resolve};
pub use stuff::Stuff;
