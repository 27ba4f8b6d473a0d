//! What is known of a scene before anything moves: enough to turn "drop it from a metre" into numbers.

use super::Seam;
use crate::spec::{Axis, Camera};

/// A scene and its spec, measured in the captured pose. World frame, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// One entry for each object of the spec, in its order.
    pub objects: Vec<ObjectFacts>,
    /// Of each, the height at which it parts in two: where a bouquet leaves its vase.
    pub seams: Vec<Seam>,
    /// Height of the ground plane.
    pub ground_m: f64,
    /// The camera that the spec resolves to.
    pub camera: Camera,
    /// Whether some Gaussians belong to no object.
    pub has_static: bool,
}

/// One object in the captured pose, floaters pruned, before its offset and rotation.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectFacts {
    /// Its name.
    pub name: String,
    /// How many Gaussians it has.
    pub gaussians: usize,
    /// Smallest corner of the centres.
    pub low_m: [f64; 3],
    /// Largest corner of the centres.
    pub high_m: [f64; 3],
    /// Mean of the centres: near the centre of mass, known without a solid.
    pub centre_m: [f64; 3],
    /// Height of what is below it: the ground, or the top of a collider.
    pub support_m: f64,
    /// Which world axis is its front.
    pub forward: Axis,
}

impl ObjectFacts {
    /// Extent along z.
    pub fn height_m(&self) -> f64 {
        self.high_m[2] - self.low_m[2]
    }
}
