//! Append-only logs of JSON lines, in which damage is found and costs no more than the damaged lines.
//!
//! A log is `history/NAME.jsonl`. Each line is `{"check", "after", "op"}`: `op` is the operation, `after` the checksum of the
//! line before, `check` a checksum of both, so that an edited byte and a deleted line show. `history/NAME.head` repeats the
//! last line's checksum and the number of lines, so that lines deleted at the end show too. A line is on disk before
//! `append` returns; one that a crash tore at the end is dropped. Lines of format 1 are the bare operation.

use std::io::{self, Read, Seek, SeekFrom, Write};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::folder::Folder;
use super::{Guard, StoreError, fault};

/// The folder of all logs.
pub(super) const HISTORY: &str = "history";

/// What an append-only file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Log<T> {
    /// Its sound operations, oldest first.
    pub lines: Vec<T>,
    /// What is wrong with it, one sentence each; what is named here is not in `lines`.
    pub damage: Vec<String>,
    /// How many lines were lost at least, those that repairs took out included.
    pub lost: usize,
    /// Whether an unfinished last line was dropped.
    pub torn: bool,
}

/// One line as it lies on disk. An edited name of a field is damage too.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line<'a> {
    check: String,
    after: Option<String>,
    #[serde(borrow)]
    op: &'a RawValue,
}

/// What `NAME.head` holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Head {
    /// None where no line is left.
    check: Option<String>,
    lines: usize,
    /// Lines that repairs took out.
    #[serde(default)]
    lost: usize,
}

impl<'a> Line<'a> {
    fn new(after: Option<String>, op: &'a RawValue) -> Line<'a> {
        Line { check: check(after.as_deref(), op), after, op }
    }

    fn is_sound(&self) -> bool {
        self.check == check(self.after.as_deref(), self.op)
    }

    fn to_bytes(&self) -> serde_json::Result<Vec<u8>> {
        let mut bytes = serde_json::to_vec(self)?;
        bytes.push(b'\n');
        Ok(bytes)
    }
}

/// The checksum of an operation and of all before it.
fn check(after: Option<&str>, op: &RawValue) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(after.unwrap_or("start").as_bytes()).update(b"\n").update(op.get().as_bytes());
    hasher.finalize().to_hex()[..32].to_owned()
}

impl Guard {
    /// Adds a line to a log.
    pub fn append(&self, log: &str, operation: &impl Serialize) -> Result<(), StoreError> {
        let history = self.root().make(HISTORY)?;
        let name = file_name(log)?;
        let path = history.path_of(&name);
        let op = serde_json::value::to_raw_value(operation).map_err(|error| StoreError::damaged(&path, error))?;
        let is_new = history.kind(&name)?.is_none();
        let mut file = history.file_or_new(&name)?;
        let (bytes, whole) = read_whole_lines(&mut file).map_err(StoreError::io("read", &path))?;
        let count = lines_of(&bytes[..whole]).count();
        let head = read_head(&history, log).ok().flatten();
        let lost = head.as_ref().map_or(0, |head| head.lost);
        let line = Line::new(last_check(&bytes[..whole], count, head), &op);
        let text = line.to_bytes().map_err(|error| StoreError::damaged(&path, error))?;
        fault::before_write();
        let torn = whole < bytes.len();
        let written = (if torn { file.set_len(whole as u64) } else { Ok(()) })
            .and_then(|()| file.seek(SeekFrom::Start(whole as u64)))
            .and_then(|_| file.write_all(&text))
            .and_then(|()| file.sync_all());
        written.map_err(StoreError::io("written", &path))?;
        if is_new {
            history.sync()?;
        }
        write_head(&history, log, &Head { check: Some(line.check), lines: count + 1, lost })
    }
}

/// Reads a log; one that is not there is empty. No lock is needed: lines are only ever added, and one that another process
/// is adding shows as torn.
pub(super) fn read<T: DeserializeOwned>(root: &Folder, log: &str, old_format: bool) -> Result<Log<T>, StoreError> {
    let name = file_name(log)?;
    let Some(history) = root.folder(HISTORY)? else { return Ok(Log::of_bytes(b"", None, old_format)) };
    // The head first: a line that is added meanwhile is then beyond it, never missing.
    let head = history.read(&head_name(log))?;
    match history.read(&name)? {
        Some(bytes) => Ok(Log::of_bytes(&bytes, head.as_deref(), old_format)),
        None => Ok(Log::of_bytes(b"", None, old_format)),
    }
}

impl<T: DeserializeOwned> Log<T> {
    /// Reads a log from the bytes of its file and of its head, none where that is missing. Anything may be in them.
    pub fn of_bytes(bytes: &[u8], head: Option<&[u8]>, old_format: bool) -> Log<T> {
        let whole = whole_lines(bytes);
        let mut log = Log { lines: Vec::new(), damage: Vec::new(), lost: 0, torn: whole < bytes.len() };
        let mut chain = Chain::Start;
        let mut count = 0;
        for (index, text) in lines_of(&bytes[..whole]).enumerate() {
            count = index + 1;
            match parse(text, old_format) {
                Ok(line) => {
                    if !chain.leads_to(&line) {
                        log.lose(1, format!("lines before line {count} are missing"));
                    }
                    chain = line.check.map_or(Chain::Start, Chain::After);
                    log.lines.push(line.value);
                }
                Err((why, claimed)) => {
                    log.lose(1, format!("line {count}: {why}"));
                    chain = claimed.map_or(Chain::Unknown, Chain::After);
                }
            }
        }
        match head.map(serde_json::from_slice::<Head>) {
            Some(Ok(head)) => {
                log.lost = log.lost.saturating_add(head.lost);
                if head.lines > count {
                    log.lose(head.lines - count, format!("{} lines at the end are missing", head.lines - count));
                }
            }
            Some(Err(error)) => log.damage.push(format!("its head cannot be read: {error}")),
            None => {}
        }
        log
    }
}

impl<T> Log<T> {
    fn lose(&mut self, lines: usize, what: String) {
        self.lost = self.lost.saturating_add(lines);
        self.damage.push(what);
    }
}

/// What the next line has to name as the one before it.
enum Chain {
    Start,
    After(String),
    /// The line before cannot be read.
    Unknown,
}

impl Chain {
    fn leads_to<T>(&self, line: &Sound<T>) -> bool {
        match (self, &line.check) {
            // A bare operation of format 1 names none.
            (_, None) | (Chain::Unknown, _) => true,
            (Chain::Start, Some(_)) => line.after.is_none(),
            (Chain::After(check), Some(_)) => line.after.as_ref() == Some(check),
        }
    }
}

/// A line that is what was written.
struct Sound<T> {
    value: T,
    check: Option<String>,
    after: Option<String>,
}

/// Parses a line; where it is damaged, why, and the checksum that it claims to have.
fn parse<T: DeserializeOwned>(text: &[u8], old_format: bool) -> Result<Sound<T>, (String, Option<String>)> {
    let line = match serde_json::from_slice::<Line<'_>>(text) {
        Ok(line) => line,
        Err(error) => {
            let bare = if old_format { serde_json::from_slice(text).ok() } else { None };
            return bare.map(|value| Sound { value, check: None, after: None }).ok_or((error.to_string(), None));
        }
    };
    if !line.is_sound() {
        return Err(("its checksum differs".to_owned(), Some(line.check)));
    }
    match serde_json::from_str(line.op.get()) {
        Ok(value) => Ok(Sound { value, check: Some(line.check), after: line.after }),
        Err(error) => Err((error.to_string(), Some(line.check))),
    }
}

/// The checksum that a new line follows. Where lines at the end were lost, it is the lost one's: the gap stays visible.
fn last_check(bytes: &[u8], count: usize, head: Option<Head>) -> Option<String> {
    match head {
        Some(head) if head.lines >= count => head.check,
        _ => lines_of(bytes).last().and_then(|text| serde_json::from_slice::<Line<'_>>(text).ok()).map(|line| line.check),
    }
}

/// Rewrites a log so that all its sound lines form one chain; whether that changed it. Of an old format bare lines are taken
/// in and damaged ones stay; else what is damaged goes. The caller keeps a copy.
pub(super) fn relink(history: &Folder, log: &str, old_format: bool) -> Result<bool, StoreError> {
    let name = file_name(log)?;
    let Some(bytes) = history.read(&name)? else { return Ok(false) };
    let path = history.path_of(&name);
    let head = read_head(history, log).ok().flatten();
    let (mut text, mut after, mut count, mut found) = (Vec::new(), None, 0, 0);
    for line in lines_of(&bytes[..whole_lines(&bytes)]) {
        found += 1;
        let op = match serde_json::from_slice::<Line<'_>>(line) {
            Ok(chained) if chained.is_sound() => Some(chained.op),
            Err(_) if old_format => serde_json::from_slice::<&RawValue>(line).ok(),
            Ok(_) | Err(_) => None,
        };
        let Some(op) = op else {
            if old_format {
                text.extend_from_slice(line);
                count += 1;
            }
            continue;
        };
        let line = Line::new(after, op);
        text.extend(line.to_bytes().map_err(|error| StoreError::damaged(&path, error))?);
        after = Some(line.check);
        count += 1;
    }
    if text != bytes {
        history.write(&name, &text)?;
    }
    let lost = head.map_or(0, |head| head.lost.saturating_add(head.lines.saturating_sub(found))).saturating_add(found - count);
    write_head(history, log, &Head { check: after, lines: count, lost })?;
    Ok(text != bytes)
}

/// The names of all logs.
pub(super) fn names(history: &Folder) -> Result<Vec<String>, StoreError> {
    let children = history.children()?;
    Ok(children
        .into_iter()
        .filter_map(|child| child.name.strip_suffix(".jsonl").map(str::to_owned))
        .filter(|name| super::checked(name).is_ok())
        .collect())
}

fn file_name(log: &str) -> Result<String, StoreError> {
    Ok(format!("{}.jsonl", super::checked(log)?))
}

fn head_name(log: &str) -> String {
    format!("{log}.head")
}

fn read_head(history: &Folder, log: &str) -> Result<Option<Head>, StoreError> {
    let name = head_name(log);
    let Some(bytes) = history.read(&name)? else { return Ok(None) };
    serde_json::from_slice(&bytes).map(Some).map_err(|error| StoreError::damaged(&history.path_of(&name), error))
}

fn write_head(history: &Folder, log: &str, head: &Head) -> Result<(), StoreError> {
    let name = head_name(log);
    let bytes = serde_json::to_vec(head).map_err(|error| StoreError::damaged(&history.path_of(&name), error))?;
    history.write(&name, &bytes)
}

/// The bytes of a file and how many of them are whole lines.
fn read_whole_lines(file: &mut std::fs::File) -> io::Result<(Vec<u8>, usize)> {
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    let whole = whole_lines(&bytes);
    Ok((bytes, whole))
}

/// Bytes up to the end of the last whole line.
fn whole_lines(bytes: &[u8]) -> usize {
    bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1)
}

fn lines_of(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    bytes.split_inclusive(|byte| *byte == b'\n')
}
