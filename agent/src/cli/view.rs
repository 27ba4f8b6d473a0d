//! `phystalk view [SPEC|VERSION] --window`: the preview window, a process of its own.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::{setup, stores};
use clap::Args;
use std::process::{Child, Command, Stdio};

#[derive(Args, Debug)]
pub struct Arguments {
    /// A spec (.toml, .json) or a version to start with; alone: the last session's newest version
    #[arg(value_parser = setup::file_argument())]
    what: Option<String>,
    /// In a window (the only way yet)
    #[arg(long)]
    window: bool,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    if !arguments.window {
        return Err(Failure::new(Kind::Usage, "say how to view it: phystalk view --window"));
    }
    check_display()?;
    open(arguments, flags)
}

#[cfg(feature = "window")]
fn open(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    use crate::preview::window::{self, Setting, Source};
    let chosen = match arguments.what.as_deref().filter(|w| !setup::is_spec(w)) {
        Some(version) => Some(stores::session(flags)?.1.find(version)?.name.clone()),
        None => None,
    };
    let source = match arguments.what.as_deref().filter(|w| setup::is_spec(w)) {
        Some(file) => Source::Spec(Box::new(setup::spec_of(file, flags)?)),
        None => Source::Session(flags.session.clone()),
    };
    let store = match source {
        Source::Session(_) => stores::session(flags)?.0,
        Source::Spec(_) => stores::of_results(flags)?,
    };
    let sessions = stores::sessions(flags, &store)?;
    window::open(Setting { store, sessions, device: flags.device_request(), options: flags.run_options(), source }, chosen)
}

#[cfg(not(feature = "window"))]
fn open(_: &Arguments, _: &Flags) -> Result<(), Failure> {
    Ok(())
}

/// What opens the window beside this process, on the same store and session.
pub fn opener(flags: &Flags, session: &str) -> Box<dyn Fn() -> Result<Child, Failure>> {
    let (flags, session) = (flags.clone(), session.to_owned());
    Box::new(move || {
        check_display()?;
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
        if let Some(quality) = flags.quality {
            command.args(["--quality", quality.as_str()]);
        }
        Ok(command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?)
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
