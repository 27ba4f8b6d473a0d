//! Frames on their way out: measured, packed and encoded on other threads while the device goes on,
//! delivered in order.

use super::EngineError;
use super::keeper::{Item, Keeper};
use super::segments::{Segment, SegmentMeta, SolverTotals};
use crate::gpu::{Arrived, Gpu, Readback};
use crate::render::{Developed, Picture};
use crate::threads::{caught, detach};
use crate::world::Checkpoint;
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
    place: u64,
    index: u32,
    time_s: f64,
    motion: Option<Readback>,
    picture: Option<Picture>,
}

/// A frame that other threads have done with.
struct Done {
    place: u64,
    measured: Option<Measured>,
    frame: Option<Frame>,
}

/// A frame's motion, back on the host.
struct Measured {
    motion: Vec<u8>,
    rows: Vec<Row>,
    /// Particles with a value that is not a number.
    nonfinite: u64,
}

/// What is delivered next.
enum Awaited {
    Frame(u64),
    /// The end of a segment, once its frames are there: the state, and what the solver did in it.
    End(Box<SolverTotals>, Box<Checkpoint>),
}

/// What came out of the frames that were simulated.
#[derive(Default)]
pub(super) struct Delivered {
    /// Rows of each frame, in order.
    pub rows: Vec<Vec<Row>>,
    /// Most particles of any frame with a value that is not a number.
    pub nonfinite: u64,
    /// How long the run was held up by encoders, the sink and the store.
    pub held_up: Duration,
}

/// A segment that is being simulated.
struct Simulated {
    segment: Arc<Segment>,
    /// Bytes of one frame of motion; 0 where motion is not kept.
    frame_bytes: usize,
    rows: Vec<Vec<Row>>,
    nonfinite: u64,
}

/// The pipeline from the device to the sink and the store.
pub(super) struct Delivery<'a> {
    gpu: &'a Gpu,
    bodies: Arc<Bodies>,
    pending: VecDeque<Pending>,
    sender: Sender<Result<Done, EngineError>>,
    receiver: Receiver<Result<Done, EngineError>>,
    working: usize,
    /// How many were taken over.
    taken: u64,
    early: BTreeMap<u64, Done>,
    awaited: VecDeque<Awaited>,
    /// Segments whose frames come, the oldest first.
    segments: VecDeque<Simulated>,
    delivered: Delivered,
    keeper: Keeper,
}

impl<'a> Delivery<'a> {
    pub fn new(gpu: &'a Gpu, bodies: Arc<Bodies>, keeper: Keeper) -> Delivery<'a> {
        let (sender, receiver) = channel();
        let (pending, awaited, segments, early) = (VecDeque::new(), VecDeque::new(), VecDeque::new(), BTreeMap::new());
        Delivery { gpu, bodies, pending, sender, receiver, working: 0, taken: 0, early, awaited, segments, delivered: Delivered::default(), keeper }
    }

    /// Frames with motion that are pushed from now on are of this segment.
    pub fn begin(&mut self, segment: &Segment, frame_bytes: usize) {
        self.segments.push_back(Simulated { segment: Arc::new(segment.clone()), frame_bytes, rows: Vec::new(), nonfinite: 0 });
    }

    /// Takes over a frame whose read-backs were started. Motion and picture of one frame may come apart.
    pub fn push(
        &mut self,
        index: u32,
        time_s: f64,
        motion: Option<Readback>,
        picture: Option<Picture>,
        sink: &mut dyn Sink,
    ) -> Result<(), EngineError> {
        let place = self.taken;
        self.taken += 1;
        self.awaited.push_back(Awaited::Frame(place));
        self.pending.push_back(Pending { place, index, time_s, motion, picture });
        while self.pending.len() > IN_FLIGHT {
            self.take_one()?;
        }
        self.deliver(sink)
    }

    /// Ends a segment: it is kept when its frames have come.
    pub fn end(&mut self, totals: SolverTotals, state: Checkpoint) {
        self.awaited.push_back(Awaited::End(Box::new(totals), Box::new(state)));
    }

    /// Keeps the state that a scene stands in, and what is to be said of it.
    pub fn keep_standing(&mut self, key: &str, state: Checkpoint, said: Vec<String>) -> Result<(), EngineError> {
        self.keeper.keep(Item::Standing(key.to_owned(), state, said))
    }

    /// Waits for the device, so that what was pushed comes as soon as it is encoded.
    pub fn hasten(&mut self) -> Result<(), EngineError> {
        while !self.pending.is_empty() {
            self.take_one()?;
        }
        Ok(())
    }

    /// Waits for everything, delivers it, and has it on disk; pictures are kept where `whole`.
    pub fn finish(mut self, whole: bool, sink: &mut dyn Sink) -> Result<Delivered, EngineError> {
        self.hasten()?;
        self.deliver(sink)?;
        while self.working > 0 {
            self.receive_one()?;
            self.deliver(sink)?;
        }
        if whole {
            self.keeper.keep(Item::Whole)?;
        }
        self.keeper.finish()?;
        Ok(self.delivered)
    }

    /// Waits for the oldest frame of the device and hands it to another thread.
    fn take_one(&mut self) -> Result<(), EngineError> {
        let Some(Pending { place, index, time_s, motion, picture }) = self.pending.pop_front() else { return Ok(()) };
        let motion = motion.map(|readback| readback.arrive(self.gpu)).transpose()?;
        let picture = picture.map(|picture| picture.develop(self.gpu)).transpose()?;
        // Those that fall behind are waited for, so that no animation piles up in memory.
        while self.working >= rayon::current_num_threads() + 2 {
            self.receive_one()?;
        }
        self.working += 1;
        let (sender, bodies) = (self.sender.clone(), self.bodies.clone());
        let work = move || {
            let measured = motion.map(|arrived| measured(&arrived, &bodies)).transpose();
            let frame = picture.map(|picture| encoded(index, time_s, &picture)).transpose();
            measured.and_then(|measured| Ok(Done { place, measured, frame: frame? }))
        };
        detach(move || {
            let done = caught("encoding a frame", work).map_err(EngineError::from).and_then(|done| done);
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
        self.early.insert(done.place, done);
        Ok(())
    }

    /// Hands on what is ready, in order.
    pub fn deliver(&mut self, sink: &mut dyn Sink) -> Result<(), EngineError> {
        while let Ok(done) = self.receiver.try_recv() {
            self.accept(done)?;
        }
        let clock = Instant::now();
        while let Some(next) = self.awaited.pop_front() {
            match next {
                Awaited::End(totals, state) => self.hand_on_end(*totals, *state)?,
                Awaited::Frame(place) => match self.early.remove(&place) {
                    Some(done) => self.hand_on(done, sink)?,
                    None => {
                        self.awaited.push_front(Awaited::Frame(place));
                        break;
                    }
                },
            }
        }
        self.delivered.held_up += clock.elapsed();
        Ok(())
    }

    fn hand_on(&mut self, done: Done, sink: &mut dyn Sink) -> Result<(), EngineError> {
        if let (Some(measured), Some(simulated)) = (done.measured, self.segments.front_mut()) {
            simulated.rows.push(measured.rows.clone());
            simulated.nonfinite = simulated.nonfinite.max(measured.nonfinite);
            self.delivered.rows.push(measured.rows);
            self.delivered.nonfinite = self.delivered.nonfinite.max(measured.nonfinite);
            if simulated.frame_bytes > 0 {
                self.keeper.keep(Item::Motion(simulated.segment.clone(), measured.motion))?;
            }
        }
        if let Some(frame) = done.frame {
            self.keeper.keep(Item::Picture(frame.png.clone()))?;
            sink.frame(frame);
        }
        Ok(())
    }

    fn hand_on_end(&mut self, totals: SolverTotals, state: Checkpoint) -> Result<(), EngineError> {
        let Some(Simulated { segment, frame_bytes, rows, nonfinite }) = self.segments.pop_front() else { return Ok(()) };
        let meta = SegmentMeta { rows, solver: SolverTotals { nonfinite, ..totals }, frame_bytes };
        self.keeper.keep(Item::End(segment, Box::new(meta), state))
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
