//! Conditions on a result: `vase.apex_m > 0.3`, `vase.travel_m.y < 0`, `vase.stretch_max.max < 2`.

use serde::Serialize;

use super::error::{SpecError, SpecErrorKind, shorten};
use super::{canonical::number, path};

/// What a metric is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One number, or none.
    Number,
    /// One vector.
    Vector,
    /// A number for each frame, or a list of times.
    Series,
    /// A vector for each frame.
    VectorSeries,
}

/// A metric of an object that conditions may name.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// Its name, the unit at its end.
    pub name: &'static str,
    /// What it is.
    pub shape: Shape,
    /// What it says.
    pub about: &'static str,
}

/// Every metric of an object: what `metrics.json` holds, and what is derived from it.
pub const METRICS: &[Metric] = &[
    Metric { name: "apex_m", shape: Shape::Number, about: "how far the centre of mass rises above where it starts" },
    Metric { name: "drop_m", shape: Shape::Number, about: "the largest fall of the centre of mass" },
    Metric { name: "travel_m", shape: Shape::Vector, about: "the centre of mass at the end, from where it starts" },
    Metric { name: "impacts_s", shape: Shape::Series, about: "when it touches down" },
    Metric { name: "settle_s", shape: Shape::Number, about: "when it comes to rest; none if it never does" },
    Metric { name: "largest_stretch", shape: Shape::Number, about: "the largest stretch of all frames" },
    Metric { name: "particles", shape: Shape::Number, about: "particles of its solid" },
    Metric { name: "gaussians", shape: Shape::Number, about: "its Gaussians" },
    Metric { name: "mass_kg", shape: Shape::Number, about: "its mass" },
    Metric { name: "fill_ratio", shape: Shape::Number, about: "inner particles over all" },
    Metric { name: "com_m", shape: Shape::VectorSeries, about: "centre of mass" },
    Metric { name: "low_m", shape: Shape::Series, about: "1st percentile of particle height" },
    Metric { name: "high_m", shape: Shape::Series, about: "99th percentile of particle height" },
    Metric { name: "speed_m_s", shape: Shape::Series, about: "fastest particle" },
    Metric { name: "mean_speed_m_s", shape: Shape::Series, about: "mean speed of its particles" },
    Metric { name: "volume_ratio", shape: Shape::Series, about: "volume over volume of the undeformed body" },
    Metric { name: "stretch_max", shape: Shape::Series, about: "99th percentile of the largest principal stretch since rest" },
    Metric { name: "spin_rad_s", shape: Shape::VectorSeries, about: "angular velocity" },
    Metric { name: "kinetic_j", shape: Shape::Series, about: "kinetic energy" },
    Metric { name: "spread_m", shape: Shape::Series, about: "root mean square horizontal distance from the centre of mass" },
];

/// A metric as it was measured.
#[derive(Clone, Debug, PartialEq)]
pub enum Measured {
    /// It never happened.
    Null,
    /// One number.
    Number(f64),
    /// One vector.
    Vector([f64; 3]),
    /// A number for each frame, or a list of times.
    Series(Vec<f64>),
    /// A vector for each frame.
    VectorSeries(Vec<[f64; 3]>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comparison {
    Above,
    AtLeast,
    Below,
    AtMost,
    Equal,
    Unequal,
}

/// The longer signs first: `>=` begins with `>`.
const SIGNS: [(&str, Comparison); 6] = [
    (">=", Comparison::AtLeast),
    ("<=", Comparison::AtMost),
    ("==", Comparison::Equal),
    ("!=", Comparison::Unequal),
    (">", Comparison::Above),
    ("<", Comparison::Below),
];

/// One number out of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pick {
    Min,
    Max,
    First,
    Last,
    Count,
}

const PICKS: [(&str, Pick); 5] = [("min", Pick::Min), ("max", Pick::Max), ("first", Pick::First), ("last", Pick::Last), ("count", Pick::Count)];

/// A condition that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    text: String,
    object: String,
    metric: &'static str,
    component: Option<usize>,
    pick: Option<Pick>,
    comparison: Comparison,
    bound: f64,
}

/// How a condition came out; one entry of `metrics.expect`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The condition as written.
    pub text: String,
    /// The value that was compared, none where there was none.
    pub value: Option<f64>,
    /// Whether the condition holds; it does not where there is no value.
    pub held: bool,
}

impl Condition {
    /// Reads `OBJECT.METRIC[.x|.y|.z][.min|.max|.first|.last|.count] COMPARISON NUMBER`.
    pub fn parse(text: &str) -> Result<Condition, SpecError> {
        let fault = |message: String| SpecError::new(SpecErrorKind::Syntax, place(text), message).allowed("a condition such as vase.apex_m > 0.3");
        let signs = SIGNS.iter().filter_map(|(sign, comparison)| Some((text.find(sign)?, *sign, *comparison)));
        // The first sign in the text, the longest where two begin there.
        let first = signs.min_by_key(|(at, sign, _)| (*at, usize::MAX - sign.len()));
        let (at, sign, comparison) = first.ok_or_else(|| fault("no comparison".to_owned()))?;
        let (left, right) = (text[..at].trim(), text[at + sign.len()..].trim());
        let bound =
            right.parse::<f64>().ok().filter(|bound| bound.is_finite()).ok_or_else(|| fault(format!("`{}` is not a number", shorten(right))))?;

        let mut parts = left.split('.');
        let object = parts.next().filter(|name| path::is_name(name)).ok_or_else(|| fault(format!("`{}` names no object", shorten(left))))?;
        let name = parts.next().ok_or_else(|| fault(format!("`{}` names no metric", shorten(left))))?;
        let metric = METRICS
            .iter()
            .find(|metric| metric.name == name)
            .ok_or_else(|| SpecError::unknown(place(text), "metric", name, METRICS.iter().map(|metric| metric.name)))?;

        let mut component = None;
        let mut pick = None;
        for part in parts {
            let axis = ["x", "y", "z"].iter().position(|axis| *axis == part);
            let picked = PICKS.iter().find(|(word, _)| *word == part).map(|(_, pick)| *pick);
            match (axis, picked) {
                (Some(axis), _) if component.is_none() && metric.is_vector() => component = Some(axis),
                (_, Some(picked)) if pick.is_none() && metric.is_series() => pick = Some(picked),
                _ => return Err(SpecError::unknown(place(text), "part of a metric", part, metric.parts())),
            }
        }
        if metric.is_vector() && component.is_none() && pick != Some(Pick::Count) {
            return Err(fault(format!("{name} is a vector; say which part: {name}.x, {name}.y or {name}.z")));
        }
        if metric.is_series() && pick.is_none() {
            return Err(fault(format!("{name} has many values; say which: {name}.max, .min, .first, .last or .count")));
        }
        Ok(Condition { text: text.to_owned(), object: object.to_owned(), metric: metric.name, component, pick, comparison, bound })
    }

    /// Refuses a condition on an object that is not there.
    pub(super) fn refers_to(&self, objects: &[&str]) -> Result<(), SpecError> {
        if objects.contains(&self.object.as_str()) {
            Ok(())
        } else {
            Err(SpecError::unknown(place(&self.text), "object", &self.object, objects.iter().copied()))
        }
    }

    /// Compares with what was measured; `lookup` is asked for an object's metric.
    pub fn evaluate(&self, lookup: impl FnOnce(&str, &str) -> Option<Measured>) -> Outcome {
        let value = lookup(&self.object, self.metric).and_then(|measured| self.value(&measured)).filter(|value| value.is_finite());
        let held = value.is_some_and(|value| match self.comparison {
            Comparison::Above => value > self.bound,
            Comparison::AtLeast => value >= self.bound,
            Comparison::Below => value < self.bound,
            Comparison::AtMost => value <= self.bound,
            Comparison::Equal => value == self.bound,
            Comparison::Unequal => value != self.bound,
        });
        Outcome { text: self.text.clone(), value, held }
    }

    fn value(&self, measured: &Measured) -> Option<f64> {
        let axis = self.component.unwrap_or(0);
        match measured {
            Measured::Null => None,
            Measured::Number(value) => Some(*value),
            Measured::Vector(vector) => Some(vector[axis]),
            Measured::Series(values) => self.pick(values.len(), values.iter().copied()),
            Measured::VectorSeries(vectors) => self.pick(vectors.len(), vectors.iter().map(|vector| vector[axis])),
        }
    }

    fn pick(&self, count: usize, mut values: impl DoubleEndedIterator<Item = f64>) -> Option<f64> {
        match self.pick? {
            Pick::Min => values.reduce(f64::min),
            Pick::Max => values.reduce(f64::max),
            Pick::First => values.next(),
            Pick::Last => values.next_back(),
            Pick::Count => Some(count as f64),
        }
    }

    /// What it compares with, as a text with the metric's unit left to its name.
    pub fn bound(&self) -> String {
        number(self.bound)
    }
}

impl Metric {
    fn is_vector(&self) -> bool {
        matches!(self.shape, Shape::Vector | Shape::VectorSeries)
    }

    fn is_series(&self) -> bool {
        matches!(self.shape, Shape::Series | Shape::VectorSeries)
    }

    fn parts(&self) -> Vec<&'static str> {
        let axes: &[&str] = if self.is_vector() { &["x", "y", "z"] } else { &[] };
        let picks: &[&str] = if self.is_series() { &["min", "max", "first", "last", "count"] } else { &[] };
        [axes, picks].concat()
    }
}

fn place(text: &str) -> String {
    format!("expect.{}", shorten(text))
}
