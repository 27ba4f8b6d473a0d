//! One turn: understand, apply, keep, plan, run, measure. Nothing else changes a spec.

use super::files::Files;
use super::merging::Change;
use super::observer::Observer;
use super::output_folder::OutputFolder;
use super::{Event, Listener, kept, narrate, rehearse};
use crate::cli::exit::{Failure, Kind};
use crate::history::{Author, HistoryError, Session, Version};
use crate::language::{Reply, VersionRef};
use phystalk::Stop;
use phystalk::gpu::Tier;
use phystalk::spec::{Auto, Camera, Edit, Spec};
use phystalk::stages::{Engine, Metrics, Plan, Report, RunOptions};
use std::collections::BTreeSet;
use std::path::Path;

/// A session that is talked to.
pub struct Conversation {
    pub(super) engine: Engine,
    pub(super) session: Session,
    pub(super) options: RunOptions,
    /// Where files go; none where pictures are only looked at.
    out: Option<OutputFolder>,
    turns: u32,
    asked_for_cpu: bool,
    said_device: bool,
    warned: BTreeSet<String>,
    /// Whether runs tell where their time and memory went.
    pub details: bool,
    /// Whether its session was there before.
    pub resumed: bool,
}

/// How a turn ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// As the process would exit with it.
    pub exit_code: u8,
    /// The version it made.
    pub version: Option<String>,
}

impl Conversation {
    /// Goes on with a session.
    pub fn new(engine: Engine, session: Session, options: RunOptions, out: Option<OutputFolder>, asked_for_cpu: bool) -> Conversation {
        let options = RunOptions { camera: session.camera(), ..options };
        Conversation {
            engine,
            session,
            options,
            out,
            turns: 0,
            asked_for_cpu,
            said_device: false,
            warned: BTreeSet::new(),
            details: false,
            resumed: false,
        }
    }

    /// Its session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The store that it works on.
    pub fn store(&self) -> &phystalk::store::Store {
        self.engine.store()
    }

    /// Announces the session.
    pub fn open(&self, listener: &mut dyn Listener) {
        listener.event(Event::SessionStarted {
            session: self.session.name().to_owned(),
            store: self.engine.store().dir().to_owned(),
            scene: self.session.spec().scene.file.clone(),
        });
        narrate::damage(&self.session).into_iter().for_each(|text| listener.event(Event::Warning { text }));
        if self.session.dropped_torn_line() {
            listener.event(Event::Warning { text: "an operation that was not finished when the program last ended was dropped".to_owned() });
        }
    }

    /// A turn in words.
    pub fn say(&mut self, words: &str, listener: &mut dyn Listener, stop: &Stop) -> Outcome {
        self.begin(words, listener);
        let result = self.understand_and_run(words, listener, stop);
        end(result, listener)
    }

    /// A turn of edits that were given as edits.
    pub fn edit(&mut self, words: &str, edits: Vec<Edit>, listener: &mut dyn Listener, stop: &Stop) -> Outcome {
        self.begin(words, listener);
        let result = self.accept(words, Author::Literal, edits, listener, stop);
        end(result, listener)
    }

    /// A turn that goes back by some versions.
    pub fn undo(&mut self, steps: u32, listener: &mut dyn Listener, stop: &Stop) -> Outcome {
        self.begin("undo", listener);
        let result = self.travel("undo", listener, stop, |session, words| session.undo(words, steps));
        end(result, listener)
    }

    /// A turn that goes forward again.
    pub fn redo(&mut self, steps: u32, listener: &mut dyn Listener, stop: &Stop) -> Outcome {
        self.begin("redo", listener);
        let result = self.travel("redo", listener, stop, |session, words| session.redo(words, steps));
        end(result, listener)
    }

    /// Goes to an older version, or forward again.
    fn travel(
        &mut self,
        words: &str,
        listener: &mut dyn Listener,
        stop: &Stop,
        go: impl FnOnce(&mut Session, &str) -> Result<Version, HistoryError>,
    ) -> Result<Ended, Failure> {
        self.able()?;
        let before = self.session.spec().clone();
        let from = self.head_name();
        match go(&mut self.session, words) {
            Ok(version) => self.made(version, from, &before, listener, stop),
            Err(error) => {
                // Told of the version that another process added, the user may say it again and mean that one.
                self.session.go_on()?;
                Err(error.into())
            }
        }
    }

    /// Makes a version of the spec as it is, without an edit, and runs it.
    pub fn run_base(&mut self, words: &str, listener: &mut dyn Listener, stop: &Stop) -> Outcome {
        self.begin(words, listener);
        let spec = self.session.spec().clone();
        let made = self.able().and_then(|()| Ok(self.session.commit(words, Author::Literal, &[], &spec)?));
        let result = made.and_then(|version| {
            listener.event(Event::SpecEdited { from: None, to: version.name.clone(), edits: Vec::new(), changes: Vec::new() });
            self.run(&version, None, listener, stop)
        });
        end(result, listener)
    }

    /// Writes the files of a version that is there already: no turn, no new version.
    pub fn run_again(&mut self, version: &str, listener: &mut dyn Listener, stop: &Stop) -> Outcome {
        self.begin(&format!("run {version}"), listener);
        let found = self.able().and_then(|()| Ok(self.session.find(version)?.clone()));
        let result = found.and_then(|version| self.run(&version, None, listener, stop));
        end(result, listener)
    }

    /// Shows what there is before anything is said: the newest version's pictures, or the scene as captured. Nothing runs.
    pub fn show(&mut self, listener: &mut dyn Listener, stop: &Stop) -> Result<(), Failure> {
        listener.film(&self.head_name().unwrap_or_else(|| "as captured".to_owned()));
        let spec = self.session.spec().clone();
        Ok(self.engine.look(&spec, Path::new(""), &self.options, &mut Watcher(listener), stop)?)
    }

    /// What the scene holds and where the conversation stands, in sentences.
    pub fn introduce(&mut self) -> Result<Vec<String>, Failure> {
        let facts = self.engine.facts(&self.session.spec().clone(), Path::new(""), &self.options)?;
        let mut said = narrate::scene(&facts);
        said.extend(narrate::damage(&self.session));
        let store = self.store().dir();
        if store.parent() != std::env::current_dir().and_then(std::fs::canonicalize).ok().as_deref() {
            said.push(format!("versions are kept in the store {}, session {}", store.display(), self.session.name()));
        }
        if let Some(head) = self.session.head() {
            let words = if head.note.is_empty() { &head.words } else { &head.note };
            said.push(format!("session {} goes on after {}: {words}", self.session.name(), head.name));
        }
        Ok(said)
    }

    /// What would run now.
    pub fn plan(&mut self) -> Result<Plan, Failure> {
        Ok(self.engine.plan(&self.session.spec().clone(), Path::new(""), &self.options, None)?)
    }

    /// The camera that the current version resolves to.
    pub fn camera(&mut self) -> Result<Camera, Failure> {
        Ok(self.engine.facts(&self.session.spec().clone(), Path::new(""), &self.options)?.camera)
    }

    /// Delivers one frame of the current version in full size, out of the store where it is there.
    pub fn frame(&mut self, index: u32, stop: &Stop) -> Result<Option<phystalk::Frame>, Failure> {
        let mut catcher = Catcher { index, frame: None };
        let spec = self.session.spec().clone();
        self.engine.run(&spec, Path::new(""), &self.options, None, &mut catcher, stop)?;
        Ok(catcher.frame)
    }

    /// The device's name, once it is open.
    pub fn device_name(&mut self) -> Result<String, Failure> {
        Ok(self.engine.device()?.name().to_owned())
    }

    fn begin(&mut self, words: &str, listener: &mut dyn Listener) {
        self.turns += 1;
        listener.event(Event::TurnStarted { turn: self.turns, text: words.to_owned() });
    }

    fn head_name(&self) -> Option<String> {
        self.session.head().map(|v| v.name.clone())
    }

    fn understand_and_run(&mut self, words: &str, listener: &mut dyn Listener, stop: &Stop) -> Result<Ended, Failure> {
        let spec = self.session.spec().clone();
        // The spec that the newest version was made from.
        let previous = self.session.head().and_then(|head| self.session.spec_before(head)).cloned();
        let reply = rehearse::hear(&mut self.engine, &self.options, &spec, previous.as_ref(), words)?;
        listener.event(Event::Usage { provider: "phrasebook".to_owned(), input_tokens: 0, output_tokens: 0 });
        match reply {
            Reply::Edits { edits, gloss, not_understood } => {
                gloss.into_iter().for_each(|text| listener.event(Event::Message { text }));
                say_not_understood(not_understood, listener);
                self.accept(words, Author::Phrasebook, edits, listener, stop).map_err(as_refusal)
            }
            Reply::Undo(steps) => self.travel(words, listener, stop, |session, words| session.undo(words, steps)),
            Reply::Redo(steps) => self.travel(words, listener, stop, |session, words| session.redo(words, steps)),
            Reply::BackTo(reference) => self.travel(words, listener, stop, |session, words| session.back_to(words, &version_name(reference))),
            Reply::Compare(from, to) => self.compare(from, to, listener),
            Reply::Refused { reason, not_understood } => {
                say_not_understood(not_understood, listener);
                Err(Failure::other(reason))
            }
        }
    }

    /// Applies edits, keeps the version, runs it. Edits that change nothing make no version, but the
    /// first turn of a session shows the scene as it is.
    fn accept(&mut self, words: &str, author: Author, edits: Vec<Edit>, listener: &mut dyn Listener, stop: &Stop) -> Result<Ended, Failure> {
        let before = self.session.spec().clone();
        let mut notes = Vec::new();
        let after = before.apply_noted(&edits, &mut notes)?;
        notes.into_iter().for_each(|text| listener.event(Event::Warning { text }));
        let from = self.head_name();
        if from.is_some() && before.diff(&after).is_empty() {
            listener.event(Event::Message { text: "nothing to change: it is so already".to_owned() });
            return Ok(Ended::Completed(None));
        }
        self.able()?;
        let longer = rehearse::longer(&mut self.engine, &self.options, &before, &after);
        let said = kept::said(&before, &after, &edits).into_iter().chain(longer);
        said.for_each(|text| listener.event(Event::Message { text }));
        let version = self.commit(&Change { words, author, edits: &edits, after: &after }, listener)?;
        let before = self.session.spec_before(&version).cloned().unwrap_or(before);
        let from = version.parent.clone();
        self.made(version, from, &before, listener, stop)
    }

    /// What two versions differ in.
    fn compare(&self, from: VersionRef, to: VersionRef, listener: &mut dyn Listener) -> Result<Ended, Failure> {
        let [from, to] = [from, to].map(|reference| self.session.find(&version_name(reference)));
        let (from, to) = (from?, to?);
        let lines: Vec<String> = from.spec.diff(&to.spec).iter().map(ToString::to_string).collect();
        let text = if lines.is_empty() {
            format!("{} and {} are the same", from.name, to.name)
        } else {
            format!("from {} ({}) to {} ({}):", from.name, from.words, to.name, to.words)
        };
        std::iter::once(text).chain(lines).for_each(|text| listener.event(Event::Message { text }));
        Ok(Ended::Completed(None))
    }

    /// Whether a version could be run: there is a device and a folder for its files. Asked before it
    /// is made, so that none is made in vain.
    fn able(&mut self) -> Result<(), Failure> {
        self.engine.device()?;
        match &self.out {
            Some(out) => out.claim(),
            None => Ok(()),
        }
    }

    /// Announces a version that is in the store, and runs it.
    fn made(&mut self, version: Version, from: Option<String>, before: &Spec, listener: &mut dyn Listener, stop: &Stop) -> Result<Ended, Failure> {
        let edits = version.edits.iter().filter_map(|e| serde_json::to_value(e).ok()).collect();
        let mut changes: Vec<String> = before.diff(self.session.spec()).iter().map(ToString::to_string).collect();
        if !version.note.is_empty() {
            changes.insert(0, version.note.clone());
        }
        let previous = from.is_some().then_some(before);
        listener.event(Event::SpecEdited { from, to: version.name.clone(), edits, changes });
        self.run(&version, previous, listener, stop)
    }

    fn run(&mut self, version: &Version, previous: Option<&Spec>, listener: &mut dyn Listener, stop: &Stop) -> Result<Ended, Failure> {
        let spec = version.spec.clone();
        let plan = self.engine.plan(&spec, Path::new(""), &self.options, previous)?;
        self.say_device(listener)?;
        listener.event(Event::PlanReady { stages: plan.stages.clone() });
        let mut files = match &self.out {
            Some(out) => Some(Files::create(&out.version(&version.name), spec.time.fps)?),
            None => None,
        };
        if let Some(files) = &files {
            spec.write(&files.path("spec.toml"))?;
            files.json("plan.json", &plan)?;
        }
        listener.film(&version.name);
        let mut observer = Observer::new(listener, files.as_mut(), &plan.stages, &mut self.warned);
        let report = self.engine.run(&spec, Path::new(""), &self.options, previous, &mut observer, stop);
        let report = match (report, files) {
            (Ok(report), files) => {
                let mut metrics = report.metrics.clone();
                metrics.version.clone_from(&version.name);
                self.finish_files(files, &report.plan, &metrics, listener)?;
                Report { metrics, ..report }
            }
            (Err(error), files) => {
                // What was drawn until then stays, contact sheet included.
                files.map(Files::finish).transpose()?;
                return Err(error.into());
            }
        };
        for stage in &report.plan.stages {
            listener.event(Event::StageCompleted {
                stage: stage.stage.as_str().to_owned(),
                action: serde_json::to_value(stage.action).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default(),
                seconds: stage.seconds.unwrap_or(0.0),
            });
        }
        self.keep_camera(&report)?;
        if report.stopped {
            return Ok(Ended::Cancelled(version.name.clone()));
        }
        // Kept of a version that ran to its end: that is how the others are told.
        let results = report.results.iter().map(|(stage, key)| format!("{stage}/{key}")).collect();
        self.session.keep_resolved(&version.name, serde_json::Value::Object(report.metrics.resolved.clone()), results)?;
        let details = if self.details { narrate::details(&report.metrics) } else { Vec::new() };
        narrate::outcome(&report.metrics, &spec).into_iter().chain(details).for_each(|text| listener.event(Event::Message { text }));
        judge(&report.metrics, &version.name)
    }

    fn finish_files(&self, files: Option<Files>, plan: &Plan, metrics: &Metrics, listener: &mut dyn Listener) -> Result<(), Failure> {
        let Some(files) = files else { return Ok(()) };
        files.json("plan.json", plan)?;
        let path = files.json("metrics.json", metrics)?;
        for w in files.finish()? {
            listener.event(Event::FrameReady { path: w.path, index: w.index, time_s: w.time_s });
        }
        listener.event(Event::MetricsReady { path });
        Ok(())
    }

    /// The first camera that placed itself is the session's, so that versions compare.
    fn keep_camera(&mut self, report: &Report) -> Result<(), Failure> {
        if self.options.camera.is_none() && self.session.spec().camera == Auto::Auto {
            self.session.keep_camera(&report.camera)?;
            self.options.camera = Some(report.camera);
        }
        Ok(())
    }

    /// Says once where it runs, if that is not a GPU and nobody asked for that.
    fn say_device(&mut self, listener: &mut dyn Listener) -> Result<(), Failure> {
        let gpu = self.engine.device()?;
        if gpu.tier == Tier::Cpu && !self.asked_for_cpu && !self.said_device {
            let quality = if self.options.quality.is_none() { ", at draft quality" } else { "" };
            listener.event(Event::Warning { text: format!("no GPU was found: running on the CPU ({}){quality}", gpu.name()) });
        }
        self.said_device = true;
        Ok(())
    }
}

fn version_name(reference: VersionRef) -> String {
    match reference {
        VersionRef::First => "first".to_owned(),
        VersionRef::Number(number) => format!("v{number}"),
        VersionRef::Last => "last".to_owned(),
        VersionRef::Previous => "previous".to_owned(),
    }
}

/// How a turn that did not fail ended.
enum Ended {
    Completed(Option<String>),
    Cancelled(String),
    /// It ran, and an expectation did not hold.
    Unmet(String, String),
}

/// The one terminal event of a turn.
fn end(result: Result<Ended, Failure>, listener: &mut dyn Listener) -> Outcome {
    match result {
        Ok(Ended::Completed(version)) => {
            listener.event(Event::TurnCompleted { exit_code: 0, version: version.clone() });
            Outcome { exit_code: 0, version }
        }
        Ok(Ended::Cancelled(version)) => {
            let exit_code = crate::cli::signals::received().unwrap_or(Kind::Interrupted).code();
            listener.event(Event::TurnCancelled { exit_code, version: Some(version.clone()) });
            Outcome { exit_code, version: Some(version) }
        }
        Ok(Ended::Unmet(version, error)) => {
            let exit_code = Kind::Expectation.code();
            listener.event(Event::TurnFailed { exit_code, error });
            Outcome { exit_code, version: Some(version) }
        }
        Err(failure) => {
            let exit_code = failure.kind.code();
            listener.event(Event::TurnFailed { exit_code, error: failure.message });
            Outcome { exit_code, version: None }
        }
    }
}

fn judge(metrics: &Metrics, version: &str) -> Result<Ended, Failure> {
    let unmet = metrics.expect.iter().filter(|e| !e.held);
    let lines: Vec<String> = unmet
        .map(|e| match e.value {
            Some(value) => format!("expected {}, measured {value:.4}", e.text),
            None => format!("expected {}, and it was never so", e.text),
        })
        .collect();
    if lines.is_empty() { Ok(Ended::Completed(Some(version.to_owned()))) } else { Ok(Ended::Unmet(version.to_owned(), lines.join("\n"))) }
}

fn say_not_understood(words: Vec<String>, listener: &mut dyn Listener) {
    if !words.is_empty() {
        listener.event(Event::NotUnderstood { words });
    }
}

/// Words that led to an edit which the schema refuses are a refused turn, not a wrong spec.
fn as_refusal(failure: Failure) -> Failure {
    match failure.kind {
        Kind::Spec => Failure::other(failure.message),
        _ => failure,
    }
}

/// Passes pictures on.
struct Watcher<'a>(&'a mut dyn Listener);

impl phystalk::Sink for Watcher<'_> {
    fn progress(&mut self, _: phystalk::Progress) {}
    fn frame(&mut self, frame: phystalk::Frame) {
        self.0.picture(&frame);
    }
    fn warning(&mut self, _: &str) {}
}

/// Keeps one frame of a run.
struct Catcher {
    index: u32,
    frame: Option<phystalk::Frame>,
}

impl phystalk::Sink for Catcher {
    fn progress(&mut self, _: phystalk::Progress) {}
    fn frame(&mut self, frame: phystalk::Frame) {
        if frame.index == self.index {
            self.frame = Some(frame);
        }
    }
    fn warning(&mut self, _: &str) {}
}
