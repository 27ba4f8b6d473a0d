//! The types of a spec. Field names carry their units; doc comments become the reference.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::auto::{Auto, Until};
use super::limits::{self, each, length};
use super::path::NAME_PATTERN;

/// One simulation, whole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "PhysTalk spec")]
pub struct Spec {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = limits::FORMAT))]
    pub format: u32,
    /// Seed of everything random: sampling jitter, dither, expressions.
    #[serde(default = "default_seed")]
    #[schemars(range(max = limits::SEED))]
    pub seed: u64,
    /// The captured scene.
    pub scene: Scene,
    /// How long, how fine in time.
    #[serde(default)]
    pub time: Time,
    /// Gravity and ground.
    #[serde(default)]
    pub world: World,
    /// Resolution of the solver.
    #[serde(default)]
    pub solver: Solver,
    /// The things that move, by name.
    #[schemars(length(min = 1, max = limits::OBJECTS))]
    #[serde(rename = "object")]
    pub objects: Vec<Object>,
    /// What holds parts of objects.
    #[schemars(length(max = limits::ENTRIES))]
    #[serde(default, rename = "pin", skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<Pin>,
    /// What objects collide with, beside the ground.
    #[schemars(length(max = limits::ENTRIES))]
    #[serde(default, rename = "collider", skip_serializing_if = "Vec::is_empty")]
    pub colliders: Vec<Collider>,
    /// Accelerations over a span of time.
    #[schemars(length(max = limits::ENTRIES))]
    #[serde(default, rename = "force", skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<Force>,
    /// What happens at an instant.
    #[schemars(length(max = limits::ENTRIES))]
    #[serde(default, rename = "event", skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<Event>,
    /// How Gaussians follow particles.
    #[serde(default)]
    pub skin: Skin,
    /// From where it is seen.
    #[serde(default)]
    pub camera: Auto<Camera>,
    /// The picture.
    #[serde(default)]
    pub output: Output,
    /// What must hold of the result.
    #[schemars(length(max = limits::ENTRIES))]
    #[serde(default, rename = "expect", skip_serializing_if = "Vec::is_empty")]
    pub expectations: Vec<Expectation>,
}

fn default_seed() -> u64 {
    1
}

/// An axis of the scene's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
pub enum Axis {
    /// +x
    #[serde(rename = "+x")]
    PlusX,
    /// -x
    #[serde(rename = "-x")]
    MinusX,
    /// +y
    #[serde(rename = "+y")]
    PlusY,
    /// -y
    #[serde(rename = "-y")]
    MinusY,
    /// +z
    #[serde(rename = "+z")]
    PlusZ,
    /// -z
    #[serde(rename = "-z")]
    MinusZ,
}

/// Where the Gaussians come from, and how their frame becomes the world's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Path of the splat file, from the spec's folder; `builtin:demo` is the built-in scene.
    pub file: String,
    /// BLAKE3 of the file's bytes, recorded when the spec is made; a file that changed is refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", regex(pattern = "^[0-9a-f]{64}$"))]
    pub blake3: Option<String>,
    /// Which axis of the file points up.
    #[serde(default)]
    pub up: Auto<Axis>,
    /// Metres in one unit of the file.
    #[serde(default = "one")]
    #[schemars(range(min = limits::METRES_PER_UNIT.0, max = limits::METRES_PER_UNIT.1))]
    pub metres_per_unit: f64,
}

fn one() -> f64 {
    1.0
}

/// Length and frame rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Time {
    /// Seconds; `"auto"` is long enough to land and settle by ballistics, 2 to 8.
    #[schemars(extend("minimum" = 0.0, "maximum" = limits::TIME_S))]
    pub duration_s: Auto<f64>,
    /// Frames a second.
    #[schemars(range(min = 1, max = limits::FPS))]
    pub fps: u32,
}

impl Default for Time {
    fn default() -> Self {
        Time { duration_s: Auto::Auto, fps: 50 }
    }
}

/// What acts on everything.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct World {
    /// Acceleration of free fall, world frame.
    #[schemars(transform = length(limits::GRAVITY_M_S2))]
    pub gravity_m_s2: [f64; 3],
    /// The ground plane.
    pub ground: Ground,
}

impl Default for World {
    fn default() -> Self {
        World { gravity_m_s2: [0.0, 0.0, -9.81], ground: Ground::default() }
    }
}

/// A horizontal plane that nothing passes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Ground {
    /// Height of the plane; `"auto"` is the lowest centre of all objects' Gaussians as captured.
    #[schemars(extend("minimum" = -limits::PLACE_M, "maximum" = limits::PLACE_M))]
    pub height_m: Auto<f64>,
    /// Coulomb coefficient.
    #[schemars(range(min = 0.0, max = limits::FRICTION))]
    pub friction: f64,
    /// Share of the approaching speed that is given back, 0 to 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub restitution: f64,
}

impl Default for Ground {
    fn default() -> Self {
        Ground { height_m: Auto::Auto, friction: 0.15, restitution: 0.0 }
    }
}

/// Resolution of the solver. Its substep is its own affair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// Grid cells along the longest side of the objects; `"auto"` follows the quality.
    #[schemars(extend("minimum" = limits::CELLS_ACROSS.0, "maximum" = limits::CELLS_ACROSS.1))]
    pub cells_across: Auto<u32>,
}

/// An axis-aligned box, world frame; what it picks of an object it picks in the captured pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxShape {
    /// Its centre.
    #[schemars(transform = length(limits::PLACE_M))]
    pub centre_m: [f64; 3],
    /// Its whole edge lengths.
    #[schemars(transform = each(limits::SIZE_M.0, limits::SIZE_M.1))]
    pub size_m: [f64; 3],
}

/// A sphere, world frame; what it picks of an object it picks in the captured pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereShape {
    /// Its centre.
    #[schemars(transform = length(limits::PLACE_M))]
    pub centre_m: [f64; 3],
    /// Its radius.
    #[schemars(range(min = limits::SIZE_M.0, max = limits::SIZE_M.1))]
    pub radius_m: f64,
}

/// A half-space: everything behind a plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneShape {
    /// A point of the plane.
    #[schemars(transform = length(limits::PLACE_M))]
    pub point_m: [f64; 3],
    /// Points out of the solid side; need not be of unit length.
    pub normal: [f64; 3],
}

/// Which Gaussians belong to an object: those whose centres are inside.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Select {
    /// Every Gaussian of the scene.
    #[default]
    All,
    /// Those in a box.
    Box(BoxShape),
    /// Those in a sphere.
    Sphere(SphereShape),
}

/// How Gaussians become a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProxyKind {
    /// Occupied voxels: concave things stay concave.
    #[default]
    Voxel,
    /// The convex hull of the pruned centres, as in the paper.
    Hull,
}

/// What the captured pose means for the solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Rest {
    /// It stands as captured: its prestress is solved first.
    #[default]
    AsCaptured,
    /// The captured pose is free of stress.
    StressFree,
}

/// A thing that moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Object {
    /// Its name, `[a-z0-9_-]+`, unique; the scene file's name up to its first dot where none is given.
    #[serde(default)]
    #[schemars(regex(pattern = NAME_PATTERN), transform = limits::no_default)]
    pub name: String,
    /// Its Gaussians.
    #[serde(default)]
    pub select: Select,
    /// How they become a solid.
    #[serde(default)]
    pub proxy: ProxyKind,
    /// What it is made of.
    #[serde(default)]
    pub material: Material,
    /// Moved by this before t = 0, after the rotation.
    #[serde(default)]
    #[schemars(transform = length(limits::PLACE_M))]
    pub offset_m: [f64; 3],
    /// Turned about fixed x, then y, then z, through the captured centre of mass.
    #[serde(default)]
    #[schemars(transform = each(-limits::ROTATE_DEG, limits::ROTATE_DEG))]
    pub rotate_deg: [f64; 3],
    /// What the captured pose means.
    #[serde(default)]
    pub rest: Rest,
    /// Velocity at t = 0.
    #[serde(default)]
    #[schemars(transform = length(limits::SPEED_M_S))]
    pub velocity_m_s: [f64; 3],
    /// Angular velocity at t = 0 about the centre of mass.
    #[serde(default)]
    #[schemars(transform = length(limits::SPIN_RAD_S))]
    pub spin_rad_s: [f64; 3],
    /// Which world axis is the object's front.
    #[serde(default = "plus_x")]
    pub forward: Axis,
}

fn plus_x() -> Axis {
    Axis::PlusX
}

impl Object {
    /// An elastic object of all Gaussians, at rest.
    pub fn new(name: &str) -> Object {
        Object {
            name: name.to_owned(),
            select: Select::All,
            proxy: ProxyKind::Voxel,
            material: Material::default(),
            offset_m: [0.0; 3],
            rotate_deg: [0.0; 3],
            rest: Rest::AsCaptured,
            velocity_m_s: [0.0; 3],
            spin_rad_s: [0.0; 3],
            forward: Axis::PlusX,
        }
    }
}

/// Hyperelastic energy of an elastic material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElasticModel {
    /// Fixed corotated: tau = 2 mu (F - R) F^T + lambda J (J - 1) I.
    #[default]
    Corotated,
    /// Neo-Hookean: tau = mu (F F^T - I) + lambda ln J I.
    NeoHookean,
}

/// What an object is made of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Material {
    /// Returns to its shape.
    Elastic(Elastic),
}

impl Default for Material {
    fn default() -> Self {
        Material::Elastic(Elastic::default())
    }
}

/// Parameters of an elastic solid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Elastic {
    /// Young's modulus E; `"auto"` is four times the self-buckling bound of the most slender part.
    #[schemars(extend("minimum" = limits::YOUNG_PA.0, "maximum" = limits::YOUNG_PA.1))]
    pub young_pa: Auto<f64>,
    /// Poisson's ratio nu.
    #[schemars(range(min = 0.0, max = limits::POISSON))]
    pub poisson: f64,
    /// Mass density rho.
    #[schemars(range(min = limits::DENSITY_KG_M3.0, max = limits::DENSITY_KG_M3.1))]
    pub density_kg_m3: f64,
    /// The energy.
    pub model: ElasticModel,
}

impl Default for Elastic {
    fn default() -> Self {
        Elastic { young_pa: Auto::Auto, poisson: 0.3, density_kg_m3: 1000.0, model: ElasticModel::Corotated }
    }
}

/// A part of an object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Region {
    /// Above this fraction of the object's height.
    Above(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// Below this fraction of the object's height.
    Below(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// In a box.
    Box(BoxShape),
    /// In a sphere.
    Sphere(SphereShape),
    /// Behind a plane.
    HalfSpace(PlaneShape),
}

/// Holds part of an object still.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pin {
    /// Its name, unique among pins.
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// The object it holds.
    pub object: String,
    /// Which part.
    pub region: Region,
    /// From when.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = limits::TIME_S))]
    pub from_s: f64,
    /// Until when.
    #[serde(default)]
    #[schemars(extend("minimum" = 0.0, "maximum" = limits::TIME_S))]
    pub to_s: Until,
}

/// The shape of a static collider, world metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ColliderShape {
    /// A box.
    Box(BoxShape),
    /// A sphere.
    Sphere(SphereShape),
    /// A half-space.
    Plane(PlaneShape),
}

/// A static thing that objects collide with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Collider {
    /// Its name, unique among colliders.
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// Where it is solid.
    pub shape: ColliderShape,
    /// Coulomb coefficient.
    #[serde(default = "default_friction")]
    #[schemars(range(min = 0.0, max = limits::FRICTION))]
    pub friction: f64,
    /// Share of the approaching speed that is given back, 0 to 1.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub restitution: f64,
}

fn default_friction() -> f64 {
    0.3
}

/// An acceleration of one object over a span of time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Force {
    /// Its name, unique among forces.
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// The object it moves.
    pub object: String,
    /// From when.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = limits::TIME_S))]
    pub from_s: f64,
    /// Until when.
    #[serde(default)]
    #[schemars(extend("minimum" = 0.0, "maximum" = limits::TIME_S))]
    pub to_s: Until,
    /// World frame.
    #[schemars(transform = length(limits::ACCELERATION_M_S2))]
    pub acceleration_m_s2: [f64; 3],
}

/// Something that happens at an instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Its name, unique among events; `event1`, `event2`, … where none is given.
    #[serde(default)]
    #[schemars(regex(pattern = NAME_PATTERN), transform = limits::no_default)]
    pub name: String,
    /// When.
    #[schemars(range(min = 0.0, max = limits::TIME_S))]
    pub at_s: f64,
    /// To which object.
    pub object: String,
    /// Added to the velocity of all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", transform = length(limits::SPEED_M_S))]
    pub push_m_s: Option<[f64; 3]>,
    /// Replaces the velocity of all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", transform = length(limits::SPEED_M_S))]
    pub velocity_m_s: Option<[f64; 3]>,
}

/// Skinning weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Weights {
    /// Exact under any affine motion.
    #[default]
    Exact,
    /// The paper's equations as printed.
    Paper,
}

/// How Gaussians follow particles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Skin {
    /// How many particles each Gaussian follows, 1 to 16.
    #[schemars(range(min = 1, max = limits::NEIGHBOURS))]
    pub neighbours: u32,
    /// How they are weighted.
    pub weights: Weights,
}

impl Default for Skin {
    fn default() -> Self {
        Skin { neighbours: 8, weights: Weights::Exact }
    }
}

/// A camera in the world's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Where it stands.
    #[schemars(transform = length(limits::PLACE_M))]
    pub eye_m: [f64; 3],
    /// What it looks at.
    #[schemars(transform = length(limits::PLACE_M))]
    pub target_m: [f64; 3],
    /// Vertical field of view.
    #[serde(default = "default_fov")]
    #[schemars(range(min = limits::FOV_DEG.0, max = limits::FOV_DEG.1))]
    pub fov_deg: f64,
    /// Turns about the vertical through the target; counter-clockwise seen from above.
    #[serde(default)]
    #[schemars(range(min = -limits::ORBIT_DEG_S, max = limits::ORBIT_DEG_S))]
    pub orbit_deg_s: f64,
}

fn default_fov() -> f64 {
    45.0
}

/// The picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Width and height in pixels; `"auto"` is 1280 x 720, in draft 640 x 360.
    #[schemars(transform = each(limits::PICTURE.0, limits::PICTURE.1))]
    pub size: Auto<[u32; 2]>,
    /// `#rrggbb`, sRGB.
    #[schemars(regex(pattern = limits::COLOUR_PATTERN))]
    pub background: String,
}

impl Default for Output {
    fn default() -> Self {
        Output { size: Auto::Auto, background: "#eaeaf2".to_owned() }
    }
}

/// What must hold of the result, such as `vase.apex_m > 0.3`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// The condition.
    pub that: String,
}
