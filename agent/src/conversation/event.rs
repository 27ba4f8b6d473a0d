//! What happens in a turn, as data. JSON Lines, the terminal interface and plain text are views of it.

use phystalk::stages::PlannedStage;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use std::path::PathBuf;

/// One line of `exec --json`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Line {
    /// What happened.
    #[serde(flatten)]
    pub event: Event,
    /// Version of this format: 1.
    pub v: u32,
    /// When, UTC, RFC 3339 with milliseconds.
    pub ts: String,
    /// Counts up from 0 within one stream, without gaps.
    pub seq: u64,
}

/// What happened. Paths are as the user would type them from where the program runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "type")]
pub enum Event {
    /// A session is open.
    #[serde(rename = "session.started")]
    SessionStarted {
        /// Its name in the store.
        session: String,
        /// The store's folder.
        #[serde(serialize_with = "phystalk::spec::file_name::serialize")]
        store: PathBuf,
        /// The scene's file, or `builtin:demo`.
        scene: String,
    },
    /// A turn begins.
    #[serde(rename = "turn.started")]
    TurnStarted {
        /// Counts the turns of this stream from 1.
        turn: u32,
        /// What was said.
        text: String,
    },
    /// A sentence for the user: what was understood, what came out.
    #[serde(rename = "message")]
    Message {
        /// The sentence.
        text: String,
    },
    /// A new version is in the store.
    #[serde(rename = "spec.edited")]
    SpecEdited {
        /// The version before, absent before the first.
        #[serde(skip_serializing_if = "Option::is_none")]
        from: Option<String>,
        /// The new version.
        to: String,
        /// What changed, as edits.
        edits: Vec<Value>,
        /// The same in words, one line a change.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        changes: Vec<String>,
    },
    /// What will run.
    #[serde(rename = "plan.ready")]
    PlanReady {
        /// Always five, in order.
        #[schemars(with = "Vec<Value>")]
        stages: Vec<PlannedStage>,
    },
    /// A stage begins to work.
    #[serde(rename = "stage.started")]
    StageStarted {
        /// Its name.
        stage: String,
    },
    /// A stage went on.
    #[serde(rename = "stage.progress")]
    StageProgress {
        /// Its name.
        stage: String,
        /// Units done.
        done: u64,
        /// Units in all.
        total: u64,
        /// Seconds left of the whole run, where there is an estimate.
        #[serde(skip_serializing_if = "Option::is_none")]
        seconds_left: Option<f64>,
    },
    /// A stage is done.
    #[serde(rename = "stage.completed")]
    StageCompleted {
        /// Its name.
        stage: String,
        /// `run`, `hit`, `resume` or `skip`.
        action: String,
        /// Wall seconds it took.
        seconds: f64,
    },
    /// A picture is on disk.
    #[serde(rename = "frame.ready")]
    FrameReady {
        /// Its file.
        #[serde(serialize_with = "phystalk::spec::file_name::serialize")]
        path: PathBuf,
        /// Frame k shows time k / fps.
        index: u32,
        /// Seconds since t = 0.
        time_s: f64,
    },
    /// The measurements are on disk.
    #[serde(rename = "metrics.ready")]
    MetricsReady {
        /// Their file.
        #[serde(serialize_with = "phystalk::spec::file_name::serialize")]
        path: PathBuf,
    },
    /// Something the user should know.
    #[serde(rename = "warning")]
    Warning {
        /// One sentence.
        text: String,
    },
    /// Words that had no effect.
    #[serde(rename = "not_understood")]
    NotUnderstood {
        /// As they were written.
        words: Vec<String>,
    },
    /// What understanding the turn cost.
    #[serde(rename = "usage")]
    Usage {
        /// Who understood.
        provider: String,
        /// Tokens read.
        input_tokens: u64,
        /// Tokens written.
        output_tokens: u64,
    },
    /// The turn did what it said.
    #[serde(rename = "turn.completed")]
    TurnCompleted {
        /// 0.
        exit_code: u8,
        /// The version it made, where it made one.
        #[serde(skip_serializing_if = "Option::is_none")]
        version: Option<String>,
    },
    /// The turn failed; nothing is lost.
    #[serde(rename = "turn.failed")]
    TurnFailed {
        /// As the program's exit codes.
        exit_code: u8,
        /// The whole message.
        error: String,
    },
    /// The turn was stopped; what was done is kept.
    #[serde(rename = "turn.cancelled")]
    TurnCancelled {
        /// 130, or 143 for a termination.
        exit_code: u8,
        /// The version it made, where it made one.
        #[serde(skip_serializing_if = "Option::is_none")]
        version: Option<String>,
    },
}

/// Numbers and dates events as lines.
#[derive(Debug, Default)]
pub struct Lines {
    next: u64,
}

impl Lines {
    /// The next line.
    pub fn line(&mut self, event: Event) -> Line {
        let seq = self.next;
        self.next += 1;
        Line { event, v: 1, ts: timestamp(std::time::SystemTime::now()), seq }
    }
}

/// RFC 3339 in UTC with milliseconds.
pub fn timestamp(time: std::time::SystemTime) -> String {
    let since = time.duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    let (days, seconds) = (since.as_secs() / 86_400, since.as_secs() % 86_400);
    let (year, month, day) = date(days);
    let (hour, minute, second) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{:03}Z", since.subsec_millis())
}

/// Gregorian date of a day counted from 1970-01-01. Years are counted from March, so that the leap
/// day is the last of its year; 400 years are 146,097 days.
fn date(days_since_1970: u64) -> (u64, u64, u64) {
    let days = days_since_1970 + 719_468; // from 0000-03-01
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    (era * 400 + year_of_era + u64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, UNIX_EPOCH};

    #[test]
    fn dates() {
        assert_eq!(timestamp(UNIX_EPOCH), "1970-01-01T00:00:00.000Z");
        assert_eq!(timestamp(UNIX_EPOCH + Duration::from_millis(951_782_400_123)), "2000-02-29T00:00:00.123Z");
        assert_eq!(timestamp(UNIX_EPOCH + Duration::from_secs(1_795_219_199)), "2026-11-20T23:59:59.000Z");
    }

    #[test]
    fn every_line_has_type_v_ts_and_seq() {
        let mut lines = Lines::default();
        for expected in 0..3u64 {
            let line = serde_json::to_value(lines.line(Event::Message { text: "jumps".into() })).unwrap();
            assert_eq!((line["type"].as_str(), line["v"].as_u64(), line["seq"].as_u64()), (Some("message"), Some(1), Some(expected)));
            assert!(line["ts"].is_string() && line["text"] == "jumps");
        }
    }
}
