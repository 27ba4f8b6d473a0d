//! Several writers of one session: a commit is a compare-and-swap on the head.

use super::*;

#[test]
fn a_commit_on_a_head_that_moved_is_refused_and_says_what_moved() {
    let (_home, store) = store();
    let mut ours = session(&store);
    turn(&mut ours, 2);
    let mut theirs = open(&store, None).unwrap();
    turn(&mut theirs, 3);
    let edits = [Edit::set("time.fps", 25)];
    let spec = ours.spec().apply(&edits).unwrap();
    let refused = ours.commit("25 fps", Author::Literal, &edits, &spec).unwrap_err();
    let text = refused.to_string();
    assert!(matches!(refused, HistoryError::Moved { .. }) && text.contains("v2 (\"seed 3\")") && text.contains("phystalk diff v1 v2"), "{text}");
    for refused in [ours.undo("undo", 1), ours.redo("redo", 1), ours.back_to("back", "first")] {
        assert!(matches!(refused, Err(HistoryError::Moved { .. })));
    }
    assert_eq!(open(&store, None).unwrap().versions().len(), 2, "nothing was added");
    // Cameras and results hold whatever others added.
    ours.keep_resolved("v1", json!({}), vec![]).unwrap();
    let seen = ours.clone();
    ours.go_on().unwrap();
    assert_eq!(ours.since(&seen).iter().map(|version| version.name.as_str()).collect::<Vec<_>>(), ["v2"]);
    let merged = merge(seen.spec(), &spec, ours.spec(), &edits).unwrap();
    let version = ours.commit_merged("25 fps", Author::Literal, &edits, &merged, Some(&seen)).unwrap();
    assert_eq!((version.parent.as_deref(), version.made_on.as_deref()), (Some("v2"), Some("v1")));
    assert_eq!((ours.spec().seed, ours.spec().time.fps), (3, 25));
    assert_eq!(ours.undo("undo", 1).unwrap().spec.seed, 3, "undo takes back what was said here, not what others said");
}

#[test]
fn the_last_session_is_that_of_this_folder() {
    let (home, store) = store();
    fs::create_dir_all(home.path().join("a")).unwrap();
    let from = |folder: &str| Sessions::seen_from(&store, &home.path().join(folder));
    let start = |folder: &str| turn(&mut from(folder).start(None, Spec::of_scene("builtin:demo")).unwrap(), 2);
    start("");
    start("a");
    assert_eq!(from("").open(None).unwrap().name(), "s1");
    assert_eq!(from("a").open(None).unwrap().name(), "s2");
    fs::create_dir_all(home.path().join("b")).unwrap();
    let refused = from("b").open(None).unwrap_err().to_string();
    assert!(refused.contains("s2 (used in a)") && refused.contains("--session"), "{refused}");
    assert_eq!(from("b").of_any_folder(true).open(None).unwrap().name(), "s2");
    assert_eq!(from("b").open(Some("s1")).unwrap().name(), "s1");
}

/// What a writer wants: a value at one of a few paths.
fn wishes(writers: usize) -> impl Strategy<Value = Vec<Vec<(usize, u32)>>> {
    prop::collection::vec(prop::collection::vec((0..PATHS.len(), 2..5_u32), 1..5), writers)
}

const PATHS: [&str; 3] = ["seed", "time.fps", "solver.cells_across"];

fn value_at(spec: &Spec, path: &str) -> serde_json::Value {
    path.split('.').fold(spec.to_value(), |value, part| value[part].clone())
}

/// A turn of one of several writers: commits what it computed, merges where the head moved, gives up on a conflict.
fn write(session: &mut Session, path: &str, value: u32) -> Result<(), HistoryError> {
    let edits = [Edit::set(path, value * 10)];
    let spec = session.spec().apply(&edits).unwrap();
    let mut done = session.commit(path, Author::Literal, &edits, &spec);
    let seen = session.clone();
    while let Err(HistoryError::Moved { moved }) = done {
        session.go_on()?;
        let conflict = |conflict: Conflict| HistoryError::Conflict { moved, paths: conflict.paths, how: "" };
        let merged = merge(seen.spec(), &spec, session.spec(), &edits).map_err(conflict)?;
        done = session.commit_merged(path, Author::Literal, &edits, &merged, Some(&seen));
    }
    done.map(drop)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..ProptestConfig::default() })]

    /// Two, three and five writers at once: no accepted edit is lost unsaid. Each accepted change stands in its version,
    /// and a later version sets the same path anew only if its writer saw that change or set the same value.
    #[test]
    fn writers_at_once_lose_nothing_of_each_other(wishes in prop_oneof![wishes(2), wishes(3), wishes(5)]) {
        let (_home, store) = store();
        turn(&mut session(&store), 7);
        let accepted: usize = std::thread::scope(|scope| {
            let writers: Vec<_> = wishes.iter().map(|wishes| {
                let store = &store;
                scope.spawn(move || {
                    let mut session = open(store, None).unwrap();
                    let mut accepted = 0;
                    for (path, value) in wishes {
                        match write(&mut session, PATHS[*path], *value) {
                            Ok(()) => accepted += 1,
                            Err(HistoryError::Conflict { .. }) => {}
                            Err(other) => panic!("{other}"),
                        }
                    }
                    accepted
                })
            }).collect();
            writers.into_iter().map(|writer| writer.join().unwrap()).sum()
        });
        let session = open(&store, None).unwrap();
        prop_assert_eq!(session.versions().len(), 1 + accepted);
        for (index, version) in session.versions().iter().enumerate().skip(1) {
            prop_assert_eq!(&version.name, &format!("v{}", index + 1));
            prop_assert_eq!(version.parent.clone(), Some(format!("v{index}")), "one line of versions");
            let before = &session.versions()[index - 1].spec;
            prop_assert_eq!(&before.apply(&version.edits).unwrap(), &version.spec, "nothing but its own edits");
            let seen = version.made_on.clone().unwrap_or_else(|| format!("v{index}"));
            let path = version.edits[0].path();
            let unseen = &session.find(&seen).unwrap().spec;
            prop_assert!(value_at(before, path) == value_at(unseen, path) || value_at(before, path) == value_at(&version.spec, path));
        }
    }
}
