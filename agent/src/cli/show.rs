//! `phystalk show V`: one version, whole.

use super::exit::Failure;
use super::flags::Flags;
use super::{output, stores};
use clap::Args;
use serde_json::json;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Which version, as v3 [default: the newest]
    version: Option<String>,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let (_, session) = stores::session(flags)?;
    let version = session.find(arguments.version.as_deref().unwrap_or("last"))?;
    let spec = session.spec_of(&version.name)?;
    if flags.json {
        return output::json(&json!({ "session": session.name(), "version": version, "spec": spec.to_value() }));
    }
    let from = version.parent.as_ref().map(|p| format!(" <- {p}")).unwrap_or_default();
    output::line(format!("# {}{from}: {}", version.name, version.words.replace('\n', " ")))?;
    if !version.note.is_empty() {
        output::line(format!("# {}", version.note))?;
    }
    for edit in &version.edits {
        output::line(format!("# {edit}"))?;
    }
    output::line(spec.to_toml().trim_end())
}
