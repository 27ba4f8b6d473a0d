//! As captured, so at rest, as it is seen: Gaussian by Gaussian, from the scene's file to skinning.

use super::engine::Engine;
use super::{EngineError, Player, Quality, RunOptions};
use crate::gpu::{DeviceRequest, Gpu, Recording};
use crate::render::{RenderOptions, View};
use crate::scene::{self, Gaussians};
use crate::skin::{Skinner, Splats};
use crate::spec::{Auto, Axis, Liquid, Material, Spec, Weights, Young};
use crate::store::Store;
use crate::world::bodies::matter;
use crate::world::measure::MotionFrame;
use crate::world::{Figure, World};
use crate::{Discard, Stop};
use glam::Vec3;
use std::path::Path;

/// How far from its captured place a scene left alone is seen, as shares of its height: the largest
/// over all Gaussians, at each of some frames.
fn seen_moving(spec: &Spec, base: &Path, frames: &[u32]) -> Vec<f32> {
    let folder = tempfile::tempdir().unwrap();
    let mut engine = Engine::new(Store::open(folder.path()).unwrap(), DeviceRequest::default());
    let options = RunOptions { quality: Some(Quality::Draft), ..Default::default() };
    let ready = engine.ready(spec, base, &options).unwrap();
    let solids = engine.solids(spec, &ready).unwrap().value;
    let bound = engine.bound(spec, &ready, &solids).unwrap().value;
    let prepared = &ready.prepared.value;
    let matter = matter(spec, prepared, &solids);
    let (gpu, stop) = (Gpu::shared_for_tests().unwrap(), Stop::default());
    let mut world = World::new(&gpu, spec, &matter, &ready.resolved).unwrap();
    let rest = &matter.particles.position_m;
    let shown = |world: &mut World| {
        world.show();
        let words: Vec<[u32; 8]> = gpu.read(world.motion(), rest.len()).unwrap();
        MotionFrame::unpack(bytemuck::cast_slice(&words), &[])
    };
    assert!(World::starts_as_captured(spec));
    let captured = shown(&mut world);
    world.prestress(spec, &stop, &mut |_| {}).unwrap();
    world.place(spec, &matter).unwrap();
    // Frame 0 may be drawn before the stress is known that it stands with.
    let standing = shown(&mut world);
    assert!(captured.position_m == standing.position_m);
    assert!(captured.deformation.iter().zip(&standing.deformation).all(|(a, b)| a.abs_diff_eq(*b, 1e-4)));
    let splats = Splats::new(&gpu, &prepared.gaussians, prepared.world_from_sh, &prepared.object_of).unwrap();
    let skinner = Skinner::new(&gpu, &splats, &bound, rest, spec.skin.weights).unwrap();
    let height_m = prepared.object_facts(spec)[0].height_m() as f32;
    let mut moved = Vec::new();
    for frame in 1..=frames[frames.len() - 1] {
        world.step_frame(&stop).unwrap();
        if frames.contains(&frame) {
            world.show();
            let mut recording = Recording::default();
            skinner.record(world.motion(), &mut recording);
            gpu.submit(&recording);
            let records: Vec<[f32; 16]> = gpu.read(&splats.geometry, prepared.gaussians.len()).unwrap();
            let farthest_m = records.iter().zip(&prepared.gaussians.mean).map(|(r, p)| Vec3::from_slice(r).distance(*p)).fold(0.0, f32::max);
            moved.push(farthest_m / height_m);
        }
    }
    println!("{} particles, seen to move by {moved:?} of their height", rest.len());
    moved
}

/// A block of Gaussians, and a twig of single ones that stands out of its side.
fn twig() -> Gaussians {
    let block = (0..10 * 10 * 15).map(|i| Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) * 0.02);
    let twig = (0..16).map(|i| Vec3::new(0.19 + 0.01 * i as f32, 0.09, 0.2));
    let mut gaussians = Gaussians::default();
    for (mean, size) in block.map(|p| (p, 0.009)).chain(twig.map(|p| (p, 0.003))) {
        gaussians.mean.push(mean);
        gaussians.scale.push(Vec3::splat(size));
        gaussians.rotation.push([1.0, 0.0, 0.0, 0.0]);
        gaussians.opacity.push(0.9);
        gaussians.sh.extend([0.8, 0.1, -0.3]);
    }
    gaussians
}

#[test]
fn a_twig_thinner_than_the_grid_sees_stands_as_captured() {
    let folder = tempfile::tempdir().unwrap();
    scene::write(&folder.path().join("twig.ply"), &twig()).unwrap();
    let mut spec = Spec::of_scene("twig.ply");
    spec.scene.up = Auto::Value(Axis::PlusZ);
    let Material::Elastic(elastic) = &mut spec.objects[0].material else { panic!("elastic") };
    elastic.young_pa = Young::Value(2e5);
    spec.solver.cells_across = Auto::Value(10);
    let moved = seen_moving(&spec, folder.path(), &[10, 25]);
    assert!(moved.iter().all(|&share| share < 0.01), "{moved:?}");
    // Of jelly it is firmer where its weight asks for it, and nowhere else: given as stiff as that throughout it droops.
    for (young_pa, stands) in [(Young::AtLeast(1e4), true), (Young::Value(1e4), false)] {
        let Material::Elastic(elastic) = &mut spec.objects[0].material else { panic!("elastic") };
        elastic.young_pa = young_pa;
        let moved = seen_moving(&spec, folder.path(), &[10, 25]);
        assert!(moved.iter().all(|&share| share < 0.015) == stands, "{young_pa:?}: {moved:?}");
    }
}

#[test]
fn the_vase_of_the_demo_left_alone_stands() {
    let moved = seen_moving(&scene::demo::spec(), Path::new(""), &[25]);
    assert!(moved.iter().all(|&share| share < 0.01), "{moved:?}");
}

/// An engine with a store of its own, and the twig for half a second.
fn twigs(folder: &Path) -> (Engine, Spec) {
    scene::write(&folder.join("twig.ply"), &twig()).unwrap();
    let mut spec = Spec::of_scene("twig.ply");
    spec.scene.up = Auto::Value(Axis::PlusZ);
    (spec.time.duration_s, spec.time.fps) = (Auto::Value(0.5), 20);
    spec.solver.cells_across = Auto::Value(10);
    spec.output.size = Auto::Value([48, 32]);
    (Engine::new(Store::open(&folder.join("store")).unwrap(), DeviceRequest::default()), spec)
}

#[test]
fn a_lost_device_is_opened_anew_by_the_next_turn() {
    let folder = tempfile::tempdir().unwrap();
    let (mut engine, _) = twigs(folder.path());
    let gpu = engine.device().unwrap().clone();
    let size = gpu.device.limits().max_buffer_size + 4;
    let _ = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("too large"),
        size,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    });
    let views = [View::look_at(Vec3::new(0.0, -1.0, 0.3), Vec3::ZERO, 40.0, [32, 32])];
    assert!(matches!(engine.still(&twig(), &views, &RenderOptions::default()), Err(EngineError::Gpu(_))));
    assert_eq!(engine.still(&twig(), &views, &RenderOptions::default()).unwrap().len(), 1);
    assert!(!engine.device().unwrap().is(&gpu));
}

#[test]
fn a_player_whose_motion_goes_away_has_fewer_frames() {
    let folder = tempfile::tempdir().unwrap();
    let (mut engine, spec) = twigs(folder.path());
    engine.gpu = Some(Gpu::shared_for_tests().unwrap());
    let options = RunOptions { render: false, ..RunOptions::default() };
    engine.run(&spec, folder.path(), &options, None, &mut Discard, &Stop::default()).unwrap();
    let segments = engine.ready(&spec, folder.path(), &options).unwrap().segments;
    let mut player = engine.player(&spec, folder.path(), &options).unwrap();
    let (camera, size) = (player.camera, player.size);
    assert_eq!((segments.len(), player.frames), (2, 11));
    let mut picture = |player: &mut Player, index| player.picture(&mut engine, index, &camera, size).unwrap().rgba8;
    let at_5 = picture(&mut player, 5);
    player.store.clone().remove("motion", &segments[1].key).unwrap();
    assert!(picture(&mut player, 10) == at_5 && player.frames == 6);
    player.store.clone().remove("motion", &segments[0].key).unwrap();
    // What is in memory is still there; what is not begins anew from the scene as captured.
    player.held = None;
    picture(&mut player, 0);
    assert_eq!((player.frames, player.is_behind()), (0, false));
}

#[test]
fn with_the_weights_of_the_paper_no_particles_are_drawn_beside_the_gaussians() {
    let folder = tempfile::tempdir().unwrap();
    let (mut engine, mut spec) = twigs(folder.path());
    spec.objects[0].material = Material::Liquid(Liquid::default());
    let gpu = Gpu::shared_for_tests().unwrap();
    engine.gpu = Some(gpu.clone());
    let ready = engine.ready(&spec, folder.path(), &RunOptions::default()).unwrap();
    let solids = engine.solids(&spec, &ready).unwrap().value;
    let bound = engine.bound(&spec, &ready, &solids).unwrap().value;
    let prepared = &ready.prepared.value;
    let matter = matter(&spec, prepared, &solids);
    let figure = |weights| Figure::new(&gpu, prepared, &bound, &matter, weights).unwrap();
    let (exact, paper) = (figure(Weights::Exact), figure(Weights::Paper));
    assert!(exact.suits(&matter, Weights::Exact) && paper.suits(&matter, Weights::Paper) && !paper.suits(&matter, Weights::Exact));
}
