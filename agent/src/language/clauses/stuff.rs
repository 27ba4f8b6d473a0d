//! What things are made of: materials by name, stiffness and density, of an object or of a part of it, from the start or
//! from a time on.

use super::super::clause::{Clause, Scale};
use super::super::draft::{Draft, Refusal};
use super::super::say;
use super::super::sense::{Property, Sense};
use super::adjust::{comparative, is_light};
use super::parts::{self, Owner};
use super::when::{self, When};
use phystalk::spec::{Auto, Event, LiquidSolver, Material, ProxyKind, limits, presets};

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
        *young_mut(draft, &owner)? = Auto::Value(after);
        let words = comparative(owner.said, scale, "stiffer", "softer");
        draft.gloss.push(format!("{words}: Young's modulus {}{note} to {}", say::pressure(before), say::pressure(after)));
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
fn young_mut<'a>(draft: &'a mut Draft, owner: &Owner) -> Result<&'a mut Auto<f64>, Refusal> {
    let material = draft.stuff(owner);
    let refusal = format!("{} is {}: it has no stiffness; \"make it of rubber\" gives it one", owner.said, material.kind());
    material.young_pa_mut().ok_or(refusal)
}

/// Young's modulus of an owner, resolved where it is automatic, and a note that says so.
fn young_pa(draft: &mut Draft, owner: &Owner) -> Result<(f64, &'static str), Refusal> {
    // A part that is new has what the whole has.
    let paths = [draft.stuff_path(owner), format!("object.{}.material", draft.name(owner.object))];
    Ok(match *young_mut(draft, owner)? {
        Auto::Value(value) => (value, ""),
        Auto::Auto => match paths.iter().find_map(|path| draft.resolved(&format!("{path}.young_pa"))) {
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
        *young_mut(draft, &owner)? = Auto::Value(say::tidy(young_pa));
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

/// Whether the clause has a motion whose time is said: "push the jelly vase at 1 s".
fn moves(clause: &Clause) -> bool {
    clause.phrases().iter().any(|p| matches!(p.sense, Sense::Verb(verb) if !is_light(verb, clause)))
}

/// A preset by its name; "elastic" alone is the automatic stiffness of things of no named material.
pub fn material(name: &'static str, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    // "as soft as jelly", "the stiffness of rubber": that property alone.
    let like = clause.has(|s| *s == Sense::As) || clause.has(|s| matches!(s, Sense::Property(_)));
    let times = clause.has(|s| matches!(s, Sense::Factor(_)));
    let only = if like { clause.take_scale(&[Property::Stiffness, Property::Hardness, Property::Density]) } else { None };
    let mut stuff = presets::material(name).map(|preset| preset.material.clone()).or_else(|| Material::of_kind(name));
    let by_particles = smoothed(clause, stuff.as_mut());
    let part = parts::take(clause);
    let objects = draft.subjects(clause)?;
    let later = !moves(clause) && only.is_none();
    let when = if later { When::take(clause, draft, objects[0])? } else { When::Start };
    for object in objects {
        // "The elastic vase jumps" says what it is.
        if name == "elastic" && part.is_none() && when == When::Start && draft.material(object).kind() == "elastic" {
            let line = format!("{} is elastic", draft.name(object));
            draft.gloss.push(line);
            continue;
        }
        let owner = parts::owner(draft, object, part);
        match (only, &stuff) {
            (Some(scale), Some(preset)) if name != "elastic" => resemble(draft, &owner, name, preset, scale, times)?,
            _ => become_stuff(draft, &owner, when, name, stuff.clone().unwrap_or_default(), by_particles),
        }
    }
    Ok(())
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
    let Some(Auto::Value(young)) = preset.young_pa() else { return Err(format!("{name} has no stiffness of its own")) };
    let young = say::tidy(young * ratio);
    *young_mut(draft, owner)? = Auto::Value(young);
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
