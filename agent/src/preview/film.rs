//! The pictures of one version, small enough to keep them all.

use phystalk::Frame;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Widest picture that a film keeps: more than a terminal shows, and 100 of them in 70 MB.
const WIDTH: u32 = 640;

/// One small picture.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Frame k shows time k / fps.
    pub index: u32,
    /// Seconds since t = 0.
    pub time_s: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// sRGB, rows from the top.
    pub rgb8: Arc<[u8]>,
}

impl Picture {
    /// Averages blocks of pixels until the picture is at most [`WIDTH`] wide.
    pub fn of(frame: &Frame) -> Picture {
        let step = frame.size[0].div_ceil(WIDTH).max(1);
        let size = [(frame.size[0] / step).max(1), (frame.size[1] / step).max(1)];
        let stride = frame.size[0] as usize * 4;
        let mut rgb8 = Vec::with_capacity((size[0] * size[1] * 3) as usize);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let mut sum = [0u32; 3];
                for row in 0..step {
                    let start = (y * step + row) as usize * stride + (x * step) as usize * 4;
                    for pixel in frame.rgba8[start..start + step as usize * 4].chunks_exact(4) {
                        (0..3).for_each(|c| sum[c] += u32::from(pixel[c]));
                    }
                }
                let area = step * step;
                rgb8.extend(sum.map(|s| ((s + area / 2) / area) as u8));
            }
        }
        Picture { index: frame.index, time_s: frame.time_s, size, rgb8: rgb8.into() }
    }
}

/// All pictures of a version that are done so far, in order.
#[derive(Clone, Debug, Default)]
pub struct Film {
    /// Counts the films of this process, so that a viewer sees that another one began.
    pub number: u64,
    /// The version's name.
    pub version: String,
    /// In order of time.
    pub pictures: Vec<Picture>,
}

impl Film {
    /// Seconds from one picture to the next.
    pub fn interval_s(&self) -> f64 {
        match self.pictures.as_slice() {
            [first, .., last] => ((last.time_s - first.time_s) / (self.pictures.len() - 1) as f64).max(1e-3),
            _ => 0.02,
        }
    }
}

/// One film, written by the thread that runs the engine and read by the one that draws.
#[derive(Clone, Debug, Default)]
pub struct Reel(Arc<Mutex<Film>>);

impl Reel {
    /// The film as it is now.
    pub fn film(&self) -> MutexGuard<'_, Film> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts an empty film in.
    pub fn start(&self, version: &str) {
        let mut film = self.film();
        *film = Film { number: film.number + 1, version: version.to_owned(), pictures: Vec::new() };
    }

    /// Adds a picture.
    pub fn add(&self, frame: &Frame) {
        let picture = Picture::of(frame);
        self.film().pictures.push(picture);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_frames_are_averaged_and_small_ones_kept() {
        let frame = |size: [u32; 2]| {
            let pixels = (0..size[0] * size[1]).flat_map(|i| [if i % 2 == 0 { 0 } else { 200 }, 10, 20, 255]);
            Frame { index: 3, time_s: 0.06, size, rgba8: pixels.collect::<Vec<u8>>().into(), png: Vec::new().into(), depth: None, id: None }
        };
        let small = Picture::of(&frame([64, 36]));
        assert_eq!((small.size, small.rgb8.len(), small.index), ([64, 36], 64 * 36 * 3, 3));
        assert_eq!(&small.rgb8[..6], [0, 10, 20, 200, 10, 20]);
        let large = Picture::of(&frame([1280, 720]));
        assert_eq!(large.size, [640, 360]);
        assert_eq!(&large.rgb8[..3], [100, 10, 20]);
    }
}
