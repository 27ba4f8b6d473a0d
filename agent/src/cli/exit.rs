//! Kinds of failure and their exit codes: the only place where one becomes the other.

use std::fmt::Display;
use std::io;

/// What went wrong, as scripts tell it apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The reader of our output went away; nothing to say, nothing failed.
    Pipe,
    /// A missing or unreadable scene, a turn not understood, no such version, a difference found.
    Other,
    /// The command line.
    Usage,
    /// A spec or a `--set`.
    Spec,
    /// No language model, or no key for it.
    NoModel,
    /// No adapter, device lost, out of memory.
    Device,
    /// The simulation could not be kept stable.
    Unstable,
    /// A store that the user has not accepted.
    Approval,
    /// The store is damaged, newer than the program, or locked.
    Store,
    /// An expectation or a golden image failed.
    Expectation,
    /// A bug of the program.
    Bug,
    /// SIGINT.
    Interrupted,
    /// SIGTERM or SIGHUP.
    Terminated,
}

/// Every kind, for turning a code back into one.
const KINDS: [Kind; 13] = [
    Kind::Pipe,
    Kind::Other,
    Kind::Usage,
    Kind::Spec,
    Kind::NoModel,
    Kind::Device,
    Kind::Unstable,
    Kind::Approval,
    Kind::Store,
    Kind::Expectation,
    Kind::Bug,
    Kind::Interrupted,
    Kind::Terminated,
];

impl Kind {
    /// The process's exit code.
    pub fn code(self) -> u8 {
        match self {
            Kind::Pipe => 0,
            Kind::Other => 1,
            Kind::Usage => 2,
            Kind::Spec => 3,
            Kind::NoModel => 4,
            Kind::Device => 6,
            Kind::Unstable => 7,
            Kind::Approval => 9,
            Kind::Store => 10,
            Kind::Expectation => 11,
            Kind::Bug => 70,
            Kind::Interrupted => 130,
            Kind::Terminated => 143,
        }
    }
}

/// A failure in the user's words: what, where, what was expected, what to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Decides the exit code.
    pub kind: Kind,
    /// Empty where everything was already said.
    pub message: String,
}

impl Failure {
    /// A failure with its message.
    pub fn new(kind: Kind, message: impl Display) -> Failure {
        Failure { kind, message: message.to_string() }
    }

    /// One whose reason was already printed.
    pub fn silent(kind: Kind) -> Failure {
        Failure { kind, message: String::new() }
    }

    /// The end of a turn whose failure was already told; nothing where the code is 0.
    pub fn from_code(code: u8) -> Result<(), Failure> {
        match code {
            0 => Ok(()),
            code => Err(Failure::silent(KINDS.into_iter().find(|k| k.code() == code).unwrap_or(Kind::Other))),
        }
    }

    /// A failure of no special kind.
    pub fn other(message: impl Display) -> Failure {
        Failure::new(Kind::Other, message)
    }

    /// A file or folder that could not be used.
    pub fn file(doing: &str, path: &std::path::Path, error: &io::Error) -> Failure {
        Failure::other(format!("cannot {doing} {}: {error}", path.display()))
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Failure {
        Failure::other(error)
    }
}

impl From<phystalk::gpu::GpuError> for Failure {
    fn from(error: phystalk::gpu::GpuError) -> Failure {
        Failure::new(Kind::Device, error)
    }
}

impl From<phystalk::scene::SceneError> for Failure {
    fn from(error: phystalk::scene::SceneError) -> Failure {
        let kind = match error {
            phystalk::scene::SceneError::Memory { .. } => Kind::Device,
            _ => Kind::Other,
        };
        Failure::new(kind, error)
    }
}

impl From<phystalk::export::ExportError> for Failure {
    fn from(error: phystalk::export::ExportError) -> Failure {
        Failure::other(error)
    }
}

impl From<phystalk::spec::SpecError> for Failure {
    fn from(error: phystalk::spec::SpecError) -> Failure {
        let kind = match error.kind {
            phystalk::spec::SpecErrorKind::File => Kind::Other,
            _ => Kind::Spec,
        };
        Failure::new(kind, error)
    }
}

impl From<phystalk::store::StoreError> for Failure {
    fn from(error: phystalk::store::StoreError) -> Failure {
        let kind = if matches!(error, phystalk::store::StoreError::NotAccepted { .. }) { Kind::Approval } else { Kind::Store };
        Failure::new(kind, error)
    }
}

impl From<phystalk::stages::EngineError> for Failure {
    fn from(error: phystalk::stages::EngineError) -> Failure {
        use phystalk::stages::EngineError as E;
        match error {
            E::Scene(error) => error.into(),
            E::Spec(error) => error.into(),
            E::Gpu(error) => error.into(),
            E::Store(error) => error.into(),
            E::Unstable(_) | E::TooLarge { .. } | E::Scale(_) => Failure::new(Kind::Unstable, error),
            E::Thread(_) | E::Proxy { .. } | E::Empty { .. } | E::SceneChanged { .. } => Failure::other(error),
        }
    }
}

impl From<crate::history::HistoryError> for Failure {
    fn from(error: crate::history::HistoryError) -> Failure {
        use crate::history::HistoryError as E;
        match error {
            E::Store(error) => error.into(),
            E::Spec(error) => error.into(),
            E::BadName { .. } => Failure::new(Kind::Usage, error),
            other => Failure::other(other),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_distinct_and_lead_back() {
        for kind in KINDS {
            let back = Failure::from_code(kind.code());
            assert_eq!(back.err().map_or(Kind::Pipe, |f| f.kind), kind);
        }
    }
}
