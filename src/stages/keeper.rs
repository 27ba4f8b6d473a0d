//! What a run makes on its way to the store, on a thread of its own: hashing and the disk hold up nobody.

use super::EngineError;
use super::segments::{self, Segment, SegmentMeta};
use crate::store::{BlobWriter, EntryWriter, Store, StoreError};
use crate::threads::Task;
use crate::world::Checkpoint;
use std::io::Write;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Frames that may wait for the disk before the run waits for it.
const WAITING: usize = 16;

/// Something to be kept.
pub(super) enum Item {
    /// The state that a scene stands in, under its key, and what is to be said of it.
    Standing(String, Checkpoint, Vec<String>),
    /// One frame of the motion of a segment.
    Motion(Arc<Segment>, Vec<u8>),
    /// The end of a segment: the state there, and what it says of itself.
    End(Arc<Segment>, Box<SegmentMeta>, Checkpoint),
    /// The PNG of the next picture.
    Picture(Arc<[u8]>),
    /// All pictures came.
    Whole,
}

/// Writes things in the order they come.
pub(super) struct Keeper {
    // Until it is finished.
    sender: Option<SyncSender<Item>>,
    thread: Writing,
}

impl Keeper {
    /// Pictures go into `album`, where there is one.
    pub fn new(store: &Store, album: Option<Album>) -> Result<Keeper, EngineError> {
        let store = store.clone();
        Keeper::with(move |incoming| write(&store, album, &incoming))
    }

    fn with(write: impl FnOnce(Receiver<Item>) -> Result<(), EngineError> + Send + 'static) -> Result<Keeper, EngineError> {
        let (sender, incoming) = sync_channel(WAITING);
        Ok(Keeper { sender: Some(sender), thread: Some(Task::spawn(WORK, move || write(incoming))?) })
    }

    /// Hands something over.
    pub fn keep(&mut self, item: Item) -> Result<(), EngineError> {
        let sent = self.sender.as_ref().is_some_and(|sender| sender.send(item).is_ok());
        // A thread that ended before its time says why.
        if sent { Ok(()) } else { self.join() }
    }

    /// Waits until all is on disk.
    pub fn finish(mut self) -> Result<(), EngineError> {
        self.join()
    }

    fn join(&mut self) -> Result<(), EngineError> {
        self.sender = None;
        ended(self.thread.take())
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        // A run that failed otherwise still keeps what it had handed over.
        let _ = self.join();
    }
}

/// Something on its way to the disk.
type Writing = Option<Task<Result<(), EngineError>>>;

/// What the threads of this module do, for the error of one that panicked.
const WORK: &str = "writing to the store";

fn write(store: &Store, album: Option<Album>, incoming: &Receiver<Item>) -> Result<(), EngineError> {
    let mut ending: Writing = None;
    let written = write_all(store, album, incoming, &mut ending);
    written.and(ended(ending))
}

/// Writes what comes. A segment that ended goes to the disk while the next one is written.
fn write_all(store: &Store, mut album: Option<Album>, incoming: &Receiver<Item>, ending: &mut Writing) -> Result<(), EngineError> {
    // The motion of the segment that has not ended.
    let mut open: Option<(EntryWriter, BlobWriter)> = None;
    for item in incoming {
        match item {
            Item::Standing(key, state, said) => {
                let entry = store.begin("prestress", &key)?;
                entry.put("state", &state.bytes()?)?;
                entry.finish(serde_json::json!({ "said": said }))?;
            }
            Item::Motion(segment, frame) => {
                let (_, blob) = match &mut open {
                    Some(open) => open,
                    none => none.insert(segments::begin(store, &segment)?),
                };
                append(store, blob, &frame)?;
            }
            Item::End(segment, meta, state) => {
                ended(ending.take())?;
                let (store, begun) = (store.clone(), open.take());
                *ending = Some(Task::spawn(WORK, move || segments::keep(&store, &segment, begun, &meta, &state.bytes()?))?);
            }
            Item::Picture(png) => album.as_mut().map_or(Ok(()), |album| album.add(&png))?,
            Item::Whole => album.take().map_or(Ok(()), Album::finish)?,
        }
    }
    Ok(())
}

/// Waits for a thread that writes.
fn ended(thread: Writing) -> Result<(), EngineError> {
    thread.map_or(Ok(()), |thread| thread.join()?)
}

fn append(store: &Store, blob: &mut BlobWriter, bytes: &[u8]) -> Result<(), EngineError> {
    Ok(blob.write_all(bytes).map_err(|source| StoreError::Io { doing: "written", path: store.dir().to_owned(), source })?)
}

/// The pictures of a run on their way into the store: one blob, and where each ends in it. Dropped before it is
/// finished, it leaves nothing.
pub(super) struct Album {
    store: Store,
    entry: EntryWriter,
    blob: BlobWriter,
    ends: Vec<u64>,
    fps: u32,
}

impl Album {
    pub fn begin(store: &Store, key: &str, fps: u32) -> Result<Album, EngineError> {
        let entry = store.begin("picture", key)?;
        Ok(Album { blob: entry.write("frames")?, entry, store: store.clone(), ends: Vec::new(), fps })
    }

    fn add(&mut self, png: &[u8]) -> Result<(), EngineError> {
        append(&self.store, &mut self.blob, png)?;
        self.ends.push(self.blob.bytes());
        Ok(())
    }

    fn finish(self) -> Result<(), EngineError> {
        self.blob.finish()?;
        self.entry.finish(serde_json::json!({ "ends": self.ends, "fps": self.fps }))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_writer_that_panics_is_an_error_of_the_run() {
        let mut keeper = Keeper::with(|incoming| incoming.recv().map_or(Ok(()), |_| panic!("a bad entry"))).unwrap();
        let given = (0..100).find_map(|_| keeper.keep(Item::Whole).err());
        let error = given.or_else(|| keeper.finish().err()).unwrap();
        assert!(matches!(&error, EngineError::Thread(_)) && error.to_string().contains("a bad entry"), "{error}");
    }
}
