//! `phystalk schema WHAT`: made from the types themselves, so that it cannot be out of date.

use super::exit::Failure;
use super::output;
use crate::conversation::Line;
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
    /// One change of a spec
    Edit,
    /// One line of `exec --json`
    Events,
    /// metrics.json
    Metrics,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let schema = match arguments.what {
        What::Spec => phystalk::spec::schema::spec().clone(),
        What::Edit => phystalk::spec::schema::edit().clone(),
        What::Events => schema_for!(Line).to_value(),
        What::Metrics => schema_for!(phystalk::stages::Metrics).to_value(),
    };
    output::json_indented(&schema)
}
