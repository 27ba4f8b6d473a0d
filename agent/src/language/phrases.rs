//! Tokens to phrases: each stretch of words becomes one [`Phrase`] with a meaning, longest match first, and times
//! are put together from their prepositions and numbers. Nothing is dropped here: a word without a meaning is a
//! phrase too.

use super::lexicon::{PATTERNS, SECTIONS};
use super::numbers::{self, Dimension, Quantity};
use super::sense::{Form, Moment, Preposition, Property, Sense};
use super::tokens::Token;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::LazyLock;

/// A stretch of tokens with one meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Phrase {
    /// What it means.
    pub sense: Sense,
    /// Its tokens.
    pub span: Range<usize>,
}

/// Names of the spec's objects as words.
pub struct Names {
    names: Vec<Vec<String>>,
}

impl Names {
    /// From the objects' names: "lego_bulldozer" is heard as "lego bulldozer" and as "bulldozer".
    pub fn new<'a>(names: impl Iterator<Item = &'a str>) -> Names {
        Names { names: names.map(|n| n.split(['_', '-', '.', ' ']).filter(|w| !w.is_empty()).map(str::to_lowercase).collect()).collect() }
    }

    /// The objects named at `at`, and how many tokens name them: whole names first, then words that all bearers share.
    fn read(&self, tokens: &[Token], at: usize) -> Option<(Vec<usize>, usize)> {
        let starts = |name: &[String]| !name.is_empty() && name.iter().enumerate().all(|(i, w)| tokens.get(at + i).is_some_and(|t| t.word == *w));
        let longest = self.names.iter().enumerate().filter(|(_, n)| starts(n)).max_by_key(|(_, n)| n.len());
        if let Some((index, name)) = longest {
            return Some((vec![index], name.len()));
        }
        let word = &tokens.get(at)?.word;
        if word.chars().count() < 3 || !word.chars().all(char::is_alphabetic) {
            return None;
        }
        let holding = |w: &str| -> Vec<usize> { self.names.iter().enumerate().filter(|(_, n)| n.iter().any(|m| m == w)).map(|(i, _)| i).collect() };
        let found = holding(word);
        if !found.is_empty() {
            return Some((found, 1));
        }
        let singular = word.strip_suffix('s').map(holding).unwrap_or_default();
        (!singular.is_empty()).then_some((singular, 1))
    }

    fn words(&self) -> impl Iterator<Item = &str> {
        self.names.iter().flatten().map(String::as_str)
    }
}

/// Phrases of a request, and what was read otherwise than written: "read 'vsae' as 'vase'".
pub struct Reading {
    /// The tokens after correction; texts stay as written.
    pub tokens: Vec<Token>,
    /// The phrases, in order, covering every token.
    pub phrases: Vec<Phrase>,
    /// Corrections, as sentences.
    pub corrections: Vec<String>,
    /// Whether it begins with a "no,".
    pub corrects: bool,
    /// Tokens that were taken for the only object there is.
    pub presumed: Vec<Range<usize>>,
}

/// Reads all phrases. A misspelt word is mended first and then read with its neighbours, as if it had been written so:
/// "1 secnd" is a time.
pub fn read(mut tokens: Vec<Token>, names: &Names) -> Reading {
    let mut corrections = Vec::new();
    let mut phrases = cover(&tokens, names);
    let mut at = 0;
    while let Some(i) = (at..phrases.len()).find(|&i| phrases[i].sense == Sense::Unknown) {
        let token = phrases[i].span.start;
        let next = phrases.get(i + 1).map(|p| &p.sense);
        let place = match (i > 0 && phrases[i - 1].sense == Sense::Article, next) {
            (false, _) => Place::Any,
            (true, Some(Sense::Objects(_) | Sense::Unknown | Sense::Material(_) | Sense::Property(_))) => Place::Describing,
            (true, _) => Place::Noun,
        };
        match correct(&tokens[token].word, names, place) {
            Some(known) => {
                corrections.push(format!("read '{}' as '{known}'", tokens[token].text));
                tokens[token].word = known;
                phrases = cover(&tokens, names);
                // Mended once: a word that is still not understood goes on as it is.
                at = phrases.iter().position(|p| p.span.start > token).unwrap_or(phrases.len());
            }
            None => at = i + 1,
        }
    }
    doubt_units(&mut phrases);
    lead_measures(&mut phrases);
    scale_gravity(&mut phrases);
    hear_complaints(&mut phrases, &tokens);
    tell_times(&mut phrases);
    Reading { tokens, phrases, corrections, corrects: false, presumed: Vec::new() }
}

/// The longest phrase at each place, one after the other.
fn cover(tokens: &[Token], names: &Names) -> Vec<Phrase> {
    let mut phrases: Vec<Phrase> = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let (sense, length) = read_one(tokens, at, names).unwrap_or((Sense::Unknown, 1));
        phrases.push(Phrase { sense, span: at..at + length });
        at += length;
    }
    phrases
}

/// The longest of: an object's name, a number with its unit, a pattern of the lexicon. A tie goes to the name, then to the lexicon.
fn read_one(tokens: &[Token], at: usize, names: &Names) -> Option<(Sense, usize)> {
    let name = names.read(tokens, at).map(|(objects, length)| (Sense::Objects(objects), length));
    let pattern = pattern(tokens, at);
    let measure = span_of_time(tokens, at).or_else(|| measure(tokens, at));
    [name, pattern, measure, first_seconds(tokens, at), version(tokens, at), landing(tokens, at, names), bounce(tokens, at)]
        .into_iter()
        .flatten()
        .fold(None, |best: Option<(Sense, usize)>, next| match best {
            Some(best) if best.1 >= next.1 => Some(best),
            _ => Some(next),
        })
}

fn pattern(tokens: &[Token], at: usize) -> Option<(Sense, usize)> {
    let fits = |words: &[&str]| words.iter().enumerate().all(|(i, w)| tokens.get(at + i).is_some_and(|t| t.word == *w));
    let pattern = PATTERNS.get(tokens[at].word.as_str())?.iter().find(|p| fits(&p.words))?;
    Some((pattern.sense.clone(), pattern.words.len()))
}

fn measure(tokens: &[Token], at: usize) -> Option<(Sense, usize)> {
    let (quantity, end) = numbers::quantity(tokens, at)?;
    // "half", "a third", "two thirds" alone are shares of something.
    let share = quantity.dimension == Dimension::Plain && tokens[at].number.is_none() && quantity.value > 0.0 && quantity.value < 1.0;
    let sense = match quantity.dimension {
        Dimension::Times => Sense::Factor(quantity.value),
        _ if share => Sense::Factor(quantity.value),
        _ => Sense::Measure(quantity, None),
    };
    Some((sense, end - at))
}

/// "when the vase hits the floor", "as soon as it touches something": who meets what goes by whom the clause is about.
fn landing(tokens: &[Token], at: usize, names: &Names) -> Option<(Sense, usize)> {
    let word = |i: usize| tokens.get(i).map_or("", |t| t.word.as_str());
    let article = |i: usize| usize::from(matches!(word(i), "the" | "a" | "an" | "its"));
    let who = match (word(at), word(at + 1), word(at + 2)) {
        ("when" | "once" | "if" | "after", ..) => at + 1,
        ("the", "moment", _) => at + 2,
        ("as", "soon", "as") => at + 3,
        _ => return None,
    };
    // "After two bounces"
    if let Some((times, verb)) =
        numbers::number(tokens, who).filter(|(_, end)| matches!(word(*end), "bounce" | "bounces" | "impacts" | "hits" | "landings"))
    {
        let moment = if times == 1.0 { Moment::Landing } else { Moment::LaterLanding };
        return Some((Sense::Moment(moment), verb + 1 - at));
    }
    // Whom nobody knows is left to be reported.
    let named = |i: usize| match names.read(tokens, i) {
        Some((_, length)) => Some(length),
        None => matches!(word(i), "this" | "that" | "thing" | "object" | "everything" | "one").then_some(1),
    };
    let verb = match word(who) {
        "it" | "they" if matches!(word(who + 1), "has" | "have" | "first") => who + 2,
        "it" | "they" => who + 1,
        _ => who + article(who) + named(who + article(who))?,
    };
    if !matches!(
        word(verb),
        "land"
            | "lands"
            | "landed"
            | "bounce"
            | "bounces"
            | "bounced"
            | "touched"
            | "struck"
            | "hit"
            | "hits"
            | "touch"
            | "touches"
            | "strike"
            | "strikes"
            | "meet"
            | "meets"
            | "collide"
            | "collides"
            | "crash"
            | "crashes"
    ) {
        return None;
    }
    let preposition = usize::from(matches!(word(verb + 1), "on" | "onto" | "into" | "with" | "against"));
    let what = verb + 1 + preposition;
    let what = what + article(what);
    let known =
        matches!(word(what), "ground" | "floor" | "table" | "surface" | "plinth" | "shelf" | "desk" | "wall" | "something" | "anything" | "it");
    let length = match names.read(tokens, what) {
        Some((_, length)) => length,
        None => usize::from(known),
    };
    let end = if length > 0 { what + length } else { verb + 1 };
    match (word(end), word(end + 1), word(end + 2)) {
        ("again", ..) => Some((Sense::Moment(Moment::LaterLanding), end + 1 - at)),
        ("a" | "the", "second" | "third", "time") => Some((Sense::Moment(Moment::LaterLanding), end + 3 - at)),
        ("the", "first", "time") => Some((Sense::Moment(Moment::Landing), end + 3 - at)),
        _ => Some((Sense::Moment(Moment::Landing), end - at)),
    }
}

/// "at the first bounce", "after the second impact".
fn bounce(tokens: &[Token], at: usize) -> Option<(Sense, usize)> {
    let word = |i: usize| tokens.get(i).map_or("", |t| t.word.as_str());
    if !matches!(word(at), "at" | "on" | "upon" | "after" | "with" | "during") {
        return None;
    }
    let ordinal = at + 1 + usize::from(matches!(word(at + 1), "the" | "its" | "a"));
    let (moment, noun) = match word(ordinal) {
        "first" | "initial" => (Moment::Landing, ordinal + 1),
        "second" | "third" | "fourth" | "fifth" | "next" | "last" | "final" | "other" | "each" | "every" | "any" => {
            (Moment::LaterLanding, ordinal + 1)
        }
        _ => (Moment::Landing, ordinal),
    };
    let meets = matches!(word(noun), "bounce" | "impact" | "landing" | "hit" | "contact" | "touch" | "touchdown" | "collision");
    meets.then_some((Sense::Moment(moment), noun + 1 - at))
}

/// "for the first second", "in the first 0.5 s": from the start until then.
fn first_seconds(tokens: &[Token], at: usize) -> Option<(Sense, usize)> {
    let word = |i: usize| tokens.get(i).map_or("", |t| t.word.as_str());
    let first = at + usize::from(matches!(word(at), "for" | "in" | "during" | "over" | "within"));
    let first = first + usize::from(word(first) == "the");
    if word(first) != "first" || first == at {
        return None;
    }
    let (quantity, end) = numbers::quantity(tokens, first + 1).or_else(|| numbers::one(tokens, first + 1))?;
    (quantity.dimension == Dimension::Time && quantity.value > 0.0).then_some((Sense::Span(0.0, quantity.value), end - at))
}

/// "from 0.2 s to 1 s", "from 0.2 to 1 s", "between 0.2 and 1 s".
fn span_of_time(tokens: &[Token], at: usize) -> Option<(Sense, usize)> {
    if !matches!(tokens[at].word.as_str(), "from" | "between") {
        return None;
    }
    let (first, middle) = numbers::quantity(tokens, at + 1)?;
    if !matches!(tokens.get(middle)?.word.as_str(), "to" | "until" | "till" | "and") {
        return None;
    }
    let (last, end) = numbers::quantity(tokens, middle + 1)?;
    let time = |d| matches!(d, Dimension::Time | Dimension::Plain);
    // "Frames 10 to 20": the last number is in the unit of the first.
    let fits = time(last.dimension) && time(first.dimension) && (last.dimension, first.dimension) != (Dimension::Plain, Dimension::Plain);
    fits.then(|| {
        if last.dimension == Dimension::Plain {
            let unit = first.value / plain_value(tokens, at + 1).unwrap_or(first.value);
            return (Sense::Span(first.value, last.value * unit), end - at);
        }
        // "from 200 to 800 ms": the first number is in the unit of the last.
        let unit = if first.dimension == Dimension::Plain { last.value / plain_value(tokens, middle + 1).unwrap_or(last.value) } else { 1.0 };
        (Sense::Span(first.value * unit, last.value), end - at)
    })
}

fn plain_value(tokens: &[Token], at: usize) -> Option<f64> {
    numbers::number(tokens, at).map(|(v, _)| v).filter(|v| *v != 0.0)
}

fn version(tokens: &[Token], at: usize) -> Option<(Sense, usize)> {
    let number = tokens[at].word.strip_prefix('v')?.parse().ok()?;
    Some((Sense::Version(number), 1))
}

/// Gives each measure the preposition before it: "from a height of about 2 m" is a length from.
fn lead_measures(phrases: &mut [Phrase]) {
    for i in 0..phrases.len() {
        let Sense::Measure(quantity, None) = phrases[i].sense else { continue };
        let mut back = i;
        let mut lead = None;
        while back > 0 {
            back -= 1;
            match phrases[back].sense {
                Sense::Preposition(Preposition::Of | Preposition::Around) | Sense::Article | Sense::Filler => {}
                Sense::Property(Property::Height | Property::Speed | Property::Distance | Property::Strength) => {}
                Sense::Preposition(preposition) => {
                    lead = Some(preposition);
                    break;
                }
                _ => break,
            }
        }
        if lead.is_none() {
            if i > 0 && phrases[i - 1].sense == Sense::Preposition(Preposition::Of) {
                phrases[i].sense = Sense::Measure(quantity, Some(Preposition::Of));
            }
            continue;
        }
        phrases[i].sense = Sense::Measure(quantity, lead);
        for between in &mut phrases[back..i] {
            between.sense = Sense::Filler;
        }
    }
}

/// A bare number right before a word that nobody knows is a number of that: to take it for metres would be to guess.
fn doubt_units(phrases: &mut [Phrase]) {
    for i in 1..phrases.len() {
        let strange = phrases[i].sense == Sense::Unknown;
        if let Sense::Measure(quantity, _) = &mut phrases[i - 1].sense
            && strange
            && quantity.dimension == Dimension::Plain
        {
            quantity.dimension = Dimension::Strange;
        }
    }
}

/// A bare number before "gravity" says how many times it: "a sixth of the gravity".
fn scale_gravity(phrases: &mut [Phrase]) {
    for i in 0..phrases.len() {
        let Sense::Measure(Quantity { value, dimension: Dimension::Plain }, _) = phrases[i].sense else { continue };
        let noun = phrases[i + 1..].iter().find(|p| !matches!(p.sense, Sense::Article | Sense::Preposition(Preposition::Of)));
        if noun.is_some_and(|p| p.sense == Sense::Property(Property::Gravity)) {
            phrases[i].sense = Sense::Factor(value);
        }
    }
}

/// "Too soft" asks for less of it, "not stiff enough" for more.
fn hear_complaints(phrases: &mut [Phrase], tokens: &[Token]) {
    let word = |phrase: &Phrase| tokens[phrase.span.end - 1].word.as_str();
    for i in 1..phrases.len() {
        if !matches!(phrases[i].sense, Sense::Quality(_, _, Form::Plain)) {
            continue;
        }
        if phrases[i - 1].sense == Sense::Filler && word(&phrases[i - 1]) == "too" {
            phrases[i - 1].sense = Sense::Change(-1.0);
        } else if phrases[i - 1].sense == Sense::Negation && phrases.get(i + 1).is_some_and(|p| word(p) == "enough") {
            phrases[i - 1].sense = Sense::Change(1.0);
            phrases[i + 1].sense = Sense::Filler;
        }
    }
}

/// Turns measures of time into moments and spans, by their prepositions.
fn tell_times(phrases: &mut [Phrase]) {
    for i in 0..phrases.len() {
        let Sense::Measure(Quantity { value, dimension: Dimension::Time }, lead) = phrases[i].sense else { continue };
        let following = phrases.get(i + 1).map(|p| &p.sense);
        let ends = |at: usize| {
            matches!(
                phrases.get(at).map(|p| &p.sense),
                None | Some(Sense::Separator | Sense::Verb(_) | Sense::It | Sense::Objects(_) | Sense::Filler)
            )
        };
        let in_after = match following {
            Some(Sense::Preposition(Preposition::After)) => true,
            Some(Sense::Preposition(Preposition::In)) => ends(i + 2),
            _ => false,
        };
        let longer = matches!(following, Some(Sense::Quality(Property::Duration, ..)));
        let sense = match lead {
            Some(Preposition::At | Preposition::After | Preposition::In | Preposition::From | Preposition::On) => Sense::At(value),
            Some(Preposition::For) if !longer => Sense::For(value),
            Some(Preposition::Until) => Sense::Until(value),
            None if in_after => Sense::At(value),
            _ => continue,
        };
        phrases[i].sense = sense;
        if in_after && lead.is_none() {
            phrases[i + 1].sense = Sense::Filler;
        }
    }
}

/// Where a word stands that may be misspelt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// Not after an article.
    Any,
    /// Between "the" and a noun.
    Describing,
    /// After "the", with no noun behind it: "push the sofa left" is not about something soft.
    Noun,
}

/// Words of the lexicon and units; those that a misspelt word may have meant, which stand alone or begin something; and
/// which of them may stand after "the".
struct Known {
    all: BTreeSet<&'static str>,
    heads: BTreeSet<&'static str>,
    nouns: BTreeSet<&'static str>,
    adjectives: BTreeSet<&'static str>,
}

static KNOWN: LazyLock<Known> = LazyLock::new(|| {
    let mut known = Known { all: BTreeSet::new(), heads: BTreeSet::new(), nouns: BTreeSet::new(), adjectives: BTreeSet::new() };
    for entry in SECTIONS.iter().flat_map(|s| s.entries) {
        let noun = matches!(
            entry.sense,
            Sense::Material(_)
                | Sense::Gravity(_)
                | Sense::Property(_)
                | Sense::Part(_)
                | Sense::Direction(_)
                | Sense::Camera
                | Sense::Ground
                | Sense::Scenery(_)
        );
        let adjective = matches!(entry.sense, Sense::Quality(_, _, Form::Plain));
        // What is refused is refused for its own name, never for one that looks like it.
        if matches!(entry.sense, Sense::Unbuilt(_)) {
            continue;
        }
        known.heads.extend(entry.words.split('|').filter_map(|phrase| phrase.split(' ').next()).filter(|w| w.len() >= 4));
        for word in entry.words.split(['|', ' ']).filter(|w| w.len() >= 4) {
            known.all.insert(word);
            if noun {
                known.nouns.insert(word);
            }
            if adjective {
                known.adjectives.insert(word);
            }
        }
    }
    for unit in numbers::UNITS.iter().flat_map(|(names, ..)| names.split(' ')).filter(|w| w.len() >= 4) {
        known.all.insert(unit);
        known.heads.insert(unit);
        known.nouns.insert(unit);
    }
    known
});

/// The one known word that is a single insertion, deletion, replacement or transposition away, where there is just one.
///
/// Words under four letters are left alone, and the first letter holds (or changes places with the second): so "flower"
/// is never read as "lower". Names of objects are exempt from the latter.
fn correct(word: &str, names: &Names, place: Place) -> Option<String> {
    let letters = word.chars().count();
    if letters < 4 || KNOWN.all.contains(word) || !word.chars().all(char::is_alphabetic) {
        return None;
    }
    let near = |known: &str| strsim::osa_distance(word, known) == 1;
    let mut named = names.words().filter(|n| n.chars().count() >= 4 && near(n));
    if let Some(name) = named.next() {
        return named.all(|n| n == name).then(|| name.to_owned());
    }
    let starts_alike = |known: &str| {
        let (mut a, mut b) = (word.chars(), known.chars());
        let (a, b) = ((a.next(), a.next()), (b.next(), b.next()));
        a.0 == b.0 || (a.0 == b.1 && a.1 == b.0)
    };
    let fits = |known: &&&str| match place {
        Place::Any => true,
        Place::Describing => KNOWN.nouns.contains(**known) || KNOWN.adjectives.contains(**known),
        Place::Noun => KNOWN.nouns.contains(**known),
    };
    let mut found = KNOWN.heads.iter().filter(fits).filter(|k| starts_alike(k) && near(k));
    let first = found.next()?;
    let rest: Vec<_> = found.collect();
    // "jumsp" is near "jump" and "jumps": one meaning, so either will do.
    let same = |other: &str| {
        let sense = |w: &str| PATTERNS.get(w).and_then(|p| p.iter().find(|p| p.words.len() == 1)).map(|p| p.sense);
        (sense(other).is_some() && sense(other) == sense(first)) || numbers::same_unit(first, other)
    };
    rest.iter().all(|other| same(other)).then(|| (*first).to_owned())
}
