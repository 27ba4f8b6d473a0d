//! What is seen: Gaussians, the motion that moves them, their shadow, the renderer.

use super::bodies::Matter;
use super::{Prepared, camera};
use crate::gpu::{Gpu, GpuError, Recording};
use crate::render::shadow::Shadow;
use crate::render::{GroundLook, Picture, RenderOptions, Renderer, View};
use crate::skin::{Bound, Filling, Skinner, Splats};
use crate::spec::{Camera, Weights};
use glam::Vec3;

/// Radius of the tone under objects over their largest extent.
const POOL_SHARE: f32 = 1.6;

/// A scene that can be posed by one frame of motion and drawn.
#[derive(Debug)]
pub struct Figure {
    gpu: Gpu,
    splats: Splats,
    moved: Option<Moved>,
    shadow: Shadow,
    renderer: Renderer,
    ground_m: f32,
    pool_m: [f32; 3],
}

/// What moves the Gaussians of a figure.
#[derive(Debug)]
struct Moved {
    skinner: Skinner,
    /// Whether particles of what keeps no shape are drawn themselves.
    filled: bool,
    /// Motion of a frame that comes from the store.
    replayed: wgpu::Buffer,
}

impl Figure {
    /// Uploads a scene and binds it to matter in the captured pose.
    pub fn new(gpu: &Gpu, prepared: &Prepared, bound: &Bound, matter: &Matter, weights: Weights) -> Result<Figure, GpuError> {
        let particles = &matter.particles;
        let rest_m = &particles.position_m;
        let filling = is_filled(matter, weights).then(|| {
            let later: Vec<_> = matter.changes.iter().flatten().map(|stuff| stuff.substance.clone()).collect();
            let made_of = particles.substance.iter().map(|&row| particles.substances[usize::from(row)].clone());
            Filling::new(&prepared.gaussians, &prepared.object_of, rest_m, &particles.volume_m3, &particles.object).made_of(made_of, &later)
        });
        let more = filling.as_ref().map_or(Vec::new(), |filling| particles.object.repeat(filling.grains as usize));
        let mut figure = Figure::with_room(gpu, prepared, &more)?;
        let mut skinner = Skinner::new(gpu, &figure.splats, bound, rest_m, weights)?;
        if let Some(filling) = &filling {
            skinner.fill(&figure.splats, filling)?;
        }
        figure.moved = Some(Moved { skinner, filled: filling.is_some(), replayed: gpu.storage::<[u32; 8]>("figure.replayed", rest_m.len())? });
        Ok(figure)
    }

    /// Whether it can show such matter.
    pub fn suits(&self, matter: &Matter, weights: Weights) -> bool {
        !is_filled(matter, weights) || self.moved.as_ref().is_some_and(|moved| moved.filled)
    }

    /// Uploads a scene in the captured pose; nothing can move it.
    pub fn captured(gpu: &Gpu, prepared: &Prepared) -> Result<Figure, GpuError> {
        Figure::with_room(gpu, prepared, &[])
    }

    /// With as many more Gaussians, which are not seen yet, as objects that they belong to are given.
    fn with_room(gpu: &Gpu, prepared: &Prepared, more: &[u32]) -> Result<Figure, GpuError> {
        let object_of = [prepared.object_of.as_slice(), more].concat();
        let splats = Splats::new(gpu, &prepared.gaussians, prepared.world_from_sh, &object_of)?;
        let (mut casters, mut receivers) = (Vec::new(), Vec::new());
        for (index, object) in (0u32..).zip(&object_of) {
            match (*object, prepared.floater.get(index as usize).copied().unwrap_or(false)) {
                (u32::MAX, _) => receivers.push(index),
                (_, false) => casters.push(index),
                _ => {}
            }
        }
        let has_static = !receivers.is_empty();
        let shadow = Shadow::new(gpu, &splats, &casters, &receivers, Some(prepared.ground_m as f32))?;
        Ok(Figure {
            moved: None,
            shadow,
            renderer: Renderer::new(gpu),
            ground_m: prepared.ground_m as f32,
            // Static Gaussians show their own floor; a cut-out gets a tone to stand on.
            pool_m: if has_static { [0.0; 3] } else { pool(prepared) },
            gpu: gpu.clone(),
            splats,
        })
    }

    /// Poses by what the solver's frame pass wrote.
    pub fn pose(&mut self, motion: &wgpu::Buffer) {
        let mut recording = Recording::default();
        if let Some(moved) = &self.moved {
            moved.skinner.record(motion, &mut recording);
        }
        self.shadow.record(&mut recording);
        self.gpu.submit(&recording);
    }

    /// Casts the shadow of the captured pose.
    pub fn rest(&mut self) {
        let mut recording = Recording::default();
        self.shadow.record(&mut recording);
        self.gpu.submit(&recording);
    }

    /// Poses by a frame of motion from the store.
    pub fn pose_from(&mut self, motion: &[u8]) {
        let Some(Moved { replayed, .. }) = &self.moved else { return };
        self.gpu.upload(replayed, motion);
        let motion = replayed.clone();
        self.pose(&motion);
    }

    /// Starts drawing the pose; the picture can be waited for later.
    pub fn draw(&mut self, camera: &Camera, time_s: f64, size: [u32; 2], background: [f32; 3]) -> Result<Picture, GpuError> {
        let now = camera::orbited(camera, time_s);
        let point = |p: [f64; 3]| Vec3::from(p.map(|v| v as f32));
        let view = View::look_at(point(now.eye_m), point(now.target_m), now.fov_deg as f32, size).with_background(background);
        // Where nothing was captured, the plain ground shows the shadow.
        let shadow = Some(self.shadow.ground_map().clone());
        let ground = Some(GroundLook { height_m: self.ground_m, shadow, pool_m: self.pool_m });
        self.renderer.draw(&self.splats, &view, &RenderOptions { ground, ..RenderOptions::default() })
    }
}

/// Whether particles of what keeps no shape are drawn themselves. The paper has none of that: its Gaussians are all there is,
/// and none of them fades.
fn is_filled(matter: &Matter, weights: Weights) -> bool {
    matter.sheds_shape() && weights != Weights::Paper
}

/// Centre and radius of the tone on a plain ground: wide enough for all objects as captured, and it
/// stays there when they move.
fn pool(prepared: &Prepared) -> [f32; 3] {
    let owned = prepared.gaussians.mean.iter().zip(prepared.object_of.iter().zip(&prepared.floater));
    let points = owned.filter(|(_, (object, floater))| **object != u32::MAX && !**floater).map(|(mean, _)| *mean);
    let (low, high) = points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    if !low.is_finite() || !high.is_finite() {
        return [0.0; 3];
    }
    let middle = (low + high) / 2.0;
    [middle.x, middle.y, POOL_SHARE * (high - low).max_element()]
}
