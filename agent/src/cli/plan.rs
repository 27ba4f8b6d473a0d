//! `phystalk plan SPEC|VERSION`: which stages would run, which are in the store, and why.

use super::exit::Failure;
use super::flags::Flags;
use super::{output, setup};
use crate::conversation::plan_table;
use clap::Args;
use phystalk::stages::RunOptions;
use std::path::Path;

#[derive(Args, Debug)]
pub struct Arguments {
    /// A spec (.toml, .json) or a version, as v3
    what: String,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let store = setup::store(flags)?;
    let mut engine = setup::engine(flags, store.clone());
    let (spec, _) = setup::spec_by_name(&arguments.what, flags)?;
    let of_version = !setup::is_spec(&arguments.what);
    let session = if of_version { Some(setup::session(flags, &store)?) } else { None };
    let options = RunOptions { camera: session.as_ref().and_then(crate::history::Session::camera), ..flags.run_options() };
    let previous = match &session {
        Some(session) => session.find(&arguments.what)?.parent.clone().and_then(|parent| session.spec_of(&parent).ok()),
        None => None,
    };
    let plan = engine.plan(&spec, Path::new(""), &options, previous.as_ref())?;
    if flags.json { output::json(&plan) } else { output::line(output::table(&plan_table(&plan.stages))) }
}
