//! `phystalk schema WHAT`: made from the types themselves, so that it cannot be out of date.

use super::exit::Failure;
use super::output;
use clap::{Args, ValueEnum};
use schemars::schema_for;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Which schema
    what: What,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum What {
    /// A spec, as TOML or JSON
    Spec,
    /// metrics.json
    Metrics,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let schema = match arguments.what {
        What::Spec => schema_for!(phystalk::spec::Spec),
        What::Metrics => schema_for!(phystalk::stages::Metrics),
    };
    output::line(serde_json::to_string_pretty(&schema).map_err(Failure::other)?)
}
