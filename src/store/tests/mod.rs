//! The store as stages and history use it, and as crashes and other processes leave it.

use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::time::Duration;

use serde_json::json;

use super::*;

mod logs;
mod safety;

fn store() -> (tempfile::TempDir, Store) {
    let home = tempfile::tempdir().unwrap();
    let store = Store::open(&home.path().join(FOLDER)).unwrap();
    (home, store)
}

fn put(store: &Store, key: &str, bytes: &[u8]) -> Entry {
    let writer = store.begin("simulate", key).unwrap();
    writer.put("motion", bytes).unwrap();
    writer.finish(json!({ "key": key })).unwrap()
}

/// Where a file of an entry lies.
fn file(store: &Store, key: &str, name: &str) -> PathBuf {
    store.dir().join("cache/simulate").join(key).join(name)
}

fn leftovers(store: &Store) -> usize {
    fs::read_dir(store.dir().join("tmp")).map_or(0, Iterator::count)
}

#[test]
fn an_entry_appears_whole_with_its_blobs() {
    let (_home, store) = store();
    let writer = store.begin("simulate", "k1").unwrap();
    let (mut motion, mut checkpoint) = (writer.write("motion").unwrap(), writer.write("t0.5").unwrap());
    for part in 0..100_u8 {
        motion.write_all(&[part; 1000]).unwrap();
        checkpoint.write_all(&[part]).unwrap();
    }
    motion.finish().unwrap();
    checkpoint.finish().unwrap();
    drop(writer.write("given_up").unwrap());
    assert!(store.get("simulate", "k1").unwrap().is_none());
    assert!(!store.contains("simulate", "k1"));
    writer.finish(json!({ "frames": 101 })).unwrap();

    assert!(store.contains("simulate", "k1"));
    let entry = store.get("simulate", "k1").unwrap().unwrap();
    assert_eq!(entry.meta(), &json!({ "frames": 101 }));
    assert_eq!(entry.names().collect::<Vec<_>>(), ["motion", "t0.5"]);
    assert_eq!((entry.bytes("motion"), entry.has("given_up")), (100_000, false));
    assert_eq!(entry.read("t0.5").unwrap(), (0..100).collect::<Vec<u8>>());
    let mut all = Vec::new();
    entry.open("motion").unwrap().read_to_end(&mut all).unwrap();
    assert_eq!((all.len(), all[99_999]), (100_000, 99));
    let mut reader = entry.open("motion").unwrap();
    reader.seek(SeekFrom::Start(50_000)).unwrap();
    let mut one = [0];
    reader.read_exact(&mut one).unwrap();
    assert_eq!(one, [50]);
    assert!(store.get("simulate", "k2").unwrap().is_none());
    assert!(entry.read("none").is_err());
    assert_eq!(leftovers(&store), 0);
}

#[test]
fn an_unfinished_entry_vanishes() {
    let (_home, store) = store();
    let writer = store.begin("proxy", "k").unwrap();
    writer.put("solid", b"half").unwrap();
    assert_eq!(leftovers(&store), 1);
    drop(writer);
    assert_eq!(leftovers(&store), 0);
    assert!(store.get("proxy", "k").unwrap().is_none());
}

#[test]
fn a_second_finish_replaces_and_a_reader_reads_on() {
    let (_home, store) = store();
    let partial = put(&store, "k", b"partial");
    let writer = store.begin("simulate", "k").unwrap();
    writer.adopt(&partial, "motion", "start").unwrap();
    writer.put("motion", b"whole").unwrap();
    let mut reader = partial.open("motion").unwrap();
    let entry = writer.finish(json!(null)).unwrap();
    let mut text = String::new();
    reader.read_to_string(&mut text).unwrap();
    assert_eq!(text, "partial");
    assert_eq!((entry.read("start").unwrap(), entry.read("motion").unwrap()), (b"partial".to_vec(), b"whole".to_vec()));
}

#[test]
fn an_equal_entry_stays_in_its_place_and_one_that_lacks_a_blob_is_replaced() {
    let (_home, store) = store();
    let finish = |blobs: &[&str], turn: u32| {
        let writer = store.begin("motion", "k").unwrap();
        blobs.iter().for_each(|name| writer.put(name, name.as_bytes()).unwrap());
        writer.finish(json!(turn)).unwrap().meta().clone()
    };
    let there = || store.get("motion", "k").unwrap().unwrap();
    assert_eq!(finish(&["checkpoint"], 1), json!(1));
    // Its folder is never away: nobody who looks meanwhile misses it.
    assert_eq!((finish(&["checkpoint"], 2), there().meta()), (json!(1), &json!(1)));
    assert_eq!((finish(&["checkpoint", "motion"], 3), there().meta()), (json!(3), &json!(3)));
    // Nor does one that has less take the place of one that has more.
    assert_eq!((finish(&["checkpoint"], 4), there().has("motion")), (json!(3), true));
    fs::write(store.dir().join("cache/motion/k/motion"), b"short").unwrap();
    assert_eq!(finish(&["checkpoint", "motion"], 5), json!(5));
    assert_eq!(leftovers(&store), 0);
}

#[test]
fn finishing_an_entry_adds_to_a_total_and_looks_at_no_other_entry() {
    let (_home, store) = store();
    fs::write(store.dir().join("size"), "1000\n").unwrap();
    drop(put(&store, "k", &[0; 10_000]));
    let total = || fs::read_to_string(store.dir().join("size")).unwrap().trim().parse::<u64>().unwrap();
    assert!((11_000..12_000).contains(&total()), "{}", total());
    // A total that is wrong leads to one look at everything before anything is evicted.
    fs::write(store.dir().join("size"), "999999999\n").unwrap();
    drop(put(&store.clone().with_cap(50_000), "second", &[0; 10_000]));
    assert!((20_000..22_000).contains(&total()) && store.contains("simulate", "k"));
}

#[test]
fn a_flipped_digit_in_the_list_of_an_entry_is_damage() {
    let (_home, store) = store();
    drop(put(&store, "k", b"0123456789"));
    let list = file(&store, "k", entry::MANIFEST);
    let text = fs::read_to_string(&list).unwrap();
    fs::write(&list, text.replace(r#""key":"k""#, r#""key":"x""#)).unwrap();
    assert!(store.get("simulate", "k").unwrap().is_none());
    assert!(store.take_damage()[0].contains("its checksum differs"));
}

#[test]
fn a_list_of_pins_that_cannot_be_read_holds_up_nobody() {
    let (_home, store) = store();
    drop(put(&store, "old", &[0; 10_000]));
    store.pin("head", [("simulate", "old")]).unwrap();
    fs::write(store.dir().join("pins/head.json"), b"[\"simul").unwrap();
    drop(put(&store.clone().with_cap(11_000), "new", &[0; 10_000]));
    assert!(store.contains("simulate", "new") && !store.contains("simulate", "old"));
    assert!(store.take_damage()[0].contains("head.json"));
}

#[test]
fn damage_is_said_once_and_then_missed() {
    let (_home, store) = store();
    drop(put(&store, "short", b"0123456789"));
    let path = file(&store, "short", "motion");
    File::options().write(true).open(&path).unwrap().set_len(3).unwrap();
    assert!(store.get("simulate", "short").unwrap().is_none());
    let told = store.clone().take_damage();
    assert!(told.len() == 1 && told[0].contains("3 bytes instead of 10"), "{told:?}");
    assert!(!store.contains("simulate", "short"));

    let entry = put(&store, "flipped", b"0123456789");
    fs::write(file(&store, "flipped", "motion"), b"0123456780").unwrap();
    assert!(matches!(entry.read("motion"), Err(StoreError::Spoilt { .. })));
    let fault = entry.open("motion").unwrap().read_to_end(&mut Vec::new()).unwrap_err();
    assert!(fault.to_string().contains("checksum"), "{fault}");
    drop(entry);
    assert!(store.get("simulate", "flipped").unwrap().is_none());
    assert_eq!((store.take_damage().len(), store.take_damage().len()), (1, 0));

    for file in [entry::MANIFEST, entry::SEAL, entry::USED] {
        let entry = put(&store, "holed", b"x");
        fs::remove_file(self::file(&store, "holed", file)).unwrap();
        drop(entry);
        assert!(store.get("simulate", "holed").unwrap().is_none(), "{file}");
        assert_eq!(store.take_damage().len(), 1, "{file}");
    }
}

#[test]
fn eviction_takes_the_longest_unused_and_spares_pins_and_readers() {
    let (_home, store) = store();
    for key in ["pinned", "read", "old", "touched"] {
        drop(put(&store, key, &[0; 10_000]));
    }
    store.pin("head", [("simulate", "pinned")]).unwrap();
    let reading = store.get("simulate", "read").unwrap().unwrap();
    drop(store.get("simulate", "touched").unwrap());
    let store = store.with_cap(42_000);
    drop(put(&store, "new", &[0; 10_000]));
    let there = |key| store.contains("simulate", key);
    assert!(!there("old"));
    assert!(["pinned", "read", "touched", "new"].into_iter().all(there));
    drop(reading);
    store.pin("head", []).unwrap();
    drop(put(&store.clone().with_cap(11_000), "last", &[0; 10_000]));
    assert_eq!(store.usage().unwrap().entries, 1);
    assert!(there("last"));
    assert_eq!(leftovers(&store), 0);
}

#[test]
fn what_dead_processes_left_is_swept_and_the_living_are_spared() {
    let (home, store) = store();
    let living = store.begin("scene", "k").unwrap();
    living.put("blob", b"x").unwrap();
    let tmp = store.dir().join("tmp");
    fs::create_dir_all(tmp.join(".tmp-1-1")).unwrap();
    fs::write(tmp.join(".tmp-1-1/used"), b"").unwrap();
    fs::write(tmp.join(".tmp-1-1/blob"), b"half").unwrap();
    fs::create_dir_all(tmp.join(".tmp-1-2/gone")).unwrap();
    fs::create_dir_all(tmp.join("1-1")).unwrap();
    fs::write(store.dir().join(".tmp-1-3"), b"half").unwrap();
    fs::create_dir_all(store.dir().join("pins")).unwrap();
    fs::write(store.dir().join("pins/.tmp-1-4"), b"half").unwrap();
    let again = Store::open(&home.path().join(FOLDER)).unwrap();
    assert_eq!(leftovers(&again), 2);
    assert!(!store.dir().join(".tmp-1-3").exists() && !store.dir().join("pins/.tmp-1-4").exists());
    assert!(store.dir().join("tmp/1-1").exists(), "no name of the store's own is left alone");
    living.finish(json!(null)).unwrap();
    assert!(again.contains("scene", "k"));
}

#[test]
fn the_nearest_store_above_is_found() {
    let (home, store) = store();
    let deep = home.path().join("a/b");
    fs::create_dir_all(&deep).unwrap();
    assert_eq!(Place::above(&deep).unwrap().unwrap().dir(), store.dir());
    let own = Store::open(&deep.join("mine")).unwrap();
    assert!(own.dir().ends_with("a/b/mine") && own.id() != store.id());
    assert!(own.cap_bytes() <= CAP_BYTES);
    assert_eq!(fs::read_to_string(store.dir().join(".gitignore")).unwrap(), "*\n");
    // An empty folder of that name is no store yet.
    fs::create_dir(deep.join(FOLDER)).unwrap();
    assert_eq!(Place::above(&deep).unwrap().unwrap().dir(), store.dir());
}

#[test]
fn folders_that_are_no_store_are_refused() {
    let home = tempfile::tempdir().unwrap();
    let open = |name: &str| Store::open(&home.path().join(name));
    fs::create_dir(home.path().join("letters")).unwrap();
    fs::write(home.path().join("letters/a.txt"), b"dear").unwrap();
    assert!(matches!(open("letters"), Err(StoreError::NotAStore { .. })));
    assert_eq!(fs::read_dir(home.path().join("letters")).unwrap().count(), 1);
    fs::write(home.path().join("file"), b"").unwrap();
    assert!(matches!(open("file"), Err(StoreError::Io { .. })));
    drop(open("s").unwrap());
    fs::write(home.path().join("s/format"), b"3\n").unwrap();
    let newer = open("s").unwrap_err();
    assert!(matches!(newer, StoreError::Newer { found: 3, known: 2, .. }), "{newer}");
}

#[test]
fn the_lock_waits_and_then_says_so() {
    let (_home, store) = store();
    let guard = store.lock().unwrap();
    let hasty = store.clone().with_wait(Duration::ZERO);
    assert!(matches!(hasty.lock(), Err(StoreError::Locked { .. })));
    assert!(matches!(hasty.begin("scene", "k"), Err(StoreError::Locked { .. })));
    drop(guard);
    hasty.lock().unwrap();
    for name in ["..", "", "a/b", ".hidden", "a\\b", "a\0"] {
        assert!(matches!(store.begin(name, "k"), Err(StoreError::Name { .. })), "{name}");
        assert!(!store.contains("scene", name));
    }
    assert!(store.begin("scene", "k").unwrap().write(entry::MANIFEST).is_err());
}

#[test]
fn atomic_writes_replace_and_leave_nothing_beside() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("deep/down/file");
    write_atomic(&path, b"one").unwrap();
    write_atomic(&path, b"two").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"two");
    assert!(write_atomic(home.path(), b"a folder").is_err());
    assert!(write_atomic(&path.join("below a file"), b"x").is_err());
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 1);
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
}
