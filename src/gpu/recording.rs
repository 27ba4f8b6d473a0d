//! Passes as data: what runs, in which order, on what.

use super::{Gpu, GpuError, Kernel};
use bytemuck::Pod;

/// One step of a recording.
#[derive(Clone, Debug)]
pub enum Step {
    /// A pass over a known number of workgroups.
    Dispatch {
        /// The compiled pass.
        kernel: Kernel,
        /// Its buffers.
        bindings: wgpu::BindGroup,
        /// Its `var<immediate>`, empty where it has none.
        immediates: Vec<u8>,
        /// Workgroups in x, y and z.
        groups: [u32; 3],
    },
    /// A pass whose number of workgroups a kernel wrote: three u32 at `offset` bytes.
    Indirect {
        /// The compiled pass.
        kernel: Kernel,
        /// Its buffers.
        bindings: wgpu::BindGroup,
        /// Its `var<immediate>`, empty where it has none.
        immediates: Vec<u8>,
        /// Where the three counts are.
        counts: wgpu::Buffer,
        /// In bytes.
        offset: u64,
    },
    /// Zeroes a whole buffer.
    Clear(wgpu::Buffer),
    /// Copies the first `bytes` bytes.
    Copy {
        /// Read from.
        from: wgpu::Buffer,
        /// Written to.
        to: wgpu::Buffer,
        /// How many.
        bytes: u64,
    },
}

/// A list of steps that can be inspected, submitted any number of times, and timed.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// In the order they run.
    pub steps: Vec<Step>,
}

/// What one label of a recording cost.
#[derive(Clone, Debug)]
pub struct PassTime {
    /// The kernel's label.
    pub label: &'static str,
    /// Seconds on the device, all steps of that label together.
    pub seconds: f64,
    /// How many steps had it.
    pub count: usize,
}

impl Recording {
    /// Adds a pass.
    pub fn dispatch(&mut self, kernel: &Kernel, bindings: &wgpu::BindGroup, groups: [u32; 3]) {
        self.push(kernel, bindings, Vec::new(), groups);
    }

    /// Adds a pass with immediate data.
    pub fn dispatch_with<T: Pod>(&mut self, kernel: &Kernel, bindings: &wgpu::BindGroup, immediates: &T, groups: [u32; 3]) {
        self.push(kernel, bindings, bytemuck::bytes_of(immediates).to_vec(), groups);
    }

    /// Adds a pass whose workgroup counts lie in a buffer.
    pub fn indirect(&mut self, kernel: &Kernel, bindings: &wgpu::BindGroup, counts: &wgpu::Buffer, offset: u64) {
        self.steps.push(Step::Indirect {
            kernel: kernel.clone(),
            bindings: bindings.clone(),
            immediates: Vec::new(),
            counts: counts.clone(),
            offset,
        });
    }

    /// As [`Recording::indirect`], with immediate data.
    pub fn indirect_with<T: Pod>(&mut self, kernel: &Kernel, bindings: &wgpu::BindGroup, immediates: &T, counts: &wgpu::Buffer, offset: u64) {
        self.steps.push(Step::Indirect {
            kernel: kernel.clone(),
            bindings: bindings.clone(),
            immediates: bytemuck::bytes_of(immediates).to_vec(),
            counts: counts.clone(),
            offset,
        });
    }

    /// Zeroes a buffer.
    pub fn clear(&mut self, buffer: &wgpu::Buffer) {
        self.steps.push(Step::Clear(buffer.clone()));
    }

    /// Copies the first `bytes` bytes of one buffer to another.
    pub fn copy(&mut self, from: &wgpu::Buffer, to: &wgpu::Buffer, bytes: u64) {
        self.steps.push(Step::Copy { from: from.clone(), to: to.clone(), bytes });
    }

    /// Appends another recording.
    pub fn extend(&mut self, other: &Recording) {
        self.steps.extend(other.steps.iter().cloned());
    }

    fn push(&mut self, kernel: &Kernel, bindings: &wgpu::BindGroup, immediates: Vec<u8>, groups: [u32; 3]) {
        self.steps.push(Step::Dispatch { kernel: kernel.clone(), bindings: bindings.clone(), immediates, groups });
    }
}

impl Gpu {
    /// Submits a recording without waiting for it.
    pub fn submit(&self, recording: &Recording) -> wgpu::SubmissionIndex {
        self.queue.submit([self.encode(recording)])
    }

    /// A recording made ready, so that submitting it takes no time.
    pub fn encode(&self, recording: &Recording) -> wgpu::CommandBuffer {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("recording") });
        encode(&recording.steps, &mut encoder);
        encoder.finish()
    }

    /// Runs each step in a pass of its own between two timestamps. Slower than [`Gpu::submit`]:
    /// the sum is for shares, whole recordings are timed by [`Gpu::time`].
    pub fn profile(&self, recording: &Recording) -> Result<Vec<PassTime>, GpuError> {
        let mut totals: Vec<PassTime> = Vec::new();
        for step in &recording.steps {
            let label = match step {
                Step::Dispatch { kernel, .. } | Step::Indirect { kernel, .. } => kernel.label,
                Step::Clear(_) => "clear",
                Step::Copy { .. } => "copy",
            };
            let seconds = self.time(&Recording { steps: vec![step.clone()] })?;
            match totals.iter_mut().find(|t| t.label == label) {
                Some(total) => {
                    total.seconds += seconds;
                    total.count += 1;
                }
                None => totals.push(PassTime { label, seconds, count: 1 }),
            }
        }
        Ok(totals)
    }

    /// Device seconds of one whole recording, by timestamps where the adapter has them, else by the
    /// wall clock around a wait.
    pub fn time(&self, recording: &Recording) -> Result<f64, GpuError> {
        if !self.can_time {
            self.wait()?;
            let start = std::time::Instant::now();
            self.submit(recording);
            self.wait()?;
            return Ok(start.elapsed().as_secs_f64());
        }
        let queries = self.device.create_query_set(&wgpu::QuerySetDescriptor { label: Some("time"), ty: wgpu::QueryType::Timestamp, count: 2 });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = self.device.create_buffer(&wgpu::BufferDescriptor { label: Some("time"), size: 16, usage, mapped_at_creation: false });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("timed") });
        encoder.write_timestamp(&queries, 0);
        encode(&recording.steps, &mut encoder);
        encoder.write_timestamp(&queries, 1);
        encoder.resolve_query_set(&queries, 0..2, &resolved, 0);
        self.queue.submit([encoder.finish()]);
        let ticks: Vec<u64> = self.read(&resolved, 2)?;
        Ok(ticks[1].wrapping_sub(ticks[0]) as f64 * f64::from(self.queue.get_timestamp_period()) * 1e-9)
    }
}

/// Consecutive passes share one compute pass: opening one costs more than most dispatches.
fn encode(steps: &[Step], encoder: &mut wgpu::CommandEncoder) {
    let mut rest = steps;
    while let Some(first) = rest.first() {
        match first {
            Step::Clear(buffer) => {
                encoder.clear_buffer(buffer, 0, None);
                rest = &rest[1..];
            }
            Step::Copy { from, to, bytes } => {
                encoder.copy_buffer_to_buffer(from, 0, to, 0, *bytes);
                rest = &rest[1..];
            }
            Step::Dispatch { .. } | Step::Indirect { .. } => {
                let passes = rest.iter().take_while(|s| matches!(s, Step::Dispatch { .. } | Step::Indirect { .. })).count();
                encode_passes(&rest[..passes], encoder);
                rest = &rest[passes..];
            }
        }
    }
}

fn encode_passes(steps: &[Step], encoder: &mut wgpu::CommandEncoder) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes: None });
    for step in steps {
        match step {
            Step::Dispatch { kernel, bindings, immediates, groups } => {
                pass.set_pipeline(&kernel.pipeline);
                pass.set_bind_group(0, bindings, &[]);
                if !immediates.is_empty() {
                    pass.set_immediates(0, immediates);
                }
                pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
            }
            Step::Indirect { kernel, bindings, immediates, counts, offset } => {
                pass.set_pipeline(&kernel.pipeline);
                pass.set_bind_group(0, bindings, &[]);
                if !immediates.is_empty() {
                    pass.set_immediates(0, immediates);
                }
                pass.dispatch_workgroups_indirect(counts, *offset);
            }
            Step::Clear(_) | Step::Copy { .. } => {}
        }
    }
}
