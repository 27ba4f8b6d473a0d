//! Two conversations about one session, as two processes hold them.

use super::*;
use crate::history::Sessions;
use phystalk::gpu::DeviceRequest;
use phystalk::scene::{Gaussians, write};
use phystalk::spec::{Edit, Spec};
use phystalk::stages::{Engine, RunOptions};
use phystalk::store::Store;
use phystalk::{Frame, Stop};
use serde_json::json;

/// Keeps what is said.
#[derive(Default)]
struct Heard(Vec<String>);

impl Listener for Heard {
    fn event(&mut self, event: Event) {
        match event {
            Event::Message { text } | Event::Warning { text } => self.0.push(text),
            Event::TurnFailed { error, .. } => self.0.push(error),
            _ => {}
        }
    }
    fn picture(&mut self, _: &Frame) {}
}

/// A session about a small block, and what it takes to open it.
struct Desk {
    _home: tempfile::TempDir,
    store: Store,
    sessions: Sessions,
}

impl Desk {
    fn new() -> Desk {
        let home = tempfile::tempdir().unwrap();
        let scene = home.path().join("block.ply");
        let at = |i: usize| glam::Vec3::new((i % 4) as f32, (i / 4 % 4) as f32, (i / 16) as f32) * 0.05;
        let block = Gaussians {
            mean: (0..64).map(at).collect(),
            scale: vec![glam::Vec3::splat(0.025); 64],
            rotation: vec![[1.0, 0.0, 0.0, 0.0]; 64],
            opacity: vec![0.95; 64],
            sh_degree: 0,
            sh: vec![0.4; 192],
        };
        write(&scene, &block).unwrap();
        let small = [Edit::set("scene.up", "+z"), Edit::set("solver.cells_across", 8), Edit::set("time.duration_s", 0.1)];
        let spec = Spec::of_scene(&scene.to_string_lossy()).apply(&small).unwrap();
        let spec = spec.apply(&[Edit::set("object.block.material.young_pa", 800_000)]).unwrap();
        let store = Store::open(&home.path().join(".phystalk")).unwrap();
        let sessions = Sessions::seen_from(&store, home.path());
        sessions.start(Some("s"), spec).unwrap();
        Desk { _home: home, store, sessions }
    }

    fn conversation(&self) -> Conversation {
        let engine = Engine::new(self.store.clone(), DeviceRequest::default());
        let options = RunOptions { render: false, ..RunOptions::default() };
        Conversation::new(engine, self.sessions.open(Some("s")).unwrap(), options, None, true)
    }
}

/// A turn of which only what comes before the run matters: whether it made a version, and what was said.
fn say(conversation: &mut Conversation, words: &str) -> (bool, String) {
    let (mut heard, stop) = (Heard::default(), Stop::default());
    stop.raise();
    let outcome = if words == "/undo" { conversation.undo(1, &mut heard, &stop) } else { conversation.say(words, &mut heard, &stop) };
    (outcome.version.is_some(), heard.0.join("\n"))
}

fn value(conversation: &Conversation, path: &str) -> serde_json::Value {
    path.split('.').fold(conversation.session().spec().to_value(), |value, part| match part.parse::<usize>() {
        Ok(index) => value[index].clone(),
        Err(_) => value[part].clone(),
    })
}

#[test]
fn turns_about_different_things_are_merged_and_that_is_said() {
    let desk = Desk::new();
    let (mut ours, mut theirs) = (desk.conversation(), desk.conversation());
    assert!(say(&mut theirs, "on the moon").0);
    let (made, said) = say(&mut ours, "twice as heavy");
    assert!(made && said.contains("v1 (\"on the moon\") was added by another process meanwhile"), "{said}");
    assert_eq!(value(&ours, "object.0.material.density_kg_m3"), json!(2000.0));
    assert_eq!(value(&ours, "world.gravity_m_s2"), json!([0.0, 0.0, -1.62]));
    let head = ours.session().head().unwrap();
    assert_eq!((head.name.as_str(), head.parent.as_deref()), ("v2", Some("v1")));
}

#[test]
fn turns_of_which_one_is_computed_from_the_other_are_refused_and_can_be_said_again() {
    let young = "object.0.material.young_pa";
    for (first, second, named) in [
        ("softer", "softer", "young_pa"),
        // A jump's speed is computed from gravity.
        ("on the moon", "jump 10 cm", "world.gravity_m_s2"),
        ("jump 10 cm", "on the moon", "velocity"),
    ] {
        let desk = Desk::new();
        let (mut ours, mut theirs) = (desk.conversation(), desk.conversation());
        assert!(say(&mut theirs, first).0, "{first}");
        let (made, said) = say(&mut ours, second);
        assert!(
            !made && said.contains(&format!("v1 (\"{first}\")")) && said.contains(named) && said.contains("say it again"),
            "{first}, {second}: {said}"
        );
        assert_eq!(desk.sessions.open(Some("s")).unwrap().versions().len(), 1, "{first}, {second}");
        let (made, said) = say(&mut ours, second);
        assert!(made, "{said}");
        if first == "softer" {
            assert_eq!(value(&ours, young), json!(200_000.0), "said again it goes on from what the other one made");
        }
    }
}

#[test]
fn an_undo_beside_an_open_conversation_is_not_undone_unseen() {
    let desk = Desk::new();
    let mut ours = desk.conversation();
    assert!(say(&mut ours, "softer").0 && say(&mut ours, "on the moon").0);
    let mut theirs = desk.conversation();
    assert!(say(&mut theirs, "/undo").0);
    let (made, said) = say(&mut ours, "/undo");
    assert!(!made && said.contains("v3") && said.contains("by another process"), "{said}");
    assert!(say(&mut ours, "undo that").0);
    assert_eq!(value(&ours, "object.0.material.young_pa"), json!(800_000.0));
    // What both versions agree on is merged, also with an undo.
    let (mut ours, mut theirs) = (desk.conversation(), desk.conversation());
    assert!(say(&mut theirs, "redo").0);
    let (made, said) = say(&mut ours, "twice as heavy");
    assert!(made, "{said}");
    assert_eq!(value(&ours, "object.0.material.young_pa"), json!(400_000.0));
}
