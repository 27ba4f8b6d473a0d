//! Results on standard output, remarks on standard error.

use super::exit::Failure;
use serde::Serialize;
use std::io::{IsTerminal, Write};

/// Writes one line of result. A reader that went away ends the program quietly.
pub fn line(text: impl std::fmt::Display) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{text}")?;
    Ok(out.flush()?)
}

/// Writes one JSON object, over several lines where a person reads it.
pub fn json(value: &impl Serialize) -> Result<(), Failure> {
    let text = if std::io::stdout().is_terminal() { serde_json::to_string_pretty(value) } else { serde_json::to_string(value) };
    line(text.map_err(Failure::other)?)
}

/// Says something beside the result.
pub fn note(text: impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Says what failed, with its continuation lines indented.
pub fn error(text: &str) {
    note(format!("error: {}", text.trim_end().replace('\n', "\n  ").replace("\n    ", "\n  ")));
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

    #[test]
    fn columns_align_and_lines_end_clean() {
        let rows = vec![vec!["a".to_owned(), "long cell".to_owned(), "x".to_owned()], vec!["abc".to_owned(), "b".to_owned(), String::new()]];
        assert_eq!(table(&rows), "a    long cell  x\nabc  b");
    }
}
