//! Files and systems that are not as they should be: names that are no text, pipes, sparse files, too little memory, too few
//! threads. Every one ends with an exit code of the contract and a message, never with a panic or an abort.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test of our own program")]

mod support;

use std::ffi::OsString;
use std::fs::{self, File};
use std::os::unix::ffi::OsStringExt;
use std::process::{Command, Output, Stdio};
use support::{Desk, SMALL, block, lines, text};

/// Bytes that are no UTF-8.
fn odd_name(end: &str) -> OsString {
    OsString::from_vec([b"caf\xe9 100%", end.as_bytes()].concat())
}

fn ended(output: &Output, code: i32, words: &[&str]) {
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{told}");
    words.iter().for_each(|word| assert!(told.contains(word), "`{word}` in: {told}"));
}

#[test]
fn a_scene_whose_path_is_not_utf_8_is_opened_by_every_command() {
    let desk = Desk::new();
    let folder = desk.path("").join(odd_name(""));
    fs::create_dir(&folder).unwrap();
    let scene = folder.join(odd_name(".ply"));
    fs::copy(desk.path("block.ply"), &scene).unwrap();
    let with = |arguments: &[&str]| desk.command(arguments).arg(&scene).output().unwrap();
    ended(&with(&["scene", "info"]), 0, &[]);
    ended(&desk.command(&["convert"]).arg(&scene).arg(folder.join("a.splat")).output().unwrap(), 0, &[]);
    let camera = desk.path("camera.json");
    let at = r#"{"width":8,"height":8,"fx":8,"fy":8,"cx":4,"cy":4,"world_to_camera":[[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]],"background":[0,0,0]}"#;
    fs::write(&camera, at).unwrap();
    let still = desk.command(&["still", "--json", "-o"]).arg(folder.join("a.png")).arg("--camera").arg(&camera).arg(&scene).output().unwrap();
    ended(&still, 0, &[]);
    let exec = desk.command(&SMALL).args(["exec", "--json", "-p", "jump"]).arg(&scene).output().unwrap();
    ended(&exec, 0, &[]);
    let started = lines(&exec.stdout).into_iter().find(|line| line["type"] == "session.started").unwrap();
    assert!(started["scene"].as_str().unwrap().contains("caf%E9 100%25.ply"), "{started}");
    // The spec that was written leads back to the file.
    ended(&desk.command(&["run", "out/v1/spec.toml", "--out", "again", "--no-render"]).output().unwrap(), 0, &[]);
}

#[test]
fn what_is_no_file_of_gaussians_is_refused_at_once_and_never_read_whole() {
    let desk = Desk::new();
    assert!(Command::new("mkfifo").arg(desk.path("pipe.ply")).status().unwrap().success());
    File::create(desk.path("zeros")).unwrap().set_len(1 << 40).unwrap();
    for (scene, word) in [("pipe.ply", "not a regular file"), ("/dev/zero", "not a regular file"), (".", "folder"), ("zeros", "not a splat file")] {
        ended(&desk.run(&["scene", "info", scene]), 1, &[word]);
        ended(&desk.run(&["exec", scene, "-p", "jump"]), 1, &[word]);
    }
}

#[test]
fn too_little_memory_for_a_scene_is_exit_code_6_with_the_amount() {
    let desk = Desk::new();
    let records = {
        phystalk::scene::write(&desk.path("block.splat"), &block()).unwrap();
        fs::read(desk.path("block.splat")).unwrap()
    };
    // 4.2 million Gaussians.
    fs::write(desk.path("large.splat"), records.repeat(8192)).unwrap();
    let limited = |scene: &str| {
        let program = desk.command(&[]);
        let line = format!("ulimit -v 1000000; exec {:?} scene info {scene}", program.get_program());
        Command::new("sh").args(["-c", &line]).current_dir(desk.path("")).output().unwrap()
    };
    ended(&limited("block.splat"), 0, &[]);
    ended(&limited("large.splat"), 6, &["not enough memory", "large.splat", "MiB", "ulimit -v"]);
}

/// Threads are limited for a user that nobody else is: root has no such limit.
#[test]
fn too_few_threads_are_exit_code_1_with_advice() {
    use std::os::unix::process::CommandExt;
    if !fs::metadata("/proc/self").is_ok_and(|me| std::os::unix::fs::MetadataExt::uid(&me) == 0) {
        println!("left out: only root may become a user without other processes");
        return;
    }
    let desk = Desk::new();
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(desk.path(""), fs::Permissions::from_mode(0o777)).unwrap();
    for most in [1, 4, 16] {
        let mut inner = desk.command(&[]);
        let program = inner.args(["exec", "block.ply", "-p", "jump"]).args(SMALL).arg("--cpu");
        let arguments: Vec<String> = program.get_args().map(|a| format!("'{}'", a.to_string_lossy())).collect();
        let line = format!("ulimit -u {most}; exec {:?} {}", program.get_program(), arguments.join(" "));
        let mut command = Command::new("sh");
        command.args(["-c", &line]).current_dir(desk.path("")).env("HOME", desk.path("")).stdin(Stdio::null()).uid(61_234 + most).gid(61_234);
        let output = command.output().unwrap();
        let told = text(&output.stderr);
        let code = output.status.code();
        assert!(code == Some(0) || code == Some(1) && told.contains("no more threads") || code == Some(6), "{most}: {code:?} {told}");
        let _ = fs::remove_dir_all(desk.path(".phystalk"));
        let _ = fs::remove_dir_all(desk.path("out"));
    }
}
