//! The engine end to end, without language or terminal: what runs, what is taken from the store, and
//! that the bits agree.

#![allow(clippy::unwrap_used, reason = "a test of good input")]

use phystalk::gpu::DeviceRequest;
use phystalk::scene::{self, Gaussians};
use phystalk::spec::{Auto, Camera, Event, Pin, Region, Spec, Until};
use phystalk::stages::{Action, Engine, Report, RunOptions, StageName};
use phystalk::store::Store;
use phystalk::{Frame, Progress, Sink, Stop};
use std::path::Path;

/// Keeps the PNG of each frame.
#[derive(Default)]
struct Film(Vec<Frame>);

impl Sink for Film {
    fn progress(&mut self, _: Progress) {}
    fn frame(&mut self, frame: Frame) {
        self.0.push(frame);
    }
    fn warning(&mut self, _: &str) {}
}

/// A block of Gaussians, 0.2 x 0.2 x 0.3 m, standing on z = 0.
fn block() -> Gaussians {
    let mut block = Gaussians::default();
    for i in 0..10 * 10 * 15 {
        let cell = glam::Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32);
        block.mean.push(cell * 0.02 + glam::Vec3::new(-0.09, -0.09, 0.0));
        block.scale.push(glam::Vec3::splat(0.009));
        block.rotation.push([1.0, 0.0, 0.0, 0.0]);
        block.opacity.push(0.9);
        block.sh.extend([0.8 - 0.1 * cell.z, 0.05 * cell.x, -0.3]);
    }
    block
}

fn spec(folder: &Path) -> Spec {
    scene::write(&folder.join("block.ply"), &block()).unwrap();
    let mut spec = Spec::of_scene("block.ply");
    spec.scene.up = Auto::Value(phystalk::spec::Axis::PlusZ);
    spec.time.duration_s = Auto::Value(0.6);
    spec.time.fps = 20;
    spec.solver.cells_across = Auto::Value(12);
    spec.output.size = Auto::Value([96, 64]);
    spec.objects[0].velocity_m_s = [0.0, 0.0, 1.0];
    spec
}

fn run(engine: &mut Engine, spec: &Spec, folder: &Path, previous: Option<&Spec>, camera: Option<Camera>) -> (Report, Vec<Frame>) {
    let mut film = Film::default();
    let options = RunOptions { camera, ..Default::default() };
    let report = engine.run(spec, folder, &options, previous, &mut film, &Stop::default()).unwrap();
    (report, film.0)
}

fn actions(report: &Report) -> Vec<Action> {
    report.plan.stages.iter().map(|s| s.action).collect()
}

fn engine(folder: &Path, name: &str) -> Engine {
    Engine::new(Store::open(&folder.join(name)).unwrap(), DeviceRequest::default())
}

#[test]
fn a_block_jumps_and_what_did_not_change_is_not_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let first = spec(folder);
    let mut engine_a = engine(folder, "store");
    let (report, film) = run(&mut engine_a, &first, folder, None, None);
    use Action::{Hit, Resume, Run};
    assert_eq!(actions(&report), [Run; 5]);
    assert_eq!((film.len(), report.metrics.frames), (13, 13));
    assert!(film.iter().enumerate().all(|(i, f)| f.index == i as u32 && f.size == [96, 64]));
    assert!(film[0].png != film[3].png, "nothing moves");
    let object = &report.metrics.objects["block"];
    let ballistic = 1.0 / (2.0 * 9.81);
    assert!((object.apex_m() - ballistic).abs() < 0.15 * ballistic, "rose {} m, ballistics say {ballistic}", object.apex_m());
    assert_eq!(report.metrics.solver.nonfinite, 0);

    // The same again, in a new process's place: everything is in the store, the pictures are the same bytes.
    let mut engine_b = engine(folder, "store");
    let (report, again) = run(&mut engine_b, &first, folder, Some(&first), Some(report.camera));
    assert_eq!(actions(&report), [Hit; 5]);
    assert!(film.iter().zip(&again).all(|(a, b)| a.png == b.png));

    // Another camera draws again and simulates nothing.
    let mut turned = first.clone();
    turned.camera = Auto::Value(Camera { orbit_deg_s: 30.0, ..report.camera });
    let (report, orbit) = run(&mut engine_b, &turned, folder, Some(&first), None);
    assert_eq!(actions(&report), [Hit, Hit, Hit, Hit, Run]);
    assert!(report.plan.stages[4].reason.contains("camera"), "{}", report.plan.stages[4].reason);
    assert!(orbit[0].png == film[0].png && orbit[12].png != film[12].png);

    // A push at 0.3 s goes on from the state before it, and ends in the same bits as a whole run.
    let mut pushed = first.clone();
    pushed.events.push(Event { push_m_s: Some([1.0, 0.0, 0.0]), ..Event::at("push1", "block", 0.3) });
    let camera = Some(report.camera);
    let (report, resumed) = run(&mut engine_b, &pushed, folder, Some(&first), camera);
    assert_eq!(actions(&report), [Hit, Hit, Hit, Resume, Run]);
    assert_eq!(report.plan.stages[3].from_s, Some(0.25));
    let (whole, direct) = run(&mut engine(folder, "other"), &pushed, folder, None, camera);
    assert_eq!(whole.metrics.objects, report.metrics.objects);
    assert!(resumed.iter().zip(&direct).all(|(a, b)| a.png == b.png));
    assert!(whole.metrics.objects["block"].travel_m()[0] > 0.1);
}

#[test]
fn a_stopped_run_keeps_what_it_finished() {
    struct StopAt(Stop, u32);
    impl Sink for StopAt {
        fn progress(&mut self, _: Progress) {}
        fn frame(&mut self, frame: Frame) {
            if frame.index == self.1 {
                self.0.raise();
            }
        }
        fn warning(&mut self, _: &str) {}
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let spec = spec(folder);
    let mut engine = engine(folder, "store");
    let stop = Stop::default();
    let report = engine.run(&spec, folder, &RunOptions::default(), None, &mut StopAt(stop.clone(), 5), &stop).unwrap();
    assert!(report.stopped && report.metrics.frames < 13);
    let plan = engine.plan(&spec, folder, &RunOptions::default(), Some(&spec)).unwrap();
    assert_eq!(plan.stage(StageName::Simulate).unwrap().action, Action::Resume);
}

/// A film and what was measured, of a run that ends as `spec` says, resumed from another in `engine` and in one piece.
fn goes_on_to_the_same_bits(engine_a: &mut Engine, spec: &Spec, folder: &Path, camera: Camera) {
    let (resumed, film) = run(engine_a, spec, folder, None, Some(camera));
    assert_eq!(resumed.plan.stages[3].from_s, Some(0.25));
    let fresh = tempfile::tempdir().unwrap();
    let (whole, direct) = run(&mut engine(folder, &fresh.path().join("store").to_string_lossy()), spec, folder, None, Some(camera));
    assert_eq!(whole.metrics.objects, resumed.metrics.objects);
    assert!(film.len() == direct.len() && film.iter().zip(&direct).all(|(a, b)| a.png == b.png));
}

#[test]
fn a_pin_that_begins_later_goes_on_from_what_was_there_before() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let first = spec(folder);
    let mut engine = engine(folder, "store");
    let camera = run(&mut engine, &first, folder, None, None).0.camera;
    let mut held = first.clone();
    let pin = Pin { name: "hold".into(), object: "block".into(), region: Region::Below(0.3), from_s: 0.3, to_s: Until::End, path: vec![] };
    held.pins.push(pin);
    goes_on_to_the_same_bits(&mut engine, &held, folder, camera);
}

/// Turns over a bit in the middle of every blob of a name.
fn spoil(folder: &Path, stage: &str, name: &str) {
    let mut spoilt = 0;
    for entry in std::fs::read_dir(folder.join("store/cache").join(stage)).unwrap() {
        let path = entry.unwrap().path().join(name);
        let Ok(mut bytes) = std::fs::read(&path) else { continue };
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        spoilt += 1;
    }
    assert!(spoilt > 0);
}

#[test]
fn what_is_damaged_in_the_store_is_made_again_to_the_same_bits() {
    use Action::{Hit, Run};
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let first = spec(folder);
    let mut engine = engine(folder, "store");
    let (report, film) = run(&mut engine, &first, folder, None, None);
    spoil(folder, "picture", "frames");
    // The plan says what was done, not what seemed to be there.
    let (again, drawn) = run(&mut engine, &first, folder, Some(&first), Some(report.camera));
    assert_eq!(actions(&again), [Hit, Hit, Hit, Hit, Run]);
    assert!(film.len() == drawn.len() && film.iter().zip(&drawn).all(|(a, b)| a.png == b.png));
    // States to go on from: the nearest that is sound is the start.
    spoil(folder, "motion", "checkpoint");
    let mut pushed = first.clone();
    pushed.events.push(Event { push_m_s: Some([1.0, 0.0, 0.0]), ..Event::at("push1", "block", 0.3) });
    goes_on_to_the_same_bits(&mut engine, &pushed, folder, report.camera);
    spoil(folder, "prestress", "state");
    let mut slower = first.clone();
    slower.objects[0].velocity_m_s = [0.0, 0.0, 0.5];
    assert_eq!(actions(&run(&mut engine, &slower, folder, None, None).0)[3], Run);
}
