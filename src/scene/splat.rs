//! The .splat format of antimatter15: records of 32 bytes and nothing else.
//!
//! Position 3 x f32, standard deviations 3 x f32 (linear), colour and opacity 4 x u8, rotation
//! 4 x u8 (w, x, y, z as (b - 128) / 128, of any length). No header, no spherical harmonics.

use super::codec::{byte_of_dc, bytes_of_rotation, dc_of_byte, rotation_of_bytes, unit_byte};
use super::error::COPY_AGAIN;
use super::{Gaussians, SceneError};
use glam::Vec3;
use rayon::prelude::*;

/// Bytes of one Gaussian.
pub(super) use super::source::RECORD;

/// Beyond this, in the file's units, nothing is a scene.
const PLAUSIBLE: f32 = 1e12;

/// Whether records of a file that is named a .splat may be Gaussians: of those without NaN or infinities at least half have
/// scales that are not negative and numbers of a credible size, and are not empty.
pub fn is_credible(records: &[[u8; RECORD]]) -> bool {
    let (good, bad) = count(records, |mean, scale| scale.min_element() >= 0.0 && (mean, scale) != (Vec3::ZERO, Vec3::ZERO));
    good >= bad
}

/// Whether records can be nothing but Gaussians, whatever their file is called. The format has no magic number, so all that
/// speaks is numbers: most records have an extent, none of them denormal as whole numbers read as floats are, and they differ.
pub fn is_evident(records: &[[u8; RECORD]]) -> bool {
    let number = |v: Vec3| v.to_array().into_iter().all(|x| x == 0.0 || x.is_normal());
    let (good, bad) = count(records, |mean, scale| number(mean) && number(scale) && scale.min_element() >= 0.0 && scale.max_element() > 0.0);
    let differ = records.len() < ALIKE || records.iter().any(|record| *record != records[0]);
    good > bad && differ
}

/// So many records that are all the same are padding.
const ALIKE: usize = 16;

/// How many records without NaN or infinities are of a credible size and pass a test of mean and scale, and how many are not.
fn count(records: &[[u8; RECORD]], passes: impl Fn(Vec3, Vec3) -> bool) -> (usize, usize) {
    let numbers = records.iter().map(|record| (vector(record, 0), vector(record, 12))).filter(|(mean, scale)| mean.is_finite() && scale.is_finite());
    let size = |v: Vec3| v.abs().max_element() < PLAUSIBLE;
    let (good, bad): (Vec<_>, Vec<_>) = numbers.partition(|&(mean, scale)| size(mean) && size(scale) && passes(mean, scale));
    (good.len(), bad.len())
}

/// Gaussians of a file's bytes, unchecked for NaN.
pub fn decode(bytes: &[u8], name: &str) -> Result<Gaussians, SceneError> {
    let (whole, rest) = (bytes.len() / RECORD, bytes.len() % RECORD);
    if rest != 0 {
        return Err(SceneError::Damaged {
            file: name.to_owned(),
            at: format!("byte {}", whole * RECORD),
            found: format!("{rest} bytes after {whole} whole records"),
            expected: format!("records of {RECORD} bytes up to the end"),
            advice: COPY_AGAIN,
        });
    }
    let mut g = Gaussians::zeros(whole, 0, name)?;
    (bytes.par_chunks_exact(RECORD), &mut g.mean, &mut g.scale, &mut g.rotation, &mut g.opacity, g.sh.par_chunks_exact_mut(3))
        .into_par_iter()
        .for_each(|(record, mean, scale, rotation, opacity, sh)| {
            *mean = vector(record, 0);
            *scale = vector(record, 12);
            sh.copy_from_slice(&[dc_of_byte(record[24]), dc_of_byte(record[25]), dc_of_byte(record[26])]);
            *opacity = f32::from(record[27]) / 255.0;
            *rotation = rotation_of_bytes([record[28], record[29], record[30], record[31]]);
        });
    Ok(g)
}

fn vector(record: &[u8], at: usize) -> Vec3 {
    let float = |i: usize| f32::from_le_bytes([record[i], record[i + 1], record[i + 2], record[i + 3]]);
    Vec3::new(float(at), float(at + 4), float(at + 8))
}

/// The bytes of a file, and what they cannot hold, one sentence each.
pub fn encode(g: &Gaussians) -> (Vec<u8>, Vec<String>) {
    let coefficients = g.sh_coefficients() * 3;
    let mut bytes = vec![0; g.len() * RECORD];
    bytes.par_chunks_exact_mut(RECORD).enumerate().for_each(|(i, record)| {
        let floats = g.mean[i].to_array().into_iter().chain(g.scale[i].to_array());
        for (field, value) in record.chunks_exact_mut(4).zip(floats) {
            field.copy_from_slice(&value.to_le_bytes());
        }
        for channel in 0..3 {
            record[24 + channel] = byte_of_dc(g.sh[i * coefficients + channel]);
        }
        record[27] = unit_byte(g.opacity[i]);
        record[28..].copy_from_slice(&bytes_of_rotation(g.rotation[i]));
    });
    let lost = losses(g, &bytes);
    (bytes, lost)
}

/// Compares Gaussians with what their records say.
fn losses(g: &Gaussians, bytes: &[u8]) -> Vec<String> {
    const HALF_STEP: f32 = 0.5 / 255.0;
    let coefficients = g.sh_coefficients() * 3;
    let count =
        |lost: &(dyn Fn(usize, &[u8]) -> bool + Sync)| bytes.par_chunks_exact(RECORD).enumerate().filter(|(i, record)| lost(*i, record)).count();
    let colour = |i: usize| &g.sh[i * coefficients..i * coefficients + 3];
    let directional = count(&|i, _| g.sh[i * coefficients + 3..(i + 1) * coefficients].iter().any(|&c| c != 0.0));
    let clamped = count(&|i, _| colour(i).iter().any(|dc| !(-HALF_STEP..=1.0 + HALF_STEP).contains(&(0.5 + super::SH_C0 * dc))));
    let rounded = count(&|i, record| {
        let kept = |channel: usize| (colour(i)[channel] - dc_of_byte(record[24 + channel])).abs() < 1e-5;
        !(kept(0) && kept(1) && kept(2)) || (g.opacity[i] - f32::from(record[27]) / 255.0).abs() > 1e-6
    });
    let turned = count(&|i, record| g.rotation[i] != rotation_of_bytes([record[28], record[29], record[30], record[31]]));
    let of = |n: usize| format!("{n} of {} Gaussians", g.len());
    let mut lost = Vec::new();
    let mut say = |n: usize, sentence: &str| {
        if n > 0 {
            lost.push(format!("{}: {sentence}", of(n)));
        }
    };
    say(directional, "colour no longer changes with the view (.splat has no spherical harmonics above degree 0)");
    say(clamped, "colour outside 0..1 is clamped");
    say(rounded, "colour or opacity is rounded to 8 bits");
    say(turned, "rotation is normalised and rounded to 8 bits a component");
    lost
}
