//! Words that nobody took and without which the rest would be something else: amounts and times, exceptions, denials,
//! limits, a second material, a part. To run without them would be to guess, so the turn is refused, with what would be
//! understood instead. Words that only describe pass, and are reported.

use super::beside;
use super::clause::Clause;
use super::draft::{Draft, Refusal};
use super::numbers::Dimension;
use super::phrases::Phrase;
use super::sense::{Field, Moment, Sense, Verb};

/// Why a clause is refused whose readers left such a word; None where they left none.
pub fn refusal(clause: &Clause, draft: &Draft) -> Option<Refusal> {
    limit(clause, draft).or_else(|| amount(clause, draft).filter(|_| clause.took_something()))
}

/// The first word that is left and limits, denies or turns round what was read.
fn limit(clause: &Clause, draft: &Draft) -> Option<Refusal> {
    let (index, hint) = clause.left_indices().find_map(|i| Some((i, meant(clause, draft, i)?)))?;
    let phrase = &clause.phrases()[index];
    let why = if phrase.sense == Sense::Deed { "is no verb that is known there" } else { "changes what is meant, and is not understood there" };
    Some(format!("\"{}\" {why}: {hint}", draft.words(phrase.span.clone())))
}

/// What would be understood, where the phrase at `i` changes the meaning of the clause.
fn meant(clause: &Clause, draft: &Draft, i: usize) -> Option<&'static str> {
    let phrases = clause.phrases();
    let next = phrases[i + 1..].iter().map(|p| &p.sense).find(|s| !matches!(s, Sense::Article | Sense::Quality(..)));
    Some(match &phrases[i].sense {
        // "The steel vase" only describes, where nobody makes it of that.
        Sense::Material(_) if matches!(next, Some(Sense::Objects(_) | Sense::It)) && !several(phrases) => return None,
        Sense::Material(_) => "one thing or part is of one material at a time: \"the top is steel\", \"turn it into water at 1 s\"",
        Sense::Stuff(_) => {
            "stuff that an event or a part brings is more or less of something: \"make the sand stickier\"; \"undo that\" takes it back"
        }
        Sense::Part(_) => match clause.verb() {
            Some(Verb::Stop) => "nothing is cut off; \"the top is sand\", \"the top crumbles at 1 s\" change a part",
            _ => {
                "forces and motions act on the whole of a thing; a part is held, \"hold the base\", is of other stuff, \"the top is rubber\", or changes, \
                 \"the top melts at 1 s\""
            }
        },
        Sense::Negation => "it goes before a motion, \"don't spin\", \"no jump\", and \"stop the wind\" and \"undo\" take something back",
        Sense::Except => "what is left out is a part, and what is asked for a material from the start: \"everything except the top is steel\"",
        Sense::Limit => limit_hint(&draft.words(phrases[i].span.clone()).to_lowercase()),
        Sense::Ends => "say when: \"stop the wind at 1 s\", \"wind from the left until 1 s\"",
        Sense::Verb(verb) if !matches!(verb, Verb::Run | Verb::Look | Verb::Zoom(_) | Verb::Orbit | Verb::Move | Verb::Turn) => {
            "it goes in a clause of its own, \"melt it, and look from above\""
        }
        Sense::Change(_) => "more and less go with what there is: \"less stiff\", \"a weaker wind\", \"half the gravity\"",
        Sense::Replace => "\"replace the water with honey\" says what and by what",
        Sense::Moment(moment) => moment_hint(*moment, clause.verb())?,
        Sense::Deed => "known are, for instance, \"jump\", \"push\", \"drop\", \"throw\", \"spin\", \"pull\", \"hold\", \"stop\", \"melt\"",
        _ if beside::waits_for(&phrases[i], draft.tokens()) => "until what? only a time is understood, \"until 1 s\"",
        Sense::Filler if draft.words(phrases[i].span.clone()).eq_ignore_ascii_case("only") => {
            let (at, _) = phrases.iter().enumerate().skip(i + 1).find(|(_, p)| {
                !matches!(p.sense, Sense::Article | Sense::Preposition(_) | Sense::Filler | Sense::Quality(..) | Sense::Material(_))
            })?;
            let noun = matches!(phrases[at].sense, Sense::Unknown | Sense::Part(_) | Sense::Scenery(_));
            if !noun || !clause.left_indices().any(|left| left == at) {
                return None;
            }
            "forces and motions act on the whole of a thing; \"only\" goes with parts that are of other stuff, \"only the top is steel\""
        }
        _ => return None,
    })
}

fn limit_hint(words: &str) -> &'static str {
    if words.starts_with("from ") {
        "a side goes with its verb, \"wind from the right\", \"look from the right\""
    } else if words.starts_with("mix") || super::lexicon::names_material(words) {
        "a thing is of one material, and so is each part of it: \"the top is rubber and the base is steel\""
    } else {
        "parts are said by name: \"the lower half\", \"the upper third\", \"the base\", \"the flowers\""
    }
}

/// Whether more than one material is named.
fn several(phrases: &[Phrase]) -> bool {
    phrases.iter().filter(|p| matches!(p.sense, Sense::Material(_))).count() > 1
}

fn moment_hint(moment: Moment, verb: Option<Verb>) -> Option<&'static str> {
    Some(match (moment, verb) {
        (Moment::LaterLanding | Moment::AfterLanding | Moment::OnTheWay, _) => super::clauses::when::no_occasion(moment),
        (_, Some(Verb::Field(Field::Explode))) => "a blast has a time and no occasion: \"explode at 1 s\"",
        _ => return None,
    })
}

/// Amounts and times that are left.
fn amount(clause: &Clause, draft: &Draft) -> Option<Refusal> {
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
        Dimension::Viscosity => "a viscosity goes with liquids, \"viscosity 5 Pa s\"",
        Dimension::Tension => "a surface tension goes with liquids, \"surface tension 0.07 N/m\"",
        Dimension::Mass => "a mass follows from the density, \"density 500 kg/m³\"",
        Dimension::FrameRate => "\"at 100 fps\" is the frames a second",
        Dimension::Percent => "it goes with more and less, \"20 % softer\"",
        Dimension::Strange => "what it is a number of is not known: \"30 cm\", \"2 m/s\", \"10 kPa\", \"500 kg/m³\" are",
        Dimension::Times | Dimension::Plain => "a number has its unit, \"jump 30 cm\", \"push it at 2 m/s\", or says how much, \"twice as stiff\"",
    }
}
