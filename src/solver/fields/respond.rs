//! What a field does to a velocity, on the CPU: `shaders/solver/field.wgsl` has the same in f32.

use crate::solver::constants::{FIELD_SPEED, FIELD_STIFFEST};
use crate::spec::expression::{Inputs, Program};
use glam::{DMat3, DVec3};

/// The change of velocity, m/s, that fields bring to one particle over `dt_s`, stable however stiff they
/// are; see `velocity_change` of the shader for the formula. Fields that give no number count as none.
pub fn velocity_change<'a>(fields: impl IntoIterator<Item = &'a Program>, here: &Inputs, dt_s: f64) -> DVec3 {
    let (mut a, mut by_x, mut by_v) = (DVec3::ZERO, DMat3::ZERO, DMat3::ZERO);
    for field in fields {
        let results = field.evaluate(here);
        let [x, y, z] = results.as_slice() else { continue };
        let value = DVec3::new(x.value, y.value, z.value);
        if !value.as_vec3().is_finite() {
            continue;
        }
        a += value;
        let columns = |from: usize| {
            let column = |k: usize| DVec3::new(x.slope[from + k], y.slope[from + k], z.slope[from + k]);
            DMat3::from_cols(column(0), column(1), column(2))
        };
        let slopes = (columns(0), columns(3));
        if slopes.0.is_finite() && slopes.1.is_finite() {
            by_x += slopes.0;
            by_v += slopes.1;
        }
    }
    let velocity = DVec3::from(here.velocity_m_s);
    let next = velocity + respond(a, by_x, by_v, dt_s);
    if !next.is_finite() {
        return DVec3::ZERO;
    }
    let most = velocity.length().max(f64::from(FIELD_SPEED));
    next * (most / next.length().max(1e-20)).min(1.0) - velocity
}

fn respond(a: DVec3, by_x: DMat3, by_v: DMat3, dt_s: f64) -> DVec3 {
    let raw = (by_v + by_x * dt_s) * -dt_s;
    let largest = raw.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
    let share = (f64::from(FIELD_STIFFEST) / largest.max(1e-20)).min(1.0);
    let (z, a) = (raw * share, a * share);
    let m = DMat3::IDENTITY + z * (2.0 / 3.0) + z * z / 6.0;
    let wanted = (a + z * a / 6.0) * dt_s;
    if m.determinant() > 1e-3 { m.inverse() * wanted } else { a * dt_s }
}
