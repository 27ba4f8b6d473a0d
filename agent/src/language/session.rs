//! What concerns the conversation, not the scene: undo, redo, versions, questions, "no,".

use super::numbers::{Dimension, Quantity};
use super::phrases::{Phrase, Reading};
use super::sense::{Sense, TurnWord};
use super::{Reply, VersionRef};
use std::f64::consts::TAU;

/// What a request says about turns.
pub enum Turn {
    /// Nothing.
    None,
    /// Only that.
    Reply(Reply),
    /// One step back, and something else on top; the word for it is out of the reading.
    UndoAnd,
}

/// Why a question is not answered; None for a request, a polite one included.
pub fn question(text: &str, reading: &Reading) -> Option<String> {
    let first = reading.phrases.iter().find(|p| !matches!(p.sense, Sense::Separator))?;
    let word = reading.tokens[first.span.start].word.as_str();
    let asks = first.sense == Sense::Question
        || (text.trim_end().ends_with('?') && matches!(word, "is" | "are" | "was" | "were" | "does" | "do" | "did" | "has"));
    asks.then(|| "the phrasebook changes a simulation and answers no questions; `/help`, `phystalk show` and `metrics.json` tell".to_owned())
}

/// A "no" that only begins a correction ("no, softer") says nothing by itself.
pub fn interjections(reading: &mut Reading) {
    let follows = reading.phrases.get(1).map(|p| &p.sense);
    let only = |p: &Phrase| p.span.len() == 1;
    if let Some(first) = reading.phrases.first()
        && first.sense == Sense::Negation
        && only(first)
        && reading.tokens[first.span.start].word == "no"
        && matches!(follows, Some(Sense::Separator | Sense::Turn(_)))
    {
        reading.phrases[0].sense = Sense::Filler;
        reading.corrects = true;
    }
}

/// Reads undo, redo and versions.
pub fn understand(reading: &mut Reading) -> Result<Turn, String> {
    let words: Vec<TurnWord> = reading
        .phrases
        .iter()
        .filter_map(|p| match p.sense {
            Sense::Turn(word @ (TurnWord::Undo | TurnWord::Redo | TurnWord::BackTo | TurnWord::First)) => Some(word),
            _ => None,
        })
        .collect();
    let rest = |p: &&Phrase| {
        let turn = matches!(p.sense, Sense::Turn(word) if word != TurnWord::OtherWay);
        !turn && !matches!(p.sense, Sense::Separator | Sense::Filler | Sense::It | Sense::Article | Sense::Preposition(_) | Sense::All)
    };
    let counts: Vec<f64> = reading.phrases.iter().filter_map(|p| count(&p.sense)).collect();
    let others = reading.phrases.iter().filter(rest).filter(|p| count(&p.sense).is_none() && !matches!(p.sense, Sense::Version(_))).count();
    let version = reading.phrases.iter().find_map(|p| match p.sense {
        Sense::Version(version) => Some(version),
        _ => None,
    });
    let Some(word) = words.first().copied() else {
        // "v2", "go to v2"
        return Ok(version.filter(|_| others == 0).map_or(Turn::None, |v| Turn::Reply(Reply::BackTo(VersionRef::Number(v)))));
    };
    if others > 0 {
        if word == TurnWord::Undo && words.len() == 1 && counts.is_empty() && version.is_none() {
            reading.phrases.retain(|p| p.sense != Sense::Turn(TurnWord::Undo));
            return Ok(Turn::UndoAnd);
        }
        return Err("going to another version stands alone: say the rest in the next turn".to_owned());
    }
    let steps = counts.first().map_or(words.len() as f64, |c| c.round()).clamp(1.0, 1e6) as u32;
    Ok(Turn::Reply(match word {
        TurnWord::First => Reply::BackTo(VersionRef::First),
        _ if version.is_some() => Reply::BackTo(VersionRef::Number(version.unwrap_or(1))),
        TurnWord::BackTo => match counts.first() {
            Some(number) => Reply::BackTo(VersionRef::Number(*number as u32)),
            None => return Err("back to which version? \"back to v2\", \"back to the first\"".to_owned()),
        },
        TurnWord::Redo => Reply::Redo(steps),
        _ => Reply::Undo(steps),
    }))
}

/// A number of steps or of a version. "Two turns" reads as an angle elsewhere.
fn count(sense: &Sense) -> Option<f64> {
    match sense {
        Sense::Factor(times) if *times >= 1.0 => Some(*times),
        Sense::Measure(Quantity { value, dimension: Dimension::Plain }, _) => Some(*value),
        Sense::Measure(Quantity { value, dimension: Dimension::Angle }, _) => Some(value / TAU),
        _ => None,
    }
}
