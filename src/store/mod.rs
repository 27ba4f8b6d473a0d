//! Content that outlives a run: stage results and history, on disk (no GPU here).

mod atomic;

pub use atomic::write_atomic;
