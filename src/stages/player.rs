//! A version played back: any frame from any camera, out of the motion that the store has, and as captured where it
//! has none. Nothing is simulated and nothing is kept.

use super::engine::Engine;
use super::run::BACKGROUND;
use super::segments::{self, Segment};
use super::{EngineError, RunOptions};
use crate::render::Image;
use crate::spec::{Camera, Spec};
use crate::store::Store;
use crate::world::Figure;
use crate::world::bodies::matter;
use std::path::Path;

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
    store: Store,
    segments: Vec<Segment>,
    /// The first segment whose motion was not there.
    next: Option<Segment>,
    figure: Figure,
    background: [f32; 3],
    /// The segment whose motion is in memory: its index, its bytes, bytes of one frame.
    held: Option<(usize, Vec<u8>, usize)>,
    posed: Option<u32>,
}

impl Engine {
    /// A player of what the store has of a version's motion.
    pub fn player(&mut self, spec: &Spec, base: &Path, options: &RunOptions) -> Result<Player, EngineError> {
        let ready = self.ready(spec, base, options)?;
        let mut segments = Vec::new();
        for segment in &ready.segments {
            match segments::get(&self.store, segment)? {
                Some(kept) if kept.meta.frame_bytes > 0 => segments.push(segment.clone()),
                _ => break,
            }
        }
        let gpu = self.device()?.clone();
        let figure = if segments.is_empty() {
            let mut figure = Figure::captured(&gpu, &ready.prepared.value)?;
            figure.rest();
            figure
        } else {
            let solids = self.solids(spec, &ready)?;
            let bound = self.bound(spec, &ready, &solids.value)?;
            let matter = matter(spec, &ready.prepared.value, &solids.value);
            Figure::new(&gpu, &ready.prepared.value, &bound.value, &matter, spec.skin.weights)?
        };
        Ok(Player {
            frames: segments.last().map_or(0, |last| last.last + 1),
            frames_total: ready.resolved.frames,
            fps: spec.time.fps,
            camera: ready.resolved.camera,
            size: ready.resolved.size,
            store: self.store.clone(),
            next: ready.segments.get(segments.len()).cloned(),
            segments,
            figure,
            background: crate::render::parse_colour(&spec.output.background).unwrap_or(BACKGROUND),
            held: None,
            posed: None,
        })
    }
}

impl Player {
    /// Whether the store has more motion by now: another player would show it.
    pub fn is_behind(&self) -> bool {
        self.next.as_ref().is_some_and(|segment| self.store.contains("motion", &segment.key))
    }

    /// Draws one frame; an index behind the last one draws the last one.
    pub fn picture(&mut self, engine: &mut Engine, index: u32, camera: &Camera, size: [u32; 2]) -> Result<Image, EngineError> {
        let index = index.min(self.frames.saturating_sub(1));
        if self.posed != Some(index) {
            self.hold(index)?;
            if let Some((segment, motion, frame_bytes)) = &self.held {
                let start = (index - self.segments[*segment].first) as usize * frame_bytes;
                self.figure.pose_from(&motion[start..start + frame_bytes]);
                self.posed = Some(index);
            }
        }
        let time_s = f64::from(index) / f64::from(self.fps);
        let picture = self.figure.draw(camera, time_s, size, self.background)?;
        Ok(picture.read(engine.device()?)?)
    }

    /// Brings the segment of a frame into memory.
    fn hold(&mut self, index: u32) -> Result<(), EngineError> {
        let Some(at) = self.segments.iter().position(|s| (s.first..=s.last).contains(&index)) else { return Ok(()) };
        if self.held.as_ref().is_some_and(|(held, ..)| *held == at) {
            return Ok(());
        }
        let kept = segments::get(&self.store, &self.segments[at])?;
        let motion = kept.as_ref().map(|k| k.motion()).transpose()?.flatten();
        self.held = kept.zip(motion).map(|(kept, motion)| (at, motion, kept.meta.frame_bytes));
        Ok(())
    }
}
