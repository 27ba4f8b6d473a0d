//! A picture on its way back from the device, and the picture itself.

use super::renderer::{Frame, Shared};
use super::uniform::Planes;
use crate::gpu::{Arrived, Extent, Gpu, GpuError, Readback};
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

    /// Waits for the picture.
    pub fn read(self, gpu: &Gpu) -> Result<Image, GpuError> {
        self.develop(gpu)?.image()
    }

    /// Waits for the picture, which lies in memory shared with the device then. Where the frame had more pairs of
    /// bin and Gaussian than there was room for, room is made and the frame drawn again from its projected
    /// Gaussians, which are still there.
    pub fn develop(mut self, gpu: &Gpu) -> Result<Developed, GpuError> {
        let (Some(mut frame), Some(mut readback)) = (self.frame.take(), self.readback.take()) else {
            return Err(gpu.lost("the picture was already read"));
        };
        loop {
            let arrived = readback.arrive(gpu)?;
            let [drawn, wanted]: [u32; 2] = arrived.part(1, |extent| bytemuck::pod_read_unaligned(&extent[..8]))?;
            if drawn == wanted {
                let planes = frame.planes;
                self.shared.put(frame.buffers);
                return Ok(Developed { arrived, planes });
            }
            frame.redraw(gpu, &self.shared.passes, self.shared.wants_pairs(wanted))?;
            readback = read_back(gpu, &frame);
        }
    }
}

/// A finished picture in memory that the device wrote. Copying it out can be left to another thread.
#[derive(Debug)]
pub struct Developed {
    arrived: Arrived,
    planes: Planes,
}

impl Developed {
    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.planes.size
    }

    /// What `read` makes of [`Image::rgba8`].
    pub fn rgba8<R>(&self, read: impl FnOnce(&[u8]) -> R) -> Result<R, GpuError> {
        let end = 4 * self.planes.starts()[0] as usize;
        self.arrived.part(0, |bytes| read(&bytes[..end]))
    }

    /// All planes.
    pub fn image(&self) -> Result<Image, GpuError> {
        self.arrived.part(0, |bytes| Image::from_bytes(bytes, &self.planes))
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
