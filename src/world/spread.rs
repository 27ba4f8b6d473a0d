//! How far what flows gets, as far as formulas tell: enough to frame it before anything is simulated.

use super::ObjectFacts;
use crate::spec::{Liquid, Material, Object, Sand, Spec, Viscoplastic, When};
use std::f64::consts::PI;

/// Share of the cylinder around an object that it fills.
const FILL: f64 = 0.5;
/// Seconds that a liquid is watched after it begins to flow.
const FLOW_S: f64 = 1.5;

/// A thing that flows.
pub struct Flow {
    /// How far from its middle it gets.
    pub radius_m: f64,
    /// Until when it is worth watching.
    pub until_s: f64,
}

/// A heap of matter before it flows: a cylinder.
struct Column {
    radius_m: f64,
    height_m: f64,
    volume_m3: f64,
}

/// What becomes of an object that flows, or comes to flow, and has something below it from `lands_s` on; none of others.
pub fn of(spec: &Spec, thing: &Object, facts: &ObjectFacts, lands_s: Option<f64>, until_s: f64) -> Option<Flow> {
    let g = spec.world.gravity_m_s2[2].abs();
    let lands_s = lands_s.filter(|_| g > 1e-3)?;
    let first = std::iter::once((0.0, &thing.material)).chain(thing.parts.iter().map(|part| (0.0, &part.material)));
    let later = spec.events.iter().filter(|e| e.object == thing.name).filter_map(|e| {
        let begins_s = if e.when == Some(When::Impact) { lands_s } else { e.at_s? };
        Some((begins_s, e.material.as_ref()?))
    });
    let size = [0, 1, 2].map(|axis| facts.high_m[axis] - facts.low_m[axis]);
    let radius_m = (0.25 * (size[0] + size[1])).max(1e-6);
    let column = Column { radius_m, height_m: size[2], volume_m3: FILL * PI * radius_m * radius_m * size[2] };
    let flows = first.chain(later).filter_map(|(from_s, material)| {
        let begins_s = lands_s.max(from_s);
        let span_s = (until_s - begins_s).max(0.0);
        let (radius_m, lasts_s) = column.spread(material, g, span_s)?;
        Some(Flow { radius_m, until_s: begins_s + lasts_s })
    });
    flows.reduce(|a, b| Flow { radius_m: a.radius_m.max(b.radius_m), until_s: a.until_s.max(b.until_s) })
}

impl Column {
    /// Radius after a while, and how long it is worth watching; none of what does not flow.
    fn spread(&self, material: &Material, g: f64, span_s: f64) -> Option<(f64, f64)> {
        match material {
            Material::Liquid(Liquid { viscosity_pa_s, density_kg_m3, .. }) => {
                Some((self.thin(g, span_s).min(self.thick(viscosity_pa_s / density_kg_m3, g, span_s)), FLOW_S))
            }
            Material::Viscoplastic(Viscoplastic { viscosity_pa_s, yield_stress_pa, density_kg_m3, .. }) => {
                // Where its own weight does not make it yield any more (Roussel and Coussot 2005).
                let shear_pa = (yield_stress_pa / 3f64.sqrt()).max(1e-9);
                let ends_m = (225.0 * density_kg_m3 * g * self.volume_m3.powi(2) / (128.0 * PI * PI * shear_pa)).powf(0.2);
                let flows_m = self.thin(g, span_s).min(self.thick(viscosity_pa_s / density_kg_m3, g, span_s));
                Some((ends_m.min(flows_m).max(self.radius_m), FLOW_S))
            }
            Material::Sand(Sand { cohesion_pa, density_kg_m3, .. }) => {
                // Columns of dry grains (Lube et al. 2004); what binds holds a part of its height.
                let loose = (1.0 - cohesion_pa / (0.2 * density_kg_m3 * g * self.height_m).max(1e-9)).clamp(0.0, 1.0);
                let slender = FILL * self.height_m / self.radius_m;
                let runs = if slender < 1.7 { 1.24 * slender } else { 1.6 * slender.sqrt() };
                Some((self.radius_m * (1.0 + runs * loose), 3.0 * (self.height_m / g).sqrt()))
            }
            _ => None,
        }
    }

    /// A flood that nothing brakes: its front moves as waves do on what is left of its depth.
    fn thin(&self, g: f64, span_s: f64) -> f64 {
        (self.radius_m.powi(2) + 2.0 * span_s * (g * self.volume_m3 / PI).sqrt()).sqrt()
    }

    /// A pool that viscosity brakes (Huppert 1982).
    fn thick(&self, kinematic_m2_s: f64, g: f64, span_s: f64) -> f64 {
        let pool_m = 0.894 * (g * self.volume_m3.powi(3) * span_s / (3.0 * kinematic_m2_s.max(1e-12))).powf(0.125);
        pool_m.max(self.radius_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Axis, Event, presets};

    fn reach(name: &str, until_s: f64) -> Option<f64> {
        let mut spec = Spec::of_scene("vase.splat");
        spec.objects[0].material = presets::material(name).unwrap().material.clone();
        Some(of(&spec, &spec.objects[0], &facts(), Some(0.0), until_s)?.radius_m)
    }

    fn facts() -> ObjectFacts {
        let (low_m, high_m) = ([-0.25, -0.25, 0.0], [0.25, 0.25, 1.0]);
        ObjectFacts { name: "vase".into(), gaussians: 1, low_m, high_m, centre_m: [0.0, 0.0, 0.5], support_m: 0.0, forward: Axis::PlusX }
    }

    #[test]
    fn thin_things_get_farther_than_thick_ones_and_solids_nowhere() {
        let [water, lava, sand, mud] = ["water", "lava", "sand", "mud"].map(|name| reach(name, 2.0).unwrap());
        assert!(water > lava && lava > 0.25 && water > 1.0, "{water} {lava}");
        assert!(mud < water && (0.4..0.9).contains(&sand), "{mud} {sand}");
        assert!(reach("rubber", 2.0).is_none() && reach("steel", 2.0).is_none());
    }

    #[test]
    fn what_turns_later_spreads_later() {
        let mut spec = Spec::of_scene("vase.splat");
        let water = presets::material("water").map(|p| p.material.clone());
        spec.events.push(Event { material: water, ..Event::at("melt", "vase", 1.5) });
        let flow = of(&spec, &spec.objects[0], &facts(), Some(0.0), 2.0).unwrap();
        assert!(flow.until_s > 2.5 && flow.radius_m < reach("water", 2.0).unwrap());
    }
}
