//! Numbers of materials that have words of their own: how thick a liquid is, how it holds together, what grains bear.

use super::super::clause::{Clause, Scale, step};
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Property, Sense};
use super::parts::{self, Owner};
use phystalk::spec::{Material, limits};

/// A number of a material.
struct Amount {
    name: &'static str,
    unit: &'static str,
    more: &'static str,
    less: &'static str,
    of: fn(&mut Material) -> Option<&mut f64>,
    /// The least that shows in a thing of this density and height: what asks for more of less than this gets this.
    seen: fn(f64, f64) -> f64,
    most: f64,
}

/// Standard gravity.
const G: f64 = 9.81;

/// Shear that carries through a hundredth of a fall: about ten times that stops it.
const VISCOSITY: Amount = Amount {
    name: "viscosity",
    unit: " Pa·s",
    more: "thicker",
    less: "thinner",
    of: Material::viscosity_pa_s_mut,
    seen: |density, height| 3e-3 * density * height * (G * height).sqrt(),
    most: limits::VISCOSITY_PA_S,
};
/// Enough to hold drops of a tenth of its height together against their weight.
const TENSION: Amount = Amount {
    name: "surface tension",
    unit: " N/m",
    more: "held together more",
    less: "held together less",
    of: Material::surface_tension_n_m_mut,
    seen: |density, height| density * G * (0.1 * height).powi(2),
    most: limits::SURFACE_TENSION_N_M,
};
/// A tenth of the pressure at its foot: a bank a few tenths of its height stands.
const COHESION: Amount = Amount {
    name: "cohesion",
    unit: " Pa",
    more: "stickier",
    less: "looser",
    of: Material::cohesion_pa_mut,
    seen: |density, height| 0.1 * density * G * height,
    most: limits::STRENGTH_PA,
};
const YIELD: Amount = Amount {
    name: "yield stress",
    unit: " Pa",
    more: "harder to dent",
    less: "easier to dent",
    of: Material::yield_stress_pa_mut,
    seen: |_, _| 0.0,
    most: limits::STRENGTH_PA,
};
const SLOPE: Amount = Amount {
    name: "friction angle",
    unit: "°",
    more: "of steeper heaps",
    less: "of flatter heaps",
    of: |material| if let Material::Sand(sand) = material { Some(&mut sand.friction_angle_deg) } else { None },
    seen: |_, _| 0.0,
    most: limits::FRICTION_ANGLE_DEG.1,
};

/// What a word means of a material; none where the material has nothing of that.
fn amount(property: Property, material: &Material) -> Option<&'static Amount> {
    match (property, material) {
        (Property::Viscosity, Material::Liquid(_) | Material::Viscoplastic(_)) => Some(&VISCOSITY),
        (Property::Tension | Property::Hold, Material::Liquid(_)) => Some(&TENSION),
        (Property::Cohesion | Property::Hold | Property::Stick, Material::Sand(_)) => Some(&COHESION),
        (Property::Stick, Material::Liquid(_) | Material::Viscoplastic(_)) => Some(&VISCOSITY),
        (Property::Yield | Property::Hold, Material::Plastic(_) | Material::Viscoplastic(_)) => Some(&YIELD),
        (Property::Slope, Material::Sand(_)) => Some(&SLOPE),
        _ => None,
    }
}

/// The properties of this file.
pub const ALL: &[Property] =
    &[Property::Viscosity, Property::Tension, Property::Cohesion, Property::Hold, Property::Stick, Property::Yield, Property::Slope];

/// More or less of one. What nobody here has is refused, with who has it.
pub fn scale(scale: Scale, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    for owner in parts::owners(clause, draft)? {
        let amount = find(scale.property, draft, &owner)?;
        let (density, height) = (draft.stuff(&owner).density_kg_m3(), draft.facts(owner.object).height_m());
        let Some(value) = (amount.of)(draft.stuff(&owner)) else { continue };
        let before = *value;
        // As much over the least that shows as it was to grow over what it was.
        let shown = (amount.seen)(density, height) * scale.ratio / step(scale.property);
        let after = if scale.ratio > 1.0 { (before * scale.ratio).max(shown) } else { before * scale.ratio };
        *value = say::tidy(after.min(amount.most));
        let (after, unit) = (*value, amount.unit);
        let words = if scale.ratio > 1.0 { amount.more } else { amount.less };
        let line = format!("{} is {words}: {} {}{unit} to {}{unit}", owner.said, amount.name, say::short(before), say::short(after));
        draft.gloss.push(line);
    }
    Ok(())
}

/// One by its name, with a number.
pub fn set(property: Property, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let value = match property {
        Property::Viscosity => clause.take_measure(Dimension::Viscosity),
        Property::Tension => clause.take_measure(Dimension::Tension),
        _ => None,
    };
    let value = value
        .or_else(|| clause.take_measure(Dimension::Pressure))
        .or_else(|| clause.take_measure(Dimension::Angle).map(|(a, lead)| (a.to_degrees(), lead)));
    let value = value.or_else(|| clause.take_measure(Dimension::Plain)).map(|(value, _)| value);
    for owner in parts::owners(clause, draft)? {
        let amount = find(property, draft, &owner)?;
        let value = value.ok_or(format!("how much {}? \"{} 5\", \"more\", \"less\"", amount.name, amount.name))?;
        if let Some(target) = (amount.of)(draft.stuff(&owner)) {
            *target = say::tidy(value);
        }
        draft.gloss.push(format!("{} has a {} of {}{}", owner.said, amount.name, say::short(value), amount.unit));
    }
    Ok(())
}

fn find(property: Property, draft: &mut Draft, owner: &Owner) -> Result<&'static Amount, Refusal> {
    let (what, who) = match property {
        Property::Viscosity => ("no viscosity", "water, honey, lava, mud and jam have one"),
        Property::Tension => ("no surface tension", "water, honey and lava have one"),
        Property::Cohesion | Property::Stick => ("nothing that sticks", "sand, soil, mud and liquids have"),
        Property::Slope => ("no friction angle", "sand and soil have one"),
        Property::Yield => ("no yield stress", "clay, dough, mud and jam have one"),
        _ => ("nothing that holds it together more or less", "liquids, sand, clay and mud have"),
    };
    let material = draft.stuff(owner);
    amount(property, material).ok_or(format!("{} is {}, which has {what}: {who}", owner.said, material.kind()))
}

/// Whether "sticky" says something of what a clause is about, and not of the ground.
pub fn sticks(clause: &mut Clause, draft: &mut Draft) -> bool {
    let stuff = clause.phrases().iter().find_map(|p| if let Sense::Stuff(name) = p.sense { Some(name) } else { None });
    if let Some(name) = stuff {
        return parts::owners_of(name, draft).iter().all(|owner| amount(Property::Stick, draft.stuff(owner)).is_some());
    }
    draft.subjects(clause).is_ok_and(|objects| objects.iter().all(|&o| amount(Property::Stick, draft.material(o)).is_some()))
}
