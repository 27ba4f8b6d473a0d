//! `phystalk diff A B`: what two versions or specs differ in, with units and what it means.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::{output, setup};
use clap::Args;
use serde_json::json;

#[derive(Args, Debug)]
pub struct Arguments {
    /// A version, as v1, or a spec
    from: String,
    /// Another one
    to: String,
    /// Exit with 1 where they differ
    #[arg(long)]
    exit_code: bool,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let (from, from_name) = setup::spec_by_name(&arguments.from, flags)?;
    let (to, to_name) = setup::spec_by_name(&arguments.to, flags)?;
    let changes = from.diff(&to);
    if flags.json {
        output::json(&json!({ "from": from_name, "to": to_name, "changes": changes }))?;
    } else if changes.is_empty() {
        if !flags.quiet {
            output::line(format!("{from_name} and {to_name} are the same"))?;
        }
    } else {
        for change in &changes {
            output::line(change)?;
        }
    }
    if arguments.exit_code && !changes.is_empty() { Err(Failure::silent(Kind::Other)) } else { Ok(()) }
}
