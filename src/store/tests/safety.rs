//! Stores that somebody else prepared: links in every part, other users, names that no store makes.
#![cfg(unix)]

use super::*;
use std::collections::BTreeMap;
use std::os::unix::fs::{PermissionsExt, symlink};

/// Everything under a folder, with its content.
fn snapshot(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for child in fs::read_dir(folder).unwrap().map(|child| child.unwrap().path()) {
        if child.is_dir() {
            found.insert(child.clone(), Vec::new());
            found.extend(snapshot(&child));
        } else {
            found.insert(child.clone(), fs::read(&child).unwrap());
        }
    }
    found
}

/// A folder of documents that look like parts of a store, so that whatever followed a link would find something to remove.
fn documents(folder: &Path) {
    for name in ["gone", "k", "simulate/k", "turns.jsonl", ".tmp-1-1/used", ".tmp-1-1/letter", "letter.txt", "simulate/k/used"] {
        let path = folder.join(name);
        if name.contains("used") || name.contains('.') {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, b"dear").unwrap();
        } else {
            fs::create_dir_all(path).unwrap();
        }
    }
}

/// Does everything that a store can do, whether or not it succeeds: the sentences of all refusals.
fn everything(dir: &Path) -> Vec<String> {
    let mut refused = Vec::new();
    let mut store = match Store::open(dir) {
        Ok(store) => store.with_cap(0).with_wait(Duration::ZERO),
        Err(error) => return vec![error.to_string()],
    };
    let mut note = |result: Result<(), StoreError>| refused.extend(result.err().map(|error| error.to_string()));
    note(store.get("simulate", "k").map(drop));
    note(store.begin("simulate", "k").and_then(|writer| writer.put("motion", b"x").and_then(|()| writer.finish(json!(null)))).map(drop));
    note(store.begin("simulate", "other").and_then(|writer| writer.finish(json!(null))).map(drop));
    note(store.pin("head", [("simulate", "k")]));
    note(store.lock().and_then(|guard| guard.append("turns", &1)));
    note(store.read_log::<u32>("turns").map(drop));
    note(store.remove("simulate", "k"));
    note(store.collect(&std::collections::BTreeSet::new(), Some(0)).map(drop));
    note(store.usage().map(drop));
    note(store.verify(true).map(drop));
    note(store.driver_log().map(drop));
    refused.extend(store.take_damage());
    refused
}

#[test]
fn a_link_in_any_part_is_refused_by_name_and_nothing_beyond_it_changes() {
    let parts = [
        "format",
        "id",
        "lock",
        "size",
        "repl.log",
        ".gitignore",
        "cache",
        "history",
        "pins",
        "tmp",
        "aside",
        "backup",
        "cache/simulate",
        "cache/simulate/k",
        "cache/simulate/k/motion",
        "cache/simulate/k/entry.json",
        "cache/simulate/k/entry.blake3",
        "cache/simulate/k/used",
        "cache/simulate/k/more",
        "cache/more",
        "cache/simulate/more",
        "tmp/.tmp-1-1",
        "tmp/more",
        "tmp/.tmp-1-2/gone",
        "pins/head.json",
        "pins/more.json",
        "history/turns.jsonl",
        "history/turns.head",
        "history/more.jsonl",
        ".tmp-1-3",
        "more",
    ];
    for part in parts {
        for target in ["folder", "folder/letter.txt", "nothing"] {
            let (home, store) = store();
            let dir = store.dir().to_owned();
            drop(put(&store, "k", b"0123456789"));
            store.pin("head", []).unwrap();
            store.lock().unwrap().append("turns", &1).unwrap();
            drop(store);
            documents(&home.path().join("folder"));
            let before = snapshot(&home.path().join("folder"));
            let path = dir.join(part);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir_all(&path));
            symlink(home.path().join(target), &path).unwrap();
            let refused = everything(&dir);
            assert_eq!(snapshot(&home.path().join("folder")), before, "{part} -> {target}: {refused:?}");
            assert!(!home.path().join("nothing").exists(), "{part} -> {target}");
            let central = PARTS.iter().any(|(name, _)| *name == part);
            assert!(!central || refused.iter().any(|sentence| sentence.contains(part) && sentence.contains("symbolic link")), "{part}: {refused:?}");
        }
    }
}

#[test]
fn what_no_store_makes_is_put_aside_and_not_removed() {
    let (_home, store) = store();
    drop(put(&store, "k", b"0123456789"));
    let entry = store.dir().join("cache/simulate/k");
    fs::remove_file(entry.join("entry.json")).unwrap();
    fs::create_dir_all(entry.join("entry.json/drafts")).unwrap();
    fs::write(entry.join("entry.json/drafts/letter.txt"), b"dear").unwrap();
    assert!(store.get("simulate", "k").unwrap().is_none());
    let told = store.take_damage();
    assert!(told.iter().any(|sentence| sentence.contains("put aside")), "{told:?}");
    assert!(snapshot(&store.dir().join("aside")).values().any(|content| content == b"dear"));
    // And the store goes on.
    drop(put(&store, "k", b"0123456789"));
    assert!(store.get("simulate", "k").unwrap().is_some());
}

#[test]
fn a_store_is_private_and_so_is_a_scratch_one() {
    let home = tempfile::tempdir().unwrap();
    let store = Store::open(&home.path().join(FOLDER)).unwrap();
    let scratch = Store::scratch().unwrap();
    let again = Store::scratch().unwrap();
    for store in [&store, &scratch] {
        assert_eq!(fs::metadata(store.dir()).unwrap().permissions().mode() & 0o777, 0o700);
    }
    assert_ne!(scratch.dir(), again.dir());
    let dir = scratch.dir().to_owned();
    drop((scratch.clone(), scratch));
    assert!(!dir.exists());
}

#[test]
fn only_stores_that_were_made_or_accepted_are_used() {
    let (home, store) = store();
    // A list of their own: the tests do not touch the user's.
    let list = AcceptedStores::in_file(home.path().join("state/stores.jsonl"));
    let mut place = Place::above(home.path()).unwrap().unwrap();
    let refused = place.check_accepted(Some(&list)).unwrap_err().to_string();
    assert!(refused.contains("phystalk store accept") && refused.contains("neither made it nor accepted it"), "{refused}");
    assert!(place.check_accepted(None).is_err());
    place.accept(&list).unwrap();
    place.check_accepted(Some(&list)).unwrap();
    // Another store in the same place is another store.
    fs::write(store.dir().join("id"), "0".repeat(32)).unwrap();
    assert!(Place::above(home.path()).unwrap().unwrap().check_accepted(Some(&list)).is_err());
    fs::remove_file(store.dir().join("id")).unwrap();
    let mut old = Place::above(home.path()).unwrap().unwrap();
    assert!(old.check_accepted(Some(&list)).is_err());
    old.accept(&list).unwrap();
    Place::above(home.path()).unwrap().unwrap().check_accepted(Some(&list)).unwrap();
}

#[test]
fn damage_to_any_file_of_a_store_is_found_and_repaired() {
    for part in [
        "format",
        "id",
        "size",
        "pins/head.json",
        "history/turns.head",
        "cache/simulate/k/entry.json",
        "cache/simulate/k/motion",
        "cache/simulate/k/used",
    ] {
        for harm in ["nonsense", "missing"] {
            let (_home, store) = store();
            drop(put(&store, "k", b"0123456789"));
            store.pin("head", [("simulate", "k")]).unwrap();
            store.lock().unwrap().append("turns", &1).unwrap();
            let path = store.dir().join(part);
            match harm {
                "nonsense" => fs::write(&path, b"\0nonsense").unwrap(),
                _ => fs::remove_file(&path).unwrap(),
            }
            let mut store = Store::open(store.dir()).unwrap();
            assert_eq!(store.read_log::<u32>("turns").unwrap().lines, [1], "{part} {harm}: all else stays readable");
            store.verify(true).unwrap();
            assert_eq!(store.verify(false).unwrap(), [], "{part} {harm}");
            let store = Store::open(store.dir()).unwrap();
            assert_eq!((store.read_only(), store.read_log::<u32>("turns").unwrap().lines), (None, vec![1]), "{part} {harm}");
            store.lock().unwrap().append("turns", &2).unwrap();
        }
    }
}

#[test]
fn a_store_that_cannot_be_written_can_be_read() {
    // Root may write everywhere: a store on which nobody may is one whose lock cannot be made.
    let (_home, store) = store();
    drop(put(&store, "k", b"0123456789"));
    store.lock().unwrap().append("turns", &1).unwrap();
    let read_only = Store { read_only: Some("read-only file system".into()), ..store };
    assert_eq!(read_only.read_log::<u32>("turns").unwrap().lines, [1]);
    assert_eq!(read_only.get("simulate", "k").unwrap().unwrap().read("motion").unwrap(), b"0123456789");
    let refused = read_only.begin("simulate", "k").unwrap_err().to_string();
    assert!(refused.contains("cannot be written to") && refused.contains("--store"), "{refused}");
}
