//! Standard output that cannot be written, for every kind of command: results that are lost are a failure, a reader that
//! left is none.
#![cfg(target_os = "linux")] // where there is a device that is always full
#![allow(clippy::unwrap_used)] // helpers of tests fail by panicking, as tests do

mod support;

use std::fs::OpenOptions;
use std::process::Stdio;
use support::{Desk, small, text};

/// Commands that print at once, as they go, and at their end; as text and as JSON.
fn kinds() -> Vec<Vec<&'static str>> {
    let plain: [&[&str]; 12] = [
        &["--help"],
        &["exec", "--help"],
        &["--version"],
        &["completions", "bash"],
        &["schema", "spec"],
        &["doctor", "--json"],
        &["scene", "info", "block.ply"],
        &["log"],
        &["show", "--json"],
        &["plan"],
        &["undo", "--json"],
        &["redo"],
    ];
    let runs: [&[&str]; 8] = [
        &["exec", "block.ply", "-p", "jump 10 cm", "--no-render"],
        &["exec", "block.ply", "-p", "jump 10 cm", "--no-render", "--json"],
        &["run", "spec.toml", "--no-render"],
        &["run", "spec.toml", "--no-render", "--json"],
        &["demo", "--no-render"],
        &["demo", "--no-render", "--json"],
        &["undo", "--session", "s1", "--no-render"],
        &["redo", "--session", "s1", "--no-render", "--json"],
    ];
    plain.into_iter().map(<[&str]>::to_vec).chain(runs.into_iter().map(small)).collect()
}

fn desk() -> Desk {
    let desk = Desk::new();
    desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm", "-p", "heavier", "--no-render"]));
    std::fs::write(desk.path("spec.toml"), "format = 1\n[scene]\nfile = \"block.ply\"\n[[object]]\nname = \"block\"\n").unwrap();
    desk
}

#[test]
fn a_full_disk_is_exit_code_1_and_the_reason() {
    let desk = desk();
    for arguments in kinds() {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = desk.command(&arguments).stdout(full).stderr(Stdio::piped()).output().unwrap();
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {errors}");
        assert!(errors.contains("error: standard output cannot be written: No space left on device"), "{arguments:?}: {errors}");
    }
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let desk = desk();
    for arguments in kinds() {
        let mut child = desk.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {errors}");
        assert!(!errors.contains("error:"), "{arguments:?}: {errors}");
    }
}
