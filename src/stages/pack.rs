//! Arrays to bytes and back, for what the store keeps.

use crate::store::{Entry, EntryWriter, Store, StoreError};
use bytemuck::Pod;

/// An entry of the store. A damaged one, which the store has taken away by then, counts as absent.
pub(super) fn find(store: &Store, stage: &str, key: &str) -> Result<Option<Entry>, StoreError> {
    match store.get(stage, key) {
        Err(damage @ (StoreError::Damaged { .. } | StoreError::Spoilt { .. })) => {
            tracing::warn!("{damage}; it is made anew");
            Ok(None)
        }
        other => other,
    }
}

/// Writes one array as a blob.
pub(super) fn write<T: Pod>(entry: &EntryWriter, name: &str, values: &[T]) -> Result<(), StoreError> {
    entry.put(name, bytemuck::cast_slice(values))
}

/// Whether a blob is what was written, read from start to end without keeping any of it.
pub(super) fn is_sound(entry: &Entry, name: &str) -> Result<bool, StoreError> {
    let read = std::io::copy(&mut entry.open(name)?, &mut std::io::sink());
    if let Err(error) = &read {
        tracing::warn!("{name} is damaged ({error}) and is made anew");
    }
    Ok(read.is_ok())
}

/// Reads one array back; a damaged blob or one of a wrong length reads as `None`, which callers treat as a miss.
pub(super) fn read<T: Pod>(entry: &Entry, name: &str) -> Result<Option<Vec<T>>, StoreError> {
    let bytes = match entry.read(name) {
        Err(damage @ (StoreError::Damaged { .. } | StoreError::Spoilt { .. })) => {
            tracing::warn!("{damage}; it is made anew");
            return Ok(None);
        }
        other => other?,
    };
    if bytes.len() % size_of::<T>() != 0 {
        return Ok(None);
    }
    let mut values = vec![T::zeroed(); bytes.len() / size_of::<T>()];
    bytemuck::cast_slice_mut::<T, u8>(&mut values).copy_from_slice(&bytes);
    Ok(Some(values))
}
