//! Everything that is fuzzed, one file each.

mod expression;
mod scenes;
mod spec;

use crate::target::Target;

/// All of them.
pub fn all() -> Vec<Box<dyn Target>> {
    // The log of sessions (store and history) goes here: `log.rs`, a line each of hostile JSON, torn and spliced.
    vec![Box::new(scenes::Ply), Box::new(scenes::Splat), Box::new(spec::SpecText), Box::new(expression::Expression)]
}
