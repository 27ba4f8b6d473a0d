//! Parts of an object: which points of its captured pose are in a region.

use crate::scene::{in_box, in_sphere};
use crate::spec::Region;
use glam::{DVec3, Vec3};

/// Lowest and highest corner of some points; a point at the origin where there are none.
pub fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let low = points.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
    let high = points.iter().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
    (low, high)
}

/// Whether a point is in a region of an object that reaches from `low` to `high`. Borders count as inside.
pub fn holds(region: &Region, point: Vec3, (low, high): (Vec3, Vec3)) -> bool {
    let level = |share: f64| f64::from(low.z) + share * f64::from(high.z - low.z);
    match region {
        Region::Above(share) => f64::from(point.z) >= level(*share),
        Region::Below(share) => f64::from(point.z) <= level(*share),
        Region::Box(shape) => in_box(point, shape),
        Region::Sphere(shape) => in_sphere(point, shape),
        Region::HalfSpace(plane) => (point.as_dvec3() - DVec3::from(plane.point_m)).dot(DVec3::from(plane.normal)) <= 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::PlaneShape;

    #[test]
    fn shares_of_the_height_and_half_spaces() {
        let whole = (Vec3::new(-1.0, -1.0, 2.0), Vec3::new(1.0, 1.0, 4.0));
        let at = |z: f32| Vec3::new(0.0, 0.0, z);
        assert!(holds(&Region::Above(0.5), at(3.0), whole) && !holds(&Region::Above(0.5), at(2.9), whole));
        assert!(holds(&Region::Below(0.25), at(2.5), whole) && !holds(&Region::Below(0.25), at(2.6), whole));
        let left = Region::HalfSpace(PlaneShape { point_m: [0.5, 0.0, 0.0], normal: [2.0, 0.0, 0.0] });
        assert!(holds(&left, at(0.0), whole) && !holds(&left, Vec3::X, whole));
    }
}
