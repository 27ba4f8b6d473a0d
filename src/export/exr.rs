//! OpenEXR: linear light, alpha and depth as 32-bit floats.

use super::raster::{check, srgb_to_linear};
use super::{ExportError, write_atomic};
use ::exr::prelude::*;
use std::io::{self, Cursor, Write};
use std::path::Path;

/// Writes a picture without its background, for compositing.
///
/// `colour` is what the renderer accumulated: display-referred (sRGB) colour C times coverage, and
/// alpha. Written are RGB = alpha * lin(C / alpha), A = alpha, and Z, the expected depth, +inf where
/// nothing is. The same picture gives the same bytes.
pub fn write_exr(path: &Path, size: [u32; 2], colour: &[[f32; 4]], depth: Option<&[f32]>) -> std::result::Result<(), ExportError> {
    check(size, 1, colour.len())?;
    if let Some(depth) = depth {
        check(size, 1, depth.len())?;
    }
    let linear: Vec<[f32; 4]> = colour.iter().map(|&c| scene_linear(c)).collect();
    let plane = |name: &str, values: Vec<f32>| AnyChannel::new(name, FlatSamples::F32(values));
    let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = SmallVec::new();
    for (k, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
        channels.push(plane(name, linear.iter().map(|c| c[k]).collect()));
    }
    channels.extend(depth.map(|depth| plane("Z", depth.to_vec())));
    let encoding = Encoding { compression: Compression::ZIP16, ..Encoding::default() };
    let layer = Layer::new((size[0] as usize, size[1] as usize), LayerAttributes::default(), encoding, AnyChannels::sort(channels));
    // The writer seeks, and the file is small: it is made in memory and lands whole.
    let mut bytes = Cursor::new(Vec::new());
    let encoded = Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).map_err(io::Error::other);
    write_atomic(path, |file| encoded.and_then(|()| file.write_all(bytes.get_ref())))
}

/// One pixel in linear light, still premultiplied.
fn scene_linear([r, g, b, alpha]: [f32; 4]) -> [f32; 4] {
    if alpha <= 0.0 {
        return [0.0; 4];
    }
    let [r, g, b] = [r, g, b].map(|v| alpha * srgb_to_linear(v / alpha));
    [r, g, b, alpha]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_linear_light_alpha_and_depth_exactly() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("still.exr");
        let colour = [[0.0; 4], [0.25, 0.5, 0.1, 0.5], [1.0, 1.0, 1.0, 1.0], [0.02, 0.0, 0.6, 0.75]];
        let depth = [f32::INFINITY, 1.5, 2.25, 1e-3];
        write_exr(&path, [2, 2], &colour, Some(&depth)).unwrap();
        let image = read_first_flat_layer_from_file(&path).unwrap();
        let names: Vec<String> = image.layer_data.channel_data.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["A", "B", "G", "R", "Z"]);
        let plane = |k: usize| image.layer_data.channel_data.list[k].sample_data.values_as_f32().collect::<Vec<f32>>();
        assert_eq!(plane(0), [0.0, 0.5, 1.0, 0.75]);
        assert_eq!(plane(4), depth);
        // C / alpha = 0.5, whose linear light is 0.21404114, times 0.5.
        assert!((plane(3)[1] - 0.107_020_57).abs() < 1e-7);
        assert_eq!((plane(2)[1], plane(3)[2], plane(1)[0]), (0.5, 1.0, 0.0));
    }

    #[test]
    fn the_same_picture_gives_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let colour: Vec<[f32; 4]> = (0..64 * 64).map(|i| [i as f32 / 5000.0, 0.1, 0.2, 0.9]).collect();
        let bytes = ["a.exr", "b.exr"].map(|name| {
            let path = folder.path().join(name);
            write_exr(&path, [64, 64], &colour, None).unwrap();
            std::fs::read(path).unwrap()
        });
        assert_eq!(bytes[0], bytes[1]);
        assert!(write_exr(&folder.path().join("c.exr"), [64, 64], &colour, Some(&[1.0])).is_err());
    }
}
