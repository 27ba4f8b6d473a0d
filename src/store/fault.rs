//! Fault injection: ends the process before its n-th write to a store or to output files, so that tests see every state that a crash can leave.
//!
//! Only in builds with debug assertions, and only where `PHYSTALK_KILL_AT_WRITE` is set: a release has none of this.

/// Stands before every change of the files of a store or of an output folder.
#[cfg(not(debug_assertions))]
pub(crate) fn before_write() {}

/// Stands before every change of the files of a store or of an output folder.
#[cfg(debug_assertions)]
pub(crate) fn before_write() {
    use std::sync::LazyLock;
    use std::sync::atomic::{AtomicU64, Ordering};

    static KILL_AT: LazyLock<Option<u64>> = LazyLock::new(|| std::env::var("PHYSTALK_KILL_AT_WRITE").ok()?.parse().ok());
    static WRITES: AtomicU64 = AtomicU64::new(0);
    if KILL_AT.is_some_and(|at| at == WRITES.fetch_add(1, Ordering::SeqCst)) {
        // As a kill does: nothing is flushed, nothing is cleaned up.
        std::process::abort();
    }
}
