//! Which store a command works on: found, made, or a scratch one; refused where it is not the user's.

use super::exit::Failure;
use super::flags::Flags;
use super::output;
use crate::history::{HistoryError, Session, Sessions};
use phystalk::store::{AcceptedStores, Place, Store, new_store_dir};
use std::path::{Path, PathBuf};

/// The store that `--store` names, or the nearest `.phystalk` here or above; none where there is none yet. One that `--store`
/// names is accepted by that; any other one has to be the user's own.
pub fn place(flags: &Flags) -> Result<Option<Place>, Failure> {
    let here = here()?;
    let Some(dir) = &flags.store else {
        let Some(place) = Place::above(&here)? else { return Ok(None) };
        place.check_accepted(AcceptedStores::of_user().as_ref())?;
        return Ok(Some(place));
    };
    let Some(mut place) = Place::at(&named(&here.join(dir)))? else { return Ok(None) };
    // Where the list cannot be written, naming the store works again the next time.
    if let Some(list) = AcceptedStores::of_user() {
        let _ = place.accept(&list);
    }
    Ok(Some(place))
}

/// Does work that is kept, with the store for it, which is made where there is none. A store that was made for work that
/// failed before it kept anything is gone again.
pub fn with_work<T>(flags: &Flags, work: impl FnOnce(&Store) -> Result<T, Failure>) -> Result<T, Failure> {
    if let Some(place) = place(flags)? {
        return work(&open(place, flags)?);
    }
    let (store, notes) = make(flags)?;
    let done = work(&store);
    match &done {
        Ok(_) => notes.iter().for_each(output::note),
        Err(_) => store.remove_unused()?,
    }
    done
}

/// The store that a named folder means: itself, or the one that it holds.
fn named(dir: &Path) -> PathBuf {
    let inner = new_store_dir(dir);
    if inner.is_dir() { inner } else { dir.to_owned() }
}

/// Makes a store; with it what the user should know about it once it is used.
fn make(flags: &Flags) -> Result<(Store, Vec<String>), Failure> {
    let here = here()?;
    let mut place = Place::make(&flags.store.as_ref().map_or_else(|| new_store_dir(&here), |dir| here.join(dir)))?;
    let list = AcceptedStores::of_user();
    let noted = list.as_ref().map(|list| place.accept(list));
    let store = place.open()?;
    let mut notes = Vec::new();
    if !flags.quiet {
        let (dir, gigabytes) = (store.dir().display(), store.cap_bytes() as f64 / 1e9);
        notes.push(format!("made the store {dir}: versions stay there, and results up to {gigabytes:.1} GB (phystalk store du)"));
    }
    if flags.store.is_none() && !matches!(noted, Some(Ok(()))) {
        let why = noted.and_then(Result::err).map_or_else(|| "neither XDG_STATE_HOME nor HOME is set".to_owned(), |error| error.to_string());
        notes.push(format!("warning: your list of stores cannot be written ({why}): next time name this one, --store {}", store.dir().display()));
    }
    Ok((store, notes))
}

/// The store that is there, for reading; none where there is none.
pub fn existing(flags: &Flags) -> Result<Option<Store>, Failure> {
    place(flags)?.map(|place| open(place, flags)).transpose()
}

/// A store for results that need not be kept: the one that is there where it can be written, else a scratch one.
pub fn of_results(flags: &Flags) -> Result<Store, Failure> {
    match existing(flags)? {
        Some(store) if store.read_only().is_none() => Ok(store),
        _ => Ok(Store::scratch()?),
    }
}

/// The sessions of a store as this command sees them.
pub fn sessions(flags: &Flags, store: &Store) -> Result<Sessions, Failure> {
    Ok(Sessions::seen_from(store, &here()?).of_any_folder(flags.store.is_some()))
}

/// The last session, or the one that `--session` names, and its store. What is damaged is reported, and the rest used.
pub fn session(flags: &Flags) -> Result<(Store, Session), Failure> {
    let Some(store) = existing(flags)? else {
        return Err(HistoryError::NoSuchSession { name: flags.session.clone(), known: Vec::new() }.into());
    };
    let sessions = sessions(flags, &store)?;
    list_damage(&sessions)?.into_iter().for_each(|text| output::note(format!("warning: {text}")));
    let session = sessions.open(flags.session.as_deref())?;
    crate::conversation::damage(&session).into_iter().for_each(|text| output::note(format!("warning: {text}")));
    Ok((store, session))
}

fn open(place: Place, flags: &Flags) -> Result<Store, Failure> {
    let store = place.open()?;
    let elsewhere = store.dir().parent() != std::fs::canonicalize(here()?).ok().as_deref();
    if elsewhere && flags.store.is_none() && !flags.quiet {
        output::note(format!("using the store {}", store.dir().display()));
    }
    if let Some(why) = store.read_only() {
        output::note(format!("warning: the store {} can only be read: {why}", store.dir().display()));
    }
    Ok(store)
}

fn here() -> Result<PathBuf, Failure> {
    std::env::current_dir().map_err(|e| Failure::file("use", Path::new("."), &e))
}

/// What is found of the store without using it: where it is, and a sentence for each thing that is wrong with it.
pub fn examine(flags: &Flags) -> (Option<PathBuf>, Vec<String>) {
    let quiet = Flags { quiet: true, ..flags.clone() };
    match existing(&quiet) {
        Ok(None) => (None, Vec::new()),
        Ok(Some(store)) => (Some(store.dir().to_owned()), damage(&quiet, &store).unwrap_or_else(|failure| vec![failure.message])),
        Err(failure) => (None, vec![failure.message.replace('\n', "; ")]),
    }
}

fn damage(flags: &Flags, store: &Store) -> Result<Vec<String>, Failure> {
    let sessions = sessions(flags, store)?;
    let mut found: Vec<String> = list_damage(&sessions)?.into_iter().collect();
    for (name, _) in sessions.used()? {
        match sessions.open(Some(&name)) {
            Ok(session) => found.extend(crate::conversation::damage(&session)),
            Err(error) => found.push(format!("session {name} cannot be read ({error}): phystalk store verify --repair")),
        }
    }
    Ok(found)
}

/// What is wrong with the list of sessions, and what to do about it.
fn list_damage(sessions: &Sessions) -> Result<Option<String>, Failure> {
    let damage = sessions.damage()?;
    let sentence = || format!("the list of sessions is damaged ({}): phystalk store verify --repair makes it anew", damage.join("; "));
    Ok((!damage.is_empty()).then(sentence))
}
