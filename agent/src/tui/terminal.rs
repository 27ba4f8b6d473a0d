//! The screen: taken at the start and after a stop, given back at the end, before a stop, after a crash and on signals.

use crate::cli::crash;
use crate::preview::terminal::{Painter, forget_pictures};
use crossterm::event::{DisableBracketedPaste, EnableBracketedPaste};
use crossterm::terminal::{EnterAlternateScreen, LeaveAlternateScreen};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use std::fs::File;
use std::io::{self, Stdout, Write};

/// The screen while it is ours.
pub struct Screen {
    /// What to draw on.
    pub terminal: Terminal<CrosstermBackend<Stdout>>,
    painter: Option<Painter>,
    errors: Option<Errors>,
}

/// Where standard error went meanwhile.
struct Errors {
    #[cfg(unix)]
    before: std::os::fd::OwnedFd,
}

impl Screen {
    /// Takes the screen: raw keys, the alternate screen, no mouse. What drivers write to standard
    /// error goes to `log` meanwhile, where there is one.
    pub fn take(log: Option<File>) -> io::Result<Screen> {
        crash::on_crash(|| give_back(None));
        set_modes()?;
        let errors = log.and_then(|file| redirect_errors(&file).ok());
        Ok(Screen { terminal: Terminal::new(CrosstermBackend::new(io::stdout()))?, painter: None, errors })
    }

    /// Gives the terminal back and stops the process, as SIGTSTP does by default.
    #[cfg(unix)]
    pub fn suspend(&mut self) {
        give_back(self.painter);
        // It fails for unknown signals only.
        let _ = signal_hook::low_level::emulate_default_handler(signal_hook::consts::SIGTSTP);
    }

    /// Nothing asks for it here.
    #[cfg(not(unix))]
    pub fn suspend(&mut self) {}

    /// Takes the terminal again after a stop, in which the shell set modes of its own.
    pub fn retake(&mut self) -> io::Result<()> {
        // crossterm does nothing where it believes that raw mode is on, and after SIGSTOP it does.
        crossterm::terminal::disable_raw_mode()?;
        set_modes()
    }

    /// Clears the screen, of whatever size it is now, so that the next drawing sends everything. The terminal is not
    /// asked where its cursor is (as `Terminal::clear` does): the keyboard's thread would take the answer.
    pub fn start_over(&mut self) -> io::Result<()> {
        let size = self.terminal.size()?;
        self.terminal.resize(size.into())
    }

    /// Remembers that pictures have to be removed from the terminal's memory at the end.
    pub fn painted_by(&mut self, painter: Option<Painter>) {
        self.painter = painter;
        crash::on_crash(move || give_back(painter));
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        crash::restore_terminal();
        restore_errors(self.errors.take());
    }
}

/// Raw keys, the alternate screen, pastes marked as such.
fn set_modes() -> io::Result<()> {
    crossterm::terminal::enable_raw_mode()?;
    crossterm::execute!(io::stdout(), EnterAlternateScreen, EnableBracketedPaste)
}

/// Leaves the terminal as it was found. Errors have nowhere to go by then.
fn give_back(painter: Option<Painter>) {
    let mut out = io::stdout();
    let _ = out.write_all(forget_pictures(painter).as_bytes());
    let _ = crossterm::execute!(out, DisableBracketedPaste, LeaveAlternateScreen, crossterm::cursor::Show);
    let _ = crossterm::terminal::disable_raw_mode();
}

#[cfg(unix)]
fn redirect_errors(file: &File) -> io::Result<Errors> {
    let before = rustix::io::dup(io::stderr())?;
    rustix::stdio::dup2_stderr(file)?;
    Ok(Errors { before })
}

#[cfg(unix)]
fn restore_errors(errors: Option<Errors>) {
    if let Some(errors) = errors {
        let _ = rustix::stdio::dup2_stderr(&errors.before);
    }
}

#[cfg(not(unix))]
fn redirect_errors(_: &File) -> io::Result<Errors> {
    Ok(Errors {})
}

#[cfg(not(unix))]
fn restore_errors(_: Option<Errors>) {}
