//! Small scenes, seeded, and where the reference material lies.

use crate::gpu::Gpu;
use crate::render::{Image, RenderOptions, Renderer, View};
use crate::scene::Gaussians;
use crate::skin::Splats;
use glam::{DQuat, Quat, Vec3};
use std::path::PathBuf;

/// SplitMix64, for scenes that are the same everywhere.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In 0..1.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Roughly normal: twelve uniforms.
    pub fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.unit()).sum::<f32>() - 6.0
    }

    pub fn in_cube(&mut self, half: f32) -> Vec3 {
        (Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0) * half
    }
}

/// Random Gaussians in a cube of half side 1, with sizes that overlap a little.
pub fn cloud(n: usize, sh_degree: u32, seed: u64) -> Gaussians {
    let mut random = Random(seed);
    let size = 1.2 / (n as f32).cbrt();
    let floats = ((sh_degree + 1) * (sh_degree + 1) * 3) as usize;
    let mut g = Gaussians { sh_degree, ..Gaussians::default() };
    for _ in 0..n {
        g.mean.push(random.in_cube(1.0));
        g.scale.push(Vec3::new(random.normal(), random.normal(), random.normal()).map(|v| size * (0.5 * v).exp()));
        g.rotation.push([random.normal(), random.normal(), random.normal(), random.normal()]);
        g.opacity.push(1.0 / (1.0 + (-1.5 * random.normal()).exp()));
        g.sh.extend((0..floats).map(|f| 0.2 * random.normal() + if f < 3 { 0.5 } else { 0.0 }));
    }
    g
}

/// One round Gaussian of a colour.
pub fn ball(at: Vec3, radius: f32, opacity: f32, colour: [f32; 3]) -> Gaussians {
    Gaussians {
        mean: vec![at],
        scale: vec![Vec3::splat(radius)],
        rotation: vec![[1.0, 0.0, 0.0, 0.0]],
        opacity: vec![opacity],
        sh_degree: 0,
        sh: colour.map(|c| (c - 0.5) / 0.282_094_8).to_vec(),
    }
}

/// All Gaussians of several scenes of one degree.
pub fn together(scenes: &[Gaussians]) -> Gaussians {
    let mut all = Gaussians { sh_degree: scenes[0].sh_degree, ..Gaussians::default() };
    for g in scenes {
        all.mean.extend(&g.mean);
        all.scale.extend(&g.scale);
        all.rotation.extend(&g.rotation);
        all.opacity.extend(&g.opacity);
        all.sh.extend(&g.sh);
    }
    all
}

/// A camera in front of the cube.
pub fn front(width: u32, height: u32) -> View {
    View::look_at(Vec3::new(0.3, -3.2, 0.4), Vec3::ZERO, 50.0, [width, height])
}

pub fn upload(gpu: &Gpu, g: &Gaussians, turn: DQuat) -> Splats {
    let object: Vec<u32> = (0..g.len() as u32).map(|i| i % 3).collect();
    let turn = Quat::from_xyzw(turn.x as f32, turn.y as f32, turn.z as f32, turn.w as f32);
    Splats::new(gpu, g, turn, &object).unwrap()
}

/// Draws once, with every plane.
pub fn shoot(gpu: &Gpu, renderer: &mut Renderer, g: &Gaussians, view: &View) -> Image {
    let options = RenderOptions { colour: true, depth: true, id: true, ..RenderOptions::default() };
    renderer.draw(&upload(gpu, g, DQuat::IDENTITY), view, &options).unwrap().read(gpu).unwrap()
}

/// The reference material beside the repository, where it is there.
pub fn shared(path: &str) -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared"));
    let file = std::env::var_os("PHYSTALK_SHARED").map_or_else(beside, PathBuf::from).join(path);
    let there = file.exists();
    if !there {
        println!("{} is absent: this comparison falls back to the project's own references", file.display());
    }
    there.then_some(file)
}

/// Peak signal to noise ratio of two 8-bit pictures, decibels.
pub fn psnr(a: impl Iterator<Item = u8>, b: impl Iterator<Item = u8>) -> f64 {
    let (sum, n) = a.zip(b).fold((0.0, 0u32), |(sum, n), (a, b)| (sum + (f64::from(a) - f64::from(b)).powi(2), n + 1));
    10.0 * (255.0f64.powi(2) * f64::from(n) / sum.max(1e-9)).log10()
}
