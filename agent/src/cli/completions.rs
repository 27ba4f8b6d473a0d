//! `phystalk completions SHELL`.

use super::exit::Failure;
use super::output;
use clap::{Args, CommandFactory};
use clap_complete::Shell;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Which shell
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut super::Cli::command(), "phystalk", &mut script);
    output::line(String::from_utf8_lossy(&script).trim_end())
}
