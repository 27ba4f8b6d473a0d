//! Against pictures that other programs made, where they are there.

use super::reference;
use super::scenes::{cloud, front, psnr, shared, shoot};
use crate::gpu::Gpu;
use crate::render::{Profile, Renderer, View};
use crate::scene::{self, Gaussians};
use glam::{DQuat, Mat4, Vec3};
use std::collections::BTreeMap;
use std::path::Path;

/// The f32 tensors of a safetensors file.
fn safetensors(path: &Path) -> BTreeMap<String, Vec<f32>> {
    let bytes = std::fs::read(path).unwrap();
    let header_bytes = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
    let header: serde_json::Value = serde_json::from_slice(&bytes[8..8 + header_bytes]).unwrap();
    let data = &bytes[8 + header_bytes..];
    let tensors = header.as_object().unwrap().iter().filter(|(name, _)| *name != "__metadata__");
    tensors
        .map(|(name, tensor)| {
            let at = |i: usize| tensor["data_offsets"][i].as_u64().unwrap() as usize;
            (name.clone(), bytemuck::pod_collect_to_vec(&data[at(0)..at(1)]))
        })
        .collect()
}

fn brush_scene(t: &BTreeMap<String, Vec<f32>>) -> Gaussians {
    let vectors = |name: &str| t[name].chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
    Gaussians {
        mean: vectors("means"),
        scale: vectors("scales").into_iter().map(|s| s.map(f32::exp)).collect(),
        rotation: t["quats"].chunks_exact(4).map(|q| [q[0], q[1], q[2], q[3]]).collect(),
        opacity: t["opacities"].iter().map(|o| 1.0 / (1.0 + (-o).exp())).collect(),
        sh_degree: 3,
        sh: t["coeffs"].clone(),
    }
}

/// Width 123, height 82, focal length half the width, at (0.123, 0.456, -8), unturned.
fn brush_camera() -> View {
    View {
        width: 123,
        height: 82,
        fx: 61.5,
        fy: 61.5,
        cx: 61.5,
        cy: 41.0,
        world_to_camera: Mat4::from_translation(Vec3::new(-0.123, -0.456, 8.0)),
        background: [0.0; 3],
    }
}

#[test]
fn brush_cases_to_1e_4_outside_threshold_flips() {
    let gpu = Gpu::shared_for_tests().unwrap();
    let mut renderer = Renderer::new(&gpu);
    for case in ["tiny", "basic"] {
        let Some(path) = shared(&format!("checks/brush_{case}_case.safetensors")) else { continue };
        let tensors = safetensors(&path);
        let (scene, view) = (brush_scene(&tensors), brush_camera());
        let image = shoot(&gpu, &mut renderer, &scene, &view);
        let own = reference::draw(&scene, DQuat::IDENTITY, &view, Profile::Gsplat);
        let mut flips = 0;
        for (i, expected) in tensors["out_img"].chunks_exact(4).enumerate() {
            if own[i].margin < 1e-4 {
                flips += 1;
                continue;
            }
            let got = image.colour.as_ref().unwrap()[i];
            for (g, e) in got.iter().zip(expected) {
                assert!((g - e).abs() < 1e-4, "{case}, pixel {i}: {got:?} against {expected:?}");
            }
        }
        assert!(flips < 20, "{case}: {flips} pixels lie at a threshold");
    }
}

#[test]
fn posed_views_of_real_scenes_at_60_db() {
    let gpu = Gpu::shared_for_tests().unwrap();
    let mut renderer = Renderer::new(&gpu);
    let Some(cameras) = shared("checks/renders/cameras.json") else {
        own_views(&gpu, &mut renderer);
        return;
    };
    let scenes: serde_json::Value = serde_json::from_slice(&std::fs::read(cameras).unwrap()).unwrap();
    for name in ["vase", "bulldozer", "hamburger"] {
        let Some(file) = shared(scenes[name]["scene"].as_str().unwrap()) else { continue };
        let gaussians = scene::read(&file).unwrap().gaussians;
        for camera in scenes[name]["cameras"].as_array().unwrap() {
            let view: View = serde_json::from_value(camera.clone()).unwrap();
            let image = shoot(&gpu, &mut renderer, &gaussians, &view);
            let picture = camera["file"].as_str().unwrap();
            let expected = image::open(shared(&format!("checks/renders/{picture}")).unwrap()).unwrap().to_rgb8();
            let opaque = image.rgba8.chunks_exact(4).flat_map(|p| p[..3].to_vec());
            let db = psnr(opaque, expected.as_raw().iter().copied());
            println!("{picture}: {db:.1} dB");
            assert!(db >= 60.0, "{picture}: {db:.1} dB");
        }
    }
}

/// The same demand on a scene of our own against the f64 reference.
fn own_views(gpu: &Gpu, renderer: &mut Renderer) {
    let scene = cloud(20_000, 3, 21);
    let view = front(160, 120).with_background([1.0; 3]);
    let image = shoot(gpu, renderer, &scene, &view);
    let expected = reference::draw(&scene, DQuat::IDENTITY, &view, Profile::Gsplat);
    let expected = expected.iter().flat_map(|p| p.bytes(glam::DVec3::ONE));
    let db = psnr(image.rgba8.chunks_exact(4).flat_map(|p| p[..3].to_vec()), expected);
    assert!(db >= 60.0, "{db:.1} dB");
}
