//! The readers of scenes: .ply and .splat.

use crate::target::{Target, class};
use glam::Vec3;
use phystalk::scene::{Gaussians, parse, write};

/// .ply files.
pub struct Ply;
/// .splat files, and what else has no magic number.
pub struct Splat;

/// Bytes of memory for a byte of a scene. A row of 14 one-byte properties becomes 56 bytes, of which the reader makes sure that
/// four copies fit, and has one beside them.
const MEMORY: usize = 32;
/// Beside that: messages, samples, the pool's own.
const MEMORY_BASE: usize = 1 << 20;

fn gaussians(count: usize, sh_degree: u32) -> Gaussians {
    let at = |i: usize| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) * 0.1;
    Gaussians {
        mean: (0..count).map(at).collect(),
        scale: vec![Vec3::new(0.05, 0.04, 0.01); count],
        rotation: vec![[0.9, 0.1, 0.2, -0.3]; count],
        opacity: vec![0.9; count],
        sh_degree,
        sh: (0..count * 3 * (sh_degree as usize + 1).pow(2)).map(|i| (i % 7) as f32 * 0.1).collect(),
    }
}

/// A scene as a file of a format.
fn file(gaussians: &Gaussians, name: &str) -> Vec<u8> {
    let path = std::env::temp_dir().join(format!("phystalk-fuzz-{}-{name}", std::process::id()));
    let bytes = write(&path, gaussians).ok().and_then(|_| std::fs::read(&path).ok());
    let _ = std::fs::remove_file(path);
    bytes.unwrap_or_default()
}

fn read(input: &[u8], name: &str) -> Result<String, String> {
    let loaded = match parse(input, name) {
        Ok(loaded) => loaded,
        Err(error) => return Ok(class(&error.to_string())),
    };
    let g = &loaded.gaussians;
    let sizes = [g.mean.len(), g.scale.len(), g.rotation.len(), g.opacity.len(), g.sh.len() / (3 * g.sh_coefficients()), loaded.place.len()];
    let numbers = g.mean.iter().chain(&g.scale).all(|v| v.is_finite()) && g.sh.iter().chain(&g.opacity).all(|x| x.is_finite());
    if g.is_empty() || sizes.iter().any(|&size| size != g.len()) || !numbers || g.scale.iter().any(|s| s.min_element() < 0.0) {
        return Err(format!("a scene that keeps no promise: sizes {sizes:?}, all numbers finite: {numbers}"));
    }
    let info = phystalk::scene::info(&loaded);
    Ok(format!("{:?} {} {} {}", loaded.format, g.sh_degree, loaded.warnings.len(), class(&info.up_guess.why)))
}

impl Target for Ply {
    fn name(&self) -> &'static str {
        "ply"
    }

    fn seeds(&self) -> Vec<Vec<u8>> {
        let small = "ply\nformat binary_little_endian 1.0\ncomment up: z\nelement vertex 1\n";
        let names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"];
        let properties: String = names.iter().map(|name| format!("property uchar {name}\n")).collect();
        let bytes = [small.as_bytes(), properties.as_bytes(), b"end_header\n", &[1; 14]].concat();
        let listed = b"ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 1\nend_header\n";
        vec![file(&gaussians(9, 0), "a.ply"), file(&gaussians(3, 3), "b.ply"), file(&gaussians(4, 1), "c.ply"), bytes, listed.to_vec()]
    }

    fn dictionary(&self) -> Vec<&'static [u8]> {
        vec![
            b"ply\n",
            b"format binary_little_endian 1.0\n",
            b"format ascii 1.0\n",
            b"element vertex 18446744073709551615\n",
            b"element vertex 2\n",
            b"element face 4294967295\n",
            b"property list uchar int x\n",
            b"property float x\n",
            b"property double y\n",
            b"property char f_rest_0\n",
            b"property float sigma_0\n",
            b"property float packed_position\n",
            b"comment up: y\n",
            b"end_header\n",
            b"\r\n",
        ]
    }

    fn memory(&self, input_bytes: usize) -> usize {
        MEMORY_BASE + MEMORY * input_bytes
    }

    fn run(&self, input: &[u8]) -> Result<String, String> {
        read(input, "a.ply")
    }
}

impl Target for Splat {
    fn name(&self) -> &'static str {
        "splat"
    }

    fn seeds(&self) -> Vec<Vec<u8>> {
        vec![
            file(&gaussians(9, 0), "a.splat"),
            file(&gaussians(40, 0), "b.splat"),
            vec![0; 640],
            vec![0x3f; 640],
            b"PK\x03\x04".to_vec(),
            b"{}".to_vec(),
        ]
    }

    fn dictionary(&self) -> Vec<&'static [u8]> {
        vec![b"ply\n", b"\x1f\x8b", b"NGSP", b"PK\x03\x04", b"glTF", b"\x89PNG", b"RIFF", &[0; 32], &[0xff; 32], b"\0\x01\0\0"]
    }

    fn memory(&self, input_bytes: usize) -> usize {
        MEMORY_BASE + MEMORY * input_bytes
    }

    /// Twice: under a name that says so, where less evidence will do, and under none.
    fn run(&self, input: &[u8]) -> Result<String, String> {
        Ok(format!("{} / {}", read(input, "a.splat")?, read(input, "a")?))
    }
}
