//! `phystalk plan [SPEC|SCENE|VERSION] [-p TEXT]…`: which stages would run, which are in the store, and why; of words also what
//! they would change.

use super::exit::Failure;
use super::flags::Flags;
use super::{output, setup, stores};
use crate::conversation::{Rehearsal, plan_table, rehearse};
use crate::history::Session;
use clap::Args;
use phystalk::stages::{Plan, RunOptions};
use serde_json::json;
use std::path::Path;

#[derive(Args, Debug)]
pub struct Arguments {
    /// A spec (.toml, .json), a scene (.ply, .splat, builtin:demo) or a version, as v3 [default: the newest version]
    #[arg(value_parser = setup::file_argument())]
    what: Option<String>,
    /// What should happen: says what it would change, and neither runs nor keeps it; several follow one another
    #[arg(short, long = "prompt", value_name = "TEXT", allow_hyphen_values = true)]
    prompt: Vec<String>,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let what = arguments.what.as_deref().unwrap_or("last");
    // What makes no version makes no store either.
    let session = if setup::is_file(what) { None } else { Some(stores::session(flags)?.1) };
    let (spec, parent) = match &session {
        Some(session) => {
            let version = session.find(what)?;
            let parent = version.parent.as_ref().map_or_else(|| Ok(session.base().clone()), |parent| session.spec_of(parent))?;
            (setup::adjusted(version.spec.clone(), flags)?, Some(parent))
        }
        None => (setup::spec_of(what, flags)?, None),
    };
    let options = RunOptions { camera: session.as_ref().and_then(Session::camera), ..flags.run_options() };
    let mut engine = setup::engine(flags, stores::of_results(flags)?);
    let (mut now, mut before) = (spec.clone(), parent.clone());
    let mut turns = Vec::new();
    for words in &arguments.prompt {
        let rehearsal = rehearse(&mut engine, &options, &now, before.as_ref(), words)?;
        before = Some(std::mem::replace(&mut now, rehearsal.after.clone()));
        turns.push((words, rehearsal));
    }
    let previous = if turns.is_empty() { parent } else { session.is_some().then_some(spec) };
    let plan = engine.plan(&now, Path::new(""), &options, previous.as_ref())?;
    tell(&turns, &plan, flags)
}

fn tell(turns: &[(&String, Rehearsal)], plan: &Plan, flags: &Flags) -> Result<(), Failure> {
    if flags.json && turns.is_empty() {
        return output::json(plan);
    }
    if flags.json {
        let turns: Vec<_> = turns
            .iter()
            .map(|(words, r)| json!({ "text": words, "said": r.said, "edits": r.edits, "changes": r.changes, "not_understood": r.not_understood }))
            .collect();
        return output::json(&json!({ "turns": turns, "stages": plan.stages }));
    }
    for (words, rehearsal) in turns {
        output::line(format!("> {words}"))?;
        rehearsal.said.iter().try_for_each(|text| output::line(format!("  {text}")))?;
        rehearsal.changes.iter().try_for_each(|change| output::line(format!("    {change}")))?;
        if !rehearsal.not_understood.is_empty() {
            output::note(format!("not understood: {}", rehearsal.not_understood.join(", ")));
        }
    }
    output::line(output::table(&plan_table(&plan.stages)))
}
