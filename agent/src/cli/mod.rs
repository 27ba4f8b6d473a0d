//! Commands, flags, exit codes. One command a file; [`main`] is the whole life of the process.

mod completions;
pub mod crash;
mod doctor;
pub mod environment;
mod exit;
mod flags;
mod output;
mod schema;
mod signals;
mod store;

use clap::{Parser, Subcommand};
use exit::{Failure, Kind};
use flags::Flags;
use std::process::ExitCode;

/// Talk to a 3D Gaussian Splatting scene, and physics answers.
#[derive(Debug, Parser)]
#[command(name = "phystalk", version, propagate_version = true, max_term_width = 100, after_help = EXIT_CODES, arg_required_else_help = true)]
struct Cli {
    #[command(flatten)]
    flags: Flags,
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 ok · 1 failed · 2 command line · 3 spec or --set · 4 no model · 6 no GPU adapter · 7 not stable · \
10 store · 11 expectation or golden · 70 a bug · 130, 143 signals";

#[derive(Debug, Subcommand)]
enum Command {
    /// What this machine offers, and what to do where something is missing
    Doctor,
    /// JSON Schema of a file or stream that other programs may rely on
    Schema(schema::Arguments),
    /// Completion script for a shell
    Completions(completions::Arguments),
}

/// Parses the command line, runs the command, says what failed; the result is the exit code.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            let failed = error.use_stderr();
            let _ = error.print();
            return ExitCode::from(if failed { Kind::Usage.code() } else { 0 });
        }
    };
    start_log();
    signals::listen();
    let result = cli.flags.check_provider().and_then(|()| run(&cli));
    match (result, signals::received()) {
        (_, Some(signal)) => ExitCode::from(signal.code()),
        (Ok(()), None) => ExitCode::SUCCESS,
        (Err(failure), None) => {
            if !failure.message.is_empty() {
                output::error(&failure.message);
            }
            ExitCode::from(failure.kind.code())
        }
    }
}

fn run(cli: &Cli) -> Result<(), Failure> {
    match &cli.command {
        Command::Doctor => doctor::run(&cli.flags),
        Command::Schema(arguments) => schema::run(arguments),
        Command::Completions(arguments) => completions::run(arguments),
    }
}

/// Sends the library's log to standard error, only where `PHYSTALK_LOG` asks for it (as `phystalk=debug`).
fn start_log() {
    if let Ok(filter) = tracing_subscriber::EnvFilter::try_from_env("PHYSTALK_LOG") {
        tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).init();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
    }
}
