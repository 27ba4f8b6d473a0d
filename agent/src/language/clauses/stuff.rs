//! What things are made of: materials by name, stiffness and density, of an object or of a part of it, from the start or
//! from a time on.

use super::super::clause::{Clause, Scale};
use super::super::draft::{Draft, Refusal};
use super::super::phrases::Phrase;
use super::super::say;
use super::super::sense::{Field, Preposition, Property, Sense, Verb};
use super::adjust::{comparative, is_light};
use super::parts::{self, Owner};
use super::when::{self, When};
use phystalk::spec::{Event, LiquidSolver, Material, ProxyKind, Young, limits, presets};

/// Stiffness taken for "softer" where the automatic one is not known: before the first run of a scene.
pub const YOUNG_BEFORE_RUN_PA: f64 = 2e5;

/// More or less stiffness, from the start, or at a time less.
pub fn stiffness(scale: Scale, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let later = when::is_said(clause) && !moves(clause);
    for owner in parts::owners(clause, draft)? {
        let when = if later { When::take(clause, draft, owner.object)? } else { When::Start };
        if when != When::Start {
            weaken(&owner, scale.ratio, when, draft)?;
            continue;
        }
        let (before, note) = young_pa(draft, &owner)?;
        let after = say::tidy(before * scale.ratio);
        let young = young_mut(draft, &owner)?;
        // What holds itself goes on doing so.
        *young = if let Young::AtLeast(_) = young { Young::AtLeast(after) } else { Young::Value(after) };
        let bears = matches!(young, Young::AtLeast(_)) && after < before;
        let words = comparative(owner.said, scale, "stiffer", "softer");
        let obeyed = if bears {
            format!("; what its weight made firmer stays so, \"stiffness {}\" is obeyed and sags", say::pressure(after))
        } else {
            String::new()
        };
        draft.gloss.push(format!("{words}: Young's modulus {}{note} to {}{obeyed}", say::pressure(before), say::pressure(after)));
    }
    Ok(())
}

/// Gives way at a time.
fn weaken(owner: &Owner, ratio: f64, when: When, draft: &mut Draft) -> Result<(), Refusal> {
    if ratio > 1.0 {
        return Err("at a time things only get softer; \"turn it into rubber at 1 s\" gives other stuff".to_owned());
    }
    let share = Some(say::tidy(ratio.max(limits::WEAKEN.0)));
    let part = part_name(draft, owner);
    draft.happen(owner.object, part, when, "weaken", |event| event.weaken = share, |event| event.weaken.is_some());
    draft.gloss.push(format!("{} gives way{}: {} times its stiffness and strength", owner.said, when.said(), say::short(ratio)));
    Ok(())
}

fn part_name(draft: &Draft, owner: &Owner) -> Option<String> {
    owner.part.map(|part| draft.spec.objects[owner.object].parts[part].name.clone())
}

/// Its Young's modulus, where its material has one.
fn young_mut<'a>(draft: &'a mut Draft, owner: &Owner) -> Result<&'a mut Young, Refusal> {
    let material = draft.stuff(owner);
    let refusal = format!("{} is {}: it has no stiffness; \"make it of rubber\" gives it one", owner.said, material.kind());
    material.young_pa_mut().ok_or(refusal)
}

/// Young's modulus of an owner, resolved where it is automatic, and a note that says so.
fn young_pa(draft: &mut Draft, owner: &Owner) -> Result<(f64, &'static str), Refusal> {
    // A part that is new has what the whole has.
    let paths = [draft.stuff_path(owner), format!("object.{}.material", draft.name(owner.object))];
    Ok(match *young_mut(draft, owner)? {
        Young::Value(value) => (value, ""),
        Young::AtLeast(value) => (value, " where that bears its weight"),
        Young::Auto => match paths.iter().find_map(|path| draft.resolved(&format!("{path}.young_pa"))) {
            Some(value) => (value, " (automatic until now)"),
            None => (YOUNG_BEFORE_RUN_PA, " (taken for the automatic one, which is known after a run)"),
        },
    })
}

/// More or less weight.
pub fn weight(scale: Scale, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    for owner in parts::owners(clause, draft)? {
        let before = draft.stuff(&owner).density_kg_m3();
        let after = say::tidy(before * scale.ratio);
        put_density(draft, &owner, after);
        let words = comparative(owner.said, scale, "heavier", "lighter");
        draft.gloss.push(format!("{words}: {} to {} kg/m³", say::short(before), say::short(after)));
    }
    Ok(())
}

fn put_density(draft: &mut Draft, owner: &Owner, density_kg_m3: f64) {
    if let Some(density) = draft.stuff(owner).density_mut() {
        *density = say::tidy(density_kg_m3);
    }
}

/// A density by its number.
pub fn set_density(clause: &mut Clause, draft: &mut Draft, density_kg_m3: f64) -> Result<(), Refusal> {
    for owner in parts::owners(clause, draft)? {
        put_density(draft, &owner, density_kg_m3);
        draft.gloss.push(format!("{} has a density of {} kg/m³", owner.said, say::short(density_kg_m3)));
    }
    Ok(())
}

/// A stiffness by its number.
pub fn set_young(clause: &mut Clause, draft: &mut Draft, young_pa: f64) -> Result<(), Refusal> {
    for owner in parts::owners(clause, draft)? {
        *young_mut(draft, &owner)? = Young::Value(say::tidy(young_pa));
        draft.gloss.push(format!("{} has a Young's modulus of {}", owner.said, say::pressure(young_pa)));
    }
    Ok(())
}

/// Poisson's ratio by its number.
pub fn set_poisson(clause: &mut Clause, draft: &mut Draft, poisson: f64) -> Result<(), Refusal> {
    for owner in parts::owners(clause, draft)? {
        *draft.stuff(&owner).poisson_mut().ok_or("what flows or is rigid has no Poisson's ratio")? = say::tidy(poisson);
        draft.gloss.push(format!("{} has a Poisson's ratio of {}", owner.said, say::short(poisson)));
    }
    Ok(())
}

/// Whether the clause has a motion whose time is said: "push the jelly vase at 1 s". What explodes into something is that
/// from then on.
fn moves(clause: &Clause) -> bool {
    let into = clause.phrases().iter().any(|p| p.sense == Sense::Preposition(Preposition::Into));
    let light = |verb| is_light(verb, clause) || (into && verb == Verb::Field(Field::Explode));
    clause.phrases().iter().any(|p| matches!(p.sense, Sense::Verb(verb) if !light(verb)))
}

/// Refuses "turn it into jello": what it is to be is no material that is known.
pub fn refuse_unknown(clause: &Clause, draft: &Draft) -> Result<(), Refusal> {
    let phrases = clause.phrases();
    let into = |p: &Phrase| matches!(p.sense, Sense::Preposition(Preposition::Into | Preposition::To));
    let Some(at) = phrases.iter().position(into) else { return Ok(()) };
    match phrases[at + 1..].iter().find(|p| p.sense != Sense::Article) {
        Some(phrase) if phrase.sense == Sense::Unknown => {
            let words = draft.words(phrase.span.clone());
            let known: Vec<&str> = presets::MATERIALS.iter().map(|preset| preset.name).collect();
            let meant = phystalk::spec::nearest(&words, known.iter().copied()).map(|near| format!(" (did you mean {near}?)")).unwrap_or_default();
            Err(format!("{words} is no material here{meant}; there are {}", known.join(", ")))
        }
        _ => Ok(()),
    }
}

/// What a clause says that something is made of.
pub struct Role {
    /// What it is to be.
    becomes: &'static str,
    /// What it is before: "from rubber into sand", "turn the steel vase into jelly".
    was: Option<&'static str>,
    /// "Replace the water with honey": what is there and is to be of other stuff.
    instead: bool,
    /// "Heavier than steel": one property of it, and more or less of that.
    than: bool,
}

/// Takes what a clause says of materials: the last one that a verb leads to is what it becomes, the one that describes
/// it, or that it comes from, is what it was.
pub fn take_role(clause: &mut Clause, draft: &Draft) -> Result<Option<Role>, Refusal> {
    let replaces = clause.has(|s| *s == Sense::Replace);
    let phrases = clause.phrases();
    let sense = |i: usize| phrases.get(i).map(|p| &p.sense);
    let lead = |i: usize| phrases[..i].iter().rfind(|p| !matches!(p.sense, Sense::Article | Sense::Quality(..))).map(|p| &p.sense);
    let mut earlier = Vec::new();
    let mut later = Vec::new();
    for i in clause.left_indices() {
        let Some(Sense::Material(name)) = sense(i) else { continue };
        let source = matches!(lead(i), Some(Sense::Preposition(Preposition::From) | Sense::Replace));
        let describes = matches!(sense(i + 1), Some(Sense::Objects(_) | Sense::It));
        if source || describes { earlier.push((i, *name)) } else { later.push((i, *name)) }
    }
    if let (true, Some((_, name)), [_, ..]) = (replaces, earlier.first(), &later[..])
        && parts::owners_of(name, draft).is_empty()
    {
        return Err(format!("nothing here is of {name}: \"make it of {}\"", later[0].1));
    }
    // "Turn the water into honey"
    let into = |i: usize| matches!(lead(i), Some(Sense::Preposition(Preposition::Into | Preposition::To)));
    if let [(_, from), (at, to)] = later[..]
        && into(at)
        && !clause.has(|s| *s == Sense::As)
    {
        return Err(format!("nothing here is of {from}: \"make it of {to}\", \"turn it into {to}\""));
    }
    // "A steel vase with jelly flowers" is both from the start.
    let with = later.first().is_some_and(|(i, _)| lead(*i) == Some(&Sense::Preposition(Preposition::With)));
    let was = earlier.first().copied().filter(|_| !later.is_empty() && (!with || replaces));
    let Some((at, becomes)) = later.first().or(earlier.first()).copied() else { return Ok(None) };
    let than = lead(at).is_some()
        && phrases[..at].iter().rfind(|p| p.sense != Sense::Article).is_some_and(|p| draft.words(p.span.clone()).eq_ignore_ascii_case("than"));
    clause.take_at_index(at);
    if let Some((at, _)) = was {
        clause.take_at_index(at);
    }
    clause.take_sense(&Sense::Replace);
    Ok(Some(Role { becomes, was: was.map(|(_, name)| name), instead: replaces, than }))
}

/// A preset by its name; "elastic" alone is the automatic stiffness of things of no named material.
pub fn material(role: Role, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let name = role.becomes;
    // "as soft as jelly", "the stiffness of rubber": that property alone.
    let compared = role.than || clause.has(|s| *s == Sense::As);
    let like = compared || clause.has(|s| matches!(s, Sense::Property(_)));
    let times = role.than || clause.has(|s| matches!(s, Sense::Factor(_)));
    let only = if like { clause.take_scale(&[Property::Stiffness, Property::Hardness, Property::Density]) } else { None };
    if compared && only.is_none() && clause.has(|s| matches!(s, Sense::Quality(..) | Sense::Property(_))) {
        return Err(format!("only weight and stiffness go by those of {name}: \"as heavy as {name}\"; \"make it of {name}\" gives it all"));
    }
    let mut stuff = presets::material(name).map(|preset| preset.material.clone()).or_else(|| Material::of_kind(name));
    let by_particles = smoothed(clause, stuff.as_mut());
    // What is said of the time of a motion is the motion's.
    if !moves(clause) && clause.has(|s| matches!(s, Sense::Until(_) | Sense::Span(..))) {
        return Err(format!("and what is it then? \"make it {name}, turn it into water at 1 s\""));
    }
    let spared = clause.take_after(&Sense::Except, |s| if let Sense::Part(part) = s { Some(*part) } else { None });
    let whole = spared.is_some() || clause.phrases().iter().any(|p| matches!(p.sense, Sense::All | Sense::Whole));
    let mut owners = match (role.instead, role.was) {
        (true, Some(was)) => parts::owners_of(was, draft),
        _ => parts::owners(clause, draft)?,
    };
    // Its parts follow it below, but for one that is left out.
    if whole && owners.iter().any(|owner| owner.part.is_none()) {
        owners.retain(|owner| owner.part.is_none());
    }
    let Some(object) = owners.first().map(|o| o.object) else { return Ok(()) };
    let later = !moves(clause) && only.is_none();
    let when = if later { When::take(clause, draft, object)? } else { When::Start };
    if when == When::Start && !moves(clause) && says_otherwise(name, stuff.as_ref(), clause, draft) {
        return Ok(());
    }
    if let Some(part) = spared {
        spare(part, when, &owners, draft)?;
    }
    for owner in owners {
        // "The elastic vase jumps" says what it is.
        if name == "elastic" && owner.part.is_none() && when == When::Start && draft.material(owner.object).kind() == "elastic" {
            let line = format!("{} is elastic", draft.name(owner.object));
            draft.gloss.push(line);
            continue;
        }
        if let Some(before) = role.was.filter(|_| when != When::Start && !role.instead) {
            let stuff = presets::material(before).map(|preset| preset.material.clone()).or_else(|| Material::of_kind(before)).unwrap_or_default();
            if *draft.stuff(&owner) != stuff {
                become_stuff(draft, &owner, When::Start, before, stuff, "");
            }
        }
        match (only, &stuff) {
            (Some(scale), Some(preset)) if name != "elastic" => resemble(draft, &owner, name, preset, scale, times)?,
            _ => become_stuff(draft, &owner, when, name, stuff.clone().unwrap_or_default(), by_particles),
        }
        if owner.part.is_none() && owner.event.is_none() && when == When::Start && only.is_none() {
            let spared = spared.map(|part| parts::owner(draft, owner.object, Some(part))).and_then(|o| o.part);
            parts_of_their_own(whole, spared, &owner, draft);
        }
    }
    Ok(())
}

/// "Everything except the top": that part is of its own, of what it is of already.
fn spare(part: super::super::sense::Part, when: When, owners: &[Owner], draft: &mut Draft) -> Result<(), Refusal> {
    if when != When::Start {
        return Err("what is left out is so from the start: \"the lower two thirds\" by name have a time, \"the lower half melts at 1 s\"".to_owned());
    }
    for owner in owners {
        let spared = parts::owner(draft, owner.object, Some(part));
        let kind = draft.stuff(&spared).kind();
        draft.gloss.push(format!("{} stays {kind}", spared.said));
    }
    Ok(())
}

/// Parts that have stuff of their own: of the new one too where all of it was said, else they keep theirs, and it is said.
fn parts_of_their_own(whole: bool, spared: Option<usize>, owner: &Owner, draft: &mut Draft) {
    let thing = &mut draft.spec.objects[owner.object];
    let stuff = thing.material.clone();
    let mut kept = Vec::new();
    let mut changed = Vec::new();
    for (_, part) in thing.parts.iter_mut().enumerate().filter(|(index, part)| Some(*index) != spared && part.material != stuff) {
        if whole {
            part.material = stuff.clone();
            changed.push(part.name.clone());
        } else {
            kept.push(format!("{} stays {}", part.name, part.material.kind()));
        }
    }
    if !changed.is_empty() {
        draft.gloss.push(format!("{} too", say::list(&changed)));
    }
    if !kept.is_empty() && !owner.said.starts_with("the rest of") {
        draft.gloss.push(format!("{}: \"make all of it …\" changes that too", say::list(&kept)));
    }
}

/// "No, to water" after a turn that made an event: that event brings it. Whether it was so.
fn says_otherwise(name: &str, stuff: Option<&Material>, clause: &Clause, draft: &mut Draft) -> bool {
    let to = clause.phrases().iter().any(|p| matches!(p.sense, Sense::Preposition(Preposition::To | Preposition::Into) | Sense::Instead));
    let verb = clause.phrases().iter().any(|p| matches!(p.sense, Sense::Verb(_)));
    if verb || !(draft.corrects || to) {
        return false;
    }
    let Some(before) = draft.context.previous_spec else { return false };
    let newer = |e: &Event| e.material.is_some() && !before.events.contains(e);
    let Some(event) = draft.spec.events.iter_mut().rev().find(|e| newer(e)) else { return false };
    let stuff = stuff.cloned().unwrap_or_default();
    let line = format!("{} turns {} into {name}: {}", event.name, event.object, say::material(&stuff));
    event.material = Some(stuff);
    draft.gloss.push(line);
    true
}

/// Reads "as particles", "on the grid": how a liquid is solved. What was said, in words.
fn smoothed(clause: &mut Clause, material: Option<&mut Material>) -> &'static str {
    let Some(Material::Liquid(liquid)) = material else { return "" };
    let said = clause.take(|s| match s {
        Sense::Smoothed(yes) => Some(*yes),
        _ => None,
    });
    match said {
        Some(true) => {
            liquid.solver = LiquidSolver::Sph;
            " of smoothed particles"
        }
        _ => "",
    }
}

/// "as particles" of a liquid that is there.
pub fn solve_as(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let Some(yes) = clause.take(|s| match s {
        Sense::Smoothed(yes) => Some(*yes),
        _ => None,
    }) else {
        return Ok(());
    };
    for owner in parts::owners(clause, draft)? {
        let Material::Liquid(liquid) = draft.stuff(&owner) else {
            return Err(format!("{} is no liquid, and only liquids are solved by particles: \"turn it into water as particles\"", owner.said));
        };
        liquid.solver = if yes { LiquidSolver::Sph } else { LiquidSolver::Mpm };
        draft.gloss.push(format!("{} is solved {}", owner.said, if yes { "by smoothed particles" } else { "on the grid" }));
    }
    Ok(())
}

/// Is of some stuff, from the start or from a time on.
pub fn become_stuff(draft: &mut Draft, owner: &Owner, when: When, name: &str, stuff: Material, note: &str) {
    let described = format!("{name}{note}: {}", say::material(&stuff));
    if when == When::Start {
        *draft.stuff(owner) = stuff;
        draft.gloss.push(format!("{} is made of {described}", owner.said));
        return;
    }
    let part = part_name(draft, owner);
    draft.happen(owner.object, part, when, "change", |event| event.material = Some(stuff), |event| event.material.is_some());
    draft.gloss.push(format!("{} turns into {described},{}", owner.said, when.said()));
}

/// One property of a preset: "as soft as jelly", "twice the density of foam".
fn resemble(draft: &mut Draft, owner: &Owner, name: &str, preset: &Material, scale: Scale, times: bool) -> Result<(), Refusal> {
    let ratio = if times { scale.ratio } else { 1.0 };
    let share = if times { format!("{} times ", say::short(ratio)) } else { String::new() };
    if scale.property == Property::Density {
        let density = say::tidy(preset.density_kg_m3() * ratio);
        put_density(draft, owner, density);
        draft.gloss.push(format!("{} has {share}the density of {name}: {} kg/m³", owner.said, say::short(density)));
        return Ok(());
    }
    let Some(young) = preset.young_pa().and_then(Young::given_pa) else { return Err(format!("{name} has no stiffness of its own")) };
    let young = say::tidy(young * ratio);
    *young_mut(draft, owner)? = Young::Value(young);
    draft.gloss.push(format!("{} has {share}the stiffness of {name}: Young's modulus {}", owner.said, say::pressure(young)));
    Ok(())
}

/// "use the convex hull": what solid is made of the Gaussians.
pub fn proxy(proxy: ProxyKind, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    for object in draft.subjects(clause)? {
        draft.object(object).proxy = proxy;
        let said = match proxy {
            ProxyKind::Hull => "its convex hull",
            ProxyKind::Voxel => "the shape of its Gaussians, hollows and all",
        };
        let line = format!("{} is as solid as {said}", draft.name(object));
        draft.gloss.push(line);
    }
    Ok(())
}

/// Whether an event freezes an object.
pub fn freezes(event: &Event, object: &str) -> bool {
    event.freeze && event.object == object
}
