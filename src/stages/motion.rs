//! Motion segment by segment, from the store as far as it goes, then from the solver; pictures as the frames come.

use super::delivery::Delivery;
use super::engine::{Engine, Ready};
use super::keeper::{Keeper, Simulated};
use super::run::BACKGROUND;
use super::segments::{self, Kept, Segment, SolverTotals};
use super::{EngineError, StageName, pack, summary};
use crate::gpu::{Gpu, Readback};
use crate::render::Picture;
use crate::spec::Spec;
use crate::store::{BlobWriter, EntryWriter, Store, StoreError};
use crate::world::bodies::Matter;
use crate::world::measure::{Bodies, MOTION_WORDS, Row};
use crate::world::{Figure, World};
use crate::{Frame, Progress, Sink, Stop};
use std::collections::BTreeMap;
use std::io::Write;
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
    played: Played,
    started: Instant,
}

impl<'a> Motion<'a> {
    pub fn new(engine: &mut Engine, spec: &'a Spec, ready: &'a Ready, matter: &'a Matter) -> Result<Motion<'a>, EngineError> {
        let frame_bytes = matter.particles.position_m.len() * MOTION_WORDS * 4;
        let bytes = frame_bytes as f64 * f64::from(ready.resolved.frames);
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
            played: Played { rows, totals, stopped: false, figure: None, parts },
            started: Instant::now(),
        })
    }

    /// Goes through all segments; with a figure, draws every frame.
    pub fn play(mut self, figure: Option<Figure>, sink: &mut dyn Sink, stop: &Stop) -> Result<Played, EngineError> {
        let clock = Instant::now();
        let mut album = figure.is_some().then(|| Album::begin(&self.store, &self.ready.picture)).transpose()?;
        self.played.figure = figure;
        let mut keep = |frame: &Frame| album.as_mut().map_or(Ok(()), |album| album.add(frame));
        let gpu = self.gpu.clone();
        let mut delivery = Delivery::new(&gpu, self.bodies.clone(), Keeper::new(&self.store), &mut keep);
        let mut before: Option<Kept> = None;
        for segment in &self.ready.segments {
            let kept = segments::get(&self.store, segment)?;
            let motion = match (&kept, &self.played.figure) {
                (Some(kept), Some(_)) => kept.motion()?,
                _ => None,
            };
            let usable = kept.filter(|_| self.world.is_none() && (self.played.figure.is_none() || motion.is_some()));
            match usable {
                Some(kept) => {
                    self.replay(&kept, motion, segment, &mut delivery, sink)?;
                    before = Some(kept);
                }
                None => {
                    self.wake(before.take(), segment, sink, stop)?;
                    self.played.stopped = self.simulate(segment, &mut delivery, sink, stop)?;
                }
            }
            self.played.stopped |= stop.raised();
            if self.played.stopped {
                break;
            }
        }
        let last = Instant::now();
        let delivered = delivery.finish(sink)?;
        self.played.rows.extend(delivered.rows);
        self.played.totals.nonfinite = self.played.totals.nonfinite.max(delivered.nonfinite);
        if let Some(album) = album {
            album.finish(self.spec.time.fps, self.played.stopped)?;
        }
        self.spend("picture.after the last frame", last);
        self.played.parts.insert("picture.waiting for encoders", delivered.held_up.as_secs_f64());
        self.played.parts.insert("simulate and picture", clock.elapsed().as_secs_f64());
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
        self.played.rows.extend(kept.meta.rows.iter().cloned());
        self.played.totals.add(&SolverTotals { seconds: 0.0, ..kept.meta.solver.clone() });
        Ok(())
    }

    /// Makes the world, at the state before a segment.
    fn wake(&mut self, before: Option<Kept>, segment: &Segment, sink: &mut dyn Sink, stop: &Stop) -> Result<(), EngineError> {
        if self.world.is_some() {
            return Ok(());
        }
        let clock = Instant::now();
        let mut world = World::new(&self.gpu, self.spec, self.matter, &self.ready.resolved)?;
        let made = self.spend("simulate.solver", clock);
        match before {
            Some(kept) => world.restore(segment.first.saturating_sub(1), &kept.checkpoint()?)?,
            None => {
                self.stand(&mut world, sink, stop)?;
                world.place(self.spec, self.matter)?;
            }
        }
        self.spend("simulate.standing", made);
        self.world = Some(world);
        self.played.totals.seconds += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// The prestress, from the store or solved: gravity, support and matter decide it, launch and events do not.
    fn stand(&self, world: &mut World, sink: &mut dyn Sink, stop: &Stop) -> Result<(), EngineError> {
        if let Some(entry) = pack::find(&self.store, "prestress", &self.ready.prestress)?
            && let Some(state) = pack::read::<u8>(&entry, "state")?
        {
            return Ok(world.restore(0, &state)?);
        }
        let mut progress = |share: f32| {
            let done = (share.clamp(0.0, 1.0) * 100.0) as u64;
            sink.progress(Progress { stage: "standing", done, total: 100, seconds_left: None });
        };
        let report = world.prestress(self.spec, stop, &mut progress)?;
        report.warnings.iter().for_each(|w| sink.warning(w));
        if !stop.raised() {
            let entry = self.store.begin("prestress", &self.ready.prestress)?;
            entry.put("state", &world.checkpoint()?)?;
            entry.finish(serde_json::json!({}))?;
        }
        Ok(())
    }

    /// Simulates one segment and has it kept; returns whether it was stopped on the way.
    fn simulate(&mut self, segment: &Segment, delivery: &mut Delivery, sink: &mut dyn Sink, stop: &Stop) -> Result<bool, EngineError> {
        let Some(mut world) = self.world.take() else { return Ok(false) };
        let mut totals = SolverTotals::default();
        let bytes = (self.bodies.mass_kg.len() * MOTION_WORDS * 4) as u64;
        let mut stopped = false;
        for index in segment.first..=segment.last {
            let clock = Instant::now();
            if index > 0 {
                let step = world.step_frame(stop)?;
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
                Some(figure) => {
                    figure.pose(world.motion());
                    Some(draw(figure, index, self.spec, self.ready)?)
                }
                None => None,
            };
            self.spend("picture.drawing", stepped);
            delivery.push(index, self.ready.resolved.time_s(index, self.spec.time.fps), Some(back), picture, sink)?;
            progress(StageName::Simulate, index, self.started, self.ready, sink);
        }
        self.played.totals.add(&totals);
        if !stopped {
            let frame_bytes = if self.keep_motion { bytes as usize } else { 0 };
            let checkpoint = world.start_checkpoint()?;
            delivery.end(Simulated { segment: segment.clone(), totals, frame_bytes, checkpoint, frames: Vec::new() });
        }
        self.world = Some(world);
        Ok(stopped)
    }

    /// Adds the time since `start` to a part; now.
    fn spend(&mut self, part: &'static str, start: Instant) -> Instant {
        let now = Instant::now();
        *self.played.parts.entry(part).or_default() += (now - start).as_secs_f64();
        now
    }
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

/// The pictures of a run on their way into the store: one blob, and where each ends in it.
struct Album {
    entry: EntryWriter,
    blob: BlobWriter,
    store: Store,
    ends: Vec<u64>,
}

impl Album {
    fn begin(store: &Store, key: &str) -> Result<Album, EngineError> {
        let entry = store.begin("picture", key)?;
        Ok(Album { blob: entry.write("frames")?, entry, store: store.clone(), ends: Vec::new() })
    }

    fn add(&mut self, frame: &Frame) -> Result<(), EngineError> {
        let failed = |source| StoreError::Io { doing: "written", path: self.store.dir().to_owned(), source };
        self.blob.write_all(&frame.png).map_err(failed)?;
        self.ends.push(self.blob.bytes());
        Ok(())
    }

    /// Keeps all pictures, or none of a run that was stopped.
    fn finish(self, fps: u32, stopped: bool) -> Result<(), EngineError> {
        self.blob.finish()?;
        if !stopped {
            self.entry.finish(serde_json::json!({ "ends": self.ends, "fps": fps }))?;
        }
        Ok(())
    }
}
