//! Moving pictures for eyes: in the terminal, in a window.

mod film;
pub mod terminal;
#[cfg(feature = "window")]
pub mod window;

pub use film::{Picture, Reel};
