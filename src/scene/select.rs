//! Which Gaussians belong to an object.

use super::Gaussians;
use crate::spec::{BoxShape, Select, SphereShape};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Indices, rising, of those whose centre (world frame, captured pose) is inside. Borders count as inside. `place` is the
/// place of each in the scene's file, by which ids go.
pub fn select(g_world: &Gaussians, place: &[u32], select: &Select) -> Vec<u32> {
    let ids: BTreeSet<u32> = if let Select::Ids(ids) = select { ids.iter().copied().collect() } else { BTreeSet::new() };
    let inside = |i: usize, p: Vec3| match select {
        Select::All => true,
        Select::Box(shape) => in_box(p, shape),
        Select::Sphere(shape) => in_sphere(p, shape),
        Select::Ids(_) => place.get(i).is_some_and(|place| ids.contains(place)),
    };
    g_world.mean.par_iter().enumerate().filter(|(i, p)| inside(*i, **p)).map(|(i, _)| i as u32).collect()
}

/// Whether a point is in a box, its faces included.
pub fn in_box(p: Vec3, shape: &BoxShape) -> bool {
    let from_centre = (p.as_dvec3() - DVec3::from_array(shape.centre_m)).abs();
    from_centre.cmple(DVec3::from_array(shape.size_m).abs() / 2.0).all()
}

/// Whether a point is in a sphere, its face included.
pub fn in_sphere(p: Vec3, shape: &SphereShape) -> bool {
    p.as_dvec3().distance(DVec3::from_array(shape.centre_m)) <= shape.radius_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_and_spheres_hold_the_centres_inside_them() {
        let g = Gaussians { mean: vec![Vec3::ZERO, Vec3::X, Vec3::new(0.9, 0.9, 0.0)], ..Gaussians::default() };
        let ball = Select::Sphere(SphereShape { centre_m: [0.0; 3], radius_m: 1.0 });
        let cube = Select::Box(BoxShape { centre_m: [0.9, 0.9, 0.0], size_m: [0.1; 3] });
        let place = [7, 3, 5];
        assert_eq!(select(&g, &place, &Select::All), [0, 1, 2]);
        assert_eq!(select(&g, &place, &ball), [0, 1]);
        assert_eq!(select(&g, &place, &cube), [2]);
        assert_eq!(select(&g, &place, &Select::Ids(vec![5, 7, 9])), [0, 2]);
    }
}
