//! `phystalk [SCENE] [PROMPT]`: the REPL.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::setup;
use crate::preview::terminal::Graphics;
use crate::tui;
use clap::Args;
use std::io::IsTerminal;
use std::path::Path;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Splat file (.ply, .splat), spec (.toml) or builtin:demo to talk to
    #[arg(value_parser = setup::file_argument())]
    scene: Option<String>,
    /// The first thing to say
    prompt: Option<String>,
    /// How the preview reaches the terminal [env: PHYSTALK_GRAPHICS]
    #[arg(long, value_enum, value_name = "HOW")]
    graphics: Option<Graphics>,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let scene = arguments.scene.as_deref();
    if scene.is_none() && !flags.resume && flags.session.is_none() {
        return Err(Failure::new(
            Kind::Usage,
            "no scene: give a splat file (.ply or .splat), builtin:demo, or --continue\ntry `phystalk demo`, and `phystalk --help` for all commands",
        ));
    }
    if let Some(scene) = scene.filter(|s| is_mistyped_command(s)) {
        let meant = phystalk::spec::nearest(scene, super::command_names().iter().map(String::as_str)).map(str::to_owned);
        let hint = meant.map(|m| format!("; did you mean `phystalk {m}`?")).unwrap_or_default();
        return Err(Failure::other(format!("{scene} is neither a file nor a command{hint}")));
    }
    if let Some(scene) = scene.filter(|s| *s != phystalk::stages::BUILTIN_DEMO) {
        let path = phystalk::spec::file_name::decode(scene);
        std::fs::metadata(&path).map_err(|e| Failure::file("read", &path, &e))?;
    }
    if !std::io::stdin().is_terminal() || !std::io::stdout().is_terminal() {
        return Err(Failure::new(
            Kind::Usage,
            format!("the REPL needs a terminal; without one: phystalk exec {} -p \"…\"", scene.unwrap_or("SCENE")),
        ));
    }
    let conversation = setup::converse(scene, flags, "repl", |_| flags.out.clone())?;
    let graphics = arguments.graphics.or_else(graphics_from_environment).unwrap_or_default();
    // The scene of a new session already has the `--set` edits; an old one gets them as a turn.
    let set = (conversation.resumed && !flags.set.is_empty()).then(|| format!("/set {}", flags.set.join(" ")));
    let lines = set.into_iter().chain(arguments.prompt.clone()).collect();
    let window = super::view::opener(flags, conversation.session().name());
    tui::run(conversation, tui::Options { graphics, lines, window })
}

/// A word that is no file and looks like no path.
fn is_mistyped_command(scene: &str) -> bool {
    !Path::new(scene).exists() && !scene.contains(['.', '/', '\\', ':'])
}

fn graphics_from_environment() -> Option<Graphics> {
    let value = std::env::var("PHYSTALK_GRAPHICS").ok()?;
    <Graphics as clap::ValueEnum>::from_str(&value, true).ok()
}
