//! Motion segment by segment, from the store as far as it goes, then from the solver; pictures as the frames come.

use super::delivery::Delivery;
use super::engine::{Engine, Ready};
use super::keeper::{Album, Keeper};
use super::run::BACKGROUND;
use super::segments::{self, Kept, Segment, SolverTotals};
use super::{EngineError, MemoryMetrics, StageName, pack, summary};
use crate::gpu::{Gpu, Readback};
use crate::render::Picture;
use crate::solver::SolverError;
use crate::spec::Spec;
use crate::store::Store;
use crate::world::bodies::Matter;
use crate::world::measure::{Bodies, MOTION_WORDS, Row};
use crate::world::{Figure, World};
use crate::{Progress, Sink, Stop};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// A run that takes more than this share of the store's room keeps checkpoints alone.
const MOTION_SHARE: f64 = 0.5;

/// What playing all segments gave.
pub(super) struct Played {
    pub rows: Vec<Vec<Row>>,
    pub totals: SolverTotals,
    pub stopped: bool,
    pub figure: Option<Figure>,
    /// Wall seconds of the parts of a stage.
    pub parts: BTreeMap<&'static str, f64>,
    pub memory: MemoryMetrics,
}

/// Bytes of one frame of motion.
pub(super) fn frame_bytes(matter: &Matter) -> usize {
    matter.particles.len() * MOTION_WORDS * 4
}

/// The motion of one run.
pub(super) struct Motion<'a> {
    gpu: Gpu,
    store: Store,
    spec: &'a Spec,
    ready: &'a Ready,
    matter: &'a Matter,
    bodies: Arc<Bodies>,
    pub keep_motion: bool,
    /// The world, once something has to be simulated.
    world: Option<World>,
    /// The frame that was drawn before it was simulated.
    drawn: Option<u32>,
    /// What was said of how it starts, until the first segment keeps it.
    said: Vec<String>,
    played: Played,
    started: Instant,
}

impl<'a> Motion<'a> {
    pub fn new(engine: &mut Engine, spec: &'a Spec, ready: &'a Ready, matter: &'a Matter) -> Result<Motion<'a>, EngineError> {
        let bytes = frame_bytes(matter) as f64 * f64::from(ready.resolved.frames);
        let keep_motion = bytes <= engine.store.cap_bytes() as f64 * MOTION_SHARE;
        let (rows, totals, parts) = (Vec::new(), SolverTotals::default(), BTreeMap::new());
        Ok(Motion {
            gpu: engine.device()?.clone(),
            store: engine.store.clone(),
            spec,
            ready,
            matter,
            bodies: Arc::new(matter.bodies.clone()),
            keep_motion,
            world: None,
            drawn: None,
            said: Vec::new(),
            played: Played { rows, totals, stopped: false, figure: None, parts, memory: MemoryMetrics::default() },
            started: Instant::now(),
        })
    }

    /// Goes through all segments; with a figure, draws every frame.
    pub fn play(mut self, figure: Option<Figure>, sink: &mut dyn Sink, stop: &Stop) -> Result<Played, EngineError> {
        let album = figure.is_some().then(|| Album::begin(&self.store, &self.ready.picture, self.spec.time.fps)).transpose()?;
        self.played.figure = figure;
        let gpu = self.gpu.clone();
        let mut delivery = Delivery::new(&gpu, self.bodies.clone(), Keeper::new(&self.store, album)?);
        for (number, segment) in self.ready.segments.iter().enumerate() {
            let kept = segments::get(&self.store, segment)?;
            let motion = match (&kept, &self.played.figure) {
                (Some(kept), Some(_)) => kept.motion(frame_bytes(self.matter))?,
                _ => None,
            };
            let usable = kept.filter(|_| self.world.is_none() && (self.played.figure.is_none() || motion.is_some()));
            match usable {
                Some(kept) => self.replay(&kept, motion, segment, &mut delivery, sink)?,
                None => {
                    self.wake(number, &mut delivery, sink, stop)?;
                    // A stress that was not found to its end is no state to go on from.
                    self.played.stopped = stop.raised() || self.simulate(segment, &mut delivery, sink, stop)?;
                }
            }
            self.played.stopped |= stop.raised();
            if self.played.stopped {
                break;
            }
        }
        let last = Instant::now();
        tracing::debug!("simulated");
        let delivered = delivery.finish(!self.played.stopped, sink)?;
        self.spend("picture.last frames", last);
        tracing::debug!("delivered and kept");
        self.played.rows.extend(delivered.rows);
        self.played.totals.nonfinite = self.played.totals.nonfinite.max(delivered.nonfinite);
        self.played.parts.insert("picture.waiting for encoders", delivered.held_up.as_secs_f64());
        self.played.memory.host_peak_bytes = host_peak_bytes();
        Ok(self.played)
    }

    /// Draws a segment whose motion the store has.
    fn replay(
        &mut self,
        kept: &Kept,
        motion: Option<Vec<u8>>,
        segment: &Segment,
        delivery: &mut Delivery,
        sink: &mut dyn Sink,
    ) -> Result<(), EngineError> {
        if let (Some(figure), Some(motion)) = (&mut self.played.figure, motion) {
            for (index, bytes) in (segment.first..=segment.last).zip(motion.chunks_exact(kept.meta.frame_bytes)) {
                figure.pose_from(bytes);
                let picture = draw(figure, index, self.spec, self.ready)?;
                delivery.push(index, self.ready.resolved.time_s(index, self.spec.time.fps), None, Some(picture), sink)?;
                progress(StageName::Picture, index, self.started, self.ready, sink);
            }
        }
        kept.meta.solver.said.iter().for_each(|w| sink.warning(w));
        self.played.rows.extend(kept.meta.rows.iter().cloned());
        self.played.totals.add(&SolverTotals { seconds: 0.0, ..kept.meta.solver.clone() });
        Ok(())
    }

    /// Makes the world, at the state before a segment: the nearest that the store has of those before it, and on from there.
    fn wake(&mut self, number: usize, delivery: &mut Delivery, sink: &mut dyn Sink, stop: &Stop) -> Result<(), EngineError> {
        if self.world.is_some() {
            return Ok(());
        }
        let clock = Instant::now();
        let mut world = None;
        for before in self.ready.segments[..number].iter().rev() {
            world = self.resumed(before)?;
            if world.is_some() {
                break;
            }
        }
        let made = self.spend("simulate.solver", clock);
        let mut world = match world {
            Some(world) => world,
            None => self.begun(number, delivery, sink, stop)?,
        };
        // What was kept of the frames until there has been told.
        while world.frame() + 1 < self.ready.segments[number].first && !stop.raised() {
            world.step_frame(stop)?;
        }
        self.spend("simulate.standing", made);
        tracing::debug!("stands");
        self.world = Some(world);
        self.played.totals.seconds += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// The world at the end of a segment; none where that was not kept, or is no state to go on from.
    fn resumed(&self, segment: &Segment) -> Result<Option<World>, EngineError> {
        let Some(kept) = segments::get(&self.store, segment)? else { return Ok(None) };
        let Some(state) = kept.checkpoint()? else { return Ok(None) };
        let mut world = World::new(&self.gpu, self.spec, self.matter, &self.ready.resolved)?;
        let fits = self.restore(&mut world, segment.last, &state, ("motion", &segment.key))?;
        Ok(fits.then_some(world))
    }

    /// Restores a state that the store keeps under a key. One that does not fit is taken away, and the world is as new.
    fn restore(&self, world: &mut World, frame: u32, state: &[u8], (stage, key): (&str, &str)) -> Result<bool, EngineError> {
        match world.restore(frame, state) {
            Err(SolverError::Checkpoint { what }) => {
                tracing::warn!("the state {stage}/{key} does not fit ({what}) and is made anew");
                self.store.remove(stage, key)?;
                *world = World::new(&self.gpu, self.spec, self.matter, &self.ready.resolved)?;
                Ok(false)
            }
            restored => Ok(restored.map(|()| true)?),
        }
    }

    /// The world at the start. Where an earlier run has told of it, nothing is told.
    fn begun(&mut self, number: usize, delivery: &mut Delivery, sink: &mut dyn Sink, stop: &Stop) -> Result<World, EngineError> {
        let mut world = World::new(&self.gpu, self.spec, self.matter, &self.ready.resolved)?;
        tracing::debug!("solver made");
        if number == 0 {
            self.draw_captured(&mut world, delivery, sink)?;
        }
        let mut said = self.stand(&mut world, delivery, sink, stop)?;
        said.extend(world.place(self.spec, self.matter)?);
        if number == 0 {
            said.iter().for_each(|w| sink.warning(w));
            self.said = said;
        }
        Ok(world)
    }

    /// Draws frame 0 before the stress is known that holds it, where it shows the captured pose: no picture depends on
    /// stress.
    fn draw_captured(&mut self, world: &mut World, delivery: &mut Delivery, sink: &mut dyn Sink) -> Result<(), EngineError> {
        let Some(figure) = self.played.figure.as_mut().filter(|_| World::starts_as_captured(self.spec)) else { return Ok(()) };
        world.show();
        figure.pose(world.motion());
        let picture = draw(figure, 0, self.spec, self.ready)?;
        delivery.push(0, self.ready.resolved.time_s(0, self.spec.time.fps), None, Some(picture), sink)?;
        self.drawn = Some(0);
        delivery.hasten()
    }

    /// The prestress, from the store or solved: gravity, support and matter decide it, launch and events do not. What is to
    /// be said of it.
    fn stand(&self, world: &mut World, delivery: &mut Delivery, sink: &mut dyn Sink, stop: &Stop) -> Result<Vec<String>, EngineError> {
        if let Some(entry) = pack::find(&self.store, "prestress", &self.ready.prestress)?
            && let Some(state) = pack::read::<u8>(&entry, "state")?
            && self.restore(world, 0, &state, ("prestress", &self.ready.prestress))?
        {
            let said = entry.meta().get("said").and_then(|said| serde_json::from_value(said.clone()).ok());
            return Ok(said.unwrap_or_default());
        }
        let mut failed = Ok(());
        let mut progress = |share: f32| {
            let done = (share.clamp(0.0, 1.0) * 100.0) as u64;
            sink.progress(Progress { stage: "standing", done, total: 100, seconds_left: None });
            if failed.is_ok() {
                failed = delivery.deliver(sink);
            }
        };
        let said = world.prestress(self.spec, stop, &mut progress)?;
        failed?;
        if !stop.raised() {
            delivery.keep_standing(&self.ready.prestress, world.start_checkpoint()?, said.clone())?;
        }
        Ok(said)
    }

    /// Simulates one segment and has it kept; returns whether it was stopped on the way.
    fn simulate(&mut self, segment: &Segment, delivery: &mut Delivery, sink: &mut dyn Sink, stop: &Stop) -> Result<bool, EngineError> {
        let Some(mut world) = self.world.take() else { return Ok(false) };
        let mut totals = SolverTotals { said: std::mem::take(&mut self.said), ..SolverTotals::default() };
        let bytes = frame_bytes(self.matter) as u64;
        delivery.begin(segment, if self.keep_motion { bytes as usize } else { 0 });
        let mut stopped = false;
        for index in segment.first..=segment.last {
            let clock = Instant::now();
            if index > 0 {
                let step = world.step_frame(stop).map_err(|e| EngineError::at(e, world.now_s()))?;
                step.advance.iter().for_each(|a| totals.add(&summary::totals(a, self.spec)));
                totals.fired.extend(&step.fired);
                stopped = step.stopped;
            }
            if stopped {
                break;
            }
            world.show();
            let back = Readback::start(&self.gpu, &[(world.motion(), bytes), (world.velocity(), bytes / 2)]);
            let stepped = self.spend("simulate.frames", clock);
            totals.seconds += (stepped - clock).as_secs_f64();
            let picture = match &mut self.played.figure {
                Some(figure) if self.drawn != Some(index) => {
                    figure.pose(world.motion());
                    Some(draw(figure, index, self.spec, self.ready)?)
                }
                _ => None,
            };
            self.spend("picture.drawing", stepped);
            delivery.push(index, self.ready.resolved.time_s(index, self.spec.time.fps), Some(back), picture, sink)?;
            progress(StageName::Simulate, index, self.started, self.ready, sink);
        }
        self.played.totals.add(&totals);
        self.weigh();
        if !stopped {
            delivery.end(totals, world.start_checkpoint()?);
        }
        self.world = Some(world);
        Ok(stopped)
    }

    /// Notes how much memory is in use.
    fn weigh(&mut self) {
        let (used, reserved) = self.gpu.memory().unwrap_or_default();
        let memory = &mut self.played.memory;
        memory.device_bytes = memory.device_bytes.max(used);
        memory.device_reserved_bytes = memory.device_reserved_bytes.max(reserved);
    }

    /// Adds the time since `start` to a part; now.
    fn spend(&mut self, part: &'static str, start: Instant) -> Instant {
        let now = Instant::now();
        *self.played.parts.entry(part).or_default() += (now - start).as_secs_f64();
        now
    }
}

/// Most main memory that this process has had, where the system tells.
fn host_peak_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    peak.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok()).map_or(0, |kib| kib * 1024)
}

fn progress(stage: StageName, index: u32, started: Instant, ready: &Ready, sink: &mut dyn Sink) {
    let (done, total) = (u64::from(index) + 1, u64::from(ready.resolved.frames));
    let left = started.elapsed().as_secs_f64() / done as f64 * (total - done) as f64;
    sink.progress(Progress { stage: stage.as_str(), done, total, seconds_left: Some(left) });
}

fn draw(figure: &mut Figure, index: u32, spec: &Spec, ready: &Ready) -> Result<Picture, EngineError> {
    let time_s = ready.resolved.time_s(index, spec.time.fps);
    let background = crate::render::parse_colour(&spec.output.background).unwrap_or(BACKGROUND);
    Ok(figure.draw(&ready.resolved.camera, time_s, ready.resolved.size, background)?)
}
