//! What `"auto"` means for one spec and one scene. Everything here is predicted from inputs.

use super::{Prepared, ballistics, camera};
use crate::spec::{Auto, Camera, Spec};
use serde_json::{Map, Value, json};

/// Grid cells along the longest side of the objects where the spec leaves it to the quality.
pub const CELLS_ACROSS_DRAFT: u32 = 24;
/// As above, for full quality.
pub const CELLS_ACROSS_FULL: u32 = 64;
/// Picture size in draft.
pub const SIZE_DRAFT: [u32; 2] = [640, 360];
/// Picture size in full quality.
pub const SIZE_FULL: [u32; 2] = [1280, 720];

/// Every automatic value of a run, filled in.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// Seconds of motion.
    pub duration_s: f64,
    /// Frames of motion, the one at t = 0 included.
    pub frames: u32,
    /// Height of the ground plane.
    pub ground_m: f64,
    /// Edge of a grid cell.
    pub cell_m: f64,
    /// Picture width and height.
    pub size: [u32; 2],
    /// Where it is seen from at t = 0.
    pub camera: Camera,
    /// The session's camera lost the predicted path and was left.
    pub reframed: bool,
    /// The predicted path leaves the picture.
    pub leaves: bool,
    /// The automatic duration ends before what is predicted to move does.
    pub cut: bool,
}

/// Fills in everything that does not need a solid.
pub fn resolve(spec: &Spec, prepared: &Prepared, draft: bool, size: Option<[u32; 2]>, session: Option<Camera>) -> Resolved {
    let facts = prepared.object_facts(spec);
    let (duration_s, cut) = match spec.time.duration_s {
        Auto::Value(duration_s) => (duration_s, false),
        Auto::Auto => ballistics::duration_s(spec, &facts, prepared.ground_m),
    };
    let frames = (duration_s * f64::from(spec.time.fps) + 1e-6).floor() as u32 + 1;
    let cells = spec.solver.cells_across.unwrap_or(if draft { CELLS_ACROSS_DRAFT } else { CELLS_ACROSS_FULL });
    let longest = facts.iter().flat_map(|f| (0..3).map(|i| f.high_m[i] - f.low_m[i])).fold(0.0, f64::max);
    let size = size.unwrap_or(spec.output.size.unwrap_or(if draft { SIZE_DRAFT } else { SIZE_FULL }));
    let aspect = f64::from(size[0]) / f64::from(size[1].max(1));
    let camera::Framed { camera, reframed, leaves } = camera::resolve(spec, prepared, duration_s, aspect, session);
    Resolved {
        duration_s,
        frames,
        ground_m: prepared.ground_m,
        cell_m: if longest > 0.0 { longest / f64::from(cells.max(1)) } else { 1e-2 },
        size,
        camera,
        reframed,
        leaves,
        cut,
    }
}

impl Resolved {
    /// Seconds of frame k.
    pub fn time_s(&self, frame: u32, fps: u32) -> f64 {
        f64::from(frame) / f64::from(fps)
    }

    /// The values that the spec left to the program, by path, for `metrics.json`.
    pub fn report(&self, spec: &Spec) -> Map<String, Value> {
        let mut values = Map::new();
        if spec.world.ground.height_m == Auto::Auto {
            values.insert("world.ground.height_m".to_owned(), json!(self.ground_m));
        }
        if spec.time.duration_s == Auto::Auto {
            values.insert("time.duration_s".to_owned(), json!(self.duration_s));
        }
        values
    }
}
