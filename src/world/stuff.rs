//! A material in the solver's terms: its law, its moduli, and what `"auto"` means for them.

use crate::proxy::BEARING;
use crate::solver::{Activation, Moduli, Substance, liquid_bulk_pa};
use crate::spec::{self, LiquidSolver, Material, Young};
use glam::DVec3;

/// Compression under its own weight that a flowing thing's automatic stiffness allows.
const FLOWING_STRAIN: f64 = 0.01;
/// Compression by its own surface tension that a drop's automatic bulk modulus allows.
const DROP_STRAIN: f64 = 0.01;
/// Softest and stiffest automatic value of a thing that flows, Pa: stiffer ones only cost steps.
const FLOWING_PA: (f64, f64) = (1e4, 1e6);
/// Compression under its own weight that what froze out of a liquid has.
const FROZEN_STRAIN: f64 = 2e-3;
/// Standard gravity, whatever the spec's is, so that a thing is the same stuff everywhere.
const STANDARD_M_S2: f64 = 9.81;

/// A law and its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Stuff {
    /// The law.
    pub substance: Substance,
    /// Young's modulus; of a liquid its bulk modulus.
    pub young_pa: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Mass density.
    pub density_kg_m3: f64,
}

/// What automatic moduli in one object go by.
#[derive(Clone, Copy, Debug)]
pub struct Yardstick {
    /// Young's modulus with which the object stands, with room to spare.
    pub standing_pa: f64,
    /// The density for which that is so.
    pub density_kg_m3: f64,
    /// Height of the object.
    pub height_m: f64,
}

impl Yardstick {
    /// Automatic Young's modulus of a material in this object.
    fn automatic_pa(&self, material: &Material) -> f64 {
        let density = material.density_kg_m3();
        if material.stands() {
            return self.standing_pa * density / self.density_kg_m3;
        }
        if let Material::Liquid(liquid) = material {
            let (height_m, gravity_m_s2) = (self.height_m as f32, STANDARD_M_S2 as f32);
            // A drop of this height holds 4 sigma / height inside, which is to compress it by no more than depth would.
            let tension_pa = 4.0 * liquid.surface_tension_n_m / self.height_m.max(f64::MIN_POSITIVE);
            return f64::from(liquid_bulk_pa(height_m, 0.0, gravity_m_s2, density as f32)).max(tension_pa / DROP_STRAIN);
        }
        // Bulk modulus from depth: K = rho g h / strain, E = 3 K (1 - 2 nu).
        let bulk_pa = density * STANDARD_M_S2 * self.height_m / FLOWING_STRAIN;
        (3.0 * bulk_pa * (1.0 - 2.0 * material.poisson().unwrap_or(0.0))).clamp(FLOWING_PA.0, FLOWING_PA.1)
    }

    /// A material of this object as the solver takes it.
    pub fn stuff(&self, material: &Material) -> Stuff {
        let young_pa = match (material, material.young_pa()) {
            // A body has no modulus.
            (Material::Rigid(_), _) => 0.0,
            (_, Some(Young::Value(young_pa) | Young::AtLeast(young_pa))) => young_pa,
            _ => self.automatic_pa(material),
        };
        Stuff { substance: substance(material), young_pa, poisson: material.poisson().unwrap_or(0.0), density_kg_m3: material.density_kg_m3() }
    }
}

impl Yardstick {
    /// What a material is where all of the object turns into it at once: the same everywhere, and enough to bear it.
    pub fn stuff_throughout(&self, material: &Material) -> Stuff {
        let mut stuff = self.stuff(material);
        if let Some(Young::AtLeast(least_pa)) = material.young_pa() {
            stuff.young_pa = least_pa.max(BEARING * self.automatic_pa(material));
        }
        stuff
    }

    /// What some stuff of this object freezes to: itself where it keeps its shape, else an elastic solid.
    pub fn frozen(&self, stuff: &Stuff) -> Stuff {
        if stuff.substance.keeps_shape() {
            return stuff.clone();
        }
        let young_pa = stuff.density_kg_m3 * STANDARD_M_S2 * self.height_m.max(f64::MIN_POSITIVE) / FROZEN_STRAIN;
        Stuff { substance: Substance::Elastic(spec::ElasticModel::Corotated), young_pa, poisson: 0.3, density_kg_m3: stuff.density_kg_m3 }
    }
}

impl Stuff {
    /// What a change to this makes of a particle's moduli.
    pub fn moduli(&self) -> Moduli {
        match self.substance.is_liquid() {
            true => Moduli::Lame { mu_pa: 0.0, lambda_pa: self.young_pa as f32 },
            false => Moduli::Young { young_pa: self.young_pa as f32, poisson: self.poisson as f32 },
        }
    }

    /// This solid as what some stuff that kept no shape froze to: the eye goes on taking it for that.
    pub fn frozen_from(&self, poured: &Stuff) -> Stuff {
        let substance = match (&self.substance, poured.substance.flow()) {
            (Substance::Elastic(model), Some(poured)) => Substance::Frozen { model: *model, poured },
            _ => self.substance.clone(),
        };
        Stuff { substance, ..self.clone() }
    }

    /// The same with less strength: yield stress and cohesion times a share. Its moduli are the solver's to scale.
    pub fn weakened(&self, share: f64) -> Stuff {
        let times = |value: f32| (f64::from(value) * share) as f32;
        let substance = match self.substance.clone() {
            Substance::Plastic { yield_stress_pa, hardening_pa } => {
                Substance::Plastic { yield_stress_pa: times(yield_stress_pa), hardening_pa: times(hardening_pa) }
            }
            Substance::Viscoplastic { yield_stress_pa, viscosity_pa_s } => {
                Substance::Viscoplastic { yield_stress_pa: times(yield_stress_pa), viscosity_pa_s }
            }
            Substance::Sand { friction_angle_deg, cohesion_pa } => Substance::Sand { friction_angle_deg, cohesion_pa: times(cohesion_pa) },
            other => other,
        };
        Stuff { substance, young_pa: self.young_pa * share, ..self.clone() }
    }
}

fn substance(material: &Material) -> Substance {
    match material {
        Material::Rigid(m) => Substance::Rigid { friction: m.friction as f32, restitution: m.restitution as f32 },
        Material::Elastic(m) => Substance::Elastic(m.model),
        Material::Muscle(m) => {
            let fibre = DVec3::from(m.fibre).normalize_or(DVec3::Z).as_vec3();
            Substance::Muscle { model: m.model, fibre, activation: activation(&m.activation) }
        }
        Material::Plastic(m) => Substance::Plastic { yield_stress_pa: m.yield_stress_pa as f32, hardening_pa: m.hardening_pa as f32 },
        Material::Viscoplastic(m) => Substance::Viscoplastic { yield_stress_pa: m.yield_stress_pa as f32, viscosity_pa_s: m.viscosity_pa_s as f32 },
        Material::Sand(m) => Substance::Sand { friction_angle_deg: m.friction_angle_deg as f32, cohesion_pa: m.cohesion_pa as f32 },
        Material::Snow(m) => Substance::Snow { theta_c: m.theta_c as f32, theta_s: m.theta_s as f32, hardening: m.hardening as f32 },
        Material::Liquid(m) => {
            let (viscosity_pa_s, surface_tension_n_m) = (m.viscosity_pa_s as f32, m.surface_tension_n_m as f32);
            match m.solver {
                LiquidSolver::Mpm => Substance::Liquid { viscosity_pa_s, surface_tension_n_m },
                LiquidSolver::Sph => Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m },
            }
        }
    }
}

fn activation(activation: &spec::Activation) -> Activation {
    match activation {
        spec::Activation::Steady(value) => Activation::Curve(vec![(0.0, *value)]),
        spec::Activation::Curve(points) => Activation::Curve(points.iter().map(|[time_s, value]| (*time_s, *value)).collect()),
        spec::Activation::Wave(w) => Activation::Wave { least: w.least, most: w.most, period_s: w.period_s, phase: w.phase },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Elastic, Liquid, Sand};

    #[test]
    fn heavier_parts_are_stiffer_and_deeper_heaps_too() {
        let yard = |height_m| Yardstick { standing_pa: 2e5, density_kg_m3: 1000.0, height_m };
        let heavy = Material::Elastic(Elastic { density_kg_m3: 3000.0, ..Elastic::default() });
        assert_eq!(yard(1.0).automatic_pa(&heavy), 6e5);
        let sand = Material::Sand(Sand { young_pa: Young::Auto, ..Sand::default() });
        // A raindrop is held by its skin: 4 x 0.072 N/m / 2 mm / 0.01.
        let water = Material::Liquid(Liquid { surface_tension_n_m: 0.072, ..Liquid::default() });
        assert!((yard(2e-3).automatic_pa(&water) - 14_400.0).abs() < 1.0);
        assert!((yard(0.5).automatic_pa(&water) - 100.0 * 1000.0 * 2.0 * 9.81 * 0.5).abs() < 200.0);
        // 1600 kg/m3 x 9.81 m/s2 x 0.25 m / 0.01 = 392 kPa of bulk modulus, x 3 (1 - 0.6).
        assert!((yard(0.25).automatic_pa(&sand) - 1.2 * 392_400.0).abs() < 1.0);
        assert_eq!(yard(10.0).automatic_pa(&sand), 1e6);
    }
}
