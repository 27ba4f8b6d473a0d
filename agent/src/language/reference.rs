//! Nouns that nobody knows, where an object is meant. In a scene of one object that one is meant, whatever it is called:
//! a capture is named after its file, and people say what they see. Among several objects nobody can know.

use super::phrases::{Phrase, Reading};
use super::sense::{Part, Preposition, Sense, Unbuilt, Verb};
use std::ops::Range;

/// Nouns of parts ("flowers", "pot") are such only where the stretch asks for something that a part can have: "push the
/// flowers" means the thing that they stand in.
pub fn demote_parts(reading: &mut Reading) {
    // "The base and the flowers" goes with what was asked of the base, "the flowers and the pot are steel" with what is to come.
    let asks = reading.phrases.split(|p| p.sense == Sense::Separator).map(asks_of_part).collect::<Vec<_>>();
    for (i, stretch) in reading.phrases.split_mut(|p| p.sense == Sense::Separator).enumerate() {
        let asked = asks[..=i].iter().rev().chain(&asks[i..]).find_map(|asks| *asks).unwrap_or(false);
        if !asked {
            stretch.iter_mut().filter(|p| is_noun_of_part(&p.sense)).for_each(|p| p.sense = Sense::Unknown);
        }
    }
}

fn is_noun_of_part(sense: &Sense) -> bool {
    matches!(sense, Sense::Part(Part::Flowers | Part::Pot))
}

/// Whether a stretch asks for something that a part can have; none where it asks for nothing.
fn asks_of_part(stretch: &[Phrase]) -> Option<bool> {
    let kept = |verb: Verb| matches!(verb, Verb::Pin | Verb::Hang | Verb::Release | Verb::Change(_));
    let moves = |s: &Sense| matches!(s, Sense::Verb(verb) if !kept(*verb) && !matches!(verb, Verb::Turn | Verb::Move));
    let had = |s: &Sense| {
        matches!(s, Sense::Material(_) | Sense::Quality(..) | Sense::Property(_) | Sense::Unbuilt(_) | Sense::Smoothed(_) | Sense::Measure(..))
            || matches!(s, Sense::Verb(verb) if kept(*verb))
            || matches!(s, Sense::Part(_)) && !is_noun_of_part(s)
    };
    let any = |pick: &dyn Fn(&Sense) -> bool| stretch.iter().any(|p| pick(&p.sense));
    (any(&super::clause::asks) || any(&had)).then(|| !any(&moves) && any(&had))
}

/// Nouns of things around ("wall", "ball") are such only where one is put there, "put a wall on the left", or taken away:
/// "the ball jumps" means the thing that was captured, and "against the wall" one that is not there.
pub fn demote_scenery(reading: &mut Reading) {
    let tokens = &reading.tokens;
    for stretch in reading.phrases.split_mut(|p| p.sense == Sense::Separator) {
        let acts = stretch.iter().any(|p| matches!(p.sense, Sense::Verb(verb) if !matches!(verb, Verb::Move | Verb::Stop)));
        let denied = stretch.iter().any(|p| matches!(p.sense, Sense::Negation | Sense::Verb(Verb::Stop)));
        for i in 0..stretch.len() {
            let told = stretch[..i].iter().rfind(|p| !describes(&p.sense));
            let new = told.is_some_and(|p| matches!(tokens[p.span.end - 1].word.as_str(), "a" | "an" | "another" | "second"));
            if !matches!(stretch[i].sense, Sense::Scenery(_)) {
                continue;
            }
            // "Drop a ball on it", "shoot it with a ball", "put it in a box": what is put around stands there and nothing else.
            let lead = stretch[..i].iter().rev().map(|p| &p.sense).find(|s| !describes(s) && **s != Sense::Article);
            let other = stretch.iter().any(|p| matches!(p.sense, Sense::It | Sense::Objects(_) | Sense::All));
            let within = matches!(lead, Some(Sense::Preposition(Preposition::With | Preposition::In | Preposition::Into)));
            let first = stretch[..i].iter().all(|p| matches!(p.sense, Sense::Article | Sense::Filler) || describes(&p.sense));
            if !denied && new && (within && other || acts && (!first || other)) {
                stretch[i].sense = Sense::Unbuilt(Unbuilt::Mover);
            } else if acts || !denied && !new {
                stretch[i].sense = Sense::Unknown;
            }
        }
    }
}

/// Reads unknown nouns in the place of an object as `object`, the only one, and notes their tokens as presumed.
pub fn presume(reading: &mut Reading, object: usize) {
    let ends = |p: &Phrase| p.sense == Sense::Separator;
    let mut start = 0;
    while start < reading.phrases.len() {
        let end = (start..reading.phrases.len()).find(|&i| ends(&reading.phrases[i])).unwrap_or(reading.phrases.len());
        // "Only the flowers" is less than all of it.
        let only = |noun: &Range<usize>| {
            let before = reading.phrases[start..start + noun.start].iter().rfind(|p| !describes(&p.sense) && p.sense != Sense::Article);
            before.is_some_and(|p| reading.tokens[p.span.end - 1].word == "only")
        };
        if let Some(noun) = stranger(&reading.phrases[start..end]).filter(|noun| !only(noun)) {
            let noun = start + noun.start..start + noun.end;
            reading.presumed.push(reading.phrases[noun.start].span.start..reading.phrases[noun.end - 1].span.end);
            reading.phrases[noun].iter_mut().for_each(|p| p.sense = Sense::Objects(vec![object]));
        }
        start = end + 1;
    }
}

/// The phrases of a noun that nobody knows and that stands where an object is named: what a verb moves ("push the chair
/// left"), what has a part ("the top of the chair"), or who does something ("the chair jumps"). None where the stretch says otherwise whom it means.
pub fn stranger(phrases: &[Phrase]) -> Option<Range<usize>> {
    if phrases.iter().any(|p| matches!(p.sense, Sense::Objects(_) | Sense::It | Sense::All)) {
        return None;
    }
    let unknown = |i: usize| phrases.get(i).is_some_and(|p| p.sense == Sense::Unknown);
    (0..phrases.len()).filter(|&i| unknown(i) && (i == 0 || !unknown(i - 1))).find_map(|i| {
        let end = (i..).find(|&j| !unknown(j)).unwrap_or(phrases.len());
        let said = &phrases[..i];
        let told = said.iter().rposition(|p| !describes(&p.sense)).map(|at| &phrases[at].sense);
        let article = told == Some(&Sense::Article);
        let before = said.iter().rev().map(|p| &p.sense).find(|s| !describes(s) && **s != Sense::Article);
        let begins = matches!(before, None | Some(Sense::Filler));
        let moved = matches!(before, Some(Sense::Verb(_)));
        let has = article && before == Some(&Sense::Preposition(Preposition::Of));
        let does = matches!(phrases.get(end).map(|p| &p.sense), Some(Sense::Verb(_) | Sense::Quality(..)));
        ((article && (begins || moved || has)) || (begins && does)).then_some(i..end)
    })
}

/// Adjectives between an article and its noun.
fn describes(sense: &Sense) -> bool {
    matches!(sense, Sense::Material(_) | Sense::Unbuilt(_) | Sense::Quality(..) | Sense::Whole)
}
