//! The thread that draws for the window: it owns an engine, follows the store, and renders what was
//! asked for last.

use crate::cli::exit::Failure;
use crate::history::{Session, Sessions, Version};
use phystalk::gpu::DeviceRequest;
use phystalk::spec::{Camera, Spec};
use phystalk::stages::{Engine, Player, RunOptions};
use phystalk::store::Store;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

/// How often the store is looked at.
const LOOK: Duration = Duration::from_millis(500);
/// How long a version that has not run is taken to be under way, seconds.
const UNDER_WAY_S: u64 = 120;
/// Players kept ready; two are needed to compare.
const PLAYERS: usize = 3;

/// What is followed.
#[derive(Clone, Debug)]
pub enum Source {
    /// All versions of a session, the last one where it has no name.
    Session(Option<String>),
    /// One spec.
    Spec(Box<Spec>),
}

/// How the engine runs.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Where results are.
    pub store: Store,
    /// The sessions of the store.
    pub sessions: Sessions,
    /// On what.
    pub device: DeviceRequest,
    /// How fine: must be as the versions were run, since other motion has other keys.
    pub options: RunOptions,
    /// What is followed.
    pub source: Source,
}

/// A picture that is wanted: only the newest wish counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// Names of one version or two.
    pub versions: Vec<String>,
    /// Which frame.
    pub frame: u32,
    /// From where; none is from where the version itself looks.
    pub camera: Option<Camera>,
    /// Of each picture, pixels.
    pub size: [u32; 2],
}

/// What the window may ask for.
#[derive(Clone, Debug)]
pub enum Request {
    /// Draw.
    Draw(Wish),
    /// Simulate a version whose motion the store does not have.
    Run(String),
}

/// One version of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed {
    /// Its name.
    pub name: String,
    /// What was said, and the note of an undo.
    pub words: String,
    /// Made a moment ago and not run to its end: whoever made it is likely to be simulating it.
    pub under_way: bool,
}

/// What one version can show.
#[derive(Clone, Debug, PartialEq)]
pub struct Extent {
    /// Frames of motion that are there; without any the picture is the scene as captured.
    pub frames: u32,
    /// Frames that the spec asks for.
    pub frames_total: u32,
    /// Frames a second.
    pub fps: u32,
    /// From where the version itself looks.
    pub camera: Camera,
    /// Width over height of the version's pictures.
    pub aspect: f64,
}

/// What the window hears.
pub enum News {
    /// The versions, and which one is newest.
    Versions {
        /// Name of the session, or of the spec's file.
        title: String,
        /// Oldest first.
        list: Vec<Listed>,
        /// The newest one's name.
        head: Option<String>,
    },
    /// A picture of one version.
    Picture {
        /// Which of the wish's versions: 0 or 1.
        place: usize,
        /// Its name.
        version: String,
        /// Width and height.
        size: [u32; 2],
        /// sRGB, opaque.
        rgba8: Vec<u8>,
        /// What the version can show.
        extent: Extent,
    },
    /// How far a run is, 0 to 1.
    Running(f32),
    /// Something failed.
    Failed(String),
}

struct Ready {
    version: String,
    spec_hash: String,
    looked: Instant,
    player: Player,
}

/// Draws and follows until the window goes.
pub struct Studio {
    setting: Setting,
    engine: Engine,
    players: VecDeque<Ready>,
    session: Option<Session>,
    /// The versions that the window was told last.
    told: Vec<Listed>,
    post: Sender<News>,
    wake: Box<dyn Fn() + Send>,
}

impl Studio {
    /// A studio that sends to `post` and calls `wake` after it.
    pub fn new(setting: Setting, post: Sender<News>, wake: Box<dyn Fn() + Send>) -> Studio {
        let engine = Engine::new(setting.store.clone(), setting.device.clone());
        Studio { setting, engine, players: VecDeque::new(), session: None, told: Vec::new(), post, wake }
    }

    /// Serves until the window is gone.
    pub fn serve(mut self, requests: &Receiver<Request>) {
        let mut last: Option<Wish> = None;
        self.follow();
        let mut looked = Instant::now();
        loop {
            let request = match requests.recv_timeout(LOOK) {
                // Of the wishes that wait, the newest counts; a run is never skipped.
                Ok(first) => requests.try_iter().fold(first, |kept, next| if matches!(kept, Request::Run(_)) { kept } else { next }),
                Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => match &last {
                    Some(wish) if self.grows(wish) => Request::Draw(wish.clone()),
                    _ => {
                        self.follow();
                        continue;
                    }
                },
            };
            if looked.elapsed() > LOOK {
                self.follow();
                looked = Instant::now();
            }
            let result = match request {
                Request::Draw(wish) => {
                    last = Some(wish.clone());
                    self.draw(&wish)
                }
                Request::Run(version) => self.run(&version),
            };
            if let Err(failure) = result {
                self.say(News::Failed(failure.message));
            }
        }
    }

    fn say(&self, news: News) {
        // The window may be gone already; then there is nobody to tell.
        let _ = self.post.send(news);
        (self.wake)();
    }

    /// Reads the session anew and tells its versions.
    fn follow(&mut self) {
        let name = match &self.setting.source {
            Source::Spec(spec) => {
                let listed = Listed { name: SPEC.to_owned(), words: spec.scene.file.clone(), under_way: false };
                self.say(News::Versions { title: spec.scene.file.clone(), list: vec![listed], head: Some(SPEC.to_owned()) });
                return;
            }
            Source::Session(name) => name.clone(),
        };
        match self.setting.sessions.open(name.as_deref()) {
            Ok(session) => {
                let list = listing(&session);
                if self.session.as_ref().is_none_or(|s| s.name() != session.name()) || self.told != list {
                    self.told.clone_from(&list);
                    self.say(News::Versions { title: session.name().to_owned(), list, head: session.head().map(|v| v.name.clone()) });
                }
                self.session = Some(session);
            }
            Err(error) => self.say(News::Failed(error.to_string())),
        }
    }

    fn spec(&self, version: &str) -> Result<Spec, Failure> {
        match (&self.setting.source, &self.session) {
            (Source::Spec(spec), _) => Ok((**spec).clone()),
            (_, Some(session)) => Ok(session.spec_of(version)?),
            (_, None) => Err(Failure::other("there is no session in this store yet")),
        }
    }

    fn options(&self) -> RunOptions {
        RunOptions { camera: self.session.as_ref().and_then(Session::camera), ..self.setting.options.clone() }
    }

    /// Whether a wished version has more to show than when it was last drawn.
    fn grows(&self, wish: &Wish) -> bool {
        let ready = |name: &String| self.players.iter().find(|r| r.version == *name);
        wish.versions.iter().any(|name| ready(name).is_none_or(|r| r.player.is_behind()))
    }

    /// The player of a version, made where there is none or the store has more of it by now.
    fn player(&mut self, version: &str) -> Result<usize, Failure> {
        let spec = self.spec(version)?;
        let hash = spec.hash();
        let fresh = |r: &Ready| r.looked.elapsed() < LOOK || !r.player.is_behind();
        if let Some(at) = self.players.iter().position(|r| r.version == version && r.spec_hash == hash && fresh(r)) {
            return Ok(at);
        }
        self.players.retain(|r| r.version != version);
        let options = self.options();
        let player = self.engine.player(&spec, Path::new(""), &options)?;
        if self.players.len() >= PLAYERS {
            self.players.pop_front();
        }
        self.players.push_back(Ready { version: version.to_owned(), spec_hash: hash, looked: Instant::now(), player });
        Ok(self.players.len() - 1)
    }

    fn draw(&mut self, wish: &Wish) -> Result<(), Failure> {
        for (place, version) in wish.versions.iter().enumerate() {
            let at = self.player(version)?;
            let player = &mut self.players[at].player;
            let aspect = f64::from(player.size[0]) / f64::from(player.size[1].max(1));
            let camera = widened(&wish.camera.unwrap_or(player.camera), aspect, wish.size);
            let image = player.picture(&mut self.engine, wish.frame, &camera, wish.size)?;
            let extent = Extent { frames: player.frames, frames_total: player.frames_total, fps: player.fps, camera: player.camera, aspect };
            self.say(News::Picture { place, version: version.clone(), size: image.size, rgba8: image.rgba8, extent });
        }
        Ok(())
    }

    fn run(&mut self, version: &str) -> Result<(), Failure> {
        let spec = self.spec(version)?;
        let options = RunOptions { render: false, ..self.options() };
        let mut reporter = Reporter { post: &self.post, wake: &self.wake };
        self.engine.run(&spec, Path::new(""), &options, None, &mut reporter, &phystalk::Stop::default())?;
        self.say(News::Running(1.0));
        Ok(())
    }
}

/// The versions as the window lists them.
fn listing(session: &Session) -> Vec<Listed> {
    let now_s = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let under_way = |v: &Version| v.resolved.is_none() && now_s.saturating_sub(v.time_s) < UNDER_WAY_S;
    let words = |v: &Version| if v.note.is_empty() { v.words.clone() } else { format!("{} ({})", v.words, v.note) };
    session.versions().iter().map(|v| Listed { name: v.name.clone(), words: words(v), under_way: under_way(v) }).collect()
}

/// The camera for a picture that is narrower than the version's own: it sees as much from side to side, and more above
/// and below, so that nothing is cut off.
fn widened(camera: &Camera, aspect: f64, size: [u32; 2]) -> Camera {
    let narrower = aspect / (f64::from(size[0]) / f64::from(size[1].max(1)));
    let half = (camera.fov_deg.to_radians() / 2.0).tan() * narrower.max(1.0);
    Camera { fov_deg: (2.0 * half.atan()).to_degrees(), ..*camera }
}

/// What a spec without a session is called in the list.
const SPEC: &str = "spec";

/// Passes a run's progress on.
struct Reporter<'a> {
    post: &'a Sender<News>,
    wake: &'a (dyn Fn() + Send),
}

impl phystalk::Sink for Reporter<'_> {
    fn progress(&mut self, progress: phystalk::Progress) {
        let _ = self.post.send(News::Running(progress.done as f32 / progress.total.max(1) as f32));
        (self.wake)();
    }
    fn frame(&mut self, _: phystalk::Frame) {}
    fn warning(&mut self, _: &str) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_pane_sees_as_far_to_the_sides() {
        let camera = Camera { eye_m: [1.0, 0.0, 0.0], target_m: [0.0; 3], fov_deg: 40.0, orbit_deg_s: 0.0 };
        let across = |camera: &Camera, aspect: f64| (camera.fov_deg.to_radians() / 2.0).tan() * aspect;
        let half = widened(&camera, 16.0 / 9.0, [800, 900]);
        assert!((across(&half, 800.0 / 900.0) - across(&camera, 16.0 / 9.0)).abs() < 1e-9);
        assert_eq!(widened(&camera, 16.0 / 9.0, [1600, 800]).fov_deg.round(), 40.0, "a wider one shows more");
    }
}
