//! Logs of the store, as sessions keep them: chained lines and the head beside them.

use crate::target::{Target, class};
use phystalk::store::{Log, Store};
use serde_json::{Value, json};

/// A head, a line break, then the log.
pub struct SessionLog;

/// Operations of the seeds: whatever a damaged log holds, nothing else is ever read from it.
fn operations() -> Vec<Value> {
    let version =
        |number: u32| json!({ "op": "version", "number": number, "how": "edit", "words": "softer", "edits": [{ "op": "set", "path": "seed" }] });
    (0..6).map(|number| if number % 3 == 0 { json!({ "op": "camera", "eye_m": [0.1, 1e-9, f64::from(number)] }) } else { version(number) }).collect()
}

/// A log of so many operations, as the store writes it.
fn written(count: usize) -> std::io::Result<Vec<u8>> {
    let folder = tempfile::tempdir()?;
    let store = Store::open(&folder.path().join("store")).map_err(std::io::Error::other)?;
    for operation in operations().iter().take(count) {
        store.lock().and_then(|guard| guard.append("log", operation)).map_err(std::io::Error::other)?;
    }
    let read = |name: &str| std::fs::read(store.dir().join("history").join(name));
    Ok([read("log.head")?, b"\n".to_vec(), read("log.jsonl")?].concat())
}

impl Target for SessionLog {
    fn name(&self) -> &'static str {
        "log"
    }

    fn seeds(&self) -> Vec<Vec<u8>> {
        let bare: Vec<u8> = operations().iter().flat_map(|operation| format!("{operation}\n").into_bytes()).collect();
        [1, 2, 6].into_iter().filter_map(|count| written(count).ok()).chain([bare, b"{}\n\n\n{\"check\":1}\n".to_vec()]).collect()
    }

    fn dictionary(&self) -> Vec<&'static [u8]> {
        let words =
            ["\n", "\"check\":", "\"after\":", "null", "\"op\":", "{", "}", "\"lines\":", "99999999999999999999", "\"lost\":", "[[[[[[[[", "\\u0000"];
        words.map(str::as_bytes).to_vec()
    }

    fn memory(&self, input_bytes: usize) -> usize {
        (1 << 20) + 256 * input_bytes
    }

    fn run(&self, input: &[u8]) -> Result<String, String> {
        let split = input.iter().position(|byte| *byte == b'\n').unwrap_or(input.len());
        let (head, log) = (&input[..split], input.get(split + 1..).unwrap_or_default());
        let read = Log::<Value>::of_bytes(log, Some(head), false);
        let known = operations();
        if let Some(forged) = read.lines.iter().find(|line| !known.contains(line)) {
            return Err(format!("an operation that nobody wrote was read: {forged}"));
        }
        let whole = log.iter().filter(|byte| **byte == b'\n').count();
        if read.lines.len() > whole || (read.lines.len() < whole && read.damage.is_empty()) {
            return Err(format!("{} of {whole} lines were read, and {} faults reported", read.lines.len(), read.damage.len()));
        }
        let old = Log::<Value>::of_bytes(log, Some(head), true);
        let classes: Vec<String> = read.damage.iter().take(3).map(|sentence| class(sentence)).collect();
        Ok(format!("{} lines {} old {}", read.lines.len(), classes.join("; "), old.lines.len()))
    }
}
