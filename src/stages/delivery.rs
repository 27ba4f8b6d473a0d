//! Frames on their way out: measured, packed and encoded on other threads while the device goes on,
//! delivered in order.

use super::EngineError;
use crate::gpu::{Gpu, Readback};
use crate::render::Picture;
use crate::world::measure::{Bodies, MotionFrame, Row, measure};
use crate::{Frame, Sink, export};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

/// Frames whose read-backs may be under way at once: enough to hide the copy, few enough to show soon.
const IN_FLIGHT: usize = 3;

/// A frame that the device works on.
struct Pending {
    index: u32,
    time_s: f64,
    motion: Option<Readback>,
    picture: Option<Picture>,
}

/// An encoded picture.
struct Encoded {
    frame: Frame,
}

/// A frame's motion, back on the host.
pub(super) struct Measured {
    pub motion: Vec<u8>,
    pub rows: Vec<Row>,
    /// Particles with a value that is not a number.
    pub nonfinite: u64,
}

/// The pipeline from the device to the sink.
pub(super) struct Delivery<'a> {
    gpu: &'a Gpu,
    bodies: Arc<Bodies>,
    pending: VecDeque<Pending>,
    measured: Vec<Measured>,
    sender: Sender<Result<Encoded, String>>,
    receiver: Receiver<Result<Encoded, String>>,
    encoding: usize,
    early: BTreeMap<u32, Encoded>,
    next: u32,
    /// Receives the PNG of each picture, in order, before the sink does.
    keep: &'a mut dyn FnMut(&Frame) -> Result<(), EngineError>,
}

impl<'a> Delivery<'a> {
    pub fn new(gpu: &'a Gpu, bodies: Arc<Bodies>, keep: &'a mut dyn FnMut(&Frame) -> Result<(), EngineError>) -> Delivery<'a> {
        let (sender, receiver) = channel();
        let (pending, measured, early) = (VecDeque::new(), Vec::new(), BTreeMap::new());
        Delivery { gpu, bodies, pending, measured, sender, receiver, encoding: 0, early, next: 0, keep }
    }

    /// Takes over a frame whose read-backs were started.
    pub fn push(
        &mut self,
        index: u32,
        time_s: f64,
        motion: Option<Readback>,
        picture: Option<Picture>,
        sink: &mut dyn Sink,
    ) -> Result<(), EngineError> {
        self.pending.push_back(Pending { index, time_s, motion, picture });
        while self.pending.len() > IN_FLIGHT {
            self.take_one()?;
        }
        self.deliver(sink)
    }

    /// Waits for the read-backs under way and returns the motion that came back since the last call.
    pub fn settle(&mut self, sink: &mut dyn Sink) -> Result<Vec<Measured>, EngineError> {
        while !self.pending.is_empty() {
            self.take_one()?;
        }
        self.deliver(sink)?;
        Ok(std::mem::take(&mut self.measured))
    }

    /// Waits for everything and delivers it.
    pub fn finish(mut self, sink: &mut dyn Sink) -> Result<Vec<Measured>, EngineError> {
        let measured = self.settle(sink)?;
        while self.encoding > 0 {
            self.receive_one()?;
            self.deliver(sink)?;
        }
        Ok(measured)
    }

    /// Waits for the oldest frame of the device and hands its picture to an encoder.
    fn take_one(&mut self) -> Result<(), EngineError> {
        let Some(pending) = self.pending.pop_front() else { return Ok(()) };
        if let Some(readback) = pending.motion {
            let mut parts = readback.wait(self.gpu)?;
            let velocity = parts.pop().unwrap_or_default();
            let motion = parts.pop().unwrap_or_default();
            let frame = MotionFrame::unpack(&motion, &velocity);
            let (rows, nonfinite) = (measure(&frame, &self.bodies), frame.nonfinite());
            self.measured.push(Measured { motion, rows, nonfinite });
        }
        let Some(picture) = pending.picture else { return Ok(()) };
        let image = picture.read(self.gpu)?;
        // Encoders that fall behind are waited for, so that no animation piles up in memory.
        while self.encoding >= 2 * rayon::current_num_threads() + 2 {
            self.receive_one()?;
        }
        self.encoding += 1;
        let (sender, index, time_s) = (self.sender.clone(), pending.index, pending.time_s);
        rayon::spawn(move || {
            let encoded = export::encode_png(image.size, &image.rgba8).map_err(|e| e.to_string()).map(|png| Encoded {
                frame: Frame { index, time_s, size: image.size, rgba8: image.rgba8.into(), png: png.into(), depth: None, id: None },
            });
            // The receiver is gone only when the run has already failed.
            let _ = sender.send(encoded);
        });
        Ok(())
    }

    fn receive_one(&mut self) -> Result<(), EngineError> {
        if let Ok(encoded) = self.receiver.recv() {
            self.accept(encoded)?;
        }
        Ok(())
    }

    fn accept(&mut self, encoded: Result<Encoded, String>) -> Result<(), EngineError> {
        self.encoding -= 1;
        let encoded = encoded.map_err(EngineError::Unstable)?;
        self.early.insert(encoded.frame.index, encoded);
        Ok(())
    }

    /// Hands on what is ready, in order.
    fn deliver(&mut self, sink: &mut dyn Sink) -> Result<(), EngineError> {
        while let Ok(encoded) = self.receiver.try_recv() {
            self.accept(encoded)?;
        }
        while let Some(encoded) = self.early.remove(&self.next) {
            (self.keep)(&encoded.frame)?;
            sink.frame(encoded.frame);
            self.next += 1;
        }
        Ok(())
    }
}
