//! Words understood without a turn: what they would change, and nothing kept or run.

use super::{kept, narrate};
use crate::cli::exit::Failure;
use crate::language::{self, Reply};
use phystalk::spec::{Auto, Edit, Spec};
use phystalk::stages::{Engine, RunOptions};
use std::cell::RefCell;
use std::path::Path;

/// What words would come to.
pub struct Rehearsal {
    /// The spec that they lead to.
    pub after: Spec,
    /// What was understood, one sentence each.
    pub said: Vec<String>,
    /// The edits.
    pub edits: Vec<Edit>,
    /// The same as a comparison of the specs.
    pub changes: Vec<String>,
    /// Words that would have no effect.
    pub not_understood: Vec<String>,
}

/// Understands words about a spec; `previous` is the one that the turn before was made on.
pub fn hear(engine: &mut Engine, options: &RunOptions, spec: &Spec, previous: Option<&Spec>, words: &str) -> Result<Reply, Failure> {
    let facts = engine.facts(spec, Path::new(""), options)?;
    let engine = RefCell::new(engine);
    // What could not be found out here, the run will explain.
    let resolved = |path: &str| engine.borrow_mut().automatic(spec, Path::new(""), options, path).ok().flatten();
    let context = language::Context { spec, facts: &facts, resolved: &resolved, previous_spec: previous };
    Ok(language::understand(words, &context))
}

/// What automatic time a turn adds to the run, where that is worth a word.
pub fn longer(engine: &mut Engine, options: &RunOptions, before: &Spec, after: &Spec) -> Option<String> {
    if (before.time.duration_s, after.time.duration_s) != (Auto::Auto, Auto::Auto) {
        return None;
    }
    let mut lasts_s = |spec: &Spec| engine.automatic(spec, Path::new(""), options, "time.duration_s").ok().flatten();
    narrate::longer(lasts_s(before)?, lasts_s(after)?)
}

/// What words would change.
pub fn rehearse(engine: &mut Engine, options: &RunOptions, spec: &Spec, previous: Option<&Spec>, words: &str) -> Result<Rehearsal, Failure> {
    match hear(engine, options, spec, previous, words)? {
        Reply::Edits { edits, gloss, not_understood } => {
            let after = spec.apply(&edits).map_err(|e| Failure::other(e.to_string()))?;
            let still = kept::said(spec, &after, &edits);
            let said = gloss.into_iter().chain(still).chain(longer(engine, options, spec, &after)).collect();
            let changes = spec.diff(&after).iter().map(ToString::to_string).collect();
            Ok(Rehearsal { after, said, edits, changes, not_understood })
        }
        Reply::Refused { reason, .. } => Err(Failure::other(format!("{words}: {reason}"))),
        _ => Err(Failure::other(format!(
            "{words}: versions are not rehearsed; `phystalk log` lists them, and `phystalk plan v2` says what one would run"
        ))),
    }
}
