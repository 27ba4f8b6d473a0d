//! Gaussians to solids: hull, voxel signed distance, interior filling.
//!
//! The Gaussians' optical depth on a grid of their own spacing ([`density`]) gives the shell;
//! [`fill`] adds what it encloses, and the signed distance of the result ([`body`]) is sampled with
//! particles at the solver's spacing ([`sample`]). Only the last step knows the solver's cell, so
//! that draft and full are two samplings of one solid.

mod body;
mod density;
mod distance;
mod fill;
mod grid;
mod hull;
mod join;
mod nearest;
mod sample;
mod sections;
mod thicken;
mod way;
mod young;

#[cfg(test)]
pub(crate) mod tests;

pub use nearest::nearest;
pub use young::{BEARING, Stance, YoungAuto, pascals, young_auto};

use crate::scene::{Gaussians, morton_order};
use crate::spec::ProxyKind;
use body::Body;
use glam::Vec3;
use sections::Sections;

/// Version of this room, for stage keys.
pub const VERSION: u32 = 6;
/// Share of the solid whose loss is worth a warning.
const NOTABLE_SHARE: f64 = 1e-3;

/// What to make a solid of.
#[derive(Clone, Copy, Debug)]
pub struct ProxyRequest<'a> {
    /// Of one object, world frame, floaters dropped already.
    pub gaussians: &'a Gaussians,
    /// The solid is cut here.
    pub ground_m: f32,
    /// Edge of the solver's cell; particles are half of it apart.
    pub cell_m: f32,
    /// Voxels or hull.
    pub kind: ProxyKind,
    /// Whether it stands by its own elasticity: threads that cannot are no matter then. What flows, falls apart or is
    /// rigid has them.
    pub stands: bool,
    /// Of the jitter.
    pub seed: u64,
}

/// A solid as particles, along a Morton curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Where they are, world frame.
    pub position_m: Vec<Vec3>,
    /// Their volumes; they add up to `volume_total_m3`.
    pub volume_m3: Vec<f32>,
    /// Whether each lies deeper than the captured skin, one spacing of the Gaussians, below the surface.
    pub inner: Vec<bool>,
    /// Inner particles over all.
    pub fill_ratio: f32,
    /// Distance between particles in the interior: half the solver's cell.
    pub spacing_m: f32,
    /// Volume of the solid; follows from the Gaussians alone, not from the cell.
    pub volume_total_m3: f32,
    /// How stiff it has to be to stand.
    pub stance: Stance,
    /// Gaussians of threads too slender to be matter, and where each thread ends on the solid, world frame.
    pub hung: Vec<(u32, Vec3)>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Why no solid could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProxyError {
    /// Nothing but haze.
    #[error("none of the object's {gaussians} Gaussians is more than haze (all under 5 % opacity): select other ones")]
    Invisible {
        /// How many there are.
        gaussians: usize,
    },
    /// A point.
    #[error("the object's {gaussians} visible Gaussians are one point without extent: select more of the scene")]
    NoExtent {
        /// How many can be seen.
        gaussians: usize,
    },
    /// All of it would be cut away.
    #[error("the object reaches up to {highest_m} m and the ground is at {ground_m} m: lower world.ground.height_m or select Gaussians above it")]
    BelowGround {
        /// Height of the ground.
        ground_m: f32,
        /// Highest point of the object.
        highest_m: f32,
    },
    /// A few far Gaussians stretch the bounds.
    #[error("the object spans {extent_m} m with Gaussians {spacing_m} m apart, too far for one solid: select a smaller part of the scene")]
    TooSparse {
        /// Longest side.
        extent_m: f32,
        /// Typical distance between neighbours.
        spacing_m: f32,
    },
    /// No volume to wrap.
    #[error("the centres of the object's {gaussians} Gaussians lie in one plane, so their hull is empty: use proxy = \"voxel\"")]
    FlatHull {
        /// How many there are.
        gaussians: usize,
    },
    /// The solver's cell is not a length, or far too small for the object.
    #[error("a solver cell of {cell_m} m is too fine for an object of {extent_m} m, or not a length: lower solver.cells_across")]
    Cell {
        /// The cell asked for.
        cell_m: f32,
        /// Longest side of the object.
        extent_m: f32,
    },
    /// Gaussians without any solid above the floor.
    #[error("the object's {gaussians} Gaussians are too thin or too transparent to make a solid: select more of the scene")]
    Empty {
        /// How many there are.
        gaussians: usize,
    },
}

/// What the Gaussians say about the solid, before any solver's cell is known.
struct Shape {
    density: density::Density,
    /// Whether each voxel belongs to the solid.
    solid: Vec<bool>,
    sections: Sections,
    joined: join::Joined,
    threads: usize,
}

/// The solid of an object's Gaussians: shell, what it encloses, loose pieces joined, nothing thinner than the
/// Gaussians' spacing, no thread that could not stand.
fn shape(gaussians: &Gaussians, ground_m: f32, stands: bool) -> Result<Shape, ProxyError> {
    let density = density::rasterise(gaussians, ground_m, fill::CLOSING_SPACINGS)?;
    let mut solid = fill::solid(&density.grid, &density.occupied, density.spacing_m);
    let joined = join::join(&density.grid, &mut solid, density.spacing_m);
    thicken::thicken(&density.grid, &mut solid);
    let mut sections = Sections::find(&density.grid, &solid);
    let mut threads = young::let_go_of_threads(&mut sections);
    if stands {
        sections.clear(&mut solid);
    } else {
        threads = 0;
    }
    Ok(Shape { density, solid, sections, joined, threads })
}

/// Makes a solid of an object's Gaussians and fills it with particles.
pub fn build(request: &ProxyRequest) -> Result<Solid, ProxyError> {
    let Shape { density, mut solid, sections, mut joined, mut threads } = shape(request.gaussians, request.ground_m, request.stands)?;
    let spacing_m = 0.5 * request.cell_m;
    let extent_m = density.grid.size.as_vec3().max_element() * density.grid.voxel_m;
    let cell_error = ProxyError::Cell { cell_m: request.cell_m, extent_m };
    if !(spacing_m > 0.0 && spacing_m.is_finite()) {
        return Err(cell_error);
    }
    // The thing stands as what it is, whatever it is simulated as.
    let stance = young::stance(request.gaussians, &density.grid, &sections);
    let mut hung = if threads > 0 { hung(request.gaussians, &density.grid, &sections) } else { Vec::new() };
    if request.kind == ProxyKind::Hull {
        solid = hull::solid(&density.grid, request.gaussians)?;
        (joined, threads) = Default::default();
        hung.clear();
    }
    let skin_m = density.spacing_m;
    let mut warnings = warnings(density.wide, &joined);
    warnings.extend((threads > 0).then(|| hanging(threads, hung.len(), request.gaussians.len())));
    let reach_m = sample::reach_m(spacing_m, density.grid.voxel_m).max(skin_m);
    let body = Body::new(density.grid, &solid, reach_m);
    let samples = sample::sample(&body, spacing_m, request.seed).ok_or(cell_error)?;
    if samples.is_empty() {
        return Err(ProxyError::Empty { gaussians: request.gaussians.len() });
    }
    Ok(Solid { stance, hung, warnings, ..finish(&body, &samples, spacing_m, skin_m) })
}

/// How stiff the thing has to be to stand, known before a solid is made of it; nothing where its Gaussians make none.
pub fn stance_of(gaussians: &Gaussians, ground_m: f32) -> Stance {
    shape(gaussians, ground_m, true).map(|shape| young::stance(gaussians, &shape.density.grid, &shape.sections)).unwrap_or_default()
}

/// Orders the samples along a Morton curve and shares the body's volume among them.
fn finish(body: &Body, samples: &[sample::Sample], spacing_m: f32, skin_m: f32) -> Solid {
    let positions: Vec<Vec3> = samples.iter().map(|s| s.position).collect();
    let order = morton_order(&positions);
    let share = body.volume_m3 / samples.iter().map(|s| f64::from(s.fraction)).sum::<f64>();
    let position_m: Vec<Vec3> = order.iter().map(|&i| positions[i as usize]).collect();
    let inner: Vec<bool> = position_m.iter().map(|&p| body.distance_m(p) < -skin_m).collect();
    Solid {
        volume_m3: order.iter().map(|&i| (f64::from(samples[i as usize].fraction) * share) as f32).collect(),
        fill_ratio: inner.iter().filter(|inner| **inner).count() as f32 / inner.len() as f32,
        position_m,
        inner,
        spacing_m,
        volume_total_m3: body.volume_m3 as f32,
        stance: Stance::default(),
        hung: Vec::new(),
        warnings: Vec::new(),
    }
}

/// The Gaussians of threads that were let go of, and where each hangs.
fn hung(gaussians: &Gaussians, grid: &grid::Grid, sections: &Sections) -> Vec<(u32, Vec3)> {
    let at = |(i, &p): (usize, &Vec3)| Some((i as u32, sections.hung_at(grid, sections.at(grid, p)?)?));
    gaussians.mean.iter().enumerate().filter_map(at).collect()
}

fn hanging(threads: usize, gaussians: usize, of: usize) -> String {
    let share = 100.0 * gaussians as f32 / of as f32;
    format!(
        "{threads} stems or threads ({share:.1} % of the Gaussians) are too thin to stand by themselves: they go along with what they hang on, and do not \
         bend, swing or break on their own; made of rigid, flowing or loose stuff (\"steel\", \"water\", \"sand\") they are simulated too"
    )
}

fn warnings(wide: usize, joined: &join::Joined) -> Vec<String> {
    let mut warnings = Vec::new();
    if wide > 0 {
        warnings.push(format!("{wide} Gaussians wider than the object itself are left out of its solid"));
    }
    if joined.dropped_share > NOTABLE_SHARE {
        let (pieces, share) = (joined.dropped, 100.0 * joined.dropped_share);
        warnings.push(format!(
            "{pieces} loose pieces far from the solid ({share:.1} % of it) have no particles of their own and follow the nearest ones"
        ));
    }
    warnings
}
