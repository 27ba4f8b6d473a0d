//! Storage buffers, uploads and read-backs.

use super::{Gpu, GpuError};
use bytemuck::Pod;

/// Everything a storage buffer of ours may be used for.
const STORAGE: wgpu::BufferUsages =
    wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_SRC).union(wgpu::BufferUsages::COPY_DST).union(wgpu::BufferUsages::INDIRECT);

impl Gpu {
    /// A zeroed storage buffer of `count` values of `T` (at least 16 bytes, so that it can always be bound).
    pub fn storage<T: Pod>(&self, label: &str, count: usize) -> Result<wgpu::Buffer, GpuError> {
        self.storage_bytes(label, (count * size_of::<T>()) as u64)
    }

    /// A zeroed storage buffer of `bytes` bytes.
    pub fn storage_bytes(&self, label: &str, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        let limits = self.device.limits();
        let allowed_bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if bytes > allowed_bytes {
            return Err(GpuError::TooLarge { what: label.to_owned(), needed_bytes: bytes, allowed_bytes, device: self.info.name.clone() });
        }
        let size = bytes.max(16).next_multiple_of(16);
        Ok(self.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage: STORAGE, mapped_at_creation: false }))
    }

    /// A storage buffer that holds `values`.
    pub fn storage_from<T: Pod>(&self, label: &str, values: &[T]) -> Result<wgpu::Buffer, GpuError> {
        let buffer = self.storage::<T>(label, values.len())?;
        self.upload(&buffer, values);
        Ok(buffer)
    }

    /// Overwrites the start of a buffer, in order with what was submitted before.
    pub fn upload<T: Pod>(&self, buffer: &wgpu::Buffer, values: &[T]) {
        if !values.is_empty() {
            self.queue.write_buffer(buffer, 0, bytemuck::cast_slice(values));
        }
    }

    /// Reads `count` values from the start of a buffer, waiting for all work submitted before.
    pub fn read<T: Pod>(&self, buffer: &wgpu::Buffer, count: usize) -> Result<Vec<T>, GpuError> {
        Readback::start(self, &[(buffer, (count * size_of::<T>()) as u64)]).wait(self).map(|mut parts| parts.remove(0)).map(|bytes| {
            let mut values = vec![T::zeroed(); count];
            let target: &mut [u8] = bytemuck::cast_slice_mut(&mut values);
            let length = target.len();
            target.copy_from_slice(&bytes[..length]);
            values
        })
    }

    /// Waits until everything submitted so far is done.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map(|_| ()).map_err(|e| self.lost(e))
    }
}

/// Bytes on their way back from the device. Started early, waited for late, so that the queue stays full.
#[derive(Debug)]
pub struct Readback {
    staging: Vec<(wgpu::Buffer, u64)>,
    submission: wgpu::SubmissionIndex,
}

impl Readback {
    /// Copies the first bytes of each buffer aside, in order with what was submitted before.
    pub fn start(gpu: &Gpu, sources: &[(&wgpu::Buffer, u64)]) -> Readback {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") });
        let staging: Vec<_> = sources
            .iter()
            .map(|(source, bytes)| {
                let size = bytes.next_multiple_of(4).max(4);
                let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
                let target = gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some("read back"), size, usage, mapped_at_creation: false });
                encoder.copy_buffer_to_buffer(source, 0, &target, 0, size);
                (target, *bytes)
            })
            .collect();
        let submission = gpu.queue.submit([encoder.finish()]);
        for (buffer, _) in &staging {
            // An error here means a lost device, which `wait` reports when it maps the range.
            buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        }
        Readback { staging, submission }
    }

    /// The bytes of each source, in the order they were given.
    pub fn wait(self, gpu: &Gpu) -> Result<Vec<Vec<u8>>, GpuError> {
        let poll = wgpu::PollType::Wait { submission_index: Some(self.submission), timeout: None };
        gpu.device.poll(poll).map_err(|e| gpu.lost(e))?;
        self.staging
            .iter()
            .map(|(buffer, bytes)| {
                let view = buffer.get_mapped_range(..).map_err(|e| gpu.lost(e))?;
                Ok(view[..*bytes as usize].to_vec())
            })
            .collect()
    }
}
