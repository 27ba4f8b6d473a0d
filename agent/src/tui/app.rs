//! State of the terminal interface: keys and updates go in, effects come out. It draws nothing, runs
//! nothing and knows no clock but the moments it is given.

use super::commands::{self, Action, COMMANDS, KEYS, Parsed};
use super::composer::{Composer, Typed};
use super::pane::Pane;
use super::theme::Theme;
use super::transcript::{Transcript, Voice};
use crate::conversation::Event;
use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use std::collections::VecDeque;
use std::time::Instant;

/// What the engine's thread is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Show what there is before anything is said.
    Open,
    /// A turn in words.
    Say(String),
    /// A turn of `PATH=VALUE` edits.
    Set(Vec<String>),
    /// Back by so many versions.
    Undo(u32),
    /// Forward by so many.
    Redo(u32),
    /// Show the plan.
    Plan,
    /// Show or change the camera.
    Camera(String),
    /// Write one frame in full size.
    Snap {
        /// Which frame.
        frame: u32,
        /// Where to, if the user said.
        file: Option<String>,
    },
}

/// What can be answered from the store, even while a run goes on.
#[derive(Clone, Debug, PartialEq)]
pub enum Question {
    /// The spec, or one part of it.
    Spec(Option<String>),
    /// All versions.
    Log,
    /// Two versions compared.
    Diff(Option<String>, Option<String>),
}

/// What comes back.
#[derive(Clone, Debug)]
pub enum Update {
    /// Something happened in a turn.
    Event(Box<Event>),
    /// A listing or a sentence.
    Text(Voice, String),
    /// New pictures are in the reel.
    Pictures,
    /// The request is done.
    Finished,
    /// What runs on what, for the status line.
    Device(String),
}

/// What the loop has to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Hand to the engine's thread.
    Send(Request),
    /// Answer from the store.
    Ask(Question),
    /// Raise the run's stop flag.
    Stop,
    /// Open the window.
    Window,
    /// Clear the screen and draw everything again.
    Redraw,
    /// Give the terminal back and stop the process.
    Suspend,
    /// Take the terminal again after a stop.
    Retake,
    /// Leave.
    Quit,
}

/// Where a run is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Running {
    /// Name of the stage.
    pub stage: String,
    /// Units done and in all.
    pub done: (u64, u64),
    /// Seconds left, where there is an estimate.
    pub seconds_left: Option<f64>,
    /// Whether it was asked to stop.
    pub stopping: bool,
}

/// The whole interface.
pub struct App {
    /// What was said.
    pub transcript: Transcript,
    /// What is being typed.
    pub composer: Composer,
    /// The preview.
    pub pane: Pane,
    /// Styles.
    pub theme: Theme,
    /// Session, for the status line.
    pub session: String,
    /// Newest version, empty before the first.
    pub version: String,
    /// Device, once known.
    pub device: String,
    /// The run that goes on, if one does.
    pub running: Option<Running>,
    /// Whether the preview is folded away or out, where the user said.
    pub preview_shown: Option<bool>,
    /// Words not understood, held back until it is known whether the failure repeats them.
    words: Vec<String>,
    queue: VecDeque<String>,
    /// Ctrl+C was the last key: once more leaves.
    interrupted: bool,
}

impl App {
    /// An interface at the start of a session.
    pub fn new(session: &str, pane: Pane, theme: Theme) -> App {
        App {
            transcript: Transcript::default(),
            composer: Composer::default(),
            pane,
            theme,
            session: session.to_owned(),
            version: String::new(),
            device: String::new(),
            running: None,
            preview_shown: None,
            words: Vec::new(),
            queue: VecDeque::new(),
            interrupted: false,
        }
    }

    /// Lines that wait for the run to end.
    pub fn queued(&self) -> usize {
        self.queue.len()
    }

    /// Takes a key.
    pub fn key(&mut self, key: KeyEvent, now: Instant) -> Vec<Effect> {
        if key.kind == KeyEventKind::Release {
            return Vec::new();
        }
        let interrupted = std::mem::take(&mut self.interrupted);
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        let alt = key.modifiers.contains(KeyModifiers::ALT);
        match key.code {
            KeyCode::Char('c') if control => return self.interrupt(interrupted),
            KeyCode::Char('d') if control && self.composer.is_empty() => return vec![Effect::Quit],
            KeyCode::Char('l') if control => return vec![Effect::Redraw],
            KeyCode::Esc => return self.stop(),
            KeyCode::PageUp => self.transcript.scroll_pages(1),
            KeyCode::PageDown => self.transcript.scroll_pages(-1),
            KeyCode::Tab => self.complete(),
            KeyCode::Char('p') if alt => self.play(now),
            KeyCode::Char(',') if alt => self.pane.step(-1),
            KeyCode::Char('.') if alt => self.pane.step(1),
            KeyCode::Char('3') if alt => self.preview_shown = Some(self.preview_shown == Some(false)),
            _ => {
                if let Typed::Sent(line) = self.composer.key(key) {
                    return self.enter(line, now);
                }
            }
        }
        Vec::new()
    }

    /// Takes pasted text, and reports how many bytes of it were lost.
    pub fn paste(&mut self, text: &str, lost: usize) {
        self.interrupted = false;
        self.composer.paste(text);
        if lost > 0 {
            let said = format!("the pasted text was too long: {lost} bytes at its end were dropped; Ctrl+C clears the line");
            self.transcript.add(Voice::Warning, said);
        }
    }

    fn complete(&mut self) {
        let text = self.composer.text();
        if let Some(name) = text.starts_with('/').then(|| commands::complete(&text)).flatten() {
            self.composer.set(&format!("{name} "));
        }
    }

    fn stop(&mut self) -> Vec<Effect> {
        match &mut self.running {
            Some(running) if !running.stopping => {
                running.stopping = true;
                vec![Effect::Stop]
            }
            _ => Vec::new(),
        }
    }

    /// Shows the scene, or what the last version came to.
    pub fn open(&mut self) -> Vec<Effect> {
        self.begin(Request::Open)
    }

    /// Plays or pauses, and says where there is nothing that could play.
    fn play(&mut self, now: Instant) {
        if !self.pane.toggle(now) {
            self.transcript.add(Voice::Error, "nothing moves yet: say what should happen first");
        }
    }

    /// Ctrl+C: stops a run, clears a line, and leaves when pressed again with no other key between.
    fn interrupt(&mut self, again: bool) -> Vec<Effect> {
        if again {
            return vec![Effect::Stop, Effect::Quit];
        }
        self.interrupted = true;
        if self.running.is_some() {
            return self.stop();
        }
        if !self.composer.is_empty() {
            self.composer.set("");
        } else {
            self.transcript.add(Voice::Detail, "Ctrl+C again leaves; everything is kept");
        }
        Vec::new()
    }

    /// Takes one finished line: at once, or into the queue while a run goes on.
    pub fn enter(&mut self, line: String, now: Instant) -> Vec<Effect> {
        let parsed = commands::parse(&line);
        let waits = self.running.is_some() && !matches!(parsed, Parsed::Unknown(..) | Parsed::Command(_, _, true, _));
        if waits {
            self.queue.push_back(line);
            return Vec::new();
        }
        self.transcript.add(Voice::You, &line);
        match parsed {
            Parsed::Words => self.begin(Request::Say(line.clone())),
            Parsed::Unknown(name, Some(near)) => self.say(Voice::Error, format!("there is no {name}; did you mean {near}?")),
            Parsed::Unknown(name, None) => self.say(Voice::Error, format!("there is no {name}; /help lists the commands")),
            Parsed::Command(_, action, _, rest) => self.act(action, rest, now),
        }
    }

    fn say(&mut self, voice: Voice, text: impl AsRef<str>) -> Vec<Effect> {
        self.transcript.add(voice, text);
        Vec::new()
    }

    fn begin(&mut self, request: Request) -> Vec<Effect> {
        let stage = if request == Request::Open { "opening" } else { "understand" };
        self.running = Some(Running { stage: stage.to_owned(), ..Running::default() });
        vec![Effect::Send(request)]
    }

    fn act(&mut self, action: Action, rest: &str, now: Instant) -> Vec<Effect> {
        let words: Vec<&str> = rest.split_whitespace().collect();
        match action {
            Action::Set if words.is_empty() => self.say(Voice::Error, "say which: /set PATH=VALUE, as /set object.vase.material.young_pa=3e4"),
            Action::Set => self.begin(Request::Set(split_settings(rest))),
            Action::Undo | Action::Redo => match words.first().map_or(Ok(1), |w| w.parse::<u32>()) {
                Ok(steps @ 1..) => self.begin(if action == Action::Undo { Request::Undo(steps) } else { Request::Redo(steps) }),
                _ => self.say(Voice::Error, format!("\"{rest}\" is not a number of versions: expected 1 or more")),
            },
            Action::Plan => self.begin(Request::Plan),
            Action::Camera => self.begin(Request::Camera(rest.to_owned())),
            Action::Snap => match self.pane.frame() {
                Some(frame) => self.begin(Request::Snap { frame, file: (!rest.is_empty()).then(|| rest.to_owned()) }),
                None => self.say(Voice::Error, "no frame is shown yet: say what should happen first"),
            },
            Action::Spec => vec![Effect::Ask(Question::Spec(words.first().map(|w| (*w).to_owned())))],
            Action::Log => vec![Effect::Ask(Question::Log)],
            Action::Diff => vec![Effect::Ask(Question::Diff(words.first().map(|w| (*w).to_owned()), words.get(1).map(|w| (*w).to_owned())))],
            Action::Play => {
                self.play(now);
                Vec::new()
            }
            Action::Frame => match rest.parse() {
                Ok(frame) if self.pane.show(frame) => Vec::new(),
                Ok(frame) => {
                    let last = self.pane.caption().map_or_else(|| "there are no frames yet".to_owned(), |c| format!("the last one is {}", c.last));
                    self.say(Voice::Error, format!("there is no frame {frame}: {last}"))
                }
                Err(_) => self.say(Voice::Error, format!("\"{rest}\" is not a frame: expected a whole number, as /frame 25")),
            },
            Action::Window => vec![Effect::Window],
            Action::Help => self.say(Voice::Detail, help()),
            Action::Quit => vec![Effect::Stop, Effect::Quit],
        }
    }

    /// Takes news of the engine's thread; a finished request starts the next line of the queue.
    pub fn update(&mut self, update: Update, now: Instant) -> Vec<Effect> {
        match update {
            Update::Event(event) => self.event(*event),
            Update::Text(voice, text) => self.transcript.add(voice, text),
            Update::Pictures => self.pane.pictures_came(),
            Update::Device(name) => self.device = name,
            Update::Finished => {
                self.running = None;
                self.pane.run_ended(now);
                if let Some(line) = self.queue.pop_front() {
                    return self.enter(line, now);
                }
            }
        }
        Vec::new()
    }

    fn event(&mut self, event: Event) {
        let words = std::mem::take(&mut self.words);
        if !words.is_empty() && !matches!(event, Event::TurnFailed { .. }) {
            self.transcript.add(Voice::Warning, format!("not understood: {}", words.join(", ")));
        }
        match event {
            Event::Message { text } => self.transcript.add(Voice::Agent, text),
            Event::SpecEdited { from, to, changes, .. } => {
                let came = from.map(|f| format!(" <- {f}")).unwrap_or_default();
                self.transcript.add(Voice::Change, format!("{to}{came}"));
                changes.into_iter().for_each(|c| self.transcript.add(Voice::Change, format!("  {c}")));
                self.version = to;
            }
            Event::PlanReady { stages } => self.transcript.add(Voice::Detail, crate::conversation::plan_line(&stages)),
            Event::StageStarted { stage } => {
                if stage == "simulate" || stage == "picture" {
                    self.pane.follow();
                }
                self.at_stage(stage, (0, 0), None);
            }
            Event::StageProgress { stage, done, total, seconds_left } => self.at_stage(stage, (done, total), seconds_left),
            Event::Warning { text } => self.transcript.add(Voice::Warning, text),
            Event::NotUnderstood { words } => self.words = words,
            Event::TurnFailed { error, .. } => self.transcript.add(Voice::Error, error),
            Event::TurnCancelled { .. } => self.transcript.add(Voice::Warning, "stopped; what was done is kept"),
            Event::SessionStarted { .. }
            | Event::TurnStarted { .. }
            | Event::StageCompleted { .. }
            | Event::FrameReady { .. }
            | Event::MetricsReady { .. }
            | Event::Usage { .. }
            | Event::TurnCompleted { .. } => {}
        }
    }

    fn at_stage(&mut self, stage: String, done: (u64, u64), seconds_left: Option<f64>) {
        let stopping = self.running.as_ref().is_some_and(|r| r.stopping);
        self.running = Some(Running { stage, done, seconds_left, stopping });
    }
}

/// `a.b=1 c.d=[0, 0, 1]` to its settings: a blank separates only before the next `PATH=`.
fn split_settings(rest: &str) -> Vec<String> {
    let mut settings: Vec<String> = Vec::new();
    for word in rest.split_whitespace() {
        let starts = word
            .split_once('=')
            .is_some_and(|(path, _)| path.starts_with(|c: char| c.is_ascii_lowercase()) && path.contains(['.', '_']) || path == "seed");
        match settings.last_mut() {
            Some(last) if !starts => {
                last.push(' ');
                last.push_str(word);
            }
            _ => settings.push(word.to_owned()),
        }
    }
    settings
}

fn help() -> String {
    let commands = COMMANDS.iter().map(|c| (format!("{} {}", c.name, c.arguments), c.help));
    let keys = KEYS.iter().map(|(k, h)| ((*k).to_owned(), *h));
    let rows: Vec<(String, &str)> = commands.chain(keys).collect();
    let width = rows.iter().map(|(left, _)| left.chars().count()).max().unwrap_or(0).min(24);
    rows.iter().map(|(left, help)| format!("{:<width$}  {help}", left.trim())).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
#[path = "app_tests.rs"]
mod tests;
