//! Values that have a name: kinds of stuff and kinds of gravity.

use super::{Elastic, ElasticModel, Liquid, LiquidSolver, Material, Plastic, Rigid, Sand, Snow, Viscoplastic, Young};

/// A stuff of everyday life.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialPreset {
    /// Its name.
    pub name: &'static str,
    /// Its kind and parameters.
    pub material: Material,
    /// Where the numbers come from.
    pub source: &'static str,
}

const fn elastic(young_pa: f64, poisson: f64, density_kg_m3: f64) -> Material {
    Material::Elastic(Elastic { young_pa: Young::Value(young_pa), poisson, density_kg_m3, model: ElasticModel::Corotated })
}

const fn rigid(density_kg_m3: f64, friction: f64, restitution: f64) -> Material {
    Material::Rigid(Rigid { density_kg_m3, friction, restitution })
}

const fn plastic(young_pa: f64, poisson: f64, density_kg_m3: f64, yield_stress_pa: f64) -> Material {
    Material::Plastic(Plastic { young_pa: Young::Value(young_pa), poisson, density_kg_m3, yield_stress_pa, hardening_pa: 0.0 })
}

const fn viscoplastic(density_kg_m3: f64, yield_stress_pa: f64, viscosity_pa_s: f64) -> Material {
    Material::Viscoplastic(Viscoplastic { young_pa: Young::Auto, poisson: 0.4, density_kg_m3, yield_stress_pa, viscosity_pa_s })
}

const fn sand(young_pa: f64, density_kg_m3: f64, friction_angle_deg: f64, cohesion_pa: f64) -> Material {
    Material::Sand(Sand { young_pa: Young::Value(young_pa), poisson: 0.3, density_kg_m3, friction_angle_deg, cohesion_pa })
}

const fn liquid(density_kg_m3: f64, viscosity_pa_s: f64, surface_tension_n_m: f64) -> Material {
    Material::Liquid(Liquid { density_kg_m3, viscosity_pa_s, surface_tension_n_m, solver: LiquidSolver::Mpm })
}

const fn preset(name: &'static str, material: Material, source: &'static str) -> MaterialPreset {
    MaterialPreset { name, material, source }
}

/// Rubber and jelly hardly change their volume (nu near 0.5); 0.45 is as near as explicit steps go without tiny steps.
/// What is given as chosen has no one value in life: it was picked so that the thing behaves as people expect of it.
pub const MATERIALS: &[MaterialPreset] = &[
    preset(
        "rubber",
        elastic(1.5e6, 0.45, 930.0),
        "natural rubber, 1.5 to 2.5 MPa and 920 to 930 kg/m3 (Ashby, Materials Selection in Mechanical Design, appendix A)",
    ),
    preset(
        "jelly",
        Material::Elastic(Elastic { young_pa: Young::AtLeast(1e4), poisson: 0.45, density_kg_m3: 1030.0, model: ElasticModel::Corotated }),
        "gelatine gel of about a tenth gelatine by weight: of the order of 10 kPa; nearly water; firmer where it would not bear its own weight, as a cook makes it",
    ),
    preset("foam", elastic(3e5, 0.25, 35.0), "flexible polymer foam of very low density, 0.3 to 1 MPa and 16 to 35 kg/m3 (Ashby, appendix A)"),
    preset("cloth-like", elastic(3e4, 0.1, 250.0), "chosen: a thick soft weave taken as a solid, so limp that it folds under its own weight"),
    preset(
        "wood",
        rigid(700.0, 0.4, 0.4),
        "oak along the year, 600 to 900 kg/m3 (Ashby, appendix A); wood on wood slides at 0.25 to 0.5; restitution chosen",
    ),
    preset(
        "steel",
        rigid(7850.0, 0.5, 0.55),
        "7850 kg/m3; dry steel on steel 0.4 to 0.6; balls of steel give back about 5/9 (Newton, Principia, scholium to the laws)",
    ),
    preset("stone", rigid(2700.0, 0.6, 0.3), "granite, 2600 to 2750 kg/m3; friction and restitution chosen"),
    preset("glass", rigid(2500.0, 0.4, 0.6), "soda-lime glass; balls of glass give back up to 15/16 (Newton), a vessel less: chosen"),
    preset(
        "plastic",
        rigid(1050.0, 0.35, 0.5),
        "ABS, 1010 to 1210 kg/m3 (Ashby, appendix A): the stuff of toys, not the kind; friction and restitution chosen",
    ),
    preset(
        "dough",
        plastic(1e5, 0.4, 1200.0, 2e3),
        "chosen within wheat dough's moduli of 10 to 100 kPa: stiff enough for a small loaf to keep its shape, soft enough to be pressed by hand",
    ),
    preset("clay", plastic(3e6, 0.4, 1750.0, 3e4), "soft clay bears 25 to 50 kPa unconfined (Terzaghi and Peck), about a hundredth of its modulus"),
    preset("water", liquid(998.0, 1.0e-3, 0.0728), "at 20 degC (IAPWS); the grid's own viscosity is larger where cells are over a few millimetres"),
    preset("honey", liquid(1420.0, 10.0, 0.055), "1.36 to 1.45 kg/l, about 10 Pa s at 20 degC, 50 to 60 mN/m"),
    preset("lava", liquid(2600.0, 150.0, 0.35), "basalt at 1150 degC: 2600 to 2700 kg/m3, 100 to 200 Pa s, 0.35 N/m (Walker and Mullins 1981)"),
    preset("mud", viscoplastic(1600.0, 300.0, 100.0), "chosen: a thick mud that stands a few centimetres high"),
    preset("jam", viscoplastic(1300.0, 60.0, 10.0), "fruit jams yield at 20 to 80 Pa; viscosity of their flow chosen"),
    preset(
        "sand",
        sand(3.5e5, 1600.0, 35.0, 0.0),
        "dry sand, 1500 to 1700 kg/m3, 30 to 35 degrees; the modulus is one that steps resolve, a heap does not show it",
    ),
    preset("dry_soil", sand(3.5e5, 1300.0, 30.0, 1e3), "loose dry loam, 1200 to 1400 kg/m3, 28 to 34 degrees, a cohesion of the order of 1 kPa"),
    preset(
        "snow",
        Material::Snow(Snow { young_pa: Young::Value(1.4e5), poisson: 0.2, density_kg_m3: 400.0, theta_c: 2.5e-2, theta_s: 7.5e-3, hardening: 10.0 }),
        "Stomakhin et al. 2013, the values that they start from",
    ),
];

/// Gravity of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityPreset {
    /// The place.
    pub name: &'static str,
    /// Free fall, downwards.
    pub m_s2: f64,
}

impl GravityPreset {
    /// As an acceleration in the world's frame.
    pub fn vector(&self) -> [f64; 3] {
        [0.0, 0.0, 0.0 - self.m_s2]
    }
}

/// Surface gravity; the giants' at one bar (NASA planetary fact sheets).
pub const GRAVITY: &[GravityPreset] = &[
    GravityPreset { name: "earth", m_s2: 9.81 },
    GravityPreset { name: "moon", m_s2: 1.62 },
    GravityPreset { name: "mars", m_s2: 3.71 },
    GravityPreset { name: "jupiter", m_s2: 24.79 },
    GravityPreset { name: "zero", m_s2: 0.0 },
];

/// The stuff of that name.
pub fn material(name: &str) -> Option<&'static MaterialPreset> {
    MATERIALS.iter().find(|preset| preset.name == name)
}

/// The gravity of that name.
pub fn gravity(name: &str) -> Option<&'static GravityPreset> {
    GRAVITY.iter().find(|preset| preset.name == name)
}
