//! How a run speaks to whoever watches it, and how it is stopped.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// One finished picture. Files, terminal, window and browser are all sinks of it.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Frame k shows time k / fps; frame 0 is the state at t = 0.
    pub index: u32,
    /// Seconds since t = 0.
    pub time_s: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// sRGB, opaque, rows from the top; `size[0] * size[1] * 4` bytes.
    pub rgba8: Arc<[u8]>,
    /// The same picture as a PNG file, byte for byte what the store keeps.
    pub png: Arc<[u8]>,
    /// Expected depth in metres along the view axis, +inf where nothing is; only where asked for.
    pub depth: Option<Arc<[f32]>>,
    /// Index of the object that covers the pixel most, `u32::MAX` where none does; only where asked for.
    pub id: Option<Arc<[u32]>>,
}

/// How far a stage is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The stage's name.
    pub stage: &'static str,
    /// Units done.
    pub done: u64,
    /// Units in all.
    pub total: u64,
    /// Estimate of the seconds left of the whole run, where there is one.
    pub seconds_left: Option<f64>,
}

/// Receives what a run makes, in order. A slow sink slows the run down unless it drops on its own
/// side: file sinks drop nothing, viewers keep the newest only.
pub trait Sink {
    /// A stage went on.
    fn progress(&mut self, progress: Progress);
    /// A picture is done.
    fn frame(&mut self, frame: Frame);
    /// Something the user should know, one sentence.
    fn warning(&mut self, text: &str);
    /// Something the user may like to know, one sentence.
    fn note(&mut self, _text: &str) {}
}

/// A sink that keeps nothing.
#[derive(Debug, Default)]
pub struct Discard;

impl Sink for Discard {
    fn progress(&mut self, _: Progress) {}
    fn frame(&mut self, _: Frame) {}
    fn warning(&mut self, _: &str) {}
}

/// A flag that any thread may raise and that the engine polls at each batch of substeps.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks the run to end at the next batch, keeping what is done.
    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the run was asked to end.
    pub fn raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
