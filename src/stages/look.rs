//! A version looked at without running it: its pictures where the store has them, else what motion it has, else the
//! scene as captured. And what `"auto"` means before a run.

use super::engine::Engine;
use super::run::Album;
use super::{EngineError, RunOptions, still};
use crate::render::Image;
use crate::spec::{Spec, Young};
use crate::world;
use crate::{Frame, Sink, Stop, proxy};
use std::path::Path;

impl Engine {
    /// Hands over the frames that a version has, one still picture where it has none. Nothing is simulated or kept.
    /// Frames that are drawn anew carry no PNG.
    pub fn look(&mut self, spec: &Spec, base: &Path, options: &RunOptions, sink: &mut dyn Sink, stop: &Stop) -> Result<(), EngineError> {
        let looked = self.look_through(spec, base, options, sink, stop);
        self.past(looked)
    }

    fn look_through(&mut self, spec: &Spec, base: &Path, options: &RunOptions, sink: &mut dyn Sink, stop: &Stop) -> Result<(), EngineError> {
        let ready = self.ready(spec, base, options)?;
        if let Some(album) = Album::open(&self.store, &ready.picture)? {
            return album.show(sink, stop);
        }
        let mut player = self.player(spec, base, options)?;
        for index in (0..player.frames.max(1)).take_while(|_| !stop.raised()) {
            let (camera, size) = (player.camera, player.size);
            let image = player.picture(self, index, &camera, size)?;
            if index > 0 && index >= player.frames {
                break;
            }
            sink.frame(frame(index, ready.resolved.time_s(index, spec.time.fps), image));
        }
        Ok(())
    }

    /// What `"auto"` comes to at a path, known without a run: duration, ground, an object's stiffness. Needs no device.
    /// Stiffness is computed when it is asked for, once.
    pub fn automatic(&mut self, spec: &Spec, base: &Path, options: &RunOptions, path: &str) -> Result<Option<f64>, EngineError> {
        let (key, prepared) = still::scene(&mut self.memory, &self.store, spec, base)?;
        let prepared = prepared.value;
        for (index, object) in spec.objects.iter().enumerate() {
            let parts = object.parts.iter().map(|part| (format!("object.{}.part.{}", object.name, part.name), &part.material));
            let mut pieces = std::iter::once((format!("object.{}", object.name), &object.material)).chain(parts);
            let Some((_, material)) = pieces.find(|(owner, _)| path == format!("{owner}.material.young_pa")) else { continue };
            // What flows goes by the depth of its solid, which is known after a run.
            if !material.stands() || material.young_pa() != Some(Young::Auto) {
                return Ok(None);
            }
            let density = object.material.density_kg_m3();
            let inputs = format!("{key} {index} {} {density}", prepared.ground_m);
            let value_pa = *self.memory.young_pa.entry(inputs).or_insert_with(|| {
                let members = prepared.gaussians.subset(&prepared.members(index as u32, false));
                proxy::young_auto(&proxy::stance_of(&members, prepared.ground_m as f32), density).value_pa
            });
            return Ok(Some(value_pa * material.density_kg_m3() / density));
        }
        let resolved = world::resolve(spec, &prepared, false, options.size, options.camera).report(spec);
        Ok(resolved.get(path).and_then(serde_json::Value::as_f64))
    }
}

fn frame(index: u32, time_s: f64, image: Image) -> Frame {
    Frame { index, time_s, size: image.size, rgba8: image.rgba8.into(), png: Vec::new().into(), depth: None, id: None }
}
