//! One input on one target, with panics caught and memory counted.

use crate::target::Target;
use peak_alloc::PeakAlloc;
use std::sync::{Mutex, PoisonError};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Where the last panic was.
static PLACE: Mutex<String> = Mutex::new(String::new());

/// What came of an input.
pub struct Trial {
    /// Its class.
    pub class: String,
    /// Most memory beyond what was in use before.
    pub peak_bytes: usize,
}

/// An input that broke a promise.
pub struct Failed {
    /// In which way.
    pub reason: String,
}

/// Notes where a panic was instead of printing it.
pub fn silence_panics() {
    std::panic::set_hook(Box::new(|info| {
        let place = info.location().map(ToString::to_string).unwrap_or_default();
        *PLACE.lock().unwrap_or_else(PoisonError::into_inner) = place;
    }));
}

/// Runs it.
pub fn run(target: &dyn Target, input: &[u8]) -> Result<Trial, Failed> {
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    let done = phystalk::threads::caught("reading", || target.run(input));
    let peak_bytes = MEMORY.peak_usage().saturating_sub(before);
    let class = match done {
        Ok(Ok(class)) => class,
        Ok(Err(reason)) => return Err(Failed { reason }),
        Err(panic) => {
            let place = PLACE.lock().unwrap_or_else(PoisonError::into_inner).clone();
            return Err(Failed { reason: format!("{panic} ({place})") });
        }
    };
    let allowed = target.memory(input.len());
    if peak_bytes > allowed {
        return Err(Failed { reason: format!("{peak_bytes} bytes of memory for {} bytes of input, {allowed} are allowed ({class})", input.len()) });
    }
    Ok(Trial { class, peak_bytes })
}
