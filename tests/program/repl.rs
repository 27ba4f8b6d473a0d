//! The REPL in a real terminal: tmux. Where there is no tmux, the tests say so; what they check of the
//! interface itself is also checked without a terminal, by keystrokes, in the program's own tests.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::print_stderr)] // helpers of tests fail by panicking, as tests do

mod support;

use std::process::Command;
use std::time::{Duration, Instant};
use support::{Desk, text};

/// A terminal of its own, ended with the test.
struct Tmux {
    socket: String,
}

impl Tmux {
    fn start(desk: &Desk, name: &str, command: &str) -> Option<Tmux> {
        if Command::new("tmux").arg("-V").output().is_err() {
            eprintln!("tmux is not installed: the REPL was not driven in a real terminal");
            return None;
        }
        let socket = format!("phystalk-{name}-{}", std::process::id());
        let program = env!("CARGO_BIN_EXE_phystalk");
        let line = format!(
            "cd '{}' && XDG_STATE_HOME=$PWD/state {} {command}; echo \"exit code $?\"; stty -a | tr ';' '\\n' | grep -o -- '-\\?icanon'; sleep 60",
            desk.path("").display(),
            program
        );
        let started =
            Command::new("tmux").args(["-L", &socket, "-f", "/dev/null", "new-session", "-d", "-x", "80", "-y", "24", &line]).status().unwrap();
        assert!(started.success());
        Some(Tmux { socket })
    }

    fn tmux(&self, arguments: &[&str]) -> String {
        text(&Command::new("tmux").args(["-L", &self.socket]).args(arguments).output().unwrap().stdout)
    }

    fn keys(&self, keys: &[&str]) {
        self.tmux(&[&["send-keys"], keys].concat());
    }

    /// Waits until the screen shows something.
    fn wait_for(&self, what: &str) -> String {
        let end = Instant::now() + Duration::from_secs(60);
        loop {
            let screen = self.tmux(&["capture-pane", "-p"]);
            if screen.contains(what) {
                return screen;
            }
            assert!(Instant::now() < end, "never saw {what:?}:\n{screen}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Tmux {
    fn drop(&mut self) {
        self.tmux(&["kill-server"]);
    }
}

const SMALL: &str = "--set solver.cells_across=8 --set time.duration_s=0.1 --size 64x48";

#[test]
fn a_session_in_a_terminal() {
    let desk = Desk::new();
    let Some(tmux) = Tmux::start(&desk, "session", &format!("block.ply {SMALL}")) else { return };
    tmux.wait_for("say what should happen, or /help");
    tmux.keys(&["jump 10 cm", "Enter"]);
    tmux.wait_for("block: ");
    tmux.keys(&["/frame 3", "Enter"]);
    let screen = tmux.wait_for("v1   3/5");
    assert!(screen.contains('▀') || screen.contains('▄'), "a picture is shown:\n{screen}");
    tmux.keys(&["/undo", "Enter"]);
    tmux.wait_for("v2 <- v1");
    tmux.keys(&["/udno", "Enter"]);
    tmux.wait_for("did you mean /undo?");
    tmux.keys(&["/snap still.png", "Enter"]);
    tmux.wait_for("wrote still.png");
    tmux.keys(&["/quit", "Enter"]);
    let screen = tmux.wait_for("exit code 0");
    assert!(tmux.wait_for("icanon").contains("\nicanon"), "the terminal is as it was:\n{screen}");
    assert!(desk.path("still.png").is_file());
    assert!(text(&desk.expect(0, &["log"]).stdout).contains("v2"));
}

#[test]
fn another_size_is_drawn_anew() {
    let desk = Desk::new();
    let Some(tmux) = Tmux::start(&desk, "resized", &format!("block.ply {SMALL}")) else { return };
    tmux.wait_for("say what should happen, or /help");
    for (width, height) in [("60", "16"), ("120", "40"), ("40", "12"), ("100", "30")] {
        tmux.tmux(&["resize-window", "-x", width, "-y", height]);
        // The line over the composer is as wide as the screen, and nothing of it is left from before.
        let edge = "─".repeat(width.parse().unwrap());
        let screen = tmux.wait_for(&edge);
        assert_eq!(screen.lines().filter(|l| l.contains('─')).collect::<Vec<_>>(), [edge.as_str()], "{screen}");
        tmux.wait_for("say what should happen, or /help");
    }
    // A size that changes several times at once, and a key that comes in between.
    for width in ["90", "50", "70"] {
        tmux.tmux(&["resize-window", "-x", width, "-y", "24"]);
    }
    tmux.keys(&["/log", "Enter"]);
    tmux.wait_for(&"─".repeat(70));
    tmux.keys(&["/quit", "Enter"]);
    tmux.wait_for("exit code 0");
}

#[test]
fn a_termination_gives_the_terminal_back() {
    let desk = Desk::new();
    let Some(tmux) = Tmux::start(&desk, "terminated", &format!("block.ply {SMALL}")) else { return };
    tmux.wait_for("say what should happen, or /help");
    let program = env!("CARGO_BIN_EXE_phystalk");
    let shell = tmux.tmux(&["display-message", "-p", "#{pane_pid}"]);
    let children = Command::new("ps").args(["-o", "pid=,args=", "--ppid", shell.trim()]).output().unwrap();
    let child = text(&children.stdout).lines().find(|l| l.contains(program)).and_then(|l| l.split_whitespace().next().map(str::to_owned));
    assert!(Command::new("kill").args(["-TERM", &child.unwrap()]).status().unwrap().success());
    tmux.wait_for("exit code 143");
    assert!(tmux.wait_for("icanon").contains("\nicanon"), "the terminal is as it was");
}
