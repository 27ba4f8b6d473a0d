//! What becomes of the spec while a request is read, clause by clause. The edits are the difference in the end, so
//! that they are few, and none contradicts another.

use super::Context;
use super::clause::Clause;
use super::clauses::when::When;
use super::directions::Frame;
use super::reference;
use super::say;
use super::sense::{Property, Sense, Verb};
use super::tokens::Token;
use glam::{DMat3, DVec3, EulerRot};
use phystalk::spec::{Auto, Camera, Event, Material, Object, Spec};
use phystalk::world::{ObjectFacts, Seam};
use std::ops::Range;

/// Why a clause is refused, as a sentence.
pub type Refusal = String;

/// More or less of a property, as it was said.
struct Compared {
    property: Property,
    more: bool,
    /// The clause's verb: what stands alone speaks of any.
    verb: Option<Verb>,
    /// Objects, parts and times of the clause.
    whose: (Vec<usize>, Vec<Sense>),
    said: String,
}

/// A spec being changed.
pub struct Draft<'a> {
    /// What the request is about.
    pub context: &'a Context<'a>,
    /// The request as written.
    tokens: &'a [Token],
    /// The spec so far.
    pub spec: Spec,
    /// What was understood, one sentence each.
    pub gloss: Vec<String>,
    /// The objects that were spoken of last.
    subject: Option<Vec<usize>>,
    /// Whether the newest turn was taken back first.
    pub undone: bool,
    /// Whether the request begins with a "no,": it says otherwise what the newest turn said.
    pub corrects: bool,
    /// What was asked to be more or less of something: of whom, and which way.
    compared: Vec<Compared>,
    /// Whether this request sent something up or placed it high: it falls by itself.
    pub aloft: bool,
}

impl<'a> Draft<'a> {
    /// Starts from `spec`.
    pub fn new(context: &'a Context<'a>, tokens: &'a [Token], spec: Spec) -> Draft<'a> {
        let undone = spec != *context.spec;
        Draft { context, tokens, spec, gloss: Vec::new(), subject: None, undone, corrects: false, compared: Vec::new(), aloft: false }
    }

    /// Some words of the request, as written.
    pub fn words(&self, span: Range<usize>) -> String {
        self.tokens[span].iter().map(|t| t.text.as_str()).collect::<Vec<_>>().join(" ")
    }

    /// The request's tokens.
    pub fn tokens(&self) -> &[Token] {
        self.tokens
    }

    /// The objects that a clause is about: those it names, else those spoken of before, else the only one.
    pub fn subjects(&mut self, clause: &mut Clause) -> Result<Vec<usize>, Refusal> {
        let named: Vec<usize> = clause
            .phrases()
            .iter()
            .filter_map(|p| match &p.sense {
                Sense::Objects(objects) => Some(objects.clone()),
                Sense::All => Some((0..self.spec.objects.len()).collect()),
                _ => None,
            })
            .flatten()
            .fold(Vec::new(), |mut all, object| {
                if !all.contains(&object) {
                    all.push(object);
                }
                all
            });
        if !named.is_empty() {
            self.subject = Some(named.clone());
            return Ok(named);
        }
        if let Some(noun) = reference::stranger(clause.phrases()) {
            let span = clause.phrases()[noun.start].span.start..clause.phrases()[noun.end - 1].span.end;
            return Err(format!("{}: no such object; {}", self.words(span), self.names()));
        }
        if stands_for_object(clause) {
            return Err(format!("the ground and what stands on it do not move; {}", self.names()));
        }
        if self.spec.objects.is_empty() {
            return Err("the scene has no object that moves".to_owned());
        }
        match &self.subject {
            Some(objects) => Ok(objects.clone()),
            None if self.spec.objects.len() == 1 => Ok(vec![0]),
            None => match self.changed_last() {
                Some(object) => Ok(vec![object]),
                None => Err(format!("which one? {}", self.names())),
            },
        }
    }

    /// Notes that a clause asks for more or less of a property; refuses the opposite of what was asked before of the same.
    pub fn compare(&mut self, property: Property, more: bool, clause: &mut Clause) -> Result<(), Refusal> {
        let of_clause =
            |s: &Sense| matches!(s, Sense::Part(_) | Sense::Stuff(_) | Sense::Scenery(_) | Sense::Ground | Sense::At(_) | Sense::Moment(_));
        let kinds = clause.phrases().iter().map(|p| &p.sense).filter(|s| of_clause(s)).cloned().collect();
        let whose = (self.subjects(clause).unwrap_or_default(), kinds);
        let word = |s: &Sense| matches!(s, Sense::Quality(p, ..) | Sense::Property(p) if *p == property);
        let phrase = clause.phrases().iter().find(|p| word(&p.sense)).map(|p| p.span.clone());
        let said = phrase.map_or_else(|| if more { "more" } else { "less" }.to_owned(), |span| self.words(span));
        let property = if property == Property::Hardness { Property::Stiffness } else { property };
        let verb = clause.verb();
        let opposes =
            |c: &&Compared| c.property == property && c.more != more && c.whose == whose && (c.verb.is_none() || verb.is_none() || c.verb == verb);
        if let Some(other) = self.compared.iter().find(opposes) {
            return Err(format!("\"{}\" and \"{said}\" pull opposite ways: say one of them, or of which part or thing each", other.said));
        }
        self.compared.push(Compared { property, more, verb, whose, said });
        Ok(())
    }

    /// The only object that the newest turn changed.
    fn changed_last(&self) -> Option<usize> {
        let before = self.context.previous_spec?;
        let mut changed = self.spec.objects.iter().enumerate().filter(|(_, o)| {
            let events = |spec: &Spec| spec.events.iter().filter(|e| e.object == o.name).cloned().collect::<Vec<_>>();
            before.objects.iter().find(|b| b.name == o.name) != Some(*o) || events(before) != events(self.context.spec)
        });
        let (first, _) = changed.next()?;
        changed.next().is_none().then_some(first)
    }

    fn names(&self) -> String {
        let names: Vec<String> = self.spec.objects.iter().map(|o| o.name.clone()).collect();
        if names.len() == 1 { format!("there is: {}", names[0]) } else { format!("there are: {}", say::list(&names)) }
    }

    /// An object of the spec.
    pub fn object(&mut self, index: usize) -> &mut Object {
        &mut self.spec.objects[index]
    }

    /// Its name.
    pub fn name(&self, index: usize) -> String {
        self.spec.objects[index].name.clone()
    }

    /// What it is made of.
    pub fn material(&mut self, index: usize) -> &mut Material {
        &mut self.spec.objects[index].material
    }

    /// Where an object parts in two: its flowers from its pot.
    pub fn seam(&self, index: usize) -> Seam {
        let name = &self.spec.objects[index].name;
        let known = self.context.facts.objects.iter().zip(&self.context.facts.seams).find(|(facts, _)| facts.name == *name);
        known.map(|(_, seam)| *seam).unwrap_or_default()
    }

    /// What is known of an object's shape. An object without facts is a metre cube on the ground.
    pub fn facts(&self, index: usize) -> ObjectFacts {
        let object = &self.spec.objects[index];
        let found = self.context.facts.objects.iter().find(|f| f.name == object.name).cloned();
        found.unwrap_or_else(|| {
            let ground = self.context.facts.ground_m;
            ObjectFacts {
                name: object.name.clone(),
                gaussians: 0,
                low_m: [-0.5, -0.5, ground],
                high_m: [0.5, 0.5, ground + 1.0],
                centre_m: [0.0, 0.0, ground + 0.5],
                support_m: ground,
                forward: object.forward,
            }
        })
    }

    /// An object's longest side, metres.
    pub fn size_m(&self, index: usize) -> f64 {
        let facts = self.facts(index);
        (DVec3::from_array(facts.high_m) - DVec3::from_array(facts.low_m)).max_element().max(1e-6)
    }

    /// Directions as an object and the camera see them.
    pub fn frame(&self, index: usize) -> Frame {
        let place = DVec3::from_array(self.facts(index).centre_m) + DVec3::from_array(self.spec.objects[index].offset_m);
        Frame::new(self.spec.objects[index].forward, place, &self.camera())
    }

    /// The camera: the spec's, or the one that was resolved.
    pub fn camera(&self) -> Camera {
        self.spec.camera.unwrap_or(self.context.facts.camera)
    }

    /// Strength of free fall in the spec so far, m/s2.
    pub fn gravity_m_s2(&self) -> f64 {
        DVec3::from_array(self.spec.world.gravity_m_s2).length()
    }

    /// Free fall for heights: 9.81 m/s2 where there is none.
    pub fn gravity_for_heights_m_s2(&self) -> f64 {
        let gravity = self.gravity_m_s2();
        if gravity < 1e-6 { 9.81 } else { gravity }
    }

    /// A resolved number of the version that is talked about.
    pub fn resolved(&self, path: &str) -> Option<f64> {
        (self.context.resolved)(path)
    }

    /// Height of an object's lowest point over what is below it at t = 0. Of a turned object the corners of its box
    /// stand for it, which is exact for quarter turns and never too high.
    pub fn gap_m(&self, index: usize) -> f64 {
        let facts = self.facts(index);
        let object = &self.spec.objects[index];
        let centre = DVec3::from_array(facts.centre_m);
        let rotation = rotation(object.rotate_deg);
        let corners =
            (0..8).map(|i| DVec3::from_array([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { facts.low_m[axis] } else { facts.high_m[axis] })));
        let low = corners.map(|corner| (rotation * (corner - centre) + centre).z).fold(f64::INFINITY, f64::min);
        tidy_length(low + object.offset_m[2] - facts.support_m)
    }

    /// Places an object so that its lowest point is `gap_m` over what is below it.
    pub fn set_gap_m(&mut self, index: usize, gap_m: f64) {
        let rise = gap_m - self.gap_m(index);
        let offset = &mut self.spec.objects[index].offset_m[2];
        *offset = tidy_length(*offset + rise);
    }

    /// Sets the part of an object's initial velocity that lies along `unit`; the rest stays.
    pub fn set_speed_along(&mut self, index: usize, unit: DVec3, speed_m_s: f64) {
        let velocity = DVec3::from_array(self.spec.objects[index].velocity_m_s);
        self.spec.objects[index].velocity_m_s = say::tidy3(velocity + (speed_m_s - velocity.dot(unit)) * unit);
    }

    /// Adds a push then, or replaces the object's push then.
    pub fn push_at(&mut self, index: usize, when: When, push_m_s: DVec3, stem: &str) {
        let push = Some(say::tidy3(push_m_s));
        self.happen(index, None, when, stem, |event| event.push_m_s = push, |event| event.push_m_s.is_some());
    }

    /// Adds an event of an object, or of a part of it, or changes the one that there is then of that `kind`.
    pub fn happen(
        &mut self,
        index: usize,
        part: Option<String>,
        when: When,
        stem: &str,
        fill: impl FnOnce(&mut Event),
        kind: impl Fn(&Event) -> bool,
    ) {
        let object = self.name(index);
        let same = |e: &&mut Event| e.object == object && e.part == part && when.is_of(e) && kind(e);
        if let Some(event) = self.spec.events.iter_mut().find(same) {
            return fill(event);
        }
        let name = self.free_name(stem, |spec, name| spec.events.iter().any(|e| e.name == name));
        let mut event = Event { part, ..when.event(&name, &object) };
        fill(&mut event);
        self.spec.events.push(event);
    }

    /// The first of stem1, stem2, … that is not in use.
    pub fn free_name(&self, stem: &str, used: impl Fn(&Spec, &str) -> bool) -> String {
        let mut number = 1;
        while used(&self.spec, &format!("{stem}{number}")) {
            number += 1;
        }
        format!("{stem}{number}")
    }

    /// The stem itself where it is not in use, else the first of stem1, stem2, … that is not.
    pub fn plain_name(&self, stem: &str, used: impl Fn(&Spec, &str) -> bool) -> String {
        if used(&self.spec, stem) { self.free_name(stem, used) } else { stem.to_owned() }
    }

    /// Length of the run, seconds: given, resolved, or the shortest automatic one.
    pub fn duration_s(&self) -> f64 {
        match self.spec.time.duration_s {
            Auto::Value(duration) => duration,
            Auto::Auto => self.resolved("time.duration_s").unwrap_or(2.0),
        }
    }
}

/// Angles of a spec to a rotation: about fixed x, then y, then z.
pub fn rotation(rotate_deg: [f64; 3]) -> DMat3 {
    let [x, y, z] = rotate_deg.map(f64::to_radians);
    DMat3::from_euler(EulerRot::ZYX, z, y, x)
}

/// A rotation to angles of a spec.
pub fn rotate_deg(rotation: DMat3) -> [f64; 3] {
    let (z, y, x) = rotation.to_euler(EulerRot::ZYX);
    [x, y, z].map(|angle| {
        let degrees = (angle.to_degrees() * 1e6).round() / 1e6;
        if degrees == 0.0 || degrees == -180.0 { degrees.abs() } else { degrees }
    })
}

/// Lengths to a micrometre.
fn tidy_length(metres: f64) -> f64 {
    let rounded = (metres * 1e6).round() / 1e6;
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// Whether the ground or a collider is what the clause would move: "push the table", not "fall to the table".
fn stands_for_object(clause: &Clause) -> bool {
    let senses: Vec<&Sense> = clause.phrases().iter().map(|p| &p.sense).filter(|s| **s != Sense::Filler).collect();
    let it = senses.iter().any(|s| matches!(s, Sense::It));
    !it && senses.iter().enumerate().any(|(i, sense)| {
        let before = senses[..i].iter().rev().find(|s| ***s != Sense::Article);
        **sense == Sense::Ground && matches!(before, None | Some(Sense::Verb(_)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_come_back() {
        for angles in [[0.0, 0.0, 90.0], [180.0, 0.0, 0.0], [30.0, 40.0, 50.0], [90.0, 0.0, 0.0]] {
            let back = rotate_deg(rotation(angles));
            assert!(back.iter().zip(angles).all(|(a, b)| (a - b).abs() < 1e-4), "{angles:?} {back:?}");
        }
        // About fixed x first: y goes to z.
        assert!((rotation([90.0, 0.0, 0.0]) * DVec3::Y - DVec3::Z).length() < 1e-12);
    }
}
