//! `phystalk demo`: the built-in scene, five turns, offline, and what to try next.

use super::exit::Failure;
use super::flags::Flags;
use super::text::{JsonLines, Teller};
use super::{exec, setup, signals};
use phystalk::Stop;
use std::path::PathBuf;

/// What the demo says, one turn each.
const TURNS: [&str; 5] =
    ["make the vase jump up and fall back", "softer", "do it on the moon", "back on earth, and push it to the left at 0.3 s", "undo that"];

pub fn run(flags: &Flags) -> Result<(), Failure> {
    let out = flags.out.clone().unwrap_or_else(|| PathBuf::from("phystalk-demo"));
    let mut conversation = setup::converse(Some("builtin:demo"), flags, "demo", |_| Some(out.clone()))?;
    let turns: Vec<String> = TURNS.iter().map(|t| (*t).to_owned()).collect();
    let stop = Stop::default();
    let _guard = signals::stop_on_signal(&stop);
    if flags.json {
        let mut listener = JsonLines::new(&stop);
        let code = exec::turns(&mut conversation, Vec::new(), &turns, &mut listener, &stop);
        return listener.end(code);
    }
    let mut teller = Teller::new(flags.quiet, &stop);
    let code = exec::turns(&mut conversation, Vec::new(), &turns, &mut teller, &stop);
    if code == 0 && !flags.quiet {
        let folder = out.display();
        let program = super::environment::program();
        teller.tell(format!(
            "\nThe pictures are in {folder}: look at {folder}/v1/contact.png, or open {folder}/v1/preview.webp in a browser.\n\
             Three things to try next:\n\
             \x20 {program} builtin:demo\n      talk to this scene yourself\n\
             \x20 {program} exec YOUR.splat -p \"drop it from 1 m\"\n      your own capture (.ply or .splat)\n\
             \x20 {program} diff v1 v2\n      what \"softer\" changed"
        ));
    }
    teller.end(code)
}
