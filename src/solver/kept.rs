//! State beside the particles: kept at the start of a segment, restored by a rollback, and part of
//! checkpoints.

use crate::gpu::{Gpu, GpuError, Recording};
use bytemuck::Pod;

/// A buffer that a segment changes and a rollback restores.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    /// What the passes use.
    pub live: wgpu::Buffer,
    backup: wgpu::Buffer,
    bytes: u64,
}

impl Kept {
    /// Filled with `values`.
    pub fn new<T: Pod>(gpu: &Gpu, label: &str, values: &[T]) -> Result<Kept, GpuError> {
        let live = gpu.storage_from(label, values)?;
        let backup = gpu.storage::<T>(&format!("{label}.backup"), values.len())?;
        Ok(Kept { live, backup, bytes: size_of_val(values) as u64 })
    }

    /// Its size.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Adds the copy that keeps the present content.
    pub fn keep(&self, recording: &mut Recording) {
        recording.copy(&self.live, &self.backup, self.bytes);
    }

    /// Adds the copy that goes back to what was kept.
    pub fn restore(&self, recording: &mut Recording) {
        recording.copy(&self.backup, &self.live, self.bytes);
    }

    /// Content from a checkpoint, of [`Kept::bytes`] bytes.
    pub fn write(&self, gpu: &Gpu, content: &[u8]) {
        gpu.upload(&self.live, content);
    }
}
