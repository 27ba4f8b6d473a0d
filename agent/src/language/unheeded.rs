//! Amounts and times that nobody took. To run without a number that was said would be to guess, so the turn is refused,
//! with what would be understood instead.

use super::clause::Clause;
use super::draft::{Draft, Refusal};
use super::numbers::Dimension;
use super::sense::{Sense, Verb};

/// Why a clause is refused whose readers left an amount or a time; None where they left none.
pub fn refusal(clause: &Clause, draft: &Draft) -> Option<Refusal> {
    let left: Vec<_> = clause.left().filter(|p| is_amount(&p.sense)).collect();
    let first = left.first()?;
    let said: Vec<String> = left.iter().map(|p| format!("\"{}\"", draft.words(p.span.clone()))).collect();
    Some(format!("{} has no place there: {}", super::say::list(&said), instead(&first.sense, clause.verb())))
}

fn is_amount(sense: &Sense) -> bool {
    matches!(
        sense,
        Sense::Measure(..)
            | Sense::Factor(_)
            | Sense::At(_)
            | Sense::Span(..)
            | Sense::Until(_)
            | Sense::For(_)
            | Sense::Moment(_)
            | Sense::Version(_)
    )
}

/// What would be understood.
fn instead(sense: &Sense, verb: Option<Verb>) -> &'static str {
    match (sense, verb) {
        (Sense::Measure(q, _), Some(Verb::Push(_) | Verb::Blow)) if q.dimension == Dimension::Length => {
            "a push has a speed, \"push it left at 2 m/s\"; \"move it 2 m to the left\" lets it start there"
        }
        (Sense::Measure(q, _), _) => dimension(q.dimension),
        (Sense::Factor(_), Some(Verb::Jump | Verb::Push(_) | Verb::Throw)) => {
            "a motion happens once; another one has its own time, \"jump, then jump at 1 s\""
        }
        (Sense::Factor(_), Some(Verb::Fall | Verb::Drop)) => {
            "how often it bounces follows from the ground, \"bouncier\", and from how high it drops, \"drop it from 2 m\""
        }
        (Sense::Factor(_), _) => "it goes with more and less, \"twice as stiff\", \"three times heavier\"",
        (Sense::At(_) | Sense::Moment(_), Some(Verb::Topple | Verb::Turn | Verb::Tilt | Verb::Move | Verb::Lift | Verb::Reset)) => {
            "that is how it starts, at 0 s; \"push it at 1 s\" happens later, and \"for 1 s\" is how long it runs"
        }
        (Sense::At(_) | Sense::Moment(_), _) => {
            "pushes, jumps, throws, stops and letting go have a time, \"push it left at 1 s\"; \"for 1 s\" is how long it runs"
        }
        (Sense::Version(_), _) => "\"back to v2\" goes to a version",
        (_, _) => "a pull and a hold last, \"pull it left from 0.2 s to 1 s\", \"hold the base until 1 s\"; \"for 3 s\" is how long it runs",
    }
}

fn dimension(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::Length => {
            "lengths go with \"jump 30 cm\", \"drop it from 1 m\", \"move it 20 cm to the left\", \"throw it 2 m\", \"camera at 2 m\""
        }
        Dimension::Time => "\"at 1 s\" is when, \"for 1 s\" is how long it runs",
        Dimension::Speed => "speeds go with \"push it at 2 m/s\", \"throw it at 3 m/s\", \"jump with 3 m/s\"",
        Dimension::Acceleration => "accelerations go with \"pull it left with 3 m/s²\", \"gravity of 5 m/s²\"",
        Dimension::Angle => "angles go with \"turn it by 90 degrees\", \"tilt it 20 degrees to the left\", \"throw it at 30 degrees\"",
        Dimension::AngularSpeed => "rates go with \"spin it at 2 turns a second\", \"orbit at 30 degrees a second\"",
        Dimension::Pressure => "a stiffness is set by \"stiffness 30 kPa\"",
        Dimension::Density => "a density is set by \"density 500 kg/m³\"",
        Dimension::Mass => "a mass follows from the density, \"density 500 kg/m³\"",
        Dimension::FrameRate => "\"at 100 fps\" is the frames a second",
        Dimension::Percent => "it goes with more and less, \"20 % softer\"",
        Dimension::Strange => "what it is a number of is not known: \"30 cm\", \"2 m/s\", \"10 kPa\", \"500 kg/m³\" are",
        Dimension::Times | Dimension::Plain => "a number has its unit, \"jump 30 cm\", \"push it at 2 m/s\", or says how much, \"twice as stiff\"",
    }
}
