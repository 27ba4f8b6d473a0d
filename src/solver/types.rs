//! What the solver is given and what it answers.

use super::constants::CFL;
use super::substance::Substance;
use crate::gpu::GpuError;
use crate::spec::ColliderShape;
use crate::spec::expression::Program;
use glam::{DVec3, Quat, Vec3};
use std::collections::BTreeMap;

/// The particles of all objects, as sampled: the captured pose, free of stress. World frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    /// Metres.
    pub position_m: Vec<Vec3>,
    /// Metres a second.
    pub velocity_m_s: Vec<Vec3>,
    /// Volume that each stands for when free of stress.
    pub volume_m3: Vec<f32>,
    /// Mass over that volume.
    pub density_kg_m3: Vec<f32>,
    /// Young's modulus E; of a liquid, which has none, the bulk modulus.
    pub young_pa: Vec<f32>,
    /// Poisson's ratio, above -1 and below 0.5; means nothing for a liquid.
    pub poisson: Vec<f32>,
    /// Row of `substances` that each is made of.
    pub substance: Vec<u16>,
    /// The table of them.
    pub substances: Vec<Substance>,
    /// Index of the object that each belongs to, from 0.
    pub object: Vec<u32>,
}

impl Particles {
    /// How many.
    pub fn len(&self) -> usize {
        self.position_m.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.position_m.is_empty()
    }

    /// Lamé's two moduli (mu, lambda) of one particle, in pascals.
    pub fn lame_pa(&self, index: usize) -> (f32, f32) {
        let (e, nu) = (self.young_pa[index], self.poisson[index]);
        if self.substances.get(usize::from(self.substance[index])).is_some_and(Substance::is_liquid) {
            return (0.0, e);
        }
        (e / (2.0 * (1.0 + nu)), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)))
    }
}

/// A horizontal plane that nothing passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Height.
    pub height_m: f32,
    /// Coulomb coefficient.
    pub friction: f32,
    /// Share of the approaching speed that is given back, 0 to 1.
    pub restitution: f32,
}

/// A static solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider {
    /// Where it is solid, world metres.
    pub shape: ColliderShape,
    /// Coulomb coefficient.
    pub friction: f32,
    /// Share of the approaching speed that is given back, 0 to 1.
    pub restitution: f32,
}

/// Holds the part of an object that lies in a shape, within its box: still, or along a path. Shape and box are of the
/// captured pose; what is held is held where it is when the pin begins. Where several soft objects share a layer of the grid,
/// all of them are held that come there.
#[derive(Clone, Debug, PartialEq)]
pub struct PinRegion {
    /// Index of the object.
    pub object: u32,
    /// Inside a box, sphere or capsule, behind a plane.
    pub shape: ColliderShape,
    /// Lowest corner of the object's captured bounds.
    pub low_m: Vec3,
    /// Highest corner of them.
    pub high_m: Vec3,
    /// From when, seconds.
    pub from_s: f64,
    /// Until when; infinite for a pin that lasts.
    pub to_s: f64,
    /// Where it has been taken, straight from point to point: seconds, then metres from where it began.
    /// Times rise from `from_s` on; after the last it stands still.
    pub path: Vec<[f64; 4]>,
}

impl PinRegion {
    /// Every time at which it begins, ends, or changes its velocity.
    pub(super) fn times_s(&self) -> impl Iterator<Item = f64> {
        [self.from_s, self.to_s].into_iter().chain(self.path.iter().map(|p| p[0]))
    }

    /// How far it has been taken at a time, and its velocity from then on.
    pub(super) fn motion(&self, time_s: f64) -> (DVec3, DVec3) {
        let at = |p: &[f64; 4]| (p[0], DVec3::new(p[1], p[2], p[3]));
        let mut from = (self.from_s, DVec3::ZERO);
        for to in self.path.iter().map(at) {
            if time_s < to.0 {
                let velocity = (to.1 - from.1) / (to.0 - from.0);
                return (from.1 + velocity * (time_s - from.0).max(0.0), velocity);
            }
            from = to;
        }
        (from.1, DVec3::ZERO)
    }
}

/// A constant acceleration of one object over a span of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectForce {
    /// Index of the object.
    pub object: u32,
    /// From when, seconds.
    pub from_s: f64,
    /// Until when; infinite for one that lasts.
    pub to_s: f64,
    /// World frame.
    pub acceleration_m_s2: Vec3,
}

/// An acceleration of one object by an expression, over a span of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// As reports call it.
    pub name: String,
    /// Index of the object.
    pub object: u32,
    /// From when, seconds.
    pub from_s: f64,
    /// Until when; infinite for one that lasts.
    pub to_s: f64,
    /// m/s^2 in the world frame: three results.
    pub acceleration: Program,
}

/// What surrounds the particles, and how finely they are solved.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Edge of a grid cell.
    pub cell_m: f32,
    /// Acceleration of free fall.
    pub gravity_m_s2: Vec3,
    /// The ground, where there is one.
    pub ground: Option<Plane>,
    /// Static solids beside it.
    pub colliders: Vec<Collider>,
    /// What is held.
    pub pins: Vec<PinRegion>,
    /// What is driven.
    pub forces: Vec<ObjectForce>,
    /// What is driven by expressions.
    pub fields: Vec<Field>,
    /// Coulomb coefficient of each object against other soft ones, by index; between two the root of the product of theirs
    /// counts, beside a body or a collider its alone. Where the list ends, that of what the object is made of; a spec gives none.
    pub(crate) frictions: Vec<f32>,
    /// Objects that touch stick together: what is one body, driven in parts, as only validation does. Else they meet with friction.
    pub(crate) glued: bool,
    /// Length of a frame. Substeps are equal parts of it, so that an event inside a frame changes
    /// nothing before itself.
    pub frame_s: f64,
    /// Of the dither.
    pub seed: u64,
    /// Substeps that a fiftieth of a second, or a shorter frame, may take for the sake of stiffness.
    pub substeps_most: u32,
    /// Cells that what is fastest may go in a substep: dt <= cfl cell / (c + |v|), c from `step_modulus` in `substance.wgsl`.
    pub cfl: f32,
}

impl Settings {
    /// Nothing around, earth's gravity, 50 frames a second.
    pub fn new(cell_m: f32) -> Settings {
        Settings {
            cell_m,
            gravity_m_s2: Vec3::new(0.0, 0.0, -9.81),
            ground: None,
            colliders: Vec::new(),
            pins: Vec::new(),
            forces: Vec::new(),
            fields: Vec::new(),
            frictions: Vec::new(),
            glued: false,
            frame_s: 0.02,
            seed: 1,
            substeps_most: 4000,
            cfl: CFL,
        }
    }
}

/// Where an object starts: x' = rotation (x - centre) + centre + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// About `centre_m`.
    pub rotation: Quat,
    /// Of mass, in the captured pose.
    pub centre_m: Vec3,
    /// After the rotation.
    pub offset_m: Vec3,
    /// Of the centre.
    pub velocity_m_s: Vec3,
    /// About the moved centre, world frame.
    pub spin_rad_s: Vec3,
}

impl Placement {
    /// Whether nothing is moved.
    pub(super) fn is_captured(&self) -> bool {
        self.rotation.is_near_identity() && self.offset_m == Vec3::ZERO
    }
}

/// What can ask for more substeps than a frame may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taut {
    /// Young's modulus, pascals.
    Stiffness,
    /// Surface tension, newtons a metre.
    SurfaceTension,
    /// How many times as stiff what is packed becomes.
    Hardening,
}

/// An object that could only be kept stable with a smaller modulus, surface tension or hardening.
#[derive(Clone, Debug, PartialEq)]
pub struct Softened {
    /// Index of the object.
    pub object: u32,
    /// What of it was lowered.
    pub what: Taut,
    /// It was multiplied by this, or by no less than this where parts differ.
    pub factor: f32,
    /// The largest that was given up then has this value now, in its unit.
    pub value: f32,
    /// When.
    pub time_s: f64,
    /// Why.
    pub reason: String,
}

/// What of an object flew farther apart than the grid holds, and is no longer followed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Left {
    /// How many particles.
    pub particles: u64,
    /// How far from the rest the farthest was when it was left.
    pub away_m: f32,
}

/// How an advance went.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Advance {
    /// Whether it was stopped; time then stands at the last boundary that was reached whole.
    pub stopped: bool,
    /// Substeps kept.
    pub substeps: u64,
    /// Shortest of them, seconds; 0 where there were none.
    pub dt_min_s: f64,
    /// Longest of them.
    pub dt_max_s: f64,
    /// Segments that were rolled back and run again.
    pub retries: u32,
    /// Objects that were softened.
    pub softened: Vec<Softened>,
    /// The speed at which something was held, the fastest that substeps follow; 0 where nothing was.
    pub held_m_s: f32,
    /// Fields that gave no number, and how often, counted by particle and substep. It counted as zero.
    pub undefined: Vec<(String, u64)>,
    /// How often a field would have brought a particle beyond 200 m/s, where it was held.
    pub limited: u64,
    /// How often particles of an object lost their strain, or their speed, as the last resort.
    pub mended: BTreeMap<u32, u64>,
    /// What was left behind, by object.
    pub left: BTreeMap<u32, Left>,
    /// Whether a rigid body touched more things at one time than the dozen that are followed from its side: the deepest counted.
    pub unmet: bool,
}

/// How far the search for the captured pose's prestress came.
#[derive(Clone, Debug, PartialEq)]
pub struct PrestressReport {
    /// Whether the residual fell below the aim.
    pub converged: bool,
    /// Force left over as a share of weight, both root mean square over the grid's mass.
    pub residual: f32,
    /// Rounds of relaxation.
    pub iterations: u32,
    /// Objects that nothing carries as captured, and how high they hang over what is below them, metres: they are taken as
    /// free of stress.
    pub hanging: Vec<(u32, f32)>,
    /// What else a user should know.
    pub warnings: Vec<String>,
}

/// Why a solver could not be made or go on.
#[derive(Debug, thiserror::Error)]
pub enum SolverError {
    /// The device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// An argument that no caller within the schema gives.
    #[error("the solver was given {what}: expected {expected}")]
    Input {
        /// What is wrong.
        what: String,
        /// What would be right.
        expected: String,
    },
    /// The grid would not fit.
    #[error(
        "the objects spread over {extent_m:.1?} m, and cells of {cell_m} m would need {nodes} grid nodes, of which the device holds {allowed}; \
         use a smaller solver.cells_across, a shorter time.duration_s or slower pushes"
    )]
    TooWide {
        /// Extent of all particles and the room around them.
        extent_m: [f32; 3],
        /// Cell size.
        cell_m: f32,
        /// Nodes needed.
        nodes: u64,
        /// Nodes allowed.
        allowed: u64,
    },
    /// More particles than one dispatch reaches.
    #[error("the objects have {count} particles, of which one pass reaches {allowed}; use a smaller solver.cells_across")]
    TooMany {
        /// How many there are.
        count: u64,
        /// How many there may be.
        allowed: u64,
    },
    /// The lattice has no node there.
    #[error(
        "something is more than {allowed_m:.1e} m from the origin, where places are too coarse for cells of {cell_m:.1e} m; place it nearer, or use a \
         smaller solver.cells_across"
    )]
    TooFar {
        /// Cell size.
        cell_m: f32,
        /// How far it may be.
        allowed_m: f32,
    },
    /// More substeps than anyone waits for.
    #[error(
        "a frame at {time_s:.3} s would take {substeps} substeps: something moves at {speed_m_s:.1} m/s through cells of {cell_m:.1e} m; \
         lower the speeds, use a smaller solver.cells_across or a higher time.fps"
    )]
    TooFast {
        /// When.
        time_s: f64,
        /// Fastest particle.
        speed_m_s: f32,
        /// Cell size.
        cell_m: f32,
        /// Substeps needed.
        substeps: u32,
    },
    /// No remedy leads to a substep that holds.
    #[error(
        "the simulation makes no progress at {time_s:.4} s: {retries} retries in this frame with smaller substeps and softer materials, and {given_up} \
         segments in a row given up; the last try failed because {reason}; use slower motion, softer materials, fewer solver.cells_across, or \
         scene.metres_per_unit where the scene is not in metres (`phystalk scene info` prints its bounds)"
    )]
    NoProgress {
        /// When.
        time_s: f64,
        /// Failed tries of the frame.
        retries: u32,
        /// Segments in a row in which no substep held.
        given_up: u32,
        /// Why the last try failed.
        reason: String,
    },
    /// Bytes that are no checkpoint of this solver.
    #[error("a checkpoint does not fit: {what}; delete it, and the run starts anew")]
    Checkpoint {
        /// In which way.
        what: String,
    },
}
