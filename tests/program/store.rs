//! The store from outside: whose it is, what is made and what is not, several writers, kills, damage, repair.
#![allow(clippy::unwrap_used)] // helpers of tests fail by panicking, as tests do

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};
use support::{Desk, json, lines, small, text};

/// A desk with a session of one version.
fn desk() -> Desk {
    let desk = Desk::new();
    desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm", "--no-render"]));
    desk
}

/// Going on with the session, without pictures.
fn go_on<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["exec", "--continue", "--no-render", "--size", "64x48", "--out", "out"], more].concat()
}

fn spec(desk: &Desk) -> Value {
    let shown: Value = serde_json::from_slice(&desk.expect(0, &["show", "--json"]).stdout).unwrap();
    shown["spec"].clone()
}

fn versions(desk: &Desk) -> Vec<String> {
    let log: Value = serde_json::from_slice(&desk.expect(0, &["log", "--json"]).stdout).unwrap();
    log["versions"].as_array().unwrap().iter().map(|version| version["name"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn a_store_that_came_with_a_folder_is_refused_until_it_is_accepted() {
    let desk = desk();
    // Another user of the same program, with another list: to them the store came with the folder.
    let other = |arguments: &[&str]| desk.command(arguments).env("XDG_STATE_HOME", desk.path("other")).output().unwrap();
    for arguments in [&["log"][..], &["exec", "--continue", "-p", "softer"], &["undo"], &["store", "gc"], &["plan"], &["block.ply"], &["run", "v1"]] {
        let refused = other(arguments);
        if arguments != ["block.ply"] {
            assert_eq!(refused.status.code(), Some(9), "{arguments:?}: {}", text(&refused.stderr));
            assert!(text(&refused.stderr).contains("phystalk store accept"), "{}", text(&refused.stderr));
        }
    }
    assert_eq!(other(&["scene", "info", "block.ply"]).status.code(), Some(0), "what needs no store asks for none");
    let advice: Value = serde_json::from_slice(&other(&["doctor", "--json"]).stdout).unwrap();
    assert!(advice["advice"].to_string().contains("phystalk store accept"), "{advice}");
    assert_eq!(versions(&desk), ["v1"]);
    assert_eq!(other(&["log", "--store", "."]).status.code(), Some(0), "naming a store, or the folder that holds it, accepts it");
    assert_eq!(other(&["log"]).status.code(), Some(0));
    // The copy of an accepted store is another one.
    fs::create_dir(desk.path("clone")).unwrap();
    fs::rename(desk.path(".phystalk"), desk.path("clone/.phystalk")).unwrap();
    let here = |arguments: &[&str]| desk.command(arguments).current_dir(desk.path("clone")).output().unwrap();
    assert_eq!(here(&["log"]).status.code(), Some(9));
    assert_eq!(here(&["store", "accept", "."]).status.code(), Some(0));
    assert_eq!(here(&["log"]).status.code(), Some(0));
}

/// Runs only as root, who alone can be two users; on other accounts what it checks is that a foreign owner cannot be made up.
#[test]
#[cfg(unix)]
fn a_store_of_another_user_is_refused_by_name() {
    use std::os::unix::fs::{MetadataExt, chown};
    let desk = desk();
    let folder = desk.path(".phystalk");
    let own = fs::metadata(&folder).unwrap().uid();
    let foreign = if own == 12345 { 12346 } else { 12345 };
    match chown(&folder, Some(foreign), None) {
        Ok(()) => {
            let refused = desk.command(&["log"]).env("XDG_STATE_HOME", desk.path("other")).output().unwrap();
            assert_eq!(refused.status.code(), Some(9));
            assert!(text(&refused.stderr).contains(&format!("belongs to user {foreign}")), "{}", text(&refused.stderr));
            assert!(text(&desk.expect(0, &["log"]).stdout).contains("v1"), "one that was accepted is used whoever owns it");
        }
        Err(error) => assert_eq!(error.kind(), std::io::ErrorKind::PermissionDenied),
    }
}

#[test]
#[cfg(unix)]
fn a_store_with_links_removes_nothing_beyond_them() {
    for part in ["tmp", "cache", "history", "pins"] {
        let desk = desk();
        fs::create_dir_all(desk.path("letters/simulate/k")).unwrap();
        fs::write(desk.path("letters/simulate/k/letter.txt"), b"dear").unwrap();
        let inside = desk.path(".phystalk").join(part);
        let _ = fs::remove_dir_all(&inside);
        std::os::unix::fs::symlink("../letters", &inside).unwrap();
        let refused = desk.expect(10, &["log"]);
        assert!(text(&refused.stderr).contains(part) && text(&refused.stderr).contains("a symbolic link"), "{}", text(&refused.stderr));
        desk.expect(10, &small(&["exec", "block.ply", "-p", "jump", "--no-render"]));
        assert_eq!(fs::read(desk.path("letters/simulate/k/letter.txt")).unwrap(), b"dear", "{part}");
    }
}

#[test]
fn what_keeps_nothing_makes_no_store() {
    let desk = Desk::new();
    let made = || desk.path(".phystalk").exists();
    for (code, arguments) in [
        (0, &["still", "block.ply", "--size", "64x48", "-o", "still.png"][..]),
        (0, &["scene", "info", "block.ply"]),
        (0, &["plan", "block.ply"]),
        (0, &["doctor"]),
        (1, &["log"]),
        (1, &["show"]),
        (1, &["undo"]),
        (1, &["store", "du"]),
        (1, &["exec", "nowhere.ply", "-p", "jump"]),
        (1, &["exec", "--continue", "-p", "jump"]),
    ] {
        let output = desk.run(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", text(&output.stderr));
        assert!(!made() && !text(&output.stderr).contains("made the store"), "{arguments:?}");
    }
    let said = text(&desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm", "--no-render"])).stderr);
    assert!(said.contains("made the store") && said.contains("GB"), "{said}");
    // From a folder below, the store above is found and named, and its last session is not that of this folder.
    fs::create_dir(desk.path("below")).unwrap();
    let below = |arguments: &[&str]| desk.command(arguments).current_dir(desk.path("below")).output().unwrap();
    let log = below(&["log"]);
    assert!(text(&log.stderr).contains("using the store") && text(&log.stderr).contains("--session"), "{}", text(&log.stderr));
    assert_eq!((log.status.code(), below(&["log", "--session", "s1"]).status.code()), (Some(1), Some(0)));
}

#[test]
fn files_of_another_session_stay_until_they_may_be_replaced() {
    let desk = desk();
    let first = fs::read(desk.path("out/v1/spec.toml")).unwrap();
    let again = ["exec", "block.ply", "-p", "jump 20 cm", "--no-render", "--out", "out"];
    let refused = desk.expect(1, &again);
    assert!(text(&refused.stderr).contains("another session (s1)") && text(&refused.stderr).contains("--replace"), "{}", text(&refused.stderr));
    assert_eq!((fs::read(desk.path("out/v1/spec.toml")).unwrap(), versions(&desk)), (first.clone(), vec!["v1".to_owned()]));
    desk.expect(1, &["run", "out/v1/spec.toml", "--no-render", "--out", "out"]);
    desk.expect(0, &go_on(&["-p", "twice as heavy"]));
    assert_eq!(fs::read(desk.path("out/v1/spec.toml")).unwrap(), first);
    desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 20 cm", "--no-render"]));
    assert!(fs::read(desk.path("out/v1/spec.toml")).unwrap() != first && !desk.path("out/v2/spec.toml").exists());
}

#[test]
fn the_files_of_a_version_are_had_without_a_turn() {
    let desk = desk();
    desk.expect(0, &go_on(&["-p", "twice as heavy"]));
    let run: Value = serde_json::from_slice(&desk.expect(0, &["run", "v1", "--size", "64x48", "--out", "old", "--json"]).stdout).unwrap();
    assert_eq!((run["version"].as_str(), run["session"].as_str()), (Some("v1"), Some("s1")));
    assert!(desk.path("old/v1/frames/0005.png").is_file() && desk.path("old/v1/preview.webp").is_file());
    assert_eq!(json(&desk.path("old/v1/metrics.json"))["spec"], json(&desk.path("out/v1/metrics.json"))["spec"]);
    assert_eq!(versions(&desk), ["v1", "v2"]);
    desk.expect(1, &["run", "v9", "--out", "old"]);
    desk.expect(2, &["run", "v1", "--set", "seed=2", "--out", "old"]);
}

/// Starts all command lines at once and waits for them.
fn at_once(desk: &Desk, all: &[Vec<&str>]) -> Vec<Output> {
    let spawn = |arguments: &Vec<&str>| desk.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let children: Vec<_> = all.iter().map(spawn).collect();
    children.into_iter().map(|child| child.wait_with_output().unwrap()).collect()
}

#[test]
fn processes_that_change_different_things_at_once_all_get_their_way() {
    let desk = desk();
    let said = [
        &["-p", "twice as heavy"][..],
        &["-p", "on the moon"],
        &["--set", "seed=5"],
        &["--set", "output.background=\"#000000\""],
        &["--set", "object.block.material.poisson=0.4"],
    ];
    let outputs = at_once(&desk, &said.map(|more| go_on(more)));
    for (said, output) in said.iter().zip(&outputs) {
        assert_eq!(output.status.code(), Some(0), "{said:?}: {}", text(&output.stderr));
    }
    let spec = spec(&desk);
    let material = &spec["object"][0]["material"];
    assert_eq!((material["density_kg_m3"].as_f64(), spec["world"]["gravity_m_s2"][2].as_f64()), (Some(2000.0), Some(-1.62)), "{spec}");
    assert_eq!((spec["seed"].as_u64(), material["poisson"].as_f64()), (Some(5), Some(0.4)), "{spec}");
    assert_eq!(versions(&desk), ["v1", "v2", "v3", "v4", "v5", "v6"]);
}

#[test]
fn processes_that_change_the_same_thing_at_once_lose_nothing_unsaid() {
    let desk = desk();
    desk.expect(0, &go_on(&["--set", "object.block.material.young_pa=800000"]));
    let outputs = at_once(&desk, &[go_on(&["-p", "softer"]), go_on(&["-p", "softer"]), go_on(&["-p", "softer"])]);
    let accepted = outputs.iter().filter(|output| output.status.code() == Some(0)).count();
    for refused in outputs.iter().filter(|output| output.status.code() != Some(0)) {
        let said = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(1), "{said}");
        assert!(said.contains("by another process") && said.contains("young_pa") && said.contains("say it again"), "{said}");
    }
    assert!(accepted >= 1);
    let young = spec(&desk)["object"][0]["material"]["young_pa"].as_f64().unwrap();
    assert_eq!(young, 800_000.0 / f64::from(1 << accepted), "each accepted turn halved it once");
    assert_eq!(versions(&desk).len(), 2 + accepted);
}

#[test]
fn a_kill_at_any_write_of_a_turn_loses_nothing_that_was_reported() {
    // How many writes a whole turn takes.
    let desk = desk();
    let kill_at = |at: u64, turn: &str| desk.command(&go_on(&["--json", "-p", turn])).env("PHYSTALK_KILL_AT_WRITE", at.to_string()).output().unwrap();
    // Every write where asked for, else a spread of them.
    let step = if std::env::var_os("PHYSTALK_TEST_ALL_KILLS").is_some() { 1 } else { 9 };
    let mut killed = 0;
    for at in (0..).step_by(step) {
        let before = versions(&desk);
        let output = kill_at(at, &format!("jump {} cm", 11 + at));
        let reported: Vec<String> = lines_of_whole_events(&output).into_iter().filter_map(|event| Some(event["to"].as_str()?.to_owned())).collect();
        let after = versions(&desk);
        assert!(
            after.starts_with(&before) && reported.iter().all(|version| after.contains(version)),
            "killed at write {at}: {before:?} {reported:?} {after:?}"
        );
        let verified = desk.run(&["store", "verify", "--json"]);
        assert_eq!(verified.status.code(), Some(0), "killed at write {at}: {}", text(&verified.stdout));
        if output.status.success() {
            break;
        }
        killed += 1;
        assert!(at < 1000, "the turn never got through");
    }
    assert!(killed >= 4, "{killed}");
    desk.expect(0, &go_on(&["-p", "twice as heavy"]));
}

/// Events of a stream that a kill may have cut.
fn lines_of_whole_events(output: &Output) -> Vec<Value> {
    text(&output.stdout).lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

#[test]
fn damage_is_reported_with_what_to_type_and_repaired() {
    let desk = desk();
    desk.expect(0, &go_on(&["-p", "twice as heavy"]));
    desk.expect(0, &["store", "verify"]);
    let log = desk.path(".phystalk/history/session-s1.jsonl");
    let whole = fs::read_to_string(&log).unwrap();
    fs::write(&log, whole.replace("\"density_kg_m3\":2000", "\"density_kg_m3\":2001")).unwrap();
    let shown = desk.expect(0, &["log"]);
    assert!(text(&shown.stdout).contains("v1") && !text(&shown.stdout).contains("v2"), "an edited number is not taken for what was said");
    assert!(text(&shown.stderr).contains("phystalk store verify --repair"), "{}", text(&shown.stderr));
    assert!(text(&desk.expect(0, &["doctor"]).stdout).contains("phystalk store verify --repair"));
    let found = desk.expect(10, &["store", "verify"]);
    assert!(text(&found.stdout).contains("session-s1.jsonl"), "{}", text(&found.stdout));
    desk.expect(10, &["store", "gc"]);
    desk.expect(0, &["store", "verify", "--repair"]);
    desk.expect(0, &["store", "verify"]);
    assert_eq!(text(&desk.expect(0, &["log"]).stderr), "");
    assert!(walk(&desk.path(".phystalk/backup")).iter().any(|file| fs::read_to_string(file).unwrap().contains("2001")), "a copy is kept");
    desk.expect(0, &go_on(&["-p", "twice as heavy"]));
    assert_eq!(versions(&desk), ["v1", "v3"], "numbers never repeat");
}

fn walk(folder: &Path) -> Vec<std::path::PathBuf> {
    let children = fs::read_dir(folder).unwrap().map(|child| child.unwrap().path());
    children.flat_map(|child| if child.is_dir() { walk(&child) } else { vec![child] }).collect()
}

#[test]
fn results_that_no_version_needs_are_collected() {
    let desk = desk();
    let usage = || -> Value { serde_json::from_slice(&desk.expect(0, &["store", "du", "--json"]).stdout).unwrap() };
    let full = usage();
    assert!(full["usage"]["bytes"].as_u64().unwrap() > 0 && full["usage"]["cap_bytes"].as_u64().unwrap() > 0);
    assert!(text(&desk.expect(0, &["store", "du"]).stdout).contains("at most"));
    // A result that no version needs.
    let cache = desk.path(".phystalk/cache/motion");
    let entry = fs::read_dir(&cache).unwrap().next().unwrap().unwrap().path();
    let copy = cache.join("unneeded");
    fs::create_dir(&copy).unwrap();
    for file in fs::read_dir(&entry).unwrap().map(Result::unwrap) {
        fs::copy(file.path(), copy.join(file.file_name())).unwrap();
    }
    let done: Value = serde_json::from_slice(&desk.expect(0, &["store", "gc", "--json"]).stdout).unwrap();
    assert_eq!(done["removed"]["entries"].as_u64(), Some(1), "{done}");
    assert_eq!(usage()["usage"]["bytes"], full["usage"]["bytes"]);
    let plan: Value = serde_json::from_slice(&desk.expect(0, &["plan", "v1", "--size", "64x48", "--json"]).stdout).unwrap();
    assert_eq!(plan["stages"][3]["action"], "hit", "what a version needs stays: {plan}");
    desk.expect(0, &["store", "gc", "--keep", "0"]);
    assert_eq!(usage()["usage"]["bytes"].as_u64(), Some(0));
    assert_eq!(versions(&desk), ["v1"], "versions are never removed");
    desk.expect(0, &go_on(&["-p", "twice as heavy"]));
}

#[test]
fn events_name_the_store_and_turns_survive_in_lines() {
    let desk = desk();
    let events = lines(&desk.expect(0, &go_on(&["-p", "undo that", "--json"])).stdout);
    assert!(events[0]["store"].as_str().unwrap().ends_with(".phystalk"));
}
