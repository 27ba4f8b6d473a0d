//! Ctrl-C and friends. The first asks a run to stop and keep what is done; the second ends the process.

use super::crash::restore_terminal;
use super::exit::Kind;
use phystalk::Stop;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU8, Ordering};

/// Exit code of the signal that came, 0 before one did.
static RECEIVED: AtomicU8 = AtomicU8::new(0);
/// The run that polls a stop flag now.
static RUNNING: Mutex<Option<Stop>> = Mutex::new(None);

/// While it lives, the first signal stops this run instead of the process.
#[derive(Debug)]
pub struct Guard;

/// Hands the first signal to a run.
pub fn stop_on_signal(stop: &Stop) -> Guard {
    if let Ok(mut running) = RUNNING.lock() {
        *running = Some(stop.clone());
    }
    Guard
}

impl Drop for Guard {
    fn drop(&mut self) {
        if let Ok(mut running) = RUNNING.lock() {
            *running = None;
        }
    }
}

/// The signal that came, if one did.
pub fn received() -> Option<Kind> {
    match RECEIVED.load(Ordering::SeqCst) {
        0 => None,
        code if code == Kind::Interrupted.code() => Some(Kind::Interrupted),
        _ => Some(Kind::Terminated),
    }
}

/// One signal: raises the run's flag the first time, ends the process where there is none or it was raised already.
#[cfg_attr(not(unix), allow(dead_code))]
fn deliver(kind: Kind) {
    let repeated = RECEIVED.swap(kind.code(), Ordering::SeqCst) != 0;
    let running = RUNNING.lock().ok().and_then(|r| r.clone());
    match running {
        Some(stop) if !repeated => {
            stop.raise();
            super::output::note("stopping: what is done is kept (again to quit at once)");
        }
        _ => {
            restore_terminal();
            std::process::exit(i32::from(kind.code()));
        }
    }
}

/// Starts listening. Where signals cannot be had, the system's own behaviour stays.
#[cfg(unix)]
pub fn listen() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP]) else { return };
    let listener = move || {
        for signal in signals.forever() {
            deliver(if signal == SIGINT { Kind::Interrupted } else { Kind::Terminated });
        }
    };
    let _ = std::thread::Builder::new().name("signals".into()).spawn(listener);
}

/// Nothing to listen to here.
#[cfg(not(unix))]
pub fn listen() {}
