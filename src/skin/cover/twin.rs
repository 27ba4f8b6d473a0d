//! `cover_*.wgsl` in plain Rust: a map of cells in place of the table.

use super::{ALONE, LEAST, MOST, REACH, SHEET, SHEET_LEAST, SPREAD_LEAST, UNITS};
use crate::skin::twin::{covariance_of, eigen, smoothstep};
use glam::{DMat3, DVec3, IVec3, Mat3, Vec3};
use std::collections::BTreeMap;

/// Gaussians that move: all the rule knows of them.
pub struct Cover {
    pub origin: Vec3,
    pub span_m: f32,
    /// Radius, thinness and what covers the surroundings in the captured pose.
    pub sizes: Vec<[f64; 3]>,
}

type Table = BTreeMap<[i32; 3], [i64; 11]>;

impl Cover {
    /// From the records of the captured pose.
    pub fn new(rest: &[[f32; 16]], origin: Vec3, span_m: f32) -> Cover {
        let mut cover = Cover { origin, span_m, sizes: rest.iter().map(|r| size(r, span_m)).collect() };
        let centres: Vec<Vec3> = rest.iter().map(|r| Vec3::from_slice(r)).collect();
        let table = cover.table(&centres, &vec![0.0; rest.len()]);
        for (g, x) in centres.iter().enumerate() {
            cover.sizes[g][2] = cover.around(&table, *x).0;
        }
        cover
    }

    fn in_cells(&self, x: Vec3) -> DVec3 {
        ((x - self.origin) / (REACH * self.span_m)).as_dvec3()
    }

    /// `cover_pour.wgsl`.
    fn table(&self, centres: &[Vec3], loose: &[f32]) -> Table {
        let mut table = Table::new();
        for ((x, size), _) in centres.iter().zip(&self.sizes).zip(loose).filter(|(_, loose)| **loose >= 0.0) {
            let x = self.in_cells(*x);
            let d = x - x.floor() - 0.5;
            let area = ((size[0] / f64::from(self.span_m)).powi(2) * f64::from(UNITS)).max(1.0);
            let words = [1.0, d.x, d.y, d.z, d.x * d.x, d.y * d.y, d.z * d.z, d.y * d.z, d.z * d.x, d.x * d.y];
            let cell = table.entry(x.floor().as_ivec3().to_array()).or_default();
            cell.iter_mut().zip(words).for_each(|(sum, word)| *sum += (area * word).round() as i64);
            cell[10] += 1;
        }
        table
    }

    /// `cover_around.wgsl`: the area around a place and of each Gaussian there, squares of the span, and its spread.
    fn around(&self, table: &Table, x: Vec3) -> (f64, f64, DMat3) {
        let x = self.in_cells(x);
        let (mut area, mut number, mut first, mut second) = (0.0, 0.0, DVec3::ZERO, DMat3::ZERO);
        for k in 0..27 {
            let cell = x.floor().as_ivec3() + IVec3::new(k % 3, k / 3 % 3, k / 9) - 1;
            let Some(sums) = table.get(&cell.to_array()) else { continue };
            let s = sums.map(|v| v as f64);
            let from = cell.as_dvec3() + 0.5 - x;
            let middle = DVec3::new(s[1], s[2], s[3]) / s[0];
            let w = (1.0 - (from + middle).length_squared()).max(0.0).powi(3);
            let about = DMat3::from_cols_array(&[s[4], s[9], s[8], s[9], s[5], s[7], s[8], s[7], s[6]]);
            area += w * s[0];
            number += w * s[10];
            first += (middle + from) * (s[0] * w);
            second += (about + outer(from, middle * s[0]) + outer(middle * s[0], from) + outer(from, from) * s[0]) * w;
        }
        let per = 1.0 / area.max(1.0);
        (area / f64::from(UNITS), area / (f64::from(UNITS) * number.max(1e-6)), second * per - outer(first * per, first * per))
    }

    /// `cover_shape.wgsl`: the covariance of each Gaussian, had it lost its shape wholly.
    pub fn spaced(&self, centres: &[Vec3], loose: &[f32]) -> Vec<Mat3> {
        let table = self.table(centres, loose);
        let one = |(x, &[radius_m, thin, rest]): (&Vec3, &[f64; 3])| {
            let (area, each, spread) = self.around(&table, *x);
            let area = area.max(1e-20);
            let together = 1.0 - f64::from(smoothstep(ALONE, ((radius_m / f64::from(self.span_m)).powi(2) / area) as f32));
            let grown = 1.0 + together * ((rest / area).sqrt().clamp(f64::from(LEAST), f64::from(MOST)) - 1.0);
            let ([_, middle, least], normal) = principal(spread.as_mat3());
            let flat = (least.max(0.0) + SPREAD_LEAST) / (middle + SPREAD_LEAST);
            let thinnest = (thin / grown.powi(3)).clamp(f64::from(SHEET_LEAST), 1.0);
            let thin = 1.0 + together * (thinnest + (1.0 - thinnest) * f64::from(smoothstep(SHEET, flat)) - 1.0);
            let even_m = radius_m + together * (f64::from(self.span_m) * each.sqrt() - radius_m);
            let n = normal.as_dvec3();
            ((DMat3::IDENTITY - outer(n, n) * (1.0 - thin * thin)) * (grown * even_m).powi(2)).as_mat3()
        };
        centres.iter().zip(&self.sizes).map(one).collect()
    }
}

/// `cover_size.wgsl`.
fn size(rest: &[f32; 16], span_m: f32) -> [f64; 3] {
    let ([a, b, c], _) = principal(covariance_of(rest));
    let disc_m = f64::from((a * b).max(0.0)).sqrt().sqrt();
    [disc_m.min(f64::from(span_m)), (f64::from(c.max(0.0)).sqrt() / disc_m).min(1.0), 0.0]
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Principal values, descending, and the axis of the least.
pub fn principal(matrix: Mat3) -> ([f32; 3], Vec3) {
    let size = (matrix.x_axis.x.abs() + matrix.y_axis.y.abs() + matrix.z_axis.z.abs()).max(1e-30);
    let (values, axes) = eigen(matrix * (1.0 / size));
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    (order.map(|k| values[k] * size), axes.col(order[2]))
}
