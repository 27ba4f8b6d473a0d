//! Every force as an expression: wind, drag, springs and the rest are texts of our own with their numbers
//! filled in, so that one mechanism moves them all.

use super::expression::{Fault, Kind, Parameter, Program, parse, parse_with};
use super::{Attractor, Auto, Drag, Drive, Explosion, Force, Motor, Spring, Until, Vortex, Wind};

/// How long a blast takes, seconds.
const BLAST_S: f64 = 0.01;

/// What the numbers of a field may depend on beside the spec's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldFacts {
    /// Centre of the object in the captured pose, metres, world frame.
    pub captured_m: [f64; 3],
    /// Its centre where it starts.
    pub start_m: [f64; 3],
    /// The spec's seed, for gusts.
    pub seed: u64,
}

impl Force {
    /// Until when it acts, seconds.
    pub fn ends_s(&self) -> f64 {
        let end = match self.to_s {
            Until::End => f64::INFINITY,
            Until::Time(time_s) => time_s,
        };
        if self.explosion.is_some() { end.min(self.from_s + BLAST_S) } else { end }
    }

    /// Its steps; none where it is a constant acceleration.
    pub fn program(&self, facts: &FieldFacts) -> Result<Option<Program>, Fault> {
        let Some(drive) = self.drives().first().copied() else { return Ok(None) };
        let tree = match drive {
            Drive::Constant(_) => return Ok(None),
            Drive::Expression(text) => parse(text, Kind::Vector)?,
            Drive::Wind(wind) => wind_of(wind, facts)?,
            Drive::Drag(drag) => drag_of(drag)?,
            Drive::Vortex(vortex) => vortex_of(vortex, facts)?,
            Drive::Attractor(attractor) => attractor_of(attractor, facts)?,
            Drive::Explosion(explosion) => explosion_of(explosion, facts)?,
            Drive::Spring(spring) => spring_of(spring, facts)?,
            Drive::Motor(motor) => motor_of(motor, facts)?,
        };
        Program::of(&tree).map(Some)
    }
}

type Made = Result<super::expression::Tree, Fault>;

const fn s(value: f64) -> Parameter {
    Parameter::Scalar(value)
}

const fn v(value: [f64; 3]) -> Parameter {
    Parameter::Vector(value)
}

fn made(text: &str, parameters: &[(&str, Parameter)]) -> Made {
    parse_with(text, Kind::Vector, parameters)
}

fn centre(given: Auto<[f64; 3]>, facts: &FieldFacts) -> Parameter {
    v(given.unwrap_or(facts.start_m))
}

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// At length 1; a valid axis has a direction.
fn unit(axis: [f64; 3]) -> Parameter {
    let size = length(axis).max(f64::MIN_POSITIVE);
    v(axis.map(|a| a / size))
}

/// Gusts pass in about a second, all over; eddies travel with the air.
fn wind_of(wind: &Wind, facts: &FieldFacts) -> Made {
    // Places in the noise that seeds do not share.
    let phase = (facts.seed % 9973) as f64 * 17.31;
    let air = if wind.gust > 0.0 { "u * (1 + gust * noise(t + phase))" } else { "u" };
    let eddies = if wind.turbulence > 0.0 {
        "swirl * vec3(noise((x - u * t) / eddy + phase), noise((x - u * t) / eddy + phase + 57.7), noise((x - u * t) / eddy + phase + 113.1))"
    } else {
        "vec3(0)"
    };
    let parameters = [
        ("rate", s(wind.drag_per_s)),
        ("u", v(wind.velocity_m_s)),
        ("gust", s(wind.gust)),
        ("phase", s(phase)),
        ("swirl", s(wind.turbulence * length(wind.velocity_m_s))),
        ("eddy", s(wind.eddy_m)),
    ];
    made(&format!("rate * ({air} + {eddies} - v)"), &parameters)
}

fn drag_of(drag: &Drag) -> Made {
    made("-(linear + quadratic * length(v)) * v", &[("linear", s(drag.linear_per_s)), ("quadratic", s(drag.quadratic_per_m))])
}

/// The swirl's own angular velocity W carries round what floats along: a = rate (air - v) - W^2 r.
fn vortex_of(vortex: &Vortex, facts: &FieldFacts) -> Made {
    let r = "((x - c) - axis * dot(x - c, axis))";
    let w = format!("(twice * radius / (radius * radius + dot({r}, {r})))");
    let parameters = [
        ("c", centre(vortex.centre_m, facts)),
        ("axis", unit(vortex.axis)),
        ("twice", s(2.0 * vortex.speed_m_s)),
        ("radius", s(vortex.radius_m)),
        ("lift", s(vortex.lift_m_s)),
        ("rate", s(vortex.drag_per_s)),
    ];
    made(&format!("rate * ({w} * cross(axis, {r}) + lift * axis - v) - {w} * {w} * {r}"), &parameters)
}

fn attractor_of(attractor: &Attractor, facts: &FieldFacts) -> Made {
    let d = "sqrt(dot(x - c, x - c) + blunt)";
    let parameters = [
        ("c", centre(attractor.centre_m, facts)),
        ("strength", s(attractor.strength_m_s2)),
        ("radius", s(attractor.radius_m)),
        ("falloff", s(attractor.falloff)),
        ("blunt", s((0.1 * attractor.radius_m).powi(2))),
    ];
    made(&format!("-strength * pow(radius / {d}, falloff) / {d} * (x - c)"), &parameters)
}

fn explosion_of(explosion: &Explosion, facts: &FieldFacts) -> Made {
    let square = "dot(x - c, x - c)";
    let parameters = [
        ("c", centre(explosion.centre_m, facts)),
        ("push", s(explosion.speed_m_s / BLAST_S)),
        ("inverse", s(explosion.radius_m.powi(-2))),
        ("blunt", s((0.05 * explosion.radius_m).powi(2))),
    ];
    made(&format!("push / sqrt({square} + blunt) / (1 + {square} * inverse) * (x - c)"), &parameters)
}

fn spring_of(spring: &Spring, facts: &FieldFacts) -> Made {
    let first = spring.to_m.or(spring.path_m.first().map(|p| [p[1], p[2], p[3]])).unwrap_or(facts.start_m);
    let mut parameters: Vec<(String, Parameter)> = vec![
        ("k".to_owned(), s(spring.stiffness_per_s2)),
        ("d".to_owned(), s(spring.damping_per_s)),
        // From a particle's captured place to its first goal.
        ("shift".to_owned(), v([0, 1, 2].map(|a| first[a] - facts.captured_m[a]))),
    ];
    let (mut goal, mut velocity) = ("x0 + shift".to_owned(), "vec3(0)".to_owned());
    for (i, pair) in spring.path_m.windows(2).enumerate() {
        let span_s = pair[1][0] - pair[0][0];
        let way = [1, 2, 3].map(|a| pair[1][a] - pair[0][a]);
        goal.push_str(&format!(" + way{i} * clamp((t - from{i}) * per{i}, 0, 1)"));
        velocity.push_str(&format!(" + if(t >= from{i} && t < to{i}, way{i} * per{i}, vec3(0))"));
        let more = [("way", v(way)), ("from", s(pair[0][0])), ("to", s(pair[1][0])), ("per", s(1.0 / span_s))];
        parameters.extend(more.map(|(name, value)| (format!("{name}{i}"), value)));
    }
    let named: Vec<(&str, Parameter)> = parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    made(&format!("k * ({goal} - x) - d * (v - ({velocity}))"), &named)
}

/// Only the speed around the axis is driven, never along or away from it.
fn motor_of(motor: &Motor, facts: &FieldFacts) -> Made {
    let w = "cross(axis, x - c)";
    let parameters =
        [("c", centre(motor.centre_m, facts)), ("axis", unit(motor.axis)), ("spin", s(motor.speed_rad_s)), ("rate", s(motor.rate_per_s))];
    made(&format!("rate * (spin - dot(v, {w}) / max(dot({w}, {w}), 1e-12)) * {w}"), &parameters)
}
