//! PNG: 8 bits, sRGB.

use super::raster::check;
use super::{ExportError, Raster, write_atomic};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::io::Write;
use std::path::Path;

/// An opaque picture of four bytes a pixel as a PNG with three: fast compression, since frames are
/// encoded as they are drawn.
pub fn encode_png(size: [u32; 2], rgba8: &[u8]) -> Result<Vec<u8>, ExportError> {
    check(size, 4, rgba8.len())?;
    let mut rgb = vec![0; rgba8.len() / 4 * 3];
    for (to, from) in rgb.as_chunks_mut::<3>().0.iter_mut().zip(rgba8.as_chunks::<4>().0) {
        *to = [from[0], from[1], from[2]];
    }
    let mut png = Vec::with_capacity(rgb.len() / 4);
    let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Fast, FilterType::Adaptive);
    encoder.write_image(&rgb, size[0], size[1], ExtendedColorType::Rgb8).map_err(|e| ExportError::Encode { what: "a PNG", reason: e.to_string() })?;
    Ok(png)
}

/// Decodes a PNG of any kind as 8-bit RGBA.
pub fn decode_png(png: &[u8]) -> Result<Raster, ExportError> {
    let failed = |e: image::ImageError| ExportError::Encode { what: "a PNG", reason: e.to_string() };
    let picture = image::load_from_memory_with_format(png, image::ImageFormat::Png).map_err(failed)?.into_rgba8();
    Ok(Raster { size: [picture.width(), picture.height()], rgba8: picture.into_raw() })
}

/// Writes an opaque picture of four bytes a pixel.
pub fn write_png(path: &Path, size: [u32; 2], rgba8: &[u8]) -> Result<(), ExportError> {
    let png = encode_png(size, rgba8)?;
    write_atomic(path, |file| file.write_all(&png))
}

/// Reads a PNG of any kind as 8-bit RGBA.
pub fn read_png(path: &Path) -> Result<Raster, ExportError> {
    let failed = |reason: String| ExportError::Read { path: path.to_owned(), reason };
    let bytes = std::fs::read(path).map_err(|e| failed(e.to_string()))?;
    decode_png(&bytes).map_err(|e| failed(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again_and_the_bytes_are_the_same_twice() {
        let folder = tempfile::tempdir().unwrap();
        let picture = Raster { size: [5, 3], rgba8: (0..15).flat_map(|i: u8| [i * 17, 255 - i, i ^ 90, 255]).collect() };
        let [a, b] = ["a.png", "deep/b.png"].map(|name| folder.path().join(name));
        write_png(&a, picture.size, &picture.rgba8).unwrap();
        write_png(&b, picture.size, &picture.rgba8).unwrap();
        assert_eq!(read_png(&a).unwrap(), picture);
        assert_eq!(std::fs::read(&a).unwrap(), std::fs::read(&b).unwrap());
    }

    #[test]
    fn what_is_no_picture_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("notes.png");
        std::fs::write(&path, b"not a picture").unwrap();
        assert!(read_png(&path).unwrap_err().to_string().contains("notes.png"));
        assert!(read_png(&folder.path().join("none.png")).is_err());
        assert!(write_png(&path, [4, 4], &[0; 12]).unwrap_err().to_string().contains("64"));
    }
}
