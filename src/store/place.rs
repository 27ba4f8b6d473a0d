//! Where a store is, whose it is, and what may be done with it, known before anything in it is touched.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::folder::{Folder, Kind};
use super::trust::{AcceptedStores, private_folders};
use super::{FORMAT, PARTS, Store, StoreError};

/// The folder that is looked for, walking up.
pub const FOLDER: &str = ".phystalk";
/// Names the layout: a number.
pub(super) const FORMAT_FILE: &str = "format";
/// Tells a store from every other one: 32 hexadecimal digits.
pub(super) const ID_FILE: &str = "id";

/// A store that was found and not yet opened.
#[derive(Clone, Debug)]
pub struct Place {
    pub(super) root: Folder,
    pub(super) id: Option<String>,
    pub(super) format: Format,
}

/// What the file `format` says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// This program's.
    Current,
    /// An older one, which opening migrates.
    Old(u32),
    /// It cannot be told: why.
    Damaged(String),
}

impl Place {
    /// The store nearest above a folder, its own `.phystalk` included; none where there is none.
    pub fn above(cwd: &Path) -> Result<Option<Place>, StoreError> {
        for folder in cwd.ancestors() {
            let dir = folder.join(FOLDER);
            if fs::symlink_metadata(&dir).is_ok()
                && let Some(place) = Place::at(&dir)?
            {
                return Ok(Some(place));
            }
        }
        Ok(None)
    }

    /// The store in a folder; none where the folder is missing or empty.
    pub fn at(dir: &Path) -> Result<Option<Place>, StoreError> {
        // Links on the way to a store are resolved here, once; below it none is followed.
        let dir = match fs::canonicalize(dir) {
            Ok(dir) => dir,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(StoreError::io("opened", dir)(error)),
        };
        let root = Folder::root(&dir).map_err(StoreError::io("opened", &dir))?;
        let children = root.children()?;
        let has = |names: &[&str]| children.iter().any(|child| names.contains(&child.name.as_str()));
        if !has(&[FORMAT_FILE, ID_FILE, "history"]) {
            let began = |name: &str| super::folder::is_temporary(name) || [".gitignore", "lock"].contains(&name);
            return if children.iter().all(|child| began(&child.name)) { Ok(None) } else { Err(StoreError::NotAStore { dir }) };
        }
        for (name, kind) in PARTS {
            check(&root, name, kind)?;
        }
        let format = read_format(&root)?;
        let id = root.read(ID_FILE)?.and_then(|bytes| String::from_utf8(bytes).ok()).map(|text| text.trim().to_owned());
        Ok(Some(Place { root, id: id.filter(|id| is_id(id)), format }))
    }

    /// Makes a store in a folder that is missing or empty; only its user can enter a folder that is made here.
    pub fn make(dir: &Path) -> Result<Place, StoreError> {
        let failed = || StoreError::io("made", dir);
        private_folders(dir).map_err(failed())?;
        let dir = fs::canonicalize(dir).map_err(failed())?;
        let root = Folder::root(&dir).map_err(StoreError::io("opened", &dir))?;
        let _guard = super::Guard::take(&root, super::LOCK_WAIT)?;
        // Another process may have made it while this one waited.
        if let Some(place) = Place::at(&dir)? {
            return Ok(place);
        }
        root.write(".gitignore", b"*\n")?;
        let id = new_id(&root)?;
        // The format makes the store: it comes last.
        root.write(FORMAT_FILE, format!("{FORMAT}\n").as_bytes())?;
        Ok(Place { root, id: Some(id), format: Format::Current })
    }

    /// Its folder, links on the way resolved.
    pub fn dir(&self) -> &Path {
        self.root.path()
    }

    /// Refuses a store that this user neither made nor accepted.
    pub fn check_accepted(&self, list: Option<&AcceptedStores>) -> Result<(), StoreError> {
        let refuse = |why: String| Err(StoreError::NotAccepted { dir: self.dir().to_owned(), why });
        let listed = match (list, &self.id) {
            (Some(list), Some(id)) => match list.holds(self.dir(), id) {
                Ok(listed) => listed,
                Err(error) => return refuse(format!("your list of stores, {}, cannot be read: {error}", list.file().display())),
            },
            _ => false,
        };
        match (listed, self.foreign_owner()) {
            (true, _) => Ok(()),
            (false, Some(owner)) => refuse(format!("it belongs to user {owner}")),
            (false, None) => refuse("you neither made it nor accepted it".to_owned()),
        }
    }

    /// Puts it on the user's list; a store of an older format is given an identity first.
    pub fn accept(&mut self, list: &AcceptedStores) -> Result<(), StoreError> {
        let id = match &self.id {
            Some(id) => id.clone(),
            None => {
                let _guard = super::Guard::take(&self.root, super::LOCK_WAIT)?;
                new_id(&self.root)?
            }
        };
        list.add(self.dir(), &id).map_err(StoreError::io("written", list.file()))?;
        self.id = Some(id);
        Ok(())
    }

    /// The user that its folder belongs to, where that is not the one who runs this.
    #[cfg(unix)]
    fn foreign_owner(&self) -> Option<u32> {
        let owner = fs::metadata(self.dir()).map(|meta| std::os::unix::fs::MetadataExt::uid(&meta)).ok()?;
        (owner != rustix::process::geteuid().as_raw()).then_some(owner)
    }

    #[cfg(not(unix))]
    fn foreign_owner(&self) -> Option<u32> {
        None
    }

    /// Opens it for reading and writing: migrates an older format, removes what a process that died left half written. One
    /// that cannot be written is opened for reading.
    pub fn open(self) -> Result<Store, StoreError> {
        Store::open_place(self)
    }
}

/// What a name in the store must be, if it is there.
fn check(root: &Folder, name: &str, kind: Kind) -> Result<(), StoreError> {
    match kind {
        Kind::Folder => root.folder(name).map(drop),
        _ => root.file(name, false).map(drop),
    }
}

fn read_format(root: &Folder) -> Result<Format, StoreError> {
    let Some(bytes) = root.read(FORMAT_FILE)? else { return Ok(Format::Damaged("it is missing".to_owned())) };
    match std::str::from_utf8(&bytes).ok().and_then(|text| text.trim().parse::<u32>().ok()) {
        Some(found) if found > FORMAT => Err(StoreError::Newer { dir: root.path().to_owned(), found, known: FORMAT }),
        Some(FORMAT) => Ok(Format::Current),
        Some(old @ 1..) => Ok(Format::Old(old)),
        Some(0) | None => Ok(Format::Damaged("it holds no version".to_owned())),
    }
}

fn is_id(text: &str) -> bool {
    text.len() == 32 && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// Gives a store its identity.
pub(super) fn new_id(root: &Folder) -> Result<String, StoreError> {
    let mut random = [0_u8; 16];
    let drawn = getrandom::fill(&mut random);
    drawn.map_err(|error| StoreError::io("written", &root.path_of(ID_FILE))(io::Error::other(error.to_string())))?;
    let id: String = random.iter().map(|byte| format!("{byte:02x}")).collect();
    root.write(ID_FILE, format!("{id}\n").as_bytes())?;
    Ok(id)
}

/// The folder that a store would be made in.
pub fn new_store_dir(cwd: &Path) -> PathBuf {
    cwd.join(OsStr::new(FOLDER))
}
