//! The offline phrasebook: words to edits, without a language model.
//!
//! A request is read in four steps, one file each: [`tokens`] (words, numbers, signs), [`phrases`] (stretches of words
//! with one meaning, from the [`lexicon`], [`numbers`] and the objects' names), [`clause`] (what belongs together), and
//! [`clauses`] (what it asks for). A clause's readers *take* the phrases that they use; what nobody took, and is not a
//! small word, is reported word by word. A request is done as a whole or not at all: where a clause is refused, or an
//! amount or a time is left, nothing is changed. Nothing is assumed in silence: amounts that were not given, corrected
//! spellings, directions and whom a noun was taken for are in the gloss.

mod beside;
mod clause;
mod clauses;
mod compare;
mod directions;
mod draft;
mod frames;
mod lexicon;
mod numbers;
#[cfg(test)]
mod page;
mod phrases;
mod reference;
pub mod say;
mod sense;
mod session;
#[cfg(test)]
mod tests;
mod tokens;
mod unheeded;
mod verbs;

use draft::Draft;
use phrases::{Names, Reading};
use phystalk::spec::{Edit, Spec};
use phystalk::world::Facts;
use sense::Sense;

/// What a request came to.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// Changes of the spec; there may be none where all is as asked already.
    Edits {
        /// The changes.
        edits: Vec<Edit>,
        /// What was understood, one sentence each.
        gloss: Vec<String>,
        /// Words that were not understood, as written.
        not_understood: Vec<String>,
    },
    /// Back by so many versions.
    Undo(u32),
    /// Forward by so many.
    Redo(u32),
    /// Back to a version.
    BackTo(VersionRef),
    /// What a version and another one differ in; nothing is changed.
    Compare(VersionRef, VersionRef),
    /// Nothing is done.
    Refused {
        /// Why, and what would be understood.
        reason: String,
        /// Words that were not understood, as written.
        not_understood: Vec<String>,
    },
}

/// A version by what it is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VersionRef {
    /// The first of the session.
    First,
    /// v1, v2, …
    Number(u32),
    /// The newest.
    Last,
    /// The one before the newest.
    Previous,
}

/// What a request is about.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The present spec.
    pub spec: &'a Spec,
    /// The scene in numbers.
    pub facts: &'a Facts,
    /// What `"auto"` comes to at a path of the present spec; it may take a while to find out.
    pub resolved: &'a dyn Fn(&str) -> Option<f64>,
    /// The spec that the newest turn's edits were made on: "no, the other way", "again", "undo that and …".
    pub previous_spec: Option<&'a Spec>,
}

/// Understands a request. The same text and context give the same reply; no text panics.
pub fn understand(text: &str, context: &Context) -> Reply {
    let mut tokens = tokens::tokenise(text);
    match compare::understand(&tokens) {
        Some(Ok((from, to))) => return Reply::Compare(from, to),
        Some(Err(reason)) => return Reply::Refused { reason, not_understood: Vec::new() },
        None => {}
    }
    let names = Names::new(context.spec.objects.iter().map(|o| o.name.as_str()));
    let frames = frames::count(&mut tokens, context.spec.time.fps);
    let mut reading = phrases::read(tokens, &names);
    reading.corrections.extend(frames);
    beside::understand(&mut reading, context.spec);
    reference::demote_parts(&mut reading);
    reference::demote_scenery(&mut reading);
    beside::hear_deeds(&mut reading);
    if context.spec.objects.len() == 1 {
        reference::presume(&mut reading, 0);
    }
    if let Some(reason) = session::question(text, &reading) {
        return refused(reason, &reading);
    }
    session::interjections(&mut reading);
    match session::understand(&mut reading) {
        Ok(session::Turn::None) => with_corrections(edits(&reading, context, context.spec.clone()), &reading),
        Ok(session::Turn::Reply(reply)) => reply,
        Ok(session::Turn::UndoAnd) => match context.previous_spec {
            Some(previous) => with_corrections(edits(&reading, context, previous.clone()), &reading),
            None => refused("there is nothing to undo".to_owned(), &reading),
        },
        Err(reason) => refused(reason, &reading),
    }
}

/// A request that is refused as a whole, with the words of it that nobody knows.
fn refused(reason: String, reading: &Reading) -> Reply {
    let unknown = reading.phrases.iter().filter(|p| matches!(p.sense, Sense::Unknown | Sense::Deed)).map(|p| p.span.clone());
    with_corrections(Reply::Refused { reason, not_understood: words(reading, unknown.chain(reading.presumed.iter().cloned())) }, reading)
}

/// A refusal says what was read otherwise than written: that may be all that is wrong.
fn with_corrections(reply: Reply, reading: &Reading) -> Reply {
    match reply {
        Reply::Refused { reason, not_understood } if !reading.corrections.is_empty() => {
            Reply::Refused { reason: format!("{reason} ({})", reading.corrections.join(", ")), not_understood }
        }
        reply => reply,
    }
}

/// Reads clause by clause into edits, starting from `start`.
fn edits(reading: &Reading, context: &Context, start: Spec) -> Reply {
    let mut draft = Draft::new(context, &reading.tokens, start);
    draft.corrects = reading.corrects;
    let mut clauses = clause::split(reading.phrases.clone());
    // The world of the turn holds for all of it: "jump 30 cm and do it on the moon" is 30 cm on the moon.
    for clause in &mut clauses {
        clauses::world::ahead(clause, &mut draft);
    }
    let mut refusals = Vec::new();
    let mut ignored = Vec::new();
    let (mut understood, mut changed) = (false, false);
    for clause in &mut clauses {
        let before = draft.spec.clone();
        let result = clauses::understand(clause, &mut draft).and_then(|()| match unheeded::refusal(clause, &draft) {
            Some(refusal) => Err(refusal),
            None => Ok(()),
        });
        match result {
            Ok(()) => {
                understood |= clause.took_something();
                changed |= draft.spec != before;
            }
            Err(reason) => {
                // The clauses after it are read all the same, for what is wrong with them.
                draft.spec = before;
                clause.refuse();
                refusals.push(reason);
            }
        }
        ignored.extend(clause.not_understood());
    }
    if !understood || !refusals.is_empty() {
        ignored.extend(reading.presumed.iter().cloned());
    }
    let not_understood = words(reading, ignored.into_iter());
    if !refusals.is_empty() {
        let rest = if understood { "; nothing of the turn was done" } else { "" };
        return Reply::Refused { reason: format!("{}{rest}", refusals.join("; ")), not_understood };
    }
    if !understood {
        return Reply::Refused { reason: reason(&draft, &not_understood), not_understood };
    }
    let edits = context.spec.edits_to(&draft.spec);
    if changed && edits.is_empty() && !draft.undone {
        let reason = format!("that cancels out, and nothing would change: {}", draft.gloss.join("; "));
        return Reply::Refused { reason, not_understood };
    }
    if let Err(error) = context.spec.apply(&edits) {
        return Reply::Refused { reason: error.to_string(), not_understood };
    }
    let mut gloss: Vec<String> = reading.corrections.clone();
    gloss.extend(reading.presumed.iter().map(|span| format!("{} is taken for {}, the only object here", draft.words(span.clone()), draft.name(0))));
    if draft.undone {
        gloss.push("the turn before is undone".to_owned());
    }
    gloss.append(&mut draft.gloss);
    if edits.is_empty() && gloss.is_empty() {
        gloss.push("that is so already".to_owned());
    }
    Reply::Edits { edits, gloss, not_understood }
}

/// Why nothing was done.
fn reason(draft: &Draft, not_understood: &[String]) -> String {
    const CAN: &str = "try, for instance, \"make it jump\", \"drop it from 1 m\", \"push it to the left at 0.5 s\", \"softer\", \"make it of rubber\", \"do it on \
                       the moon\", \"for 3 seconds\", \"look from above\", \"undo that\"";
    // "A steel vase", and nothing else: what was said of the steel is the reason.
    if !draft.gloss.is_empty() {
        return draft.gloss.join("; ");
    }
    if not_understood.is_empty() {
        return format!("nothing to do in that; {CAN}");
    }
    format!("not understood: {}; {CAN}", not_understood.join(", "))
}

/// The words of some stretches, as written, in the order of the request, each once.
fn words(reading: &Reading, spans: impl Iterator<Item = std::ops::Range<usize>>) -> Vec<String> {
    let mut places: Vec<usize> = spans.flatten().collect();
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(|i| reading.tokens[i].text.clone()).collect()
}
