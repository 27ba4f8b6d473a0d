//! The folder that a session's files go to, and whose it is: `session.json` in it names the session.

use crate::cli::exit::Failure;
use phystalk::export::remove_leftovers;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Names the owner of an output folder.
const OWNER: &str = "session.json";

/// Whose files a folder holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Owner {
    /// Identity of the store.
    pub store: String,
    /// Name of the session.
    pub session: String,
    /// The command that made it.
    pub command: String,
}

impl Owner {
    /// Whether both are one session, whatever command it was gone on with.
    fn is(&self, other: &Owner) -> bool {
        (&self.store, &self.session) == (&other.store, &other.session)
    }
}

/// The output folder of one session.
#[derive(Clone, Debug)]
pub struct OutputFolder {
    dir: PathBuf,
    owner: Owner,
    replace: bool,
}

impl OutputFolder {
    /// A session's folder; refused where it holds files of another one, unless they may be replaced. Nothing is made yet.
    pub fn open(dir: PathBuf, owner: Owner, replace: bool) -> Result<OutputFolder, Failure> {
        check(&dir, Some(&owner), &owner.command, replace)?;
        Ok(OutputFolder { dir, owner, replace })
    }

    /// Makes it the session's, before the first file is written.
    pub fn claim(&self) -> Result<(), Failure> {
        check(&self.dir, Some(&self.owner), &self.owner.command, self.replace)?;
        claim(&self.dir, &self.owner)
    }

    /// Where the files of a version go.
    pub fn version(&self, name: &str) -> PathBuf {
        self.dir.join(name)
    }
}

/// What a folder holds before anything is written to it.
#[derive(Debug, PartialEq, Eq)]
enum Held {
    Nothing,
    By(Owner),
    /// Versions of nobody knows which session.
    Unnamed,
}

/// Refuses a folder that holds files of another session, before anything is made for them; `None` is a session yet to start.
pub fn check(dir: &Path, owner: Option<&Owner>, command: &str, replace: bool) -> Result<(), Failure> {
    let held = held(dir)?;
    let own = match &held {
        Held::Nothing => true,
        Held::By(found) => owner.is_some_and(|owner| found.is(owner)) || (command == "demo" && found.command == "demo"),
        Held::Unnamed => false,
    };
    if own || replace {
        return Ok(());
    }
    let whose = match &held {
        Held::By(found) => format!("files of another session ({})", found.session),
        _ => "files of another session".to_owned(),
    };
    Err(Failure::other(format!(
        "{} holds {whose}: nothing was written\nname another folder with --out, or replace them with --replace",
        dir.display()
    )))
}

/// Makes a folder an owner's: files of another session are removed, after [`check`] let that pass. What killed runs left
/// unfinished in it goes too.
fn claim(dir: &Path, owner: &Owner) -> Result<(), Failure> {
    let failed = |error: io::Error| unusable(dir, &error);
    fs::create_dir_all(dir).map_err(failed)?;
    match held(dir)? {
        Held::By(found) if found.is(owner) => {}
        Held::Nothing => write(dir, owner).map_err(failed)?,
        Held::By(_) | Held::Unnamed => {
            for version in versions(dir)? {
                remove_version(&version).map_err(|error| Failure::file("replace", &version, &error))?;
            }
            let _ = fs::remove_file(dir.join(OWNER));
            write(dir, owner).map_err(failed)?;
        }
    }
    for version in versions(dir)? {
        remove_leftovers(&version);
        remove_leftovers(&version.join("frames"));
    }
    Ok(())
}

fn unusable(dir: &Path, error: &io::Error) -> Failure {
    Failure::other(format!("{} cannot be written to: {error}\nname another folder with --out", dir.display()))
}

/// Of two sessions that start at once, one gets the folder.
fn write(dir: &Path, owner: &Owner) -> io::Result<()> {
    let mut file = fs::File::create_new(dir.join(OWNER))?;
    file.write_all(&serde_json::to_vec(owner)?)?;
    file.write_all(b"\n")
}

fn held(dir: &Path) -> Result<Held, Failure> {
    match fs::read(dir.join(OWNER)) {
        Ok(bytes) => Ok(serde_json::from_slice(&bytes).map_or(Held::Unnamed, Held::By)),
        Err(_) if versions(dir)?.is_empty() => Ok(Held::Nothing),
        Err(_) => Ok(Held::Unnamed),
    }
}

/// Folders in it that hold a version: `v1`, `v2`, ….
fn versions(dir: &Path) -> Result<Vec<PathBuf>, Failure> {
    let listing = match fs::read_dir(dir) {
        Ok(listing) => listing,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(unusable(dir, &error)),
    };
    let is_version = |name: &str| name.strip_prefix('v').is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()));
    let folders = listing.filter_map(Result::ok).filter(|child| child.file_type().is_ok_and(|kind| kind.is_dir()));
    Ok(folders.filter(|child| child.file_name().to_str().is_some_and(is_version)).map(|child| child.path()).collect())
}

/// Removes the files that a version is made of, and the folders where nothing else is in them.
fn remove_version(version: &Path) -> io::Result<()> {
    let frames = version.join("frames");
    let is_frame = |name: &str| name.strip_suffix(".png").is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()));
    if let Ok(listing) = fs::read_dir(&frames) {
        for child in listing.filter_map(Result::ok).filter(|child| child.file_name().to_str().is_some_and(is_frame)) {
            fs::remove_file(child.path())?;
        }
    }
    for name in ["spec.toml", "plan.json", "metrics.json", "contact.png", "preview.webp"] {
        match fs::remove_file(version.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    // A folder that holds something else stays with it.
    let _ = fs::remove_dir(frames);
    let _ = fs::remove_dir(version);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn owner(session: &str) -> Owner {
        Owner { store: "a".into(), session: session.into(), command: "exec".into() }
    }

    #[test]
    fn a_folder_is_its_first_sessions_until_it_is_replaced() {
        let home = tempfile::tempdir().unwrap();
        let dir = home.path().join("out");
        check(&dir, None, "exec", false).unwrap();
        assert!(!dir.exists(), "a check makes nothing");
        claim(&dir, &owner("s1")).unwrap();
        fs::create_dir_all(dir.join("v1/frames")).unwrap();
        for name in ["v1/spec.toml", "v1/frames/0000.png", "v1/frames/notes.txt", "letter.txt"] {
            fs::write(dir.join(name), b"dear").unwrap();
        }
        check(&dir, Some(&owner("s1")), "exec", false).unwrap();
        for other in [None, Some(&owner("s2"))] {
            let refused = check(&dir, other, "exec", false).unwrap_err().message;
            assert!(refused.contains("(s1)") && refused.contains("--replace"), "{refused}");
        }
        assert!(check(&dir, None, "demo", false).is_err());
        claim(&dir, &owner("s2")).unwrap();
        assert!(!dir.join("v1/spec.toml").exists() && !dir.join("v1/frames/0000.png").exists());
        assert!(dir.join("v1/frames/notes.txt").exists() && dir.join("letter.txt").exists(), "what is not ours stays");
        check(&dir, Some(&owner("s2")), "exec", false).unwrap();
    }

    #[test]
    fn versions_of_an_unknown_session_are_not_replaced_and_the_demo_replaces_its_own() {
        let home = tempfile::tempdir().unwrap();
        fs::create_dir_all(home.path().join("v3")).unwrap();
        assert!(check(home.path(), None, "exec", false).is_err());
        check(home.path(), None, "exec", true).unwrap();
        claim(home.path(), &Owner { command: "demo".into(), ..owner("s1") }).unwrap();
        check(home.path(), None, "demo", false).unwrap();
        assert!(check(home.path(), None, "exec", false).is_err());
    }
}
