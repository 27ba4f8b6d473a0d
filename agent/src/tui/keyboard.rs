//! Terminal input: the keyboard's bytes and the terminal's signals as messages, each from a thread that lives as long as the
//! process.

use super::Message;
use crate::cli::exit::Failure;
use crossterm::event::KeyEvent;
use std::sync::mpsc::Sender;

/// What the terminal reports.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(not(unix), allow(dead_code))]
pub enum Input {
    /// A key.
    Key(KeyEvent),
    /// Text pasted as a whole.
    Paste {
        /// The text.
        text: String,
        /// Bytes over the limit, which were dropped.
        lost: usize,
    },
    /// The terminal has another size.
    Resized,
    /// SIGTSTP: the process has to stop and leave the terminal to the shell.
    Suspend,
    /// SIGCONT: the process runs again after a stop, in which the shell changed the terminal's mode.
    Resumed,
    /// The terminal is gone.
    Closed,
}

/// Starts the threads.
#[cfg(unix)]
pub fn listen(post: &Sender<Message>) -> Result<(), Failure> {
    let (keys, signals) = (post.clone(), post.clone());
    let caught = signal_hook::iterator::Signals::new(unix::SIGNALS)?;
    std::thread::Builder::new().name("keys".into()).spawn(move || unix::read_keys(&keys))?;
    std::thread::Builder::new().name("terminal signals".into()).spawn(move || unix::forward_signals(caught, &signals))?;
    Ok(())
}

#[cfg(unix)]
mod unix {
    use super::{Input, Message};
    use crate::tui::keys::Decoder;
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use rustix::io::Errno;
    use signal_hook::consts::{SIGCONT, SIGTSTP, SIGWINCH};
    use std::sync::mpsc::Sender;
    use std::time::Instant;

    pub const SIGNALS: [i32; 3] = [SIGWINCH, SIGCONT, SIGTSTP];

    /// Reads standard input until it ends. crossterm's own reader waits without end for a sequence that never ends, so the
    /// bytes are decoded here.
    pub fn read_keys(post: &Sender<Message>) {
        let mut decoder = Decoder::default();
        loop {
            let Some(inputs) = next_inputs(&mut decoder) else {
                // The receiver is gone only while the program ends.
                let _ = post.send(Message::Input(Input::Closed));
                return;
            };
            for input in inputs {
                if post.send(Message::Input(input)).is_err() {
                    return;
                }
            }
        }
    }

    /// Waits for bytes, or for the moment at which an unfinished sequence counts as ended. Nothing where standard input ended.
    fn next_inputs(decoder: &mut Decoder) -> Option<Vec<Input>> {
        let stdin = std::io::stdin();
        let wait = decoder.deadline().map(|end| end.saturating_duration_since(Instant::now()));
        let wait = wait.map(|wait| Timespec { tv_sec: wait.as_secs() as i64, tv_nsec: i64::from(wait.subsec_nanos()) });
        match poll(&mut [PollFd::new(&stdin, PollFlags::IN)], wait.as_ref()) {
            Ok(0) => return Some(decoder.expire(Instant::now())),
            Ok(_) => {}
            Err(Errno::INTR) => return Some(Vec::new()),
            Err(_) => return None,
        }
        let mut bytes = [0; 4096];
        match rustix::io::read(&stdin, &mut bytes) {
            Ok(0) => None,
            Ok(count) => Some(decoder.feed(&bytes[..count], Instant::now())),
            Err(Errno::INTR | Errno::AGAIN) => Some(Vec::new()),
            Err(_) => None,
        }
    }

    pub fn forward_signals(mut signals: signal_hook::iterator::Signals, post: &Sender<Message>) {
        for signal in signals.forever() {
            let input = match signal {
                SIGTSTP => Input::Suspend,
                SIGCONT => Input::Resumed,
                _ => Input::Resized,
            };
            // The receiver is gone: the terminal is already given back, so the process only has to stop.
            if post.send(Message::Input(input)).is_err() && signal == SIGTSTP {
                let _ = signal_hook::low_level::emulate_default_handler(SIGTSTP);
            }
        }
    }
}

/// Starts the thread.
#[cfg(not(unix))]
pub fn listen(post: &Sender<Message>) -> Result<(), Failure> {
    use crossterm::event::Event;
    let post = post.clone();
    let read = move || {
        loop {
            let input = match crossterm::event::read() {
                Ok(Event::Key(key)) => Input::Key(key),
                Ok(Event::Paste(text)) => Input::Paste { text, lost: 0 },
                Ok(Event::Resize(..)) => Input::Resized,
                Ok(_) => continue,
                Err(_) => Input::Closed,
            };
            let ended = input == Input::Closed;
            if post.send(Message::Input(input)).is_err() || ended {
                return;
            }
        }
    };
    std::thread::Builder::new().name("keys".into()).spawn(read)?;
    Ok(())
}
