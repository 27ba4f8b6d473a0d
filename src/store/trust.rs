//! The list of stores that a user made or accepted, in the user's state directory.
//!
//! A store is found by walking up, so a cloned repository or a shared folder can bring one along. Only a store on this
//! list is used, as git does with `safe.directory`. An entry is the store's folder and its identity, a random number that
//! lies in the store: a store that is put in the place of another one is not the same.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// The list, one JSON line a store. Only its user can read and write it.
#[derive(Clone, Debug)]
pub struct AcceptedStores {
    file: PathBuf,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Accepted {
    /// The folder, its links resolved; bytes that are not UTF-8 as `%XX`.
    dir: String,
    id: String,
}

impl AcceptedStores {
    /// The list of this user: `$XDG_STATE_HOME/phystalk/stores.jsonl`, by default in `~/.local/state`. None where the
    /// environment names no home.
    pub fn of_user() -> Option<AcceptedStores> {
        let folder = |variable: &str| std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute());
        let home = || folder(if cfg!(windows) { "USERPROFILE" } else { "HOME" }).map(|home| home.join(".local/state"));
        let state = folder("XDG_STATE_HOME").or_else(|| if cfg!(windows) { folder("LOCALAPPDATA") } else { None }).or_else(home)?;
        Some(AcceptedStores { file: state.join("phystalk").join("stores.jsonl") })
    }

    /// A list in a file of its own.
    pub fn in_file(file: PathBuf) -> AcceptedStores {
        AcceptedStores { file }
    }

    /// Where the list lies.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Whether a store is on the list. A line that cannot be read accepts nothing.
    pub fn holds(&self, dir: &Path, id: &str) -> io::Result<bool> {
        match fs::read(&self.file) {
            Ok(bytes) => Ok(lists(&bytes, &Accepted { dir: encoded(dir), id: id.to_owned() })),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// Puts a store on the list.
    pub fn add(&self, dir: &Path, id: &str) -> io::Result<()> {
        if let Some(folder) = self.file.parent() {
            private_folders(folder)?;
        }
        let mut options = File::options();
        options.create(true).read(true).append(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let mut file = options.open(&self.file)?;
        file.lock()?;
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(0))?;
        file.read_to_end(&mut bytes)?;
        let accepted = Accepted { dir: encoded(dir), id: id.to_owned() };
        if lists(&bytes, &accepted) {
            return Ok(());
        }
        // A line that a crash tore does not swallow the new one.
        let mut line = if bytes.last().is_some_and(|last| *last != b'\n') { b"\n".to_vec() } else { Vec::new() };
        line.extend(serde_json::to_vec(&accepted)?);
        line.push(b'\n');
        file.write_all(&line)?;
        file.sync_all()
    }
}

fn lists(bytes: &[u8], wanted: &Accepted) -> bool {
    bytes.split(|byte| *byte == b'\n').any(|line| serde_json::from_slice::<Accepted>(line).is_ok_and(|listed| listed == *wanted))
}

/// A path as text, reversibly.
fn encoded(dir: &Path) -> String {
    let mut text = String::new();
    for chunk in dir.as_os_str().as_encoded_bytes().utf8_chunks() {
        text.push_str(&chunk.valid().replace('%', "%25"));
        chunk.invalid().iter().for_each(|byte| text.push_str(&format!("%{byte:02X}")));
    }
    text
}

/// Makes folders that only their user can enter.
pub(super) fn private_folders(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_store_is_listed_by_its_folder_and_its_identity() {
        let home = tempfile::tempdir().unwrap();
        let list = AcceptedStores { file: home.path().join("a/b/stores.jsonl") };
        let dir = Path::new("/srv/100%/x");
        assert!(!list.holds(dir, "1").unwrap());
        list.add(dir, "1").unwrap();
        list.add(dir, "1").unwrap();
        assert!(list.holds(dir, "1").unwrap() && !list.holds(dir, "2").unwrap() && !list.holds(Path::new("/srv"), "1").unwrap());
        assert_eq!(fs::read_to_string(list.file()).unwrap().lines().count(), 1);
        fs::write(list.file(), b"{\"dir\": tor").unwrap();
        assert!(!list.holds(dir, "1").unwrap());
        list.add(dir, "1").unwrap();
        assert!(list.holds(dir, "1").unwrap(), "a damaged line costs one line");
    }

    #[cfg(unix)]
    #[test]
    fn only_its_user_can_read_the_list() {
        use std::os::unix::fs::PermissionsExt;
        let home = tempfile::tempdir().unwrap();
        let list = AcceptedStores { file: home.path().join("state/stores.jsonl") };
        list.add(Path::new("/a"), "1").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!((mode(list.file()), mode(list.file().parent().unwrap())), (0o600, 0o700));
    }
}
