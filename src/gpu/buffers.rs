//! Storage buffers, uploads and read-backs.

use super::{Gpu, GpuError};
use bytemuck::Pod;
use std::sync::{Mutex, PoisonError};

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
        let arrived = Readback::start(self, &[(buffer, (count * size_of::<T>()) as u64)]).arrive(self)?;
        arrived.part(0, |bytes| {
            let mut values = vec![T::zeroed(); count];
            bytemuck::cast_slice_mut(&mut values).copy_from_slice(bytes);
            values
        })
    }

    /// Waits until everything submitted so far is done.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map(|_| ()).map_err(|e| self.lost(e))
    }
}

/// Bytes that free buffers for read-backs may hold together.
const STAGING_BYTES: u64 = 256 << 20;

/// Buffers that read-backs land in, used again: a new one each time would be mapped and cleared each time.
#[derive(Debug, Default)]
pub(super) struct Staging(Mutex<Vec<wgpu::Buffer>>);

impl Staging {
    /// A free buffer of this size, or a new one.
    fn take(&self, gpu: &Gpu, size: u64) -> wgpu::Buffer {
        let mut free = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(at) = free.iter().position(|buffer| buffer.size() == size) {
            return free.swap_remove(at);
        }
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some("read back"), size, usage, mapped_at_creation: false })
    }

    fn put(&self, buffer: wgpu::Buffer) {
        let mut free = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let held: u64 = free.iter().map(wgpu::Buffer::size).sum();
        if held + buffer.size() <= STAGING_BYTES {
            free.push(buffer);
        }
    }
}

/// Bytes on their way back from the device. Started early, waited for late, so that the queue stays full.
#[derive(Debug)]
pub struct Readback {
    parts: Vec<(wgpu::Buffer, u64)>,
    submission: wgpu::SubmissionIndex,
}

impl Readback {
    /// Copies the first bytes of each buffer aside, in order with what was submitted before.
    pub fn start(gpu: &Gpu, sources: &[(&wgpu::Buffer, u64)]) -> Readback {
        Readback::start_at(gpu, &sources.iter().map(|&(source, bytes)| (source, 0, bytes)).collect::<Vec<_>>())
    }

    /// The same from some byte of each on, a multiple of 4.
    pub fn start_at(gpu: &Gpu, sources: &[(&wgpu::Buffer, u64, u64)]) -> Readback {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") });
        let parts: Vec<_> = sources
            .iter()
            .map(|(source, from, bytes)| {
                let size = bytes.next_multiple_of(4).max(4);
                // Few sizes, so that most are found again.
                let target = gpu.staging.take(gpu, size.next_power_of_two().min(size.next_multiple_of(1 << 20)));
                encoder.copy_buffer_to_buffer(source, *from, &target, 0, size);
                (target, *bytes)
            })
            .collect();
        let submission = gpu.queue.submit([encoder.finish()]);
        for (buffer, _) in &parts {
            // An error here means a lost device or no memory, which shows when they are waited for.
            buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        }
        Readback { parts, submission }
    }

    /// Waits for the copies, which can then be read without a further one, on any thread.
    pub fn arrive(self, gpu: &Gpu) -> Result<Arrived, GpuError> {
        let poll = wgpu::PollType::Wait { submission_index: Some(self.submission), timeout: None };
        gpu.device.poll(poll).map_err(|e| gpu.lost(e))?;
        gpu.sound()?;
        Ok(Arrived { parts: self.parts, gpu: gpu.clone() })
    }

    /// The bytes of each source, in the order they were given.
    pub fn wait(self, gpu: &Gpu) -> Result<Vec<Vec<u8>>, GpuError> {
        let arrived = self.arrive(gpu)?;
        (0..arrived.parts.len()).map(|index| arrived.part(index, <[u8]>::to_vec)).collect()
    }
}

/// Bytes that are back, still in memory that the device wrote.
#[derive(Debug)]
pub struct Arrived {
    parts: Vec<(wgpu::Buffer, u64)>,
    gpu: Gpu,
}

impl Arrived {
    /// What `read` makes of the bytes of one source.
    pub fn part<R>(&self, index: usize, read: impl FnOnce(&[u8]) -> R) -> Result<R, GpuError> {
        let (buffer, bytes) = &self.parts[index];
        let view = buffer.get_mapped_range(..).map_err(|e| self.gpu.lost(e))?;
        Ok(read(&view[..*bytes as usize]))
    }
}

impl Drop for Arrived {
    fn drop(&mut self) {
        for (buffer, _) in self.parts.drain(..) {
            buffer.unmap();
            self.gpu.staging.put(buffer);
        }
    }
}
