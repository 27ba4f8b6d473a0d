//! Which axis of a file points up.
//!
//! A thing that stands rests on a broad base, much of it lies in that base, and its centre of mass
//! is above it. Each of the six axes is tried as up: the lowest slab is the base, and the score is
//! (share of the mass in the slab) x (hull of the slab / hull of the whole, seen from above) x (how
//! far inside the slab's hull the centre of mass stands, in extents). A thing on its side tips over (0),
//! a lawn under flowers wins by far, and so does the foot of a vase over its bouquet.

use super::Gaussians;
use crate::spec::Axis;
use glam::{Vec2, Vec3};
use serde::Serialize;

/// Thickness of the base, of the whole height.
const SLAB: f32 = 0.035;
/// Left out at either end of each axis before measuring: floaters below a lawn are no base.
const TAIL: f32 = 0.002;
/// A best score below this is no evidence.
const FAINT: f32 = 2e-5;
/// A best score less than this many times the second is said to be unsure.
const CLEAR: f32 = 1.5;
/// Fewer Gaussians than this have no shape to judge.
const FEWEST: usize = 50;

/// An up axis and the reason for it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UpGuess {
    /// Of the file's own frame.
    pub axis: Axis,
    /// One clause, for the user.
    pub why: String,
    /// False where it is the usual axis of captures for want of evidence.
    pub sure: bool,
}

/// As the user writes it.
fn name(axis: Axis) -> &'static str {
    match axis {
        Axis::PlusX => "+x",
        Axis::MinusX => "-x",
        Axis::PlusY => "+y",
        Axis::MinusY => "-y",
        Axis::PlusZ => "+z",
        Axis::MinusZ => "-z",
    }
}

/// The six candidates, usual ones of captures and generators first: ties go to the first.
const AXES: [Axis; 6] = [Axis::MinusY, Axis::PlusZ, Axis::PlusY, Axis::MinusZ, Axis::PlusX, Axis::MinusX];

/// Guesses up from the shape alone.
pub fn guess_up(g: &Gaussians) -> UpGuess {
    let usual = |why: &str| UpGuess { axis: Axis::MinusY, why: format!("{why}; -y is the usual axis of captures"), sure: false };
    let body = Body::of(g);
    if body.points.len() < FEWEST {
        return usual("too few Gaussians to judge");
    }
    let mut ranked = AXES.map(|axis| (body.stands(axis), axis));
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let [(best, axis), (second, other), ..] = ranked;
    if best < FAINT {
        return usual("no side is a base that it could stand on");
    }
    if best < CLEAR * second {
        return UpGuess { axis, why: format!("it stands about as well with {} as with {} up", name(axis), name(other)), sure: false };
    }
    let times = if best > 100.0 * second { "more than 100".to_owned() } else { format!("{:.1}", best / second) };
    UpGuess { axis, why: format!("it stands on the broadest base with {} up, {times} times as well as on any other side", name(axis)), sure: true }
}

/// Up as the comments of a .ply state it: `Vertical axis: y`, a sign allowed.
pub(super) fn stated(comments: &[String]) -> Option<UpGuess> {
    comments.iter().find_map(|comment| {
        let lower = comment.to_ascii_lowercase();
        let axis = match lower.strip_prefix("vertical axis:")?.trim() {
            "x" | "+x" => Axis::PlusX,
            "-x" => Axis::MinusX,
            "y" | "+y" => Axis::PlusY,
            "-y" => Axis::MinusY,
            "z" | "+z" => Axis::PlusZ,
            "-z" => Axis::MinusZ,
            _ => return None,
        };
        Some(UpGuess { axis, why: format!("the file says `{comment}`"), sure: true })
    })
}

/// The visible bulk of a scene as weighted points.
struct Body {
    points: Vec<Vec3>,
    /// Opacity times the area of the two longer axes, the largest few levelled.
    mass: Vec<f32>,
    /// Longest side.
    extent: f32,
    centre_of_mass: Vec3,
}

impl Body {
    fn of(g: &Gaussians) -> Body {
        let visible: Vec<usize> = (0..g.len()).filter(|&i| g.opacity[i] > 0.1).collect();
        let end = |axis: usize, share: f32| quantile(visible.iter().map(|&i| g.mean[i][axis]).collect(), share);
        let low = Vec3::from_array([0, 1, 2].map(|axis| end(axis, TAIL)));
        let high = Vec3::from_array([0, 1, 2].map(|axis| end(axis, 1.0 - TAIL)));
        let within = |i: &usize| g.mean[*i].cmpge(low).all() && g.mean[*i].cmple(high).all();
        let bulk: Vec<usize> = visible.into_iter().filter(within).collect();
        let face = |s: Vec3| s.element_product() / s.min_element().max(f32::MIN_POSITIVE);
        let mut mass: Vec<f32> = bulk.iter().map(|&i| g.opacity[i] * face(g.scale[i])).collect();
        let most = quantile(mass.clone(), 0.98);
        mass.iter_mut().for_each(|m| *m = m.min(most));
        let points: Vec<Vec3> = bulk.iter().map(|&i| g.mean[i]).collect();
        let total: f32 = mass.iter().sum();
        let centre_of_mass = points.iter().zip(&mass).map(|(&p, &m)| p * (m / total)).sum();
        Body { points, mass, extent: (high - low).max_element(), centre_of_mass }
    }

    /// How well it stands with an axis up; 0 where it would tip over.
    fn stands(&self, up: Axis) -> f32 {
        let frame = super::SceneFrame { up, metres_per_unit: 1.0 };
        let turned: Vec<Vec3> = self.points.iter().map(|&p| frame.to_world(p)).collect();
        let (low, high) = turned.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), p| (l.min(p.z), h.max(p.z)));
        let base = |p: &Vec3| p.z <= low + SLAB * (high - low);
        let hull = convex_hull(turned.iter().filter(|p| base(p)).map(|p| p.truncate()).collect());
        let whole = convex_hull(turned.iter().map(|p| p.truncate()).collect());
        let mass_in_base: f32 = turned.iter().zip(&self.mass).filter(|(p, _)| base(p)).map(|(_, m)| m).sum();
        let share = mass_in_base / self.mass.iter().sum::<f32>();
        let margin = depth_inside(&hull, frame.to_world(self.centre_of_mass).truncate()) / self.extent;
        let score = share * area(&hull) / area(&whole) * margin;
        if score.is_finite() { score.max(0.0) } else { 0.0 }
    }
}

/// The value below which a share of the values lies; 0 of none.
fn quantile(mut values: Vec<f32>, share: f32) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let rank = ((values.len() - 1) as f32 * share).round() as usize;
    *values.select_nth_unstable_by(rank, f32::total_cmp).1
}

/// Corners counter-clockwise, by Andrew's monotone chain.
fn convex_hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let chain = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain.as_slice()
                && (*b - *a).perp_dot(p - *a) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

/// The shoelace formula.
fn area(hull: &[Vec2]) -> f32 {
    edges(hull).map(|(a, b)| a.perp_dot(b)).sum::<f32>() / 2.0
}

/// Distance from the nearest edge, negative outside.
fn depth_inside(hull: &[Vec2], p: Vec2) -> f32 {
    edges(hull).map(|(a, b)| (b - a).normalize_or_zero().perp_dot(p - a)).fold(f32::INFINITY, f32::min)
}

fn edges(hull: &[Vec2]) -> impl Iterator<Item = (Vec2, Vec2)> + '_ {
    hull.iter().zip(hull.iter().cycle().skip(1)).map(|(&a, &b)| (a, b))
}
