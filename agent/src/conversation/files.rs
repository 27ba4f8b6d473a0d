//! What a version leaves under `--out`: its spec, frames, plan, measurements, contact sheet, preview.

use phystalk::Frame;
use phystalk::export::{ContactSheet, ExportError, Preview, read_png, write_atomic};
use phystalk::threads::{Task, caught};
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::ScopedJoinHandle;

/// Frames that may wait for the disk before the run waits for it.
const WAITING: usize = 8;

/// The folder of one version, while it is written.
///
/// Frames go through two threads, one for the files and one for the preview's compression, so that
/// neither holds up the device. A frame that cannot be written ends the writing, not the run.
pub struct Files {
    folder: PathBuf,
    fps: u32,
    to_disk: Option<SyncSender<Frame>>,
    written: Receiver<Written>,
    disk: Writing,
    film: Writing,
}

/// A thread that writes; a panic on it is an error of the run.
type Writing = Option<Task<Result<(), ExportError>>>;

/// A frame that is on disk.
#[derive(Clone, Debug)]
pub struct Written {
    /// Its file.
    pub path: PathBuf,
    /// Its index.
    pub index: u32,
    /// Its time.
    pub time_s: f64,
}

impl Files {
    /// Makes `folder`, removes frames of an earlier run from it, and starts the writing threads.
    pub fn create(folder: &Path, fps: u32) -> Result<Files, ExportError> {
        let frames = folder.join("frames");
        for index in 0.. {
            if std::fs::remove_file(frame_path(&frames, index)).is_err() {
                break;
            }
        }
        for name in ["contact.png", "preview.webp", "metrics.json"] {
            let _ = std::fs::remove_file(folder.join(name));
        }
        let preview = Preview::create(&folder.join("preview.webp"), f64::from(fps))?;
        let (to_film, film_frames) = sync_channel::<Frame>(WAITING);
        let film = Task::spawn("writing the preview", move || compress(preview, &film_frames))?;
        let (to_disk, disk_frames) = sync_channel::<Frame>(WAITING);
        let (done, written) = channel();
        let disk = Task::spawn("writing frames", move || store(&frames, &disk_frames, &to_film, &done))?;
        Ok(Files { folder: folder.to_owned(), fps, to_disk: Some(to_disk), written, disk: Some(disk), film: Some(film) })
    }

    /// Hands a frame to the writers.
    pub fn frame(&mut self, frame: Frame) {
        // A writer that failed is gone; its error comes out of `finish`.
        if let Some(sender) = &self.to_disk {
            let _ = sender.send(frame);
        }
    }

    /// Frames that reached the disk since the last call.
    pub fn written(&self) -> Vec<Written> {
        self.written.try_iter().collect()
    }

    /// Writes one JSON file; its path.
    pub fn json(&self, name: &str, value: &impl Serialize) -> Result<PathBuf, ExportError> {
        let path = self.folder.join(name);
        write_atomic(&path, |file| {
            serde_json::to_writer_pretty(&mut *file, value)?;
            file.write_all(b"\n")
        })?;
        Ok(path)
    }

    /// Path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Waits for the writers, then makes the contact sheet; frames that were still on their way.
    pub fn finish(mut self) -> Result<Vec<Written>, ExportError> {
        drop(self.to_disk.take());
        join(self.disk.take())?;
        tracing::debug!("frames on disk");
        let last: Vec<Written> = self.written.try_iter().collect();
        sheet(&self.folder, self.fps)?;
        tracing::debug!("contact sheet on disk");
        join(self.film.take())?;
        tracing::debug!("preview on disk");
        Ok(last)
    }
}

fn join(thread: Writing) -> Result<(), ExportError> {
    thread.map_or(Ok(()), |thread| thread.join()?)
}

fn frame_path(frames: &Path, index: u32) -> PathBuf {
    frames.join(format!("{index:04}.png"))
}

/// Writes frames as they come and passes them on to the preview.
fn store(frames: &Path, incoming: &Receiver<Frame>, film: &SyncSender<Frame>, done: &Sender<Written>) -> Result<(), ExportError> {
    for frame in incoming {
        let path = frame_path(frames, frame.index);
        write_atomic(&path, |file| file.write_all(&frame.png))?;
        let _ = done.send(Written { path, index: frame.index, time_s: frame.time_s });
        let _ = film.send(frame);
    }
    Ok(())
}

fn compress(mut preview: Preview, incoming: &Receiver<Frame>) -> Result<(), ExportError> {
    for frame in incoming {
        preview.add(&frame)?;
    }
    preview.finish()
}

/// The contact sheet of the frames that are there, read back side by side.
fn sheet(folder: &Path, fps: u32) -> Result<(), ExportError> {
    let frames = folder.join("frames");
    let total = (0..).take_while(|&i| frame_path(&frames, i).exists()).count() as u32;
    let mut sheet = ContactSheet::new(total);
    let wanted: Vec<u32> = (0..total).filter(|&i| sheet.wants(i)).collect();
    let read = |index: u32| {
        let raster = read_png(&frame_path(&frames, index))?;
        let (time_s, rgba8) = (f64::from(index) / f64::from(fps.max(1)), raster.rgba8.into());
        Ok(ContactSheet::tile(&Frame { index, time_s, size: raster.size, rgba8, png: Vec::new().into(), depth: None, id: None }))
    };
    let tiles: Vec<Result<_, ExportError>> = std::thread::scope(|scope| {
        let spawn = |index| std::thread::Builder::new().spawn_scoped(scope, move || caught("reading frames", || read(index)));
        let readers: Vec<_> = wanted.iter().map(|&index| (index, spawn(index).ok())).collect();
        let mut tiles = Vec::new();
        for (index, reader) in readers {
            tiles.push(match reader.map(ScopedJoinHandle::join) {
                Some(Ok(read)) => read.map_err(ExportError::from).and_then(|tile| tile),
                // Where no thread is to be had, this one reads.
                _ => read(index),
            });
        }
        tiles
    });
    sheet.extend(tiles.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten());
    sheet.finish(&folder.join("contact.png"))
}
