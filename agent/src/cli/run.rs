//! `phystalk run SPEC|VERSION`: a spec, no language; or the files of a version that is kept.

use super::collect::Collector;
use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::text::Teller;
use super::{output, setup, signals, stores};
use crate::conversation::{Conversation, Listener, Outcome};
use clap::Args;
use phystalk::Stop;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub struct Arguments {
    /// The spec, .toml or .json; or a version of the session, as v2: its files are written, and no new version is made
    what: PathBuf,
}

/// What is run, in which conversation.
struct Run {
    conversation: Conversation,
    out: PathBuf,
    what: What,
}

enum What {
    /// The session starts with the spec as its first version; how the turn is called.
    Spec(String),
    /// A version that is there.
    Version(String),
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let mut run = match arguments.what.to_str().filter(|what| !setup::is_file(what)) {
        Some(version) => of_version(version, flags)?,
        None => of_spec(&arguments.what, flags)?,
    };
    run.conversation.details = flags.verbose;
    let stop = Stop::default();
    let _guard = signals::stop_on_signal(&stop);
    if flags.json {
        let mut collector = Collector::default();
        let outcome = run.turn(&mut collector, &stop);
        output::json(&collector.object(run.conversation.session().name(), &outcome, &run.out))?;
        return Failure::from_code(outcome.exit_code);
    }
    let mut teller = Teller::new(flags.quiet, &stop);
    run.conversation.open(&mut teller);
    let outcome = run.turn(&mut teller, &stop);
    teller.end(outcome.exit_code)
}

fn of_spec(path: &Path, flags: &Flags) -> Result<Run, Failure> {
    let spec = setup::adjusted(setup::read(path)?, flags)?;
    if let Some(out) = &flags.out {
        crate::conversation::output_folder::check(out, None, "run", flags.replace)?;
    }
    stores::with_work(flags, |store| {
        let mut engine = setup::engine(flags, store.clone());
        engine.open_ahead();
        engine.facts(&spec, Path::new(""), &flags.run_options())?;
        let session = stores::sessions(flags, store)?.start(flags.session.as_deref(), spec)?;
        let out = setup::default_out(flags, session.name());
        let folder = setup::output(out.clone(), store, &session, flags, "run")?;
        let conversation = Conversation::new(engine, session, flags.run_options(), Some(folder), flags.cpu);
        Ok(Run { conversation, out, what: What::Spec(format!("run {}", path.display())) })
    })
}

fn of_version(version: &str, flags: &Flags) -> Result<Run, Failure> {
    if !flags.set.is_empty() {
        return Err(Failure::new(Kind::Usage, "--set makes a new version: phystalk exec --continue --set PATH=VALUE"));
    }
    let (store, session) = stores::session(flags)?;
    let version = session.find(version)?.name.clone();
    let out = setup::default_out(flags, session.name());
    let folder = setup::output(out.clone(), &store, &session, flags, "run")?;
    let results = if store.read_only().is_none() { store } else { stores::of_results(flags)? };
    let conversation = Conversation::new(setup::engine(flags, results), session, flags.run_options(), Some(folder), flags.cpu);
    Ok(Run { conversation, out, what: What::Version(version) })
}

impl Run {
    fn turn(&mut self, listener: &mut dyn Listener, stop: &Stop) -> Outcome {
        match &self.what {
            What::Spec(words) => self.conversation.run_base(words, listener, stop),
            What::Version(version) => self.conversation.run_again(version, listener, stop),
        }
    }
}
