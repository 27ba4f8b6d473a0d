//! Standard output for results, standard error for remarks. Outside the REPL only this module writes to them, so every text is
//! sanitised here ([`sanitise`]).

use super::exit::{Failure, Kind};
use super::sanitise;
use phystalk::Stop;
use serde::Serialize;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};

/// Writes one line of result.
pub fn line(text: impl Display) -> Result<(), Failure> {
    write_line(&sanitise::text(&text.to_string()))
}

/// Writes one JSON object, over several lines where a person reads it.
pub fn json(value: &impl Serialize) -> Result<(), Failure> {
    if io::stdout().is_terminal() { json_indented(value) } else { json_line(value) }
}

/// Writes one JSON object on one line.
pub fn json_line(value: &impl Serialize) -> Result<(), Failure> {
    write_line(&sanitise::json(&serde_json::to_string(value).map_err(no_json)?))
}

/// Writes one JSON object over several lines.
pub fn json_indented(value: &impl Serialize) -> Result<(), Failure> {
    write_line(&sanitise::json(&serde_json::to_string_pretty(value).map_err(no_json)?))
}

/// JSON is UTF-8, and names of files need not be.
fn no_json(error: serde_json::Error) -> Failure {
    Failure::other(format!("the result cannot be written as JSON: {error}; use names of files in UTF-8, or leave --json out"))
}

fn write_line(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    writeln!(out, "{text}").and_then(|()| out.flush()).map_err(|error| unwritable(&error))
}

/// A closed pipe is no failure: its reader has all it wants, as `head` has. Every other error loses results.
fn unwritable(error: &io::Error) -> Failure {
    match error.kind() {
        io::ErrorKind::BrokenPipe => Failure::silent(Kind::Pipe),
        _ => Failure::other(format!("standard output cannot be written: {error}")),
    }
}

/// Writes a remark. A failed write is ignored: there is no stream left to report it on.
pub fn note(text: impl Display) {
    let _ = writeln!(io::stderr(), "{}", sanitise::text(&text.to_string()));
}

/// Says what failed, with its continuation lines indented.
pub fn error(text: &str) {
    note(format!("error: {}", text.trim_end().replace('\n', "\n  ").replace("\n    ", "\n  ")));
}

/// Prints clap's help, version or error, in clap's colours where the stream is a terminal. The caller escapes the arguments
/// that clap repeats.
pub fn clap(message: &clap::Error) -> Result<(), Failure> {
    let printed = message.print().and_then(|()| io::stdout().flush());
    if message.use_stderr() { Ok(()) } else { printed.map_err(|error| unwritable(&error)) }
}

/// Standard error for the log, which writes whole lines.
pub struct Log;

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        io::stderr().write_all(sanitise::text(&String::from_utf8_lossy(bytes)).as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}

/// Standard output of a command that prints while it runs: the first write that fails stops the run and becomes the
/// command's result.
pub struct Outlet {
    stop: Stop,
    failure: Option<Failure>,
}

impl Outlet {
    /// An outlet that raises `stop` when it fails.
    pub fn new(stop: &Stop) -> Outlet {
        Outlet { stop: stop.clone(), failure: None }
    }

    /// Writes one line of result.
    pub fn line(&mut self, text: impl Display) {
        self.write(|| line(text));
    }

    /// Writes one JSON object on one line.
    pub fn json_line(&mut self, value: &impl Serialize) {
        self.write(|| json_line(value));
    }

    fn write(&mut self, write: impl FnOnce() -> Result<(), Failure>) {
        if self.failure.is_none()
            && let Err(failure) = write()
        {
            self.failure = Some(failure);
            self.stop.raise();
        }
    }

    /// Result of the command: the failed write, else the exit code of its turns.
    pub fn end(self, exit_code: u8) -> Result<(), Failure> {
        self.failure.map_or_else(|| Failure::from_code(exit_code), Err)
    }
}

/// Rows in columns: each as wide as its widest cell, the last one free.
pub fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|r| r.get(column)).map(|c| c.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let render = |row: &Vec<String>| {
        let cells = row.iter().enumerate().map(|(i, cell)| if i + 1 == row.len() { cell.clone() } else { format!("{cell:<w$}", w = widths[i]) });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(render).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::{Path, PathBuf};

    #[test]
    fn columns_align_and_lines_end_clean() {
        let rows = vec![vec!["a".to_owned(), "long cell".to_owned(), "x".to_owned()], vec!["abc".to_owned(), "b".to_owned(), String::new()]];
        assert_eq!(table(&rows), "a    long cell  x\nabc  b");
    }

    #[test]
    fn the_first_failed_write_stops_the_run_and_is_the_result() {
        let stop = Stop::default();
        let mut outlet = Outlet::new(&stop);
        outlet.write(|| Err(unwritable(&io::ErrorKind::StorageFull.into())));
        outlet.write(|| Err(unwritable(&io::ErrorKind::BrokenPipe.into())));
        assert!(stop.raised());
        let failure = outlet.end(130).unwrap_err();
        assert_eq!((failure.kind, failure.message.as_str()), (Kind::Other, "standard output cannot be written: no storage space"));
        let mut outlet = Outlet::new(&Stop::default());
        outlet.write(|| Err(unwritable(&io::ErrorKind::BrokenPipe.into())));
        assert_eq!(outlet.end(130), Err(Failure::silent(Kind::Pipe)));
        assert_eq!(Outlet::new(&Stop::default()).end(7), Err(Failure::silent(Kind::Unstable)));
    }

    /// Files that may name the streams, and why.
    const WRITERS: [(&str, &str); 4] = [
        ("agent/src/cli/output.rs", "the writer"),
        ("agent/src/cli/progress.rs", "indicatif draws the bar; it shows numbers and names of stages"),
        ("agent/src/tui/terminal.rs", "takes the screen; ratatui draws its cells, which draw.rs keeps free of escapes"),
        ("agent/src/preview/terminal.rs", "asks the terminal for kitty graphics, a constant"),
    ];

    /// What a writer would call.
    const CALLS: [&str; 8] = ["stdout", "stderr", "print!", "eprint!", "println!", "eprintln!", "dbg!", "/dev/tty"];

    /// Whether a line of source calls a function or names a path; methods (`Command::stdout`, `child.stdout`) are others'.
    fn names(line: &str, call: &str) -> bool {
        let methods = ["use_stderr()", ".stdout", ".stderr"].iter().fold(line.to_owned(), |line, method| line.replace(method, ""));
        let word = |c: char| c.is_alphanumeric() || c == '_';
        let mut found = methods.match_indices(call);
        found.any(|(at, _)| !methods[..at].ends_with(word) && !methods[at + call.len()..].starts_with(word) && !line.trim_start().starts_with("//"))
    }

    #[test]
    fn nothing_else_writes_to_the_streams() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut files = Vec::new();
        ["agent/src", "src"].iter().for_each(|room| rust_files(&root.join(room), &mut files));
        assert!(files.len() > 100, "the sources were found");
        for file in files {
            let name = file.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
            let is_test = name.contains("/tests") || name.ends_with("tests.rs");
            if is_test || WRITERS.iter().any(|(writer, _)| *writer == name) {
                continue;
            }
            let source = std::fs::read_to_string(&file).unwrap();
            for (number, line) in source.lines().enumerate() {
                let found = CALLS.iter().find(|call| names(line, call) && !line.contains(".is_terminal()"));
                assert_eq!(found, None, "{name}:{}: print through cli::output, which escapes what a terminal would obey", number + 1);
            }
        }
    }

    fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                rust_files(&path, files);
            } else if path.extension().is_some_and(|e| e == "rs") {
                files.push(path);
            }
        }
    }
}
