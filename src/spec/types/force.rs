//! What drives objects: accelerations and fields over a span of time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Attractor, Drag, Explosion, Motor, Spring, Vortex, Wind};
use crate::spec::auto::Until;
use crate::spec::limits::{self, length};
use crate::spec::path::NAME_PATTERN;

/// Three numbers, or an expression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Acceleration {
    /// The same everywhere and always.
    Constant([f64; 3]),
    /// The canonical text of an expression that gives a vector.
    Expression(String),
}

/// A force and the fields that it may be, each listed once: its key, its type, and that type's name for the schema.
macro_rules! force {
    ($($(#[$doc:meta])* $key:ident: $Field:ident = $name:literal,)*) => {
        /// Drives one object over a span of time. Exactly one of the ways is given; each acts on every particle by
        /// itself, as an acceleration.
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
            /// An acceleration in the world frame: three numbers, or an expression (see below) such as
            /// `"vec3(6 * sin(3 * t), 0, 0)"`.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(with = "Acceleration", transform = length(limits::ACCELERATION_M_S2))]
            pub acceleration_m_s2: Option<Acceleration>,
            $($(#[$doc])*
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(with = $name)]
            pub $key: Option<$Field>,)*
        }

        /// What a force is: the one of its ways that is given.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(missing_docs, reason = "each is the key of the spec that it is called")]
        pub enum Drive<'a> {
            Constant([f64; 3]),
            Expression(&'a str),
            $($Field(&'a $Field),)*
        }

        impl Force {
            /// The keys of its ways.
            pub const WAYS: &'static [&'static str] = &["acceleration_m_s2", $(stringify!($key)),*];

            /// One without any way to act yet.
            pub fn new(name: &str, object: &str, from_s: f64, to_s: Until) -> Force {
                Force { name: name.to_owned(), object: object.to_owned(), from_s, to_s, acceleration_m_s2: None, $($key: None,)* }
            }

            /// Every way that is given; a valid force has one.
            pub fn drives(&self) -> Vec<Drive<'_>> {
                let acceleration = self.acceleration_m_s2.as_ref().map(|a| match a {
                    Acceleration::Constant(a) => Drive::Constant(*a),
                    Acceleration::Expression(text) => Drive::Expression(text),
                });
                [acceleration, $(self.$key.as_ref().map(Drive::$Field)),*].into_iter().flatten().collect()
            }
        }
    };
}

force! {
    /// Air that moves, and drags particles along: a = drag_per_s (air - v).
    wind: Wind = "Wind",
    /// Resistance of what it moves through: a = -(linear + quadratic |v|) v.
    drag: Drag = "Drag",
    /// Air that circles: at a distance r from the axis it has the speed 2 S s / (1 + s^2), s = r / radius_m. What floats
    /// along stays on its circle.
    vortex: Vortex = "Vortex",
    /// A pull towards a point: a = strength (radius_m / r)^falloff, blunted within a tenth of the radius.
    attractor: Attractor = "Attractor",
    /// A blast at `from_s`, over a hundredth of a second: speed / (1 + (r / radius_m)^2) away from a point.
    explosion: Explosion = "Explosion",
    /// A spring that draws the object, in its captured shape, to a place or along a path:
    /// a = -stiffness (x - goal) - damping (v - velocity of the goal). The goal of each particle is its captured place, moved
    /// so that the object's centre is at `to_m` or on `path_m`: exactly one of them.
    spring: Spring = "Spring",
    /// Drives the speed around an axis towards that of a turning body, and leaves the rest of the motion alone.
    motor: Motor = "Motor",
}

impl Force {
    /// A constant acceleration.
    pub fn constant(name: &str, object: &str, from_s: f64, to_s: Until, acceleration_m_s2: [f64; 3]) -> Force {
        Force { acceleration_m_s2: Some(Acceleration::Constant(acceleration_m_s2)), ..Force::new(name, object, from_s, to_s) }
    }

    /// Its constant acceleration, where it is one.
    pub fn constant_m_s2(&self) -> Option<[f64; 3]> {
        match self.acceleration_m_s2 {
            Some(Acceleration::Constant(a)) => Some(a),
            _ => None,
        }
    }

    /// Makes it a constant acceleration, whatever it was.
    pub fn set_constant(&mut self, acceleration_m_s2: [f64; 3]) {
        *self = Force::constant(&self.name, &self.object, self.from_s, self.to_s, acceleration_m_s2);
    }

    /// How strong it is, and in what unit: an acceleration, a speed, a rate. None of an expression.
    pub fn strength(&self) -> Option<(f64, &'static str)> {
        let length = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        Some(match self.drives().first()? {
            Drive::Constant(a) => (length(a), "m/s²"),
            Drive::Expression(_) => return None,
            Drive::Wind(wind) => (length(&wind.velocity_m_s), "m/s"),
            Drive::Drag(drag) if drag.linear_per_s > 0.0 => (drag.linear_per_s, "/s"),
            Drive::Drag(drag) => (drag.quadratic_per_m, "/m"),
            Drive::Vortex(vortex) => (vortex.speed_m_s, "m/s"),
            Drive::Attractor(attractor) => (attractor.strength_m_s2, "m/s²"),
            Drive::Explosion(explosion) => (explosion.speed_m_s, "m/s"),
            Drive::Spring(spring) => (spring.stiffness_per_s2, "/s²"),
            Drive::Motor(motor) => (motor.speed_rad_s, "rad/s"),
        })
    }

    /// Multiplies its strength; of an expression the whole.
    pub fn scale(&mut self, ratio: f64) {
        match &mut self.acceleration_m_s2 {
            Some(Acceleration::Constant(a)) => *a = a.map(|x| x * ratio),
            Some(Acceleration::Expression(text)) => *text = format!("{} * ({text})", crate::spec::number(ratio)),
            None => {}
        }
        if let Some(wind) = &mut self.wind {
            wind.velocity_m_s = wind.velocity_m_s.map(|x| x * ratio);
        }
        if let Some(drag) = &mut self.drag {
            (drag.linear_per_s, drag.quadratic_per_m) = (drag.linear_per_s * ratio.abs(), drag.quadratic_per_m * ratio.abs());
        }
        let single = [
            self.vortex.as_mut().map(|v| &mut v.speed_m_s),
            self.attractor.as_mut().map(|a| &mut a.strength_m_s2),
            self.explosion.as_mut().map(|e| &mut e.speed_m_s),
            self.motor.as_mut().map(|m| &mut m.speed_rad_s),
        ];
        single.into_iter().flatten().for_each(|strength| *strength *= ratio);
        if let Some(spring) = &mut self.spring {
            spring.stiffness_per_s2 *= ratio.abs();
        }
    }
}
