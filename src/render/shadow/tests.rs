//! The contact shadow: that it follows, fades and blurs as it should, and equals its twin.

use super::twin::ShadowTwin;
use super::*;
use crate::scene::Gaussians;
use glam::{Quat, Vec3};

/// A ball of Gaussians of radius 0.15 m whose lowest point is at `bottom`, over a floor of static
/// ones at z = 0 and, where asked for, under it a table top at z = 0.5.
struct Scene {
    gaussians: Gaussians,
    casters: Vec<u32>,
    receivers: Vec<u32>,
}

const RADIUS: f32 = 0.15;

fn scene(bottom: Vec3, table: bool) -> Scene {
    let mut mean = Vec::new();
    for i in 0..1500 {
        // Points of a sphere along a spiral.
        let z = 1.0 - 2.0 * (i as f32 + 0.5) / 1500.0;
        let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
        let r = (1.0 - z * z).sqrt();
        mean.push(bottom + RADIUS * Vec3::new(r * cos, r * sin, z + 1.0));
    }
    let casters: Vec<u32> = (0..mean.len() as u32).collect();
    let plane = |z: f32, half: f32| (0..1600).map(move |i| Vec3::new((i % 40) as f32 / 19.5 - 1.0, (i / 40) as f32 / 19.5 - 1.0, z / half) * half);
    mean.extend(plane(0.0, 1.0));
    if table {
        mean.extend(plane(0.5, 0.5));
    }
    let count = mean.len();
    let receivers = (casters.len() as u32..count as u32).collect();
    let gaussians = Gaussians {
        scale: vec![Vec3::splat(0.012); count],
        rotation: vec![[1.0, 0.0, 0.0, 0.0]; count],
        opacity: vec![0.9; count],
        sh_degree: 0,
        sh: vec![0.2; count * 3],
        mean,
    };
    Scene { gaussians, casters, receivers }
}

/// Records of all Gaussians with their shade, and the ground's map, from the device.
fn on_device(scene: &Scene, ground_m: Option<f32>) -> (Vec<[f32; 16]>, Vec<f32>) {
    let gpu = Gpu::shared_for_tests().unwrap();
    let object = vec![0; scene.gaussians.len()];
    let splats = Splats::new(&gpu, &scene.gaussians, Quat::IDENTITY, &object).unwrap();
    let shadow = Shadow::new(&gpu, &splats, &scene.casters, &scene.receivers, ground_m).unwrap();
    let mut recording = Recording::default();
    shadow.record(&mut recording);
    // Twice: nothing of a frame may be left over in the next.
    gpu.submit(&recording);
    gpu.submit(&recording);
    let records = gpu.read(&splats.geometry, scene.gaussians.len()).unwrap();
    (records, gpu.read(shadow.ground_map(), (SIDE * SIDE) as usize + 4).unwrap())
}

fn twin(scene: &Scene, ground_m: Option<f32>) -> ShadowTwin {
    let record = |i: u32| {
        let (m, c) = (scene.gaussians.mean[i as usize], scene.gaussians.covariance(i as usize));
        let cov = [c.x_axis.x, c.x_axis.y, c.x_axis.z, c.y_axis.y, c.y_axis.z, c.z_axis.z];
        let mut record = [0.0; 16];
        record[..4].copy_from_slice(&[m.x, m.y, m.z, scene.gaussians.opacity[i as usize]]);
        record[4..10].copy_from_slice(&cov);
        record
    };
    let records = |list: &[u32]| list.iter().map(|&i| record(i)).collect::<Vec<_>>();
    ShadowTwin::new(&records(&scene.casters), &records(&scene.receivers), ground_m).unwrap()
}

#[test]
fn the_device_agrees_with_the_twin() {
    for (bottom, table) in [(Vec3::new(0.1, -0.2, 0.0), false), (Vec3::new(0.0, 0.0, 0.53), true), (Vec3::new(-0.3, 0.2, 1.7), false)] {
        let scene = scene(bottom, table);
        let (records, map) = on_device(&scene, Some(0.0));
        let twin = twin(&scene, Some(0.0));
        let mut darkest = 1.0f32;
        for &receiver in &scene.receivers {
            let record = &records[receiver as usize];
            let expected = twin.shade(Vec3::from_slice(record));
            assert!((record[10] - expected).abs() < 2e-3, "{} where the twin has {expected}", record[10]);
            darkest = darkest.min(record[10]);
        }
        assert!(darkest < 0.99);
        for (t, factor) in map[4..].iter().enumerate() {
            let place = Vec3::new((t as u32 % SIDE) as f32 + 0.5, (t as u32 / SIDE) as f32 + 0.5, 0.0) / map[2];
            assert!((factor - twin.shade(place + Vec3::new(map[0], map[1], 0.0))).abs() < 2e-3);
        }
        // What casts is not darkened by itself.
        assert!(scene.casters.iter().all(|&c| records[c as usize][10] == 1.0));
    }
}

#[test]
fn two_runs_give_the_same_bits() {
    let scene = scene(Vec3::new(0.05, 0.0, 0.2), true);
    let bits = |(records, map): (Vec<[f32; 16]>, Vec<f32>)| {
        (bytemuck::cast_slice::<_, u32>(&records).to_vec(), bytemuck::cast_slice::<_, u32>(&map).to_vec())
    };
    assert_eq!(bits(on_device(&scene, Some(0.0))), bits(on_device(&scene, Some(0.0))));
}

#[test]
fn follows_the_thing_that_casts_it() {
    let here = twin(&scene(Vec3::new(0.0, 0.0, 0.1), false), Some(0.0));
    let shift = Vec3::new(0.437, -0.291, 0.0);
    let there = twin(&scene(Vec3::new(0.0, 0.0, 0.1) + shift, false), Some(0.0));
    for i in 0..400 {
        let p = Vec3::new((i % 20) as f32 * 0.03 - 0.3, (i / 20) as f32 * 0.03 - 0.3, 0.0);
        assert!((here.shade(p) - there.shade(p + shift)).abs() < 0.01);
    }
    assert!(here.shade(Vec3::ZERO) < 0.7 && here.shade(shift) > 0.98);
}

#[test]
fn is_dark_and_tight_at_contact_and_fades_and_widens_with_height() {
    let mut last = (0.0f32, 0.0f32);
    for height in [0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2] {
        let shadow = twin(&scene(Vec3::Z * height, false), Some(0.0));
        let under = shadow.shade(Vec3::ZERO);
        // Where half of the darkening is left.
        let half = (0..4000).map(|i| i as f32 * 1e-3).find(|&x| 1.0 - shadow.shade(Vec3::X * x) < 0.5 * (1.0 - under)).unwrap();
        assert!(under > last.0 && half > last.1 * 0.98, "at {height} m: {under} after {}, {half} m wide after {}", last.0, last.1);
        last = (under, half);
        if height == 0.0 {
            assert!(under < 1.0 - DARKNESS + 0.12 && half < 1.2 * RADIUS, "{under}, {half}");
        }
    }
    assert!(last.0 > 0.97, "{}", last.0);
}

#[test]
fn a_table_keeps_its_floor_in_the_light() {
    let open = twin(&scene(Vec3::Z * 0.55, false), None);
    let covered = twin(&scene(Vec3::Z * 0.55, true), None);
    assert!(open.shade(Vec3::ZERO) < 0.95);
    assert!(covered.shade(Vec3::Z * 0.5) < 0.6, "{}", covered.shade(Vec3::Z * 0.5));
    assert_eq!(covered.shade(Vec3::ZERO), 1.0);
}

#[test]
fn a_table_keeps_its_floor_in_the_light_when_some_of_it_falls_off() {
    let mut scene = scene(Vec3::Z * 0.55, true);
    let whole = twin(&scene, None);
    // A few that lie on the floor beside the table cast a shadow there, and the ball above none below the table.
    for i in 0..20 {
        scene.gaussians.mean[i] = Vec3::new(0.7 + 0.005 * i as f32, 0.0, 0.01);
    }
    let partly = twin(&scene, None);
    for i in 0..100 {
        let p = Vec3::new((i % 10) as f32 * 0.08 - 0.36, (i / 10) as f32 * 0.08 - 0.36, 0.0);
        assert!(whole.shade(p) > 0.99 && partly.shade(p) > 0.99, "{p}: {} {}", whole.shade(p), partly.shade(p));
    }
    assert!(partly.shade(Vec3::new(0.75, 0.0, 0.0)) < 0.8 && partly.shade(Vec3::Z * 0.5) < 0.6);
    let (records, _) = on_device(&scene, None);
    for &receiver in &scene.receivers {
        let record = &records[receiver as usize];
        assert!((record[10] - partly.shade(Vec3::from_slice(record))).abs() < 2e-3);
    }
}

#[test]
fn nothing_that_moves_leaves_all_in_the_light() {
    let mut scene = scene(Vec3::ZERO, false);
    scene.casters.clear();
    let (records, map) = on_device(&scene, Some(0.0));
    assert!(records.iter().all(|r| r[10] == 1.0) && map[4..].iter().all(|&v| v == 1.0));
}

#[test]
fn far_and_absurd_scenes_do_not_break_it() {
    for (centre, size) in [(Vec3::splat(4000.0), 1.0), (Vec3::ZERO, 1e5), (Vec3::ZERO, 1e-6)] {
        let mut scene = scene(Vec3::ZERO, true);
        scene.gaussians.mean.iter_mut().for_each(|m| *m = *m * size + centre);
        let (records, map) = on_device(&scene, Some(centre.z));
        assert!(records.iter().all(|r| (0.0..=1.0).contains(&r[10])) && map[4..].iter().all(|v| (0.0..=1.0).contains(v)));
    }
    // A single Gaussian has no extent at all.
    let mut scene = scene(Vec3::ZERO, false);
    scene.casters.truncate(1);
    assert!(on_device(&scene, None).0.iter().all(|r| (0.0..=1.0).contains(&r[10])));
}

#[test]
fn shaders_are_valid() {
    for source in kernels() {
        let module =
            naga::front::wgsl::parse_str(&source.wgsl()).unwrap_or_else(|e| panic!("{}: {}", source.label, e.emit_to_string(&source.wgsl())));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all()).validate(&module).unwrap();
        let (_, immediates) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("Immediates")).unwrap();
        assert_eq!(immediates.inner.size(module.to_ctx()), source.immediate_bytes);
    }
    let ground: String = GROUND_PARTS.iter().map(|part| part.1).collect();
    let text = format!("const SIDE: u32 = {SIDE}u;\n@group(0) @binding(0) var<storage, read> ground_map: array<f32>;\n{ground}");
    naga::front::wgsl::parse_str(&text).unwrap();
    assert!(shader_text().contains("shadow_shade"));
}
