//! Pictures of the renderer against those kept in `snapshots/render/`, made on lavapipe (Mesa 22.3.6).
//! `UPDATE_SNAPSHOTS=1` writes them anew; look at them before keeping them.

#![allow(clippy::unwrap_used)] // Helpers of tests are tests too.

use glam::{Quat, Vec3};
use phystalk::export::{Raster, Tolerance, compare, read_png, write_exr, write_png};
use phystalk::gpu::Gpu;
use phystalk::render::{Image, Profile, RenderOptions, Renderer, View};
use phystalk::scene::Gaussians;
use phystalk::skin::Splats;
use std::path::PathBuf;

/// A trefoil knot of flat Gaussians that lie along it, tinted by direction, with a gleam in degree 2 that
/// moves with the eye, over a disc.
fn knot() -> Gaussians {
    let mut g = Gaussians { sh_degree: 2, ..Gaussians::default() };
    let at = |t: f32| Vec3::new(t.sin() + 2.0 * (2.0 * t).sin(), t.cos() - 2.0 * (2.0 * t).cos(), -(3.0 * t).sin()) * 0.3;
    for i in 0..1200 {
        let t = i as f32 * std::f32::consts::TAU / 1200.0;
        let along = (at(t + 1e-3) - at(t - 1e-3)).normalize();
        let around = Quat::from_axis_angle(along, i as f32 * 2.4) * along.any_orthonormal_vector();
        let turn = Quat::from_rotation_arc(Vec3::X, along);
        let tint = 0.5 + 0.5 * Vec3::new(along.x, (t * 3.0).sin(), around.z);
        push(&mut g, at(t) + 0.1 * around, Vec3::new(0.03, 0.02, 0.008), turn, 0.9, tint);
    }
    for i in 0..600 {
        let (r, a) = ((i as f32 / 600.0).sqrt() * 1.3, i as f32 * 2.399_963);
        push(&mut g, Vec3::new(r * a.cos(), r * a.sin(), -0.45), Vec3::new(0.06, 0.06, 0.004), Quat::IDENTITY, 0.7, Vec3::splat(0.35 + 0.2 * r));
    }
    g
}

fn push(g: &mut Gaussians, mean: Vec3, scale: Vec3, turn: Quat, opacity: f32, tint: Vec3) {
    g.mean.push(mean);
    g.scale.push(scale);
    g.rotation.push([turn.w, turn.x, turn.y, turn.z]);
    g.opacity.push(opacity);
    let mut sh = [0.0f32; 27];
    sh[..3].copy_from_slice(&((tint - 0.5) / 0.282_094_8).to_array());
    sh[6..9].copy_from_slice(&[0.15; 3]);
    sh[18..21].copy_from_slice(&[0.1, 0.08, 0.05]);
    g.sh.extend(sh);
}

fn draw(profile: Profile, size: [u32; 2], background: [f32; 3]) -> Image {
    let gpu = Gpu::shared_for_tests().unwrap();
    let scene = knot();
    let splats = Splats::new(&gpu, &scene, Quat::IDENTITY, &vec![0; scene.len()]).unwrap();
    let view = View::look_at(Vec3::new(1.6, -2.4, 1.5), Vec3::new(0.0, 0.0, -0.1), 40.0, size).with_background(background);
    let options = RenderOptions { profile, colour: true, depth: true, ..RenderOptions::default() };
    Renderer::new(&gpu).draw(&splats, &view, &options).unwrap().read(&gpu).unwrap()
}

fn kept(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("snapshots/render").join(name)
}

fn updating() -> bool {
    std::env::var_os("UPDATE_SNAPSHOTS").is_some()
}

#[test]
fn each_profile_looks_as_it_did() {
    for (name, profile) in [("gsplat", Profile::Gsplat), ("inria", Profile::Inria), ("antialiased", Profile::Antialiased)] {
        let image = draw(profile, [200, 150], [0.92, 0.92, 0.95]);
        let file = kept(&format!("knot_{name}.png"));
        if updating() {
            write_png(&file, image.size, &image.rgba8).unwrap();
        }
        let actual = Raster { size: image.size, rgba8: image.rgba8 };
        let comparison = compare(&actual, &read_png(&file).unwrap(), Tolerance { psnr_db: 50.0, ..Tolerance::default() });
        assert!(comparison.held, "{name}: {}", comparison.sentence());
    }
}

#[test]
fn colours_and_depths_as_kept_in_the_exr() {
    let image = draw(Profile::Gsplat, [80, 60], [0.0; 3]);
    let (colour, depth) = (image.colour.unwrap(), image.depth.unwrap());
    let file = kept("knot.exr");
    if updating() {
        write_exr(&file, image.size, &colour, Some(&depth)).unwrap();
    }
    let fresh = tempfile::tempdir().unwrap();
    let actual = fresh.path().join("knot.exr");
    write_exr(&actual, image.size, &colour, Some(&depth)).unwrap();
    let (kept, actual) = (channels(&file), channels(&actual));
    assert_eq!(kept.len(), 5, "A, B, G, R, Z");
    for ((name, kept), (_, actual)) in kept.iter().zip(&actual) {
        let far = kept.iter().zip(actual).filter(|(k, a)| k != a && (*k - *a).abs() > 1e-3 * k.abs().max(1.0)).count();
        assert!(far <= 10, "{name}: {far} of {} values differ", kept.len());
    }
}

/// Every channel of an EXR as f32, by name.
fn channels(path: &std::path::Path) -> Vec<(String, Vec<f32>)> {
    use exr::prelude::*;
    let image = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes().from_file(path).unwrap();
    image.layer_data.channel_data.list.iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}
