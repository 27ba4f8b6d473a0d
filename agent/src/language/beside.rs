//! What a phrase means beside its neighbours, where it alone would be misread: exceptions, winds that die down, waiting,
//! stuff that is there already, and verbs that nobody knows.

use super::phrases::{Phrase, Reading};
use super::sense::{Moment, Preposition, Sense, TurnWord, Verb};
use super::tokens::Token;
use phystalk::spec::{Material, Spec, Young, presets};

/// All of these, in their order.
pub fn understand(reading: &mut Reading, spec: &Spec) {
    hear_exceptions(reading);
    count_on(&mut reading.phrases, &reading.tokens);
    hear_contrast(&mut reading.phrases);
    hear_undone(&mut reading.phrases, &reading.tokens);
    for stretch in reading.phrases.split_mut(|p| p.sense == Sense::Separator) {
        hear_switch(stretch, &reading.tokens);
    }
    let mut stretches: Vec<&mut [Phrase]> = reading.phrases.split_mut(|p| p.sense == Sense::Separator).collect();
    hear_sides(&mut stretches);
    let count = stretches.len();
    for (i, stretch) in stretches.iter_mut().enumerate() {
        hear_endings(stretch);
        hear_onset(stretch, &reading.tokens);
        hear_instead(stretch);
        hear_watching(stretch, &reading.tokens);
        hear_rock(stretch, &reading.tokens);
        hear_shares(stretch, &reading.tokens);
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

/// "Wind from the left, then from the right": whether the camera or another wind is meant nobody can know.
fn hear_sides(stretches: &mut [&mut [Phrase]]) {
    let mut blown = false;
    for stretch in stretches.iter_mut().filter(|s| !s.is_empty()) {
        let side = |p: &Phrase| matches!(p.sense, Sense::View(view) if super::directions::from_side(view).is_some());
        let acts = |p: &Phrase| super::clause::asks(&p.sense) && !side(p);
        let bare = !stretch.iter().any(acts);
        if let Some(phrase) = stretch.iter_mut().find(|p| bare && blown && side(p)) {
            phrase.sense = Sense::Limit;
        }
        let seen = stretch.iter().any(|p| matches!(p.sense, Sense::Camera | Sense::Verb(Verb::Look)));
        blown = !seen && stretch.iter().any(|p| matches!(p.sense, Sense::Verb(Verb::Blow | Verb::Push(_) | Verb::Pull))) && stretch.iter().any(side);
    }
}

/// "Rubber instead of steel", "left rather than right": what comes after is what is not wanted.
fn hear_instead(stretch: &mut [Phrase]) {
    let Some(at) = stretch.iter().position(|p| p.sense == Sense::Instead && p.span.len() == 2) else { return };
    let unwanted =
        |s: &Sense| matches!(s, Sense::Material(_) | Sense::Direction(_) | Sense::Verb(_) | Sense::Part(_) | Sense::Quality(..) | Sense::It);
    if let Some(next) = stretch[at + 1..].iter_mut().find(|p| !matches!(p.sense, Sense::Article | Sense::Filler))
        && unwanted(&next.sense)
    {
        next.sense = Sense::Filler;
    }
}

/// "Make it steel, not jelly": what is not wanted beside what is.
fn hear_contrast(phrases: &mut [Phrase]) {
    let noun = |s: &Sense| matches!(s, Sense::Material(_) | Sense::Direction(_) | Sense::Part(_));
    let mut start = 0;
    while start < phrases.len() {
        let end = (start..phrases.len()).find(|&i| phrases[i].sense == Sense::Separator).unwrap_or(phrases.len());
        let only = |p: &Phrase| matches!(p.sense, Sense::Negation | Sense::Article | Sense::Preposition(_)) || noun(&p.sense);
        let denied = phrases[start..end].first().is_some_and(|p| p.sense == Sense::Negation) && phrases[start..end].iter().all(only);
        let unwanted = phrases[start..end].iter().find(|p| noun(&p.sense)).map(|p| std::mem::discriminant(&p.sense));
        if denied && unwanted.is_some() && phrases[..start].iter().any(|p| Some(std::mem::discriminant(&p.sense)) == unwanted) {
            phrases[start..end].iter_mut().for_each(|p| p.sense = Sense::Filler);
        }
        let named = |from: usize, to: usize| phrases[from..to].iter().any(|p| matches!(p.sense, Sense::Material(_)));
        let bare = |p: &Phrase| matches!(p.sense, Sense::Material(_) | Sense::Article | Sense::Filler | Sense::Preposition(_));
        // "Rubber and jelly" is neither.
        let before = phrases[..start].iter().rposition(|p| p.sense != Sense::Separator).map_or(0, |i| i + 1);
        let begin = phrases[..before].iter().rposition(|p| p.sense == Sense::Separator).map_or(0, |i| i + 1);
        let parts = phrases[begin..before].iter().any(|p| matches!(p.sense, Sense::Part(_) | Sense::Negation));
        let same = phrases[start..end].iter().all(bare) && named(start, end) && named(begin, before) && !parts;
        if let Some(second) = phrases[start..end].iter_mut().find(|p| same && matches!(p.sense, Sense::Material(_))) {
            second.sense = Sense::Limit;
        }
        start = end + 1;
    }
}

/// "Undo the wind" takes that back, and not the turn before it.
fn hear_undone(phrases: &mut [Phrase], tokens: &[Token]) {
    for i in 1..phrases.len() {
        let named = tokens[phrases[i].span.start].word == "the";
        if named && phrases[i - 1].sense == Sense::Turn(TurnWord::Undo) && phrases[i - 1].span.len() == 1 {
            phrases[i - 1].sense = Sense::Verb(Verb::Stop);
        }
    }
}

/// "Turn the wind off", "turn the wind down", "reverse the wind": what lasts is ended, made less, or turned round.
fn hear_switch(stretch: &mut [Phrase], tokens: &[Token]) {
    let word = |p: &Phrase| tokens[p.span.start].word.as_str();
    let lasts = |p: &Phrase| matches!(p.sense, Sense::Verb(Verb::Blow | Verb::Pull | Verb::Spin | Verb::Field(_)) | Sense::Property(_));
    for i in 0..stretch.len() {
        let single = stretch[i].span.len() == 1;
        let verb = word(&stretch[i]);
        let turns = matches!(verb, "turn" | "turns" | "turned" | "switch" | "switched" | "crank" | "dial" | "ramp");
        let what = stretch.iter().skip(i + 1).position(lasts).map(|at| at + i + 1);
        let Some(what) = what.filter(|_| single) else { continue };
        if matches!(verb, "reverse" | "reverses" | "invert" | "inverts" | "flip" | "flips")
            && stretch[i + 1..what].iter().all(|p| p.sense == Sense::Article)
        {
            stretch[i].sense = Sense::Turn(TurnWord::OtherWay);
            continue;
        }
        let next_to = |at: &usize| *at == i + 1 || *at == what + 1;
        let number = matches!(stretch[what].sense, Sense::Property(_));
        let how = (i + 1..stretch.len()).filter(next_to).find_map(|at| {
            Some((
                at,
                match word(&stretch[at]) {
                    "off" => Sense::Verb(Verb::Stop),
                    "on" => Sense::Filler,
                    "down" => Sense::Change(-1.0),
                    "up" => Sense::Change(1.0),
                    "around" | "round" => Sense::Turn(TurnWord::OtherWay),
                    _ => return None,
                },
            ))
        });
        // A number is more or less, and nothing else.
        if let Some((at, how)) = how.filter(|(_, how)| turns && (!number || matches!(how, Sense::Change(_)))) {
            (stretch[i].sense, stretch[at].sense) = (how, Sense::Filler);
        }
    }
}

/// "Watch it shatter", "see it bounce": what it does is asked for, not where it is seen from.
fn hear_watching(stretch: &mut [Phrase], tokens: &[Token]) {
    for i in 0..stretch.len() {
        let watches =
            stretch[i].sense == Sense::Verb(Verb::Look) && matches!(tokens[stretch[i].span.start].word.as_str(), "see" | "watch" | "watched");
        let next = stretch[i + 1..]
            .iter()
            .map(|p| &p.sense)
            .find(|s| !matches!(s, Sense::It | Sense::Article | Sense::Objects(_) | Sense::All | Sense::Filler));
        if watches && matches!(next, Some(Sense::Verb(verb)) if !matches!(verb, Verb::Look | Verb::Zoom(_) | Verb::Orbit)) {
            stretch[i].sense = Sense::Filler;
        }
    }
}

/// "As hard as rock" is of stone and sways nowhere.
fn hear_rock(stretch: &mut [Phrase], tokens: &[Token]) {
    for i in 1..stretch.len() {
        let before = &stretch[i - 1];
        let named = matches!(
            before.sense,
            Sense::As | Sense::Article | Sense::Material(_) | Sense::Preposition(Preposition::Of | Preposition::Into | Preposition::To)
        ) || matches!(tokens[before.span.end - 1].word.as_str(), "like" | "than");
        if named && tokens[stretch[i].span.start].word == "rock" && stretch[i].span.len() == 1 {
            stretch[i].sense = Sense::Material("stone");
        }
    }
}

/// "The left side of the top", "the vase's neck": parts of parts, and parts that nobody knows, are less than what would be read.
fn hear_shares(stretch: &mut [Phrase], tokens: &[Token]) {
    for i in 1..stretch.len() {
        let before = stretch[..i].iter().rev().map(|p| &p.sense).find(|s| **s != Sense::Article);
        let of_part = before == Some(&Sense::Preposition(Preposition::Of))
            && matches!(stretch[i].sense, Sense::Part(_))
            && stretch[..i]
                .iter()
                .rev()
                .find(|p| !matches!(p.sense, Sense::Article | Sense::Preposition(_)))
                .is_some_and(|p| matches!(p.sense, Sense::Part(_)));
        let owner = &stretch[i - 1];
        let owned = stretch[i].sense == Sense::Unknown
            && matches!(owner.sense, Sense::Objects(_))
            && tokens[owner.span.end - 1].text.to_lowercase().ends_with(['s', '’', '\''])
            && tokens[owner.span.end - 1].text.contains(['\'', '’']);
        let begins = before == Some(&Sense::Preposition(Preposition::From))
            && matches!(stretch[i].sense, Sense::Part(_))
            && stretch.iter().any(|p| matches!(p.sense, Sense::Verb(Verb::Change(_))));
        if of_part || owned || begins {
            stretch[i].sense = Sense::Limit;
        }
    }
}

/// "The wind picks up at 0.5 s" begins then, and nothing is lifted; "a gust hits it" is what gusts do.
fn hear_onset(stretch: &mut [Phrase], tokens: &[Token]) {
    for i in 1..stretch.len() {
        let blown = stretch[..i].iter().any(|p| p.sense == Sense::Verb(Verb::Blow));
        let moved = stretch.get(i + 1).is_some_and(|p| matches!(p.sense, Sense::It | Sense::Article | Sense::Objects(_) | Sense::All));
        if blown && moved && matches!(stretch[i].sense, Sense::Verb(Verb::Push(_))) {
            stretch[i].sense = Sense::Filler;
            continue;
        }
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
    let young = |m: &Material| m.young_pa().and_then(Young::given_pa);
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
        // "Drop the wind", "put the wind back": nobody can.
        for i in 1..stretch.len() {
            let wind = stretch[i].sense == Sense::Verb(Verb::Blow) && matches!(tokens[stretch[i].span.start].word.as_str(), "the" | "a");
            let verb = &mut stretch[i - 1].sense;
            if wind && matches!(verb, Sense::Verb(verb) if !matches!(verb, Verb::Blow | Verb::Stop | Verb::Run | Verb::Look | Verb::Field(_))) {
                *verb = Sense::Deed;
            }
        }
    }
}

/// Whether "until" stands before something that is no time.
pub fn waits_for(phrase: &Phrase, tokens: &[Token]) -> bool {
    phrase.sense == Sense::Preposition(Preposition::Until) && tokens[phrase.span.end - 1].word != "to"
}
