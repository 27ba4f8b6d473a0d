//! Animated WebP: what a README and a chat window can show.

use super::atomic::Pending;
use super::raster::{check, fitted, shrunk};
use super::vp8;
use super::{ExportError, Raster};
use crate::Frame;
use crate::threads::{ThreadError, caught, detach};
use std::collections::VecDeque;
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, OnceLock};

/// Widest a preview is.
const WIDTH: u32 = 640;

/// Most pictures a second; a run of more frames a second is thinned to it.
const FPS: f64 = 25.0;

/// How long the last picture stands before the animation starts again, milliseconds.
const LAST_MS: u32 = 600;

/// An animated WebP that grows by one frame at a time, lossy. Of each frame only the rectangle that changed
/// is kept; the file takes its name when it is finished. Frames are shrunk and compressed on all cores.
#[derive(Debug)]
pub struct Preview {
    file: Pending,
    step: u32,
    frame_ms: u32,
    size: Option<[u32; 2]>,
    /// The last frame that was added, once another thread has shrunk it.
    shown: Option<Arc<OnceLock<Shrunk>>>,
    /// What other threads make of the frames, in order.
    coming: VecDeque<Receiver<Result<Option<Patch>, ThreadError>>>,
    /// The picture not yet written, since its duration is known only when the next one comes.
    waiting: Option<(Patch, u32)>,
}

/// A frame as the preview shows it; an error where making it panicked, so that nobody waits for it.
type Shrunk = Result<Raster, ThreadError>;

/// What the threads of this module do, for the error of one that panicked.
const WORK: &str = "compressing the preview";

/// A changed rectangle, encoded.
#[derive(Debug)]
struct Patch {
    corner: [u32; 2],
    size: [u32; 2],
    chunk: Vec<u8>,
}

impl Preview {
    /// Opens a preview of frames that come `fps` times a second.
    pub fn create(path: &Path, fps: f64) -> Result<Preview, ExportError> {
        let step = (fps / FPS).round().max(1.0) as u32;
        let frame_ms = (1000.0 * f64::from(step) / fps.max(1e-3)).round().clamp(1.0, 60_000.0) as u32;
        Ok(Preview { file: Pending::create(path)?, step, frame_ms, size: None, shown: None, coming: VecDeque::new(), waiting: None })
    }

    /// Adds a frame, if it is one of those that are kept. Frames come in order.
    pub fn add(&mut self, frame: &Frame) -> Result<(), ExportError> {
        if !frame.index.is_multiple_of(self.step) {
            return Ok(());
        }
        check(frame.size, 4, frame.rgba8.len())?;
        match self.size {
            None => self.open(frame.size)?,
            Some(expected) if expected != frame.size => {
                return Err(ExportError::Size { path: self.file.path().to_owned(), expected, got: frame.size });
            }
            Some(_) => {}
        }
        while self.coming.len() > 2 * rayon::current_num_threads() {
            self.take()?;
        }
        let (sender, receiver) = channel();
        let (now, size, rgba8) = (Arc::<OnceLock<Shrunk>>::default(), frame.size, frame.rgba8.clone());
        let before = self.shown.replace(now.clone());
        self.coming.push_back(receiver);
        // Threads take these up in order, so the frame before is done or being shrunk when it is waited for.
        detach(move || {
            let now = now.get_or_init(|| caught(WORK, || shrunk(size, &rgba8, fitted(size, WIDTH))));
            drop(rgba8);
            let made = || {
                let before = before.as_ref().map(|before| before.wait().as_ref()).transpose();
                let (before, now) = (before.map_err(ThreadError::clone)?, now.as_ref().map_err(ThreadError::clone)?);
                Ok(patch(before, now))
            };
            // The receiver is gone only when the preview was given up.
            let _ = sender.send(caught(WORK, made).and_then(|made| made));
        });
        Ok(())
    }

    /// Writes the last picture and the sizes, and gives the file its name. Nothing appears where no
    /// frame came.
    pub fn finish(mut self) -> Result<(), ExportError> {
        while !self.coming.is_empty() {
            self.take()?;
        }
        let Some((_, duration_ms)) = &mut self.waiting else { return Ok(()) };
        *duration_ms += LAST_MS;
        self.flush()?;
        self.file.with(|file| {
            let length = file.stream_position()?;
            file.seek(SeekFrom::Start(4))?;
            file.write_all(&u32::try_from(length - 8).unwrap_or(u32::MAX).to_le_bytes())
        })?;
        self.file.finish()
    }

    /// Waits for the oldest frame that other threads work on.
    fn take(&mut self) -> Result<(), ExportError> {
        let patch = self.coming.pop_front().and_then(|coming| coming.recv().ok()).transpose()?.flatten();
        match (patch, &mut self.waiting) {
            (Some(patch), _) => {
                self.flush()?;
                self.waiting = Some((patch, self.frame_ms));
            }
            (None, Some((_, duration_ms))) => *duration_ms += self.frame_ms,
            (None, None) => {}
        }
        Ok(())
    }

    /// RIFF header (its size is written at the end), VP8X with the animation flag, ANIM: background
    /// white, repeated for ever.
    fn open(&mut self, size: [u32; 2]) -> Result<(), ExportError> {
        self.size = Some(size);
        let [width, height] = fitted(size, WIDTH);
        self.file.with(|file| {
            file.write_all(b"RIFF\0\0\0\0WEBPVP8X")?;
            file.write_all(&10u32.to_le_bytes())?;
            file.write_all(&[0x02, 0, 0, 0])?;
            file.write_all(&u24(width - 1))?;
            file.write_all(&u24(height - 1))?;
            file.write_all(b"ANIM")?;
            file.write_all(&6u32.to_le_bytes())?;
            file.write_all(&[255, 255, 255, 255, 0, 0])
        })
    }

    /// Writes the waiting picture as an ANMF chunk that replaces what it covers.
    fn flush(&mut self) -> Result<(), ExportError> {
        let Some((patch, duration_ms)) = self.waiting.take() else { return Ok(()) };
        self.file.with(|file| {
            file.write_all(b"ANMF")?;
            file.write_all(&(16 + patch.chunk.len() as u32).to_le_bytes())?;
            for value in [patch.corner[0] / 2, patch.corner[1] / 2, patch.size[0] - 1, patch.size[1] - 1, duration_ms.min(0xff_ffff)] {
                file.write_all(&u24(value))?;
            }
            const NO_BLENDING: u8 = 0x02;
            file.write_all(&[NO_BLENDING])?;
            file.write_all(&patch.chunk)
        })
    }
}

/// What changed between two pictures, encoded; all of a first one; none where nothing did.
fn patch(before: Option<&Raster>, now: &Raster) -> Option<Patch> {
    let [x, y, width, height] = changed(before, now)?;
    Some(Patch { corner: [x, y], size: [width, height], chunk: encode(now, [x, y, width, height]) })
}

/// The low three bytes, as the container wants its numbers.
fn u24(value: u32) -> [u8; 3] {
    let [a, b, c, _] = value.to_le_bytes();
    [a, b, c]
}

/// The rectangle (x, y, width, height) that differs, its corner on even pixels as the container
/// asks; all of the first picture; none where nothing changed.
fn changed(before: Option<&Raster>, now: &Raster) -> Option<[u32; 4]> {
    let [width, height] = now.size;
    let Some(before) = before else { return Some([0, 0, width, height]) };
    let (mut low, mut high) = ([u32::MAX; 2], [0; 2]);
    for (i, (a, b)) in before.rgba8.as_chunks::<4>().0.iter().zip(now.rgba8.as_chunks::<4>().0).enumerate() {
        if a != b {
            let at = [i as u32 % width, i as u32 / width];
            low = [low[0].min(at[0]), low[1].min(at[1])];
            high = [high[0].max(at[0]), high[1].max(at[1])];
        }
    }
    let corner = low.map(|v| v & !1);
    (low[0] != u32::MAX).then(|| [corner[0], corner[1], high[0] + 1 - corner[0], high[1] + 1 - corner[1]])
}

/// The VP8 chunk of a rectangle, header and padding included.
fn encode(picture: &Raster, [x, y, width, height]: [u32; 4]) -> Vec<u8> {
    let pixels = picture.rgba8.as_chunks::<4>().0;
    let pixel = |px: usize, py: usize| pixels[(y as usize + py) * picture.size[0] as usize + x as usize + px];
    let mut frame = vp8::encode([width as usize, height as usize], pixel);
    let length = frame.len() as u32;
    if length % 2 == 1 {
        frame.push(0);
    }
    [b"VP8 ".as_slice(), &length.to_le_bytes(), &frame].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::AnimationDecoder;
    use image::codecs::webp::WebPDecoder;

    /// A bright square that moves over a shaded ground, still for the last third.
    fn frame(index: u32, size: [u32; 2]) -> Frame {
        let mut picture = Raster::filled(size, [230, 230, 240, 255]);
        for y in 0..size[1] {
            for x in 0..size[0] {
                picture.pixel_mut(x, y).unwrap()[2] = (90 + x / 2 + y) as u8;
            }
        }
        let at = index.min(8) * 7;
        picture.paste(&Raster::filled([20, 20], [200, 30, 40, 255]), at, size[1] / 3 + at / 2);
        Frame { index, time_s: f64::from(index) / 50.0, size, rgba8: picture.rgba8.into(), png: Vec::new().into(), depth: None, id: None }
    }

    fn decoded(path: &Path) -> Vec<(Raster, u32)> {
        let decoder = WebPDecoder::new(std::io::BufReader::new(std::fs::File::open(path).unwrap())).unwrap();
        let frames = decoder.into_frames().collect_frames().unwrap();
        frames
            .into_iter()
            .map(|f| {
                let (ms, _) = f.delay().numer_denom_ms();
                let picture = f.into_buffer();
                (Raster { size: [picture.width(), picture.height()], rgba8: picture.into_raw() }, ms)
            })
            .collect()
    }

    #[test]
    fn plays_what_was_added_every_second_frame_at_fifty_a_second() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("preview.webp");
        let mut preview = Preview::create(&path, 50.0).unwrap();
        (0..13).for_each(|i| preview.add(&frame(i, [160, 90])).unwrap());
        assert!(!path.exists(), "nothing under its name before it is whole");
        preview.finish().unwrap();
        let pictures = decoded(&path);
        // Frames 0, 2, 4, 6, 8; those after 8 look the same and prolong it.
        assert_eq!(pictures.iter().map(|p| p.1).collect::<Vec<_>>(), [40, 40, 40, 40, 3 * 40 + 600]);
        for (k, (picture, _)) in pictures.iter().enumerate() {
            let expected = Raster { size: [160, 90], rgba8: frame(2 * k as u32, [160, 90]).rgba8.to_vec() };
            let found = crate::export::compare(picture, &expected, crate::export::Tolerance::default());
            assert!(found.psnr_db > 36.0, "picture {k}: {}", found.sentence());
        }
    }

    #[test]
    fn large_frames_are_shrunk_and_another_size_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("preview.webp");
        let mut preview = Preview::create(&path, 25.0).unwrap();
        (0..2).for_each(|i| preview.add(&frame(i, [1280, 720])).unwrap());
        let error = preview.add(&frame(2, [640, 360])).unwrap_err().to_string();
        assert!(error.contains("640x360") && error.contains("1280x720"), "{error}");
        preview.finish().unwrap();
        assert!(decoded(&path).iter().all(|(p, _)| p.size == [640, 360]));
    }

    #[test]
    fn nothing_added_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("preview.webp");
        Preview::create(&path, 50.0).unwrap().finish().unwrap();
        drop(Preview::create(&path, 50.0).unwrap());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
