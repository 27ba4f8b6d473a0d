//! `phystalk view [SPEC|VERSION] --window`: the preview window, a process of its own.

use super::exit::Failure;
use super::flags::Flags;
use std::process::{Command, Stdio};

/// What opens the window beside this process, on the same store and session.
pub fn opener(flags: &Flags, session: &str) -> Box<dyn Fn() -> Result<(), Failure>> {
    let (flags, session) = (flags.clone(), session.to_owned());
    Box::new(move || {
        super::view::check_display()?;
        let program = std::env::current_exe()?;
        let mut command = Command::new(program);
        command.args(["view", "--window", "--session", &session]);
        if let Some(store) = &flags.store {
            command.arg("--store").arg(store);
        }
        if let Some(device) = &flags.device {
            command.args(["--device", device]);
        }
        if flags.cpu {
            command.arg("--cpu");
        }
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
        Ok(())
    })
}

/// Says in good time that there is nowhere to open a window.
pub fn check_display() -> Result<(), Failure> {
    let shown = ["WAYLAND_DISPLAY", "DISPLAY"].iter().any(|v| std::env::var_os(v).is_some_and(|v| !v.is_empty()));
    if cfg!(feature = "window") && (shown || !cfg!(target_os = "linux")) {
        return Ok(());
    }
    let why = if cfg!(feature = "window") { "there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)" } else { "this build has no window" };
    Err(Failure::other(format!(
        "no window can be opened: {why}\nthe preview shows in the terminal, and pictures are files: phystalk exec SCENE -p \"…\" --out DIR"
    )))
}
