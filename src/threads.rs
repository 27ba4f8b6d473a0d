//! Threads that may fail to start, and whose panics end the work they did, not the process.
//!
//! [`start_pool`] makes rayon's pool from threads that run already, so that rayon, which panics where it gets none, never asks.
//! A panic under [`caught`] becomes a [`ThreadError`]; the program's panic hook asks [`is_caught`] and leaves it alone.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, JoinHandle};
use std::{io, num};

/// Threads left for the rest of the program where the system gives fewer than there are cores: engine, keys, signals, three that
/// write, and the driver's own.
const SPARE: usize = 8;

/// Why a piece of work that was given to a thread has no result.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ThreadError {
    /// No thread could be started.
    #[error("the system lets this process start no more threads: {reason}; end other programs of this user, or raise `ulimit -u`")]
    Start {
        /// The system's answer.
        reason: String,
    },
    /// The work panicked.
    #[error("{work} failed at a bug of phystalk: {message}; please report this line with the command that led to it")]
    Panicked {
        /// What was done.
        work: &'static str,
        /// What the panic said.
        message: String,
    },
}

thread_local! {
    static CAUGHT: Cell<bool> = const { Cell::new(false) };
}

/// Whether a panic of this thread becomes an error of the work that it does.
pub fn is_caught() -> bool {
    CAUGHT.get()
}

/// Does some work; a panic in it is an error.
pub fn caught<T>(name: &'static str, work: impl FnOnce() -> T) -> Result<T, ThreadError> {
    let outer = CAUGHT.replace(true);
    // Whatever the work left half done is dropped with it: the error ends the run.
    let done = catch_unwind(AssertUnwindSafe(work));
    CAUGHT.set(outer);
    done.map_err(|payload| ThreadError::Panicked { work: name, message: message(payload.as_ref()) })
}

/// What a panic said.
fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied().or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message").to_owned()
}

/// Work on a thread of its own.
#[derive(Debug)]
pub struct Task<T>(JoinHandle<Result<T, ThreadError>>);

impl<T: Send + 'static> Task<T> {
    /// Starts it.
    pub fn spawn(name: &'static str, work: impl FnOnce() -> T + Send + 'static) -> Result<Task<T>, ThreadError> {
        let thread = Builder::new().name(name.to_owned()).spawn(move || caught(name, work));
        thread.map(Task).map_err(|error| ThreadError::Start { reason: error.to_string() })
    }

    /// Waits for its result.
    pub fn join(self) -> Result<T, ThreadError> {
        // Nothing panics outside of `caught`.
        self.0.join().unwrap_or_else(|payload| Err(ThreadError::Panicked { work: "a thread", message: message(payload.as_ref()) }))
    }
}

/// Whether the pool has no thread but those that call it.
static ALONE: AtomicBool = AtomicBool::new(false);

/// Makes rayon's global pool with a thread for each core, or with as many as the system gives. Called once, at the start.
pub fn start_pool() {
    let wanted = std::thread::available_parallelism().map_or(1, num::NonZero::get);
    start_pool_with(wanted, |thread| Builder::new().spawn(thread).map(drop));
}

type Started = Receiver<rayon::ThreadBuilder>;

fn start_pool_with(wanted: usize, spawn: impl Fn(Box<dyn FnOnce() + Send>) -> io::Result<()>) {
    let idle = idle_threads(wanted, spawn);
    let pool = rayon::ThreadPoolBuilder::new();
    let built = match idle.len() {
        0 => {
            ALONE.store(true, Ordering::Relaxed);
            pool.num_threads(1).use_current_thread().build_global()
        }
        count => {
            let idle = std::sync::Mutex::new(idle);
            let hand_over = move |thread: rayon::ThreadBuilder| {
                let waiting = idle.lock().ok().and_then(|mut idle| idle.pop());
                waiting.and_then(|waiting| waiting.send(thread).ok()).ok_or_else(|| io::Error::other("no thread is waiting"))
            };
            pool.num_threads(count).spawn_handler(hand_over).build_global()
        }
    };
    if let Err(error) = built {
        tracing::debug!(%error, "the pool was there already");
    }
}

/// Threads that wait to become the pool's; those whose sender is dropped end.
fn idle_threads(wanted: usize, spawn: impl Fn(Box<dyn FnOnce() + Send>) -> io::Result<()>) -> Vec<Sender<rayon::ThreadBuilder>> {
    let mut idle = Vec::new();
    while idle.len() < wanted {
        let (sender, receiver): (_, Started) = channel();
        let wait = move || {
            if let Ok(thread) = receiver.recv() {
                thread.run();
            }
        };
        if spawn(Box::new(wait)).is_err() {
            idle.truncate(idle.len().saturating_sub(SPARE));
            break;
        }
        idle.push(sender);
    }
    idle
}

/// Has the pool do some work, in the order it came; a pool without threads of its own would never come to it, so it is done now.
pub fn detach(work: impl FnOnce() + Send + 'static) {
    if ALONE.load(Ordering::Relaxed) { work() } else { rayon::spawn_fifo(work) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_with_its_message_and_the_next_work_is_done() {
        assert!(!is_caught());
        let failed = caught("encoding a picture", || {
            if is_caught() {
                panic!("no {}", "luck")
            }
        });
        assert_eq!(failed, Err(ThreadError::Panicked { work: "encoding a picture", message: "no luck".to_owned() }));
        assert!(!is_caught());
        let task = Task::spawn("writing", || -> u32 { panic!("full") }).unwrap();
        assert!(task.join().unwrap_err().to_string().contains("writing failed at a bug of phystalk: full"));
        assert_eq!(Task::spawn("writing", || 7).unwrap().join(), Ok(7));
    }

    /// A spawner that starts so many threads and then fails as a process at its limit does.
    fn limited(most: usize) -> impl Fn(Box<dyn FnOnce() + Send>) -> io::Result<()> {
        let left = Cell::new(most);
        move |thread| {
            left.set(left.get().checked_sub(1).ok_or(io::ErrorKind::WouldBlock)?);
            Builder::new().spawn(thread).map(drop)
        }
    }

    #[test]
    fn where_threads_run_out_some_are_left_for_the_rest_of_the_program() {
        assert_eq!(idle_threads(4, limited(usize::MAX)).len(), 4);
        assert_eq!(idle_threads(32, limited(20)).len(), 20 - SPARE);
        assert_eq!(idle_threads(32, limited(3)).len(), 0);
        assert_eq!(idle_threads(32, limited(0)).len(), 0);
    }

    #[test]
    fn detached_work_is_done() {
        let (sender, receiver) = channel();
        detach(move || sender.send(1).unwrap());
        assert_eq!(receiver.recv(), Ok(1));
    }
}
