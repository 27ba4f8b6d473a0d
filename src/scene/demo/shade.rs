//! What stands between a dab and the light.

use super::dab::Dab;
use glam::Vec3;

/// Something that takes light away.
pub trait Shade {
    /// The share of light that arrives at a point from a direction, 0..1.
    fn passes(&self, point: Vec3, towards: Vec3) -> f32;
}

/// Solid boxes, low and high corner.
pub struct Boxes(pub Vec<[Vec3; 2]>);

impl Shade for Boxes {
    fn passes(&self, point: Vec3, towards: Vec3) -> f32 {
        // Starts a little off the surface that the point lies on.
        let origin = point + towards * 4e-3;
        let inverse = towards.recip();
        let hit = |[low, high]: &[Vec3; 2]| {
            let (a, b) = ((*low - origin) * inverse, (*high - origin) * inverse);
            let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
            leave > enter.max(0.0)
        };
        if self.0.iter().any(hit) { 0.0 } else { 1.0 }
    }
}

/// A fog of dabs on a grid: soft shade within foliage.
pub struct Fog {
    low: Vec3,
    size: [usize; 3],
    /// Extinction per cell edge.
    density: Vec<f32>,
}

/// Edge of a cell of the fog, metres.
const CELL: f32 = 0.008;
/// How far shade reaches, cells.
const REACH: usize = 34;

impl Fog {
    /// Deposits each dab's covered area in its cell.
    pub fn of(dabs: &[Dab]) -> Fog {
        let (low, high) = dabs.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), d| (l.min(d.centre), h.max(d.centre)));
        let low = low - CELL;
        let size = ((high - low) / CELL).ceil().to_array().map(|n| n as usize + 1);
        let mut fog = Fog { low, size, density: vec![0.0; size.iter().product()] };
        for dab in dabs {
            if let Some(at) = fog.cell(dab.centre) {
                // A Gaussian covers 2 pi sigma^2; a random plane shows half of that from any side.
                fog.density[at] += 0.5 * std::f32::consts::PI * dab.sigma.x * dab.sigma.y * dab.paint.opacity / (CELL * CELL);
            }
        }
        fog.density.iter_mut().for_each(|d| *d = d.min(1.6));
        fog
    }

    fn cell(&self, p: Vec3) -> Option<usize> {
        let at = (p - self.low) / CELL;
        let [nx, ny, nz] = self.size;
        let inside = at.cmpge(Vec3::ZERO).all() && at.cmplt(Vec3::new(nx as f32, ny as f32, nz as f32)).all();
        inside.then(|| (at.z as usize * ny + at.y as usize) * nx + at.x as usize)
    }
}

impl Shade for Fog {
    fn passes(&self, point: Vec3, towards: Vec3) -> f32 {
        let step = towards * CELL;
        let mut at = point + step * 1.6;
        let mut depth = 0.0;
        for _ in 0..REACH {
            match self.cell(at) {
                Some(cell) => depth += self.density[cell],
                None => break,
            }
            if depth > 4.0 {
                return 0.0;
            }
            at += step;
        }
        (-depth).exp()
    }
}
