//! Between the engine and whoever listens: the engine's calls become events, its frames files.

use super::files::Files;
use super::{Event, Listener};
use phystalk::stages::{Action, PlannedStage};
use phystalk::{Frame, Progress, Sink};
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// Shortest time between two progress events of one stage.
const PROGRESS: Duration = Duration::from_millis(50);

/// The sink of one run.
pub struct Observer<'a> {
    listener: &'a mut dyn Listener,
    files: Option<&'a mut Files>,
    /// Stages that will work, in order, and how many of them were announced.
    stages: Vec<&'static str>,
    announced: usize,
    said: Option<Instant>,
    /// Warnings that this conversation has heard: each is said once.
    warned: &'a mut BTreeSet<String>,
}

impl<'a> Observer<'a> {
    /// A sink that writes frames where there are files to write.
    pub fn new(
        listener: &'a mut dyn Listener,
        files: Option<&'a mut Files>,
        plan: &[PlannedStage],
        warned: &'a mut BTreeSet<String>,
    ) -> Observer<'a> {
        let works = plan.iter().filter(|s| matches!(s.action, Action::Run | Action::Resume)).map(|s| s.stage.as_str());
        let mut observer = Observer { listener, files, stages: works.collect(), announced: 0, said: None, warned };
        observer.announce_until(0);
        observer
    }

    /// Announces the stages up to and with `index`.
    fn announce_until(&mut self, index: usize) {
        while self.announced <= index && self.announced < self.stages.len() {
            self.listener.event(Event::StageStarted { stage: self.stages[self.announced].to_owned() });
            self.announced += 1;
        }
    }

    fn report_written(&mut self) {
        let written = self.files.as_ref().map(|f| f.written()).unwrap_or_default();
        for w in written {
            self.listener.event(Event::FrameReady { path: w.path, index: w.index, time_s: w.time_s });
        }
    }
}

impl Sink for Observer<'_> {
    fn progress(&mut self, progress: Progress) {
        if let Some(index) = self.stages.iter().position(|s| *s == progress.stage) {
            self.announce_until(index);
        }
        let now = Instant::now();
        let ends = progress.done >= progress.total;
        if ends || self.said.is_none_or(|said| now.duration_since(said) >= PROGRESS) {
            self.said = Some(now);
            let Progress { stage, done, total, seconds_left } = progress;
            self.listener.event(Event::StageProgress { stage: stage.to_owned(), done, total, seconds_left });
        }
        self.report_written();
    }

    fn frame(&mut self, frame: Frame) {
        self.announce_until(self.stages.len());
        self.listener.picture(&frame);
        if let Some(files) = &mut self.files {
            files.frame(frame);
        }
        self.report_written();
    }

    fn note(&mut self, text: &str) {
        if self.warned.insert(text.to_owned()) {
            self.listener.event(Event::Message { text: text.to_owned() });
        }
    }

    fn warning(&mut self, text: &str) {
        if self.warned.insert(text.to_owned()) {
            self.listener.event(Event::Warning { text: text.to_owned() });
        }
    }
}
