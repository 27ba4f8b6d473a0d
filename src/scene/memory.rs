//! Memory whose amount a file decides: it is asked for before it is used, so that a file too large is an error and no abort.

use super::SceneError;
use std::hint::black_box;

/// Copies of the Gaussians that opening a scene needs at once: as decoded, in the world's frame, in Morton order, and what up
/// axis and floaters are found with.
const COPIES: u64 = 4;

/// Bytes of one Gaussian: centre, scale, rotation, opacity, and colour of three channels for each coefficient.
fn gaussian_bytes(coefficients: u64) -> u64 {
    4 * (3 + 3 + 4 + 1 + 3 * coefficients)
}

/// A list of equal values.
pub(super) fn filled<T: Clone>(count: usize, value: T, file: &str) -> Result<Vec<T>, SceneError> {
    let mut list = reserved(count, file)?;
    list.resize(count, value);
    Ok(list)
}

/// An empty list with room.
pub(super) fn reserved<T>(count: usize, file: &str) -> Result<Vec<T>, SceneError> {
    let mut list = Vec::new();
    list.try_reserve_exact(count).map_err(|_| exhausted(count as u64 * size_of::<T>() as u64, file))?;
    Ok(list)
}

/// Asks the system for all that opening a file of so many Gaussians takes, and gives it back: what fails later, in code that
/// cannot tell which file it works for, fails here.
pub(super) fn probe(count: u64, coefficients: u64, file: &str) -> Result<(), SceneError> {
    let needed = COPIES.saturating_mul(count).saturating_mul(gaussian_bytes(coefficients));
    let room = usize::try_from(needed).map_err(|_| exhausted(needed, file)).and_then(|bytes| reserved::<u8>(bytes, file))?;
    // Else the compiler leaves out an allocation that nobody uses.
    drop(black_box(room));
    Ok(())
}

fn exhausted(needed: u64, file: &str) -> SceneError {
    SceneError::Memory { file: file.to_owned(), mib: needed.div_ceil(1 << 20) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_there_is_is_an_error_that_names_the_file_and_the_amount() {
        let error = probe(u64::MAX / 1_000_000, 16, "big.ply").unwrap_err();
        assert!(matches!(&error, SceneError::Memory { file, mib } if file == "big.ply" && *mib > 1 << 20), "{error}");
        assert!(filled(usize::MAX / 64, [0.0_f32; 4], "big.ply").is_err());
        assert_eq!(filled(3, 1_u8, "small.ply").unwrap(), [1, 1, 1]);
        assert!(probe(1000, 1, "small.ply").is_ok());
    }
}
