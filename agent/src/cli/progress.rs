//! How far a run is, on standard error: one moving line in a terminal, a few plain ones elsewhere.

use super::output;
use crate::conversation::duration;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// Progress of one turn after another.
pub struct Bar {
    quiet: bool,
    bar: Option<ProgressBar>,
    /// The stage shown, and the tenths of it that plain lines told.
    stage: String,
    tenths: u64,
    done: Vec<(String, String, f64)>,
}

impl Bar {
    /// Nothing at all where `quiet`.
    pub fn new(quiet: bool) -> Bar {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let style = ProgressStyle::with_template("  {prefix:8} [{bar:24}] {pos}/{len} {msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr()).with_style(style.progress_chars("=> "))
        });
        Bar { quiet, bar, stage: String::new(), tenths: 0, done: Vec::new() }
    }

    /// A stage begins.
    pub fn stage(&mut self, stage: &str) {
        self.at(stage);
    }

    /// A stage went on.
    pub fn progress(&mut self, stage: &str, done: u64, total: u64, seconds_left: Option<f64>) {
        self.at(stage);
        let left = seconds_left.filter(|s| *s > 0.5).map(|s| format!("{} left", duration(s))).unwrap_or_default();
        if let Some(bar) = &self.bar {
            bar.set_length(total);
            bar.set_position(done);
            bar.set_message(left);
        } else if !self.quiet && total > 0 && done * 4 / total > self.tenths {
            self.tenths = done * 4 / total;
            output::note(format!("  {stage} {done}/{total} {left}").trim_end().to_owned());
        }
    }

    fn at(&mut self, stage: &str) {
        if self.stage != stage {
            self.stage = stage.to_owned();
            self.tenths = 0;
            if let Some(bar) = &self.bar {
                bar.set_prefix(stage.to_owned());
                bar.set_position(0);
            }
        }
    }

    /// A stage is done.
    pub fn completed(&mut self, stage: &str, action: &str, seconds: f64) {
        self.done.push((stage.to_owned(), action.to_owned(), seconds));
    }

    /// Which stages ran and for how long, which came from the store; forgets them.
    pub fn summary(&mut self) -> Option<String> {
        self.clear();
        let done = std::mem::take(&mut self.done);
        let said = done.iter().map(|(stage, action, seconds)| match action.as_str() {
            "hit" => format!("{stage} from the store"),
            "skip" => format!("{stage} skipped"),
            "resume" => format!("{stage} resumed {}", duration(*seconds)),
            _ => format!("{stage} {}", duration(*seconds)),
        });
        let said: Vec<String> = said.collect();
        (!said.is_empty()).then(|| format!("stages: {}", said.join(", ")))
    }

    /// Removes the moving line, so that text can be written.
    pub fn clear(&mut self) {
        self.stage.clear();
        if let Some(bar) = &self.bar {
            bar.set_draw_target(ProgressDrawTarget::stderr());
            bar.suspend(|| {});
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
