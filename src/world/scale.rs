//! Whether a scene's size in metres is one that the solver's 32-bit floats can hold; if not, which `scene.metres_per_unit` is.

use super::{Prepared, Resolved};
use crate::spec::{Spec, limits};

/// The size of a scene is none that can be simulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the objects are {longest_m:.1e} m across, so a grid cell is {cell_m:.1e} m, and 32-bit arithmetic holds cells from {least_m:.1e} to {most_m:.1e} m; {advice}"
)]
pub struct ScaleError {
    /// Longest side of any object.
    pub longest_m: f64,
    /// Edge of a grid cell.
    pub cell_m: f64,
    /// Smallest cell that is simulated.
    pub least_m: f64,
    /// Largest.
    pub most_m: f64,
    /// What to change.
    pub advice: String,
}

/// Bits that a sum over a node's particles needs above the largest of them.
const HEADROOM_BITS: i32 = 24;

/// Smallest and largest cell for matter of a density. The solver multiplies a particle's mass by the square of a cell (affine
/// momentum, inertia): with eight particles in a cell that is density * cell^5 / 8, which has to be a normal f32, and to leave
/// room for sums above. For water the range is 1e-8 m to 7e5 m.
fn cells_m(density_kg_m3: f64) -> (f64, f64) {
    let cell_m = |inertia: f64| (8.0 * inertia / density_kg_m3).powf(0.2);
    (cell_m(f64::from(f32::MIN_POSITIVE)), cell_m(f64::from(f32::MAX) / f64::from(HEADROOM_BITS).exp2()))
}

/// Refuses a scene that is too small or too large to be simulated, before anything is made of it.
pub fn check(spec: &Spec, prepared: &Prepared, resolved: &Resolved) -> Result<(), ScaleError> {
    let parts = spec.objects.iter().flat_map(|o| o.parts.iter().map(|p| &p.material).chain([&o.material]));
    let ranges = parts.map(|material| cells_m(material.density_kg_m3()));
    let (least_m, most_m) = ranges.fold((0.0, f64::INFINITY), |(low, high), (least, most)| (least.max(low), most.min(high)));
    if (least_m..=most_m).contains(&resolved.cell_m) {
        return Ok(());
    }
    let sides = prepared.object_facts(spec).into_iter().flat_map(|f| (0..3).map(move |i| f.high_m[i] - f.low_m[i]));
    let longest_m = sides.fold(0.0, f64::max);
    Err(ScaleError { longest_m, cell_m: resolved.cell_m, least_m, most_m, advice: advice(spec.scene.metres_per_unit, longest_m) })
}

/// The power of ten that makes the scene about a metre large, where a spec may say so.
fn advice(metres_per_unit: f64, longest_m: f64) -> String {
    let wanted = 10f64.powf((metres_per_unit / longest_m).log10().round());
    let (low, high) = limits::METRES_PER_UNIT;
    match wanted {
        _ if (low..=high).contains(&wanted) => format!("`--set scene.metres_per_unit={wanted:e}` makes them about 1 m"),
        _ => "convert the file to units in which it is about 1 across".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_of_cells_is_that_of_inertia_in_f32() {
        let (least_m, most_m) = cells_m(1000.0);
        assert!((0.9e-8..1.1e-8).contains(&least_m) && (1e5..1e6).contains(&most_m), "{least_m} {most_m}");
        let inertia = |cell_m: f64| (1000.0 * cell_m.powi(5) / 8.0) as f32;
        assert!(inertia(1.01 * least_m).is_normal() && !inertia(0.99 * least_m).is_normal());
    }

    #[test]
    fn advice_is_a_scale_that_a_spec_may_have() {
        assert!(advice(1.0, 2e-12).contains("=1e12`") || advice(1.0, 2e-12).contains("=5e11`"), "{}", advice(1.0, 2e-12));
        assert!(advice(1.0, 1e9).contains("scene.metres_per_unit=1e-9"));
        assert!(advice(1.0, 1e-30).contains("convert the file"));
        assert!(advice(1.0, 0.0).contains("convert the file"));
    }
}
