//! A picture on its way back from the device, and the picture itself.

use super::renderer::{Frame, Shared};
use super::uniform::Planes;
use crate::gpu::{Extent, Gpu, GpuError, Readback};
use std::sync::Arc;

/// A frame that was submitted. Reading it waits; the device does not.
#[derive(Debug)]
pub struct Picture {
    // Both are there until the picture is read or dropped.
    frame: Option<Frame>,
    readback: Option<Readback>,
    shared: Arc<Shared>,
}

/// A finished picture, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Composited on the background, display-referred, rounded; alpha is 255.
    pub rgba8: Vec<u8>,
    /// Accumulated colour, display-referred and premultiplied, without the background; alpha last.
    pub colour: Option<Vec<[f32; 4]>>,
    /// Mean camera z, each splat by its weight, in the scene's units; +inf where nothing is.
    pub depth: Option<Vec<f32>>,
    /// Object of the heaviest splat; `u32::MAX` where nothing is or what is there is static.
    pub id: Option<Vec<u32>>,
}

impl Picture {
    pub(super) fn start(gpu: &Gpu, frame: Frame, shared: Arc<Shared>) -> Picture {
        let readback = read_back(gpu, &frame);
        Picture { frame: Some(frame), readback: Some(readback), shared }
    }

    /// Waits for the picture. Where the frame had more pairs of bin and Gaussian than there was room
    /// for, room is made and the frame drawn again from its projected Gaussians, which are still there.
    pub fn read(mut self, gpu: &Gpu) -> Result<Image, GpuError> {
        let (Some(mut frame), Some(mut readback)) = (self.frame.take(), self.readback.take()) else {
            return Err(gpu.lost("the picture was already read"));
        };
        loop {
            let parts = readback.wait(gpu)?;
            let extent: Vec<u32> = bytemuck::pod_collect_to_vec(&parts[1]);
            let (drawn, wanted) = (extent[0], extent[1]);
            if drawn == wanted {
                let image = Image::from_bytes(&parts[0], &frame.planes);
                self.shared.put(frame.buffers);
                return Ok(image);
            }
            frame.redraw(gpu, &self.shared.passes, self.shared.wants_pairs(wanted))?;
            readback = read_back(gpu, &frame);
        }
    }
}

impl Drop for Picture {
    fn drop(&mut self) {
        if let Some(frame) = self.frame.take() {
            self.shared.put(frame.buffers);
        }
    }
}

/// The planes, and whether all pairs had room.
fn read_back(gpu: &Gpu, frame: &Frame) -> Readback {
    let bytes = u64::from(frame.planes.starts()[3]) * 4;
    Readback::start(gpu, &[(&frame.buffers.pixels, bytes), (&frame.buffers.pairs.buffer, Extent::BYTES)])
}

impl Image {
    fn from_bytes(bytes: &[u8], planes: &Planes) -> Image {
        let [colour, depth, id, end] = planes.starts().map(|word| 4 * word as usize);
        let plane = |wanted: bool, from: usize, to: usize| wanted.then(|| &bytes[from..to]);
        Image {
            size: planes.size,
            rgba8: bytes[..colour].to_vec(),
            colour: plane(planes.colour, colour, depth).map(bytemuck::pod_collect_to_vec),
            depth: plane(planes.depth, depth, id).map(bytemuck::pod_collect_to_vec),
            id: plane(planes.id, id, end).map(bytemuck::pod_collect_to_vec),
        }
    }
}
