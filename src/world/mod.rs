//! One prepared scene alive on the device: step a frame, apply an event, checkpoint, restore,
//! picture, measure.

pub mod ballistics;
pub mod camera;
mod facts;
pub mod measure;
mod prepared;
mod resolve;

pub use facts::{Facts, ObjectFacts};
pub use prepared::{Prepared, support_below};
pub use resolve::{Resolved, resolve};
