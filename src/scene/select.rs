//! Which Gaussians belong to an object.

use super::Gaussians;
use crate::spec::{BoxShape, Select, SphereShape};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Indices, rising, of those whose centre (world frame, captured pose) is inside. Borders count as inside.
pub fn select(g_world: &Gaussians, select: &Select) -> Vec<u32> {
    let inside = |p: Vec3| match select {
        Select::All => true,
        Select::Box(shape) => in_box(p, shape),
        Select::Sphere(shape) => in_sphere(p, shape),
    };
    g_world.mean.par_iter().enumerate().filter(|(_, p)| inside(**p)).map(|(i, _)| i as u32).collect()
}

fn in_box(p: Vec3, shape: &BoxShape) -> bool {
    let from_centre = (p.as_dvec3() - DVec3::from_array(shape.centre_m)).abs();
    from_centre.cmple(DVec3::from_array(shape.size_m).abs() / 2.0).all()
}

fn in_sphere(p: Vec3, shape: &SphereShape) -> bool {
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
        assert_eq!(select(&g, &Select::All), [0, 1, 2]);
        assert_eq!(select(&g, &ball), [0, 1]);
        assert_eq!(select(&g, &cube), [2]);
    }
}
