//! The `phystalk` program: words become edits, edits make versions, versions become pictures.

mod cli;
mod conversation;
mod history;
mod language;
mod preview;
mod tui;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::environment::prepare();
    cli::crash::install();
    phystalk::threads::start_pool();
    cli::main()
}
