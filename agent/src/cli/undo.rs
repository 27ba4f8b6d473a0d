//! `phystalk undo` and `phystalk redo`: going back is a version too, so nothing is lost.

use super::collect::Collector;
use super::exit::Failure;
use super::flags::Flags;
use super::text::Teller;
use super::{output, setup, signals, stores};
use crate::conversation::{Conversation, Listener};
use crate::history::Session;
use clap::Args;
use phystalk::Stop;
use phystalk::store::Store;
use serde_json::json;
use std::path::Path;

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
        return with_files(arguments.steps, way, flags, (store, session), out);
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

/// Goes to the version as a turn, which writes its files below `out`.
fn with_files(steps: u32, way: Way, flags: &Flags, (store, session): (Store, Session), out: &Path) -> Result<(), Failure> {
    let from = session.head().map(|v| v.name.clone());
    let folder = setup::output(out.to_owned(), &store, &session, flags, "exec")?;
    let mut conversation = Conversation::new(setup::engine(flags, store), session, flags.run_options(), Some(folder), flags.cpu);
    let stop = Stop::default();
    let _guard = signals::stop_on_signal(&stop);
    let mut go = |listener: &mut dyn Listener| match way {
        Way::Back => conversation.undo(steps, listener, &stop),
        Way::Forward => conversation.redo(steps, listener, &stop),
    };
    if !flags.json {
        let mut teller = Teller::new(flags.quiet, &stop);
        let outcome = go(&mut teller);
        return teller.end(outcome.exit_code);
    }
    let mut collector = Collector::default();
    let outcome = go(&mut collector);
    let session = conversation.session();
    let note = outcome.version.as_ref().and_then(|_| session.head()).map(|v| v.note.clone());
    let mut object = collector.object(session.name(), &outcome, out);
    (object["from"], object["to"], object["note"]) = (json!(from), json!(outcome.version), json!(note));
    output::json(&object)?;
    Failure::from_code(outcome.exit_code)
}
