//! Damaged sessions: what is left of them, what is reported, how they go on.

use super::*;

/// A session with a turn, a camera, two more turns, an undo and what a run came to: seven lines.
fn seven_lines(store: &Store) -> Session {
    let mut session = session(store);
    turn(&mut session, 2);
    session.keep_camera(&phystalk::spec::Camera { eye_m: [1.0; 3], target_m: [0.0; 3], fov_deg: 45.0, orbit_deg_s: 0.0 }).unwrap();
    turn(&mut session, 3);
    turn(&mut session, 4);
    session.undo("undo", 1).unwrap();
    session.keep_resolved("v4", json!({}), vec![]).unwrap();
    session
}

#[test]
fn every_line_of_a_session_may_be_damaged_and_costs_that_line() {
    for at in 0..7 {
        for harm in ["nonsense", "an edited number", "deleted"] {
            let (_home, mut store) = store();
            let whole = seven_lines(&store);
            let path = store.dir().join("history/session-s1.jsonl");
            let mut lines: Vec<String> = fs::read_to_string(&path).unwrap().lines().map(|line| format!("{line}\n")).collect();
            match harm {
                "nonsense" => lines[at] = "nonsense\n".to_owned(),
                "an edited number" => {
                    let digit = lines[at].rfind(|c: char| c.is_ascii_digit()).unwrap();
                    let other = if &lines[at][digit..=digit] == "9" { "8" } else { "9" };
                    lines[at].replace_range(digit..=digit, other);
                }
                _ => drop(lines.remove(at)),
            }
            fs::write(&path, lines.concat()).unwrap();
            let mut opened = open(&store, None).unwrap();
            let lost = match at {
                1 => Some("v1"),
                3 => Some("v2"),
                4 => Some("v3"),
                5 => Some("v4"),
                _ => None,
            };
            let left: Vec<&Version> = whole.versions().iter().filter(|version| Some(version.name.as_str()) != lost).collect();
            let same = |a: &Version, b: &Version| (&a.name, &a.spec, &a.words, &a.parent) == (&b.name, &b.spec, &b.words, &b.parent);
            assert!(opened.versions().iter().zip(&left).all(|(a, b)| same(a, b)), "{harm} {at}");
            assert_eq!(opened.versions().len(), left.len(), "{harm} {at}");
            assert!(!opened.damage().is_empty(), "{harm} {at}");
            // Numbers never repeat, not even of what is lost, and not after a repair either.
            let next = turn(&mut opened, 9);
            assert!(whole.versions().iter().all(|version| version.name != next.name), "{harm} {at}: {}", next.name);
            store.verify(true).unwrap();
            let mut repaired = open(&store, None).unwrap();
            assert_eq!((repaired.damage(), repaired.versions().len()), (&[][..], left.len() + 1), "{harm} {at}");
            let last = turn(&mut repaired, 10);
            assert!(repaired.versions().iter().filter(|version| version.name == last.name).count() == 1 && last.name != next.name);
        }
    }
}

#[test]
fn a_damaged_list_of_sessions_is_made_anew_from_the_sessions() {
    let (_home, mut store) = store();
    for _ in 0..3 {
        turn(&mut session(&store), 2);
    }
    session(&store);
    let path = store.dir().join("history/sessions.jsonl");
    for text in [b"nonsense\nnonsense\nnonsense\n".as_slice(), b""] {
        fs::write(&path, text).unwrap();
        assert!(open(&store, Some("s2")).unwrap().damage().is_empty());
        assert!(!sessions(&store).damage().unwrap().is_empty());
        assert!(["s1", "s2", "s3"].iter().all(|name| names(&store).iter().any(|known| known == name)), "{:?}", names(&store));
        store.verify(true).unwrap();
        sessions(&store).relist().unwrap();
        assert_eq!(names(&store).iter().filter(|name| name.as_str() != "s4").count(), 3);
        assert!(sessions(&store).damage().unwrap().is_empty());
    }
}

#[test]
fn the_last_session_stays_the_last_when_a_lost_one_is_listed_again() {
    let (_home, mut store) = store();
    let mut first = session(&store);
    turn(&mut first, 2);
    turn(&mut session(&store), 2);
    turn(&mut first, 3);
    let path = store.dir().join("history/sessions.jsonl");
    let list = fs::read_to_string(&path).unwrap().replace("\"s2\"", "\"s9\"");
    fs::write(&path, list).unwrap();
    store.verify(true).unwrap();
    assert_eq!(sessions(&store).relist().unwrap(), 1);
    assert_eq!((open(&store, None).unwrap().name(), names(&store).len()), ("s1", 2));
}

#[test]
fn a_session_of_the_first_format_goes_on() {
    // A line of each operation, as the program wrote them before checksums.
    let (_home, store) = store();
    let mut session = seven_lines(&store);
    let dir = store.dir().to_owned();
    for name in ["session-s1", "sessions"] {
        let path = dir.join(format!("history/{name}.jsonl"));
        let bare = |line: &str| serde_json::from_str::<serde_json::Value>(line).unwrap()["op"].to_string() + "\n";
        let old: String = fs::read_to_string(&path).unwrap().lines().map(bare).collect();
        let old = old.replace(r#","author":"literal""#, "").replace(r#","author":"travel""#, "").replace(r#","restored":{"version":2}"#, "");
        fs::write(&path, old).unwrap();
        fs::remove_file(dir.join(format!("history/{name}.head"))).unwrap();
    }
    fs::remove_file(dir.join("id")).unwrap();
    fs::write(dir.join("format"), "1\n").unwrap();
    let store = Store::open(&dir).unwrap();
    let mut opened = open(&store, None).unwrap();
    assert_eq!((opened.damage().len(), opened.versions().len(), opened.spec()), (0, 4, session.spec()));
    assert_eq!(opened.undo("undo", 1).unwrap().note, "back to v1");
    assert!(session.undo("undo", 1).is_err(), "a process that looked before sees that the head moved");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any bytes in the place of any part of a session's files: it opens or is refused with a sentence, and every version that
    /// is left is one that was made.
    #[test]
    fn any_damage_to_the_files_of_a_session_is_borne(
        file in prop::sample::select(vec!["session-s1.jsonl", "session-s1.head", "sessions.jsonl", "sessions.head"]),
        at in 0.0..1.0_f64,
        length in 0..400_usize,
        bytes in prop::collection::vec(any::<u8>(), 0..40),
    ) {
        let (_home, mut store) = store();
        let whole = seven_lines(&store);
        let path = store.dir().join("history").join(file);
        let mut content = fs::read(&path).unwrap();
        let start = (at * content.len() as f64) as usize;
        let end = (start + length).min(content.len());
        content.splice(start..end, bytes);
        fs::write(&path, content).unwrap();
        for name in [None, Some("s1")] {
            if let Ok(opened) = open(&store, name) {
                let made = |left: &Version| whole.versions().iter().any(|version| version.name == left.name && version.spec == left.spec);
                prop_assert!(opened.versions().iter().all(made));
                prop_assert!(opened.versions().len() == 4 || !opened.damage().is_empty() || opened.dropped_torn_line());
            }
        }
        store.verify(true).unwrap();
        sessions(&store).relist().unwrap();
        prop_assert_eq!(store.verify(false).unwrap(), vec![]);
        if let Ok(mut opened) = open(&store, None) {
            turn(&mut opened, 9);
        }
    }
}
