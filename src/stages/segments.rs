//! Motion in pieces of a quarter second, each kept under a key of its own.
//!
//! A segment's key knows what the spec says until the segment's end and nothing of later times, so
//! versions that agree until some moment share everything before it: an edit at 1.2 s goes on from
//! the state at the end of the last common segment, and a longer duration appends.

use super::{EngineError, LeftMetrics, keys, pack};
use crate::spec::Spec;
use crate::store::{BlobWriter, Entry, EntryWriter, Store};
use crate::world::measure::Row;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Length of a segment.
const SEGMENT_S: f64 = 0.25;

/// A run of frames that are simulated and kept together.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Segment {
    pub key: String,
    /// First frame that it holds; frame 0 belongs to the first segment.
    pub first: u32,
    /// Last frame that it holds, where its checkpoint stands.
    pub last: u32,
}

/// All segments of a run.
pub(super) fn layout(spec: &Spec, prestress: &str, frames: u32) -> Vec<Segment> {
    let fps = spec.time.fps;
    let length = ((f64::from(fps) * SEGMENT_S).round() as u32).max(1);
    let end = frames.saturating_sub(1);
    let mut segments = Vec::new();
    let mut first = 0;
    loop {
        let last = (first.max(1) - 1 + length).min(end);
        let key = keys::motion(spec, prestress, first..=last, f64::from(last) / f64::from(fps));
        segments.push(Segment { key, first, last });
        if last >= end {
            return segments;
        }
        first = last + 1;
    }
}

/// What a segment says of itself beside its motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct SegmentMeta {
    /// Rows of each frame, one for each object.
    pub rows: Vec<Vec<Row>>,
    /// What the solver did in it.
    pub solver: SolverTotals,
    /// Bytes of one frame of motion; 0 where motion was not kept.
    pub frame_bytes: usize,
}

/// Sums over a stretch of motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct SolverTotals {
    pub substeps: u64,
    pub dt_min_s: f64,
    pub dt_max_s: f64,
    pub retries: u32,
    pub nonfinite: u64,
    pub softened: Vec<String>,
    /// What is to be known of how it starts: that it does not quite balance, that it starts elsewhere than the spec says.
    #[serde(default)]
    pub said: Vec<String>,
    /// How often each force gave no number, by [`keys::force`]: versions that call it otherwise share the segment.
    #[serde(default)]
    pub undefined: BTreeMap<String, u64>,
    /// The speed at which something was held, the fastest that substeps follow; 0 where nothing was.
    #[serde(default)]
    pub held_m_s: f64,
    /// How often particles of an object lost their strain or speed as the last resort, by name.
    #[serde(default)]
    pub mended: BTreeMap<String, u64>,
    /// What of each object flew out of what is followed, by name.
    #[serde(default)]
    pub left: BTreeMap<String, LeftMetrics>,
    /// Whether a rigid body touched more things than are followed.
    #[serde(default)]
    pub unmet: bool,
    /// How often a force was held at the speed that forces end at.
    #[serde(default)]
    pub limited: u64,
    /// Events that waited for an impact, by their number among those, and when it came.
    #[serde(default)]
    pub fired: Vec<(usize, f64)>,
    pub seconds: f64,
}

impl SolverTotals {
    /// Adds a later stretch.
    pub fn add(&mut self, later: &SolverTotals) {
        if later.substeps > 0 {
            self.dt_min_s = if self.substeps == 0 { later.dt_min_s } else { self.dt_min_s.min(later.dt_min_s) };
            self.dt_max_s = self.dt_max_s.max(later.dt_max_s);
        }
        self.substeps += later.substeps;
        self.retries += later.retries;
        self.nonfinite = later.nonfinite.max(self.nonfinite);
        self.seconds += later.seconds;
        self.limited += later.limited;
        self.unmet |= later.unmet;
        self.held_m_s = self.held_m_s.max(later.held_m_s);
        self.fired.extend_from_slice(&later.fired);
        for (name, times) in &later.undefined {
            *self.undefined.entry(name.clone()).or_default() += times;
        }
        for (name, times) in &later.mended {
            *self.mended.entry(name.clone()).or_default() += times;
        }
        for (name, more) in &later.left {
            self.left.entry(name.clone()).or_default().add(more);
        }
        for (ours, theirs) in [(&mut self.softened, &later.softened), (&mut self.said, &later.said)] {
            for text in theirs {
                if !ours.contains(text) {
                    ours.push(text.clone());
                }
            }
        }
    }
}

/// A segment from the store.
pub(super) struct Kept {
    pub meta: SegmentMeta,
    entry: Entry,
}

impl Kept {
    /// Motion of all its frames, one after another, where a frame takes so many bytes; `None` where it was not kept or is
    /// damaged.
    pub fn motion(&self, frame_bytes: usize) -> Result<Option<Vec<u8>>, EngineError> {
        if self.meta.frame_bytes != frame_bytes || frame_bytes == 0 {
            return Ok(None);
        }
        Ok(pack::read(&self.entry, "motion")?.filter(|motion: &Vec<u8>| motion.len() == frame_bytes * self.meta.rows.len()))
    }

    /// The state at its last frame; `None` where it is damaged.
    pub fn checkpoint(&self) -> Result<Option<Vec<u8>>, EngineError> {
        Ok(pack::read(&self.entry, "checkpoint")?)
    }
}

/// Looks a segment up; anything unreadable counts as absent.
pub(super) fn get(store: &Store, segment: &Segment) -> Result<Option<Kept>, EngineError> {
    let Some(entry) = pack::find(store, "motion", &segment.key)? else { return Ok(None) };
    let frames = (segment.last - segment.first + 1) as usize;
    let meta = serde_json::from_value::<SegmentMeta>(entry.meta().clone()).ok().filter(|meta| meta.rows.len() == frames);
    Ok(meta.map(|meta| Kept { meta, entry }))
}

/// Starts to keep a segment, with its motion, frame after frame.
pub(super) fn begin(store: &Store, segment: &Segment) -> Result<(EntryWriter, BlobWriter), EngineError> {
    let entry = store.begin("motion", &segment.key)?;
    let motion = entry.write("motion")?;
    Ok((entry, motion))
}

/// Keeps a finished segment; without motion where none was begun.
pub(super) fn keep(
    store: &Store,
    segment: &Segment,
    begun: Option<(EntryWriter, BlobWriter)>,
    meta: &SegmentMeta,
    checkpoint: &[u8],
) -> Result<(), EngineError> {
    let entry = match begun {
        Some((entry, motion)) => {
            motion.finish()?;
            entry
        }
        None => store.begin("motion", &segment.key)?,
    };
    entry.put("checkpoint", checkpoint)?;
    entry.finish(serde_json::to_value(meta).unwrap_or_default())?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Event, Spec};

    fn keys_of(spec: &Spec, frames: u32) -> Vec<String> {
        layout(spec, "prestress", frames).into_iter().map(|s| s.key).collect()
    }

    fn spec() -> Spec {
        Spec::of_scene("vase.splat")
    }

    #[test]
    fn segments_cover_every_frame_once() {
        for frames in [1, 2, 13, 14, 101, 401] {
            let segments = layout(&spec(), "p", frames);
            assert_eq!(segments[0].first, 0);
            assert_eq!(segments[segments.len() - 1].last, frames - 1);
            assert!(segments.windows(2).all(|w| w[1].first == w[0].last + 1));
        }
    }

    #[test]
    fn an_event_changes_only_segments_that_end_after_it() {
        let before = spec();
        let mut after = before.clone();
        after.events.push(Event { push_m_s: Some([1.0, 0.0, 0.0]), ..Event::at("push", "vase", 1.2) });
        let (a, b) = (keys_of(&before, 101), keys_of(&after, 101));
        let segments = layout(&before, "p", 101);
        for (index, segment) in segments.iter().enumerate() {
            let ends_after = f64::from(segment.last) / 50.0 > 1.2;
            assert_eq!(a[index] != b[index], ends_after, "segment {index} ends at frame {}", segment.last);
        }
    }

    #[test]
    fn a_longer_duration_keeps_every_whole_segment() {
        let (short, long) = (keys_of(&spec(), 101), keys_of(&spec(), 201));
        let shared = short.iter().zip(&long).take_while(|(a, b)| a == b).count();
        assert!(shared >= short.len() - 1);
    }
}
