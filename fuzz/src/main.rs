//! `phystalk-fuzz TARGET`: mutated inputs for everything of the engine that reads what others wrote.
//!
//! Deterministic from its seed. Each input runs under `catch_unwind` and a counting allocator: a panic, more memory than the
//! target allows for its length, or a promise of the target that is broken is a failure, and the input is written to a file.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for developers that prints its result")]

mod corpus;
mod mutate;
mod target;
mod targets;
mod trial;

use clap::Parser;
use corpus::Corpus;
use mutate::Mutator;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use target::Target;
use trial::{Failed, Trial};

/// Tries mutated inputs on one target.
#[derive(Debug, Parser)]
#[command(name = "phystalk-fuzz")]
struct Arguments {
    /// Which: ply, splat, spec, expression
    target: String,
    /// How long, seconds of wall time
    #[arg(long, default_value_t = 10)]
    seconds: u64,
    /// How many inputs, instead of a time
    #[arg(long)]
    cases: Option<u64>,
    /// Of the mutations: equal seeds and corpora give equal inputs
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder of inputs to start from; those that are worth keeping are added
    #[arg(long)]
    corpus: Option<PathBuf>,
    /// Runs one input from a file, nothing else
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
    /// Writes each input to `fuzz-last` before it runs: for what ends the process itself, as a stack overflow does
    #[arg(long)]
    trace: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let Some(target) = targets::all().into_iter().find(|target| target.name() == arguments.target) else {
        let names: Vec<_> = targets::all().iter().map(|target| target.name()).collect();
        eprintln!("phystalk-fuzz: no target `{}`; there are: {}", arguments.target, names.join(", "));
        return ExitCode::from(2);
    };
    trial::silence_panics();
    phystalk::threads::start_pool();
    let done = match &arguments.replay {
        Some(file) => replay(target.as_ref(), file),
        None => fuzz(target.as_ref(), &arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("phystalk-fuzz: {message}");
            ExitCode::from(1)
        }
    }
}

fn replay(target: &dyn Target, file: &Path) -> Result<(), String> {
    let input = std::fs::read(file).map_err(|e| format!("cannot read {}: {e}", file.display()))?;
    let Trial { class, peak_bytes } = trial::run(target, &input).map_err(|failed| failed.reason)?;
    println!("{} of {} bytes: {class}; at most {peak_bytes} bytes of memory", target.name(), input.len());
    Ok(())
}

/// Tries inputs until time or count is over, or one fails.
fn fuzz(target: &dyn Target, arguments: &Arguments) -> Result<(), String> {
    let mut corpus = Corpus::open(target.seeds(), arguments.corpus.as_deref())?;
    let mut mutator = Mutator::new(arguments.seed, target.dictionary());
    let (clock, limit) = (Instant::now(), Duration::from_secs(arguments.seconds));
    let (mut classes, mut tried) = (BTreeMap::<String, u64>::new(), 0);
    loop {
        let over = arguments.cases.map_or_else(|| clock.elapsed() >= limit, |cases| tried >= cases);
        if over {
            break;
        }
        // The seeds themselves come first.
        let input = corpus.inputs().get(tried as usize).cloned().unwrap_or_else(|| mutator.mutated(corpus.inputs(), target.longest()));
        if arguments.trace {
            std::fs::write("fuzz-last", &input).map_err(|e| format!("cannot write fuzz-last: {e}"))?;
        }
        let trial = trial::run(target, &input).map_err(|failed| kept(target, &input, &failed, tried, arguments.seed))?;
        tried += 1;
        let count = classes.entry(trial.class).or_default();
        *count += 1;
        if *count == 1 {
            corpus.add(input)?;
        }
    }
    let seconds = clock.elapsed().as_secs_f64();
    println!("{}: {tried} inputs in {seconds:.1} s, {} classes of outcome, seed {}", target.name(), classes.len(), arguments.seed);
    Ok(())
}

/// Writes the input that failed; what happened, and how to see it again.
fn kept(target: &dyn Target, input: &[u8], failed: &Failed, case: u64, seed: u64) -> String {
    let name = format!("fuzz-{}-{}", target.name(), &blake3::hash(input).to_hex()[..12]);
    let file = match std::fs::write(&name, input) {
        Ok(()) => format!("\n  phystalk-fuzz {} --replay {name}", target.name()),
        Err(error) => format!("\n  {name} could not be written: {error}; --seed {seed} comes to it again"),
    };
    format!("input {case} of seed {seed} for {}: {}{file}", target.name(), failed.reason)
}
