//! Verbs that make other stuff of a thing: melting, freezing, crumbling, dissolving, pulsing.

use super::super::clause::Clause;
use super::super::draft::{Draft, Refusal};
use super::super::say;
use super::super::sense::{Fate, Property, Sense, Verb};
use super::parts::{self, Owner};
use super::stuff::{become_stuff, freezes};
use super::when::When;
use phystalk::spec::{Activation, Elastic, Event, Liquid, Material, Muscle, Sand, Wave, presets};

/// Time in which a melt of any size sinks together: its viscosity is its weight over its foot times this.
const MELT_S: f64 = 0.2;
/// Power of a pace that viscosity goes with, so that "slowly" is seen.
const PACE: f64 = 3.0;
/// How hard a thing that pulses pulls, as a share of its stiffness, and how long a pulse takes.
const PULSE: (f64, f64) = (0.2, 1.0);

/// Reads one such verb with all that belongs to it.
pub fn understand(fate: Fate, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    if clause.has(|s| matches!(s, Sense::View(_))) && !clause.has(|s| matches!(s, Sense::Camera | Sense::Verb(Verb::Look))) {
        return Err("a part changes as one, \"the top melts at 1 s\"; the camera is asked in a clause of its own, \"look from above\"".to_owned());
    }
    let owners = parts::owners(clause, draft)?;
    let Some(first) = owners.first().map(|owner| owner.object) else { return Ok(()) };
    let when = When::take(clause, draft, first)?;
    // "Melts slowly" is a thick melt.
    let scale = if fate == Fate::Melt { clause.take_scale(&[Property::Speed]) } else { None };
    let pace = scale.map_or(1.0, |s| s.ratio);
    for owner in owners {
        let object = owner.object;
        // An event of the whole is one of its parts too.
        if when != When::Start && owner.part.is_some() && draft.spec.events.iter().any(|e| when.is_of(e) && e.part.is_none() && is_of(fate, e)) {
            continue;
        }
        let name = draft.name(object);
        if scale.is_some_and(|s| s.compared) && when == When::Start && melts_already(pace, &owner, draft) {
            continue;
        }
        let density_kg_m3 = draft.stuff(&owner).density_kg_m3();
        match fate {
            Fate::Melt if when != When::Start && thaws(&owner, draft) => {
                draft.happen(object, None, when, "thaw", |event| event.release = true, |event| event.release);
                draft.gloss.push(format!("{name} is what it was before it froze,{}", when.said()));
            }
            Fate::Melt => {
                let weight_pa = density_kg_m3 * 9.81 * draft.facts(object).height_m();
                let viscosity_pa_s = say::tidy((weight_pa * MELT_S * pace.powf(-PACE)).clamp(1.0, 1e5));
                let melt = Liquid { density_kg_m3, viscosity_pa_s, surface_tension_n_m: 0.05, ..Liquid::default() };
                become_stuff(draft, &owner, when, "a melt of itself", Material::Liquid(melt), "");
            }
            Fate::Dissolve => {
                let water = presets::material("water").map(|p| p.material.clone()).unwrap_or_default();
                become_stuff(draft, &owner, when, "water", water, "");
            }
            Fate::Crumble => {
                let sand = Sand { density_kg_m3, ..Sand::default() };
                become_stuff(draft, &owner, when, "loose grains", Material::Sand(sand), "");
            }
            Fate::Freeze if when == When::Start => {
                return Err("when? \"it freezes at 1 s\", \"drop it from 1 m, it freezes when it lands\"".to_owned());
            }
            Fate::Freeze => {
                let part = owner.part.map(|part| draft.spec.objects[object].parts[part].name.clone());
                draft.happen(object, part, when, "freeze", |event| event.freeze = true, |event| event.freeze);
                draft.gloss.push(format!("{} freezes{}: a solid of the shape that it has then", owner.said, when.said()));
            }
            Fate::Pulse => {
                let elastic = match draft.stuff(&owner) {
                    Material::Elastic(elastic) => elastic.clone(),
                    _ => Elastic { density_kg_m3, ..Elastic::default() },
                };
                let Elastic { young_pa, poisson, density_kg_m3, .. } = elastic;
                let wave = Wave { least: 0.0, most: PULSE.0, period_s: PULSE.1, phase: 0.0 };
                let muscle = Muscle { young_pa, poisson, density_kg_m3, activation: Activation::Wave(wave), ..Muscle::default() };
                become_stuff(draft, &owner, when, "a muscle that pulls upright once a second", Material::Muscle(muscle), "");
            }
            Fate::Shatter => {
                return Err(
                    "breaking into pieces is not built yet; \"it shatters into sand\" and \"it crumbles\" are, \"when it lands\" too".to_owned()
                );
            }
        }
    }
    Ok(())
}

/// Whether a melt only undoes a freeze: one of the same part, and the only one, for a release undoes them all.
fn thaws(owner: &Owner, draft: &Draft) -> bool {
    let thing = &draft.spec.objects[owner.object];
    let part = owner.part.map(|part| &thing.parts[part].name);
    let mut frozen = draft.spec.events.iter().filter(|e| freezes(e, &thing.name)).peekable();
    frozen.peek().is_some() && frozen.all(|e| part.is_none() || e.part.as_ref() == part)
}

/// "Melt faster": the melt that there is, thinner. Whether there is one.
fn melts_already(pace: f64, owner: &Owner, draft: &mut Draft) -> bool {
    let thing = &draft.spec.objects[owner.object];
    let (name, part) = (thing.name.clone(), owner.part.map(|part| thing.parts[part].name.clone()));
    let event = draft.spec.events.iter().rposition(|e| e.object == name && e.part == part && matches!(e.material, Some(Material::Liquid(_))));
    let owner = Owner { event, ..owner.clone() };
    let Material::Liquid(liquid) = draft.stuff(&owner) else { return false };
    let before = liquid.viscosity_pa_s;
    liquid.viscosity_pa_s = say::tidy((before * pace.powf(-PACE)).clamp(1.0, 1e5));
    let after = liquid.viscosity_pa_s;
    draft.gloss.push(format!("the melt of {} has a viscosity of {} Pa·s instead of {}", owner.said, say::short(after), say::short(before)));
    true
}

/// Whether an event is of that kind: "don't melt it after all".
pub fn is_of(fate: Fate, event: &Event) -> bool {
    match fate {
        Fate::Freeze => event.freeze,
        Fate::Melt | Fate::Dissolve => matches!(event.material, Some(Material::Liquid(_))) || fate == Fate::Melt && event.name.starts_with("thaw"),
        Fate::Crumble | Fate::Shatter => matches!(event.material, Some(Material::Sand(_))),
        Fate::Pulse => matches!(event.material, Some(Material::Muscle(_))),
    }
}
