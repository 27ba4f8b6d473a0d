//! Benchmarks of the whole: a frame, a file to its first picture, an edit to its first frame, a turn,
//! a cold start. Each works in a store of its own that is removed afterwards; only drivers keep caches.

use super::{Job, Timing};
use crate::cli::exit::{Failure, Kind};
use crate::cli::flags::Flags;
use crate::cli::setup;
use phystalk::gpu::Gpu;
use phystalk::render::{RenderOptions, View};
use phystalk::spec::{Edit, Spec};
use phystalk::stages::{Engine, RunOptions};
use phystalk::store::Store;
use phystalk::{Frame, Progress, Sink, Stop, scene};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Size of pictures, unless `--size` says otherwise.
const SIZE: [u32; 2] = [1280, 720];
/// Repetitions of what takes long.
const REPEATS: usize = 3;
/// What `exec` and `cold` say.
const PROMPT: &str = "jump and fall back";

/// All of them.
pub fn jobs(scene: &str, flags: &Flags) -> Vec<Job> {
    let job = |name, run: fn(&Flags, &str) -> Result<Timing, Failure>| {
        let (flags, scene) = (flags.clone(), scene.to_owned());
        let size = if scene == "builtin:demo" { "demo".to_owned() } else { file_name(&scene) };
        Job { name, size, heavy: false, run: Box::new(move |_: &Gpu| run(&flags, &scene)) }
    };
    vec![
        job("frame", frame),
        job("load", load),
        job("edit", edit),
        Job { size: "PNG".to_owned(), ..job("export", png) },
        Job { size: "preview.webp, a frame".to_owned(), ..job("export", preview) },
        job("exec", |flags, scene| spawned(flags, scene, true, |s| s.end_s)),
        Job { size: "to first substep".to_owned(), ..job("cold", |flags, scene| spawned(flags, scene, false, |s| s.substep_s)) },
        Job { size: "to first picture".to_owned(), ..job("cold", |flags, scene| spawned(flags, scene, false, |s| s.picture_s)) },
    ]
}

fn file_name(path: &str) -> String {
    Path::new(path).file_name().map_or_else(|| path.to_owned(), |n| n.to_string_lossy().into_owned())
}

/// A folder that vanishes with it.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Result<Scratch, Failure> {
        let path = std::env::temp_dir().join(format!("phystalk-bench-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).map_err(|e| Failure::file("make", &path, &e))?;
        Ok(Scratch(path))
    }

    fn engine(&self, flags: &Flags) -> Result<Engine, Failure> {
        Ok(Engine::new(Store::open(&self.0.join("store"))?, flags.device_request()))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn options(flags: &Flags) -> RunOptions {
    RunOptions { size: Some(flags.size.unwrap_or(SIZE)), render: true, ..flags.run_options() }
}

/// Notes when pictures come.
struct Clock {
    start: Instant,
    frames_s: Vec<f64>,
    /// And when a frame was simulated and handed on.
    simulated_s: Vec<f64>,
    /// Stops the run after the first picture.
    first_only: Option<Stop>,
}

impl Sink for Clock {
    fn progress(&mut self, progress: Progress) {
        if progress.stage == "simulate" {
            self.simulated_s.push(self.start.elapsed().as_secs_f64());
        }
    }
    fn frame(&mut self, _: Frame) {
        self.frames_s.push(self.start.elapsed().as_secs_f64());
        if let Some(stop) = &self.first_only {
            stop.raise();
        }
    }
    fn warning(&mut self, _: &str) {}
}

fn clocked(engine: &mut Engine, spec: &Spec, options: &RunOptions, first_only: bool) -> Result<Clock, Failure> {
    let stop = Stop::default();
    let mut clock = Clock { start: Instant::now(), frames_s: Vec::new(), simulated_s: Vec::new(), first_only: first_only.then(|| stop.clone()) };
    engine.run(spec, Path::new(""), options, None, &mut clock, &stop)?;
    Ok(clock)
}

fn moving(scene: &str, flags: &Flags, edits: &[Edit]) -> Result<Spec, Failure> {
    let spec = setup::spec_of(scene, flags)?;
    let jump = spec.objects.first().map(|o| Edit::set(format!("object.{}.velocity_m_s", o.name), vec![0.0, 0.0, 2.0]));
    let all: Vec<Edit> = jump.into_iter().chain(edits.iter().cloned()).collect();
    Ok(spec.apply(&all)?)
}

/// From one frame to the next while a scene jumps at 60 frames a second: simulate, skin, render, and the motion and the
/// picture on their way back. Pictures are encoded beside it, and come out in bursts.
fn frame(flags: &Flags, scene: &str) -> Result<Timing, Failure> {
    let scratch = Scratch::new("frame")?;
    let spec = moving(scene, flags, &[Edit::set("time.fps", 60), Edit::set("time.duration_s", 1.0)])?;
    let clock = clocked(&mut scratch.engine(flags)?, &spec, &options(flags), false)?;
    // The first frames wait for pipelines.
    let steady = &clock.simulated_s[clock.simulated_s.len().min(4)..];
    let seconds: Vec<f64> = steady.windows(2).map(|w| w[1] - w[0]).collect();
    if seconds.is_empty() { Err(Failure::other("the scene made too few frames to time")) } else { Ok(Timing::of(seconds)) }
}

/// A file to its first picture, the device being open.
fn load(flags: &Flags, scene: &str) -> Result<Timing, Failure> {
    let scratch = Scratch::new("load")?;
    let path = if scene == "builtin:demo" {
        let path = scratch.0.join("demo.ply");
        scene::write(&path, &scene::demo::gaussians(1))?;
        path
    } else {
        PathBuf::from(scene)
    };
    let mut engine = scratch.engine(flags)?;
    engine.device()?;
    let mut seconds = Vec::new();
    for _ in 0..REPEATS {
        let start = Instant::now();
        let loaded = scene::read(&path)?;
        let (low, high) = loaded.gaussians.bounds();
        let (centre, reach) = ((low + high) * 0.5, (high - low).length());
        let view = View::look_at(centre - reach * glam::Vec3::X, centre, 45.0, flags.size.unwrap_or(SIZE));
        engine.still(&loaded.gaussians, &[view], &RenderOptions::default())?;
        seconds.push(start.elapsed().as_secs_f64());
    }
    Ok(Timing::of(seconds))
}

/// A picture of the demo as a PNG, on one core.
fn png(flags: &Flags, _: &str) -> Result<Timing, Failure> {
    let picture = pictures(flags, 1)?.swap_remove(0);
    let encode = |_| {
        let start = Instant::now();
        phystalk::export::encode_png(picture.size, &picture.rgba8).map(|_| start.elapsed().as_secs_f64())
    };
    Ok(Timing::of((0..REPEATS * REPEATS).map(encode).collect::<Result<_, _>>()?))
}

/// A frame of a preview: shrunk, compared with the one before, compressed; on all cores.
fn preview(flags: &Flags, _: &str) -> Result<Timing, Failure> {
    const FRAMES: usize = 24;
    let scratch = Scratch::new("preview")?;
    let pictures = pictures(flags, 2)?;
    let film = |_| {
        let mut preview = phystalk::export::Preview::create(&scratch.0.join("preview.webp"), 25.0)?;
        let start = Instant::now();
        for index in 0..FRAMES {
            preview.add(&Frame { index: index as u32, ..pictures[index % 2].clone() })?;
        }
        preview.finish()?;
        Ok(start.elapsed().as_secs_f64() / FRAMES as f64)
    };
    Ok(Timing::of((0..REPEATS).map(film).collect::<Result<_, phystalk::export::ExportError>>()?))
}

/// Pictures of the demo from places side by side.
fn pictures(flags: &Flags, count: usize) -> Result<Vec<Frame>, Failure> {
    let scratch = Scratch::new("pictures")?;
    let gaussians = scene::demo::gaussians(1);
    let (low, high) = gaussians.bounds();
    let (centre, reach) = ((low + high) * 0.5, (high - low).length());
    let view = |i: usize| {
        let eye = centre - reach * (glam::Vec3::X + 0.01 * i as f32 * glam::Vec3::Y);
        View::look_at(eye, centre, 45.0, flags.size.unwrap_or(SIZE))
    };
    let views: Vec<View> = (0..count).map(view).collect();
    let images = scratch.engine(flags)?.still(&gaussians, &views, &RenderOptions::default())?;
    let frame = |image: phystalk::render::Image| Frame {
        index: 0,
        time_s: 0.0,
        size: image.size,
        rgba8: image.rgba8.into(),
        png: Vec::new().into(),
        depth: None,
        id: None,
    };
    Ok(images.into_iter().map(frame).collect())
}

/// An edit of the launch speed to the first new frame, in a session that has run before.
fn edit(flags: &Flags, scene: &str) -> Result<Timing, Failure> {
    let scratch = Scratch::new("edit")?;
    let short = [Edit::set("time.duration_s", 0.1)];
    let spec = moving(scene, flags, &short)?;
    let mut engine = scratch.engine(flags)?;
    let options = options(flags);
    clocked(&mut engine, &spec, &options, false)?;
    let Some(name) = spec.objects.first().map(|o| o.name.clone()) else { return Err(Failure::other("the scene has no object")) };
    let mut seconds = Vec::new();
    for turn in 0..REPEATS {
        let start = Instant::now();
        let edited = spec.apply(&[Edit::set(format!("object.{name}.velocity_m_s"), vec![0.0, 0.0, 2.1 + 0.1 * turn as f64])])?;
        let prepared_s = start.elapsed().as_secs_f64();
        let first = clocked(&mut engine, &edited, &options, true)?.frames_s.first().copied();
        seconds.push(prepared_s + first.ok_or_else(|| Failure::other("no frame came"))?);
    }
    Ok(Timing::of(seconds))
}

/// Milestones of one process, seconds after it was started.
struct Spawned {
    substep_s: f64,
    picture_s: f64,
    end_s: f64,
}

/// Runs `exec` in processes of their own, each with an empty store; whole, or until its first picture.
fn spawned(flags: &Flags, scene: &str, whole: bool, milestone: fn(&Spawned) -> f64) -> Result<Timing, Failure> {
    let runs: Result<Vec<Spawned>, Failure> = (0..REPEATS).map(|turn| spawn(flags, scene, turn, whole)).collect();
    Ok(Timing::of(runs?.iter().map(milestone).collect()))
}

fn spawn(flags: &Flags, scene: &str, turn: usize, whole: bool) -> Result<Spawned, Failure> {
    let scratch = Scratch::new(&format!("exec{turn}"))?;
    let size = flags.size.unwrap_or(SIZE);
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["exec", scene, "-p", PROMPT, "--json", "--size", &format!("{}x{}", size[0], size[1])]);
    command.arg("--store").arg(scratch.0.join("store")).arg("--out").arg(scratch.0.join("out"));
    if let Some(quality) = flags.quality {
        command.args(["--quality", quality.as_str()]);
    }
    if let Some(device) = &flags.device {
        command.args(["--device", device]);
    }
    if flags.cpu {
        command.arg("--cpu");
    }
    let start = Instant::now();
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn()?;
    let (mut substep_s, mut picture_s) = (None, None);
    for line in child.stdout.take().into_iter().flat_map(|out| BufReader::new(out).lines()).map_while(Result::ok) {
        let event: Value = serde_json::from_str(&line).map_err(Failure::other)?;
        match (event["type"].as_str(), event["stage"].as_str()) {
            (Some("stage.progress"), Some("simulate" | "standing")) => substep_s = substep_s.or(Some(start.elapsed().as_secs_f64())),
            (Some("frame.ready"), _) => picture_s = picture_s.or(Some(start.elapsed().as_secs_f64())),
            _ => {}
        }
        if !whole && substep_s.is_some() && picture_s.is_some() {
            break;
        }
    }
    let succeeded = if whole { child.wait()?.success() } else { child.kill().and_then(|()| child.wait()).is_ok() };
    let end_s = start.elapsed().as_secs_f64();
    match (substep_s, picture_s) {
        (Some(substep_s), Some(picture_s)) if succeeded => Ok(Spawned { substep_s, picture_s, end_s }),
        _ => Err(Failure::new(Kind::Other, format!("`phystalk exec {scene} -p \"{PROMPT}\"` failed; run it to see why"))),
    }
}
