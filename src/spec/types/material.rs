//! What things are made of.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::auto::Auto;
use crate::spec::limits;

/// Hyperelastic energy of an elastic material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElasticModel {
    /// Fixed corotated: tau = 2 mu (F - R) F^T + lambda J (J - 1) I.
    #[default]
    Corotated,
    /// Neo-Hookean: tau = mu (F F^T - I) + lambda ln J I.
    NeoHookean,
}

/// What an object is made of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Material {
    /// Returns to its shape.
    Elastic(Elastic),
}

impl Default for Material {
    fn default() -> Self {
        Material::Elastic(Elastic::default())
    }
}

/// Parameters of an elastic solid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Elastic {
    /// Young's modulus E; `"auto"` is four times the self-buckling bound of the most slender part.
    #[schemars(extend("minimum" = limits::YOUNG_PA.0, "maximum" = limits::YOUNG_PA.1))]
    pub young_pa: Auto<f64>,
    /// Poisson's ratio nu.
    #[schemars(range(min = 0.0, max = limits::POISSON))]
    pub poisson: f64,
    /// Mass density rho.
    #[schemars(range(min = limits::DENSITY_KG_M3.0, max = limits::DENSITY_KG_M3.1))]
    pub density_kg_m3: f64,
    /// The energy.
    pub model: ElasticModel,
}

impl Default for Elastic {
    fn default() -> Self {
        Elastic { young_pa: Auto::Auto, poisson: 0.3, density_kg_m3: 1000.0, model: ElasticModel::Corotated }
    }
}
