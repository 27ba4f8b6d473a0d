//! A run as one JSON object: what `run`, `undo` and `redo` print with `--json`.

use super::output;
use crate::conversation::{Event, Listener, Outcome};
use serde_json::{Value, json};
use std::path::Path;

/// Keeps what the one JSON object of a run says.
#[derive(Default)]
pub struct Collector {
    stages: Vec<Value>,
    warnings: Vec<String>,
    error: Option<String>,
}

impl Collector {
    /// The object of a run, with the files below `out` where it made a version.
    pub fn object(self, session: &str, outcome: &Outcome, out: &Path) -> Value {
        let (version, exit_code) = (&outcome.version, outcome.exit_code);
        let folder = version.as_ref().map(|name| out.join(name));
        let bytes = folder.as_ref().and_then(|folder| std::fs::read(folder.join("metrics.json")).ok());
        let metrics: Option<Value> = bytes.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        json!({
            "session": session, "version": version, "out": folder, "exit_code": exit_code,
            "plan": { "stages": self.stages }, "metrics": metrics, "warnings": self.warnings, "error": self.error,
        })
    }
}

impl Listener for Collector {
    fn event(&mut self, event: Event) {
        match event {
            Event::PlanReady { stages } => self.stages = stages.iter().filter_map(|s| serde_json::to_value(s).ok()).collect(),
            Event::Warning { text } => self.warnings.push(text),
            Event::TurnFailed { error, .. } => {
                output::error(&error);
                self.error = Some(error);
            }
            _ => {}
        }
    }
}
