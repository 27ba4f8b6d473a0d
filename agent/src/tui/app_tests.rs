//! Keys in, effects and screens out.

use super::*;
use crate::preview::Reel;
use crate::preview::terminal::Painter;
use crate::tui::draw::draw;
use phystalk::Frame;
use phystalk::stages::{Action as StageAction, PlannedStage, StageName};
use ratatui::Terminal;
use ratatui::backend::TestBackend;

fn app_with(reel: &Reel) -> App {
    App::new("s1", Pane::new(reel.clone(), Some(Painter::Halfblocks)), Theme::plain())
}

/// Types a string: `<enter>`, `<esc>`, `<c-c>`, `<c-j>`, `<tab>`, `<up>` and so on are keys.
fn typed(app: &mut App, keys: &str) -> Vec<Effect> {
    let now = Instant::now();
    let mut effects = Vec::new();
    let mut rest = keys;
    while let Some(c) = rest.chars().next() {
        let named = rest.strip_prefix('<').and_then(|r| r.split_once('>'));
        let (code, modifiers) = match named {
            Some((name, after)) => {
                rest = after;
                let (modifiers, name) = match name.split_once('-') {
                    Some(("c", key)) => (KeyModifiers::CONTROL, key),
                    Some(("a", key)) => (KeyModifiers::ALT, key),
                    _ => (KeyModifiers::NONE, name),
                };
                let code = match name {
                    "enter" => KeyCode::Enter,
                    "esc" => KeyCode::Esc,
                    "tab" => KeyCode::Tab,
                    "up" => KeyCode::Up,
                    "pgup" => KeyCode::PageUp,
                    one => KeyCode::Char(one.chars().next().unwrap()),
                };
                (code, modifiers)
            }
            None => {
                rest = &rest[c.len_utf8()..];
                (KeyCode::Char(c), KeyModifiers::NONE)
            }
        };
        effects.extend(app.key(KeyEvent::new(code, modifiers), now));
    }
    effects
}

fn event(app: &mut App, event: Event) {
    app.update(Update::Event(Box::new(event)), Instant::now());
}

fn screen(app: &mut App, width: u16, height: u16) -> Terminal<TestBackend> {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| draw(app, frame)).unwrap();
    terminal
}

/// A whole turn, stopped where its pictures come.
fn busy(reel: &Reel) -> App {
    let mut app = app_with(reel);
    typed(&mut app, "make the vase jump and fall back<enter>");
    event(&mut app, Event::Message { text: "vase jumps 0.4 m".into() });
    let changes = vec!["object.vase.velocity_m_s: [0, 0, 0] -> [0, 0, 2.8] m/s".to_owned()];
    event(&mut app, Event::SpecEdited { from: None, to: "v1".into(), edits: Vec::new(), changes });
    let stage = |stage, action| PlannedStage { stage, key: "k".into(), action, from_s: None, reason: "first run".into(), seconds: None };
    let stages = StageName::ALL.map(|s| stage(s, StageAction::Run)).to_vec();
    event(&mut app, Event::PlanReady { stages });
    event(&mut app, Event::StageStarted { stage: "simulate".into() });
    reel.start("v1");
    for index in 0..43 {
        let pixels = (0..32 * 18).flat_map(|i: u32| [(i % 32 * 8) as u8, (i / 32 * 14) as u8, index as u8 * 5, 255]);
        reel.add(&Frame {
            index,
            time_s: f64::from(index) / 50.0,
            size: [32, 18],
            rgba8: pixels.collect::<Vec<u8>>().into(),
            png: Vec::new().into(),
            depth: None,
            id: None,
        });
    }
    app.update(Update::Pictures, Instant::now());
    event(&mut app, Event::StageProgress { stage: "simulate".into(), done: 43, total: 101, seconds_left: Some(3.2) });
    app
}

#[test]
fn a_line_becomes_a_request() {
    let mut app = app_with(&Reel::default());
    assert_eq!(typed(&mut app, "on the moon<enter>"), [Effect::Send(Request::Say("on the moon".into()))]);
}

#[test]
fn commands_become_what_they_say() {
    let cases: [(&str, Effect); 9] = [
        ("/set object.vase.material.young_pa=3e4<enter>", Effect::Send(Request::Set(vec!["object.vase.material.young_pa=3e4".into()]))),
        (
            "/set world.gravity_m_s2=[0, 0, -1.62] seed=2<enter>",
            Effect::Send(Request::Set(vec!["world.gravity_m_s2=[0, 0, -1.62]".into(), "seed=2".into()])),
        ),
        ("/undo<enter>", Effect::Send(Request::Undo(1))),
        ("/redo 2<enter>", Effect::Send(Request::Redo(2))),
        ("/plan<enter>", Effect::Send(Request::Plan)),
        ("/log<enter>", Effect::Ask(Question::Log)),
        ("/diff v1 v2<enter>", Effect::Ask(Question::Diff(Some("v1".into()), Some("v2".into())))),
        ("/spec world<enter>", Effect::Ask(Question::Spec(Some("world".into())))),
        ("/wi<tab><enter>", Effect::Window),
    ];
    for (keys, expected) in cases {
        assert_eq!(typed(&mut app_with(&Reel::default()), keys), [expected], "{keys}");
    }
}

#[test]
fn it_opens_with_a_picture_and_what_is_typed_waits_for_it() {
    let reel = Reel::default();
    let mut app = app_with(&reel);
    assert_eq!(app.open(), [Effect::Send(Request::Open)]);
    assert_eq!(typed(&mut app, "jump<enter>"), []);
    reel.start("as captured");
    let pixels = (0..32 * 18).flat_map(|i: u32| [(i % 32 * 8) as u8, (i / 32 * 14) as u8, 90, 255]).collect::<Vec<u8>>();
    reel.add(&Frame { index: 0, time_s: 0.0, size: [32, 18], rgba8: pixels.into(), png: Vec::new().into(), depth: None, id: None });
    app.update(Update::Pictures, Instant::now());
    let drawn = screen(&mut app, 80, 24).backend().to_string();
    assert!(drawn.contains("as captured") && drawn.contains('▄') && drawn.contains("opening"), "{drawn}");
    assert_eq!(app.update(Update::Finished, Instant::now()), [Effect::Send(Request::Say("jump".into()))]);
}

#[test]
fn what_makes_no_sense_does_nothing_and_says_why() {
    for keys in ["/udno<enter>", "/undo many<enter>", "/frame x<enter>", "/frame 7<enter>", "/play<enter>", "/snap<enter>", "/set<enter>"] {
        let mut app = app_with(&Reel::default());
        assert_eq!(typed(&mut app, keys), [], "{keys}");
        assert!(screen(&mut app, 80, 24).backend().to_string().contains("x "), "{keys}");
    }
}

#[test]
fn typing_ahead_queues_and_runs_in_order() {
    let mut app = app_with(&Reel::default());
    typed(&mut app, "jump<enter>");
    assert_eq!(typed(&mut app, "softer<enter>on mars<enter>"), []);
    assert_eq!(app.queued(), 2);
    assert_eq!(typed(&mut app, "/log<enter>"), [Effect::Ask(Question::Log)], "what only reads does not wait");
    let now = Instant::now();
    assert_eq!(app.update(Update::Finished, now), [Effect::Send(Request::Say("softer".into()))]);
    assert_eq!(app.update(Update::Finished, now), [Effect::Send(Request::Say("on mars".into()))]);
    assert_eq!(app.update(Update::Finished, now), []);
    assert_eq!(app.running, None);
}

#[test]
fn escape_stops_once_and_keeps_what_is_done() {
    let mut app = busy(&Reel::default());
    assert_eq!(typed(&mut app, "<esc><esc>"), [Effect::Stop]);
    event(&mut app, Event::TurnCancelled { exit_code: 130, version: Some("v1".into()) });
    app.update(Update::Finished, Instant::now());
    assert!(screen(&mut app, 80, 24).backend().to_string().contains("stopped; what was done is kept"));
    assert_eq!(typed(&mut app, "<esc>"), [], "nothing to stop");
}

#[test]
fn control_c_stops_clears_and_leaves() {
    let mut app = app_with(&Reel::default());
    typed(&mut app, "half a thou<c-c>");
    assert!(app.composer.is_empty());
    assert_eq!(typed(&mut app, "<c-c>"), [Effect::Stop, Effect::Quit], "however slowly");
    let mut app = app_with(&Reel::default());
    assert_eq!(typed(&mut app, "<c-c>x<c-c>"), [], "another key in between, and it is not meant");
    assert_eq!(typed(&mut app_with(&Reel::default()), "<c-d>"), [Effect::Quit]);
    assert_eq!(typed(&mut busy(&Reel::default()), "<c-c>"), [Effect::Stop]);
}

#[test]
fn several_lines_and_history() {
    let mut app = app_with(&Reel::default());
    assert_eq!(typed(&mut app, "jump<c-j>then fall<enter>"), [Effect::Send(Request::Say("jump\nthen fall".into()))]);
    app.update(Update::Finished, Instant::now());
    assert_eq!(typed(&mut app, "<up><enter>"), [Effect::Send(Request::Say("jump\nthen fall".into()))]);
}

#[test]
fn screens() {
    for (width, height) in [(40, 12), (80, 24), (120, 40)] {
        let name = |what: &str| format!("{what}-{width}x{height}");
        let mut empty = app_with(&Reel::default());
        insta::assert_snapshot!(name("start"), screen(&mut empty, width, height).backend());
        let mut app = busy(&Reel::default());
        typed(&mut app, "softer<enter>and on the moon");
        insta::assert_snapshot!(name("running"), screen(&mut app, width, height).backend());
    }
    let mut app = app_with(&Reel::default());
    typed(&mut app, "/help<enter>");
    insta::assert_snapshot!("help-80x40", screen(&mut app, 80, 40).backend());
}

#[test]
fn every_size_draws_without_a_crash() {
    let mut app = busy(&Reel::default());
    typed(&mut app, "a rather long line that has to be broken into several rows, and one more<c-j>and another");
    for width in (1..130).step_by(7) {
        for height in 1..45 {
            screen(&mut app, width, height);
        }
    }
}

#[test]
fn no_text_reaches_the_terminal_as_an_escape() {
    let hostile = "a\x1b]0;title\x07\u{9b}2J\x7f\u{202e}b\u{2028}c\r";
    let reel = Reel::default();
    let mut app = busy(&reel);
    app.session = hostile.to_owned();
    for voice in [Voice::You, Voice::Agent, Voice::Change, Voice::Detail, Voice::Warning, Voice::Error] {
        app.transcript.add(voice, hostile);
    }
    app.paste(hostile, 3);
    typed(&mut app, "\u{9b}\u{202e}");
    event(&mut app, Event::StageStarted { stage: hostile.into() });
    reel.start(hostile);
    let mut screens = vec![text(&screen(&mut app, 100, 40))];
    app.update(Update::Device(hostile.into()), Instant::now());
    app.update(Update::Finished, Instant::now());
    screens.push(text(&screen(&mut app, 100, 40)));
    for shown in screens {
        assert!(!shown.contains(crate::cli::sanitise::is_unprintable), "{shown:?}");
        assert!(shown.contains("a\\u{1b}]0;title"), "escapes are shown: {shown}");
        assert!(shown.contains("3 bytes at its end were dropped"), "{shown}");
    }
    assert!(!app.composer.text().contains(crate::cli::sanitise::is_unprintable));
}

/// The symbols of a screen, rows joined by newlines.
fn text(terminal: &Terminal<TestBackend>) -> String {
    let buffer = terminal.backend().buffer();
    let rows = buffer.content().chunks(usize::from(buffer.area.width));
    rows.map(|row| row.iter().map(|cell| cell.symbol()).collect::<String>()).collect::<Vec<_>>().join("\n")
}
