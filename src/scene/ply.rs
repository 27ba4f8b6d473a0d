//! The binary little-endian .ply that INRIA's trainer writes and most programs exchange.
//!
//! One row a Gaussian: x y z, f_dc_0..2, f_rest_* (all of red, then green, then blue: 0, 9, 24 or
//! 45 of them for degree 0 to 3), opacity as logit, scale_0..2 as logarithms, rot_0..3 as w x y z of
//! any length. Properties are found by name, in any order and number type; others are ignored.
//!
//! A linear f32 does not survive its rounded logarithm. Where that matters (a .splat on its way
//! through a .ply) we add `sigma_0..2`, the linear values; a reader that ignores them is off by less
//! than 1e-6 of them, and where another program has since changed `scale_*` they no longer match and are ignored.

use super::codec::{exp, ln, logit, sigmoid};
use super::error::{CONVERT, COPY_AGAIN};
use super::ply_header::{self, Column, Element, Header};
use super::{Gaussians, SceneError};
use glam::Vec3;
use rayon::prelude::*;

/// `sigma_*` counts where it is within this share of exp(`scale_*`).
const SIGMA_TOLERANCE: f32 = 1e-5;

/// Gaussians of a file's bytes, unchecked for NaN, and the comments of its header.
pub fn decode(bytes: &[u8], name: &str) -> Result<(Gaussians, Vec<String>), SceneError> {
    let header = ply_header::parse(bytes, name)?;
    let (vertex, rows) = vertex_rows(bytes, &header, name)?;
    let columns = Columns::find(vertex, name)?;
    let count = rows.len() / vertex.stride;
    let coefficients = 1 + columns.rest.len() / 3;
    let mut g = Gaussians::zeros(count, coefficients.isqrt() as u32 - 1, name)?;
    (rows.par_chunks_exact(vertex.stride), &mut g.mean, &mut g.scale, &mut g.rotation, &mut g.opacity, g.sh.par_chunks_exact_mut(coefficients * 3))
        .into_par_iter()
        .for_each(|(row, mean, scale, rotation, opacity, sh)| {
            *mean = vector(columns.mean, row);
            *scale = columns.scale(row);
            *rotation = columns.rotation.map(|c| c.read(row));
            *opacity = sigmoid(columns.opacity.read(row));
            for (value, column) in sh.iter_mut().zip(&columns.dc) {
                *value = column.read(row);
            }
            for (i, column) in columns.rest.iter().enumerate() {
                let (channel, coefficient) = (i / (coefficients - 1), i % (coefficients - 1));
                sh[(coefficient + 1) * 3 + channel] = column.read(row);
            }
        });
    Ok((g, header.comments))
}

fn vector(columns: [Column; 3], row: &[u8]) -> Vec3 {
    Vec3::from_array(columns.map(|c| c.read(row)))
}

/// The element of Gaussians and its rows, once the file is known to hold them all.
fn vertex_rows<'a, 'h>(bytes: &'a [u8], header: &'h Header, name: &str) -> Result<(&'h Element, &'a [u8]), SceneError> {
    let mut at = header.bytes as u128;
    for element in &header.elements {
        let length = u128::from(element.count) * element.stride as u128;
        if element.column("packed_position").is_some() {
            return Err(SceneError::Unsupported { file: name.to_owned(), found: "a compressed .ply of PlayCanvas".to_owned(), advice: CONVERT });
        }
        if element.name == "vertex" && !element.lists {
            let present = bytes.len() as u128 - at.min(bytes.len() as u128);
            // Also where it has no rows and the elements before it end behind the file.
            if at + length > bytes.len() as u128 {
                let whole = present / element.stride.max(1) as u128;
                return Err(SceneError::Damaged {
                    file: name.to_owned(),
                    at: format!("byte {}", bytes.len()),
                    found: format!("the end of the file after {whole} of {} Gaussians", element.count),
                    expected: format!("{} bytes in all", at + length),
                    advice: COPY_AGAIN,
                });
            }
            return Ok((element, &bytes[at as usize..(at + length) as usize]));
        }
        if element.lists && element.count > 0 {
            break;
        }
        at += length;
    }
    Err(SceneError::Missing {
        file: name.to_owned(),
        missing: "x, y, z and the rest".to_owned(),
        advice: "there is no plain `element vertex`: this is another kind of .ply, export Gaussians from the program that made it",
    })
}

/// Where a row holds what.
struct Columns {
    mean: [Column; 3],
    dc: [Column; 3],
    rest: Vec<Column>,
    opacity: Column,
    scale: [Column; 3],
    sigma: Option<[Column; 3]>,
    rotation: [Column; 4],
}

impl Columns {
    fn find(vertex: &Element, name: &str) -> Result<Columns, SceneError> {
        let mut missing = Vec::new();
        let mut find = |property: &'static str| {
            vertex.column(property).or_else(|| {
                missing.push(property);
                None
            })
        };
        let mean = ["x", "y", "z"].map(&mut find);
        let dc = ["f_dc_0", "f_dc_1", "f_dc_2"].map(&mut find);
        let opacity = find("opacity");
        let scale = ["scale_0", "scale_1", "scale_2"].map(&mut find);
        let rotation = ["rot_0", "rot_1", "rot_2", "rot_3"].map(&mut find);
        let sigma = ["sigma_0", "sigma_1", "sigma_2"].map(|property| vertex.column(property));
        if let ([Some(x), Some(y), Some(z)], [Some(r), Some(g), Some(b)], Some(opacity)) = (mean, dc, opacity)
            && let ([Some(s0), Some(s1), Some(s2)], [Some(q0), Some(q1), Some(q2), Some(q3)]) = (scale, rotation)
        {
            return Ok(Columns {
                mean: [x, y, z],
                dc: [r, g, b],
                rest: rest_columns(vertex, name)?,
                opacity,
                scale: [s0, s1, s2],
                sigma: if let [Some(a), Some(b), Some(c)] = sigma { Some([a, b, c]) } else { None },
                rotation: [q0, q1, q2, q3],
            });
        }
        let advice = match missing.as_slice() {
            ["scale_2"] => "this looks like flat (2D) Gaussians, which are not supported yet: train or export 3D Gaussians",
            names if names.contains(&"f_dc_0") => {
                "this looks like a point cloud or a mesh, not Gaussians: choose the .ply that a Gaussian splatting trainer writes"
            }
            _ => "export it again as an INRIA (uncompressed) .ply",
        };
        Err(SceneError::Missing { file: name.to_owned(), missing: missing.join(", "), advice })
    }

    /// Standard deviations: the linear ones where they are there and still true.
    fn scale(&self, row: &[u8]) -> Vec3 {
        let scale = Vec3::from_array(self.scale.map(|c| exp(c.read(row))));
        let Some(sigma) = self.sigma else { return scale };
        let sigma = vector(sigma, row);
        let agrees = (sigma - scale).abs().cmple(sigma * SIGMA_TOLERANCE);
        Vec3::select(agrees, sigma, scale)
    }
}

/// The f_rest properties, which must be those of a whole degree.
fn rest_columns(vertex: &Element, name: &str) -> Result<Vec<Column>, SceneError> {
    let named = vertex.properties.iter().filter(|(n, _)| n.starts_with("f_rest_")).count();
    let columns: Vec<Column> = (0..named).map_while(|i| vertex.column(&format!("f_rest_{i}"))).collect();
    if matches!(columns.len(), 0 | 9 | 24 | 45) && columns.len() == named {
        return Ok(columns);
    }
    Err(SceneError::Damaged {
        file: name.to_owned(),
        at: "its header".to_owned(),
        found: format!("{named} f_rest properties"),
        expected: "f_rest_0 onwards, 0, 9, 24 or 45 of them (degree 0 to 3)".to_owned(),
        advice: "export it with spherical harmonics of degree 3 or less",
    })
}

/// The bytes of a file. Nothing is lost but the last bits of opacities and of the rotation's length.
pub fn encode(g: &Gaussians) -> Vec<u8> {
    let exact = |s: f32| exp(ln(s)) == s;
    let with_sigma = !g.scale.par_iter().all(|s| exact(s.x) && exact(s.y) && exact(s.z));
    let names = property_names(g.sh_coefficients(), with_sigma);
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", g.len());
    for name in &names {
        header.push_str(&format!("property float {name}\n"));
    }
    header.push_str("end_header\n");
    let start = header.len();
    let stride = names.len() * 4;
    let mut bytes = header.into_bytes();
    bytes.resize(start + g.len() * stride, 0);
    bytes[start..].par_chunks_exact_mut(stride).enumerate().for_each(|(i, row)| {
        let mut fields = row.chunks_exact_mut(4);
        let mut put = |value: f32| {
            if let Some(field) = fields.next() {
                field.copy_from_slice(&value.to_le_bytes());
            }
        };
        write_row(g, i, with_sigma, &mut put);
    });
    bytes
}

/// In the order that INRIA's own programs expect, unused normals included.
fn property_names(coefficients: usize, with_sigma: bool) -> Vec<String> {
    let numbered = |stem: &str, count: usize| (0..count).map(|i| format!("{stem}_{i}")).collect::<Vec<_>>();
    let mut names: Vec<String> = ["x", "y", "z", "nx", "ny", "nz"].map(str::to_owned).to_vec();
    names.extend(numbered("f_dc", 3));
    names.extend(numbered("f_rest", (coefficients - 1) * 3));
    names.push("opacity".to_owned());
    names.extend(numbered("scale", 3));
    names.extend(numbered("rot", 4));
    if with_sigma {
        names.extend(numbered("sigma", 3));
    }
    names
}

/// The values of one row in the order of [`property_names`].
fn write_row(g: &Gaussians, i: usize, with_sigma: bool, put: &mut dyn FnMut(f32)) {
    let coefficients = g.sh_coefficients();
    let sh = &g.sh[i * coefficients * 3..(i + 1) * coefficients * 3];
    g.mean[i].to_array().into_iter().chain([0.0; 3]).for_each(&mut *put);
    sh[..3].iter().copied().for_each(&mut *put);
    for channel in 0..3 {
        for coefficient in 1..coefficients {
            put(sh[coefficient * 3 + channel]);
        }
    }
    put(logit(g.opacity[i]));
    g.scale[i].to_array().map(ln).into_iter().chain(g.rotation[i]).for_each(&mut *put);
    if with_sigma {
        g.scale[i].to_array().into_iter().for_each(put);
    }
}
