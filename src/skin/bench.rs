//! How fast skinning is: whole frames, both passes, the queue kept full.

use super::{Skinner, Splats, bind, twin};
use crate::gpu::{Gpu, GpuError, Recording};
use crate::scene::{Gaussians, morton_order};
use crate::spec::{Skin, Weights};
use glam::{Mat3, Quat, Vec3};

/// Frames recorded together, so that what is timed is work and not submission.
const FRAMES: u32 = 20;

/// Timed recordings after those that bring the clock up.
const SAMPLES: usize = 21;

/// Seconds of one frame's skinning, one value a sample, ascending: a solid cube of `particles`, twisted,
/// moves `gaussians` Gaussians at random places in it with K = 8, all in Morton order.
pub fn bench_skin(gpu: &Gpu, gaussians: usize, particles: usize) -> Result<Vec<f64>, GpuError> {
    let rest = scattered(particles, 1);
    let centres = scattered(gaussians, 2);
    let scene = Gaussians {
        scale: vec![Vec3::new(0.002, 0.004, 0.003); gaussians],
        rotation: vec![[1.0, 0.0, 0.0, 0.0]; gaussians],
        opacity: vec![0.8; gaussians],
        sh_degree: 0,
        sh: vec![0.0; gaussians * 3],
        mean: centres,
    };
    let object = vec![0; gaussians];
    let bound = bind(&scene.mean, &object, &rest, &vec![0; particles], &Skin::default());
    let splats = Splats::new(gpu, &scene, Quat::IDENTITY, &object)?;
    let skinner = Skinner::new(gpu, &splats, &bound, &rest, Weights::Exact)?;
    let motion: Vec<[u32; 8]> = rest.iter().map(|&p| twisted(p)).collect();
    let motion = gpu.storage_from("bench.motion", &motion)?;

    let mut recording = Recording::default();
    (0..FRAMES).for_each(|_| skinner.record(&motion, &mut recording));
    gpu.time(&recording)?;
    let mut samples = Vec::with_capacity(SAMPLES);
    for _ in 0..SAMPLES {
        // A card that idles clocks down: the timed recording starts behind a busy one.
        gpu.submit(&recording);
        samples.push(gpu.time(&recording)? / f64::from(FRAMES));
    }
    samples.sort_by(f64::total_cmp);
    Ok(samples)
}

/// The motion of a particle where the cube is twisted about z by a radian a metre.
fn twisted(p: Vec3) -> [u32; 8] {
    let turn = Mat3::from_rotation_z(p.z);
    twin::pack_motion(turn * p, turn - Mat3::IDENTITY)
}

/// Points of the unit cube in Morton order, the same for the same seed.
fn scattered(count: usize, seed: u32) -> Vec<Vec3> {
    let points: Vec<Vec3> = (0..count as u32).map(|i| Vec3::new(hash(i, seed), hash(i, seed + 10), hash(i, seed + 20))).collect();
    morton_order(&points).into_iter().map(|i| points[i as usize]).collect()
}

/// A number of 0 to 1 from two, by a mixing function of xor, shift and multiply.
fn hash(i: u32, seed: u32) -> f32 {
    let mut h = i.wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
    for (shift, factor) in [(16, 0x7feb_352d), (15, 0x846c_a68b)] {
        h = (h ^ h >> shift).wrapping_mul(factor);
    }
    (h ^ h >> 16) as f32 / u32::MAX as f32
}
