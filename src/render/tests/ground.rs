//! The pass of the plain ground, pixel by pixel in plain Rust.

use super::scenes::{Random, ball, upload};
use crate::gpu::Gpu;
use crate::render::profile::{FAR, POOL_TONE};
use crate::render::shadow::SIDE;
use crate::render::uniform::Uniform;
use crate::render::{GroundLook, RenderOptions, Renderer, View};
use glam::{DQuat, Vec2, Vec3, Vec4, Vec4Swizzles};

/// Factor of the ground behind one pixel.
fn ground(frame: &Uniform, map: &[f32], x: u32, y: u32) -> f32 {
    let slope = (Vec2::new(x as f32, y as f32) + 0.5 - Vec2::from(frame.centre)) / Vec2::from(frame.focal);
    let row = |i: usize| Vec4::from(frame.camera[i]).truncate();
    let ray = slope.x * row(0) + slope.y * row(1) + row(2);
    let reach = (frame.ground_m - frame.eye[2]) / ray.z;
    if !(reach > 0.0 && reach < FAR && frame.eye[2] > frame.ground_m) {
        return 1.0;
    }
    let p = Vec2::new(frame.eye[0], frame.eye[1]) + reach * ray.truncate();
    let pool = Vec4::from(frame.pool);
    let tone = if pool.z > 0.0 { 1.0 - POOL_TONE * (-((p - pool.xy()).length() / pool.z).powi(2)).exp() } else { 1.0 };
    shade(map, p) * tone
}

/// The map at a place, through a quadratic B-spline; 1 beyond it.
fn shade(map: &[f32], p: Vec2) -> f32 {
    let s = (p - Vec2::new(map[0], map[1])) * map[2];
    if s.min_element() < 1.0 || s.max_element() > SIDE as f32 - 1.0 {
        return 1.0;
    }
    let (cell, f) = (s.floor().as_ivec2(), s - s.floor());
    let weights = |f: f32| [0.5 * (1.0 - f).powi(2), 0.5 + f * (1.0 - f), 0.5 * f * f];
    let (across, down) = (weights(f.x), weights(f.y));
    let texel = |x: i32, y: i32| map[4 + (y.clamp(0, SIDE as i32 - 1) * SIDE as i32 + x.clamp(0, SIDE as i32 - 1)) as usize];
    let taps = (0..9).map(|k| across[k % 3] * down[k / 3] * texel(cell.x + k as i32 % 3 - 1, cell.y + k as i32 / 3 - 1));
    taps.sum()
}

/// A map of noise that is full light at its border, over a square from (-1, -1.5) of 2.6 m.
fn map() -> Vec<f32> {
    let mut random = Random(5);
    let mut map = vec![-1.0, -1.5, SIDE as f32 / 2.6, 0.0];
    map.extend((0..SIDE * SIDE).map(|i| {
        let (x, y) = (i % SIDE, i / SIDE);
        let border = x.min(y).min(SIDE - 1 - x.max(y)) < 2;
        if border { 1.0 } else { random.unit() }
    }));
    map
}

#[test]
fn the_plain_ground_equals_its_twin() {
    let gpu = Gpu::shared_for_tests().unwrap();
    let splats = upload(&gpu, &ball(Vec3::Z, 0.1, 0.9, [0.5; 3]), DQuat::IDENTITY);
    let (renderer, map) = (Renderer::new(&gpu), map());
    let shadow = gpu.storage_from("test.map", &map).unwrap();
    let view = |eye: Vec3, target: Vec3| View::look_at(eye, target, 60.0, [70, 50]);
    let down = view(Vec3::new(0.4, -2.5, 1.5), Vec3::new(0.1, 0.0, 0.2));
    let horizon = view(Vec3::new(0.4, -2.5, 0.5), Vec3::new(0.1, 0.0, 0.5));
    let below = view(Vec3::new(0.4, -2.5, 0.1), Vec3::new(0.1, 0.0, 0.6));
    for (view, pool_m, plain) in [(&down, [0.3, 0.2, 1.5], 0), (&down, [0.0; 3], 1), (&horizon, [0.3, 0.2, 1.5], 1), (&below, [0.3, 0.2, 1.5], 3500)]
    {
        let look = GroundLook { height_m: 0.2, shadow: Some(shadow.clone()), pool_m };
        let frame = renderer.prepare(&splats, view, &RenderOptions { ground: Some(look), ..RenderOptions::default() }).unwrap();
        gpu.submit(&frame.record(&gpu, &renderer.shared.passes, &splats));
        let got: Vec<f32> = gpu.read(&frame.buffers.backdrop, 70 * 50).unwrap();
        for (i, got) in got.iter().enumerate() {
            let want = ground(&frame.uniform, &map, i as u32 % 70, i as u32 / 70);
            assert!((got - want).abs() < 1e-4, "pixel {} {}: {got} against {want}", i % 70, i / 70);
        }
        let unshaded = got.iter().filter(|&&factor| factor == 1.0).count();
        assert!(unshaded >= plain && (plain == 3500 || got.iter().any(|&factor| factor < 0.5)), "{unshaded} pixels without shade");
    }
}
