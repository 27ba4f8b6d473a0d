//! Slash commands: each declares its name, what it takes, what it does, and whether it may be used
//! while a run goes on.

/// What a command does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Changes values.
    Set,
    /// Shows the spec, or one path of it.
    Spec,
    /// Shows what would run.
    Plan,
    /// Lists versions.
    Log,
    /// Compares two versions.
    Diff,
    /// Goes back.
    Undo,
    /// Goes forward.
    Redo,
    /// Plays or pauses the preview.
    Play,
    /// Shows one frame.
    Frame,
    /// Changes the camera.
    Camera,
    /// Writes a picture.
    Snap,
    /// Opens the window.
    Window,
    /// Lists commands and keys.
    Help,
    /// Leaves.
    Quit,
}

/// One command.
#[derive(Debug)]
pub struct Command {
    /// With its slash.
    pub name: &'static str,
    /// What it takes, as shown in the help.
    pub arguments: &'static str,
    /// One line.
    pub help: &'static str,
    /// Whether it may be used while a run goes on; others wait in the queue.
    pub while_running: bool,
    /// What it does.
    pub action: Action,
}

const fn command(name: &'static str, arguments: &'static str, help: &'static str, while_running: bool, action: Action) -> Command {
    Command { name, arguments, help, while_running, action }
}

/// All commands, in the order of the help.
pub const COMMANDS: &[Command] = &[
    command("/set", "PATH=VALUE …", "change values of the spec", false, Action::Set),
    command("/spec", "[PATH]", "show the spec, or one part of it", true, Action::Spec),
    command("/plan", "", "what would run now, and why", false, Action::Plan),
    command("/log", "", "versions of this session", true, Action::Log),
    command("/diff", "[A] [B]", "compare two versions; alone: the last two", true, Action::Diff),
    command("/undo", "[N]", "back by N versions, losing nothing", false, Action::Undo),
    command("/redo", "[N]", "forward again", false, Action::Redo),
    command("/play", "", "play or pause the preview", true, Action::Play),
    command("/frame", "N", "show frame N", true, Action::Frame),
    command("/camera", "[auto | KEY=VALUE …]", "show or set the camera: eye=x,y,z target=x,y,z fov=deg orbit=deg/s", false, Action::Camera),
    command("/snap", "[FILE.png]", "write the frame shown, in full size", false, Action::Snap),
    command("/window", "", "open the preview window", true, Action::Window),
    command("/help", "", "commands and keys", true, Action::Help),
    command("/quit", "", "leave; everything is kept", true, Action::Quit),
];

/// Keys, for the help.
pub const KEYS: &[(&str, &str)] = &[
    ("Enter", "send; while a run goes on: queue"),
    ("Ctrl+J", "new line"),
    ("Esc", "stop the run, keep what is done"),
    ("Up, Down", "history"),
    ("Tab", "complete a command"),
    ("PgUp, PgDn", "scroll"),
    ("Alt+P", "play or pause"),
    ("Alt+,  Alt+.", "one frame back, forward"),
    ("Alt+3", "fold or unfold the preview"),
    ("Ctrl+L", "draw again"),
    ("Ctrl+C", "stop; clear the line; twice: leave"),
    ("Ctrl+D", "leave"),
];

/// A command line, parsed.
#[derive(Debug, PartialEq, Eq)]
pub enum Parsed<'a> {
    /// Words for the language.
    Words,
    /// A command and the rest of its line.
    Command(&'static str, Action, bool, &'a str),
    /// No such command; the nearest name, where one is near.
    Unknown(&'a str, Option<&'static str>),
}

/// Reads one line. An unknown command is never run under another name.
pub fn parse(line: &str) -> Parsed<'_> {
    if !line.starts_with('/') {
        return Parsed::Words;
    }
    let (name, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    match COMMANDS.iter().find(|c| c.name == name) {
        Some(c) => Parsed::Command(c.name, c.action, c.while_running, rest.trim()),
        None => Parsed::Unknown(name, nearest(name)),
    }
}

fn nearest(name: &str) -> Option<&'static str> {
    let scored = COMMANDS.iter().map(|c| (strsim::osa_distance(name, c.name), c.name));
    let near = scored.min_by_key(|(distance, _)| *distance).filter(|(distance, _)| *distance <= 2).map(|(_, n)| n);
    near.or_else(|| (name.len() > 1).then(|| COMMANDS.iter().find(|c| c.name.starts_with(name)).map(|c| c.name)).flatten())
}

/// The command that a prefix completes to, where there is exactly one.
pub fn complete(prefix: &str) -> Option<&'static str> {
    let mut fitting = COMMANDS.iter().filter(|c| c.name.starts_with(prefix));
    match (fitting.next(), fitting.next()) {
        (Some(only), None) => Some(only.name),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_parse_to_themselves() {
        for (index, c) in COMMANDS.iter().enumerate() {
            assert_eq!(parse(&format!("{} a b", c.name)), Parsed::Command(c.name, c.action, c.while_running, "a b"));
            assert!(COMMANDS[..index].iter().all(|o| o.name != c.name));
        }
    }

    #[test]
    fn unknown_commands_suggest_and_do_nothing() {
        assert_eq!(parse("/udno"), Parsed::Unknown("/udno", Some("/undo")));
        assert_eq!(parse("/cam"), Parsed::Unknown("/cam", Some("/camera")));
        assert_eq!(parse("/xylophone"), Parsed::Unknown("/xylophone", None));
        assert_eq!(parse("make it jump"), Parsed::Words);
    }

    #[test]
    fn only_one_way_to_complete() {
        assert_eq!(complete("/und"), Some("/undo"));
        assert_eq!(complete("/p"), None);
    }
}
