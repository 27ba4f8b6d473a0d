//! Commands, flags, exit codes. One command a file; [`main`] is the whole life of the process.

mod bench;
mod collect;
mod completions;
pub mod crash;
mod demo;
mod diff;
mod doctor;
pub mod environment;
mod exec;
pub mod exit;
mod flags;
mod golden;
pub mod log;
pub mod output;
mod plan;
mod progress;
mod repl;
mod run;
pub mod sanitise;
mod scene;
mod schema;
mod setup;
mod show;
pub mod signals;
mod still;
mod store;
mod stores;
mod text;
mod undo;
mod validate;
mod view;

use clap::{Parser, Subcommand};
use exit::{Failure, Kind};
use flags::Flags;
use std::process::ExitCode;

/// Talk to a 3D Gaussian Splatting scene, and physics answers.
#[derive(Debug, Parser)]
#[command(name = "phystalk", version, max_term_width = 100, after_help = EXIT_CODES)]
struct Cli {
    #[command(flatten)]
    flags: Flags,
    #[command(flatten)]
    repl: repl::Arguments,
    #[command(subcommand)]
    command: Option<Command>,
}

const EXIT_CODES: &str = "Exit codes: 0 ok · 1 failed · 2 command line · 3 spec or --set · 4 no model · 6 no GPU adapter · 7 not stable · \
9 store not accepted · 10 store · 11 expectation or golden · 70 a bug · 130, 143 signals";

#[derive(Debug, Subcommand)]
enum Command {
    /// The built-in scene, five turns, offline, pictures in ./phystalk-demo
    Demo,
    /// Say what should happen, without a terminal: one turn for each -p
    Exec(exec::Arguments),
    /// Run a spec, no language
    Run(run::Arguments),
    /// Which stages would run, which are in the store, and why
    Plan(plan::Arguments),
    /// Versions of a session
    Log,
    /// One version, whole
    Show(show::Arguments),
    /// What two versions or specs differ in
    Diff(diff::Arguments),
    /// Go back by a version, losing nothing
    Undo(undo::Arguments),
    /// Go forward again
    Redo(undo::Arguments),
    /// What a splat file holds
    Scene(scene::Arguments),
    /// Write a splat file in another format
    Convert(scene::ConvertArguments),
    /// One picture of a scene in its own frame
    Still(still::Arguments),
    /// Compare frames with expected pictures
    Golden(golden::Arguments),
    /// Look at versions: turn, play, compare
    View(view::Arguments),
    /// The store: size, clean-up, damage and repair, trust
    Store(store::Arguments),
    /// The solver against formulas and published data, on this device
    Validate(validate::Arguments),
    /// How fast this device is
    Bench(bench::Arguments),
    /// What this machine offers, and what to do where something is missing
    Doctor,
    /// JSON Schema of a file or stream that other programs may rely on
    Schema(schema::Arguments),
    /// Completion script for a shell
    Completions(completions::Arguments),
}

/// Parses the command line, runs the command, says what failed; the result is the exit code.
pub fn main() -> ExitCode {
    std::sync::LazyLock::force(&text::STARTED);
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(message) => return answer(&message),
    };
    start_log();
    signals::listen();
    let result = cli.flags.check_provider().and_then(|()| run(&cli));
    match signals::received() {
        Some(signal) => ExitCode::from(signal.code()),
        None => exit_code(result),
    }
}

/// The exit code of a result whose failure, if it has a message, is printed here.
fn exit_code(result: Result<(), Failure>) -> ExitCode {
    let Err(failure) = result else { return ExitCode::SUCCESS };
    if !failure.message.is_empty() {
        output::error(&failure.message);
    }
    ExitCode::from(failure.kind.code())
}

/// Prints clap's help, version or error. Errors repeat arguments, so the command line is parsed again with its control
/// characters escaped: the message shows them, and keeps clap's colours.
fn answer(message: &clap::Error) -> ExitCode {
    let escaped = std::env::args_os().map(|argument| sanitise::text(&argument.to_string_lossy()).into_owned());
    match Cli::try_parse_from(escaped) {
        Err(message) if message.use_stderr() => {
            let _ = output::clap(&message);
            ExitCode::from(Kind::Usage.code())
        }
        Err(message) => exit_code(output::clap(&message)),
        // Escaping mended the command line: it held bytes that are no UTF-8.
        Ok(_) => exit_code(Err(Failure::new(Kind::Usage, message.to_string().trim_start_matches("error: ")))),
    }
}

fn run(cli: &Cli) -> Result<(), Failure> {
    let flags = &cli.flags;
    let Some(command) = &cli.command else { return repl::run(&cli.repl, flags) };
    match command {
        Command::Demo => demo::run(flags),
        Command::Exec(arguments) => exec::run(arguments, flags),
        Command::Run(arguments) => run::run(arguments, flags),
        Command::Plan(arguments) => plan::run(arguments, flags),
        Command::Log => log::run(flags),
        Command::Show(arguments) => show::run(arguments, flags),
        Command::Diff(arguments) => diff::run(arguments, flags),
        Command::Undo(arguments) => undo::run(arguments, undo::Way::Back, flags),
        Command::Redo(arguments) => undo::run(arguments, undo::Way::Forward, flags),
        Command::Scene(arguments) => scene::run(arguments, flags),
        Command::Convert(arguments) => scene::convert(arguments, flags),
        Command::Still(arguments) => still::run(arguments, flags),
        Command::Golden(arguments) => golden::run(arguments, flags),
        Command::View(arguments) => view::run(arguments, flags),
        Command::Store(arguments) => store::run(arguments, flags),
        Command::Validate(arguments) => validate::run(arguments, flags),
        Command::Bench(arguments) => bench::run(arguments, flags),
        Command::Doctor => doctor::run(flags),
        Command::Schema(arguments) => schema::run(arguments),
        Command::Completions(arguments) => completions::run(arguments),
    }
}

/// Names of all commands, for suggestions.
fn command_names() -> Vec<String> {
    use clap::CommandFactory;
    Cli::command().get_subcommands().map(|c| c.get_name().to_owned()).collect()
}

/// Sends the library's log to standard error, only where `PHYSTALK_LOG` asks for it (as `phystalk=debug`).
fn start_log() {
    if let Ok(filter) = tracing_subscriber::EnvFilter::try_from_env("PHYSTALK_LOG") {
        tracing_subscriber::fmt().with_env_filter(filter).with_ansi(false).with_writer(|| output::Log).init();
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

    #[test]
    fn a_prompt_may_begin_with_a_sign() {
        assert!(Cli::try_parse_from(["phystalk", "exec", "vase.splat", "-p", "-20 % stiffer"]).is_ok());
    }
}
