//! How fast pictures are drawn and keys are sorted: whole frames, the queue kept full.

use super::{RenderOptions, Renderer, View};
use crate::gpu::{Extent, Gpu, GpuError, PassTime, RadixSort, Recording, Samples};
use crate::scene::{Gaussians, morton_order};
use crate::skin::Splats;
use glam::{Mat4, Quat, Vec3};

/// One benchmark's result.
#[derive(Clone, Debug)]
pub struct Bench {
    /// Seconds of one frame, or of one sort.
    pub samples: Samples,
    /// Each label alone, for shares; slower in sum than the whole.
    pub passes: Vec<PassTime>,
    /// Seconds of the fixed kernel right after.
    pub calibration_s: f64,
}

/// Draws `gaussians` random ones with spherical harmonics of degree 3, all in view, as the peers'
/// benchmark does: uniform in a cube of half side 1, log-normal sizes around 0.6 of their spacing.
pub fn bench_render(gpu: &Gpu, gaussians: usize, size: [u32; 2]) -> Result<Bench, GpuError> {
    bench_with(gpu, &Renderer::new(gpu), gaussians, size)
}

/// The same with a given form of the renderer.
pub fn bench_with(gpu: &Gpu, renderer: &Renderer, gaussians: usize, size: [u32; 2]) -> Result<Bench, GpuError> {
    finish(gpu, &bench_recording(gpu, renderer, gaussians, size)?)
}

/// The frame that is timed, as data.
pub fn bench_recording(gpu: &Gpu, renderer: &Renderer, gaussians: usize, size: [u32; 2]) -> Result<Recording, GpuError> {
    let scene = random_scene(gaussians, 1);
    let splats = Splats::new(gpu, &scene, Quat::IDENTITY, &vec![0; gaussians])?;
    let focal = 0.5 * size[1] as f32 / 25f32.to_radians().tan();
    let view = View {
        width: size[0],
        height: size[1],
        fx: focal,
        fy: focal,
        cx: 0.5 * size[0] as f32,
        cy: 0.5 * size[1] as f32,
        world_to_camera: Mat4::from_translation(3.2 * Vec3::Z),
        background: [0.0; 3],
    };
    renderer.recording(&splats, &view, &RenderOptions::default())
}

/// Sorts `n` random pairs by all 32 bits.
pub fn bench_sort(gpu: &Gpu, n: usize) -> Result<Bench, GpuError> {
    let sort = RadixSort::new(gpu);
    let mut random = Random(7);
    let keys: Vec<u32> = (0..n).map(|_| (random.next() >> 32) as u32).collect();
    let buffers = sort.buffers(gpu, "bench.sort", n as u32)?;
    gpu.upload(&buffers.keys[0], &keys);
    let extent = Extent::known(gpu, "bench.extent", n as u32, &sort.blocks)?;
    // Four digits end where they began: every repeat after the first sorts sorted keys, which costs
    // the same, since no pass branches on a key.
    finish(gpu, &sort.plan(gpu, &buffers, &extent, u32::BITS).recording)
}

fn finish(gpu: &Gpu, recording: &Recording) -> Result<Bench, GpuError> {
    let samples = gpu.bench(recording)?;
    Ok(Bench { samples, passes: gpu.profile(recording)?, calibration_s: gpu.calibrate()? })
}

/// The random Gaussians of the benchmark, along a Morton curve.
fn random_scene(n: usize, seed: u64) -> Gaussians {
    let mut random = Random(seed);
    let size = (1.2 / (n as f32).cbrt()).ln();
    let mut scene = Gaussians { sh_degree: 3, ..Gaussians::default() };
    for _ in 0..n {
        scene.mean.push(Vec3::new(random.unit(), random.unit(), random.unit()) * 2.0 - 1.0);
        scene.rotation.push([random.normal(), random.normal(), random.normal(), random.normal()]);
        scene.scale.push(Vec3::new(random.normal(), random.normal(), random.normal()).map(|v| (0.5 * v + size).exp()));
        scene.opacity.push(1.0 / (1.0 + (-1.5 * random.normal()).exp()));
        scene.sh.extend((0..48).map(|f| 0.2 * random.normal() + if f < 3 { 0.5 } else { 0.0 }));
    }
    scene.subset(&morton_order(&scene.mean))
}

/// SplitMix64 (Steele et al. 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In 0..1.
    fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Standard normal (Box and Muller 1958).
    fn normal(&mut self) -> f32 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f32::consts::TAU * self.unit()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn benchmarks_run_and_name_their_passes() {
        let gpu = Gpu::shared_for_tests().unwrap();
        let bench = bench_render(&gpu, 500, [64, 48]).unwrap();
        assert!(bench.samples.median() > 0.0 && bench.calibration_s > 0.0);
        for label in ["render.project", "gpu.sort_scatter", "render.emit", "render.raster"] {
            assert!(bench.passes.iter().any(|p| p.label == label), "{label}");
        }
        assert!(bench_sort(&gpu, 1000).unwrap().samples.min() > 0.0);
    }

    #[test]
    fn the_scene_has_the_peers_distribution() {
        let scene = random_scene(20_000, 1);
        let mean = |values: &mut dyn Iterator<Item = f32>| values.map(f64::from).sum::<f64>() / 20_000.0;
        assert!((mean(&mut scene.scale.iter().map(|s| s.x.ln())) - f64::from((1.2 / 20_000f32.cbrt()).ln())).abs() < 0.02);
        assert!((mean(&mut scene.opacity.iter().copied()) - 0.5).abs() < 0.01);
        assert!(mean(&mut scene.mean.iter().map(|m| m.y)).abs() < 0.02);
    }
}
