//! Benchmarks of single rooms: each room brings its own, since it knows what it times.

use super::{Job, Timing};
use crate::cli::exit::{Failure, Kind};
use phystalk::{render, skin, solver};

/// Particles of `mpm` and `sph`.
const PARTICLES: [(usize, &str); 4] = [(8_000, "8k"), (20_000, "20k"), (100_000, "100k"), (1_000_000, "1M")];
/// Particles of `mpm` that are of many laws.
const MIXED: usize = 100_000;
/// Gaussians and particles of `skin`.
const SKINS: [(usize, usize, &str); 2] = [(100_000, 20_000, "100k/20k"), (1_000_000, 100_000, "1M/100k")];
/// Gaussians of `render`.
const GAUSSIANS: [(usize, &str); 3] = [(100_000, "100k"), (1_000_000, "1M"), (3_000_000, "3M")];
/// Pictures of `render`.
const SIZES: [[u32; 2]; 2] = [[512, 512], [1920, 1080]];
/// Pairs of `sort`.
const PAIRS: [(usize, &str); 2] = [(1_000_000, "1M"), (4_000_000, "4M")];

/// All of them, smallest first.
pub fn jobs() -> Vec<Job> {
    let mut jobs = Vec::new();
    for (particles, size) in PARTICLES {
        let run = move |gpu: &phystalk::gpu::Gpu| {
            let report = solver::bench_substep(gpu, particles).map_err(|e| Failure::new(Kind::Unstable, e))?;
            Ok(Timing { seconds: report.substep_seconds.to_vec(), passes: report.passes })
        };
        jobs.push(Job { name: "mpm", size: size.to_owned(), heavy: particles > 20_000, run: Box::new(run) });
    }
    let mixture = |gpu: &phystalk::gpu::Gpu| {
        let report = solver::bench_mixture(gpu, MIXED).map_err(|e| Failure::new(Kind::Unstable, e))?;
        Ok(Timing { seconds: report.substep_seconds.to_vec(), passes: report.passes })
    };
    jobs.push(Job { name: "mpm", size: "mixture".to_owned(), heavy: true, run: Box::new(mixture) });
    for (particles, size) in PARTICLES {
        let run = move |gpu: &phystalk::gpu::Gpu| {
            let report = solver::bench_sph(gpu, particles).map_err(|e| Failure::new(Kind::Unstable, e))?;
            Ok(Timing { seconds: report.substep_seconds.to_vec(), passes: report.passes })
        };
        jobs.push(Job { name: "sph", size: size.to_owned(), heavy: particles > 20_000, run: Box::new(run) });
        let second = move |gpu: &phystalk::gpu::Gpu| {
            Ok(Timing::of(vec![solver::bench_sph_second(gpu, particles).map_err(|e| Failure::new(Kind::Unstable, e))?]))
        };
        jobs.push(Job { name: "sph", size: format!("{size}, 1 s of it"), heavy: true, run: Box::new(second) });
    }
    for (gaussians, particles, size) in SKINS {
        let run = move |gpu: &phystalk::gpu::Gpu| Ok(Timing::of(skin::bench_skin(gpu, gaussians, particles)?));
        jobs.push(Job { name: "skin", size: size.to_owned(), heavy: gaussians > 100_000, run: Box::new(run) });
    }
    for (gaussians, count) in GAUSSIANS {
        for size in SIZES {
            let run = move |gpu: &phystalk::gpu::Gpu| {
                let bench = render::bench_render(gpu, gaussians, size)?;
                Ok(Timing { seconds: bench.samples.seconds, passes: bench.passes })
            };
            jobs.push(Job { name: "render", size: format!("{count} at {}x{}", size[0], size[1]), heavy: gaussians > 100_000, run: Box::new(run) });
        }
    }
    for (pairs, size) in PAIRS {
        let run = move |gpu: &phystalk::gpu::Gpu| {
            let bench = render::bench_sort(gpu, pairs)?;
            Ok(Timing { seconds: bench.samples.seconds, passes: bench.passes })
        };
        jobs.push(Job { name: "sort", size: size.to_owned(), heavy: pairs > 1_000_000, run: Box::new(run) });
    }
    jobs
}
