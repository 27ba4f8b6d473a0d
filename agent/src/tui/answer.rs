//! Questions that the store answers, even while a run goes on.

use super::app::Question;
use crate::cli::exit::Failure;
use crate::history::{Session, Sessions};

/// The answer as text.
pub fn answer(question: &Question, sessions: &Sessions, session: &str) -> Result<String, Failure> {
    let session = sessions.open(Some(session))?;
    match question {
        Question::Log => Ok(crate::cli::log::text(&session)),
        Question::Spec(None) => Ok(session.spec().to_toml().trim_end().to_owned()),
        Question::Spec(Some(path)) => {
            let part = session.spec().part_to_toml(path);
            part.ok_or_else(|| Failure::other(format!("there is no {path} in the spec; /spec shows all of it")))
        }
        Question::Diff(a, b) => diff(&session, a.as_deref(), b.as_deref()),
    }
}

/// Two versions; one against the newest; or the newest against the one before it.
fn diff(session: &Session, a: Option<&str>, b: Option<&str>) -> Result<String, Failure> {
    let head = session.head().ok_or_else(|| Failure::other("there is no version yet"))?;
    let (from, to) = match (a, b) {
        (Some(a), Some(b)) => (a.to_owned(), b.to_owned()),
        (Some(a), None) => (a.to_owned(), head.name.clone()),
        (None, _) => {
            let before = session.versions().iter().rev().nth(1).map(|v| v.name.clone());
            (before.ok_or_else(|| Failure::other("there is only one version yet"))?, head.name.clone())
        }
    };
    let spec = |name: &str| -> Result<_, Failure> { Ok(session.spec_of(&session.find(name)?.name.clone())?) };
    let changes = spec(&from)?.diff(&spec(&to)?);
    let lines: Vec<String> = changes.iter().map(ToString::to_string).collect();
    Ok(if lines.is_empty() { format!("{from} and {to} are the same") } else { format!("{from} -> {to}\n{}", lines.join("\n")) })
}
