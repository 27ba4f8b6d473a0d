//! Views of a conversation's events for people and for programs.

use super::exit::Failure;
use super::output::{self, Outlet};
use super::progress::Bar;
use crate::conversation::{Event, Lines, Listener, duration, plan_line};
use phystalk::{Frame, Stop};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::Instant;

/// When the process started, as near as it can tell.
pub static STARTED: LazyLock<Instant> = LazyLock::new(Instant::now);

/// Events as lines of text: results on standard output, progress and warnings on standard error.
pub struct Teller {
    quiet: bool,
    outlet: Outlet,
    bar: Bar,
    folder: Option<PathBuf>,
    frames: u32,
    pictured: bool,
    /// Words not understood, held back until it is known whether the failure repeats them.
    words: Vec<String>,
}

impl Teller {
    /// A teller; a failed write raises `stop`.
    pub fn new(quiet: bool, stop: &Stop) -> Teller {
        Teller { quiet, outlet: Outlet::new(stop), bar: Bar::new(quiet), folder: None, frames: 0, pictured: false, words: Vec::new() }
    }

    /// Prints one line of result above the progress.
    pub fn tell(&mut self, text: impl std::fmt::Display) {
        self.bar.clear();
        self.outlet.line(text);
    }

    /// Result of the command whose turns ended with `exit_code`.
    pub fn end(self, exit_code: u8) -> Result<(), Failure> {
        self.outlet.end(exit_code)
    }

    fn aside(&mut self, text: String) {
        if !self.quiet {
            self.tell(text);
        }
    }

    fn warn(&mut self, text: String) {
        self.bar.clear();
        output::note(text);
    }

    fn frame_written(&mut self, path: &Path) {
        self.frames += 1;
        if self.folder.is_none() {
            self.folder = path.parent().and_then(Path::parent).map(Path::to_path_buf);
        }
    }

    fn ended(&mut self) {
        self.bar.clear();
        if let Some(folder) = self.folder.take() {
            let pictures = if self.frames > 0 { format!(" ({} frames, contact.png, preview.webp)", self.frames) } else { String::new() };
            self.tell(format!("  -> {}{pictures}", folder.display()));
        }
        self.frames = 0;
    }
}

impl Listener for Teller {
    fn event(&mut self, event: Event) {
        let words = std::mem::take(&mut self.words);
        if !words.is_empty() && !matches!(event, Event::TurnFailed { .. }) {
            self.warn(format!("not understood: {}", words.join(", ")));
        }
        match event {
            Event::SessionStarted { session, scene, .. } => self.aside(format!("session {session}: {scene}")),
            Event::TurnStarted { text, .. } => self.aside(format!("\n> {text}")),
            Event::Message { text } => self.tell(format!("  {text}")),
            Event::SpecEdited { from, to, changes, .. } => {
                self.tell(format!("{to}{}", from.map(|f| format!(" <- {f}")).unwrap_or_default()));
                changes.into_iter().for_each(|c| self.aside(format!("    {c}")));
            }
            Event::PlanReady { stages } => self.aside(format!("  {}", plan_line(&stages))),
            Event::StageStarted { stage } => self.bar.stage(&stage),
            Event::StageProgress { stage, done, total, seconds_left } => self.bar.progress(&stage, done, total, seconds_left),
            Event::StageCompleted { stage, action, seconds } => self.bar.completed(&stage, &action, seconds),
            Event::FrameReady { path, .. } => self.frame_written(&path),
            Event::MetricsReady { path } => self.folder = path.parent().map(Path::to_path_buf),
            Event::Warning { text } => self.warn(format!("warning: {text}")),
            Event::NotUnderstood { words } => self.words = words,
            Event::Usage { .. } => {}
            Event::TurnCompleted { .. } => {
                let summary = self.bar.summary();
                if let Some(summary) = summary {
                    self.aside(format!("  {summary}"));
                }
                self.ended();
            }
            Event::TurnFailed { error, .. } => {
                self.bar.clear();
                output::error(&error);
                self.ended();
            }
            Event::TurnCancelled { .. } => {
                self.warn("stopped; what was done is kept".to_owned());
                self.ended();
            }
        }
    }

    fn picture(&mut self, _: &Frame) {
        if !std::mem::replace(&mut self.pictured, true) {
            let seconds = STARTED.elapsed().as_secs_f64();
            self.aside(format!("  first picture {} after the start of the program", duration(seconds)));
        }
    }
}

/// Events as JSON Lines on standard output.
pub struct JsonLines {
    lines: Lines,
    outlet: Outlet,
}

impl JsonLines {
    /// A stream that starts at 0; a failed write raises `stop`.
    pub fn new(stop: &Stop) -> JsonLines {
        JsonLines { lines: Lines::default(), outlet: Outlet::new(stop) }
    }

    /// Result of the command whose turns ended with `exit_code`.
    pub fn end(self, exit_code: u8) -> Result<(), Failure> {
        self.outlet.end(exit_code)
    }
}

impl Listener for JsonLines {
    fn event(&mut self, event: Event) {
        self.outlet.json_line(&self.lines.line(event));
    }
}
