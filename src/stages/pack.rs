//! Arrays to bytes and back, for what the store keeps.

use crate::store::{Entry, EntryWriter, StoreError};
use bytemuck::Pod;

/// Writes one array as a blob.
pub(super) fn write<T: Pod>(entry: &EntryWriter, name: &str, values: &[T]) -> Result<(), StoreError> {
    entry.put(name, bytemuck::cast_slice(values))
}

/// Reads one array back; a blob of a wrong length reads as `None`, which callers treat as a miss.
pub(super) fn read<T: Pod>(entry: &Entry, name: &str) -> Result<Option<Vec<T>>, StoreError> {
    let bytes = entry.read(name)?;
    if bytes.len() % size_of::<T>() != 0 {
        return Ok(None);
    }
    let mut values = vec![T::zeroed(); bytes.len() / size_of::<T>()];
    bytemuck::cast_slice_mut::<T, u8>(&mut values).copy_from_slice(&bytes);
    Ok(Some(values))
}
