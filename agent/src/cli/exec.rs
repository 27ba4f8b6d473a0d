//! `phystalk exec SCENE -p TEXT…`: a conversation without a terminal.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::text::{JsonLines, Teller};
use super::{setup, signals};
use crate::conversation::{Conversation, Listener};
use clap::Args;
use phystalk::Stop;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Splat file (.ply, .splat), spec (.toml) or builtin:demo; not needed with --continue
    scene: Option<String>,
    /// What should happen; one turn each
    #[arg(short, long = "prompt", value_name = "TEXT", required = true)]
    prompt: Vec<String>,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let mut conversation = setup::converse(arguments.scene.as_deref(), flags, |session| Some(setup::default_out(flags, session)))?;
    let stop = Stop::default();
    let _guard = signals::stop_on_signal(&stop);
    let (code, broken) = if flags.json {
        let mut listener = JsonLines::new(&stop);
        (turns(&mut conversation, &arguments.prompt, &mut listener, &stop), listener.broken)
    } else {
        let mut listener = Teller::new(flags.quiet, &stop);
        (turns(&mut conversation, &arguments.prompt, &mut listener, &stop), listener.broken)
    };
    if broken { Err(Failure::silent(Kind::Pipe)) } else { Failure::from_code(code) }
}

/// All turns, until one is stopped; the first exit code that is not 0.
pub fn turns(conversation: &mut Conversation, prompts: &[String], listener: &mut dyn Listener, stop: &Stop) -> u8 {
    conversation.open(listener);
    let mut first = 0;
    for prompt in prompts {
        let outcome = conversation.say(prompt, listener, stop);
        first = if first == 0 { outcome.exit_code } else { first };
        if stop.raised() {
            break;
        }
    }
    first
}
