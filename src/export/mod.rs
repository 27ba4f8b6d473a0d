//! Frames to files: PNG, EXR, contact sheets, animated previews; and the comparison of pictures.
//!
//! Every file appears whole or not at all. The room is a leaf: it knows pictures and files, and
//! nothing of what made them.

mod atomic;
mod compare;
mod error;
mod exr;
mod font;
mod png;
mod preview;
mod raster;
mod sheet;
mod vp8;

pub use atomic::{remove_leftovers, write_atomic};
pub use compare::{Comparison, Tolerance, compare};
pub use error::ExportError;
pub use exr::write_exr;
pub use png::{decode_png, encode_png, read_png, write_png};
pub use preview::Preview;
pub use raster::Raster;
pub use sheet::ContactSheet;
