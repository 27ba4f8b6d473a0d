//! Terminal escape injection, over every command: hostile text in file names, files, arguments and stored words is printed as
//! visible escapes, and JSON stays JSON.
#![cfg(unix)] // file names elsewhere cannot hold control characters
#![allow(clippy::unwrap_used)] // helpers of tests fail by panicking, as tests do

mod support;

use serde_json::Value;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::os::unix::ffi::OsStringExt;
use std::process::Output;
use support::{Desk, block, text};

/// Sets a window's title; 8-bit CSI; DEL; a direction override; a line separator.
const HOSTILE: &str = "\u{1b}]0;owned\u{7}\u{9b}31m\u{7f}\u{202e}\u{2028}";

/// A sentence that the phrasebook understands and the store keeps.
const WORDS: &str = "jump 10 cm \u{1b}\u{7}\u{9b}\u{7f}\u{202e}\u{2028}!";

/// Names of commands, as the program's own help lists them: a new one cannot be forgotten here.
fn commands(desk: &Desk, command: &[&str]) -> Vec<Vec<String>> {
    let help = text(&desk.expect(0, &[command, &["--help"]].concat()).stdout);
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = listed.filter_map(|line| line.strip_prefix("  ")?.split_whitespace().next()).filter(|name| *name != "help");
    let mut found = Vec::new();
    for name in names.filter(|name| name.starts_with(char::is_alphabetic)) {
        let path = [command, &[name]].concat();
        found.push(path.iter().map(|word| (*word).to_owned()).collect());
        found.extend(commands(desk, &path));
    }
    found
}

/// A folder whose files have hostile names and hold hostile text, and a session whose words are hostile.
struct Stage {
    desk: Desk,
    scene: String,
    damaged: String,
    spec: String,
    bad_spec: String,
    camera: String,
    bad_camera: String,
}

impl Stage {
    fn new() -> Stage {
        let desk = Desk::new();
        let name = |stem: &str, suffix: &str| format!("{stem}{HOSTILE}.{suffix}");
        let (scene, damaged) = (name("block", "ply"), name("damaged", "ply"));
        phystalk::scene::write(&desk.path(&scene), &block()).unwrap();
        let bytes = std::fs::read(desk.path(&scene)).unwrap();
        let header = |line: &str| [b"ply\n", line.as_bytes(), &bytes[3..]].concat();
        std::fs::write(desk.path(&damaged), header(HOSTILE)).unwrap();
        std::fs::write(desk.path(&scene), header("comment Vertical axis:\u{85}\u{2028}z")).unwrap();
        let (spec, bad_spec) = (name("spec", "toml"), name("bad", "toml"));
        let toml = |scene: &str, object: &str| {
            let quoted = |text: &str| serde_json::to_string(text).unwrap().replace('\u{7f}', "\\u007f");
            format!(
                "format = 1\n[scene]\nfile = {}\nup = \"+z\"\n[time]\nduration_s = 0.1\n[solver]\ncells_across = 8\n[[object]]\nname = {}\n",
                quoted(scene),
                quoted(object)
            )
        };
        std::fs::write(desk.path(&spec), toml(&scene, "block")).unwrap();
        std::fs::write(desk.path(&bad_spec), toml("block.ply", HOSTILE)).unwrap();
        let (camera, bad_camera) = (name("camera", "json"), name("bad", "json"));
        let view = serde_json::json!({ "width": 64, "height": 48, "fx": 60, "fy": 60, "cx": 32, "cy": 24,
            "world_to_camera": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]], "background": [1, 1, 1] });
        std::fs::write(desk.path(&camera), view.to_string()).unwrap();
        std::fs::write(desk.path(&bad_camera), serde_json::json!({ "width": HOSTILE, HOSTILE: 1 }).to_string()).unwrap();
        Stage { desk, scene, damaged, spec, bad_spec, camera, bad_camera }
    }

    /// Command lines by command, in the order in which they make sense: `exec` makes the versions that others show.
    fn invocations(&self) -> Vec<Vec<String>> {
        let small = ["--no-render", "--set", "solver.cells_across=8", "--set", "time.duration_s=0.1", "--set", "scene.up=\"+z\""];
        let (words, out) = (WORDS, format!("out{HOSTILE}"));
        let (picture, setting, splat) = (format!("picture{HOSTILE}.png"), format!("{HOSTILE}=1"), format!("copy{HOSTILE}.splat"));
        let (scene, spec, h) = (self.scene.as_str(), self.spec.as_str(), HOSTILE);
        let rows: Vec<Vec<&str>> = vec![
            [&["exec", scene, "-p", words, "-p", "heavier", "-p", h, "--out", &out], &small[..]].concat(),
            vec!["exec", "--continue", "-p", "jump 10 cm", "--set", &setting],
            vec!["exec", self.bad_spec.as_str(), "-p", "softer"],
            vec!["exec", self.damaged.as_str(), "-p", "softer"],
            vec!["log"],
            vec!["log", "--session", h],
            vec!["show", "v1"],
            vec!["show", h],
            vec!["diff", "v1", "v2"],
            vec!["diff", spec, self.bad_spec.as_str()],
            vec!["diff", spec, scene],
            vec!["plan", spec, "-p", words],
            vec!["plan", "v1", "--set", &setting],
            vec!["undo", "--out", &out, "--no-render"],
            vec!["redo", "--out", &out, "--no-render"],
            vec!["undo"],
            vec!["store", h],
            vec!["store", "du", "--store", h],
            vec!["store", "gc", "--keep", h],
            vec!["store", "verify", "--store", h],
            vec!["store", "accept", h],
            vec!["redo", "--store", &out],
            vec!["redo"],
            vec!["run", spec, "--no-render", "--out", &out],
            vec!["run", self.bad_spec.as_str()],
            vec!["scene", scene],
            vec!["scene", "info", scene],
            vec!["scene", "info", self.damaged.as_str()],
            vec!["convert", scene, &splat],
            vec!["still", scene, "--camera", self.camera.as_str(), "-o", &picture],
            vec!["still", scene, "--camera", self.bad_camera.as_str(), "-o", &picture],
            vec!["golden", spec, "--frames", "0", "--dir", &out, "--size", "64x48"],
            vec!["golden", spec, "--frames", "0", "--dir", &out, "--size", "64x48", "--update"],
            vec!["golden", spec, "--frames", "0", "--dir", &out, "--size", "64x48"],
            vec!["demo", "--set", &setting],
            vec!["view", h, "--window"],
            vec!["view", "--window", h, h],
            vec!["validate", h],
            vec!["bench", h],
            vec!["doctor", "--device", h],
            vec!["schema", h],
            vec!["completions", h],
            vec![h],
            vec![scene],
            vec![scene, h, h],
        ];
        rows.into_iter().map(|row| row.into_iter().map(str::to_owned).collect()).collect()
    }

    fn run(&self, arguments: &[OsString]) -> Output {
        let mut command = self.desk.command(&[]);
        command.args(arguments).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env("PHYSTALK_LOG", "phystalk=debug");
        command.output().unwrap()
    }

    /// Runs a command line; whether it showed what is hostile.
    fn check(&self, arguments: &[OsString]) -> bool {
        let output = self.run(arguments);
        for stream in [&output.stdout, &output.stderr] {
            let printed = text(stream);
            assert_eq!(printed.as_bytes(), stream, "{arguments:?} printed no UTF-8");
            let found = printed.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t') || matches!(c, '\u{2028}' | '\u{202e}'));
            assert_eq!(found, None, "{arguments:?} printed {printed:?}");
        }
        let code = output.status.code();
        assert!(code.is_some_and(|code| code < 70), "{arguments:?}: {code:?} {}", text(&output.stderr));
        let printed = text(&output.stdout);
        if arguments.iter().any(|a| a == "--json") {
            let values: Result<Vec<Value>, _> = serde_json::Deserializer::from_str(&printed).into_iter().collect();
            assert!(values.is_ok(), "{arguments:?}: {values:?}\n{printed}");
        }
        let escapes = |printed: &str| printed.contains("\\u{") || printed.contains("\\u00");
        escapes(&printed) || escapes(&text(&output.stderr))
    }
}

#[test]
fn no_command_prints_an_escape() {
    let stage = Stage::new();
    let commands: BTreeSet<String> = commands(&stage.desk, &[]).into_iter().map(|path| path.join(" ")).chain([String::new()]).collect();
    assert!(commands.len() > 15 && commands.contains("scene info"), "the help lists the commands: {commands:?}");
    let mut shown = BTreeSet::new();
    for row in stage.invocations() {
        let of = |words: usize| Some(row.get(..words)?.join(" ")).filter(|name| commands.contains(name));
        let command = of(2).or_else(|| of(1)).unwrap_or_default();
        for json in [None, Some("--json")] {
            let row: Vec<OsString> = row.iter().map(String::as_str).chain(json).map(OsString::from).collect();
            if stage.check(&row) {
                shown.insert(command.clone());
            }
        }
    }
    assert!(text(&stage.desk.expect(0, &["log", "--session", "s1"]).stdout).contains("jump 10 cm \\u{1b}\\u{7}\\u{9b}"), "the store keeps the words");
    // What no command takes, some of it no text.
    for command in &commands {
        for last in [format!("--no-such{HOSTILE}").into_bytes(), b"--\xff\x1b".to_vec()] {
            let words = command.split_whitespace().map(OsString::from).chain([OsString::from_vec(last)]);
            stage.check(&words.collect::<Vec<_>>());
        }
    }
    // Each command printed something hostile at least once: a new one needs a command line above.
    let silent: Vec<&String> = commands.iter().filter(|command| !shown.contains(*command)).collect();
    assert!(silent.is_empty(), "these have no command line in this test that makes them print hostile text: add one: {silent:?}");
}
