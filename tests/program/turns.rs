//! Turns from outside: events, files, versions, goldens, signals.
#![allow(clippy::unwrap_used)] // helpers of tests fail by panicking, as tests do

mod support;

use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use support::{Desk, json, lines, small, text};

fn kinds(events: &[Value]) -> Vec<&str> {
    events.iter().map(|e| e["type"].as_str().unwrap()).collect()
}

fn actions(plan: &Value) -> Vec<&str> {
    plan["stages"].as_array().unwrap().iter().map(|s| s["action"].as_str().unwrap()).collect()
}

#[test]
fn a_turn_leaves_its_events_and_its_files() {
    let desk = Desk::new();
    let output = desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm", "-p", "undo that", "-p", "twice as heavy", "--json"]));
    let events = lines(&output.stdout);
    for (index, event) in events.iter().enumerate() {
        assert_eq!((event["seq"].as_u64(), event["v"].as_u64()), (Some(index as u64), Some(1)));
        assert!(event["ts"].as_str().unwrap().ends_with('Z'));
    }
    let kinds = kinds(&events);
    assert_eq!((kinds[0], kinds[1]), ("session.started", "turn.started"));
    assert_eq!(kinds.iter().filter(|k| **k == "turn.completed").count(), 3, "{kinds:?}");
    assert!(!kinds.contains(&"turn.failed"));
    let edited: Vec<&Value> = events.iter().filter(|e| e["type"] == "spec.edited").collect();
    let names: Vec<(Option<&str>, &str)> = edited.iter().map(|e| (e["from"].as_str(), e["to"].as_str().unwrap())).collect();
    assert_eq!(names, [(None, "v1"), (Some("v1"), "v2"), (Some("v2"), "v3")]);

    for version in ["v1", "v2", "v3"] {
        let folder = desk.path("out").join(version);
        for file in ["spec.toml", "frames/0000.png", "frames/0005.png", "metrics.json", "plan.json", "contact.png", "preview.webp"] {
            assert!(folder.join(file).is_file(), "{version}/{file}");
        }
        assert!(!folder.join("frames/0006.png").exists(), "0.1 s at 50 fps are frames 0 to 5");
        let metrics = json(&folder.join("metrics.json"));
        assert_eq!((metrics["version"].as_str(), metrics["frames"].as_u64()), (Some(version), Some(6)));
        assert_eq!(metrics["objects"]["block"]["com_m"].as_array().unwrap().len(), 6);
        assert_eq!(metrics["solver"]["nonfinite"], 0);
        assert_eq!(json(&folder.join("plan.json"))["stages"].as_array().unwrap().len(), 5);
    }
    let mass = |version: &str| json(&desk.path("out").join(version).join("metrics.json"))["objects"]["block"]["mass_kg"].as_f64().unwrap();
    assert!((mass("v3") / mass("v1") - 2.0).abs() < 1e-6);
}

#[test]
fn frames_reported_are_on_disk_and_in_order() {
    let desk = Desk::new();
    let mut child =
        desk.command(&small(&["exec", "block.ply", "-p", "jump", "--json"])).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut next = 0;
    for line in BufReader::new(child.stdout.take().unwrap()).lines() {
        let event: Value = serde_json::from_str(&line.unwrap()).unwrap();
        if event["type"] == "frame.ready" {
            assert!(desk.path(event["path"].as_str().unwrap()).is_file());
            assert_eq!(event["index"].as_u64(), Some(next));
            next += 1;
        }
    }
    assert_eq!((next, child.wait().unwrap().code()), (6, Some(0)));
}

#[test]
fn a_spec_that_was_written_runs_again_from_the_store() {
    let desk = Desk::new();
    desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm"]));
    let written = "out/v1/spec.toml";
    let plan: Value = serde_json::from_slice(&desk.expect(0, &["plan", written, "--size", "64x48", "--json"]).stdout).unwrap();
    assert_eq!(actions(&plan)[1..4], ["hit", "hit", "hit"], "{plan}");
    let run: Value = serde_json::from_slice(&desk.expect(0, &["run", written, "--size", "64x48", "--json", "--out", "again"]).stdout).unwrap();
    assert_eq!((run["version"].as_str(), run["exit_code"].as_u64()), (Some("v1"), Some(0)));
    assert_eq!(json(&desk.path("again/v1/metrics.json"))["spec"], json(&desk.path("out/v1/metrics.json"))["spec"]);
    let frame = |folder: &str| std::fs::read(desk.path(folder).join("v1/frames/0005.png")).unwrap();
    assert_eq!(frame("again"), frame("out"), "the same spec gives the same bytes");
}

#[test]
fn versions_can_be_listed_shown_and_compared() {
    let desk = Desk::new();
    desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm", "-p", "twice as heavy", "--no-render"]));
    let log: Value = serde_json::from_slice(&desk.expect(0, &["log", "--json"]).stdout).unwrap();
    assert_eq!((log["head"].as_str(), log["versions"].as_array().map(Vec::len)), (Some("v2"), Some(2)));
    assert!(text(&desk.expect(0, &["show", "v2"]).stdout).contains("density_kg_m3 = 2000"));
    assert!(text(&desk.expect(0, &["diff", "v1", "v2"]).stdout).contains("density_kg_m3"));
    desk.expect(1, &["diff", "v1", "v2", "--exit-code"]);
    desk.expect(0, &["diff", "v1", "v1", "--exit-code"]);
    assert!(text(&desk.expect(0, &["undo"]).stdout).contains("back to v1"));
    desk.expect(0, &["diff", "v1", "v3", "--exit-code"]);
    desk.expect(0, &["redo"]);
    desk.expect(0, &["diff", "v2", "v4", "--exit-code"]);
    assert!(text(&desk.expect(1, &["redo"]).stderr).contains("nothing to redo"));
    assert!(text(&desk.expect(1, &["show", "v9"]).stderr).contains("v9"));
}

#[test]
fn words_are_rehearsed_and_leave_nothing_behind() {
    let desk = Desk::new();
    let bare = desk.run(&["plan", "block.ply", "-p", "jump 10 cm", "-p", "softer", "--json"]);
    assert_eq!(bare.status.code(), Some(0), "{}", text(&bare.stderr));
    let told: Value = serde_json::from_slice(&bare.stdout).unwrap();
    assert_eq!((told["turns"].as_array().map(Vec::len), told["stages"].as_array().map(Vec::len)), (Some(2), Some(5)));
    assert_eq!(told["turns"][0]["edits"][0]["path"], "object.block.velocity_m_s");
    assert!(!desk.path(".phystalk").exists() && !desk.path("store").exists() && !desk.path("out").exists());
    desk.expect(0, &small(&["exec", "block.ply", "-p", "turn it into water at 0.1 s", "--no-render"]));
    let said = text(&desk.expect(0, &["plan", "-p", "make it heavier"]).stdout);
    assert!(said.contains("still in force: block turns into water at 0.1 s") && said.contains("density_kg_m3"), "{said}");
    assert!(text(&desk.expect(0, &["log"]).stdout).lines().all(|line| !line.contains("v2")), "no version was made");
    assert!(text(&desk.expect(0, &["show"]).stdout).contains("turn it into water"), "the newest version is shown");
    assert!(text(&desk.expect(1, &["plan", "-p", "frobnicate it"]).stderr).contains("frobnicate"));
    let compared = text(&desk.expect(0, &small(&["exec", "--continue", "-p", "compare with the first"])).stdout);
    assert!(compared.contains("v1 and v1 are the same"), "{compared}");
}

#[test]
fn words_that_mean_nothing_make_no_version() {
    let desk = Desk::new();
    let output = desk.expect(1, &small(&["exec", "block.ply", "-p", "frobnicate the xyzzy", "--json"]));
    let events = lines(&output.stdout);
    let kinds = kinds(&events);
    assert!(kinds.contains(&"not_understood") && !kinds.contains(&"spec.edited"), "{kinds:?}");
    let last = events.last().unwrap();
    assert_eq!((last["type"].as_str(), last["exit_code"].as_u64()), (Some("turn.failed"), Some(1)));
    let half = desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm frobnicate", "--no-render"]));
    assert!(text(&half.stderr).contains("frobnicate"), "understood in part: it runs and says so");
}

#[test]
fn goldens_hold_fail_and_are_updated() {
    let desk = Desk::new();
    desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm"]));
    let golden = |code: i32, more: &[&str]| {
        let base = ["golden", "v1", "--frames", "0,5", "--dir", "golden", "--size", "64x48", "--out", "beside"];
        desk.expect(code, &[&base[..], more].concat())
    };
    assert!(text(&golden(11, &[]).stderr).contains("--update"));
    golden(0, &["--update"]);
    let held: Value = serde_json::from_slice(&golden(0, &["--json"]).stdout).unwrap();
    assert_eq!((held["held"].as_bool(), held["frames"].as_array().map(Vec::len)), (Some(true), Some(2)));
    assert!(held["tolerance"]["psnr_db"].is_number());
    golden(11, &["--set", "object.block.offset_m=[0, 0, 0.1]"]);
    assert!(desk.path("beside/0000-actual.png").is_file() && desk.path("beside/0000-difference.png").is_file());
    golden(1, &["--frames", "99"]);
}

#[test]
fn bad_input_is_one_message_and_the_right_code() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("folder")).unwrap();
    std::fs::write(desk.path("empty.splat"), b"").unwrap();
    std::fs::write(desk.path("text.ply"), b"hello").unwrap();
    std::fs::write(desk.path("file"), b"").unwrap();
    std::fs::write(desk.path("bad.toml"), b"format = 1\n[scene]\nfile = \"block.ply\"\ngravty = 1\n").unwrap();
    let cases: [(i32, &[&str], &str); 13] = [
        (1, &["exec", "nowhere.splat", "-p", "jump"], "nowhere.splat"),
        (1, &["exec", "folder", "-p", "jump"], "folder"),
        (1, &["exec", "empty.splat", "-p", "jump"], "empty.splat"),
        (1, &["exec", "text.ply", "-p", "jump"], "text.ply"),
        (1, &["scene", "info", "text.ply"], "text.ply"),
        (3, &["run", "bad.toml"], "gravty"),
        (1, &["run", "nowhere.toml"], "nowhere.toml"),
        (3, &["exec", "block.ply", "-p", "jump", "--set", "object.block.material.young=3"], "young_pa"),
        (1, &["exec", "block.ply", "-p", "jump", "--out", "file/in/a/file"], "--out"),
        (6, &["exec", "block.ply", "-p", "jump", "--device", "no such device"], "no such device"),
        (1, &["dmeo"], "did you mean `phystalk demo`"),
        (2, &["block.ply"], "needs a terminal"),
        (1, &["nofile.splat"], "nofile.splat"),
    ];
    for (code, arguments, named) in cases {
        let output = desk.expect(code, arguments);
        let said = text(&output.stderr);
        assert!(said.contains(named), "{arguments:?}: {said}");
        assert_eq!(said.matches("error: ").count(), 1, "{arguments:?}: {said}");
    }
    assert!(text(&desk.expect(1, &["log"]).stderr).contains("there is no session yet"), "nothing of this made a version");
}

#[test]
fn a_session_without_a_version_is_not_the_last_one() {
    let desk = Desk::new();
    desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm", "--no-render"]));
    desk.expect(1, &small(&["exec", "block.ply", "-p", ""]));
    let log = text(&desk.expect(0, &["log"]).stdout);
    assert!(log.contains("session s1") && log.contains("v1") && !log.contains("not run"), "{log}");
    // By its name it is there all the same, and goes on.
    desk.expect(0, &small(&["exec", "--session", "s2", "-p", "twice as heavy", "--no-render"]));
    assert!(text(&desk.expect(0, &["log"]).stdout).contains("session s2"));
    desk.expect(0, &["undo"]);
    assert!(text(&desk.expect(0, &["log"]).stdout).contains("not run to its end"), "an undo alone runs nothing");
}

#[test]
fn the_automatic_stiffness_is_known_before_the_first_run() {
    let desk = Desk::new();
    let first = text(&desk.expect(0, &small(&["exec", "block.ply", "-p", "softer", "--no-render"])).stdout);
    let spec = std::fs::read_to_string(desk.path("out/v1/spec.toml")).unwrap();
    desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm", "--no-render"]));
    let metrics = json(&desk.path("out/v1/metrics.json"));
    let automatic = metrics["resolved"]["object.block.material.young_pa"].as_f64().unwrap();
    assert!(spec.contains(&format!("young_pa = {}", automatic / 2.0)), "{automatic}: {first}\n{spec}");
}

#[test]
#[cfg(unix)]
fn an_interrupted_run_keeps_what_is_done() {
    let desk = Desk::new();
    let long = [
        "exec",
        "block.ply",
        "-p",
        "jump",
        "--json",
        "--set",
        "solver.cells_across=8",
        "--set",
        "time.duration_s=60",
        "--size",
        "64x48",
        "--out",
        "out",
    ];
    let mut child = desk.command(&long).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut events = Vec::new();
    for line in BufReader::new(child.stdout.take().unwrap()).lines() {
        let event: Value = serde_json::from_str(&line.unwrap()).unwrap();
        if event["type"] == "frame.ready" && event["index"] == 2 {
            assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        }
        events.push(event);
    }
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let last = events.last().unwrap();
    assert_eq!((last["type"].as_str(), last["exit_code"].as_u64()), (Some("turn.cancelled"), Some(130)));
    assert!(desk.path("out/v1/frames/0002.png").is_file() && desk.path("out/v1/contact.png").is_file());
    assert!(text(&desk.expect(0, &["log"]).stdout).contains("v1"), "the version is kept");
}

#[test]
fn stills_are_drawn_for_one_camera_or_many() {
    let desk = Desk::new();
    let camera = r##"{"width": 40, "height": 30, "fx": 40, "fy": 40, "cx": 20, "cy": 15, "background": "#ffffff",
        "world_to_camera": [[1,0,0,0],[0,1,0,-0.175],[0,0,1,1],[0,0,0,1]]}"##;
    std::fs::write(desk.path("one.json"), camera).unwrap();
    std::fs::write(desk.path("two.json"), format!("[{camera}, {camera}]")).unwrap();
    desk.expect(0, &["still", "block.ply", "--camera", "one.json", "-o", "one.png"]);
    let picture = phystalk::export::read_png(&desk.path("one.png")).unwrap();
    assert_eq!(picture.size, [40, 30]);
    let corner = &picture.rgba8[..3];
    let middle = &picture.rgba8[(15 * 40 + 20) * 4..][..3];
    assert!(corner == [255; 3] && middle != [255; 3], "{corner:?} {middle:?}");
    desk.expect(0, &["still", "block.ply", "--camera", "two.json", "-o", "many_%d.exr"]);
    assert!(desk.path("many_0.exr").is_file() && desk.path("many_1.exr").is_file());
    desk.expect(2, &["still", "block.ply", "--camera", "two.json", "-o", "many.png"]);
    desk.expect(2, &["still", "block.ply", "--camera", "one.json", "-o", "one.jpg"]);
    // Without a camera all of it is in the picture.
    desk.expect(0, &["still", "block.ply", "--size", "64x48", "-o", "usual.png"]);
    let picture = phystalk::export::read_png(&desk.path("usual.png")).unwrap();
    let white = |x: usize, y: usize| picture.rgba8[(y * 64 + x) * 4..][..3] == [255; 3];
    assert!(!white(32, 24) && (0..64).all(|x| white(x, 0) && white(x, 47)) && (0..48).all(|y| white(0, y) && white(63, y)));
}

#[test]
fn scenes_are_described_and_converted() {
    let desk = Desk::new();
    let info: Value = serde_json::from_slice(&desk.expect(0, &["scene", "info", "block.ply", "--json"]).stdout).unwrap();
    assert_eq!((info["gaussians"].as_u64(), info["sh_degree"].as_u64(), info["format"].as_str()), (Some(512), Some(0), Some("ply")));
    let short: Value = serde_json::from_slice(&desk.expect(0, &["scene", "block.ply", "--json"]).stdout).unwrap();
    assert_eq!(short, info);
    for key in ["bounds", "up_guess", "floaters"] {
        assert!(!info[key].is_null(), "{key}");
    }
    desk.expect(0, &["convert", "block.ply", "a.splat"]);
    desk.expect(0, &["convert", "a.splat", "b.ply"]);
    desk.expect(0, &["convert", "b.ply", "c.splat"]);
    assert_eq!(std::fs::read(desk.path("a.splat")).unwrap(), std::fs::read(desk.path("c.splat")).unwrap());
}

#[test]
fn undo_and_redo_with_files_are_one_json_object() {
    let desk = Desk::new();
    desk.expect(0, &small(&["exec", "block.ply", "-p", "jump 10 cm", "-p", "heavier", "--no-render"]));
    for (command, from, to) in [("undo", "v2", "v3"), ("redo", "v3", "v4")] {
        let output = desk.expect(0, &[command, "--json", "--no-render", "--size", "64x48", "--out", "again"]);
        let [object] = lines(&output.stdout).try_into().unwrap();
        let folder = format!("again/{to}");
        let found = [&object["session"], &object["from"], &object["to"], &object["version"], &object["out"]].map(|v| v.as_str().unwrap());
        assert_eq!(found, ["s1", from, to, to, &folder]);
        assert_eq!((object["metrics"]["version"].as_str(), object["plan"]["stages"].as_array().unwrap().len()), (Some(to), 5));
        assert!(object["note"].is_string() && object["error"].is_null() && desk.path(&folder).join("spec.toml").is_file());
    }
    let output = desk.expect(1, &["redo", "--json", "--no-render", "--out", "again"]);
    let [object] = lines(&output.stdout).try_into().unwrap();
    assert!(object["to"].is_null() && object["version"].is_null() && object["error"].as_str().unwrap().starts_with("nothing to redo"));
}
