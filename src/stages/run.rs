//! One run: motion segment by segment, pictures as the frames come.

use super::delivery::Delivery;
use super::engine::{Engine, Ready, Report};
use super::segments::{self, Kept, Segment, SegmentMeta, SolverTotals};
use super::{Action, EngineError, RunOptions, StageName, pack, summary};
use crate::gpu::{Gpu, Readback};
use crate::render::Picture;
use crate::spec::{Auto, Spec};
use crate::store::{Store, StoreError};
use crate::world::Figure;
use crate::world::bodies::{Matter, matter};
use crate::world::measure::{MOTION_WORDS, Row};
use crate::{Frame, Progress, Sink, Stop, world::World};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Where the spec's background is no colour, which validation refuses before.
pub(super) const BACKGROUND: [f32; 3] = [0.918, 0.918, 0.949];
/// A run that takes more than this share of the store's room keeps checkpoints alone.
const MOTION_SHARE: f64 = 0.5;

const LONG_WAY: &str = "it is predicted to go farther than the picture shows, which frames the first part of its way";
const OUT_OF_SIGHT: &str = "it is predicted to leave the picture of the camera that was set; the automatic camera frames it";

pub(super) fn run(
    engine: &mut Engine,
    spec: &Spec,
    base: &Path,
    options: &RunOptions,
    previous: Option<&Spec>,
    sink: &mut dyn Sink,
    stop: &Stop,
) -> Result<Report, EngineError> {
    let mut seconds = BTreeMap::new();
    let clock = Instant::now();
    let ready = engine.ready(spec, base, options)?;
    seconds.insert(StageName::Scene, clock.elapsed().as_secs_f64());
    let mut plan = engine.plan_of(&ready, spec, options, previous);
    engine.memory.told();
    let clock = Instant::now();
    let solids = engine.solids(spec, &ready)?;
    seconds.insert(StageName::Proxy, clock.elapsed().as_secs_f64());
    let clock = Instant::now();
    let bound = engine.bound(spec, &ready, &solids.value)?;
    seconds.insert(StageName::Bind, clock.elapsed().as_secs_f64());

    let matter = matter(spec, &ready.prepared.value, &solids.value)?;
    let mut warnings = warnings(&ready, &solids.value, &matter);
    let motion = Motion::new(engine, &ready, &matter)?;
    if !motion.keep_motion {
        warnings.push("the motion would take more than half of the store, so checkpoints alone are kept: a new camera simulates again".to_owned());
    }
    warnings.extend(engine.store.take_damage());
    warnings.iter().for_each(|w| sink.warning(w));
    matter.notes.iter().for_each(|n| sink.note(n));
    if options.render && ready.resolved.leaves {
        sink.note(if spec.camera == Auto::Auto { LONG_WAY } else { OUT_OF_SIGHT });
    }

    let wants_pictures = options.render;
    let pictures_kept = wants_pictures && plan.stage(StageName::Picture).is_some_and(|s| s.action == Action::Hit);
    let clock = Instant::now();
    let figure = if wants_pictures && !pictures_kept { Some(take_figure(engine, spec, &ready, &bound.value, &matter)?) } else { None };
    let done = motion.play(figure, spec, &ready, sink, stop)?;
    if let Some(figure) = done.figure {
        engine.figure = Some((ready.keys.bind.clone(), figure));
    }
    if pictures_kept && !done.stopped {
        replay_pictures(&engine.store, &ready, sink)?;
    }
    let total = clock.elapsed().as_secs_f64();
    seconds.insert(StageName::Simulate, done.totals.seconds);
    seconds.insert(StageName::Picture, (total - done.totals.seconds).max(0.0));
    for stage in &mut plan.stages {
        stage.seconds = seconds.get(&stage.stage).copied();
    }
    let motion = ready.segments.iter().map(|s| ("motion", s.key.as_str()));
    let made = [("scene", ready.keys.scene.as_str()), ("proxy", &ready.keys.proxy), ("bind", &ready.keys.bind), ("picture", &ready.picture)];
    engine.store.pin("head", made.into_iter().chain(motion).filter(|(stage, key)| engine.store.contains(stage, key)))?;
    let of_forces = summary::of_forces(&done.totals);
    of_forces.iter().for_each(|w| sink.warning(w));
    warnings.extend(of_forces);
    // Whoever gave a stiffness hears what it was simulated with.
    done.totals.softened.iter().for_each(|text| sink.warning(text));
    warnings.extend(done.totals.softened.iter().cloned());
    let metrics = summary::metrics(spec, &ready, &matter, &done.rows, &done.totals, &seconds, engine.device()?);
    Ok(Report { plan, metrics, camera: ready.resolved.camera, stopped: done.stopped, warnings })
}

fn warnings(ready: &Ready, solids: &[crate::proxy::Solid], matter: &Matter) -> Vec<String> {
    let mut warnings = ready.prepared.value.warnings.clone();
    warnings.extend(solids.iter().flat_map(|s| s.warnings.iter().cloned()));
    warnings.extend(matter.warnings.iter().cloned());
    if ready.resolved.reframed {
        warnings.push("the predicted path leaves the session's picture, so the camera was framed anew".to_owned());
    }
    warnings
}

/// The figure of the last run where it is of the same binding, else a new one.
fn take_figure(engine: &mut Engine, spec: &Spec, ready: &Ready, bound: &crate::skin::Bound, matter: &Matter) -> Result<Figure, EngineError> {
    match engine.figure.take() {
        Some((key, figure)) if key == ready.keys.bind => Ok(figure),
        _ => {
            let gpu = engine.device()?.clone();
            Ok(Figure::new(&gpu, &ready.prepared.value, bound, &matter.particles.position_m, spec.skin.weights)?)
        }
    }
}

/// Delivers pictures that the store has.
pub(super) fn replay_pictures(store: &Store, ready: &Ready, sink: &mut dyn Sink) -> Result<(), EngineError> {
    let Some(entry) = pack::find(store, "picture", &ready.picture)? else { return Ok(()) };
    let bytes = entry.read("frames")?;
    let ends: Vec<usize> = entry.meta().get("ends").and_then(|v| serde_json::from_value(v.clone()).ok()).unwrap_or_default();
    let fps = entry.meta().get("fps").and_then(serde_json::Value::as_f64).unwrap_or(1.0);
    let mut start = 0;
    for (index, end) in ends.into_iter().enumerate() {
        let Some(png) = bytes.get(start..end) else { break };
        start = end;
        let Ok(picture) = crate::export::decode_png(png) else { break };
        let index = index as u32;
        let (size, rgba8) = (picture.size, picture.rgba8.into());
        sink.frame(Frame { index, time_s: f64::from(index) / fps, size, rgba8, png: png.into(), depth: None, id: None });
    }
    Ok(())
}

/// What playing all segments gave.
struct Played {
    rows: Vec<Vec<Row>>,
    totals: SolverTotals,
    stopped: bool,
    figure: Option<Figure>,
}

/// The motion of one run: from the store as far as it goes, then from the solver.
struct Motion<'a> {
    gpu: Gpu,
    store: Store,
    matter: &'a Matter,
    bodies: Arc<crate::world::measure::Bodies>,
    keep_motion: bool,
    /// The world, once something has to be simulated.
    world: Option<World>,
    rows: Vec<Vec<Row>>,
    totals: SolverTotals,
    started: Instant,
}

impl<'a> Motion<'a> {
    fn new(engine: &mut Engine, ready: &Ready, matter: &'a Matter) -> Result<Motion<'a>, EngineError> {
        let frame_bytes = matter.particles.position_m.len() * MOTION_WORDS * 4;
        let bytes = frame_bytes as f64 * f64::from(ready.resolved.frames);
        let keep_motion = bytes <= engine.store.cap_bytes() as f64 * MOTION_SHARE;
        Ok(Motion {
            gpu: engine.device()?.clone(),
            store: engine.store.clone(),
            matter,
            bodies: Arc::new(matter.bodies.clone()),
            keep_motion,
            world: None,
            rows: Vec::new(),
            totals: SolverTotals::default(),
            started: Instant::now(),
        })
    }

    /// Goes through all segments; with a figure, draws every frame.
    fn play(mut self, mut figure: Option<Figure>, spec: &Spec, ready: &Ready, sink: &mut dyn Sink, stop: &Stop) -> Result<Played, EngineError> {
        let picture_entry = match figure {
            Some(_) => Some(self.store.begin("picture", &ready.picture)?),
            None => None,
        };
        let mut blob = match &picture_entry {
            Some(entry) => Some(entry.write("frames")?),
            None => None,
        };
        let folder = self.store.dir().to_owned();
        let (mut ends, mut written): (Vec<usize>, usize) = (Vec::new(), 0);
        let mut keep = |frame: &Frame| -> Result<(), EngineError> {
            if let Some(blob) = &mut blob {
                blob.write_all(&frame.png).map_err(|source| StoreError::Io { doing: "written", path: folder.clone(), source })?;
                written += frame.png.len();
                ends.push(written);
            }
            Ok(())
        };
        let gpu = self.gpu.clone();
        let mut delivery = Delivery::new(&gpu, self.bodies.clone(), &mut keep);
        let mut stopped = false;
        let mut before: Option<Kept> = None;
        for segment in &ready.segments {
            let kept = segments::get(&self.store, segment)?;
            let motion = match (&kept, &figure) {
                (Some(kept), Some(_)) => kept.motion()?,
                _ => None,
            };
            let usable = kept.filter(|_| self.world.is_none() && (figure.is_none() || motion.is_some()));
            match usable {
                Some(kept) => {
                    self.replay(&kept, motion, segment, figure.as_mut(), spec, ready, &mut delivery, sink)?;
                    before = Some(kept);
                }
                None => {
                    self.wake(before.take(), segment, spec, ready, sink, stop)?;
                    stopped = self.simulate(segment, figure.as_mut(), spec, ready, &mut delivery, sink, stop)?;
                }
            }
            stopped |= stop.raised();
            if stopped {
                break;
            }
        }
        delivery.finish(sink)?;
        if let Some(blob) = blob {
            blob.finish()?;
        }
        if let Some(entry) = picture_entry
            && !stopped
        {
            entry.finish(serde_json::json!({ "ends": ends, "fps": spec.time.fps }))?;
        }
        Ok(Played { rows: self.rows, totals: self.totals, stopped, figure })
    }

    /// Draws a segment whose motion the store has.
    #[allow(clippy::too_many_arguments, reason = "one call from one place; a struct would only rename them")]
    fn replay(
        &mut self,
        kept: &Kept,
        motion: Option<Vec<u8>>,
        segment: &Segment,
        figure: Option<&mut Figure>,
        spec: &Spec,
        ready: &Ready,
        delivery: &mut Delivery,
        sink: &mut dyn Sink,
    ) -> Result<(), EngineError> {
        if let (Some(figure), Some(motion)) = (figure, motion) {
            for (index, bytes) in (segment.first..=segment.last).zip(motion.chunks_exact(kept.meta.frame_bytes)) {
                figure.pose_from(bytes);
                let picture = draw(figure, index, spec, ready)?;
                delivery.push(index, ready.resolved.time_s(index, spec.time.fps), None, Some(picture), sink)?;
                self.progress(StageName::Picture, index, ready, sink);
            }
        }
        self.rows.extend(kept.meta.rows.iter().cloned());
        self.totals.add(&SolverTotals { seconds: 0.0, ..kept.meta.solver.clone() });
        Ok(())
    }

    /// Makes the world, at the state before a segment.
    fn wake(
        &mut self,
        before: Option<Kept>,
        segment: &Segment,
        spec: &Spec,
        ready: &Ready,
        sink: &mut dyn Sink,
        stop: &Stop,
    ) -> Result<(), EngineError> {
        if self.world.is_some() {
            return Ok(());
        }
        let clock = Instant::now();
        let mut world = World::new(&self.gpu, spec, self.matter, &ready.resolved)?;
        match before {
            Some(kept) => world.restore(segment.first.saturating_sub(1), &kept.checkpoint()?)?,
            None => {
                self.stand(&mut world, spec, ready, sink, stop)?;
                world.place(spec, self.matter)?;
            }
        }
        self.world = Some(world);
        self.totals.seconds += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// The prestress, from the store or solved: gravity, support and matter decide it, launch and events do not.
    fn stand(&self, world: &mut World, spec: &Spec, ready: &Ready, sink: &mut dyn Sink, stop: &Stop) -> Result<(), EngineError> {
        if let Some(entry) = pack::find(&self.store, "prestress", &ready.prestress)?
            && let Some(state) = pack::read::<u8>(&entry, "state")?
        {
            return Ok(world.restore(0, &state)?);
        }
        let mut progress = |share: f32| {
            let done = (share.clamp(0.0, 1.0) * 100.0) as u64;
            sink.progress(Progress { stage: "standing", done, total: 100, seconds_left: None });
        };
        let report = world.prestress(spec, stop, &mut progress)?;
        report.warnings.iter().for_each(|w| sink.warning(w));
        if !stop.raised() {
            let entry = self.store.begin("prestress", &ready.prestress)?;
            entry.put("state", &world.checkpoint()?)?;
            entry.finish(serde_json::json!({}))?;
        }
        Ok(())
    }

    /// Simulates and keeps one segment; returns whether it was stopped on the way.
    #[allow(clippy::too_many_arguments, reason = "one call from one place; a struct would only rename them")]
    fn simulate(
        &mut self,
        segment: &Segment,
        mut figure: Option<&mut Figure>,
        spec: &Spec,
        ready: &Ready,
        delivery: &mut Delivery,
        sink: &mut dyn Sink,
        stop: &Stop,
    ) -> Result<bool, EngineError> {
        let Some(world) = &mut self.world else { return Ok(false) };
        let mut totals = SolverTotals::default();
        let bytes = (self.bodies.mass_kg.len() * MOTION_WORDS * 4) as u64;
        let mut stopped = false;
        for index in segment.first..=segment.last {
            let clock = Instant::now();
            if index > 0 {
                let step = world.step_frame(stop)?;
                step.advance.iter().for_each(|a| totals.add(&summary::totals(a, spec)));
                stopped = step.stopped;
            }
            if stopped {
                break;
            }
            world.show();
            let back = Readback::start(&self.gpu, &[(world.motion(), bytes), (world.velocity(), bytes / 2)]);
            totals.seconds += clock.elapsed().as_secs_f64();
            let picture = match figure.as_deref_mut() {
                Some(figure) => {
                    figure.pose(world.motion());
                    Some(draw(figure, index, spec, ready)?)
                }
                None => None,
            };
            delivery.push(index, ready.resolved.time_s(index, spec.time.fps), Some(back), picture, sink)?;
            let left = self.started.elapsed().as_secs_f64() / f64::from(index + 1) * f64::from(ready.resolved.frames - index - 1);
            let (done, total) = (u64::from(index) + 1, u64::from(ready.resolved.frames));
            sink.progress(Progress { stage: StageName::Simulate.as_str(), done, total, seconds_left: Some(left) });
        }
        let measured = delivery.settle(sink)?;
        let rows: Vec<Vec<Row>> = measured.iter().map(|m| m.rows.clone()).collect();
        totals.nonfinite = measured.iter().map(|m| m.nonfinite).max().unwrap_or(0);
        if !stopped {
            let meta = SegmentMeta { rows: rows.clone(), solver: totals.clone(), frame_bytes: if self.keep_motion { bytes as usize } else { 0 } };
            let motion: Vec<u8> = measured.into_iter().flat_map(|m| m.motion).collect();
            segments::keep(&self.store, segment, &meta, &motion, &world.checkpoint()?)?;
        }
        self.rows.extend(rows);
        self.totals.add(&totals);
        Ok(stopped)
    }

    fn progress(&self, stage: StageName, index: u32, ready: &Ready, sink: &mut dyn Sink) {
        let (done, total) = (u64::from(index) + 1, u64::from(ready.resolved.frames));
        let left = self.started.elapsed().as_secs_f64() / done as f64 * (total - done) as f64;
        sink.progress(Progress { stage: stage.as_str(), done, total, seconds_left: Some(left) });
    }
}

fn draw(figure: &mut Figure, index: u32, spec: &Spec, ready: &Ready) -> Result<Picture, EngineError> {
    let time_s = ready.resolved.time_s(index, spec.time.fps);
    Ok(figure.draw(
        &ready.resolved.camera,
        time_s,
        ready.resolved.size,
        crate::render::parse_colour(&spec.output.background).unwrap_or(BACKGROUND),
    )?)
}
