//! One run: what is still, then motion and pictures, then what was measured.

use super::engine::{Engine, Ready, Report};
use super::motion::Motion;
use super::{Action, EngineError, Metrics, Plan, RunOptions, StageName, pack, summary};
use crate::gpu::Gpu;
use crate::spec::{Auto, Spec};
use crate::store::{BlobReader, Entry, Store};
use crate::threads::caught;
use crate::world::bodies::{Matter, matter};
use crate::world::{Figure, asked_in_vain};
use crate::{Frame, Sink, Stop, render, skin, solver};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// Where the spec's background is no colour, which validation refuses before.
pub(super) const BACKGROUND: [f32; 3] = [0.918, 0.918, 0.949];

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
    let album = if hits(&plan) { Album::open(&engine.store, &ready.picture)? } else { None };
    if album.is_none() && hits(&plan) {
        // They were damaged: what has to be done is more than it seemed.
        plan = engine.plan_of(&ready, spec, options, previous);
    }
    engine.memory.told();
    tracing::debug!("planned");
    let gpu = engine.device()?.clone();
    // The driver compiles while the scene is made solid.
    let (solids, bound) = std::thread::scope(|scope| -> Result<_, EngineError> {
        // Without a thread for it, the passes are compiled when they are asked for.
        let ahead = || caught("compiling shaders", || prepare(&plan, spec, ready.resolved.size, &gpu));
        let _ = std::thread::Builder::new().spawn_scoped(scope, ahead);
        let clock = Instant::now();
        let solids = engine.solids(spec, &ready)?;
        seconds.insert(StageName::Proxy, clock.elapsed().as_secs_f64());
        let clock = Instant::now();
        let bound = engine.bound(spec, &ready, &solids.value)?;
        seconds.insert(StageName::Bind, clock.elapsed().as_secs_f64());
        Ok((solids, bound))
    })?;

    tracing::debug!("solid and bound");
    let matter = matter(spec, &ready.prepared.value, &solids.value);
    let mut warnings = warnings(&ready, &solids.value, &matter);
    warnings.extend(asked_in_vain(spec, &matter, &ready.resolved));
    let motion = Motion::new(engine, spec, &ready, &matter)?;
    if !motion.keep_motion {
        warnings.push("the motion would take more than half of the store, so checkpoints alone are kept: a new camera simulates again".to_owned());
    }
    warnings.extend(engine.store.take_damage());
    warnings.iter().for_each(|w| sink.warning(w));
    matter.notes.iter().for_each(|n| sink.note(n));
    if options.render && ready.resolved.leaves {
        sink.note(if spec.camera == Auto::Auto { LONG_WAY } else { OUT_OF_SIGHT });
    }

    if ready.resolved.cut {
        let ends_s = ready.resolved.duration_s;
        sink.note(&format!("the run ends at {ends_s} s, while something slides or is driven on: \"for {:.0} s\" shows more of it", 2.0 * ends_s));
    }

    let clock = Instant::now();
    let figure = if options.render && album.is_none() { Some(take_figure(engine, spec, &ready, &bound.value, &matter)?) } else { None };
    tracing::debug!("figure made");
    let figure_s = clock.elapsed().as_secs_f64();
    let mut done = motion.play(figure, sink, stop)?;
    if let Some(figure) = done.figure {
        engine.figure = Some((ready.keys.bind.clone(), figure));
    }
    if let Some(album) = album.filter(|_| !done.stopped) {
        album.show(sink, stop)?;
        done.stopped = stop.raised();
    }
    let total = clock.elapsed().as_secs_f64();
    seconds.insert(StageName::Simulate, done.totals.seconds);
    seconds.insert(StageName::Picture, (total - done.totals.seconds).max(0.0));
    for stage in &mut plan.stages {
        stage.seconds = seconds.get(&stage.stage).copied();
    }
    let results = results(engine, &ready);
    engine.store.pin("head", results.iter().map(|(stage, key)| (*stage, key.as_str())))?;
    warnings.extend(done.totals.said.iter().cloned());
    let of_solver = summary::of_forces(&done.totals, spec).into_iter().chain(summary::of_contacts(&done.totals));
    let of_solver: Vec<String> = of_solver.chain(summary::of_mended(&done.totals)).chain(summary::of_left(&done.totals)).collect();
    of_solver.iter().for_each(|w| sink.warning(w));
    warnings.extend(of_solver);
    summary::of_impacts(spec, &done.totals, ready.resolved.cell_m, done.stopped).iter().for_each(|n| sink.note(n));
    // Whoever gave a stiffness hears what it was simulated with.
    done.totals.softened.iter().for_each(|text| sink.warning(text));
    warnings.extend(done.totals.softened.iter().cloned());
    let parts = [("picture.figure", figure_s)].into_iter().chain(done.parts.clone()).map(|(part, s)| (part.to_owned(), s));
    let seconds = seconds.iter().map(|(stage, s)| (stage.as_str().to_owned(), *s)).chain(parts).collect();
    let metrics = summary::metrics(spec, &ready, &matter, &done.rows, &done.totals, seconds, engine.device()?);
    let metrics = Metrics { memory: done.memory, ..metrics };
    let crushed = summary::of_crushed(spec, &metrics);
    crushed.iter().for_each(|w| sink.warning(w));
    warnings.extend(crushed);
    Ok(Report { plan, metrics, camera: ready.resolved.camera, stopped: done.stopped, warnings, results })
}

/// What the store has of everything that a run is made of.
fn results(engine: &Engine, ready: &Ready) -> Vec<(&'static str, String)> {
    let keys = &ready.keys;
    let made = [("scene", &keys.scene), ("proxy", &keys.proxy), ("prestress", &ready.prestress), ("bind", &keys.bind), ("picture", &ready.picture)];
    let all = made.into_iter().chain(ready.segments.iter().map(|s| ("motion", &s.key)));
    all.filter(|(stage, key)| engine.store.contains(stage, key)).map(|(stage, key)| (stage, key.clone())).collect()
}

/// Whether the store has all pictures.
fn hits(plan: &Plan) -> bool {
    plan.stage(StageName::Picture).is_some_and(|s| s.action == Action::Hit)
}

/// Has the passes compiled that this run will ask for, as far as its plan tells.
fn prepare(plan: &Plan, spec: &Spec, size: [u32; 2], gpu: &Gpu) {
    let works = |stage| plan.stage(stage).is_some_and(|s| matches!(s.action, Action::Run | Action::Resume));
    if works(StageName::Simulate) {
        solver::prepare(gpu);
    }
    if works(StageName::Picture) {
        skin::prepare(gpu, spec.skin.weights);
        render::prepare(gpu, size);
    }
}

fn warnings(ready: &Ready, solids: &[crate::proxy::Solid], matter: &Matter) -> Vec<String> {
    let mut warnings = ready.prepared.value.warnings.clone();
    warnings.extend(solids.iter().flat_map(|s| s.warnings.iter().cloned()));
    warnings.extend(matter.warnings.iter().cloned());
    if ready.resolved.reframed {
        warnings.push("the predicted path does not suit the session's picture, so the camera was framed anew".to_owned());
    }
    warnings
}

/// The figure of the last run where it is of the same binding, else a new one.
fn take_figure(engine: &mut Engine, spec: &Spec, ready: &Ready, bound: &crate::skin::Bound, matter: &Matter) -> Result<Figure, EngineError> {
    match engine.figure.take() {
        Some((key, figure)) if key == ready.keys.bind && figure.suits(matter, spec.skin.weights) => Ok(figure),
        _ => {
            let gpu = engine.device()?.clone();
            Ok(Figure::new(&gpu, &ready.prepared.value, bound, matter, spec.skin.weights)?)
        }
    }
}

/// Pictures that the store has. One at a time is in memory.
pub(super) struct Album {
    entry: Entry,
    /// One PNG after another: where each ends.
    ends: Vec<u64>,
    fps: f64,
}

/// The blob of an album.
const FRAMES: &str = "frames";

impl Album {
    /// None where they are not kept, or are damaged.
    pub fn open(store: &Store, key: &str) -> Result<Option<Album>, EngineError> {
        let Some(entry) = pack::find(store, "picture", key)? else { return Ok(None) };
        let ends: Vec<u64> = entry.meta().get("ends").and_then(|v| serde_json::from_value(v.clone()).ok()).unwrap_or_default();
        let fps = entry.meta().get("fps").and_then(serde_json::Value::as_f64).unwrap_or(1.0);
        let whole = ends.is_sorted() && ends.last() == Some(&entry.bytes(FRAMES));
        Ok(if whole && pack::is_sound(&entry, FRAMES)? { Some(Album { entry, ends, fps }) } else { None })
    }

    /// Delivers them.
    pub fn show(&self, sink: &mut dyn Sink, stop: &Stop) -> Result<(), EngineError> {
        let mut blob = self.entry.open(FRAMES)?;
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        for (index, (start, end)) in (0u32..).zip(starts.zip(self.ends.iter().copied())).take_while(|_| !stop.raised()) {
            let png = self.read(&mut blob, start, end)?;
            let picture = crate::export::decode_png(&png).map_err(|e| EngineError::Unstable(e.to_string()))?;
            let (size, rgba8) = (picture.size, picture.rgba8.into());
            sink.frame(Frame { index, time_s: f64::from(index) / self.fps, size, rgba8, png: png.into(), depth: None, id: None });
        }
        Ok(())
    }

    fn read(&self, blob: &mut BlobReader, start: u64, end: u64) -> Result<Vec<u8>, EngineError> {
        Ok(blob.read_range(start, (end - start) as usize)?)
    }
}
