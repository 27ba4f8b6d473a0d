//! Segments on their way to the store, on a thread of its own: hashing and the disk hold up nobody.

use super::EngineError;
use super::delivery::Measured;
use super::segments::{self, Segment, SegmentMeta, SolverTotals};
use crate::store::Store;
use crate::world::Checkpoint;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

/// Segments that may wait for the disk before the run waits for it.
const WAITING: usize = 2;

/// A segment that was simulated to its end.
pub(super) struct Simulated {
    pub segment: Segment,
    pub totals: SolverTotals,
    /// Bytes of one frame of motion; 0 where motion is not kept.
    pub frame_bytes: usize,
    /// The state at its end.
    pub checkpoint: Checkpoint,
    /// Its frames.
    pub frames: Vec<Measured>,
}

/// Writes segments in the order they come.
pub(super) struct Keeper {
    // Until it is finished.
    sender: Option<SyncSender<Box<Simulated>>>,
    thread: Option<JoinHandle<Result<(), EngineError>>>,
}

impl Keeper {
    pub fn new(store: &Store) -> Keeper {
        let (sender, incoming) = sync_channel(WAITING);
        let store = store.clone();
        Keeper { sender: Some(sender), thread: Some(std::thread::spawn(move || write(&store, &incoming))) }
    }

    /// Hands a segment over.
    pub fn keep(&mut self, simulated: Box<Simulated>) -> Result<(), EngineError> {
        let sent = self.sender.as_ref().is_some_and(|sender| sender.send(simulated).is_ok());
        // A thread that ended before its time says why.
        if sent { Ok(()) } else { self.join() }
    }

    /// Waits until all is on disk.
    pub fn finish(mut self) -> Result<(), EngineError> {
        self.join()
    }

    fn join(&mut self) -> Result<(), EngineError> {
        self.sender = None;
        // A panic on that thread has already ended the process through the panic hook.
        self.thread.take().map_or(Ok(()), |thread| thread.join().unwrap_or(Ok(())))
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        // A run that failed otherwise still keeps what it had handed over.
        let _ = self.join();
    }
}

fn write(store: &Store, incoming: &Receiver<Box<Simulated>>) -> Result<(), EngineError> {
    for simulated in incoming {
        let Simulated { segment, mut totals, frame_bytes, checkpoint, frames } = *simulated;
        totals.nonfinite = frames.iter().map(|f| f.nonfinite).max().unwrap_or(0);
        let meta = SegmentMeta { rows: frames.iter().map(|f| f.rows.clone()).collect(), solver: totals, frame_bytes };
        segments::keep(store, &segment, &meta, frames.iter().map(|f| f.motion.as_slice()), &checkpoint.bytes()?)?;
    }
    Ok(())
}
