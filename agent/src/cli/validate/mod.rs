//! `phystalk validate [NAME]…`: the solver against formulas and published data, on this device.

mod page;
mod plot;

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::output;
use crate::conversation::duration;
use clap::Args;
use phystalk::gpu::Gpu;
use phystalk::skin;
use phystalk::solver::validate::{self, Case, Check};
use phystalk::spec::random::Size;
use phystalk::stages::{EngineError, fuzz};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Cases, as V5 or "left alone" [default: all]
    names: Vec<String>,
    /// Only the cases that take seconds
    #[arg(long)]
    quick: bool,
    /// How many random specs V28 draws
    #[arg(long, value_name = "N")]
    specs: Option<u64>,
    /// The seed of the first of them
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    from: u64,
    /// Write a page with plots too; the plots go to media/ beside it
    #[arg(long, value_name = "FILE.md")]
    page: Option<PathBuf>,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let cases = chosen(arguments)?;
    let gpu = Gpu::open(&flags.device_request())?;
    let mut checks: Vec<Check> = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        if !flags.quiet {
            output::note(format!("{} ({} of {}) …", case.name, number + 1, cases.len()));
        }
        let started = Instant::now();
        let size = if arguments.quick { Size::Small } else { Size::Whole };
        let found = match arguments.specs {
            Some(specs) if case.name == "V28" => {
                fuzz::checks(&gpu, size, arguments.from..arguments.from + specs, &mut |outcome| told(outcome, flags))
            }
            _ => case.run(&gpu),
        };
        let found = found.map_err(EngineError::from)?;
        if !flags.json {
            found.iter().try_for_each(|check| output::line(line(check)))?;
        }
        if !flags.quiet {
            output::note(format!("  {}", duration(started.elapsed().as_secs_f64())));
        }
        checks.extend(found);
    }
    if flags.json {
        output::json(&json!({ "device": gpu.name(), "tests": checks }))?;
    }
    if let Some(file) = &arguments.page {
        page::write(file, gpu.name(), &checks)?;
    }
    let failed = checks.iter().filter(|c| !c.held).count();
    match failed {
        0 if flags.json => Ok(()),
        0 => output::line(format!("all {} checks held on {}", checks.len(), gpu.name())),
        n => Err(Failure::new(Kind::Expectation, format!("{n} of {} checks did not hold on {}", checks.len(), gpu.name()))),
    }
}

/// Says what went wrong with a random spec; with `--verbose` what came of each.
fn told(outcome: &fuzz::Outcome, flags: &Flags) {
    let fine = matches!(outcome.kind, fuzz::Kind::Held | fuzz::Kind::Refused(_));
    if flags.verbose || !fine {
        output::note(format!("  {outcome}"));
    }
    if !flags.quiet && (outcome.seed + 1).is_multiple_of(100) {
        output::note(format!("  to seed {}", outcome.seed));
    }
}

/// Every case of every room.
fn cases() -> impl Iterator<Item = &'static Case> {
    validate::CASES.iter().chain(skin::validate::CASES).chain(fuzz::CASES)
}

/// The cases that were asked for, in their own order.
fn chosen(arguments: &Arguments) -> Result<Vec<&'static Case>, Failure> {
    let fits = |name: &String, case: &Case| case.name.eq_ignore_ascii_case(name);
    if let Some(unknown) = arguments.names.iter().find(|n| !cases().any(|c| fits(n, c))) {
        let known: Vec<_> = cases().map(|c| c.name).collect();
        return Err(Failure::new(Kind::Usage, format!("there is no case {unknown:?}; there are {}", known.join(", "))));
    }
    let wanted = |case: &&Case| (arguments.names.is_empty() || arguments.names.iter().any(|n| fits(n, case))) && (case.quick || !arguments.quick);
    Ok(cases().filter(wanted).collect())
}

/// One check on one line.
fn line(check: &Check) -> String {
    let held = if check.held { "held" } else { "FAILED" };
    let unit = if check.unit.is_empty() { String::new() } else { format!(" {}", check.unit) };
    format!(
        "{:<6} {:<36} measured {}{unit}, expected {}{unit}, within {}",
        held,
        check.name,
        number(check.measured),
        number(check.expected),
        tolerance(check)
    )
}

/// Five digits that mean something.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e5).contains(&size) => {
            let places = (4 - size.log10().floor() as i32).max(0) as usize;
            format!("{value:.places$}")
        }
        _ => format!("{value:.4e}"),
    }
}

/// A share of what is expected, or absolute where that is nothing.
fn tolerance(check: &Check) -> String {
    let short = |value: f64| (value * 1e9).round() / 1e9;
    if check.expected == 0.0 {
        format!("{} {}", short(check.tolerance), check.unit).trim_end().to_owned()
    } else {
        format!("{} %", short(100.0 * check.tolerance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_five_digits() {
        assert_eq!(number(0.0), "0");
        assert_eq!(number(0.0256391), "0.025639");
        assert_eq!(number(3.375), "3.3750");
        assert_eq!(number(-12345.6), "-12346");
        assert_eq!(number(1.25e-7), "1.2500e-7");
    }

    #[test]
    fn an_unknown_case_is_refused_with_the_known_ones() {
        let arguments = Arguments { names: vec!["V99".to_owned()], quick: false, specs: None, from: 0, page: None };
        let failure = chosen(&arguments).err().unwrap();
        assert_eq!(failure.kind, Kind::Usage);
        assert!(failure.message.contains("V5"), "{}", failure.message);
        let both = Arguments { names: vec!["v5".to_owned(), "V1".to_owned()], quick: true, specs: None, from: 0, page: None };
        assert_eq!(chosen(&both).unwrap().iter().map(|c| c.name).collect::<Vec<_>>(), ["V1"]);
    }
}
