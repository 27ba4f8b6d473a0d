//! Phrases to clauses: one clause asks for one thing. Whoever understands a phrase takes it; what nobody took is
//! reported.

use super::numbers::{Dimension, Quantity};
use super::phrases::Phrase;
use super::sense::{Direction, Form, Preposition, Property, Sense, Verb};
use std::ops::Range;

/// One clause of a request.
#[derive(Debug, Default)]
pub struct Clause {
    phrases: Vec<Phrase>,
    taken: Vec<bool>,
}

impl Clause {
    fn new(phrases: Vec<Phrase>) -> Clause {
        Clause { taken: vec![false; phrases.len()], phrases }
    }

    /// All phrases, taken or not.
    pub fn phrases(&self) -> &[Phrase] {
        &self.phrases
    }

    /// Takes the first phrase that `pick` accepts.
    pub fn take<T>(&mut self, pick: impl Fn(&Sense) -> Option<T>) -> Option<T> {
        let found = (0..self.phrases.len()).filter(|i| !self.taken[*i]).find_map(|i| pick(&self.phrases[i].sense).map(|value| (i, value)));
        found.map(|(i, value)| {
            self.taken[i] = true;
            value
        })
    }

    /// Takes the first phrase that `pick` accepts and that stands right before another meaning.
    pub fn take_before<T>(&mut self, next: impl Fn(&Sense) -> bool, pick: impl Fn(&Sense) -> Option<T>) -> Option<T> {
        let at =
            (1..self.phrases.len()).find(|&i| next(&self.phrases[i].sense) && !self.taken[i - 1] && pick(&self.phrases[i - 1].sense).is_some())?;
        self.taken[at - 1] = true;
        pick(&self.phrases[at - 1].sense)
    }

    /// Takes every phrase that `pick` accepts.
    pub fn take_all<T>(&mut self, pick: impl Fn(&Sense) -> Option<T>) -> Vec<T> {
        std::iter::from_fn(|| self.take(&pick)).collect()
    }

    /// Takes every phrase of one meaning; whether there was one.
    pub fn take_sense(&mut self, sense: &Sense) -> bool {
        !self.take_all(|s| (s == sense).then_some(())).is_empty()
    }

    /// Whether a phrase that nobody took yet has such a meaning.
    pub fn has(&self, pick: impl Fn(&Sense) -> bool) -> bool {
        self.left().any(|p| pick(&p.sense))
    }

    /// Phrases that nobody took yet.
    pub fn left(&self) -> impl Iterator<Item = &Phrase> {
        self.phrases.iter().zip(&self.taken).filter(|(_, taken)| !**taken).map(|(phrase, _)| phrase)
    }

    /// Where phrases stand that nobody took yet.
    pub fn left_indices(&self) -> impl Iterator<Item = usize> {
        (0..self.phrases.len()).filter(|&i| !self.taken[i])
    }

    /// Takes a meaning together with the phrase after it, articles aside, where `pick` accepts that one.
    pub fn take_after<T>(&mut self, lead: &Sense, pick: impl Fn(&Sense) -> Option<T>) -> Option<T> {
        let at = self.left_indices().find(|&i| self.phrases[i].sense == *lead)?;
        let next = (at + 1..self.phrases.len()).find(|&i| self.phrases[i].sense != Sense::Article).filter(|&i| !self.taken[i])?;
        let value = pick(&self.phrases[next].sense)?;
        (self.taken[at], self.taken[next]) = (true, true);
        Some(value)
    }

    /// Takes the phrase at a place.
    pub fn take_at_index(&mut self, index: usize) {
        self.taken[index] = true;
    }

    /// Whether anybody took something.
    pub fn took_something(&self) -> bool {
        self.taken.iter().any(|t| *t)
    }

    /// Tokens of phrases that carry meaning and that nobody took.
    pub fn not_understood(&self) -> Vec<Range<usize>> {
        let silent = |sense: &Sense| {
            matches!(
                sense,
                Sense::Objects(_)
                    | Sense::It
                    | Sense::All
                    | Sense::Whole
                    | Sense::Wait
                    | Sense::Article
                    | Sense::As
                    | Sense::Preposition(_)
                    | Sense::Filler
                    | Sense::Separator
            )
        };
        // "On the table" only says where it stands; any other word about the ground asks for something.
        let stands = |i: usize| {
            self.phrases[i].sense == Sense::Ground && {
                let before = self.phrases[..i].iter().rev().find(|p| !matches!(p.sense, Sense::Article | Sense::Material(_)));
                before.is_some_and(|p| p.sense == Sense::Preposition(Preposition::On))
            }
        };
        let left = (0..self.phrases.len()).filter(|&i| !self.taken[i] && !silent(&self.phrases[i].sense) && !stands(i));
        left.map(|i| self.phrases[i].span.clone()).collect()
    }

    /// Takes back everything but what no reader could have understood: the clause is refused for a reason of its own.
    pub fn refuse(&mut self) {
        for (phrase, taken) in self.phrases.iter().zip(&mut self.taken) {
            *taken = !matches!(phrase.sense, Sense::Unknown | Sense::Deed | Sense::Unbuilt(_) | Sense::Condition | Sense::Negation | Sense::Question);
        }
    }

    /// Takes the first verb that `pick` accepts.
    pub fn take_verb(&mut self, pick: impl Fn(Verb) -> bool) -> Option<Verb> {
        self.take(|s| match s {
            Sense::Verb(verb) if pick(*verb) => Some(*verb),
            _ => None,
        })
    }

    /// Takes all directions.
    pub fn take_directions(&mut self) -> Vec<Direction> {
        self.take_all(|s| match s {
            Sense::Direction(direction) => Some(*direction),
            _ => None,
        })
    }

    /// Takes a number of a dimension, with its preposition.
    pub fn take_measure(&mut self, dimension: Dimension) -> Option<(f64, Option<Preposition>)> {
        self.take(|s| match s {
            Sense::Measure(Quantity { value, dimension: d }, lead) if *d == dimension => Some((*value, *lead)),
            _ => None,
        })
    }

    /// Takes a number of a dimension, or one without a unit that no preposition ties to a time.
    pub fn take_measure_or_plain(&mut self, dimension: Dimension) -> Option<(f64, Option<Preposition>)> {
        self.take_measure(dimension).or_else(|| {
            self.take(|s| match s {
                Sense::Measure(Quantity { value, dimension: Dimension::Plain }, lead)
                    if matches!(lead, None | Some(Preposition::By | Preposition::From | Preposition::To | Preposition::Of | Preposition::With)) =>
                {
                    Some((*value, *lead))
                }
                _ => None,
            })
        })
    }

    /// Takes "at 0.5 s".
    pub fn take_at(&mut self) -> Option<f64> {
        self.take(|s| match s {
            Sense::At(time) => Some(*time),
            _ => None,
        })
    }

    /// Takes "for 2 s".
    pub fn take_for(&mut self) -> Option<f64> {
        self.take(|s| match s {
            Sense::For(time) => Some(*time),
            _ => None,
        })
    }

    /// Takes "until 2 s".
    pub fn take_until(&mut self) -> Option<f64> {
        self.take(|s| match s {
            Sense::Until(time) => Some(*time),
            _ => None,
        })
    }

    /// Takes how much more or less of one of `properties` is asked for, with the words that say how much.
    pub fn take_scale(&mut self, properties: &[Property]) -> Option<Scale> {
        // The noun first: in "stronger gravity" the adjective says how much of it.
        let noun = self.take(|s| match s {
            Sense::Property(property) if properties.contains(property) => Some((*property, 1.0, None)),
            _ => None,
        });
        let (property, sign, form) = noun.or_else(|| {
            self.take(|s| match s {
                Sense::Quality(property, sign, form) if properties.contains(property) => Some((*property, *sign, Some(*form))),
                _ => None,
            })
        })?;
        Some(self.scaled(property, sign, form))
    }

    /// Takes "less wind", "half the wind", "20 % more wind": how much more or less of what a verb names.
    pub fn take_more(&mut self, verb: Verb) -> Option<Scale> {
        let counts = matches!(verb, Verb::Blow | Verb::Field(_))
            && self.has(|s| matches!(s, Sense::Factor(_) | Sense::Measure(Quantity { dimension: Dimension::Percent, .. }, _)));
        if !counts && !self.has(|s| matches!(s, Sense::Change(_))) {
            return None;
        }
        Some(Scale { compared: true, ..self.scaled(Property::Strength, 1.0, None) })
    }

    /// How much, of a property that is taken already.
    fn scaled(&mut self, property: Property, mut sign: f64, form: Option<Form>) -> Scale {
        let mut compared = form == Some(Form::Comparative);
        if let Some(change) = self.take(|s| match s {
            Sense::Change(change) => Some(*change),
            _ => None,
        }) {
            sign *= change;
            compared = true;
        } else if form.is_none()
            && let Some(change) = self.take(|s| match s {
                // "higher gravity", "a strong gravity", "lower stiffness"
                Sense::Quality(Property::Height | Property::Strength | Property::Size, change, _) => Some(*change),
                _ => None,
            })
        {
            sign *= change;
            compared = true;
        }
        let factor = self.take(|s| match s {
            Sense::Factor(factor) => Some(*factor),
            _ => None,
        });
        let percent = self.take_measure(Dimension::Percent);
        let as_much = self.take_sense(&Sense::As);
        let degrees = self.take_all(|s| match s {
            Sense::Degree(degree) => Some(*degree),
            _ => None,
        });
        let degree = if degrees.is_empty() { 1.0 } else { degrees.iter().product() };
        let asked = compared || form.is_some() || factor.is_some() || percent.is_some();
        let ratio = match (factor, percent) {
            (Some(factor), _) if compared && factor < 1.0 => 1.0 + sign * factor,
            (Some(factor), _) => factor.powf(sign),
            (None, Some((percent, lead))) if as_much || lead == Some(Preposition::To) || !compared => (percent / 100.0).powf(sign),
            (None, Some((percent, _))) => 1.0 + sign * percent / 100.0,
            (None, None) => step(property).powf(sign * degree),
        };
        Scale { property, ratio, sign, compared, asked }
    }

    /// Takes adverbs of strength: 0 where there are none, 1 for "hard", 2 for "very hard", -1 for "gently".
    fn take_strength(&mut self) -> f64 {
        let strengths = self.take_all(|s| match s {
            Sense::Strength(strength) => Some(*strength),
            _ => None,
        });
        let degrees = self.take_all(|s| match s {
            Sense::Degree(degree) => Some(*degree),
            _ => None,
        });
        let degree: f64 = degrees.iter().product();
        match (strengths.is_empty(), degrees.is_empty()) {
            (true, true) => 0.0,
            // "hop a little", "push it a lot"
            (true, false) => {
                if degree < 1.0 {
                    -1.0
                } else {
                    1.0
                }
            }
            (false, _) => strengths.iter().sum::<f64>() * degree,
        }
    }

    /// How vigorous a verb is to be: 1 where nothing says so, [`HARD`] for "hard", its inverse for "gently" or "a bit".
    pub fn take_vigour(&mut self) -> f64 {
        HARD.powf(self.take_strength())
    }

    /// Takes "half its height", "twice its height": in heights of the object.
    pub fn take_heights(&mut self) -> Option<f64> {
        if !self.has(|s| *s == Sense::Property(Property::Height)) {
            return None;
        }
        let factor = self.take(|s| match s {
            Sense::Factor(factor) => Some(*factor),
            _ => None,
        });
        self.take_sense(&Sense::Property(Property::Height));
        Some(factor.unwrap_or(1.0))
    }

    /// Whether the clause, standing alone, asks for something.
    fn has_head(&self) -> bool {
        self.phrases.iter().any(|p| asks(&p.sense))
    }

    /// Whether all that the clause asks for is how a verb is to be done: "and hard".
    fn only_qualifies(&self, verb: Verb) -> bool {
        self.phrases.iter().all(|p| match &p.sense {
            Sense::Quality(property, _, _) => qualifies(verb).contains(property),
            Sense::Degree(_) | Sense::Strength(_) | Sense::Filler | Sense::Article | Sense::As | Sense::Factor(_) => true,
            _ => false,
        })
    }

    fn starts_with_condition(&self) -> bool {
        self.phrases.iter().find(|p| p.sense != Sense::Filler).is_some_and(|p| p.sense == Sense::Condition)
    }

    /// The first verb, taken or not.
    pub fn verb(&self) -> Option<Verb> {
        self.phrases.iter().find_map(|p| match p.sense {
            Sense::Verb(verb) => Some(verb),
            _ => None,
        })
    }

    fn last_verb(&self) -> Option<Verb> {
        self.phrases.iter().rev().find_map(|p| match p.sense {
            Sense::Verb(verb) => Some(verb),
            _ => None,
        })
    }

    /// The verb that a following stretch without one repeats: one that gives another amount or time beside another direction.
    fn repeated_verb(&self, next: &Clause) -> Option<Phrase> {
        let kind = |sense: &Sense| match sense {
            Sense::Measure(quantity, _) => Some(Some(quantity.dimension)),
            Sense::At(_) => Some(None),
            _ => None,
        };
        let directed = |clause: &Clause| clause.phrases.iter().any(|p| matches!(p.sense, Sense::Direction(_)));
        let both = next.phrases.iter().filter_map(|p| kind(&p.sense)).any(|k| self.phrases.iter().any(|p| kind(&p.sense) == Some(k)));
        let verb = self.phrases.iter().rev().find(|p| matches!(p.sense, Sense::Verb(_)))?;
        (both && directed(self) && directed(next)).then(|| verb.clone())
    }

    /// "The vase does not", after what somebody else does: the same verb, denied.
    fn denies_alone(&self, said: &Clause) -> Option<Clause> {
        let nouns = |s: &Sense| matches!(s, Sense::Objects(_) | Sense::All | Sense::It | Sense::Article | Sense::Filler | Sense::Part(_));
        let (denials, rest): (Vec<Phrase>, Vec<Phrase>) = self.phrases.iter().cloned().partition(|p| p.sense == Sense::Negation);
        let named = rest.iter().any(|p| matches!(p.sense, Sense::Objects(_) | Sense::Part(_)));
        let verb = said.phrases.iter().rev().find(|p| matches!(p.sense, Sense::Verb(_)))?;
        (denials.len() == 1 && named && rest.iter().all(|p| nouns(&p.sense))).then(|| Clause::new([rest, denials, vec![verb.clone()]].concat()))
    }

    fn append(&mut self, other: Clause) {
        self.phrases.extend(other.phrases);
        self.taken = vec![false; self.phrases.len()];
    }
}

/// How much more or less of a property.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Of what.
    pub property: Property,
    /// New value over the old one.
    pub ratio: f64,
    /// Which way the word goes.
    pub sign: f64,
    /// "softer", "less stiff", not "soft".
    pub compared: bool,
    /// Whether a change was asked for at all; false for a property that is only named.
    pub asked: bool,
}

/// "Hard" multiplies a speed by this, "gently" divides.
pub const HARD: f64 = 1.75;

/// What a comparative alone multiplies by: "softer" halves, "higher" is half as high again.
pub fn step(property: Property) -> f64 {
    match property {
        Property::Stiffness | Property::Hardness | Property::Density | Property::Friction | Property::Gravity | Property::Bounce => 2.0,
        Property::Cohesion | Property::Yield => 2.0,
        // It takes that much to be seen.
        Property::Viscosity | Property::Tension | Property::Hold | Property::Stick => 4.0,
        Property::Height | Property::Speed | Property::Strength | Property::Size | Property::Duration | Property::Distance | Property::Detail => 1.5,
        Property::FieldOfView | Property::FrameRate | Property::Poisson | Property::Slope => 1.25,
    }
}

/// The adjectives that say how a verb is done.
pub fn qualifies(verb: Verb) -> &'static [Property] {
    match verb {
        Verb::Jump | Verb::Somersault => &[Property::Height, Property::Strength, Property::Hardness, Property::Size, Property::Speed],
        Verb::Fall | Verb::Drop | Verb::Lift => &[Property::Height, Property::Size],
        Verb::Push(_) | Verb::Pull | Verb::Blow | Verb::Field(_) => &[Property::Strength, Property::Hardness, Property::Speed, Property::Size],
        Verb::Throw => &[Property::Strength, Property::Hardness, Property::Speed, Property::Height, Property::Distance, Property::Size],
        Verb::Spin | Verb::Roll => &[Property::Speed, Property::Strength, Property::Hardness],
        Verb::Zoom(_) | Verb::Look | Verb::Orbit => &[Property::Distance, Property::FieldOfView, Property::Speed],
        _ => &[],
    }
}

/// Whether a meaning, standing alone, asks for something.
pub fn asks(sense: &Sense) -> bool {
    match sense {
        Sense::Verb(_)
        | Sense::Quality(..)
        | Sense::Property(_)
        | Sense::Material(_)
        | Sense::Unbuilt(_)
        | Sense::Gravity(_)
        | Sense::Surface(_)
        | Sense::Springy(_)
        | Sense::Scenery(_)
        | Sense::Course(_)
        | Sense::Proxy(_)
        | Sense::View(_)
        | Sense::Pose(_)
        | Sense::Turn(_)
        | Sense::Change(_)
        | Sense::Condition
        | Sense::Question
        | Sense::Camera
        | Sense::Smoothed(_)
        | Sense::Backdrop(_)
        | Sense::PictureSize(_)
        | Sense::Reseed
        | Sense::For(_)
        | Sense::Deed
        | Sense::Replace
        | Sense::Negation => true,
        Sense::Measure(quantity, _) => matches!(quantity.dimension, Dimension::Pressure | Dimension::Density | Dimension::FrameRate),
        _ => false,
    }
}

/// Stretches between separators. "Without spinning" after another verb begins one too.
fn segments(phrases: &[Phrase]) -> Vec<&[Phrase]> {
    let mut segments = Vec::new();
    for stretch in phrases.split(|p| p.sense == Sense::Separator) {
        let verb = |i: usize| matches!(stretch.get(i).map(|p| &p.sense), Some(Sense::Verb(_)));
        let denial = (1..stretch.len()).find(|&i| stretch[i].sense == Sense::Negation && verb(i + 1) && (0..i).any(verb));
        let (first, second) = stretch.split_at(denial.unwrap_or(stretch.len()));
        segments.extend([first, second].into_iter().filter(|s| !s.is_empty()));
    }
    segments
}

/// Splits phrases into clauses. A stretch between separators that asks for nothing by itself belongs to the clause
/// before it ("up and to the left"), or to the next one where it is the first ("after a second, push it").
pub fn split(phrases: Vec<Phrase>) -> Vec<Clause> {
    let mut clauses: Vec<Clause> = Vec::new();
    let mut pending: Option<Clause> = None;
    for segment in segments(&phrases) {
        let mut clause = Clause::new(segment.to_vec());
        if let Some(denial) = clauses.last().filter(|_| pending.is_none()).and_then(|said| clause.denies_alone(said)) {
            clauses.push(denial);
            continue;
        }
        let waits = !clause.has_head() && clause.phrases.iter().any(|p| p.sense == Sense::Wait);
        let belongs = !clause.has_head()
            || clause.starts_with_condition()
            || clauses.last().and_then(Clause::last_verb).is_some_and(|verb| clause.only_qualifies(verb));
        if let Some(mut before) = pending.take() {
            before.append(clause);
            clause = before;
        } else if belongs
            && !waits
            && let Some(last) = clauses.last_mut()
        {
            match last.repeated_verb(&clause) {
                // "push it left at 0.5 s and right at 1 s": the verb is said once for both.
                Some(verb) => clauses.push(Clause::new([vec![verb], clause.phrases].concat())),
                None => last.append(clause),
            }
            continue;
        }
        if waits || belongs && clauses.is_empty() {
            pending = Some(clause);
        } else {
            clauses.push(clause);
        }
    }
    clauses.extend(pending);
    clauses
}
