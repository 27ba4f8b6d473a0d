//! What a phrase means beside its neighbours, where it alone would be misread: exceptions, winds that die down, waiting,
//! stuff that is there already, and verbs that nobody knows.

use super::phrases::{Phrase, Reading};
use super::sense::{Moment, Preposition, Sense, Verb};
use super::tokens::Token;
use phystalk::spec::{Auto, Material, Spec, presets};

/// All of these, in their order.
pub fn understand(reading: &mut Reading, spec: &Spec) {
    hear_exceptions(reading);
    count_on(&mut reading.phrases, &reading.tokens);
    let mut stretches: Vec<&mut [Phrase]> = reading.phrases.split_mut(|p| p.sense == Sense::Separator).collect();
    let count = stretches.len();
    for (i, stretch) in stretches.iter_mut().enumerate() {
        hear_endings(stretch);
        hear_onset(stretch, &reading.tokens);
        hear_wait(stretch, i + 1 < count);
    }
    know_stuff(&mut reading.phrases, &reading.tokens, spec);
}

/// "All of it but the top is steel", "make it steel but the flowers": between a noun and what asks for something "but"
/// leaves out; elsewhere it only separates.
fn hear_exceptions(reading: &mut Reading) {
    let Reading { tokens, phrases, .. } = reading;
    let separates = |p: &Phrase| p.sense == Sense::Separator;
    for i in 1..phrases.len() {
        if !separates(&phrases[i]) || tokens[phrases[i].span.start].word != "but" || phrases[i].span.len() > 1 {
            continue;
        }
        let begin = phrases[..i].iter().rposition(separates).map_or(0, |at| at + 1);
        let end = (i + 1..phrases.len()).find(|&j| separates(&phrases[j])).unwrap_or(phrases.len());
        let (before, after) = (&phrases[begin..i], &phrases[i + 1..end]);
        let noun = after.iter().find(|p| p.sense != Sense::Article).map(|p| &p.sense);
        let named =
            matches!(noun, Some(Sense::Part(_) | Sense::Objects(_) | Sense::Unknown | Sense::Scenery(_) | Sense::Ground | Sense::Material(_)));
        let all = before.iter().any(|p| matches!(p.sense, Sense::All | Sense::Objects(_) | Sense::Whole));
        let asks = |stretch: &[Phrase]| stretch.iter().any(|p| super::clause::asks(&p.sense));
        if named && (all && !asks(before) || !asks(after)) {
            phrases[i].sense = Sense::Except;
        }
    }
}

/// "0.2 s after impact" is a moment of its own; "0.2 s later" counts on from the time before it.
fn count_on(phrases: &mut [Phrase], tokens: &[Token]) {
    let mut last: Option<Sense> = None;
    for i in 0..phrases.len() {
        let (time_s, later) = match phrases[i].sense {
            Sense::Measure(quantity, _) if quantity.dimension == super::numbers::Dimension::Time => (quantity.value, false),
            Sense::At(at_s) => (at_s, phrases.get(i + 1).is_some_and(|p| tokens[p.span.start].word == "later")),
            Sense::Moment(_) => {
                last = Some(phrases[i].sense.clone());
                continue;
            }
            _ => continue,
        };
        let landed = matches!(phrases.get(i + 1), Some(p) if p.sense == Sense::Moment(Moment::Landing) && tokens[p.span.start].word == "after");
        if landed {
            phrases[i].sense = Sense::Moment(Moment::AfterLanding);
            phrases[i + 1].sense = Sense::Filler;
        } else if later {
            match last {
                Some(Sense::Moment(_)) => phrases[i].sense = Sense::Moment(Moment::AfterLanding),
                Some(Sense::At(before_s)) => phrases[i].sense = Sense::At(before_s + time_s),
                _ => {}
            }
        }
        if let Sense::At(_) | Sense::Moment(_) = phrases[i].sense {
            last = Some(phrases[i].sense.clone());
        }
    }
}

/// "A wind that dies down after 1 s" blows until then.
fn hear_endings(stretch: &mut [Phrase]) {
    let Some(ends) = stretch.iter().position(|p| p.sense == Sense::Ends) else { return };
    let lasts = |p: &Phrase| matches!(p.sense, Sense::Verb(Verb::Blow | Verb::Pull | Verb::Field(_)));
    if stretch[..ends].iter().any(lasts)
        && let Some(time) = stretch[ends..].iter_mut().find(|p| matches!(p.sense, Sense::At(_)))
        && let Sense::At(at_s) = time.sense
    {
        time.sense = Sense::Until(at_s);
        stretch[ends].sense = Sense::Filler;
    }
}

/// "The wind picks up at 0.5 s" begins then; nothing is lifted.
fn hear_onset(stretch: &mut [Phrase], tokens: &[Token]) {
    for i in 1..stretch.len() {
        let picks = matches!(tokens[stretch[i].span.start].word.as_str(), "pick" | "picks") && stretch[i].sense == Sense::Verb(Verb::Lift);
        if picks && stretch[..i].iter().any(|p| p.sense == Sense::Verb(Verb::Blow)) {
            stretch[i].sense = Sense::Filler;
        }
    }
}

/// "Let it stand for a second and then melt": what follows happens so much later.
fn hear_wait(stretch: &mut [Phrase], followed: bool) {
    let waits = stretch.iter().any(|p| p.sense == Sense::Wait);
    let acts = stretch.iter().any(|p| p.sense != Sense::Wait && !matches!(p.sense, Sense::For(_)) && super::clause::asks(&p.sense));
    for phrase in stretch {
        phrase.sense = match phrase.sense {
            Sense::For(wait_s) if waits && !acts && followed => Sense::At(wait_s),
            Sense::Measure(quantity, None) if waits && !acts && followed && quantity.dimension == super::numbers::Dimension::Time => {
                Sense::At(quantity.value)
            }
            Sense::Wait if acts || !followed => Sense::Filler,
            _ => continue,
        };
    }
}

/// "The sand": a whole thing of it, a part of it or what an event makes of it, where there is one. Elsewhere it is a material to be.
fn know_stuff(phrases: &mut [Phrase], tokens: &[Token], spec: &Spec) {
    for i in 1..phrases.len() {
        let Sense::Material(name) = phrases[i].sense else { continue };
        let definite = phrases[i - 1].sense == Sense::Article && tokens[phrases[i - 1].span.start].word == "the";
        let describes = matches!(
            phrases.get(i + 1).map(|p| &p.sense),
            Some(Sense::Objects(_) | Sense::Unknown | Sense::Ground | Sense::Scenery(_) | Sense::Part(_) | Sense::It | Sense::Material(_))
        );
        if !definite || describes {
            continue;
        }
        let whole: Vec<usize> = (0..spec.objects.len()).filter(|&o| is_of(&spec.objects[o].material, name)).collect();
        let part = spec.objects.iter().flat_map(|o| &o.parts).any(|p| is_of(&p.material, name));
        let event = spec.events.iter().filter_map(|e| e.material.as_ref()).any(|m| is_of(m, name));
        if !whole.is_empty() {
            phrases[i].sense = Sense::Objects(whole);
        } else if part || event {
            phrases[i].sense = Sense::Stuff(name);
        }
    }
}

/// Whether a material is a preset, or what more and less made of it: as heavy still, or as stiff.
pub fn is_of(material: &Material, name: &str) -> bool {
    let young = |m: &Material| if let Some(Auto::Value(young)) = m.young_pa() { Some(young) } else { None };
    presets::material(name).is_some_and(|preset| {
        let preset = &preset.material;
        material.kind() == preset.kind()
            && (material.density_kg_m3() == preset.density_kg_m3() || young(material).is_some() && young(material) == young(preset))
    })
}

/// A word that nobody knows where a verb stands, "zap the wind": to do the rest without it would be to do something else.
pub fn hear_deeds(reading: &mut Reading) {
    let tokens = &reading.tokens;
    for stretch in reading.phrases.split_mut(|p| p.sense == Sense::Separator) {
        let Some(first) = stretch.iter().position(|p| p.sense != Sense::Filler) else { continue };
        // "The wind" is one word for a verb.
        let governs = stretch.get(first + 1).is_some_and(|p| match p.sense {
            Sense::Article | Sense::It => true,
            Sense::Verb(_) => matches!(tokens[p.span.start].word.as_str(), "the" | "a"),
            _ => false,
        });
        let adverb = tokens[stretch[first].span.start].word.ends_with("ly");
        let letters = tokens[stretch[first].span.start].word.chars().all(char::is_alphabetic);
        if stretch[first].sense == Sense::Unknown && governs && letters && !adverb {
            stretch[first].sense = Sense::Deed;
        }
    }
}

/// Whether "until" stands before something that is no time.
pub fn waits_for(phrase: &Phrase, tokens: &[Token]) -> bool {
    phrase.sense == Sense::Preposition(Preposition::Until) && tokens[phrase.span.end - 1].word != "to"
}
