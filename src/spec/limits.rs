//! What values a spec may hold. The JSON Schema carries these numbers, and reading checks against
//! the schema, so that documentation, schema and reader cannot disagree.

use schemars::Schema;
use serde_json::{Value, json};

/// The newest format that this program reads.
pub const FORMAT: u32 = 1;
/// Largest seed: the largest whole number that every JSON reader keeps exactly.
pub const SEED: u64 = (1 << 53) - 1;
/// Objects in one spec.
pub const OBJECTS: u32 = 64;
/// Pins, forces, events and expectations, each.
pub const ENTRIES: u32 = 256;
/// Colliders: with the ground, as many as a mark on the grid tells apart.
pub const COLLIDERS: u32 = 126;
/// Rigid objects and rigid parts together, whether they start so or become so.
pub const RIGID: u32 = 128;
/// Length of a name.
pub const NAME: usize = 64;
/// Scale of a scene: from files in picometres to files in thousands of astronomical units. `world::check_scale` bounds the product.
pub const METRES_PER_UNIT: (f64, f64) = (1e-12, 1e12);
/// Longest simulation and latest event.
pub const TIME_S: f64 = 600.0;
/// Frames a second.
pub const FPS: u32 = 1000;
/// Magnitude of gravity: forty times Jupiter's.
pub const GRAVITY_M_S2: f64 = 1e3;
/// Magnitude of a force's acceleration.
pub const ACCELERATION_M_S2: f64 = 1e4;
/// How fast a drag or a motor acts: beyond a microsecond it is at once.
pub const RATE_PER_S: f64 = 1e6;
/// Of a spring.
pub const STIFFNESS_PER_S2: f64 = 1e9;
/// Points of a path.
pub const PATH: u32 = 32;
/// Points of the path of a pin: some rounds of a curve.
pub const PIN_PATH: u32 = 256;
/// Steps of all expressions of a spec together.
pub const EXPRESSION_STEPS: usize = 8192;
/// Magnitude of a velocity: beyond it a step of the solver crosses a cell.
pub const SPEED_M_S: f64 = 200.0;
/// Magnitude of a spin, about 160 turns a second.
pub const SPIN_RAD_S: f64 = 1e3;
/// Distance of anything from the origin: beyond it f32 is coarser than a centimetre.
pub const PLACE_M: f64 = 1e5;
/// Edge lengths and radii.
pub const SIZE_M: (f64, f64) = (1e-6, 1e5);
/// Rotation before the start, a hundred turns.
pub const ROTATE_DEG: f64 = 36e3;
/// Coulomb coefficient.
pub const FRICTION: f64 = 10.0;
/// Young's modulus, from a weak gel to a diamond.
pub const YOUNG_PA: (f64, f64) = (1e2, 1e12);
/// Poisson's ratio: explicit steps cannot follow the volume waves of 0.5.
pub const POISSON: f64 = 0.49;
/// Density, from the air to osmium.
pub const DENSITY_KG_M3: (f64, f64) = (1.0, 2e4);
/// Yield stress, cohesion, and hardening of either sign: none to a diamond's.
pub const STRENGTH_PA: f64 = 1e12;
/// Viscosity: pitch is a hundred times as thick as this, lava a thousandth.
pub const VISCOSITY_PA_S: f64 = 1e6;
/// Surface tension: two thousand times that of mercury.
pub const SURFACE_TENSION_N_M: f64 = 1e3;
/// Angle of internal friction: gravel has 45, and none stands as steep as this.
pub const FRICTION_ANGLE_DEG: (f64, f64) = (1.0, 80.0);
/// Stretch and compression at which snow gives way.
pub const SNOW_STRETCH: (f64, f64) = (1e-4, 0.9);
/// Hardening of snow: beyond it packed snow is stiffer than any step resolves.
pub const SNOW_HARDENING: f64 = 20.0;
/// Period of a muscle that swings.
pub const PERIOD_S: (f64, f64) = (1e-2, TIME_S);
/// What an event may multiply the strength by.
pub const WEAKEN: (f64, f64) = (1e-6, 1.0);
/// Parts of one object.
pub const PARTS: u32 = 64;
/// Gaussians that are picked one by one.
pub const IDS: u32 = 100_000;
/// Grid cells along the longest side.
pub const CELLS_ACROSS: (u32, u32) = (4, 1024);
/// Particles that a Gaussian follows.
pub const NEIGHBOURS: u32 = 16;
/// Substeps of a frame for the sake of stiffness.
pub const SUBSTEPS: (u32, u32) = (20, 100_000);
/// Vertical field of view.
pub const FOV_DEG: (f64, f64) = (1.0, 170.0);
/// Rate of a camera's orbit.
pub const ORBIT_DEG_S: f64 = 3600.0;
/// Width and height of a picture, pixels.
pub const PICTURE: (u32, u32) = (16, 8192);
/// What the schema says of a colour.
pub(super) const COLOUR_PATTERN: &str = "^#[0-9a-fA-F]{6}$";
/// Longest text of a spec that is read, bytes.
pub const TEXT_BYTES: u64 = 1 << 20;

/// Key that our schemas carry for vectors: the largest Euclidean length. Validators that do not
/// know it still see the same bound on each component.
pub const MAX_NORM: &str = "x-maxNorm";

/// Bounds the Euclidean length of a vector.
pub(super) fn length(limit: f64) -> impl FnMut(&mut Schema) {
    move |schema| {
        bound_items(schema, json!(-limit), json!(limit));
        schema.insert(MAX_NORM.to_owned(), json!(limit));
    }
}

/// Bounds each component of a vector.
pub(super) fn each<T: Into<Value>>(low: T, high: T) -> impl FnMut(&mut Schema) {
    let (low, high): (Value, Value) = (low.into(), high.into());
    move |schema| bound_items(schema, low.clone(), high.clone())
}

/// Leaves a default out of the schema: it stands for something that is not there, or that the reader makes up.
pub(super) fn no_default(schema: &mut Schema) {
    schema.remove("default");
}

/// Sets the bounds of the items of an array, which may be one of several alternatives.
fn bound_items(schema: &mut Schema, low: Value, high: Value) {
    fn array_in(schema: &mut serde_json::Map<String, Value>) -> Option<&mut Value> {
        if schema.contains_key("items") {
            return schema.get_mut("items");
        }
        let alternatives = schema.get_mut("anyOf")?.as_array_mut()?;
        alternatives.iter_mut().filter_map(Value::as_object_mut).find_map(array_in)
    }
    if let Some(items) = schema.as_object_mut().and_then(array_in) {
        items["minimum"] = low;
        items["maximum"] = high;
    }
}
