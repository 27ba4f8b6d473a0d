//! What to simulate: types with units, defaults, TOML and JSON, schema, validation, edits, diff.
//!
//! A [`Spec`] is complete by itself: nothing outside it changes the motion. Nothing mutates one but
//! a list of [`Edit`]s, which is applied whole or not at all.

mod types;

pub use types::*;
