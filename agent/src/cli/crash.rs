//! A bug in the program itself: the terminal is given back, one sentence is said, exit code 70.

use super::exit::Kind;
use std::panic::PanicHookInfo;
use std::sync::Mutex;

type Restore = Box<dyn Fn() + Send>;

static RESTORE: Mutex<Option<Restore>> = Mutex::new(None);

/// What to do before a crash is reported: the terminal interface gives the screen back here.
pub fn on_crash(restore: impl Fn() + Send + 'static) {
    if let Ok(mut slot) = RESTORE.lock() {
        *slot = Some(Box::new(restore));
    }
}

/// Runs and forgets what [`on_crash`] was given; also for a signal that ends the process.
pub fn restore_terminal() {
    if let Ok(mut slot) = RESTORE.lock()
        && let Some(restore) = slot.take()
    {
        restore();
    }
}

/// Makes every panic end the process with exit code 70, on whatever thread, but for those that become errors of a run.
pub fn install() {
    std::panic::set_hook(Box::new(|info| {
        if phystalk::threads::is_caught() {
            tracing::error!("{}", sentence(info));
            return;
        }
        restore_terminal();
        super::output::note(sentence(info));
        std::process::exit(i32::from(Kind::Bug.code()));
    }));
}

fn sentence(info: &PanicHookInfo<'_>) -> String {
    let payload = info.payload();
    let text = payload.downcast_ref::<&str>().copied().or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
    let place = info.location().map(|l| format!("{}:{}", l.file(), l.line())).unwrap_or_default();
    format!(
        "error: phystalk {} stopped at a bug of its own: {text} ({place})\n  finished versions and stages are kept in the store; \
         please report this line with the command that led to it",
        env!("CARGO_PKG_VERSION")
    )
}
