//! What every pass of a frame knows. Mirrors `shaders/render/frame.wgsl`. It lies in a storage buffer:
//! lavapipe compiles a pass anew, and keeps it, wherever a uniform alone decides a branch or a loop.

use super::profile::{Constants, INRIA_TILE, NEAR};
use super::{RenderOptions, View};
use bytemuck::{Pod, Zeroable};

/// See `struct Frame` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Uniform {
    pub camera: [[f32; 4]; 3],
    pub eye: [f32; 3],
    pub near: f32,
    pub focal: [f32; 2],
    pub centre: [f32; 2],
    pub tangent_low: [f32; 2],
    pub tangent_high: [f32; 2],
    pub background: [f32; 3],
    pub dilation: f32,
    pub size: [u32; 2],
    pub bins: [u32; 2],
    pub bin_shift: u32,
    pub count: u32,
    pub sh_degree: u32,
    pub capacity: u32,
    pub compensation_floor: f32,
    pub opacity_cap: f32,
    pub sigmas: f32,
    pub stop: f32,
    pub alpha_min_log2: f32,
    pub alpha_min: f32,
    pub shaded: u32,
    pub colour_at: u32,
    pub depth_at: u32,
    pub id_at: u32,
    pub ground_m: f32,
    pub pad: u32,
    pub pool: [f32; 4],
}

/// Which planes a picture has, and where in its words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Planes {
    pub size: [u32; 2],
    pub colour: bool,
    pub depth: bool,
    pub id: bool,
}

impl Planes {
    fn pixels(&self) -> u32 {
        self.size[0] * self.size[1]
    }

    /// First word of the premultiplied colours, of the depths, of the ids; then the number of words.
    pub fn starts(&self) -> [u32; 4] {
        let colour = self.pixels();
        let depth = colour + if self.colour { 4 * self.pixels() } else { 0 };
        let id = depth + if self.depth { self.pixels() } else { 0 };
        [colour, depth, id, id + if self.id { self.pixels() } else { 0 }]
    }
}

/// Side of the bins: what suits the device, unless the profile names its tiles.
pub(super) fn bin_side(constants: &Constants, preferred: u32) -> u32 {
    if constants.sigmas > 0.0 { INRIA_TILE } else { preferred }
}

impl Uniform {
    /// Everything but `capacity`, which the frame's buffers know.
    pub fn new(view: &View, options: &RenderOptions, planes: &Planes, bin: u32, count: u32, sh_degree: u32) -> Uniform {
        let constants = options.profile.constants();
        let rows = view.world_to_camera.transpose().to_cols_array_2d();
        let (tangent_low, tangent_high) = tangents(view, &constants);
        let [colour_at, depth_at, id_at, _] = planes.starts();
        let shaded = options.ground.as_ref().is_some_and(|ground| ground.shadow.is_some());
        let word = |wanted: bool, at: u32| if wanted { at } else { u32::MAX };
        Uniform {
            camera: [rows[0], rows[1], rows[2]],
            eye: view.eye().to_array(),
            near: constants.near.unwrap_or(if options.near > 0.0 { options.near } else { NEAR }),
            focal: [view.fx, view.fy],
            centre: [view.cx, view.cy],
            tangent_low,
            tangent_high,
            background: view.background,
            dilation: constants.dilation,
            size: planes.size,
            bins: planes.size.map(|pixels| pixels.div_ceil(bin)),
            bin_shift: bin.trailing_zeros(),
            count,
            sh_degree,
            capacity: 0,
            compensation_floor: constants.compensation_floor,
            opacity_cap: constants.opacity_cap,
            sigmas: constants.sigmas,
            stop: constants.stop,
            alpha_min_log2: constants.alpha_min.log2(),
            alpha_min: constants.alpha_min,
            shaded: u32::from(shaded),
            colour_at: word(planes.colour, colour_at),
            depth_at: word(planes.depth, depth_at),
            id_at: word(planes.id, id_at),
            ground_m: options.ground.as_ref().map_or(0.0, |ground| ground.height_m),
            pad: 0,
            pool: options.ground.as_ref().map_or([0.0; 4], |ground| [ground.pool_m[0], ground.pool_m[1], ground.pool_m[2], 0.0]),
        }
    }

    /// Bins of the whole picture.
    pub fn bin_count(&self) -> u32 {
        self.bins[0] * self.bins[1]
    }
}

/// Smallest and largest tangent at which the projection's slope is taken, x and y.
fn tangents(view: &View, constants: &Constants) -> ([f32; 2], [f32; 2]) {
    let size = [view.width as f32, view.height as f32];
    let (focal, centre) = ([view.fx, view.fy], [view.cx, view.cy]);
    let half = |i: usize| 0.5 * size[i] / focal[i];
    let edge = |i: usize, distance: f32| if constants.symmetric { half(i) } else { distance / focal[i] };
    let low = |i: usize| -(edge(i, centre[i]) + constants.tangent_margin * half(i));
    let high = |i: usize| edge(i, size[i] - centre[i]) + constants.tangent_margin * half(i);
    ([low(0), low(1)], [high(0), high(1)])
}
