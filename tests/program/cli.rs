//! The program from outside: commands, exit codes, what is on which stream.
#![allow(clippy::unwrap_used)] // helpers of tests fail by panicking, as tests do

use std::process::{Command, Output};

fn phystalk(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_phystalk")).args(arguments).env_remove("XDG_RUNTIME_DIR").output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_wrong_command_line_exits_2_and_prints_no_result() {
    for arguments in [&["--no-such-flag"][..], &["schema", "nothing"], &["doctor", "--size", "big"]] {
        let output = phystalk(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stderr));
        assert!(output.stdout.is_empty());
        assert!(text(&output.stderr).starts_with("error:"));
    }
}

#[test]
fn help_and_version_are_results() {
    for (arguments, expected) in [(&["--help"][..], "Usage: phystalk"), (&["--version"], env!("CARGO_PKG_VERSION"))] {
        let output = phystalk(arguments);
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stdout).contains(expected));
    }
}

#[test]
fn schemas_are_json_schemas() {
    for what in ["spec", "edit", "events", "metrics"] {
        let output = phystalk(&["schema", what]);
        assert_eq!(output.status.code(), Some(0));
        let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(schema["$schema"].as_str().unwrap().contains("json-schema.org"), "{what}");
    }
}

#[test]
fn completions_for_the_usual_shells() {
    for shell in ["bash", "zsh", "fish"] {
        let output = phystalk(&["completions", shell]);
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stdout).contains("phystalk"));
    }
}

#[test]
fn another_provider_exits_4() {
    let output = phystalk(&["doctor", "--provider", "openai"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(text(&output.stderr).contains("only the phrasebook is built"));
}

#[test]
fn doctor_finds_a_device_and_no_driver_noise() {
    let output = phystalk(&["doctor", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(!found["adapters"].as_array().unwrap().is_empty());
    assert_eq!(text(&output.stderr), "", "drivers must not write to the terminal");
}

#[test]
fn doctor_without_an_adapter_exits_6_and_says_what_to_install() {
    let output = phystalk(&["doctor", "--device", "no adapter has this name"]);
    assert_eq!(output.status.code(), Some(6));
    assert!(text(&output.stdout).contains("apt install"));
}
