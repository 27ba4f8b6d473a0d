//! The `phystalk` program: words become edits, edits make versions, versions become pictures.

#![allow(dead_code, unused_imports)] // rooms open one after another

mod cli;
mod history;
mod language;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::environment::prepare();
    cli::crash::install();
    cli::main()
}
