//! A folder of the store, reached by its open handle: one name at a time, and never through a link.
//!
//! Everything under a store is opened relative to the folder above it, so that a symbolic link, a pipe or a device in
//! the place of a file or folder is refused by name instead of followed out of the store. Names are single components:
//! those that [`super::checked`] lets through, or constants.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use cap_fs_ext::{DirExt, FollowSymlinks, OpenOptionsFollowExt};
use cap_std::ambient_authority;
use cap_std::fs::{Dir, FileType, OpenOptions};

use super::{StoreError, TEMP, fault};

/// An open folder. Clones share the handle.
#[derive(Clone, Debug)]
pub(super) struct Folder {
    dir: Arc<Dir>,
    /// For messages, and for nothing else.
    path: Arc<Path>,
}

/// What lies under a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// Nothing that a store makes; in words.
    Foreign(&'static str),
}

/// One entry of a folder's listing.
#[derive(Clone, Debug)]
pub(super) struct Child {
    /// Its name; lossy where that is not UTF-8, and then never one of the store's own.
    pub name: String,
    pub kind: Kind,
    pub bytes: u64,
    pub modified: SystemTime,
}

impl Kind {
    fn of(file_type: FileType) -> Kind {
        match () {
            () if file_type.is_file() => Kind::File,
            () if file_type.is_dir() => Kind::Folder,
            () if file_type.is_symlink() => Kind::Foreign("a symbolic link"),
            () => Kind::Foreign("a pipe, socket or device"),
        }
    }

    fn in_words(self) -> &'static str {
        match self {
            Kind::File => "a file",
            Kind::Folder => "a folder",
            Kind::Foreign(what) => what,
        }
    }
}

impl Folder {
    /// Opens the store's own folder, which the caller has chosen and resolved.
    pub fn root(path: &Path) -> io::Result<Folder> {
        Ok(Folder { dir: Arc::new(Dir::open_ambient_dir(path, ambient_authority())?), path: path.into() })
    }

    /// Where it lies, for messages.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where a child of it lies, for messages.
    pub fn path_of(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// What lies under a name, none where nothing does. A link is a link here.
    pub fn kind(&self, name: &str) -> Result<Option<Kind>, StoreError> {
        match self.dir.symlink_metadata(name) {
            Ok(meta) => Ok(Some(Kind::of(meta.file_type()))),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(StoreError::io("read", &self.path_of(name))(error)),
        }
    }

    /// Whether something of the expected kind is there; refuses by name what is something else.
    fn has(&self, name: &str, expected: Kind) -> Result<bool, StoreError> {
        match self.kind(name)? {
            None => Ok(false),
            Some(kind) if kind == expected => Ok(true),
            Some(found) => Err(StoreError::Foreign { path: self.path_of(name), found: found.in_words(), expected: expected.in_words() }),
        }
    }

    /// Opens a folder in it, none where there is none.
    pub fn folder(&self, name: &str) -> Result<Option<Folder>, StoreError> {
        let path = self.path_of(name);
        if !self.has(name, Kind::Folder)? {
            return Ok(None);
        }
        match self.dir.open_dir_nofollow(name) {
            Ok(dir) => Ok(Some(Folder { dir: Arc::new(dir), path: path.into() })),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(StoreError::io("opened", &path)(error)),
        }
    }

    /// Opens a folder in it, made where there is none.
    pub fn make(&self, name: &str) -> Result<Folder, StoreError> {
        let path = self.path_of(name);
        loop {
            if let Some(folder) = self.folder(name)? {
                return Ok(folder);
            }
            fault::before_write();
            match self.dir.create_dir(name) {
                // Another process was faster: open its folder.
                Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(StoreError::io("made", &path)(error)),
                _ => {}
            }
        }
    }

    /// A new folder in it, under a name that nothing else in this process or another one takes.
    pub fn make_temporary(&self) -> Result<(String, Folder), StoreError> {
        loop {
            let name = temporary_name();
            fault::before_write();
            match self.dir.create_dir(&name) {
                Ok(()) => {}
                // Left by a process that died and had our number.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(error) => return Err(StoreError::io("made", &self.path_of(&name))(error)),
            }
            if let Some(folder) = self.folder(&name)? {
                return Ok((name, folder));
            }
        }
    }

    fn open(&self, name: &str, options: &mut OpenOptions) -> io::Result<File> {
        self.dir.open_with(name, options.follow(FollowSymlinks::No)).map(cap_std::fs::File::into_std)
    }

    /// Opens a regular file, none where there is none.
    pub fn file(&self, name: &str, write: bool) -> Result<Option<File>, StoreError> {
        if !self.has(name, Kind::File)? {
            return Ok(None);
        }
        match self.open(name, OpenOptions::new().read(true).write(write)) {
            Ok(file) => Ok(Some(file)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(StoreError::io(if write { "opened for writing" } else { "read" }, &self.path_of(name))(error)),
        }
    }

    /// Opens a regular file for reading and writing, made empty where there is none.
    pub fn file_or_new(&self, name: &str) -> Result<File, StoreError> {
        self.has(name, Kind::File)?;
        fault::before_write();
        let opened = self.open(name, OpenOptions::new().read(true).write(true).create(true));
        opened.map_err(StoreError::io("opened for writing", &self.path_of(name)))
    }

    /// A new file, for writing.
    pub fn create(&self, name: &str) -> Result<File, StoreError> {
        fault::before_write();
        let opened = self.open(name, OpenOptions::new().write(true).create_new(true));
        opened.map_err(StoreError::io("written", &self.path_of(name)))
    }

    /// A whole file, none where there is none.
    pub fn read(&self, name: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let Some(mut file) = self.file(name, false)? else { return Ok(None) };
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(StoreError::io("read", &self.path_of(name)))?;
        Ok(Some(bytes))
    }

    /// Writes a file that is there whole or not at all, and brings it to disk.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let temporary = temporary_name();
        let mut file = self.create(&temporary)?;
        let path = self.path_of(name);
        let written = file.write_all(bytes).and_then(|()| file.sync_all()).map_err(StoreError::io("written", &path));
        drop(file);
        let done = written.and_then(|()| self.rename(&temporary, self, name)).and_then(|()| self.sync());
        if done.is_err() {
            // The first error matters; a leftover is swept.
            let _ = self.dir.remove_file(&temporary);
        }
        done
    }

    /// Moves a child to another folder or name; a file there is replaced.
    pub fn rename(&self, name: &str, to: &Folder, new_name: &str) -> Result<(), StoreError> {
        fault::before_write();
        self.dir.rename(name, &to.dir, new_name).map_err(StoreError::io("moved", &self.path_of(name)))
    }

    /// Gives a file of another folder a second name here; copies it where the disk has no hard links.
    pub fn adopt(&self, from: &Folder, name: &str, new_name: &str) -> Result<(), StoreError> {
        fault::before_write();
        let linked = from.dir.hard_link(name, &self.dir, new_name);
        let copied = linked.or_else(|_| from.dir.copy(name, &self.dir, new_name).map(drop));
        copied.map_err(StoreError::io("written", &self.path_of(new_name)))
    }

    /// Removes a file, or a link as a link; whether there was one.
    pub fn remove_file(&self, name: &str) -> Result<bool, StoreError> {
        fault::before_write();
        match self.dir.remove_file(name) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
            Err(error) => Err(StoreError::io("removed", &self.path_of(name))(error)),
        }
    }

    /// Removes a folder in it with all that the store itself makes in one: files and folders of its own names. Whether it is
    /// gone; one that holds anything else stays with that.
    pub fn remove_own(&self, name: &str) -> Result<bool, StoreError> {
        let Some(folder) = self.folder(name)? else { return Ok(true) };
        let mut whole = true;
        for child in folder.children()? {
            whole &= match child.kind {
                Kind::File if is_own(&child.name) => {
                    folder.remove_file(&child.name)?;
                    true
                }
                Kind::Folder if child.name == GONE => folder.remove_own(&child.name)?,
                _ => false,
            };
        }
        if whole {
            fault::before_write();
            match self.dir.remove_dir(name) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(StoreError::io("removed", &self.path_of(name))(error)),
                _ => {}
            }
        }
        Ok(whole)
    }

    /// What lies in it, by name.
    pub fn children(&self) -> Result<Vec<Child>, StoreError> {
        let failed = || StoreError::io("read", &self.path);
        let mut found = Vec::new();
        for entry in self.dir.entries().map_err(failed())? {
            let entry = entry.map_err(failed())?;
            // Gone between the two looks: nothing to list.
            let Ok(meta) = entry.metadata() else { continue };
            let modified = meta.modified().map_or(SystemTime::UNIX_EPOCH, cap_std::time::SystemTime::into_std);
            let name = entry.file_name().to_string_lossy().into_owned();
            found.push(Child { name, kind: Kind::of(meta.file_type()), bytes: meta.len(), modified });
        }
        found.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(found)
    }

    /// Brings renames to disk. Systems that cannot do that with a folder do it by themselves.
    pub fn sync(&self) -> Result<(), StoreError> {
        if cfg!(not(unix)) {
            return Ok(());
        }
        let opened = self.open(".", OpenOptions::new().read(true));
        opened.and_then(|folder| folder.sync_all()).map_err(StoreError::io("written", &self.path))
    }
}

/// The name of an entry on its way out, in a folder of `tmp`.
pub(super) const GONE: &str = "gone";

/// Whether the store itself makes files of this name.
pub(super) fn is_own(name: &str) -> bool {
    super::checked(name).is_ok() || is_temporary(name)
}

/// Whether this is the name of something unfinished: `.tmp-PID-N`.
pub(super) fn is_temporary(name: &str) -> bool {
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    name.strip_prefix(TEMP).and_then(|rest| rest.split_once('-')).is_some_and(|(process, count)| digits(process) && digits(count))
}

/// A name that nothing else in this process or another one takes.
fn temporary_name() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    format!("{TEMP}{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}
