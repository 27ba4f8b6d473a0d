//! `phystalk run SPEC.toml`: a spec, no language.

use super::collect::Collector;
use super::exit::Failure;
use super::flags::Flags;
use super::text::Teller;
use super::{output, setup, signals};
use crate::conversation::Conversation;
use crate::history::Session;
use clap::Args;
use phystalk::Stop;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub struct Arguments {
    /// The spec, .toml or .json
    spec: PathBuf,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let spec = setup::adjusted(setup::read(&arguments.spec)?, flags)?;
    let store = setup::store(flags)?;
    let mut engine = setup::engine(flags, store.clone());
    engine.open_ahead();
    engine.facts(&spec, Path::new(""), &flags.run_options())?;
    let session = Session::start(&store, flags.session.as_deref(), spec)?;
    let words = format!("run {}", arguments.spec.display());
    let out = setup::default_out(flags, session.name());
    let name = session.name().to_owned();
    let mut conversation = Conversation::new(engine, session, flags.run_options(), Some(out.clone()), flags.cpu);
    conversation.details = flags.verbose;
    let stop = Stop::default();
    let _guard = signals::stop_on_signal(&stop);
    if flags.json {
        let mut collector = Collector::default();
        let outcome = conversation.run_base(&words, &mut collector, &stop);
        output::json(&collector.object(&name, &outcome, &out))?;
        return Failure::from_code(outcome.exit_code);
    }
    let mut teller = Teller::new(flags.quiet, &stop);
    conversation.open(&mut teller);
    let outcome = conversation.run_base(&words, &mut teller, &stop);
    teller.end(outcome.exit_code)
}
