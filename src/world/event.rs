//! What happens in a world at instants, and what it makes of the stuff that things are of.

use super::stuff::Stuff;
use crate::spec::{Event, Spec};
use glam::Vec3;

/// A change of one object at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedEvent {
    /// When; infinite for one that waits.
    pub at_s: f64,
    /// Index of the object.
    pub object: u32,
    /// Its piece, where only one changes: 0 is the object's own material, 1 its first part's.
    pub piece: Option<u16>,
    /// What happens.
    pub effect: Effect,
}

/// What an event does.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Adds to the velocity.
    Push(Vec3),
    /// Replaces the velocity.
    Velocity(Vec3),
    /// Makes it of other stuff; mass, place and speed stay.
    Become(Stuff),
    /// Multiplies moduli, yield stress and cohesion.
    Weaken(f64),
    /// Makes it a solid of its present shape.
    Freeze,
    /// Ends its pins, and undoes a freeze.
    Release,
}

impl TimedEvent {
    /// An event of a spec, whose change of material, if it has one, is `change`; none where its object is not there.
    pub(super) fn of(event: &Event, change: Option<&Stuff>, spec: &Spec) -> Option<TimedEvent> {
        let object = spec.objects.iter().position(|o| o.name == event.object)?;
        let effect = match event {
            Event { push_m_s: Some(push), .. } => Effect::Push(vec3(*push)),
            Event { velocity_m_s: Some(velocity), .. } => Effect::Velocity(vec3(*velocity)),
            Event { weaken: Some(share), .. } => Effect::Weaken(*share),
            Event { freeze: true, .. } => Effect::Freeze,
            Event { release: true, .. } => Effect::Release,
            _ => Effect::Become(change?.clone()),
        };
        let part = event.part.as_ref().and_then(|name| spec.objects[object].parts.iter().position(|part| part.name == *name));
        let piece = part.map(|index| index as u16 + 1);
        Some(TimedEvent { at_s: event.at_s.unwrap_or(f64::INFINITY), object: object as u32, piece, effect })
    }
}

pub(super) fn vec3(value: [f64; 3]) -> Vec3 {
    Vec3::from(value.map(|v| v as f32))
}

/// One piece of an object in the course of events.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    /// What it is now.
    pub now: Stuff,
    /// What it freezes to.
    pub solid: Stuff,
    /// What it was before it froze.
    pub thawed: Option<Stuff>,
}

/// All pieces of all objects.
#[derive(Clone, Debug)]
pub(super) struct Course(Vec<Vec<Piece>>);

impl Course {
    /// From what pieces are at the start, and what each freezes to.
    pub fn new(first: &[Vec<Stuff>], solid: &[Vec<Stuff>]) -> Course {
        let piece = |(now, solid): (&Stuff, &Stuff)| Piece { now: now.clone(), solid: solid.clone(), thawed: None };
        Course(first.iter().zip(solid).map(|(first, solid)| first.iter().zip(solid).map(piece).collect()).collect())
    }

    /// The pieces that an event is about, by number, as they are and as it makes them.
    pub fn changes(&self, event: &TimedEvent) -> Vec<(u16, Piece, Piece)> {
        let Some(pieces) = self.0.get(event.object as usize) else { return Vec::new() };
        let about = |number: &u16| event.piece.is_none_or(|only| only == *number);
        let numbered = (0u16..).zip(pieces).filter(|(number, _)| about(number));
        numbered.map(|(number, piece)| (number, piece.clone(), piece.after(&event.effect))).collect()
    }

    /// Keeps in mind what an event makes of its pieces.
    pub fn note(&mut self, event: &TimedEvent) {
        for (number, _, after) in self.changes(event) {
            self.0[event.object as usize][usize::from(number)] = after;
        }
    }
}

impl Piece {
    fn after(&self, effect: &Effect) -> Piece {
        let of = |now: Stuff, thawed| Piece { now, thawed, solid: self.solid.clone() };
        match effect {
            Effect::Become(next) => of(next.clone(), None),
            // Of what flows freely nothing can weaken.
            Effect::Weaken(share) if !self.now.substance.flows_freely() => of(self.now.weakened(*share), self.thawed.clone()),
            Effect::Freeze if self.thawed.is_none() => {
                let solid = if self.now.substance.keeps_shape() { self.now.clone() } else { self.solid.frozen_from(&self.now) };
                of(solid, Some(self.now.clone()))
            }
            Effect::Release => of(self.thawed.clone().unwrap_or(self.now.clone()), None),
            _ => self.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{Flow, Substance};
    use crate::spec::ElasticModel;

    #[test]
    fn what_froze_out_of_water_is_ice_that_looks_like_it_and_thaws_to_water() {
        let stuff = |substance| Stuff { substance, young_pa: 1e5, poisson: 0.3, density_kg_m3: 1e3 };
        let water = stuff(Substance::Liquid { viscosity_pa_s: 1e-3, surface_tension_n_m: 0.0 });
        let ice = stuff(Substance::Elastic(ElasticModel::Corotated));
        let piece = Piece { now: water.clone(), solid: ice.clone(), thawed: None };
        let frozen = piece.after(&Effect::Freeze);
        assert!(frozen.now.substance.keeps_shape() && frozen.now.substance.flow() == Some(Flow::Liquid));
        assert_eq!(frozen.after(&Effect::Release).now, water);
        // What kept its shape never flowed.
        let rubber = Piece { now: ice.clone(), solid: ice.clone(), thawed: None };
        assert_eq!(rubber.after(&Effect::Freeze).now, ice);
    }
}
