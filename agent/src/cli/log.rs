//! `phystalk log`: the versions of a session.

use super::exit::Failure;
use super::flags::Flags;
use super::{output, stores};
use crate::history::Session;
use serde_json::json;

pub fn run(flags: &Flags) -> Result<(), Failure> {
    let (_, session) = stores::session(flags)?;
    if flags.json {
        return output::json(&json!({
            "session": session.name(), "scene": session.base().scene.file, "head": session.head().map(|v| &v.name), "versions": session.versions(),
        }));
    }
    output::line(text(&session))
}

/// One line a version, the newest last.
pub fn text(session: &Session) -> String {
    let head = session.head().map(|v| v.name.as_str());
    let row = |v: &crate::history::Version| {
        let here = if Some(v.name.as_str()) == head { "*" } else { " " };
        let from = v.parent.as_ref().map(|p| format!("<- {p}")).unwrap_or_default();
        let what = if v.note.is_empty() { v.words.clone() } else { format!("{} ({})", v.words, v.note) };
        let run = if v.resolved.is_none() { "(not run to its end)".to_owned() } else { String::new() };
        vec![format!("{here} {}", v.name), from, what, run]
    };
    let rows: Vec<Vec<String>> = session.versions().iter().map(row).collect();
    let title = format!("session {}: {}", session.name(), session.base().scene.file);
    if rows.is_empty() { format!("{title}\n  no version yet") } else { format!("{title}\n{}", output::table(&rows)) }
}
