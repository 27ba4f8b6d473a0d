//! The front door: facts, plan, run.

use super::keys::{self, StillKeys};
use super::segments::{self, Segment};
use super::still::{self, Made, Memory};
use super::{Action, EngineError, Metrics, Plan, PlannedStage, Quality, RunOptions, StageName, reasons};
use crate::gpu::{DeviceRequest, Gpu, GpuError, Tier};
use crate::proxy::Solid;
use crate::render::{Image, RenderOptions, Renderer, View};
use crate::scene::Gaussians;
use crate::skin::{Bound, Splats};
use crate::spec::{Camera, Spec};
use crate::store::Store;
use crate::threads::Task;
use crate::world::{self, Facts, Figure, Prepared, Resolved};
use crate::{Sink, Stop};
use std::path::Path;

/// Owns the device, opened on first need, the store, and what the last run prepared. One engine
/// thread owns an engine; nothing in it is async.
#[derive(Debug)]
pub struct Engine {
    pub(super) store: Store,
    request: DeviceRequest,
    pub(super) gpu: Option<Gpu>,
    /// The device that another thread is opening.
    opening: Option<Task<Result<Gpu, GpuError>>>,
    pub(super) memory: Memory,
    /// The last figure and the key of what it was made of.
    pub(super) figure: Option<(String, Figure)>,
}

/// What a run left behind.
#[derive(Clone, Debug)]
pub struct Report {
    /// The plan, with what each stage took.
    pub plan: Plan,
    /// What was measured.
    pub metrics: Metrics,
    /// The camera that was used: hand it to later runs of the session.
    pub camera: Camera,
    /// Whether it was stopped before its end; what was finished until then is kept.
    pub stopped: bool,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// The stored results that it needs to be shown again: stage and key.
    pub results: Vec<(&'static str, String)>,
}

/// Everything that is known before motion.
pub(super) struct Ready {
    pub prepared: Made<Prepared>,
    pub resolved: Resolved,
    pub keys: StillKeys,
    pub prestress: String,
    pub segments: Vec<Segment>,
    pub picture: String,
    pub draft: bool,
}

impl Drop for Engine {
    fn drop(&mut self) {
        // A driver that is still opening when the process ends may crash.
        let _ = self.opening.take().map(Task::join);
    }
}

impl Engine {
    /// An engine that will open the requested device when it needs one.
    pub fn new(store: Store, device: DeviceRequest) -> Engine {
        Engine { store, request: device, gpu: None, opening: None, memory: Memory::default(), figure: None }
    }

    /// Begins to open the device on another thread, so that reading a scene need not wait for it.
    pub fn open_ahead(&mut self) {
        if self.gpu.is_none() && self.opening.is_none() {
            let request = self.request.clone();
            // Where no thread is to be had, the device is opened when it is needed.
            self.opening = Task::spawn("opening the device", move || Gpu::open(&request)).ok();
        }
    }

    /// Where results are kept.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// The device, opened on the first call.
    pub fn device(&mut self) -> Result<&Gpu, EngineError> {
        if self.gpu.is_none() {
            let opened = self.opening.take().map(Task::join).transpose()?;
            self.gpu = Some(opened.unwrap_or_else(|| Gpu::open(&self.request))?);
        }
        self.gpu.as_ref().ok_or_else(|| EngineError::Unstable("the device was closed".to_owned()))
    }

    /// What a spec's scene looks like before anything moves. Needs no device.
    pub fn facts(&mut self, spec: &Spec, base: &Path, options: &RunOptions) -> Result<Facts, EngineError> {
        let (_, prepared) = still::scene(&mut self.memory, &self.store, spec, base)?;
        // The cell of a draft: what full quality alone cannot hold is refused when it is asked for.
        let resolved = world::resolve(spec, &prepared.value, true, options.size, options.camera);
        world::check_scale(spec, &prepared.value, &resolved)?;
        Ok(prepared.value.facts(spec, resolved.camera))
    }

    /// Reads the scene and computes every key; nothing is simulated or drawn.
    pub(super) fn ready(&mut self, spec: &Spec, base: &Path, options: &RunOptions) -> Result<Ready, EngineError> {
        spec.validate()?;
        let (scene_key, prepared) = still::scene(&mut self.memory, &self.store, spec, base)?;
        let tier = self.device()?.tier;
        let draft = options.quality.map_or(tier == Tier::Cpu, |q| q == Quality::Draft);
        let resolved = world::resolve(spec, &prepared.value, draft, options.size, options.camera);
        world::check_scale(spec, &prepared.value, &resolved)?;
        let keys = keys::still(spec, scene_key, &resolved);
        let gpu = self.device()?;
        let prestress = keys::prestress(spec, &keys, &resolved, gpu);
        let segments = segments::layout(spec, &prestress, resolved.frames);
        let whole = segments.last().map_or("", |s| s.key.as_str());
        let picture = keys::picture(spec, whole, &keys, &resolved, gpu);
        Ok(Ready { prepared, resolved, keys, prestress, segments, picture, draft })
    }

    /// What a run would do, and why. Reasons compare with `previous`.
    pub fn plan(&mut self, spec: &Spec, base: &Path, options: &RunOptions, previous: Option<&Spec>) -> Result<Plan, EngineError> {
        let ready = self.ready(spec, base, options)?;
        Ok(self.plan_of(&ready, spec, options, previous))
    }

    pub(super) fn plan_of(&self, ready: &Ready, spec: &Spec, options: &RunOptions, previous: Option<&Spec>) -> Plan {
        let kept = |stage: &str, key: &str| if self.store.contains(stage, key) { Action::Hit } else { Action::Run };
        let picture = if options.render { kept("picture", &ready.picture) } else { Action::Skip };
        // New pictures are drawn from motion; a segment may have been kept as its end alone.
        let serves = |segment: &Segment| match picture {
            Action::Run => segments::get(&self.store, segment).ok().flatten().is_some_and(|kept| kept.meta.frame_bytes > 0),
            _ => self.store.contains("motion", &segment.key),
        };
        let missing = ready.segments.iter().position(|s| !serves(s));
        let (simulate, from_s) = match missing {
            None => (Action::Hit, None),
            Some(0) => (Action::Run, None),
            Some(index) => (Action::Resume, Some(ready.resolved.time_s(ready.segments[index - 1].last, spec.time.fps))),
        };
        let whole = ready.segments.last().map(|s| s.key.clone()).unwrap_or_default();
        let rows = [
            (StageName::Scene, ready.keys.scene.clone(), ready.prepared.action, None),
            (StageName::Proxy, ready.keys.proxy.clone(), kept("proxy", &ready.keys.proxy), None),
            (StageName::Bind, ready.keys.bind.clone(), kept("bind", &ready.keys.bind), None),
            (StageName::Simulate, whole, simulate, from_s),
            (StageName::Picture, ready.picture.clone(), picture, None),
        ];
        let mut upstream = None;
        let stages = rows.into_iter().map(|(stage, key, action, from_s)| {
            let reason = reasons::reason(stage, action, from_s, spec, previous, upstream);
            if matches!(action, Action::Run | Action::Resume) && upstream.is_none() {
                upstream = Some(stage);
            }
            PlannedStage { stage, key, action, from_s, reason, seconds: None }
        });
        Plan { stages: stages.collect() }
    }

    /// Runs what has to run, streams pictures as they come, and measures the motion.
    pub fn run(
        &mut self,
        spec: &Spec,
        base: &Path,
        options: &RunOptions,
        previous: Option<&Spec>,
        sink: &mut dyn Sink,
        stop: &Stop,
    ) -> Result<Report, EngineError> {
        let done = super::run::run(self, spec, base, options, previous, sink, stop);
        self.past(done)
    }

    /// Hands a result on. A device that is lost, or has no memory left, goes with what was made on it: the next turn opens one
    /// anew.
    pub(super) fn past<T>(&mut self, done: Result<T, EngineError>) -> Result<T, EngineError> {
        if let Err(EngineError::Gpu(GpuError::NoMemory { .. } | GpuError::Lost { .. })) = &done {
            (self.gpu, self.figure) = (None, None);
        }
        done
    }

    /// Pictures of Gaussians as they are, in their own frame.
    pub fn still(&mut self, gaussians: &Gaussians, views: &[View], options: &RenderOptions) -> Result<Vec<Image>, EngineError> {
        let gpu = self.device()?.clone();
        let object = vec![u32::MAX; gaussians.len()];
        let draw = || -> Result<Vec<Image>, EngineError> {
            let splats = Splats::new(&gpu, gaussians, glam::Quat::IDENTITY, &object)?;
            let mut renderer = Renderer::new(&gpu);
            views.iter().map(|view| Ok(renderer.draw(&splats, view, options)?.read(&gpu)?)).collect()
        };
        self.past(draw())
    }

    pub(super) fn solids(&mut self, spec: &Spec, ready: &Ready) -> Result<Made<Vec<Solid>>, EngineError> {
        still::solids(&mut self.memory, &self.store, spec, &ready.prepared.value, &ready.keys, &ready.resolved)
    }

    pub(super) fn bound(&mut self, spec: &Spec, ready: &Ready, solids: &[Solid]) -> Result<Made<Bound>, EngineError> {
        still::bound(&mut self.memory, &self.store, spec, &ready.prepared.value, solids, &ready.keys)
    }
}
