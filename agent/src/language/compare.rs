//! "Compare v1 with the first", "what changed": versions by their names, before anything is read as a request for the scene.

use super::VersionRef;
use super::tokens::Token;

/// Words that ask for a comparison.
const ASKS: &[&str] = &["compare", "compared", "comparison", "diff", "difference", "differences"];
/// Words that say nothing of which versions.
const SMALL: &[&str] = &[
    "a", "against", "an", "and", "are", "at", "between", "by", "can", "could", "did", "do", "does", "from", "has", "have", "how", "i", "in", "is",
    "it", "let", "lets", "me", "ok", "of", "on", "one", "please", "run", "see", "session", "show", "side", "since", "so", "than", "that", "the",
    "then", "these", "time", "to", "turn", "two", "us", "version", "versions", "versus", "vs", "was", "we", "what", "whats", "with", "you", ",", ";",
];

/// The two versions that a request compares, or why they are not known; none where it asks for something else.
pub fn understand(tokens: &[Token]) -> Option<Result<(VersionRef, VersionRef), String>> {
    let word = |i: usize| tokens.get(i).map_or("", |t| t.word.as_str());
    let what = matches!(word(0), "what" | "whats") && tokens.iter().any(|t| matches!(t.word.as_str(), "changed" | "different" | "changes"));
    if !what && !tokens.iter().any(|t| ASKS.contains(&t.word.as_str())) {
        return None;
    }
    let mut named = Vec::new();
    for (i, token) in tokens.iter().enumerate() {
        match version(tokens, i) {
            Some(versions) => named.extend(versions),
            None if SMALL.contains(&token.word.as_str()) || ASKS.contains(&token.word.as_str()) => {}
            None if what && matches!(token.word.as_str(), "changed" | "different" | "changes") => {}
            None => {
                let text = &token.text;
                return Some(Err(format!(
                    "\"{text}\" is no version to compare with: \"compare v1 with v3\", \"compare with the first\", \"compare with before\""
                )));
            }
        }
    }
    Some(match named[..] {
        [] | [VersionRef::Last] => Ok((VersionRef::Previous, VersionRef::Last)),
        [one] => Ok((one, VersionRef::Last)),
        [from, to] => Ok((from, to)),
        _ => Err("two versions are compared at a time: \"compare v1 with v3\"".to_owned()),
    })
}

/// The versions that a token names.
fn version(tokens: &[Token], i: usize) -> Option<Vec<VersionRef>> {
    let (token, next) = (&tokens[i], tokens.get(i + 1).map_or("", |t| t.word.as_str()));
    let number = token.number.or_else(|| token.word.strip_prefix('v')?.parse().ok()).filter(|n| n.fract() == 0.0 && (1.0..1e6).contains(n));
    if let Some(number) = number {
        return Some(vec![VersionRef::Number(number as u32)]);
    }
    Some(match token.word.as_str() {
        "first" | "original" | "beginning" | "start" | "initial" => vec![VersionRef::First],
        "second" => vec![VersionRef::Number(2)],
        "third" => vec![VersionRef::Number(3)],
        "fourth" => vec![VersionRef::Number(4)],
        "fifth" => vec![VersionRef::Number(5)],
        // "The last two"
        "last" if next == "two" => vec![VersionRef::Previous, VersionRef::Last],
        "last" | "latest" | "newest" | "current" | "present" | "after" | "this" => vec![VersionRef::Last],
        // "Now compare them" is no version.
        "now" if i > 0 => vec![VersionRef::Last],
        "now" => Vec::new(),
        "before" | "previous" | "earlier" | "prior" | "old" => vec![VersionRef::Previous],
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokenise;
    use super::VersionRef::{First, Last, Number, Previous};
    use super::*;

    #[test]
    fn versions_are_compared_by_what_they_are_called() {
        let of = |text: &str| understand(&tokenise(text));
        for (text, pair) in [
            ("compare v1 with the first", (Number(1), First)),
            ("compare the first and the last", (First, Last)),
            ("compare with before", (Previous, Last)),
            ("compare this with the first one, please", (Last, First)),
            ("now compare it with version 2", (Number(2), Last)),
            ("compare the last two versions", (Previous, Last)),
            ("what changed?", (Previous, Last)),
            ("what has changed since v1?", (Number(1), Last)),
            ("what is the difference between v1 and v3?", (Number(1), Number(3))),
            ("diff", (Previous, Last)),
        ] {
            assert_eq!(of(text), Some(Ok(pair)), "{text}");
        }
        assert!(matches!(of("compare it with steel"), Some(Err(reason)) if reason.contains("steel")));
        assert!(matches!(of("compare v1, v2 and v3"), Some(Err(_))));
        assert_eq!(of("make it jump like before"), None);
    }
}
