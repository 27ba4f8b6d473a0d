//! Frames on their way out: measured, packed and encoded on other threads while the device goes on,
//! delivered in order.

use super::EngineError;
use super::keeper::{Keeper, Simulated};
use crate::gpu::{Arrived, Gpu, Readback};
use crate::render::{Developed, Picture};
use crate::world::measure::{Bodies, MotionFrame, Row, measure};
use crate::{Frame, Sink, export};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// Frames whose read-backs may be under way at once: enough to hide the copy, few enough to show soon.
const IN_FLIGHT: usize = 3;

/// A frame that the device works on.
struct Pending {
    index: u32,
    time_s: f64,
    motion: Option<Readback>,
    picture: Option<Picture>,
}

/// A frame that other threads have done with.
struct Done {
    index: u32,
    measured: Option<Measured>,
    frame: Option<Frame>,
}

/// A frame's motion, back on the host.
pub(super) struct Measured {
    pub motion: Vec<u8>,
    pub rows: Vec<Row>,
    /// Particles with a value that is not a number.
    pub nonfinite: u64,
}

/// What is delivered next.
enum Awaited {
    Frame(u32),
    /// The end of a segment, once its frames are there.
    End(Box<Simulated>),
}

/// What came out of the frames that were simulated.
#[derive(Default)]
pub(super) struct Delivered {
    /// Rows of each frame, in order.
    pub rows: Vec<Vec<Row>>,
    /// Most particles of any frame with a value that is not a number.
    pub nonfinite: u64,
    /// How long the run was held up by encoders and the sink.
    pub held_up: Duration,
}

/// The pipeline from the device to the sink and the store.
pub(super) struct Delivery<'a> {
    gpu: &'a Gpu,
    bodies: Arc<Bodies>,
    pending: VecDeque<Pending>,
    sender: Sender<Result<Done, EngineError>>,
    receiver: Receiver<Result<Done, EngineError>>,
    working: usize,
    early: BTreeMap<u32, Done>,
    awaited: VecDeque<Awaited>,
    /// Of the segment that is not complete.
    measured: Vec<Measured>,
    delivered: Delivered,
    keeper: Keeper,
    /// Receives the PNG of each picture, in order, before the sink does.
    keep: &'a mut dyn FnMut(&Frame) -> Result<(), EngineError>,
}

impl<'a> Delivery<'a> {
    pub fn new(gpu: &'a Gpu, bodies: Arc<Bodies>, keeper: Keeper, keep: &'a mut dyn FnMut(&Frame) -> Result<(), EngineError>) -> Delivery<'a> {
        let (sender, receiver) = channel();
        let (pending, awaited, early) = (VecDeque::new(), VecDeque::new(), BTreeMap::new());
        let (measured, delivered) = (Vec::new(), Delivered::default());
        Delivery { gpu, bodies, pending, sender, receiver, working: 0, early, awaited, measured, delivered, keeper, keep }
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
        self.awaited.push_back(Awaited::Frame(index));
        self.pending.push_back(Pending { index, time_s, motion, picture });
        while self.pending.len() > IN_FLIGHT {
            self.take_one()?;
        }
        self.deliver(sink)
    }

    /// Takes over a segment whose frames were pushed: it is kept when they have come.
    pub fn end(&mut self, simulated: Simulated) {
        self.awaited.push_back(Awaited::End(Box::new(simulated)));
    }

    /// Waits for everything, delivers it, and has it on disk.
    pub fn finish(mut self, sink: &mut dyn Sink) -> Result<Delivered, EngineError> {
        while !self.pending.is_empty() {
            self.take_one()?;
        }
        self.deliver(sink)?;
        while self.working > 0 {
            self.receive_one()?;
            self.deliver(sink)?;
        }
        self.keeper.finish()?;
        Ok(self.delivered)
    }

    /// Waits for the oldest frame of the device and hands it to another thread.
    fn take_one(&mut self) -> Result<(), EngineError> {
        let Some(Pending { index, time_s, motion, picture }) = self.pending.pop_front() else { return Ok(()) };
        let motion = motion.map(|readback| readback.arrive(self.gpu)).transpose()?;
        let picture = picture.map(|picture| picture.develop(self.gpu)).transpose()?;
        // Those that fall behind are waited for, so that no animation piles up in memory.
        while self.working >= 2 * rayon::current_num_threads() + 2 {
            self.receive_one()?;
        }
        self.working += 1;
        let (sender, bodies) = (self.sender.clone(), self.bodies.clone());
        rayon::spawn(move || {
            let measured = motion.map(|arrived| measured(&arrived, &bodies)).transpose();
            let frame = picture.map(|picture| encoded(index, time_s, &picture)).transpose();
            let done = measured.and_then(|measured| Ok(Done { index, measured, frame: frame? }));
            // The receiver is gone only when the run has already failed.
            let _ = sender.send(done);
        });
        Ok(())
    }

    fn receive_one(&mut self) -> Result<(), EngineError> {
        let clock = Instant::now();
        if let Ok(done) = self.receiver.recv() {
            self.accept(done)?;
        }
        self.delivered.held_up += clock.elapsed();
        Ok(())
    }

    fn accept(&mut self, done: Result<Done, EngineError>) -> Result<(), EngineError> {
        self.working -= 1;
        let done = done?;
        self.early.insert(done.index, done);
        Ok(())
    }

    /// Hands on what is ready, in order.
    fn deliver(&mut self, sink: &mut dyn Sink) -> Result<(), EngineError> {
        while let Ok(done) = self.receiver.try_recv() {
            self.accept(done)?;
        }
        let clock = Instant::now();
        while let Some(next) = self.awaited.pop_front() {
            match next {
                Awaited::End(mut simulated) => {
                    simulated.frames = std::mem::take(&mut self.measured);
                    self.keeper.keep(simulated)?;
                }
                Awaited::Frame(index) => match self.early.remove(&index) {
                    Some(done) => self.hand_on(done, sink)?,
                    None => {
                        self.awaited.push_front(Awaited::Frame(index));
                        break;
                    }
                },
            }
        }
        self.delivered.held_up += clock.elapsed();
        Ok(())
    }

    fn hand_on(&mut self, done: Done, sink: &mut dyn Sink) -> Result<(), EngineError> {
        if let Some(measured) = done.measured {
            self.delivered.rows.push(measured.rows.clone());
            self.delivered.nonfinite = self.delivered.nonfinite.max(measured.nonfinite);
            self.measured.push(measured);
        }
        if let Some(frame) = done.frame {
            (self.keep)(&frame)?;
            sink.frame(frame);
        }
        Ok(())
    }
}

/// Motion and velocities, measured.
fn measured(arrived: &Arrived, bodies: &Bodies) -> Result<Measured, EngineError> {
    let motion = arrived.part(0, <[u8]>::to_vec)?;
    let frame = arrived.part(1, |velocity| MotionFrame::unpack(&motion, velocity))?;
    Ok(Measured { rows: measure(&frame, bodies), nonfinite: frame.nonfinite(), motion })
}

fn encoded(index: u32, time_s: f64, picture: &Developed) -> Result<Frame, EngineError> {
    let size = picture.size();
    let rgba8: Arc<[u8]> = picture.rgba8(|pixels| pixels.into())?;
    let png = export::encode_png(size, &rgba8).map_err(|e| EngineError::Unstable(e.to_string()))?;
    Ok(Frame { index, time_s, size, rgba8, png: png.into(), depth: None, id: None })
}
