//! The built-in scene: a glazed vase of flowers on a wooden table on a tiled floor, made from a seed.
//!
//! Surfaces are covered with flat dabs ([`dab`]), lit by a room with a large window past what stands
//! in the way ([`light`], [`shade`]), and what each dab sends to each side is kept as spherical
//! harmonics. The vase casts no shadow on the table: the picture adds one that moves with it.

mod bouquet;
mod dab;
mod light;
mod petal;
mod random;
mod shade;
mod table;
mod vase;

use super::Gaussians;
use crate::spec::{Auto, Axis, BoxShape, Collider, ColliderShape, Ground, Object, Scene, Select, Spec, World};
use glam::Vec3;
use shade::{Boxes, Fog};

/// The name that `scene.file` has for it.
pub const FILE: &str = "builtin:demo";

/// The vase and its flowers are modelled smaller than they stand here.
const SIZE: f32 = 1.12;

/// What it is made of; world frame, z up, metres, floor at 0. The same seed gives the same Gaussians.
pub fn gaussians(seed: u64) -> Gaussians {
    let foot = Vec3::Z * table::TOP_M;
    let mut standing = vase::vase(seed, foot);
    standing.extend(bouquet::bouquet(seed, foot));
    for dab in &mut standing {
        dab.centre = foot + (dab.centre - foot) * SIZE;
        dab.sigma *= SIZE;
    }
    let mut g = Gaussians { sh_degree: 3, ..Gaussians::default() };
    light::bake(&standing, &Fog::of(&standing), &mut g);
    let mut around = table::table(seed);
    around.extend(table::floor(seed));
    light::bake(&around, &Boxes(table::solids()), &mut g);
    g
}

/// The simulation that the demo starts from: the vase stands on the table, table and floor are solid.
pub fn spec() -> Spec {
    let [low, high] = table::solids()[0].map(|p| p.as_dvec3());
    // From a hair above the dabs of the table's face to well above the highest flower.
    let over_table = BoxShape { centre_m: [0.0, 0.0, high.z - 4e-4 + 0.5], size_m: [1.0, 1.0, 1.0] };
    let top = BoxShape { centre_m: ((low + high) / 2.0).to_array(), size_m: (high - low).to_array() };
    Spec {
        format: 1,
        seed: 1,
        scene: Scene { file: FILE.to_owned(), blake3: None, up: Auto::Value(Axis::PlusZ), metres_per_unit: 1.0 },
        time: Default::default(),
        world: World { ground: Ground { height_m: Auto::Value(0.0), ..Ground::default() }, ..World::default() },
        solver: Default::default(),
        objects: vec![Object { select: Select::Box(over_table), ..Object::new("vase") }],
        pins: Vec::new(),
        colliders: vec![Collider { name: "table".to_owned(), shape: ColliderShape::Box(top), friction: 0.4, restitution: 0.0 }],
        forces: Vec::new(),
        events: Vec::new(),
        skin: Default::default(),
        // Frames the vase's predicted path, and again where a later turn leaves the picture.
        camera: Auto::Auto,
        output: Default::default(),
        expectations: Vec::new(),
    }
}

#[cfg(test)]
mod tests;
