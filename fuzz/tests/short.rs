//! A short run of every target, with a fixed seed: what `./check` tries each time.
#![allow(clippy::unwrap_used, reason = "a test of our own program")]

use std::process::Command;

fn holds(target: &str, cases: &str) {
    let folder = tempfile::tempdir().unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_phystalk-fuzz"))
        .args([target, "--cases", cases, "--seed", "1"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(run.status.success(), "{target}: {}{}", String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(String::from_utf8_lossy(&run.stdout).contains(&format!("{target}: {cases} inputs")));
}

#[test]
fn ply() {
    holds("ply", "4000");
}

#[test]
fn splat() {
    holds("splat", "4000");
}

#[test]
fn specs() {
    holds("spec", "2000");
}

#[test]
fn expressions() {
    holds("expression", "4000");
}

#[test]
fn logs() {
    holds("log", "4000");
}

#[test]
fn an_unknown_target_is_refused_with_those_there_are() {
    let run = Command::new(env!("CARGO_BIN_EXE_phystalk-fuzz")).arg("nothing").output().unwrap();
    assert!(run.status.code() == Some(2) && String::from_utf8_lossy(&run.stderr).contains("expression"));
}
