//! What to simulate: types with units, defaults, TOML and JSON, schema, validation, edits, diff.
//!
//! A [`Spec`] is complete by itself: nothing outside it changes the motion. Nothing mutates one but
//! a list of [`Edit`]s, which is applied whole or not at all.

mod aliases;
mod auto;
mod canonical;
mod check;
mod diff;
mod edit;
mod error;
pub mod expect;
pub mod expression;
mod fields;
pub mod file_name;
mod gloss;
mod later;
pub mod limits;
mod path;
mod place;
pub mod presets;
pub mod random;
mod read;
mod reference;
pub mod schema;
mod spelling;
mod types;
mod validate;

pub use auto::{Auto, Until};
pub use canonical::number;
pub use diff::{Change, unit};
pub use edit::Edit;
pub use error::{SpecError, SpecErrorKind, nearest};
pub use fields::FieldFacts;
pub use path::{LISTS, is_name, name_from_file};
pub use reference::markdown as reference_page;
pub use types::*;

#[cfg(test)]
mod material_tests;
#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
