//! Moving pictures for eyes: in the terminal, in a window.

mod film;
pub mod terminal;

pub use film::{Picture, Reel};
