//! A version looked at without running it: its pictures where the store has them, else what motion it has, else the
//! scene as captured. And what `"auto"` means before a run.

use super::engine::Engine;
use super::run::{BACKGROUND, replay_pictures};
use super::{EngineError, RunOptions, still};
use crate::render::Image;
use crate::spec::{Auto, Spec};
use crate::world::{self, Figure};
use crate::{Frame, Sink, Stop, proxy};
use serde_json::{Map, Value, json};
use std::path::Path;

impl Engine {
    /// Hands over the frames that a version has, one still picture where it has none. Nothing is simulated or kept.
    /// Frames that are drawn anew carry no PNG.
    pub fn look(&mut self, spec: &Spec, base: &Path, options: &RunOptions, sink: &mut dyn Sink, stop: &Stop) -> Result<(), EngineError> {
        let ready = self.ready(spec, base, options)?;
        if self.store.contains("picture", &ready.picture) {
            return replay_pictures(&self.store, &ready, sink);
        }
        if let Some(mut player) = self.player(spec, base, options)? {
            for index in (0..player.frames).take_while(|_| !stop.raised()) {
                let camera = player.camera;
                let image = player.picture(self, index, &camera, ready.resolved.size)?;
                sink.frame(frame(index, ready.resolved.time_s(index, spec.time.fps), image));
            }
            return Ok(());
        }
        let gpu = self.device()?.clone();
        let mut figure = Figure::captured(&gpu, &ready.prepared.value)?;
        figure.rest();
        let background = crate::render::parse_colour(&spec.output.background).unwrap_or(BACKGROUND);
        let image = figure.draw(&ready.resolved.camera, 0.0, ready.resolved.size, background)?.read(&gpu)?;
        sink.frame(frame(0, 0.0, image));
        Ok(())
    }

    /// What `"auto"` comes to, by path, known without a run: duration, ground, each object's stiffness. Needs no device.
    pub fn automatic(&mut self, spec: &Spec, base: &Path, options: &RunOptions) -> Result<Map<String, Value>, EngineError> {
        let (key, prepared) = still::scene(&mut self.memory, &self.store, spec, base)?;
        let prepared = prepared.value;
        let mut values = world::resolve(spec, &prepared, false, options.size, options.camera).report(spec);
        for (index, object) in spec.objects.iter().enumerate() {
            let parts = object.parts.iter().map(|part| (format!("object.{}.part.{}", object.name, part.name), &part.material));
            let pieces = std::iter::once((format!("object.{}", object.name), &object.material)).chain(parts);
            // What flows goes by the depth of its solid, which is known after a run.
            let asked: Vec<_> = pieces.filter(|(_, m)| m.stands() && m.young_pa() == Some(Auto::Auto)).collect();
            if asked.is_empty() {
                continue;
            }
            let density = object.material.density_kg_m3();
            let inputs = format!("{key} {index} {} {density}", prepared.ground_m);
            let value_pa = *self.memory.young_pa.entry(inputs).or_insert_with(|| {
                let members = prepared.gaussians.subset(&prepared.members(index as u32, false));
                proxy::young_auto(&proxy::stance_of(&members, prepared.ground_m as f32), density).value_pa
            });
            for (path, material) in asked {
                values.insert(format!("{path}.material.young_pa"), json!(value_pa * material.density_kg_m3() / density));
            }
        }
        Ok(values)
    }
}

fn frame(index: u32, time_s: f64, image: Image) -> Frame {
    Frame { index, time_s, size: image.size, rgba8: image.rgba8.into(), png: Vec::new().into(), depth: None, id: None }
}
