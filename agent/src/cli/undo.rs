//! `phystalk undo` and `phystalk redo`: going back is a version too, so nothing is lost.

use super::exit::Failure;
use super::flags::Flags;
use super::text::Teller;
use super::{output, setup, signals, stores};
use crate::conversation::Conversation;
use clap::Args;
use phystalk::Stop;
use serde_json::json;

#[derive(Args, Debug)]
pub struct Arguments {
    /// How many versions
    #[arg(default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    steps: u32,
}

/// Which way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// To older versions.
    Back,
    /// Forward again.
    Forward,
}

pub fn run(arguments: &Arguments, way: Way, flags: &Flags) -> Result<(), Failure> {
    let (store, mut session) = stores::session(flags)?;
    if let Some(out) = &flags.out {
        let folder = setup::output(out.clone(), &store, &session, flags, "exec")?;
        let mut conversation = Conversation::new(setup::engine(flags, store), session, flags.run_options(), Some(folder), flags.cpu);
        let stop = Stop::default();
        let _guard = signals::stop_on_signal(&stop);
        let mut teller = Teller::new(flags.quiet || flags.json, &stop);
        let outcome = match way {
            Way::Back => conversation.undo(arguments.steps, &mut teller, &stop),
            Way::Forward => conversation.redo(arguments.steps, &mut teller, &stop),
        };
        return Failure::from_code(outcome.exit_code);
    }
    let from = session.head().map(|v| v.name.clone());
    let version = match way {
        Way::Back => session.undo("undo", arguments.steps)?,
        Way::Forward => session.redo("redo", arguments.steps)?,
    };
    if flags.json {
        return output::json(&json!({ "session": session.name(), "from": from, "to": version.name, "note": version.note }));
    }
    output::line(format!("{} <- {}: {}", version.name, from.unwrap_or_default(), version.note))
}
