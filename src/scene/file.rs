//! From a file to Gaussians and back.

use super::error::{CONVERT, COPY_AGAIN};
use super::source::{Sample, Source};
use super::{Gaussians, SceneError, UpGuess, memory, ply, splat, up};
use crate::store::write_atomic;
use serde::Serialize;
use std::path::Path;

/// The formats that are read and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// INRIA's binary little-endian .ply.
    Ply,
    /// antimatter15's .splat.
    Splat,
}

/// What a file held.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// In the file's own frame and order.
    pub gaussians: Gaussians,
    /// Place of each in the file, from 0: those that are unusable are left out.
    pub place: Vec<u32>,
    /// By content, whatever the name says.
    pub format: Format,
    /// What was left out or repaired, one sentence each.
    pub warnings: Vec<String>,
    /// BLAKE3 of the file's bytes, hexadecimal.
    pub blake3: String,
    /// Up as the file itself states it.
    pub stated_up: Option<UpGuess>,
}

impl Loaded {
    /// Up as the file states it, else as its Gaussians suggest.
    pub fn up(&self) -> UpGuess {
        self.stated_up.clone().unwrap_or_else(|| up::guess_up(&self.gaussians))
    }
}

/// Reads a scene. The format is told by content, from a bounded part of the file: what is no scene is never read whole.
pub fn read(path: &Path) -> Result<Loaded, SceneError> {
    let mut source = Source::open(path)?;
    recognise(&source.sample()?, source.name())?;
    let name = source.name().to_owned();
    parse(&source.read()?, &name)
}

/// BLAKE3 of a scene's file, hexadecimal; an error where the file is no scene.
pub fn digest(path: &Path) -> Result<String, SceneError> {
    let mut source = Source::open(path)?;
    recognise(&source.sample()?, source.name())?;
    source.digest()
}

/// Reads a scene from a file's bytes; `name` is for messages.
pub fn parse(bytes: &[u8], name: &str) -> Result<Loaded, SceneError> {
    let format = recognise(&Sample::of(bytes), name)?;
    let (gaussians, comments) = match format {
        Format::Ply => ply::decode(bytes, name)?,
        Format::Splat => (splat::decode(bytes, name)?, Vec::new()),
    };
    if gaussians.is_empty() {
        return Err(SceneError::Empty { file: name.to_owned(), why: "it says so itself, its count is 0".to_owned() });
    }
    let (gaussians, place, warnings) = keep_usable(gaussians, name)?;
    Ok(Loaded { gaussians, place, format, warnings, blake3: blake3::hash(bytes).to_hex().to_string(), stated_up: up::stated(&comments) })
}

/// Tells the format by content; the extension only where content cannot say.
fn recognise(sample: &Sample, name: &str) -> Result<Format, SceneError> {
    let bytes = sample.front.as_slice();
    let unsupported = |found: &str| Err(SceneError::Unsupported { file: name.to_owned(), found: found.to_owned(), advice: CONVERT });
    let not_a_scene = |found: &str| Err(SceneError::NotAScene { file: name.to_owned(), found: found.to_owned() });
    match bytes {
        [] => return Err(SceneError::Empty { file: name.to_owned(), why: "the file has 0 bytes".to_owned() }),
        [b'p', b'l', b'y', b'\n' | b'\r', ..] => return Ok(Format::Ply),
        [0x1f, 0x8b, ..] => return unsupported("gzip data, as .spz is"),
        [b'N', b'G', b'S', b'P', ..] => return unsupported("a .spz of version 4"),
        [b'P', b'K', 3, 4, ..] => return unsupported("a zip archive, as .sog is"),
        [b'g', b'l', b'T', b'F', ..] => return unsupported("a binary glTF (.glb)"),
        [0x89, b'P', b'N', b'G', ..] | [b'R', b'I', b'F', b'F', ..] | [0xff, 0xd8, 0xff, ..] => return not_a_scene("it is a picture"),
        [0, 1, ..] if is_ksplat(bytes) => return unsupported("a .ksplat"),
        _ => {}
    }
    if let Some(text) = text(&bytes[..bytes.len().min(4096)]) {
        return match text.trim_start().starts_with('{') {
            true => unsupported("JSON, as the meta.json of a .sog or a .gltf is"),
            false => not_a_scene("it is text"),
        };
    }
    let named_splat = Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("splat"));
    let whole = sample.length.is_multiple_of(splat::RECORD as u64);
    if if named_splat { splat::is_credible(&sample.records) } else { whole && splat::is_evident(&sample.records) } {
        return Ok(Format::Splat);
    }
    if named_splat {
        return not_a_scene("most of its records are empty, or have negative or absurd scales or positions");
    }
    if name.to_ascii_lowercase().ends_with(".ply") {
        return Err(SceneError::Damaged {
            file: name.to_owned(),
            at: "byte 0".to_owned(),
            found: "no `ply` line".to_owned(),
            expected: "the header of a .ply".to_owned(),
            advice: COPY_AGAIN,
        });
    }
    not_a_scene("its first bytes are of no known format")
}

/// The front of a file as text, where it is UTF-8 in words or lines; its last character may be cut.
fn text(front: &[u8]) -> Option<&str> {
    let whole = match std::str::from_utf8(front) {
        Err(cut) if cut.error_len().is_none() => &front[..cut.valid_up_to()],
        _ => front,
    };
    let text = std::str::from_utf8(whole).ok()?;
    let written = text.bytes().all(|b| matches!(b, 9..=13 | 32..=126 | 128..));
    (written && text.contains([' ', '\n', '{'])).then_some(text)
}

/// mkkellogg's header: version 0.1 and a number of sections, padded with zeros to 4096 bytes, then one of 1024 for each section.
fn is_ksplat(bytes: &[u8]) -> bool {
    let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    bytes.len() >= 5120 && (1..=1 << 16).contains(&word(4)) && bytes[64..4096].iter().all(|&b| b == 0)
}

/// Beyond this a number of a Gaussian, in the file's units, is no measurement; squares stay finite below.
const ABSURD: f32 = 1e12;

/// Drops Gaussians with NaN, infinities or absurd numbers, and makes negative scales positive; says which are kept and how many were not.
fn keep_usable(mut g: Gaussians, name: &str) -> Result<(Gaussians, Vec<u32>, Vec<String>), SceneError> {
    let width = g.sh_coefficients() * 3;
    let largest = |i: usize| {
        let numbers = g.mean[i].to_array().into_iter().chain(g.scale[i].to_array()).chain(g.rotation[i]).chain([g.opacity[i]]);
        let all = numbers.chain(g.sh[i * width..(i + 1) * width].iter().copied());
        all.fold(0.0_f32, |most, x| if x.is_finite() { most.max(x.abs()) } else { f32::INFINITY })
    };
    let (mut keep, mut not_finite, mut absurd) = (memory::reserved(g.len(), name)?, 0, 0);
    for i in 0..g.len() {
        match largest(i) {
            f32::INFINITY => not_finite += 1,
            size if size > ABSURD => absurd += 1,
            _ => keep.push(i as u32),
        }
    }
    let all = g.len();
    if keep.is_empty() {
        let why = format!("all {all} have NaN, infinite or absurd (over {ABSURD:e}) numbers");
        return Err(SceneError::Empty { file: name.to_owned(), why });
    }
    if keep.len() < all {
        g.retain(&keep);
    }
    let negative = g.scale.iter().filter(|s| s.min_element() < 0.0).count();
    for scale in &mut g.scale {
        *scale = scale.abs();
    }
    let mut warnings = Vec::new();
    let mut warn = |count: usize, what: &str| {
        if count > 0 {
            warnings.push(format!("{name}: {count} of {all} Gaussians {what}"));
        }
    };
    warn(not_finite, "dropped: NaN or infinite numbers");
    warn(absurd, "dropped: numbers over 1e12");
    warn(negative, "have negative scales, taken as positive");
    Ok((g, keep, warnings))
}

/// Writes a scene in the format of the name's extension and says what that format cannot hold.
/// The file appears whole or not at all.
pub fn write(path: &Path, g: &Gaussians) -> Result<Vec<String>, SceneError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let compressed = path.to_string_lossy().to_ascii_lowercase().ends_with(".compressed.ply");
    let (bytes, lost) = match extension.as_deref() {
        Some("ply") if !compressed => (ply::encode(g), Vec::new()),
        Some("splat") => splat::encode(g),
        _ => return Err(SceneError::Extension { file: path.display().to_string() }),
    };
    write_atomic(path, &bytes).map_err(|source| SceneError::Write { file: path.display().to_string(), source })?;
    Ok(lost)
}
