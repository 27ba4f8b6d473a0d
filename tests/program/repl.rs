//! The REPL in a real terminal: tmux, which `./check` installs where it may.
#![cfg(unix)]
#![allow(clippy::unwrap_used)] // helpers of tests fail by panicking, as tests do

mod support;

use std::process::Command;
use std::time::{Duration, Instant};
use support::{Desk, text};

/// A terminal of its own, ended with the test.
struct Tmux {
    socket: String,
}

impl Tmux {
    /// The program alone; then its exit code and the terminal's mode.
    fn start(desk: &Desk, name: &str, command: &str) -> Tmux {
        Tmux::open(desk, name, &format!("{PROGRAM} {command}; echo \"exit code $?\"; {MODE}; sleep 60"))
    }

    /// A shell that controls jobs, with the program in its foreground. The prompt shows the last exit code.
    fn shell(desk: &Desk, name: &str, command: &str) -> Tmux {
        let tmux = Tmux::open(desk, name, "exec bash --norc --noprofile -i");
        tmux.keys(&[&format!("PS1='exit code $? > '; {PROGRAM} {command}"), "Enter"]);
        tmux
    }

    fn open(desk: &Desk, name: &str, line: &str) -> Tmux {
        let socket = format!("phystalk-{name}-{}", std::process::id());
        let line = format!("cd '{}' && export XDG_STATE_HOME=$PWD/state && {line}", desk.path("").display());
        let started = Command::new("tmux").args(["-L", &socket, "-f", "/dev/null", "new-session", "-d", "-x", "80", "-y", "24", &line]).status();
        assert!(started.is_ok_and(|status| status.success()), "these tests need tmux: apt install tmux");
        Tmux { socket }
    }

    /// Sends the program a signal.
    fn signal(&self, signal: &str) {
        let shell = self.tmux(&["display-message", "-p", "#{pane_pid}"]);
        let children = text(&Command::new("ps").args(["-o", "pid=,args=", "--ppid", shell.trim()]).output().unwrap().stdout);
        let child = children.lines().find(|line| line.contains(PROGRAM)).and_then(|line| line.split_whitespace().next());
        assert!(Command::new("kill").args([signal, child.unwrap()]).status().unwrap().success());
    }

    /// Types bytes, escapes included.
    fn bytes(&self, desk: &Desk, bytes: &[u8]) {
        std::fs::write(desk.path("typed"), bytes).unwrap();
        self.tmux(&["load-buffer", &desk.path("typed").to_string_lossy()]);
        self.tmux(&["paste-buffer", "-r"]);
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

const PROGRAM: &str = env!("CARGO_BIN_EXE_phystalk");
/// Prints `icanon` where the terminal is in its usual mode, `-icanon` in raw mode.
const MODE: &str = "stty -a | tr ';' '\\n' | grep -o -- '-\\?icanon'";
const READY: &str = "say what should happen, or /help";
const SMALL: &str = "--set solver.cells_across=8 --set time.duration_s=0.1 --size 64x48";

#[test]
fn a_session_in_a_terminal() {
    let desk = Desk::new();
    let tmux = Tmux::start(&desk, "session", &format!("block.ply {SMALL}"));
    tmux.wait_for(READY);
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
    let tmux = Tmux::start(&desk, "resized", &format!("block.ply {SMALL}"));
    tmux.wait_for(READY);
    for (width, height) in [("60", "16"), ("120", "40"), ("40", "12"), ("100", "30")] {
        tmux.tmux(&["resize-window", "-x", width, "-y", height]);
        // The line over the composer is as wide as the screen, and nothing of it is left from before.
        let edge = "─".repeat(width.parse().unwrap());
        let screen = tmux.wait_for(&edge);
        assert_eq!(screen.lines().filter(|l| l.contains('─')).collect::<Vec<_>>(), [edge.as_str()], "{screen}");
        tmux.wait_for(READY);
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
    let tmux = Tmux::start(&desk, "terminated", &format!("block.ply {SMALL}"));
    tmux.wait_for(READY);
    tmux.signal("-TERM");
    tmux.wait_for("exit code 143");
    assert!(tmux.wait_for("icanon").contains("\nicanon"), "the terminal is as it was");
}

#[test]
fn a_paste_without_an_end_leaves_ctrl_c_working() {
    let desk = Desk::new();
    let tmux = Tmux::start(&desk, "pasted", &format!("block.ply {SMALL}"));
    tmux.wait_for(READY);
    tmux.bytes(&desk, b"\x1b[200~jump \x1b]0;title\x07high");
    tmux.wait_for("> jump ]0;titlehigh");
    tmux.keys(&["C-c"]);
    tmux.wait_for(READY);
    // Pressed before the paste is given up, it comes after the pasted text.
    tmux.bytes(&desk, b"\x1b[200~again\x03");
    tmux.keys(&["C-c"]);
    tmux.wait_for("exit code 0");
}

#[test]
fn a_stopped_program_takes_the_terminal_again() {
    let desk = Desk::new();
    let tmux = Tmux::shell(&desk, "stopped", &format!("block.ply {SMALL}"));
    tmux.wait_for(READY);
    // SIGSTOP cannot be caught: bash sets its own mode, and what is on the screen stays there.
    tmux.signal("-STOP");
    tmux.wait_for("Stopped");
    tmux.keys(&["fg", "Enter"]);
    tmux.wait_for(READY);
    tmux.keys(&["/log", "Enter"]);
    let screen = tmux.wait_for("no version yet\n");
    assert!(!screen.contains("Stopped"), "all is drawn again:\n{screen}");
    // SIGTSTP can: the shell gets a screen and a mode as it knows them.
    tmux.signal("-TSTP");
    tmux.wait_for("Stopped");
    tmux.keys(&[MODE, "Enter"]);
    let screen = tmux.wait_for("\nicanon");
    assert!(!screen.contains(READY), "the alternate screen is left:\n{screen}");
    tmux.keys(&["fg", "Enter"]);
    tmux.wait_for(READY);
    tmux.keys(&["/undo 1000", "Enter"]);
    tmux.wait_for("x ");
    tmux.keys(&["/quit", "Enter"]);
    tmux.wait_for("64x48\nexit code 0 >");
    tmux.keys(&[MODE, "Enter"]);
    tmux.wait_for("\nicanon");
}
