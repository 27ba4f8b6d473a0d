//! Numbers in digits and words, and units by dimensional analysis: a unit is a factor and the exponents of metre,
//! second, kilogram and radian, so that "km/h", "metres per second" and "m / s" are one thing.

use super::tokens::Token;
use std::f64::consts::TAU;

/// What a number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Metres.
    Length,
    /// Seconds.
    Time,
    /// Metres a second.
    Speed,
    /// Metres a second squared.
    Acceleration,
    /// Radians.
    Angle,
    /// Radians a second.
    AngularSpeed,
    /// Pascals.
    Pressure,
    /// Kilograms a cubic metre.
    Density,
    /// Kilograms.
    Mass,
    /// Pascal seconds.
    Viscosity,
    /// Newtons a metre.
    Tension,
    /// Frames a second.
    FrameRate,
    /// Hundredths.
    Percent,
    /// So many times.
    Times,
    /// A number alone.
    Plain,
    /// In something that nobody knows.
    Strange,
}

/// A number with what it measures, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// Its value in the SI unit of its dimension.
    pub value: f64,
    /// What it measures.
    pub dimension: Dimension,
}

/// Reads a number, in digits or words, at `at`: its value and where it ends.
pub fn number(tokens: &[Token], at: usize) -> Option<(f64, usize)> {
    if word(tokens, at) == "minus" {
        return number(tokens, at + 1).map(|(value, end)| (-value, end));
    }
    let (whole, end) = digits(tokens, at).or_else(|| cardinal(tokens, at)).or_else(|| fraction(tokens, at))?;
    // "two and a half", "2 1/2"
    if word(tokens, end) == "and"
        && matches!(word(tokens, end + 1), "a" | "one")
        && let Some((part, end)) = fraction(tokens, end + 1)
    {
        return Some((whole + part, end));
    }
    Some((whole, end))
}

/// Digits, "1/3", "1½", "3 thousand".
fn digits(tokens: &[Token], at: usize) -> Option<(f64, usize)> {
    let value = tokens.get(at)?.number?;
    let following = |i: usize| tokens.get(i).and_then(|t| t.number);
    if word(tokens, at + 1) == "/"
        && let Some(below) = following(at + 2).filter(|d| *d != 0.0)
    {
        return Some((value / below, at + 3));
    }
    if let Some(part) = following(at + 1)
        && value.fract() == 0.0
        && (0.0..1.0).contains(&part)
        && tokens[at + 1].text.chars().all(|c| !c.is_ascii())
    {
        return Some((value + part, at + 2));
    }
    match magnitude(word(tokens, at + 1)) {
        Some(times) => Some((value * times, at + 2)),
        None => Some((value, at + 1)),
    }
}

fn magnitude(word: &str) -> Option<f64> {
    Some(match word {
        "hundred" => 100.0,
        "thousand" => 1e3,
        "million" => 1e6,
        "dozen" => 12.0,
        _ => return None,
    })
}

fn small(word: &str) -> Option<f64> {
    const NAMES: [&str; 20] = [
        "zero",
        "one",
        "two",
        "three",
        "four",
        "five",
        "six",
        "seven",
        "eight",
        "nine",
        "ten",
        "eleven",
        "twelve",
        "thirteen",
        "fourteen",
        "fifteen",
        "sixteen",
        "seventeen",
        "eighteen",
        "nineteen",
    ];
    NAMES.iter().position(|n| *n == word).map(|n| n as f64)
}

fn tens(word: &str) -> Option<f64> {
    const NAMES: [&str; 8] = ["twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"];
    NAMES.iter().position(|n| *n == word).map(|n| 10.0 * (n as f64 + 2.0))
}

/// Number words: "twenty five", "three hundred and ten", "a hundred", "two point five", "a couple of".
fn cardinal(tokens: &[Token], start: usize) -> Option<(f64, usize)> {
    let mut at = start;
    if word(tokens, at) == "a" && matches!(word(tokens, at + 1), "hundred" | "thousand" | "million" | "dozen") {
        return Some((magnitude(word(tokens, at + 1))?, at + 2));
    }
    if word(tokens, at) == "a" && word(tokens, at + 1) == "couple" && word(tokens, at + 2) == "of" {
        return Some((2.0, at + 3));
    }
    let (mut total, mut group) = (0.0, 0.0);
    loop {
        let this = word(tokens, at);
        if let Some(ten) = tens(this) {
            group += ten;
            if let Some(one) = small(word(tokens, at + 1)).filter(|v| (1.0..10.0).contains(v)) {
                group += one;
                at += 1;
            }
        } else if let Some(value) = small(this) {
            group += value;
        } else {
            break;
        }
        at += 1;
        let Some(times) = magnitude(word(tokens, at)) else { break };
        at += 1;
        if times == 100.0 {
            group *= times;
            if word(tokens, at) == "and" && (small(word(tokens, at + 1)).is_some() || tens(word(tokens, at + 1)).is_some()) {
                at += 1;
            }
        } else {
            total += group * times;
            group = 0.0;
        }
    }
    if at == start {
        return None;
    }
    let mut value = total + group;
    if word(tokens, at) == "point" {
        let mut place = 0.1;
        let mut digit_at = at + 1;
        while let Some(digit) = small(word(tokens, digit_at)).filter(|d| *d < 10.0) {
            value += digit * place;
            place *= 0.1;
            digit_at += 1;
        }
        if digit_at > at + 1 {
            at = digit_at;
        }
    }
    // "two thirds", "three quarters"
    if let Some(part) = part_of_one(word(tokens, at)) {
        return Some((value * part, at + 1));
    }
    Some((value, at))
}

fn part_of_one(word: &str) -> Option<f64> {
    Some(match word {
        "half" | "halves" => 0.5,
        "third" | "thirds" => 1.0 / 3.0,
        "quarter" | "quarters" | "fourth" | "fourths" => 0.25,
        "fifth" | "fifths" => 0.2,
        "sixth" | "sixths" => 1.0 / 6.0,
        "eighth" | "eighths" => 0.125,
        "tenth" | "tenths" => 0.1,
        _ => return None,
    })
}

/// "half", "a half", "a third", "a quarter of".
fn fraction(tokens: &[Token], start: usize) -> Option<(f64, usize)> {
    let at = if matches!(word(tokens, start), "a" | "one" | "an") { start + 1 } else { start };
    let this = word(tokens, at);
    let part = part_of_one(this).filter(|_| at > start || this == "half" || this == "quarter")?;
    Some((part, at + 1))
}

/// Reads a number with a unit, or a number alone, at `at`.
pub fn quantity(tokens: &[Token], at: usize) -> Option<(Quantity, usize)> {
    // "a metre", "an inch", "a second and a half"
    if matches!(word(tokens, at), "a" | "an" | "one")
        && let Some((unit, end)) = unit(tokens, at + 1)
    {
        let half = word(tokens, end) == "and" && word(tokens, end + 1) == "a" && word(tokens, end + 2) == "half";
        let (value, end) = if half { (1.5, end + 3) } else { (1.0, end) };
        return Some((Quantity { value: value * unit.factor, dimension: unit.dimension()? }, end));
    }
    let (value, after) = number(tokens, at)?;
    let sign = |dimension, length| Some((Quantity { value, dimension }, after + length));
    match word(tokens, after) {
        "%" | "percent" => return sign(Dimension::Percent, 1),
        "per" if word(tokens, after + 1) == "cent" => return sign(Dimension::Percent, 2),
        "x" | "fold" if tokens[at].number.is_some() => return sign(Dimension::Times, 1),
        "times" => return sign(Dimension::Times, 1),
        _ => {}
    }
    // "half a metre", "a third of a second"
    let mut from = after;
    if word(tokens, from) == "of" {
        from += 1;
    }
    if matches!(word(tokens, from), "a" | "an" | "one") {
        from += 1;
    }
    let fits = from == after || value < 1.0;
    if fits && let Some((unit, end)) = unit(tokens, from) {
        return Some((Quantity { value: value * unit.factor, dimension: unit.dimension()? }, end));
    }
    Some((Quantity { value, dimension: Dimension::Plain }, after))
}

/// A unit alone, "the first second": one of it.
pub fn one(tokens: &[Token], at: usize) -> Option<(Quantity, usize)> {
    let (unit, end) = unit(tokens, at)?;
    Some((Quantity { value: unit.factor, dimension: unit.dimension()? }, end))
}

/// A unit: how many SI units it is, and the exponents of metre, second, kilogram, radian and frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unit {
    factor: f64,
    exponents: [i8; 5],
}

impl Unit {
    fn dimension(self) -> Option<Dimension> {
        Some(match self.exponents {
            [1, 0, 0, 0, 0] => Dimension::Length,
            [0, 1, 0, 0, 0] => Dimension::Time,
            [1, -1, 0, 0, 0] => Dimension::Speed,
            [1, -2, 0, 0, 0] => Dimension::Acceleration,
            [0, 0, 0, 1, 0] => Dimension::Angle,
            [0, -1, 0, 1, 0] => Dimension::AngularSpeed,
            [-1, -2, 1, 0, 0] => Dimension::Pressure,
            [-3, 0, 1, 0, 0] => Dimension::Density,
            [0, 0, 1, 0, 0] => Dimension::Mass,
            [-1, -1, 1, 0, 0] => Dimension::Viscosity,
            [0, -2, 1, 0, 0] => Dimension::Tension,
            [0, -1, 0, 0, 1] => Dimension::FrameRate,
            _ => return None,
        })
    }

    fn over(self, below: Unit) -> Unit {
        let mut exponents = self.exponents;
        for (above, below) in exponents.iter_mut().zip(below.exponents) {
            *above -= below;
        }
        Unit { factor: self.factor / below.factor, exponents }
    }

    fn power(self, exponent: i8) -> Unit {
        Unit { factor: self.factor.powi(i32::from(exponent)), exponents: self.exponents.map(|e| e * exponent) }
    }
}

const METRE: [i8; 5] = [1, 0, 0, 0, 0];
const SECOND: [i8; 5] = [0, 1, 0, 0, 0];
const KILOGRAM: [i8; 5] = [0, 0, 1, 0, 0];
const RADIAN: [i8; 5] = [0, 0, 0, 1, 0];
const SPEED: [i8; 5] = [1, -1, 0, 0, 0];
const ACCELERATION: [i8; 5] = [1, -2, 0, 0, 0];
const PRESSURE: [i8; 5] = [-1, -2, 1, 0, 0];

/// The units, by their names: factor to SI and exponents. `docs/phrases.md` lists them from here.
pub const UNITS: &[(&str, f64, [i8; 5])] = &[
    ("m metre metres meter meters", 1.0, METRE),
    ("cm centimetre centimetres centimeter centimeters", 1e-2, METRE),
    ("mm millimetre millimetres millimeter millimeters", 1e-3, METRE),
    ("km kilometre kilometres kilometer kilometers", 1e3, METRE),
    ("in inch inches", 0.0254, METRE),
    ("ft foot feet", 0.3048, METRE),
    ("s sec secs second seconds", 1.0, SECOND),
    ("ms millisecond milliseconds", 1e-3, SECOND),
    ("min minute minutes", 60.0, SECOND),
    ("h hour hours", 3600.0, SECOND),
    ("kg kilo kilos kilogram kilograms", 1.0, KILOGRAM),
    ("gram grams", 1e-3, KILOGRAM),
    ("deg degree degrees", TAU / 360.0, RADIAN),
    ("rad radian radians", 1.0, RADIAN),
    ("turn turns revolution revolutions rev revs rotation rotations", TAU, RADIAN),
    ("hz hertz", TAU, [0, -1, 0, 1, 0]),
    ("rpm", TAU / 60.0, [0, -1, 0, 1, 0]),
    ("mps", 1.0, SPEED),
    ("kmh kph", 1.0 / 3.6, SPEED),
    ("mph", 0.44704, SPEED),
    ("g gs gee gees", 9.81, ACCELERATION),
    ("pa pascal pascals", 1.0, PRESSURE),
    ("kpa kilopascal kilopascals", 1e3, PRESSURE),
    ("mpa megapascal megapascals", 1e6, PRESSURE),
    ("gpa gigapascal gigapascals", 1e9, PRESSURE),
    ("cp centipoise", 1e-3, [-1, -1, 1, 0, 0]),
    ("poise", 0.1, [-1, -1, 1, 0, 0]),
    ("newton newtons", 1.0, [1, -2, 1, 0, 0]),
    ("mn millinewton millinewtons", 1e-3, [1, -2, 1, 0, 0]),
    ("frame frames", 1.0, [0, 0, 0, 0, 1]),
    ("fps", 1.0, [0, -1, 0, 0, 1]),
];

/// Whether two words name one unit: "meter" and "metres".
pub fn same_unit(a: &str, b: &str) -> bool {
    UNITS.iter().any(|(names, ..)| [a, b].iter().all(|word| names.split(' ').any(|name| name == *word)))
}

fn base_unit(word: &str) -> Option<Unit> {
    let (stem, exponent) = match word.strip_suffix(['2', '3']) {
        Some(stem) => (stem, if word.ends_with('2') { 2 } else { 3 }),
        None => (word, 1),
    };
    let (_, factor, exponents) = UNITS.iter().find(|(names, ..)| names.split(' ').any(|n| n == stem))?;
    Some(Unit { factor: *factor, exponents: *exponents }.power(exponent))
}

/// Reads a unit: "m", "m/s2", "metres per second", "turns a second", "kilograms per cubic metre", "metres per second squared".
fn unit(tokens: &[Token], at: usize) -> Option<(Unit, usize)> {
    // A g alone is free fall, one over something is a gram.
    let gram = word(tokens, at) == "g" && matches!(word(tokens, at + 1), "/" | "per");
    // An n alone is a word, one over something is a newton.
    let newton = word(tokens, at) == "n" && matches!(word(tokens, at + 1), "/" | "per");
    let name = match word(tokens, at) {
        _ if gram => "gram",
        _ if newton => "newton",
        name => name,
    };
    let mut unit = base_unit(name)?;
    let mut end = at + 1;
    // "5 Pa s" is a viscosity; of a million of them nobody speaks, so "mPa s" is a thousandth.
    if unit.exponents == PRESSURE && base_unit(word(tokens, end)).is_some_and(|u| u.exponents == SECOND) && word(tokens, end) != "min" {
        let pascals = if name == "mpa" { 1e-3 } else { unit.factor };
        unit = Unit { factor: pascals, exponents: [-1, -1, 1, 0, 0] };
        end += 1;
    }
    loop {
        let mut below_at = match word(tokens, end) {
            "/" | "per" => end + 1,
            // "3 metres a second", but not "turn it 3 degrees a metre away"
            "a" | "an" if unit.exponents[1] == 0 && base_unit(word(tokens, end + 1)).is_some_and(|u| u.exponents == SECOND) => end + 1,
            _ => break,
        };
        let power = match word(tokens, below_at) {
            "cubic" => 3,
            "square" => 2,
            _ => 1,
        };
        below_at += usize::from(power > 1);
        let Some(mut below) = base_unit(word(tokens, below_at)).map(|u| u.power(power)) else { break };
        below_at += 1;
        if matches!(word(tokens, below_at), "squared" | "cubed") {
            below = below.power(if word(tokens, below_at) == "squared" { 2 } else { 3 });
            below_at += 1;
        }
        unit = unit.over(below);
        end = below_at;
    }
    unit.dimension().map(|_| (unit, end))
}

fn word(tokens: &[Token], at: usize) -> &str {
    tokens.get(at).map_or("", |t| t.word.as_str())
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokenise;
    use super::*;

    fn read(text: &str) -> (f64, Dimension) {
        let tokens = tokenise(text);
        let (quantity, end) = quantity(&tokens, 0).expect(text);
        assert_eq!(end, tokens.len(), "{text}");
        ((quantity.value * 1e9).round() / 1e9, quantity.dimension)
    }

    #[test]
    fn numbers_with_units() {
        use Dimension::*;
        for (text, value, dimension) in [
            ("30 cm", 0.3, Length),
            ("half a metre", 0.5, Length),
            ("a third of a second", 0.333333333, Time),
            ("two and a half meters", 2.5, Length),
            ("a metre and a half", 1.5, Length),
            ("1½ m", 1.5, Length),
            ("an inch", 0.0254, Length),
            ("2 ft", 0.6096, Length),
            ("500 ms", 0.5, Time),
            ("three quarters of a second", 0.75, Time),
            ("twenty-five degrees", 0.436332313, Angle),
            ("3 m/s", 3.0, Speed),
            ("three metres per second", 3.0, Speed),
            ("36 km/h", 10.0, Speed),
            ("3 m/s²", 3.0, Acceleration),
            ("3 metres per second squared", 3.0, Acceleration),
            ("3 metres per second per second", 3.0, Acceleration),
            ("2 g's", 19.62, Acceleration),
            ("2 turns per second", 12.566370614, AngularSpeed),
            ("6 rpm", 0.628318531, AngularSpeed),
            ("10 deg/s", 0.174532925, AngularSpeed),
            ("10 kPa", 1e4, Pressure),
            ("0.5 MPa", 5e5, Pressure),
            ("500 kg/m3", 500.0, Density),
            ("500 kilograms per cubic metre", 500.0, Density),
            ("2 g/cm3", 2000.0, Density),
            ("10 Hz", 62.831853072, AngularSpeed),
            ("100 fps", 100.0, FrameRate),
            ("24 frames per second", 24.0, FrameRate),
            ("20 %", 20.0, Percent),
            ("twenty percent", 20.0, Percent),
            ("three times", 3.0, Times),
            ("1.5x", 1.5, Times),
            ("1/3", 0.333333333, Plain),
            ("three hundred and ten", 310.0, Plain),
            ("two point five", 2.5, Plain),
            ("a hundred", 100.0, Plain),
        ] {
            assert_eq!(read(text), (value, dimension), "{text}");
        }
    }
}
