//! Everything that is fuzzed, one file each.

mod expression;
mod log;
mod scenes;
mod spec;

use crate::target::Target;

/// All of them.
pub fn all() -> Vec<Box<dyn Target>> {
    vec![Box::new(scenes::Ply), Box::new(scenes::Splat), Box::new(spec::SpecText), Box::new(expression::Expression), Box::new(log::SessionLog)]
}
