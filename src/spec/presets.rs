//! Values that have a name: kinds of stuff and kinds of gravity.

use super::{Auto, Elastic, ElasticModel};

/// An elastic solid of everyday life.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticPreset {
    /// Its name.
    pub name: &'static str,
    /// Young's modulus.
    pub young_pa: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density.
    pub density_kg_m3: f64,
    /// Where the numbers come from.
    pub source: &'static str,
}

impl ElasticPreset {
    /// As a material.
    pub fn material(&self) -> Elastic {
        Elastic { young_pa: Auto::Value(self.young_pa), poisson: self.poisson, density_kg_m3: self.density_kg_m3, model: ElasticModel::Corotated }
    }
}

/// Rubber and jelly hardly change their volume (nu near 0.5); 0.45 is as near as explicit steps go
/// without locking and without tiny steps.
pub const ELASTIC: &[ElasticPreset] = &[
    ElasticPreset {
        name: "rubber",
        young_pa: 1.5e6,
        poisson: 0.45,
        density_kg_m3: 930.0,
        source: "natural rubber, 1.5 to 2.5 MPa and 920 to 930 kg/m3 (Ashby, Materials Selection in Mechanical Design, appendix A)",
    },
    ElasticPreset {
        name: "jelly",
        young_pa: 1e4,
        poisson: 0.45,
        density_kg_m3: 1030.0,
        source: "gelatine gel of about a tenth gelatine by weight: of the order of 10 kPa; nearly water",
    },
    ElasticPreset {
        name: "foam",
        young_pa: 3e5,
        poisson: 0.25,
        density_kg_m3: 35.0,
        source: "flexible polymer foam of very low density, 0.3 to 1 MPa and 16 to 35 kg/m3 (Ashby, appendix A)",
    },
    ElasticPreset {
        name: "cloth-like",
        young_pa: 3e4,
        poisson: 0.1,
        density_kg_m3: 250.0,
        source: "chosen: a thick soft weave taken as a solid, so limp that it folds under its own weight",
    },
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

/// The elastic preset of that name.
pub fn elastic(name: &str) -> Option<&'static ElasticPreset> {
    ELASTIC.iter().find(|preset| preset.name == name)
}

/// The gravity of that name.
pub fn gravity(name: &str) -> Option<&'static GravityPreset> {
    GRAVITY.iter().find(|preset| preset.name == name)
}
