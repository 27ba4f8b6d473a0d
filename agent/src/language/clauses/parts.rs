//! Parts of an object as words call them: shares of its height, halves, flowers and their pot.

use super::super::beside::is_of;
use super::super::clause::Clause;
use super::super::draft::{Draft, Refusal};
use super::super::say;
use super::super::sense::{Direction, Part, Sense};
use glam::DVec3;
use phystalk::spec::{self, BoxShape, Material, PlaneShape, Region};
use phystalk::world::Mark;

/// An object, or a part of it that words may speak of.
#[derive(Clone, Debug, PartialEq)]
pub struct Owner {
    /// Index of the object.
    pub object: usize,
    /// Index of the part.
    pub part: Option<usize>,
    /// Index of the event that brings the stuff that is meant.
    pub event: Option<usize>,
    /// How it is said: "vase", "the upper half of vase".
    pub said: String,
}

/// A part as it was said, and where it is.
pub struct Portion {
    /// What it is called in a spec.
    pub stem: &'static str,
    /// Where it is.
    pub region: Region,
    /// "the upper half".
    pub said: &'static str,
    /// How its border was chosen, where nobody said.
    pub chosen: Option<String>,
}

impl Draft<'_> {
    /// What an owner is made of.
    pub fn stuff(&mut self, owner: &Owner) -> &mut Material {
        if let Some(event) = owner.event {
            return self.spec.events[event].material.get_or_insert_default();
        }
        let object = &mut self.spec.objects[owner.object];
        match owner.part {
            Some(part) => &mut object.parts[part].material,
            None => &mut object.material,
        }
    }

    /// Where its material is in the spec.
    pub fn stuff_path(&self, owner: &Owner) -> String {
        if let Some(event) = owner.event {
            return format!("event.{}.material", self.spec.events[event].name);
        }
        let object = &self.spec.objects[owner.object];
        match owner.part {
            Some(part) => format!("object.{}.part.{}.material", object.name, object.parts[part].name),
            None => format!("object.{}.material", object.name),
        }
    }
}

/// The part that a clause names.
pub fn take(clause: &mut Clause) -> Option<Part> {
    clause.take(|s| match s {
        Sense::Part(part) => Some(*part),
        _ => None,
    })
}

/// The parts that a clause names; none where it is about the whole.
pub fn take_all(clause: &mut Clause) -> Vec<Option<Part>> {
    let parts: Vec<Part> = std::iter::from_fn(|| take(clause)).collect();
    let mut each: Vec<Option<Part>> = Vec::new();
    for part in parts {
        match part {
            Part::Ends => each.extend([Some(Part::Top), Some(Part::Base)]),
            part => each.push(Some(part)),
        }
    }
    each.dedup();
    if each.is_empty() { vec![None] } else { each }
}

/// Whom a clause is about: objects, or the parts of each that it names, which are made where there are none; or whatever
/// is of the stuff that it names.
pub fn owners(clause: &mut Clause, draft: &mut Draft) -> Result<Vec<Owner>, Refusal> {
    let stuff = clause.take(|s| match s {
        Sense::Stuff(name) => Some(*name),
        _ => None,
    });
    if let Some(name) = stuff {
        return Ok(owners_of(name, draft));
    }
    let parts = take_all(clause);
    let objects = draft.subjects(clause)?;
    if parts.contains(&Some(Part::Rest)) && super::when::is_said(clause) {
        return Err("the rest changes at a time only where it is named: \"the lower half melts at 1 s\"".to_owned());
    }
    // "Everything", "the whole vase": its parts too.
    let whole = parts == [None] && clause.phrases().iter().any(|p| matches!(p.sense, Sense::All | Sense::Whole));
    if whole {
        let each = |object: usize| {
            let thing = &draft.spec.objects[object];
            let own = thing.parts.iter().enumerate();
            let parts = own.map(move |(part, p)| Owner { object, part: Some(part), event: None, said: format!("{} of {}", p.name, thing.name) });
            std::iter::once(Owner { object, part: None, event: None, said: thing.name.clone() }).chain(parts).collect::<Vec<_>>()
        };
        return Ok(objects.into_iter().flat_map(each).collect());
    }
    Ok(objects
        .into_iter()
        .flat_map(|object| parts.iter().map(move |part| (object, *part)))
        .map(|(object, part)| owner(draft, object, part))
        .collect())
}

/// Whatever is of some stuff: objects, parts of them, and what events make of either.
pub fn owners_of(name: &str, draft: &Draft) -> Vec<Owner> {
    let mut owners = Vec::new();
    for (object, thing) in draft.spec.objects.iter().enumerate() {
        if is_of(&thing.material, name) {
            owners.push(Owner { object, part: None, event: None, said: thing.name.clone() });
        }
        let parts = thing.parts.iter().enumerate().filter(|(_, p)| is_of(&p.material, name));
        owners.extend(parts.map(|(part, p)| Owner { object, part: Some(part), event: None, said: format!("{} of {}", p.name, thing.name) }));
        for (event, happens) in draft.spec.events.iter().enumerate().filter(|(_, e)| e.object == thing.name) {
            if happens.material.as_ref().is_some_and(|m| is_of(m, name)) {
                let said = format!("what {} makes of {}", happens.name, thing.name);
                owners.push(Owner { object, part: None, event: Some(event), said });
            }
        }
    }
    owners
}

/// An object, or the named part of it.
pub fn owner(draft: &mut Draft, object: usize, part: Option<Part>) -> Owner {
    let name = draft.name(object);
    let Some(part) = part else { return Owner { object, part: None, event: None, said: name } };
    // The parts have what is theirs already.
    if part == Part::Rest {
        return Owner { object, part: None, event: None, said: format!("the rest of {name}") };
    }
    let portion = stuff_portion(draft, object, part);
    let said = format!("{} of {name}", portion.said);
    let parts = &draft.spec.objects[object].parts;
    // By its name first: a part that was given another border is still called what it was.
    let known = parts.iter().position(|p| p.name == portion.stem).or_else(|| parts.iter().position(|p| p.region == portion.region));
    if let Some(index) = known {
        return Owner { object, part: Some(index), event: None, said };
    }
    let said = match &portion.chosen {
        Some(chosen) => format!("{said} ({chosen})"),
        None => said,
    };
    let thing = draft.object(object);
    let material = thing.material.clone();
    thing.parts.push(spec::Part { name: portion.stem.to_owned(), region: portion.region, material });
    Owner { object, part: Some(thing.parts.len() - 1), event: None, said }
}

/// Where a part is that is of other stuff: a twentieth is enough to hold a thing by, and too little for that.
fn stuff_portion(draft: &Draft, object: usize, part: Part) -> Portion {
    let portion = portion(draft, object, part);
    match part {
        Part::Top => Portion { region: Region::Above(0.666667), said: "the highest third", ..portion },
        Part::Base => Portion { region: Region::Below(0.333333), said: "the lowest third", ..portion },
        _ => portion,
    }
}

/// Where a part of an object is. Sides are the object's own, in the captured pose.
pub fn portion(draft: &Draft, object: usize, part: Part) -> Portion {
    let facts = draft.facts(object);
    let (low, high) = (DVec3::from_array(facts.low_m), DVec3::from_array(facts.high_m));
    let middle = 0.5 * (low + high);
    let side = |towards: Direction| {
        // Behind a plane is where its normal does not point.
        let normal = (-draft.frame(object).unit(towards)).to_array().map(|x| if x == 0.0 { 0.0 } else { x });
        Region::HalfSpace(PlaneShape { point_m: say::tidy3(middle), normal })
    };
    let waist = || {
        let room = 0.1 * (high - low).max_element();
        let size_m = [high.x - low.x + room, high.y - low.y + room, (high.z - low.z) / 3.0].map(say::tidy);
        Region::Box(BoxShape { centre_m: say::tidy3(middle), size_m })
    };
    let seam = draft.seam(object);
    let chosen = |side: &str, named: &str, instead: &str| {
        let (share, height) = (say::short(100.0 * seam.share), say::metres(seam.share * (high.z - low.z)));
        let why = match seam.by {
            Mark::Neck => "at its neck",
            Mark::Colours => "where its colours change most",
            Mark::Nothing => "the middle, for neither its shape nor its colours tell them apart",
        };
        Some(format!("what is {side} {share} % of its height, {height}, {why}; \"{named} the {instead} third\" says otherwise"))
    };
    let (stem, region, said, chosen) = match part {
        Part::Base => ("base", Region::Below(0.05), "the lowest twentieth", None),
        Part::Top => ("top", Region::Above(0.95), "the highest twentieth", None),
        Part::LowerHalf => ("lower-half", Region::Below(0.5), "the lower half", None),
        Part::UpperHalf => ("upper-half", Region::Above(0.5), "the upper half", None),
        Part::LowerThird => ("lower-third", Region::Below(0.333333), "the lowest third", None),
        Part::MiddleThird => ("middle-third", waist(), "the middle third", None),
        Part::UpperThird => ("upper-third", Region::Above(0.666667), "the highest third", None),
        Part::LeftHalf => ("left-half", side(Direction::Left), "the left half", None),
        Part::RightHalf => ("right-half", side(Direction::Right), "the right half", None),
        Part::FrontHalf => ("front-half", side(Direction::Forward), "the front half", None),
        Part::BackHalf => ("back-half", side(Direction::Backward), "the back half", None),
        Part::Flowers => ("flowers", Region::Above(seam.share), "flowers", chosen("above", "the flowers are", "upper")),
        Part::Pot => ("pot", Region::Below(seam.share), "pot", chosen("below", "the pot is", "lower")),
        Part::Rest | Part::Ends => ("rest", Region::Above(0.0), "all", None),
    };
    Portion { stem, region, said, chosen }
}

/// "only the upper half", "the flowers are the upper third": another border for a part that is there, the one that is
/// named or that the newest turn made. Whether the clause was that.
pub fn correct(clause: &mut Clause, draft: &mut Draft) -> Result<bool, Refusal> {
    let parts = clause.take_all(|s| match s {
        Sense::Part(part) => Some(*part),
        _ => None,
    });
    let (named, border) = match parts.as_slice() {
        [border] => (None, *border),
        [named, border] => (Some(*named), *border),
        _ => return Ok(false),
    };
    let object = draft.subjects(clause)?[0];
    let before = draft.context.previous_spec.and_then(|spec| spec.objects.iter().find(|o| o.name == draft.spec.objects[object].name));
    let stem = named.map(|part| portion(draft, object, part).stem);
    let newest = |p: &spec::Part| before.is_none_or(|before| !before.parts.contains(p));
    let parts = &draft.spec.objects[object].parts;
    let found = parts.iter().rposition(|p| stem.map_or_else(|| newest(p), |stem| p.name == stem));
    let Some(index) = found else { return Err("that part has no material of its own yet: \"the upper half is rubber\"".to_owned()) };
    let border = stuff_portion(draft, object, border);
    let part = &mut draft.object(object).parts[index];
    part.region = border.region;
    let line = format!("what is called {} of {} is {}", part.name.clone(), draft.name(object), border.said);
    draft.gloss.push(line);
    Ok(true)
}

/// Whether a clause speaks of nothing but parts.
pub fn is_about_borders(clause: &Clause) -> bool {
    let other = |s: &Sense| {
        matches!(
            s,
            Sense::Verb(_)
                | Sense::Material(_)
                | Sense::Quality(..)
                | Sense::Property(_)
                | Sense::Unbuilt(_)
                | Sense::Measure(..)
                | Sense::Smoothed(_)
        )
    };
    clause.has(|s| matches!(s, Sense::Part(_))) && !clause.phrases().iter().any(|p| other(&p.sense))
}
