//! What the program's tests share: a folder with a small scene, and the program run in it.
#![allow(clippy::unwrap_used, dead_code)] // helpers of tests fail by panicking, and not every test needs all

use phystalk::scene::{Gaussians, write};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A block of Gaussians, 0.4 m high, that stands on z = 0.
pub fn block() -> Gaussians {
    let n = 8;
    let at = |i: usize| ((i % n) as f32, (i / n % n) as f32, (i / n / n) as f32);
    let count = n * n * n;
    let mean = (0..count).map(at).map(|(x, y, z)| glam::Vec3::new(x - 3.5, y - 3.5, z) * 0.05).collect();
    Gaussians {
        mean,
        scale: vec![glam::Vec3::splat(0.025); count],
        rotation: vec![[1.0, 0.0, 0.0, 0.0]; count],
        opacity: vec![0.95; count],
        sh_degree: 0,
        sh: (0..count).flat_map(|i| [at(i).2 / 8.0, 0.4, -at(i).0 / 8.0]).collect(),
    }
}

/// A folder of its own with `block.ply` in it, removed at the end.
pub struct Desk(tempfile::TempDir);

impl Desk {
    /// An empty store, one scene.
    pub fn new() -> Desk {
        let folder = tempfile::tempdir().unwrap();
        write(&folder.path().join("block.ply"), &block()).unwrap();
        Desk(folder)
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program, to be run in the folder.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_phystalk"));
        command.args(arguments).current_dir(self.0.path()).env_remove("XDG_RUNTIME_DIR");
        // The tests leave no trace in the user's list of stores.
        command.env("XDG_STATE_HOME", self.path("state"));
        command
    }

    /// Runs the program.
    pub fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs it and expects an exit code.
    pub fn expect(&self, code: i32, arguments: &[&str]) -> Output {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}\n{}\n{}", text(&output.stdout), text(&output.stderr));
        output
    }
}

/// Small and short: what most runs of these tests take.
pub const SMALL: [&str; 11] =
    ["--set", "solver.cells_across=8", "--set", "time.duration_s=0.1", "--set", "scene.up=\"+z\"", "--size", "64x48", "--out", "out", "--replace"];

/// A command line with [`SMALL`] behind it.
pub fn small<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [arguments, &SMALL].concat()
}

/// Bytes as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// One JSON value a line.
pub fn lines(bytes: &[u8]) -> Vec<Value> {
    text(bytes).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// A JSON file.
pub fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}
