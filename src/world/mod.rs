//! One prepared scene alive on the device: step a frame, apply an event, checkpoint, restore,
//! picture, measure.

mod facts;

pub use facts::{Facts, ObjectFacts};
