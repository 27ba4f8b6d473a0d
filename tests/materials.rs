//! Every material end to end: a block of it stands, falls and does what such a stuff does.

#![allow(clippy::unwrap_used, reason = "a test of good input")]

use phystalk::gpu::DeviceRequest;
use phystalk::scene::{self, Gaussians};
use phystalk::spec::{Auto, BoxShape, Collider, ColliderShape, Event, Material, Part, Pin, Region, Spec, SphereShape, Until, presets};
use phystalk::stages::{Engine, ObjectMetrics, Report, RunOptions};
use phystalk::store::Store;
use phystalk::{Frame, Progress, Sink, Stop};
use std::path::Path;

/// Keeps nothing.
struct Deaf;

impl Sink for Deaf {
    fn progress(&mut self, _: Progress) {}
    fn frame(&mut self, _: Frame) {}
    fn warning(&mut self, _: &str) {}
}

/// A column of Gaussians, 0.12 x 0.12 x 0.24 m, standing on z = 0.
fn column() -> Gaussians {
    let mut column = Gaussians::default();
    for i in 0..6 * 6 * 12 {
        let cell = glam::Vec3::new((i % 6) as f32, (i / 6 % 6) as f32, (i / 36) as f32);
        column.mean.push(cell * 0.02 + glam::Vec3::new(-0.05, -0.05, 0.0));
        column.scale.push(glam::Vec3::splat(0.009));
        column.rotation.push([1.0, 0.0, 0.0, 0.0]);
        column.opacity.push(0.9);
        column.sh.extend([0.8, 0.1, -0.3]);
    }
    column
}

fn spec(folder: &Path) -> Spec {
    scene::write(&folder.join("column.ply"), &column()).unwrap();
    let mut spec = Spec::of_scene("column.ply");
    spec.scene.up = Auto::Value(phystalk::spec::Axis::PlusZ);
    spec.time.duration_s = Auto::Value(0.3);
    spec.time.fps = 20;
    spec.solver.cells_across = Auto::Value(8);
    spec
}

fn run(spec: &Spec, folder: &Path) -> Report {
    let mut engine = Engine::new(Store::open(&folder.join("store")).unwrap(), DeviceRequest::default());
    let options = RunOptions { render: false, ..RunOptions::default() };
    let report = engine.run(spec, folder, &options, None, &mut Deaf, &Stop::default()).unwrap();
    assert_eq!(report.metrics.solver.nonfinite, 0);
    report
}

/// How far its top sank, and how much wider it got.
fn fate(object: &ObjectMetrics) -> (f64, f64) {
    let ends = |values: &[f64]| (values[0], values[values.len() - 1]);
    let ((high, low), (narrow, wide)) = (ends(&object.high_m), ends(&object.spread_m));
    (high - low, wide / narrow)
}

fn fate_of(material: &Material, folder: &Path) -> (f64, f64) {
    let mut spec = spec(folder);
    spec.objects[0].material = material.clone();
    fate(&run(&spec, folder).metrics.objects["column"])
}

fn preset(name: &str) -> Material {
    presets::material(name).unwrap().material.clone()
}

#[test]
fn what_stands_stands_and_what_flows_flows() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["rubber", "clay"] {
        let (sank, wider) = fate_of(&preset(name), folder.path());
        assert!(sank.abs() < 0.01 && (wider - 1.0).abs() < 0.03, "{name} sank {sank} m and got {wider} times as wide");
    }
    for name in ["sand", "mud"] {
        let (sank, wider) = fate_of(&preset(name), folder.path());
        assert!(sank > 0.02 && wider > 1.08, "{name} sank {sank} m and got {wider} times as wide");
    }
    // A heap of snow keeps its edges.
    let (snow, _) = fate_of(&preset("snow"), folder.path());
    assert!(snow < 0.03, "snow sank {snow} m");
}

#[test]
fn parts_of_one_body_are_of_their_own_stuff() {
    let folder = tempfile::tempdir().unwrap();
    let mut whole = spec(folder.path());
    whole.objects[0].material = preset("rubber");
    let mut parted = whole.clone();
    parted.objects[0].parts.push(Part { name: "foot".to_owned(), region: Region::Below(0.4), material: preset("sand") });
    let (whole, parted) = (run(&whole, folder.path()), run(&parted, folder.path()));
    let mass = |report: &Report| report.metrics.objects["column"].mass_kg;
    // Two fifths are of 1600 kg/m3 instead of 930.
    let heavier = mass(&parted) / mass(&whole);
    assert!((heavier - (0.6 + 0.4 * 1600.0 / 930.0)).abs() < 0.08, "{heavier} times as heavy");
    let ((stood, _), (sank, wider)) = (fate(&whole.metrics.objects["column"]), fate(&parted.metrics.objects["column"]));
    assert!(stood.abs() < 0.01 && sank > 0.015 && wider > 1.02, "stood {stood}, sank {sank}, {wider} times as wide");
}

#[test]
fn what_is_asked_for_in_vain_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut spec = spec(folder.path());
    spec.time.duration_s = Auto::Value(0.12);
    spec.objects[0].material = preset("rubber");
    let far = SphereShape { centre_m: [9.0, 0.0, 0.0], radius_m: 0.1 };
    spec.objects[0].parts.push(Part { name: "nowhere".to_owned(), region: Region::Sphere(far), material: preset("sand") });
    let pin = |name: &str, region, from_s| Pin { name: name.to_owned(), object: "column".to_owned(), region, from_s, to_s: Until::End, path: vec![] };
    spec.pins = vec![pin("air", Region::Sphere(far), 0.0), pin("late", Region::Above(0.5), 5.0)];
    spec.events.push(Event { push_m_s: Some([1.0, 0.0, 0.0]), ..Event::at("shove", "column", 0.11) });
    spec.events.push(Event { freeze: true, part: Some("nowhere".to_owned()), ..Event::at("chill", "column", 0.0) });
    let half = ColliderShape::Box(BoxShape { centre_m: [0.0, 0.0, 0.06], size_m: [1.0, 1.0, 0.12] });
    spec.colliders.push(Collider { name: "slab".to_owned(), shape: half, friction: 0.5, restitution: 0.0 });
    let warnings = run(&spec, folder.path()).warnings;
    let wanted = [
        "the last one is at 0.100 s",
        "event shove: begins at 0.11 s",
        "pin late",
        "pin air: its region holds nothing",
        "event chill: part nowhere",
        "inside collider slab",
    ];
    for words in wanted {
        assert!(warnings.iter().any(|w| w.contains(words)), "{words}: {warnings:#?}");
    }
}

#[test]
fn a_change_of_material_in_time_changes_nothing_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut still = spec(folder.path());
    still.objects[0].material = preset("rubber");
    still.time.duration_s = Auto::Value(0.5);
    let mut falls = still.clone();
    falls.events.push(Event { material: Some(preset("sand")), ..Event::at("crumble", "column", 0.3) });
    falls.events.push(Event { weaken: Some(0.5), ..Event::at("weaker", "column", 0.4) });
    let (before, resumed) = (run(&still, folder.path()), run(&falls, folder.path()));
    assert_eq!(resumed.plan.stages[3].from_s, Some(0.25), "what is before the event is in the store");
    let other = tempfile::tempdir().unwrap();
    std::fs::copy(folder.path().join("column.ply"), other.path().join("column.ply")).unwrap();
    let whole = run(&falls, other.path());
    let column = |report: &Report| report.metrics.objects["column"].clone();
    assert_eq!(column(&whole).com_m, column(&resumed).com_m, "a run that goes on ends in the same bits");
    assert_eq!(column(&whole).com_m[..=6], column(&before).com_m[..=6], "0.3 s of both agree");
    let (sank, _) = fate(&column(&whole));
    assert!(sank > 0.005, "it sank {sank} m");
}

/// Height over the ground at which a drop of the column starts.
const DROP_M: f64 = 0.1;

#[test]
fn what_waits_for_an_impact_happens_when_the_run_finds_it_and_goes_on_from_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let mut spec = spec(folder.path());
    spec.time.duration_s = Auto::Value(0.5);
    spec.objects[0].material = preset("rubber");
    spec.objects[0].offset_m = [0.0, 0.0, DROP_M];
    spec.events.push(Event { material: Some(preset("sand")), ..Event::on_impact("crumble", "column") });
    spec.events.push(Event { push_m_s: Some([1.0, 0.0, 0.0]), ..Event::on_impact("push", "column") });
    let mut first = spec.clone();
    first.time.duration_s = Auto::Value(0.25);
    let (begun, resumed) = (run(&first, folder.path()), run(&spec, folder.path()));
    assert_eq!(resumed.plan.stages[3].from_s, Some(0.25));
    let landed_s = (2.0 * DROP_M / 9.81).sqrt();
    for report in [&begun, &resumed] {
        let times: Vec<f64> = report.metrics.events.iter().map(|e| e.at_s.unwrap()).collect();
        assert!(times.iter().all(|t| (t - landed_s).abs() < 0.5 / 20.0 / 4.0), "{times:?}, expected {landed_s}");
    }
    let column = |report: &Report| report.metrics.objects["column"].clone();
    let (sank, _) = fate(&column(&resumed));
    assert!(sank - DROP_M > 0.02 && column(&resumed).com_m[10][0] > 0.03, "it crumbles and goes off: {sank}");
    // Nothing before it knew.
    let mut plain = spec.clone();
    plain.events.clear();
    let other = tempfile::tempdir().unwrap();
    std::fs::copy(folder.path().join("column.ply"), other.path().join("column.ply")).unwrap();
    assert_eq!(column(&run(&plain, other.path())).com_m[..=2], column(&resumed).com_m[..=2]);
    assert_eq!(column(&run(&spec, other.path())).com_m, column(&resumed).com_m, "in one go the same bits");
    // What stands meets nothing.
    spec.objects[0].offset_m = [0.0; 3];
    let still = run(&spec, folder.path());
    assert!(still.metrics.events.iter().all(|e| e.at_s.is_none()), "{:?}", still.metrics.events);
}

#[test]
fn what_freezes_keeps_the_shape_that_it_has_until_it_is_released() {
    let folder = tempfile::tempdir().unwrap();
    let mut spec = spec(folder.path());
    spec.objects[0].material = preset("water");
    spec.time.duration_s = Auto::Value(0.6);
    spec.events.push(Event { freeze: true, ..Event::at("freeze", "column", 0.1) });
    spec.events.push(Event { release: true, ..Event::at("melt", "column", 0.4) });
    let column = run(&spec, folder.path()).metrics.objects["column"].clone();
    let (flowed, kept, gone) =
        (column.spread_m[2] / column.spread_m[0], column.spread_m[8] / column.spread_m[2], column.spread_m[12] / column.spread_m[8]);
    assert!(flowed > 1.02 && (kept - 1.0).abs() < 0.08 && gone > 1.15, "{flowed} {kept} {gone}");
}

#[test]
fn water_of_smoothed_particles_comes_to_rest_on_the_ground() {
    let folder = tempfile::tempdir().unwrap();
    let mut spec = spec(folder.path());
    let Material::Liquid(mut water) = preset("water") else { panic!("a liquid") };
    water.solver = phystalk::spec::LiquidSolver::Sph;
    water.viscosity_pa_s = 1.0;
    spec.objects[0].material = Material::Liquid(water);
    spec.time.duration_s = Auto::Value(0.6);
    let report = run(&spec, folder.path());
    let column = &report.metrics.objects["column"];
    let last = column.com_m.len() - 1;
    let fastest = column.mean_speed_m_s.iter().copied().fold(0.0, f64::max);
    println!(
        "{} to {} m high, {} times as wide, {fastest} to {} m/s",
        column.high_m[0],
        column.high_m[last],
        fate(column).1,
        column.mean_speed_m_s[last]
    );
    assert!(column.gap_m.iter().all(|gap| *gap > -1e-3), "{:?}", column.gap_m);
    assert!(fate(column).1 > 1.5 && column.mean_speed_m_s[last] < 0.1 * fastest);
}
