//! Sessions as conversations use them, and as crashes and other processes leave them.

use std::fs;

use phystalk::spec::{Edit, Spec};
use phystalk::store::Store;
use proptest::prelude::*;
use serde_json::json;

use super::*;

mod damage;
mod writers;

fn store() -> (tempfile::TempDir, Store) {
    let home = tempfile::tempdir().unwrap();
    let store = Store::open(&home.path().join(".phystalk")).unwrap();
    (home, store)
}

/// The sessions of a store, from the folder that it lies in.
fn sessions(store: &Store) -> Sessions {
    Sessions::seen_from(store, store.dir().parent().unwrap())
}

fn session(store: &Store) -> Session {
    sessions(store).start(None, Spec::of_scene("builtin:demo")).unwrap()
}

fn open(store: &Store, name: Option<&str>) -> Result<Session, HistoryError> {
    sessions(store).open(name)
}

/// A turn that sets the seed.
fn turn(session: &mut Session, seed: u32) -> Version {
    let edits = [Edit::set("seed", seed)];
    let spec = session.spec().apply(&edits).unwrap();
    session.commit(&format!("seed {seed}"), Author::Literal, &edits, &spec).unwrap()
}

/// All sessions, in the order of use.
fn names(store: &Store) -> Vec<String> {
    sessions(store).used().unwrap().into_iter().map(|(name, _)| name).collect()
}

fn seeds(session: &Session) -> Vec<u64> {
    session.versions().iter().map(|version| version.spec.seed).collect()
}

#[test]
fn turns_make_versions_that_are_there_after_opening_again() {
    let (_home, store) = store();
    let mut session = session(&store);
    assert_eq!((session.name(), session.head(), session.spec().seed), ("s1", None, 1));
    let first = turn(&mut session, 2);
    assert_eq!((first.name.as_str(), first.parent.as_deref(), first.words.as_str(), first.note.as_str()), ("v1", None, "seed 2", ""));
    assert_eq!(first.spec_hash, session.spec().hash());
    let second = turn(&mut session, 3);
    assert_eq!((second.name.as_str(), second.parent.as_deref()), ("v2", Some("v1")));
    session.keep_resolved("v2", json!({ "time.duration_s": 2.0 }), vec!["motion/k".to_owned()]).unwrap();

    let again = open(&store, None).unwrap();
    assert_eq!(again.versions(), session.versions());
    assert_eq!(again.find("2").unwrap().resolved, Some(json!({ "time.duration_s": 2.0 })));
    assert_eq!(again.spec(), session.spec());
    for (reference, name) in [("v1", "v1"), ("V2", "v2"), ("first", "v1"), ("last", "v2"), ("previous", "v1")] {
        assert_eq!(again.find(reference).unwrap().name, name);
    }
    for reference in ["v3", "v0", "", "vv1", "v-1", "99999999999"] {
        assert!(matches!(again.find(reference), Err(HistoryError::NoSuchVersion { .. })), "{reference}");
    }
    let line = serde_json::to_value(&again.versions()[1]).unwrap();
    assert_eq!((&line["name"], &line["parent"], &line["edits"][0]["path"]), (&json!("v2"), &json!("v1"), &json!("seed")));
}

#[test]
fn undo_makes_versions_and_walks_further_back() {
    let (_home, store) = store();
    let mut session = session(&store);
    for seed in [2, 3, 4] {
        turn(&mut session, seed);
    }
    let back = session.undo("undo that", 1).unwrap();
    assert_eq!((back.name.as_str(), back.note.as_str(), back.spec.seed, back.words.as_str()), ("v4", "back to v2", 3, "undo that"));
    assert_eq!(back.spec_hash, session.find("v2").unwrap().spec_hash);
    assert_eq!(back.edits, [Edit::set("seed", 3)]);
    assert_eq!(session.undo("undo", 1).unwrap().note, "back to v1");
    assert_eq!(session.redo("redo", 1).unwrap().note, "forward to v2");
    assert_eq!(session.redo("redo", 9).unwrap().note, "forward to v3, all that there is: 1 of 9 steps");
    assert!(matches!(session.redo("redo", 1), Err(HistoryError::NothingToRedo { .. })));
    assert_eq!(session.undo("undo", 2).unwrap().note, "back to v1");
    assert_eq!(session.undo("undo", 9).unwrap().note, "back to the start, all that there is: 1 of 9 steps");
    assert_eq!(session.spec(), session.base());
    assert!(matches!(session.undo("undo", 1), Err(HistoryError::NothingToUndo { .. })));
    assert_eq!(seeds(&session), [2, 3, 4, 3, 2, 3, 4, 2, 1]);
    // The walk is the same for a process that comes later.
    let mut later = open(&store, Some("s1")).unwrap();
    assert_eq!(later.redo("redo", 1).unwrap().note, "forward to v1");
    turn(&mut later, 9);
    assert!(matches!(later.redo("redo", 1), Err(HistoryError::NothingToRedo { .. })));
    assert_eq!(later.undo("undo", 1).unwrap().spec.seed, 2);
}

#[test]
fn going_back_by_name_is_a_change_of_its_own() {
    let (_home, store) = store();
    let mut session = session(&store);
    for seed in [2, 3, 4] {
        turn(&mut session, seed);
    }
    let back = session.back_to("back to the first", "first").unwrap();
    assert_eq!((back.name.as_str(), back.note.as_str(), back.spec.seed), ("v4", "back to v1", 2));
    assert_eq!(session.undo("undo", 1).unwrap().note, "back to v3");
    assert_eq!(session.back_to("", "start").unwrap().spec.seed, 1);
    assert!(session.back_to("", "v77").is_err());
    assert_eq!(session.versions().len(), 6);
}

#[test]
fn a_spec_that_was_taken_over_has_nothing_before_it() {
    let (_home, store) = store();
    let mut session = session(&store);
    let base = session.base().clone();
    session.commit("run a.toml", Author::Literal, &[], &base).unwrap();
    assert!(matches!(session.undo("undo", 1), Err(HistoryError::NothingToUndo { .. })));
    turn(&mut session, 5);
    assert_eq!(session.undo("undo", 5).unwrap().note, "back to v1, all that there is: 1 of 5 steps");
}

#[test]
fn sessions_are_found_in_the_order_of_use() {
    let (_home, store) = store();
    assert!(matches!(open(&store, None), Err(HistoryError::NoSuchSession { .. })));
    let mut first = session(&store);
    turn(&mut first, 1);
    turn(&mut session(&store), 1);
    let mut named = sessions(&store).start(Some("vases"), Spec::of_scene("builtin:demo")).unwrap();
    assert_eq!(open(&store, None).unwrap().name(), "s2", "nothing was said in the newest one");
    assert!(sessions(&store).has("vases").unwrap() && !sessions(&store).has("s9").unwrap());
    turn(&mut named, 1);
    assert_eq!(names(&store), ["s1", "s2", "vases"]);
    assert_eq!(open(&store, None).unwrap().name(), named.name());
    turn(&mut first, 2);
    assert_eq!(names(&store), ["s2", "vases", "s1"]);
    assert_eq!(session(&store).name(), "s4");
    let start = |name| sessions(&store).start(Some(name), Spec::of_scene("builtin:demo"));
    assert!(matches!(start("vases"), Err(HistoryError::SessionExists { .. })));
    assert!(matches!(start("../vases"), Err(HistoryError::BadName { .. })));
    assert!(matches!(open(&store, Some("../vases")), Err(HistoryError::NoSuchSession { .. })));
}

#[test]
fn the_scene_is_found_from_anywhere_and_the_camera_is_kept() {
    let (home, store) = store();
    let base = Spec::of_scene("vase.splat").absolute_from(home.path()).unwrap();
    let mut session = sessions(&store).start(None, base).unwrap();
    assert!(std::path::Path::new(&session.base().scene.file).is_absolute());
    assert_eq!(session.camera(), None);
    let camera = phystalk::spec::Camera { eye_m: [1.0, 2.0, 0.1 + 0.2], target_m: [0.0; 3], fov_deg: 45.0, orbit_deg_s: 0.0 };
    session.keep_camera(&camera).unwrap();
    assert_eq!(open(&store, Some("s1")).unwrap().camera(), Some(camera));
}

#[test]
fn a_crash_after_any_byte_leaves_a_history_that_reads() {
    let (_home, store) = store();
    let mut session = session(&store);
    turn(&mut session, 2);
    turn(&mut session, 3);
    session.undo("undo", 1).unwrap();
    let path = store.dir().join("history/session-s1.jsonl");
    let whole = fs::read(&path).unwrap();
    let ends: Vec<usize> = whole.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1).collect();
    assert_eq!(ends.len(), 4);
    // What a crash leaves is a head of the line before, or none.
    fs::remove_file(store.dir().join("history/session-s1.head")).unwrap();
    for cut in (0..whole.len()).step_by(37).chain(ends.iter().flat_map(|end| [end - 1, *end])) {
        fs::write(&path, &whole[..cut]).unwrap();
        let lines = ends.iter().filter(|end| **end <= cut).count();
        match open(&store, Some("s1")) {
            Ok(opened) => {
                assert_eq!(opened.versions().len() + 1, lines, "cut at {cut}");
                assert_eq!(opened.dropped_torn_line(), !ends.contains(&cut));
                assert_eq!(opened.versions(), &session.versions()[..lines - 1]);
            }
            Err(error) => assert!(lines == 0 && matches!(error, HistoryError::NoSuchSession { .. }), "{error} at {cut}"),
        }
    }
    // And it goes on from there.
    fs::write(&path, &whole[..whole.len() - 5]).unwrap();
    let mut opened = open(&store, Some("s1")).unwrap();
    assert_eq!(turn(&mut opened, 7).name, "v3");
    assert_eq!(seeds(&open(&store, Some("s1")).unwrap()), [2, 3, 7]);
    // A torn list of sessions loses the order of use, not a session.
    fs::write(store.dir().join("history/sessions.jsonl"), b"{\"sess").unwrap();
    assert_eq!(self::session(&store).name(), "s2");
    assert_eq!(open(&store, Some("s1")).unwrap().versions().len(), 3);
}

/// What a user may do in a turn.
#[derive(Clone, Debug)]
enum Step {
    Turn(u32),
    Undo(u32),
    Redo(u32),
    Back(u32),
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        3 => (2..1000_u32).prop_map(Step::Turn),
        2 => (1..4_u32).prop_map(Step::Undo),
        2 => (1..4_u32).prop_map(Step::Redo),
        1 => (1..9_u32).prop_map(Step::Back),
    ];
    prop::collection::vec(step, 0..10)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// After anything: n undos and n redos lead back to the same spec, nothing that was there is gone,
    /// and a process that comes later sees the same.
    #[test]
    fn redo_takes_back_undo(steps in steps()) {
        let (_home, store) = store();
        let mut session = session(&store);
        for step in steps {
            let before = session.versions().to_vec();
            let made = match step {
                Step::Turn(seed) => { turn(&mut session, seed); true }
                Step::Undo(steps) => session.undo("undo", steps).is_ok(),
                Step::Redo(steps) => session.redo("redo", steps).is_ok(),
                Step::Back(number) => session.back_to("back", &format!("v{number}")).is_ok(),
            };
            prop_assert_eq!(&session.versions()[..before.len()], &before[..]);
            prop_assert_eq!(session.versions().len(), before.len() + usize::from(made));
        }
        let spec = session.spec().clone();
        let mut undone = 0;
        while session.undo("undo", 1).is_ok() {
            undone += 1;
        }
        prop_assert_eq!(session.spec(), session.base());
        for _ in 0..undone {
            session.redo("redo", 1).unwrap();
        }
        prop_assert_eq!(session.spec(), &spec);
        let later = open(&store, Some(session.name())).unwrap();
        prop_assert_eq!(later.versions(), session.versions());
        prop_assert_eq!(later.spec(), session.spec());
    }
}
