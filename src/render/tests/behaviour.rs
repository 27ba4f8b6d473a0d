//! The renderer against the slow reference, and what it must do whatever it is given.

use super::reference;
use super::scenes::{ball, cloud, front, shoot, together, upload};
use crate::gpu::{Gpu, Recording, Tier};
use crate::render::shadow::Shadow;
use crate::render::{GroundLook, Image, Profile, RenderOptions, Renderer, View};
use crate::scene::Gaussians;
use glam::{DQuat, DVec3, Vec3};

const FORMS: [(Tier, u32); 4] = [(Tier::Cpu, 16), (Tier::Cpu, 32), (Tier::Gpu, 16), (Tier::Gpu, 32)];

fn gpu() -> Gpu {
    Gpu::shared_for_tests().unwrap()
}

/// Largest error of colour and alpha, and of depth relative to it, over pixels where no decision was
/// within rounding of going the other way; and how many pixels were.
fn compare(image: &Image, pixels: &[reference::Pixel]) -> (f64, f64, usize) {
    let (mut worst, mut worst_depth, mut close) = (0.0f64, 0.0f64, 0);
    for (i, expected) in pixels.iter().enumerate() {
        if expected.margin < 1e-4 {
            close += 1;
            continue;
        }
        let [r, g, b, a] = image.colour.as_ref().unwrap()[i].map(f64::from);
        let error = (DVec3::new(r, g, b) - expected.colour).abs().max_element();
        worst = worst.max(error).max((a - (1.0 - expected.transmittance)).abs());
        let (depth, alpha) = (f64::from(image.depth.as_ref().unwrap()[i]), 1.0 - expected.transmittance);
        if alpha > 0.0 {
            worst_depth = worst_depth.max((depth * alpha / expected.depth - 1.0).abs());
        } else {
            assert_eq!(depth, f64::INFINITY);
        }
    }
    (worst, worst_depth, close)
}

#[test]
fn every_form_equals_the_reference() {
    let gpu = gpu();
    let turn = DQuat::from_rotation_z(0.7) * DQuat::from_rotation_x(0.4);
    let view = front(101, 67);
    for (degree, profile) in [(3, Profile::Gsplat), (0, Profile::Gsplat), (1, Profile::Antialiased), (2, Profile::Gsplat)] {
        let g = cloud(3000, degree, 5);
        let expected = reference::draw(&g, turn, &view, profile);
        let splats = upload(&gpu, &g, turn);
        let options = RenderOptions { profile, colour: true, depth: true, id: true, ..RenderOptions::default() };
        for (tier, bin) in FORMS {
            let image = Renderer::with_form(&gpu, tier, bin).draw(&splats, &view, &options).unwrap().read(&gpu).unwrap();
            let (worst, depth, close) = compare(&image, &expected);
            assert!(worst < 1e-4 && depth < 1e-4, "{tier:?} {bin} degree {degree} {profile:?}: {worst:.1e}, depth {depth:.1e}");
            assert!(close < expected.len() / 10, "{close} pixels at a threshold");
        }
    }
}

#[test]
fn every_form_gives_the_same_bits_every_time() {
    let gpu = gpu();
    let g = cloud(4000, 1, 6);
    let view = front(90, 75);
    for (tier, bin) in FORMS {
        let mut renderer = Renderer::with_form(&gpu, tier, bin);
        let first = shoot(&gpu, &mut renderer, &g, &view);
        assert!(shoot(&gpu, &mut renderer, &g, &view) == first, "{tier:?} {bin}");
        assert!(shoot(&gpu, &mut Renderer::with_form(&gpu, tier, bin), &g, &view) == first, "{tier:?} {bin}, another renderer");
    }
}

#[test]
fn a_known_alpha_at_the_centre_and_half_pixels() {
    let gpu = gpu();
    // On the axis of a picture of odd size the centre lies on the middle pixel's centre.
    let view = View::look_at(Vec3::new(0.0, -4.0, 0.0), Vec3::ZERO, 40.0, [33, 33]);
    for (tier, bin) in FORMS {
        let image = shoot(&gpu, &mut Renderer::with_form(&gpu, tier, bin), &ball(Vec3::ZERO, 0.2, 0.6, [1.0, 0.5, 0.25]), &view);
        let [r, g, b, a] = image.colour.as_ref().unwrap()[16 * 33 + 16];
        assert!((a - 0.6).abs() < 1e-6 && (r - 0.6).abs() < 1e-6 && (g - 0.3).abs() < 1e-6 && (b - 0.15).abs() < 1e-6);
        assert!((image.depth.as_ref().unwrap()[16 * 33 + 16] - 4.0).abs() < 1e-5);
        let at = |x: usize, y: usize| image.colour.as_ref().unwrap()[y * 33 + x];
        assert_eq!(at(10, 16), at(22, 16), "symmetric");
        assert_eq!(at(16, 10), at(16, 22));
    }
}

#[test]
fn nearer_covers_farther_and_equal_depths_go_by_index() {
    let gpu = gpu();
    let view = View::look_at(Vec3::new(0.0, -4.0, 0.0), Vec3::ZERO, 40.0, [17, 17]);
    let (red, blue) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let middle = 8 * 17 + 8;
    for (tier, bin) in FORMS {
        let mut renderer = Renderer::with_form(&gpu, tier, bin);
        let far_first = together(&[ball(Vec3::Y, 0.3, 0.9, red), ball(-Vec3::Y, 0.3, 0.9, blue)]);
        let image = shoot(&gpu, &mut renderer, &far_first, &view);
        let colour = image.colour.as_ref().unwrap()[middle];
        assert!(colour[2] > 0.85 && colour[0] < 0.1, "the nearer one is blue");
        assert_eq!(image.id.as_ref().unwrap()[middle], 1);
        for (first, second, channel) in [(red, blue, 0), (blue, red, 2)] {
            let tied = together(&[ball(Vec3::ZERO, 0.3, 0.9, first), ball(Vec3::ZERO, 0.3, 0.9, second)]);
            let image = shoot(&gpu, &mut renderer, &tied, &view);
            assert!(image.colour.unwrap()[middle][channel] > 0.85, "the lower index is in front");
            assert_eq!(image.id.unwrap()[middle], 0);
        }
    }
}

#[test]
fn poison_falls_out_and_the_rest_is_drawn() {
    let gpu = gpu();
    let view = front(40, 30);
    let good = cloud(300, 0, 8);
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let mut bad = cloud(14, 0, 9);
    bad.mean[0] = Vec3::new(nan, 0.0, 0.0);
    bad.mean[1] = Vec3::new(0.0, inf, 0.0);
    bad.mean[2] = Vec3::splat(-inf);
    bad.scale[3] = Vec3::splat(nan);
    bad.scale[4] = Vec3::splat(1e30);
    bad.scale[5] = Vec3::splat(inf);
    bad.scale[6].y = nan;
    bad.opacity[7] = nan;
    bad.opacity[8] = inf;
    bad.opacity[9] = -1.0;
    bad.opacity[10] = 0.0;
    bad.sh[33] = nan;
    bad.sh[36] = inf;
    bad.mean[13] = view.eye();
    let mixed = together(&[good.clone(), bad]);
    for (tier, bin) in FORMS {
        let mut renderer = Renderer::with_form(&gpu, tier, bin);
        let (clean, poisoned) = (shoot(&gpu, &mut renderer, &good, &view), shoot(&gpu, &mut renderer, &mixed, &view));
        assert!(clean == poisoned, "{tier:?} {bin}");
        assert!(poisoned.colour.unwrap().iter().flatten().all(|c| c.is_finite()));
    }
}

#[test]
fn nothing_one_behind_and_tiny_pictures() {
    let gpu = gpu();
    let background = [0.2, 0.4, 0.6];
    let empty_pixel = [51, 102, 153, 255];
    for (tier, bin) in FORMS {
        let mut renderer = Renderer::with_form(&gpu, tier, bin);
        for (width, height) in [(1, 1), (1, 40), (33, 2), (31, 65)] {
            let view = front(width, height).with_background(background);
            let behind = ball(Vec3::new(0.3, -5.0, 0.4), 0.2, 1.0, [1.0; 3]);
            for nothing in [Gaussians::default(), behind] {
                let image = shoot(&gpu, &mut renderer, &nothing, &view);
                assert_eq!(image.rgba8.len(), (4 * width * height) as usize);
                assert!(image.rgba8.chunks(4).all(|p| p == empty_pixel));
                assert!(image.depth.unwrap().iter().all(|&z| z == f32::INFINITY));
                assert!(image.id.unwrap().iter().all(|&id| id == u32::MAX));
            }
            let one = shoot(&gpu, &mut renderer, &ball(Vec3::ZERO, 0.5, 0.9, [1.0; 3]), &view);
            assert!(one.rgba8.chunks(4).any(|p| p != empty_pixel), "{width} x {height}");
        }
    }
}

#[test]
fn an_overflow_is_drawn_again_whole() {
    let gpu = gpu();
    // Wide splats: each covers most bins, far past the room that a first frame gets.
    let mut g = cloud(3000, 0, 12);
    g.scale.iter_mut().for_each(|s| *s = Vec3::splat(0.6));
    g.opacity.iter_mut().for_each(|o| *o = 0.02);
    let view = front(260, 200);
    let expected = reference::draw(&g, DQuat::IDENTITY, &view, Profile::Gsplat);
    for (tier, bin) in [(Tier::Cpu, 16), (Tier::Gpu, 16)] {
        let mut renderer = Renderer::with_form(&gpu, tier, bin);
        let options = RenderOptions { colour: true, depth: true, ..RenderOptions::default() };
        let splats = upload(&gpu, &g, DQuat::IDENTITY);
        // Two in flight, so that the first is drawn again after the second was submitted.
        let pictures = [(); 2].map(|()| renderer.draw(&splats, &view, &options).unwrap());
        let [first, second] = pictures.map(|p| p.read(&gpu).unwrap());
        assert!(first == second);
        let (worst, depth, _) = compare(&first, &expected);
        assert!(worst < 1e-4 && depth < 1e-4, "{worst:.1e} {depth:.1e}");
    }
}

#[test]
fn the_plain_ground_darkens_under_what_stands_on_it_and_nowhere_else() {
    let gpu = gpu();
    // A ball of many that just touches the ground.
    let on_ball = |i: usize| {
        let (z, (sin, cos)) = (1.0 - (i as f32 + 0.5) / 300.0, (i as f32 * 2.399_963).sin_cos());
        0.2 * Vec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z + 1.0)
    };
    let g = together(&(0..600).map(|i| ball(on_ball(i), 0.015, 0.9, [0.8, 0.3, 0.2])).collect::<Vec<_>>());
    let casters: Vec<u32> = (0..600).collect();
    let splats = upload(&gpu, &g, DQuat::IDENTITY);
    let view = View::look_at(Vec3::new(0.0, -2.5, 1.2), Vec3::new(0.0, 0.0, 0.1), 40.0, [96, 72]).with_background([0.9; 3]);
    let shadow = Shadow::new(&gpu, &splats, &casters, &[], Some(0.0)).unwrap();
    let mut recording = Recording::default();
    shadow.record(&mut recording);
    gpu.submit(&recording);
    let draw = |shadow: Option<wgpu::Buffer>, tier, bin| {
        let options = RenderOptions { ground: Some(GroundLook { height_m: 0.0, shadow, pool_m: [0.0; 3] }), ..RenderOptions::default() };
        Renderer::with_form(&gpu, tier, bin).draw(&splats, &view, &options).unwrap().read(&gpu).unwrap().rgba8
    };
    let plain = draw(None, Tier::Cpu, 16);
    for (tier, bin) in FORMS {
        let shaded = draw(Some(shadow.ground_map().clone()), tier, bin);
        let red = |picture: &[u8], x: usize, y: usize| picture[4 * (y * 96 + x)];
        assert!((0..96).all(|x| red(&shaded, x, 0) == red(&plain, x, 0)), "nothing above the horizon");
        let foot = view.world_to_camera.transform_point3(Vec3::new(0.0, -0.2, 0.0));
        let (x, y) = ((view.fx * foot.x / foot.z + view.cx) as usize, (view.fy * foot.y / foot.z + view.cy) as usize);
        assert!(red(&shaded, x, y) + 8 < red(&plain, x, y), "{} against {} at {x}, {y}", red(&shaded, x, y), red(&plain, x, y));
        assert!(shaded.iter().zip(&plain).all(|(s, p)| *s <= p.saturating_add(1)), "never brighter than by the grain");
        let below = View::look_at(Vec3::new(0.0, -2.5, -0.5), Vec3::ZERO, 40.0, [96, 72]).with_background([0.9; 3]);
        let options = RenderOptions {
            ground: Some(GroundLook { height_m: 0.0, shadow: Some(shadow.ground_map().clone()), pool_m: [0.0; 3] }),
            ..RenderOptions::default()
        };
        let from_below = Renderer::with_form(&gpu, tier, bin).draw(&splats, &below, &options).unwrap().read(&gpu).unwrap();
        assert_eq!(from_below.rgba8[..4], [230, 230, 230, 255], "the ground is seen from above only");
    }
}

#[test]
fn a_slow_gradient_of_the_ground_has_no_steps() {
    let gpu = gpu();
    let g = together(&[ball(Vec3::new(0.0, 0.0, 50.0), 0.01, 0.9, [0.8, 0.3, 0.2])]);
    let splats = upload(&gpu, &g, DQuat::IDENTITY);
    let shadow = Shadow::new(&gpu, &splats, &[0], &[], Some(0.0)).unwrap();
    // Half of a pool of tone from above: some twelve levels over 96 pixels.
    let view = View::look_at(Vec3::new(0.9, 0.0, 3.0), Vec3::new(0.9, 0.01, 0.0), 30.0, [96, 72]).with_background([0.9; 3]);
    let ground = Some(GroundLook { height_m: 0.0, shadow: Some(shadow.ground_map().clone()), pool_m: [0.0, 0.0, 1.0] });
    for (tier, bin) in FORMS {
        let options = RenderOptions { ground: ground.clone(), ..RenderOptions::default() };
        let picture = Renderer::with_form(&gpu, tier, bin).draw(&splats, &view, &options).unwrap().read(&gpu).unwrap().rgba8;
        // Rounded to whole levels, most blocks of 6 by 6 pixels would lie on one; the grain leaves the mean in between.
        let mean = |block: usize| {
            let (x, y) = (block % 16 * 6, block / 16 * 6);
            let sum: u32 = (0..36).map(|i| u32::from(picture[4 * ((y + i / 6) * 96 + x + i % 6)])).sum();
            f64::from(sum) / 36.0
        };
        let means: Vec<f64> = (0..16 * 12).map(mean).collect();
        let whole = means.iter().filter(|m| m.fract() == 0.0).count();
        assert!(whole * 4 < means.len(), "{whole} of {} blocks have one level", means.len());
        let (low, high) = means.iter().fold((255.0f64, 0.0f64), |(low, high), m| (low.min(*m), high.max(*m)));
        assert!(high - low > 3.0, "{low} to {high}");
    }
}
