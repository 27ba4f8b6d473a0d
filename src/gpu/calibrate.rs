//! A yardstick beside every benchmark: how long this device takes for a fixed amount of arithmetic.
//! Cards that idle run at a third of their clock, so figures are compared only where this one agrees.

use super::{Access, Constant, Gpu, GpuError, KernelSource, Recording, Tier};

/// Threads, each with four lanes of the logistic map.
const THREADS: u32 = 1 << 16;
/// Steps of the map.
const STEPS: u32 = 1 << 10;
/// Samples, of which the median counts.
const SAMPLES: usize = 15;

/// Sorted samples of a benchmark, seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Ascending.
    pub seconds: Vec<f64>,
}

impl Samples {
    /// The middle one.
    pub fn median(&self) -> f64 {
        self.seconds.get(self.seconds.len() / 2).copied().unwrap_or(f64::NAN)
    }

    /// The fastest.
    pub fn min(&self) -> f64 {
        self.seconds.first().copied().unwrap_or(f64::NAN)
    }

    /// The slowest.
    pub fn max(&self) -> f64 {
        self.seconds.last().copied().unwrap_or(f64::NAN)
    }
}

impl Gpu {
    /// Times a recording over and over while the queue stays full: several in one submission, each
    /// sample behind a busy device, after as many again that nobody times.
    pub fn bench(&self, recording: &Recording) -> Result<Samples, GpuError> {
        let once = self.time(recording)?.max(1e-6);
        let (busy_s, samples) = match self.tier {
            Tier::Gpu => (0.02, SAMPLES),
            Tier::Cpu => (0.2, 7),
        };
        let repeats = (busy_s / once).ceil().clamp(1.0, 200.0) as usize;
        let mut many = Recording::default();
        (0..repeats).for_each(|_| many.extend(recording));
        self.time(&many)?;
        let mut seconds = Vec::with_capacity(samples);
        for _ in 0..samples {
            if self.tier == Tier::Gpu {
                self.submit(&many);
            }
            seconds.push(self.time(&many)? / repeats as f64);
        }
        seconds.sort_by(f64::total_cmp);
        Ok(Samples { seconds })
    }

    /// Seconds of the fixed kernel.
    pub fn calibrate(&self) -> Result<f64, GpuError> {
        let kernel = self.kernel(&source());
        let sums = self.storage::<f32>("gpu.calibrate", THREADS as usize)?;
        let bindings = self.bind(&kernel, &[&sums]);
        let mut recording = Recording::default();
        recording.dispatch(&kernel, &bindings, [THREADS / 256, 1, 1]);
        Ok(self.bench(&recording)?.median())
    }
}

pub(super) fn source() -> KernelSource {
    KernelSource {
        label: "gpu.calibrate",
        entry: "main",
        parts: vec![("gpu/calibrate.wgsl", include_str!("../../shaders/gpu/calibrate.wgsl"))],
        constants: vec![("STEPS", Constant::U32(STEPS))],
        bindings: vec![Access::Write],
        immediate_bytes: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_yardstick_runs_and_samples_ascend() {
        let gpu = Gpu::shared_for_tests().unwrap();
        assert!(gpu.calibrate().unwrap() > 0.0);
        let samples = Samples { seconds: vec![1.0, 2.0, 4.0] };
        assert_eq!((samples.min(), samples.median(), samples.max()), (1.0, 2.0, 4.0));
    }
}
