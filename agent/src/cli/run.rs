//! `phystalk run SPEC.toml`: a spec, no language.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::text::Teller;
use super::{output, setup, signals};
use crate::conversation::{Conversation, Event, Listener};
use crate::history::Session;
use clap::Args;
use phystalk::Stop;
use serde_json::{Value, json};
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
        let version = outcome.version.unwrap_or_default();
        let metrics: Option<Value> = std::fs::read(out.join(&version).join("metrics.json")).ok().and_then(|b| serde_json::from_slice(&b).ok());
        output::json(&json!({
            "session": name, "version": version, "out": out.join(&version), "exit_code": outcome.exit_code,
            "plan": { "stages": collector.stages }, "metrics": metrics, "warnings": collector.warnings, "error": collector.error,
        }))?;
        return Failure::from_code(outcome.exit_code);
    }
    let mut teller = Teller::new(flags.quiet, &stop);
    conversation.open(&mut teller);
    let outcome = conversation.run_base(&words, &mut teller, &stop);
    if teller.broken { Err(Failure::silent(Kind::Pipe)) } else { Failure::from_code(outcome.exit_code) }
}

/// Keeps what the one JSON object of a run says.
#[derive(Default)]
struct Collector {
    stages: Vec<Value>,
    warnings: Vec<String>,
    error: Option<String>,
}

impl Listener for Collector {
    fn event(&mut self, event: Event) {
        match event {
            Event::PlanReady { stages } => self.stages = stages.iter().filter_map(|s| serde_json::to_value(s).ok()).collect(),
            Event::Warning { text } => self.warnings.push(text),
            Event::TurnFailed { error, .. } => {
                output::error(&error);
                self.error = Some(error);
            }
            _ => {}
        }
    }
}
