//! A version played back: any frame from any camera, out of the motion that the store has, and as captured where it
//! has none. Nothing is simulated and nothing is kept.

use super::engine::Engine;
use super::motion::frame_bytes;
use super::run::BACKGROUND;
use super::segments::{self, Segment};
use super::{EngineError, RunOptions};
use crate::gpu::Gpu;
use crate::render::Image;
use crate::spec::{Camera, Spec};
use crate::store::Store;
use crate::world::bodies::matter;
use crate::world::{Figure, Prepared};
use std::path::Path;
use std::sync::Arc;

/// One version that can be looked at.
#[derive(Debug)]
pub struct Player {
    /// How many frames of motion there are: fewer than the spec asks for while a run still goes on, none before it.
    pub frames: u32,
    /// How many the spec asks for.
    pub frames_total: u32,
    /// Frames a second.
    pub fps: u32,
    /// The camera that the spec resolves to.
    pub camera: Camera,
    /// Width and height of the pictures that the spec resolves to.
    pub size: [u32; 2],
    pub(super) store: Store,
    /// The device that it draws on.
    gpu: Gpu,
    prepared: Arc<Prepared>,
    segments: Vec<Segment>,
    /// The first segment whose motion was not there.
    next: Option<Segment>,
    figure: Figure,
    background: [f32; 3],
    /// Bytes of one frame of motion.
    frame_bytes: usize,
    /// The segment whose motion is in memory: its index, its bytes.
    pub(super) held: Option<(usize, Vec<u8>)>,
    posed: Option<u32>,
}

impl Engine {
    /// A player of what the store has of a version's motion.
    pub fn player(&mut self, spec: &Spec, base: &Path, options: &RunOptions) -> Result<Player, EngineError> {
        let made = Player::new(self, spec, base, options);
        self.past(made)
    }
}

impl Player {
    fn new(engine: &mut Engine, spec: &Spec, base: &Path, options: &RunOptions) -> Result<Player, EngineError> {
        let ready = engine.ready(spec, base, options)?;
        let mut segments = Vec::new();
        for segment in &ready.segments {
            match segments::get(&engine.store, segment)? {
                Some(kept) if kept.meta.frame_bytes > 0 => segments.push(segment.clone()),
                _ => break,
            }
        }
        let gpu = engine.device()?.clone();
        let prepared = ready.prepared.value.clone();
        let (figure, frame_bytes) = if segments.is_empty() {
            (captured(&gpu, &prepared)?, 0)
        } else {
            let solids = engine.solids(spec, &ready)?;
            let bound = engine.bound(spec, &ready, &solids.value)?;
            let matter = matter(spec, &prepared, &solids.value);
            (Figure::new(&gpu, &prepared, &bound.value, &matter, spec.skin.weights)?, frame_bytes(&matter))
        };
        Ok(Player {
            frames: segments.last().map_or(0, |last| last.last + 1),
            frames_total: ready.resolved.frames,
            fps: spec.time.fps,
            camera: ready.resolved.camera,
            size: ready.resolved.size,
            store: engine.store.clone(),
            gpu,
            prepared,
            next: ready.segments.get(segments.len()).cloned(),
            segments,
            figure,
            background: crate::render::parse_colour(&spec.output.background).unwrap_or(BACKGROUND),
            frame_bytes,
            held: None,
            posed: None,
        })
    }

    /// Whether the store has more motion by now: another player would show it.
    pub fn is_behind(&self) -> bool {
        self.next.as_ref().is_some_and(|segment| self.store.contains("motion", &segment.key))
    }

    /// Draws one frame; an index behind the last one draws the last one. Where motion has gone from the store since, there are
    /// fewer frames than there were.
    pub fn picture(&mut self, engine: &mut Engine, index: u32, camera: &Camera, size: [u32; 2]) -> Result<Image, EngineError> {
        let drawn = self.draw(index, camera, size);
        let own = engine.gpu.as_ref().is_some_and(|gpu| gpu.is(&self.gpu));
        if own { engine.past(drawn) } else { drawn }
    }

    fn draw(&mut self, index: u32, camera: &Camera, size: [u32; 2]) -> Result<Image, EngineError> {
        let index = self.pose(index)?;
        let time_s = f64::from(index) / f64::from(self.fps);
        Ok(self.figure.draw(camera, time_s, size, self.background)?.read(&self.gpu)?)
    }

    /// Poses the figure as in a frame, or in the last one that there is; which one that was.
    fn pose(&mut self, index: u32) -> Result<u32, EngineError> {
        loop {
            let index = index.min(self.frames.saturating_sub(1));
            let Some(at) = self.segments.iter().position(|s| (s.first..=s.last).contains(&index)) else { return Ok(0) };
            if self.posed == Some(index) {
                return Ok(index);
            }
            if !self.hold(at)? {
                self.shrink(at)?;
            } else if let Some((_, motion)) = &self.held {
                let start = (index - self.segments[at].first) as usize * self.frame_bytes;
                self.figure.pose_from(&motion[start..start + self.frame_bytes]);
                self.posed = Some(index);
            }
        }
    }

    /// Brings a segment into memory; whether the store still has it.
    fn hold(&mut self, at: usize) -> Result<bool, EngineError> {
        if self.held.as_ref().is_none_or(|(held, _)| *held != at) {
            let motion = segments::get(&self.store, &self.segments[at])?.map(|kept| kept.motion(self.frame_bytes)).transpose()?;
            self.held = motion.flatten().map(|motion| (at, motion));
        }
        Ok(self.held.is_some())
    }

    /// From a segment on there is no motion any more.
    fn shrink(&mut self, at: usize) -> Result<(), EngineError> {
        (self.frames, self.next) = (self.segments[at].first, Some(self.segments[at].clone()));
        self.segments.truncate(at);
        if self.segments.is_empty() {
            (self.frames, self.figure) = (0, captured(&self.gpu, &self.prepared)?);
        }
        Ok(())
    }
}

/// The scene as captured.
fn captured(gpu: &Gpu, prepared: &Prepared) -> Result<Figure, EngineError> {
    let mut figure = Figure::captured(gpu, prepared)?;
    figure.rest();
    Ok(figure)
}
