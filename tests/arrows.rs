//! The arrows of ARCHITECTURE.md: data flows one way, and so do the `use` lines.

#![allow(clippy::unwrap_used, reason = "a test reads its own sources")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Which rooms of the engine each room may name, beside the leaves.
const ALLOWED: &[(&str, &[&str])] = &[
    ("spec", &["store"]),
    ("store", &[]),
    ("gpu", &[]),
    ("scene", &["gpu"]),
    ("proxy", &["scene", "gpu"]),
    ("solver", &["proxy", "scene", "gpu"]),
    ("skin", &["solver", "proxy", "scene", "gpu"]),
    ("render", &["skin", "solver", "proxy", "scene", "gpu"]),
    ("export", &[]),
    ("world", &["render", "skin", "solver", "proxy", "scene", "gpu"]),
    ("stages", &["world", "render", "skin", "solver", "proxy", "scene", "gpu", "export"]),
];

/// What anyone to their left may use.
const LEAVES: &[&str] = &["spec", "store", "sink"];

/// Names at the crate's root that stand for the sink.
const SINK: &[&str] = &["Stop", "Sink", "Frame", "Progress", "Discard"];

fn rust_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Rooms that one file names through `crate::`, outside its unit tests.
fn rooms_named(text: &str) -> Vec<String> {
    let code = text.split("\nmod tests {").next().unwrap_or(text);
    let lines = code.lines().filter(|l| !l.trim_start().starts_with("//"));
    let mut rooms = Vec::new();
    for line in lines {
        for part in line.split("crate::").skip(1) {
            let names: Vec<&str> = match part.strip_prefix('{') {
                Some(list) => list.split(['}', ';']).next().unwrap_or("").split(',').map(str::trim).collect(),
                None => vec![part],
            };
            for name in names {
                let word: String = name.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                rooms.push(if SINK.contains(&word.as_str()) { "sink".to_owned() } else { word });
            }
        }
    }
    rooms
}

#[test]
fn rooms_only_name_rooms_to_their_right() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let allowed: BTreeMap<&str, &[&str]> = ALLOWED.iter().copied().collect();
    let mut wrong = Vec::new();
    for (room, right) in &allowed {
        let folder = source.join(room);
        if !folder.is_dir() {
            continue;
        }
        let mut files = Vec::new();
        rust_files(&folder, &mut files);
        for file in files {
            for named in rooms_named(&fs::read_to_string(&file).unwrap()) {
                let leaf = LEAVES.contains(&named.as_str()) && !["gpu", "spec", "store"].contains(room);
                let fine = leaf || named == *room || right.contains(&named.as_str());
                if (allowed.contains_key(named.as_str()) || named == "sink") && !fine {
                    wrong.push(format!("{} names `{named}`, which is not to the right of `{room}`", file.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_room_of_the_engine_is_in_the_table() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for entry in fs::read_dir(source).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            assert!(ALLOWED.iter().any(|(room, _)| *room == name), "src/{name} has no arrows: add it to tests/arrows.rs and ARCHITECTURE.md");
        }
    }
}

#[test]
fn the_engine_names_no_language_terminal_or_window() {
    let manifest = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap();
    let dependencies = manifest.split("[dependencies]").nth(1).unwrap().split("\n[").next().unwrap();
    for foreign in ["clap", "ratatui", "crossterm", "eframe", "tokio", "genai", "axum"] {
        assert!(!dependencies.contains(foreign), "the engine depends on {foreign}");
    }
}

#[test]
fn the_program_names_no_kernels() {
    let manifest = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("agent/Cargo.toml")).unwrap();
    assert!(!manifest.lines().any(|l| l.starts_with("wgpu")), "agent/Cargo.toml names wgpu: the engine owns the device");
}
