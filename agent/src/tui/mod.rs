//! The REPL: a transcript, a line to type in, a moving preview. One thread draws, one owns the engine, two read the keyboard
//! and the terminal's signals; they send messages through one channel. It draws when something changed, never else.

mod answer;
mod app;
mod commands;
mod composer;
mod draw;
mod keyboard;
#[cfg(unix)]
mod keys;
mod pane;
mod terminal;
mod theme;
mod transcript;
mod worker;

use crate::cli::exit::Failure;
use crate::conversation::Conversation;
use crate::history::Sessions;
use crate::preview::Reel;
use crate::preview::terminal::Graphics;
use app::{App, Effect, Update};
use keyboard::Input;
use pane::Pane;
use phystalk::Stop;
use std::process::Child;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use terminal::Screen;
use theme::Theme;
use transcript::Voice;

/// Shortest time between two drawings.
const BREATH: Duration = Duration::from_millis(16);

/// How long leaving waits for the engine to come to its next batch.
const FAREWELL: Duration = Duration::from_secs(2);

/// What wakes the thread that draws.
pub enum Message {
    /// A key, a paste, a signal of the terminal.
    Input(Input),
    /// News of the engine's thread.
    Update(Update),
}

/// How the REPL starts.
pub struct Options {
    /// How pictures reach the terminal.
    pub graphics: Graphics,
    /// What is entered first, one line each.
    pub lines: Vec<String>,
    /// Opens the window beside the REPL.
    pub window: Box<dyn Fn() -> Result<Child, Failure>>,
}

/// Runs the REPL until the user leaves.
pub fn run(conversation: Conversation, options: Options) -> Result<(), Failure> {
    let session = conversation.session().name().to_owned();
    let sessions = conversation.session().sessions().clone();
    let scene = conversation.session().spec().scene.file.clone();
    let mut screen = Screen::take(conversation.store().driver_log().ok())?;
    let painter = options.graphics.settle();
    screen.painted_by(painter);
    let reel = Reel::default();
    let mut app = App::new(&session, Pane::new(reel.clone(), painter), Theme::from_environment());
    app.version = conversation.session().head().map(|v| v.name.clone()).unwrap_or_default();
    app.transcript.add(Voice::Agent, &scene);

    let (post, inbox) = channel();
    let brake: worker::Brake = Arc::new(Mutex::new(Stop::default()));
    let (ask, requests) = channel();
    let engine = {
        let (post, reel, brake) = (post.clone(), reel.clone(), brake.clone());
        let serve = move || worker::serve(conversation, &requests, &post, &reel, &brake);
        std::thread::Builder::new().name("engine".into()).spawn(serve)?
    };
    keyboard::listen(&post)?;
    let mut desk = Desk { ask, brake, sessions, session, window: Window { open: options.window, child: None } };
    let mut first = app.open();
    first.extend(options.lines.into_iter().flat_map(|line| app.enter(line, Instant::now())));
    let result = attend(&mut app, &mut screen, &inbox, &mut desk, first);
    drop(screen);
    // The engine ends at its next batch: the stop flag is up, and there is nobody left to ask. It is
    // not waited for long: what it keeps appears whole or not at all.
    desk.stop();
    drop(desk);
    let patience = Instant::now() + FAREWELL;
    while !engine.is_finished() && Instant::now() < patience {
        std::thread::sleep(BREATH);
    }
    result
}

/// What effects act on.
struct Desk {
    ask: Sender<app::Request>,
    brake: worker::Brake,
    sessions: Sessions,
    session: String,
    window: Window,
}

impl Desk {
    fn stop(&self) {
        if let Ok(stop) = self.brake.lock() {
            stop.raise();
        }
    }
}

/// The window beside the REPL, a process of its own that ends with it.
struct Window {
    open: Box<dyn Fn() -> Result<Child, Failure>>,
    child: Option<Child>,
}

impl Window {
    fn show(&mut self) -> Result<&'static str, Failure> {
        if self.child.as_mut().is_some_and(|child| matches!(child.try_wait(), Ok(None))) {
            return Ok("the window is open already");
        }
        self.child = Some((self.open)()?);
        Ok("the window opens beside, and closes with /quit")
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child {
            // It may have been closed long ago.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Takes messages and draws, until the user leaves.
fn attend(app: &mut App, screen: &mut Screen, inbox: &Receiver<Message>, desk: &mut Desk, first: Vec<Effect>) -> Result<(), Failure> {
    let mut leave = act(app, screen, desk, first)?;
    let mut changed = true;
    while !leave {
        if changed {
            screen.terminal.draw(|frame| draw::draw(app, frame))?;
            changed = false;
            std::thread::sleep(BREATH);
        }
        let now = Instant::now();
        let message = match app.pane.due(now) {
            Some(due) => match inbox.recv_timeout(due.saturating_duration_since(now)) {
                Ok(message) => Some(message),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => break,
            },
            None => match inbox.recv() {
                Ok(message) => Some(message),
                Err(_) => break,
            },
        };
        // All that waits is taken before the next drawing: a burst of frames is one drawing.
        for message in message.into_iter().chain(inbox.try_iter()) {
            changed = true;
            let effects = take(app, message);
            leave |= act(app, screen, desk, effects)?;
        }
        changed |= app.pane.advance(Instant::now());
    }
    Ok(())
}

fn take(app: &mut App, message: Message) -> Vec<Effect> {
    let now = Instant::now();
    match message {
        Message::Input(Input::Key(key)) => app.key(key, now),
        Message::Input(Input::Paste { text, lost }) => {
            app.paste(&text, lost);
            Vec::new()
        }
        Message::Input(Input::Resized) => vec![Effect::Redraw],
        Message::Input(Input::Suspend) => vec![Effect::Suspend],
        Message::Input(Input::Resumed) => vec![Effect::Retake, Effect::Redraw],
        Message::Input(Input::Closed) => vec![Effect::Stop, Effect::Quit],
        Message::Update(update) => app.update(update, now),
    }
}

/// Does what the interface asked for; whether to leave.
fn act(app: &mut App, screen: &mut Screen, desk: &mut Desk, effects: Vec<Effect>) -> Result<bool, Failure> {
    for effect in effects {
        match effect {
            Effect::Send(request) => {
                // The engine's thread ends only with the program.
                let _ = desk.ask.send(request);
            }
            Effect::Ask(question) => match answer::answer(&question, &desk.sessions, &desk.session) {
                Ok(text) => app.transcript.add(Voice::Detail, text),
                Err(failure) => app.transcript.add(Voice::Error, failure.message),
            },
            Effect::Stop => desk.stop(),
            Effect::Window => match desk.window.show() {
                Ok(said) => app.transcript.add(Voice::Agent, said),
                Err(failure) => app.transcript.add(Voice::Error, failure.message),
            },
            Effect::Redraw => {
                app.pane.repaint();
                screen.start_over()?;
            }
            Effect::Suspend => screen.suspend(),
            Effect::Retake => screen.retake()?,
            Effect::Quit => return Ok(true),
        }
    }
    Ok(false)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::process::Command;

    #[test]
    fn the_window_is_opened_once_and_ends_with_the_repl() {
        let open = || Ok(Command::new("sleep").arg("60").spawn()?);
        let mut window = Window { open: Box::new(open), child: None };
        assert!(window.show().is_ok_and(|said| said.contains("opens")));
        assert!(window.show().is_ok_and(|said| said.contains("already")));
        let child = window.child.as_ref().map(|child| child.id().to_string()).unwrap_or_default();
        let alive = || Command::new("kill").args(["-0", &child]).output().is_ok_and(|o| o.status.success());
        assert!(alive());
        drop(window);
        assert!(!alive());
    }
}
