//! Paths of scenes: from a spec's folder to a place, and back.

use std::path::{Component, Path, PathBuf};

use super::error::{SpecError, SpecErrorKind};
use super::{Spec, SpecError as Error, file_name};

/// Scenes that are part of the program.
const BUILTIN: &str = "builtin:";

impl Spec {
    /// Writes the canonical text whole or not at all. The path of the scene is made relative to the
    /// file's folder, so that both can move together.
    pub fn write(&self, file: &Path) -> Result<(), Error> {
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let text = self.relative_to(folder)?.to_toml();
        crate::store::write_atomic(file, text.as_bytes())
            .map_err(|error| SpecError::new(SpecErrorKind::File, "", format!("{} cannot be written: {error}", file.display())))
    }

    /// The same spec with its scene's path made absolute, from `folder` where it is not yet.
    pub fn absolute_from(mut self, folder: &Path) -> Result<Spec, Error> {
        self.scene.file = absolute(&self.scene.file, folder)?;
        Ok(self)
    }

    /// The same spec with its scene's path as it reads from `folder`.
    pub fn relative_to(&self, folder: &Path) -> Result<Spec, Error> {
        let mut spec = self.clone();
        spec.scene.file = relative(&self.scene.file, folder)?;
        Ok(spec)
    }
}

/// The absolute form of a scene's path that was written in `folder`.
fn absolute(file: &str, folder: &Path) -> Result<String, SpecError> {
    if file.starts_with(BUILTIN) {
        return Ok(file.to_owned());
    }
    let joined = folder.join(file_name::decode(file));
    let whole = std::path::absolute(&joined).map_err(|error| not_a_path(&joined, &error.to_string()))?;
    Ok(text(&real(&whole)))
}

/// An absolute path as it reads from `folder`; unchanged where there is no way between them.
fn relative(file: &str, folder: &Path) -> Result<String, SpecError> {
    let path = file_name::decode(file);
    if file.starts_with(BUILTIN) || !path.is_absolute() {
        return Ok(file.to_owned());
    }
    let target = real(&path);
    let folder = real(&std::path::absolute(folder).map_err(|error| not_a_path(folder, &error.to_string()))?);
    let shared = target.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    // Two drives share nothing.
    if !matches!(target.components().next(), Some(first) if shared > 0 && folder.components().next() == Some(first)) {
        return Ok(text(&target));
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    Ok(text(&up.chain(target.components().skip(shared)).collect::<PathBuf>()))
}

/// An absolute path without links: those of the part that exists are followed, the rest is taken as
/// it is named.
fn real(path: &Path) -> PathBuf {
    let tidied = tidy(path);
    let existing = tidied.ancestors().find_map(|front| Some((front, std::fs::canonicalize(front).ok()?)));
    match existing {
        Some((front, real)) => tidied
            .strip_prefix(front)
            .map_or_else(|_| tidied.clone(), |rest| if rest.as_os_str().is_empty() { real.clone() } else { real.join(rest) }),
        None => tidied,
    }
}

/// Resolves `.` and `..` by name alone.
fn tidy(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}

/// As text with forward slashes, which every system reads.
fn text(path: &Path) -> String {
    let text = file_name::encode(path);
    if cfg!(windows) { text.replace('\\', "/") } else { text }
}

fn not_a_path(path: &Path, why: &str) -> SpecError {
    SpecError::new(SpecErrorKind::File, "scene.file", format!("{}: {why}", path.display()))
}
