//! The engine's thread: owns the conversation, takes requests, sends updates.

use super::app::{Request, Update};
use super::transcript::Voice;
use crate::cli::exit::Failure;
use crate::conversation::{Conversation, Event, Listener, plan_table};
use crate::preview::Reel;
use phystalk::spec::{Camera, Edit};
use phystalk::{Frame, Stop};
use serde_json::json;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender};

/// A message to the thread that draws.
pub type Post = Sender<super::Message>;

/// The stop flag of the run that goes on. A flag once raised stays so: each request gets a new one.
pub type Brake = std::sync::Arc<std::sync::Mutex<Stop>>;

/// Serves requests until there are no more askers.
pub fn serve(mut conversation: Conversation, requests: &Receiver<Request>, post: &Post, reel: &Reel, brake: &Brake) {
    for request in requests {
        let stop = Stop::default();
        if let Ok(mut current) = brake.lock() {
            *current = stop.clone();
        }
        let mut relay = Relay { post, reel };
        let before = conversation.session().head().map(|v| v.name.clone());
        let opens = request == Request::Open;
        if let Err(failure) = handle(&mut conversation, request, &mut relay, &stop) {
            relay.text(Voice::Error, failure.message);
        }
        if (opens || before != conversation.session().head().map(|v| v.name.clone()))
            && let Ok(name) = conversation.device_name()
        {
            relay.send(Update::Device(name));
        }
        relay.send(Update::Finished);
    }
}

/// What a newcomer can do.
const SAY: &str = "Say what should happen, as \"make it jump\", \"drop it from 1 m\", \"softer\", \"undo that\". The phrasebook understands it, offline; /help \
                   lists commands and keys.";

fn handle(conversation: &mut Conversation, request: Request, relay: &mut Relay<'_>, stop: &Stop) -> Result<(), Failure> {
    match request {
        Request::Open => {
            conversation.introduce()?.into_iter().for_each(|text| relay.text(Voice::Agent, text));
            relay.text(Voice::Agent, SAY.to_owned());
            conversation.show(relay, stop)?;
        }
        Request::Say(words) => {
            conversation.say(&words, relay, stop);
        }
        Request::Set(settings) => {
            let edits: Vec<Edit> = settings.iter().map(|s| Ok(Edit::parse_set(s)?)).collect::<Result<_, Failure>>()?;
            conversation.edit(&format!("/set {}", settings.join(" ")), edits, relay, stop);
        }
        Request::Undo(steps) => {
            conversation.undo(steps, relay, stop);
        }
        Request::Redo(steps) => {
            conversation.redo(steps, relay, stop);
        }
        Request::Plan => {
            let plan = conversation.plan()?;
            relay.text(Voice::Detail, crate::cli::output::table(&plan_table(&plan.stages)));
        }
        Request::Camera(text) if text.is_empty() => {
            let camera = conversation.camera()?;
            relay.text(Voice::Detail, describe(&camera));
        }
        Request::Camera(text) => {
            let edit = camera_edit(&text, conversation)?;
            conversation.edit(&format!("/camera {text}"), vec![edit], relay, stop);
        }
        Request::Snap { frame, file } => {
            let path = snap(conversation, frame, file, stop)?;
            relay.text(Voice::Agent, format!("wrote {}", path.display()));
        }
    }
    Ok(())
}

fn snap(conversation: &mut Conversation, index: u32, file: Option<String>, stop: &Stop) -> Result<PathBuf, Failure> {
    let version = conversation.session().head().map_or_else(|| "scene".to_owned(), |v| v.name.clone());
    let path = PathBuf::from(file.unwrap_or_else(|| format!("{}-{version}-{index:04}.png", conversation.session().name())));
    let frame = conversation.frame(index, stop)?.ok_or_else(|| Failure::other(format!("{version} has no frame {index}")))?;
    phystalk::export::write_png(&path, frame.size, &frame.rgba8)?;
    Ok(path)
}

fn describe(camera: &Camera) -> String {
    let point = |p: [f64; 3]| format!("{:.3},{:.3},{:.3}", p[0], p[1], p[2]);
    format!("eye={} target={} fov={:.1} orbit={:.1}", point(camera.eye_m), point(camera.target_m), camera.fov_deg, camera.orbit_deg_s)
}

/// `auto`, or some of `eye=x,y,z target=x,y,z fov=deg orbit=deg/s`; what is not named stays.
fn camera_edit(text: &str, conversation: &mut Conversation) -> Result<Edit, Failure> {
    if text == "auto" {
        return Ok(Edit::set("camera", json!("auto")));
    }
    let mut camera = conversation.camera()?;
    for word in text.split_whitespace() {
        let bad =
            || Failure::other(format!("\"{word}\" is no part of a camera: expected auto, or some of eye=x,y,z target=x,y,z fov=deg orbit=deg/s"));
        let (name, value) = word.split_once('=').ok_or_else(bad)?;
        let numbers: Vec<f64> = value.split(',').map(str::parse).collect::<Result<_, _>>().map_err(|_| bad())?;
        match (name, numbers.as_slice()) {
            ("eye", &[x, y, z]) => camera.eye_m = [x, y, z],
            ("target", &[x, y, z]) => camera.target_m = [x, y, z],
            ("fov", &[degrees]) => camera.fov_deg = degrees,
            ("orbit", &[speed]) => camera.orbit_deg_s = speed,
            _ => return Err(bad()),
        }
    }
    Ok(Edit::set("camera", serde_json::to_value(camera).map_err(Failure::other)?))
}

/// Passes a conversation's events on.
struct Relay<'a> {
    post: &'a Post,
    reel: &'a Reel,
}

impl Relay<'_> {
    fn send(&self, update: Update) {
        // Nobody listens any more only while the program ends.
        let _ = self.post.send(super::Message::Update(update));
    }

    fn text(&self, voice: Voice, text: String) {
        self.send(Update::Text(voice, text));
    }
}

impl Listener for Relay<'_> {
    fn event(&mut self, event: Event) {
        self.send(Update::Event(Box::new(event)));
    }

    fn picture(&mut self, frame: &Frame) {
        self.reel.add(frame);
        self.send(Update::Pictures);
    }

    fn film(&mut self, version: &str) {
        self.reel.start(version);
        self.send(Update::Pictures);
    }
}
