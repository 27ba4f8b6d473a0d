//! `phystalk store du|gc|verify|accept`: size, clean-up, damage and repair, trust.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::{output, stores};
use clap::{Args, Subcommand};
use phystalk::store::{AcceptedStores, FOLDER, Finding, Place, Store, StoreError, Usage};
use serde_json::json;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// How much the store holds, by stage, and the size that it is kept under
    Du,
    /// Remove results that no version needs; versions themselves are never removed
    Gc {
        /// Then remove those used longest ago, until the rest is at most this, as 500MB or 2GB
        #[arg(long, value_name = "SIZE", value_parser = parse_size)]
        keep: Option<u64>,
    },
    /// Compare every checksum and say what is damaged; exit code 10 where something is
    Verify {
        /// Mend what can be mended; copies of changed logs go to the store's folder backup
        #[arg(long)]
        repair: bool,
    },
    /// Use a store that somebody else made from now on
    Accept {
        /// The store, or the folder that holds it
        dir: PathBuf,
    },
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    match &arguments.command {
        Command::Accept { dir } => accept(dir, flags),
        Command::Du => usage(&existing(flags)?, flags),
        Command::Gc { keep } => collect(&existing(flags)?, *keep, flags),
        Command::Verify { repair } => verify(existing(flags)?, *repair, flags),
    }
}

fn existing(flags: &Flags) -> Result<Store, Failure> {
    let missing = || match &flags.store {
        Some(dir) => format!("there is no store in {}", dir.display()),
        None => "there is no store here or above: phystalk exec SCENE -p TEXT makes one, --store names one".to_owned(),
    };
    stores::existing(flags)?.ok_or_else(|| Failure::other(missing()))
}

fn accept(dir: &Path, flags: &Flags) -> Result<(), Failure> {
    let inner = dir.join(FOLDER);
    let dir = if inner.is_dir() { &inner } else { dir };
    let mut place = match Place::at(dir) {
        Ok(Some(place)) => place,
        Ok(None) | Err(StoreError::NotAStore { .. }) => return Err(Failure::other(format!("there is no store in {}", dir.display()))),
        Err(error) => return Err(error.into()),
    };
    let list = AcceptedStores::of_user();
    let list = list.ok_or_else(|| Failure::other("your list of stores has no place: set HOME or XDG_STATE_HOME, or name the store with --store"))?;
    place.accept(&list)?;
    if flags.json {
        return output::json(&json!({ "accepted": place.dir(), "list": list.file() }));
    }
    output::line(format!("accepted {}, noted in {}", place.dir().display(), list.file().display()))
}

fn usage(store: &Store, flags: &Flags) -> Result<(), Failure> {
    let usage = store.usage()?;
    if flags.json {
        return output::json(&json!({ "store": store.dir(), "usage": usage }));
    }
    output::line(report(store.dir(), &usage))
}

fn report(dir: &Path, usage: &Usage) -> String {
    let mut rows = vec![vec!["store".to_owned(), dir.display().to_string(), String::new()]];
    let row = |what: &str, bytes: u64, more: String| vec![what.to_owned(), size(bytes), more];
    rows.extend(usage.stages.iter().map(|(stage, (entries, bytes))| row(stage, *bytes, format!("results: {entries}"))));
    rows.push(row(
        "results",
        usage.bytes,
        format!("of at most {}: those used longest ago go first; phystalk store gc removes what no version needs", size(usage.cap_bytes)),
    ));
    rows.push(row("history", usage.history_bytes, "versions and copies of repaired logs: never removed".to_owned()));
    output::table(&rows)
}

fn collect(store: &Store, keep: Option<u64>, flags: &Flags) -> Result<(), Failure> {
    let sessions = stores::sessions(flags, store)?;
    let mut reached = BTreeSet::new();
    for (name, _) in sessions.used()? {
        let session = sessions.open(Some(&name))?;
        // What a damaged version needs cannot be known.
        if let Some(damage) = session.damage().first() {
            return Err(Failure::new(Kind::Store, format!("session {name} is damaged ({damage}): phystalk store verify --repair first")));
        }
        reached.extend(session.versions().iter().flat_map(|version| version.results.iter().cloned()));
    }
    let collected = store.collect(&reached, keep)?;
    if flags.json {
        return output::json(&json!({ "removed": collected, "usage": store.usage()? }));
    }
    let left = store.usage()?;
    output::line(format!("results removed: {}, {}; left: {}, {}", collected.entries, size(collected.bytes), left.entries, size(left.bytes)))
}

fn verify(mut store: Store, repair: bool, flags: &Flags) -> Result<(), Failure> {
    let mut findings = store.verify(repair)?;
    let sessions = stores::sessions(flags, &store)?;
    if repair {
        let relisted = sessions.relist()?;
        if relisted > 0 {
            let problem = format!("sessions that it did not name: {relisted}");
            findings.push(Finding { part: "history/sessions.jsonl".to_owned(), problem, repair: Some("they are listed again".to_owned()) });
        }
    }
    let mended = repair && findings.iter().all(|finding| finding.repair.is_some());
    if flags.json {
        output::json(&json!({ "store": store.dir(), "findings": findings, "repaired": mended }))?;
    } else if findings.is_empty() {
        output::line(format!("{} is sound", store.dir().display()))?;
    } else {
        let told = |finding: &Finding| {
            let repair =
                finding.repair.as_ref().map(|what| format!(" ({}{what})", if repair { "repaired: " } else { "a repair: " })).unwrap_or_default();
            format!("{}: {}{repair}", finding.part, finding.problem)
        };
        findings.iter().try_for_each(|finding| output::line(told(finding)))?;
    }
    let hurt = findings.iter().filter(|finding| finding.repair.is_some()).count();
    match (hurt, repair) {
        (0, _) | (_, true) => Ok(()),
        (hurt, false) => Err(Failure::new(
            Kind::Store,
            format!(
                "damaged parts: {hurt}; phystalk store verify --repair mends what can be mended and keeps copies of logs in the store's folder backup"
            ),
        )),
    }
}

fn size(bytes: u64) -> String {
    match bytes as f64 {
        b if b < 1e3 => format!("{b:.0} B"),
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.2} GB", b / 1e9),
    }
}

/// `500MB`, `2GB`, `2.5 GB`, `1000000`.
fn parse_size(text: &str) -> Result<u64, String> {
    let expected = || format!("\"{text}\" is not a size: expected a number of B, kB, MB, GB or TB, as 2GB");
    let split = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let factor = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "t" | "tb" => 1e12,
        _ => return Err(expected()),
    };
    let bytes = number.trim().parse::<f64>().ok().map(|n| n * factor).filter(|b| b.is_finite() && *b >= 0.0 && *b < 1e18);
    bytes.map(|b| b as u64).ok_or_else(expected)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!((parse_size("2GB"), parse_size("1.5 kB"), parse_size("7")), (Ok(2_000_000_000), Ok(1500), Ok(7)));
        for bad in ["", "-1", "GB", "1 lightyear", "1e30"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
        assert_eq!((size(999), size(1_500_000), size(2_340_000_000)), ("999 B".to_owned(), "1.5 MB".to_owned(), "2.34 GB".to_owned()));
    }
}
