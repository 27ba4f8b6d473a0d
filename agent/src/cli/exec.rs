//! `phystalk exec SCENE -p TEXT…`: a conversation without a terminal.

use super::exit::Failure;
use super::flags::Flags;
use super::text::{JsonLines, Teller};
use super::{setup, signals};
use crate::conversation::{Conversation, Listener};
use clap::Args;
use phystalk::Stop;
use phystalk::spec::Edit;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Splat file (.ply, .splat), spec (.toml) or builtin:demo; not needed with --continue
    #[arg(value_parser = setup::file_argument())]
    scene: Option<String>,
    /// What should happen; one turn each
    #[arg(short, long = "prompt", value_name = "TEXT", required_unless_present = "set", allow_hyphen_values = true)]
    prompt: Vec<String>,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let mut conversation = setup::converse(arguments.scene.as_deref(), flags, "exec", |session| Some(setup::default_out(flags, session)))?;
    // The scene of a new session already has the `--set` edits; an old one gets them as a turn.
    let edits = if conversation.resumed { setup::edits(flags)? } else { Vec::new() };
    let stop = Stop::default();
    let _guard = signals::stop_on_signal(&stop);
    if flags.json {
        let mut listener = JsonLines::new(&stop);
        let code = turns(&mut conversation, edits, &arguments.prompt, &mut listener, &stop);
        listener.end(code)
    } else {
        let mut listener = Teller::new(flags.quiet, &stop);
        let code = turns(&mut conversation, edits, &arguments.prompt, &mut listener, &stop);
        listener.end(code)
    }
}

/// All turns, until one is stopped: first the edits, if there are any, then the prompts; where there is neither, the
/// scene as it starts. The first exit code that is not 0.
pub fn turns(conversation: &mut Conversation, edits: Vec<Edit>, prompts: &[String], listener: &mut dyn Listener, stop: &Stop) -> u8 {
    conversation.open(listener);
    let mut first = 0;
    if edits.is_empty() && prompts.is_empty() {
        return conversation.run_base("as it starts", listener, stop).exit_code;
    }
    if !edits.is_empty() {
        let words = edits.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        first = conversation.edit(&words, edits, listener, stop).exit_code;
    }
    for prompt in prompts {
        if stop.raised() {
            break;
        }
        let outcome = conversation.say(prompt, listener, stop);
        first = if first == 0 { outcome.exit_code } else { first };
    }
    first
}
