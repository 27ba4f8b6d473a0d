//! What is wrong with the text of an expression, and where.

use std::fmt;

/// A fault at a character.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Which character, from 1; 0 for the text as a whole.
    pub at: usize,
    /// What is there.
    pub found: String,
    /// What would be right.
    pub expected: String,
    /// The name that was probably meant.
    pub nearest: Option<String>,
}

impl Fault {
    pub(super) fn new(at: usize, found: impl Into<String>, expected: impl Into<String>) -> Fault {
        Fault { at, found: found.into(), expected: expected.into(), nearest: None }
    }

    /// A fault of the text as a whole.
    pub(super) fn whole(found: impl Into<String>, expected: impl Into<String>) -> Fault {
        Fault::new(0, found, expected)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.at > 0 {
            write!(out, "character {}: ", self.at)?;
        }
        write!(out, "{}", self.found)?;
        match &self.nearest {
            Some(nearest) => write!(out, "; did you mean `{nearest}`?"),
            None => write!(out, " where {} is expected", self.expected),
        }
    }
}

impl std::error::Error for Fault {}
