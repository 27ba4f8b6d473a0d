//! What things are made of: a kind and its parameters.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Activation, Young};
use crate::spec::limits;

/// What an object, or a part of one, is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Material {
    /// Keeps its shape whatever happens.
    Rigid(Rigid),
    /// Returns to its shape.
    Elastic(Elastic),
    /// Returns to its shape and pulls along its fibres by itself.
    Muscle(Muscle),
    /// Keeps the shape that it is bent to: beyond a stress it yields.
    Plastic(Plastic),
    /// Rests like a solid and flows like a thick liquid beyond a stress.
    Viscoplastic(Viscoplastic),
    /// Grains that slide on each other.
    Sand(Sand),
    /// Packs under pressure and breaks under pull.
    Snow(Snow),
    /// Flows.
    Liquid(Liquid),
}

impl Default for Material {
    fn default() -> Self {
        Material::Elastic(Elastic::default())
    }
}

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

/// How a liquid is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LiquidSolver {
    /// On the grid, as all else: couples with everything.
    #[default]
    Mpm,
    /// By smoothed particles: sharper drops and jets.
    Sph,
}

/// A body that keeps its shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Rigid {
    /// Mass density rho.
    #[schemars(range(min = limits::DENSITY_KG_M3.0, max = limits::DENSITY_KG_M3.1))]
    pub density_kg_m3: f64,
    /// Coulomb coefficient of its surface.
    #[schemars(range(min = 0.0, max = limits::FRICTION))]
    pub friction: f64,
    /// Share of the approaching speed that is given back, 0 to 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub restitution: f64,
}

/// A liquid. The speed of sound, which stands for its stiffness, follows from depth and speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Liquid {
    /// Mass density rho.
    #[schemars(range(min = limits::DENSITY_KG_M3.0, max = limits::DENSITY_KG_M3.1))]
    pub density_kg_m3: f64,
    /// Dynamic viscosity eta: water 0.001, honey 10.
    #[schemars(range(min = 0.0, max = limits::VISCOSITY_PA_S))]
    pub viscosity_pa_s: f64,
    /// Surface tension sigma: low spreads, high holds together.
    #[schemars(range(min = 0.0, max = limits::SURFACE_TENSION_N_M))]
    pub surface_tension_n_m: f64,
    /// How it is solved.
    pub solver: LiquidSolver,
}

/// A solid's parameters: the moduli and the density that all solids share, then its own.
macro_rules! solid {
    ($(#[$about:meta])* $name:ident { $young:expr, $poisson:expr, $density:expr; $($(#[$doc:meta])* $field:ident: $kind:ty = $value:expr,)* }) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, default)]
        pub struct $name {
            /// Young's modulus E; `"auto"` is enough to stand, or to bear its own weight where it flows; `{ at_least = … }` is stiffer where
            /// its weight asks for it, and only there.
            #[schemars(extend("minimum" = limits::YOUNG_PA.0, "maximum" = limits::YOUNG_PA.1))]
            pub young_pa: Young,
            /// Poisson's ratio nu.
            #[schemars(range(min = 0.0, max = limits::POISSON))]
            pub poisson: f64,
            /// Mass density rho.
            #[schemars(range(min = limits::DENSITY_KG_M3.0, max = limits::DENSITY_KG_M3.1))]
            pub density_kg_m3: f64,
            $($(#[$doc])* pub $field: $kind,)*
        }

        impl Default for $name {
            fn default() -> Self {
                $name { young_pa: $young, poisson: $poisson, density_kg_m3: $density, $($field: $value,)* }
            }
        }
    };
}

solid! {
    /// An elastic solid.
    Elastic { Young::Auto, 0.3, 1000.0;
        /// The energy.
        model: ElasticModel = ElasticModel::Corotated,
    }
}

solid! {
    /// An elastic solid with fibres that pull.
    Muscle { Young::Auto, 0.3, 1000.0;
        /// The energy of the elastic part.
        model: ElasticModel = ElasticModel::NeoHookean,
        /// Direction of the fibres in the captured pose; need not be of unit length.
        fibre: [f64; 3] = [0.0, 0.0, 1.0],
        /// How much of Young's modulus the fibres pull with, 0 to 1: one number, `[time_s, activation]`
        /// pairs with straight lines between them, or `{ period_s = … }` for a swing.
        activation: Activation = Activation::Steady(0.0),
    }
}

solid! {
    /// A solid that yields by von Mises' criterion in logarithmic strain.
    Plastic { Young::Value(1e6), 0.3, 1000.0;
        /// Yield stress in uniaxial tension.
        #[schemars(range(min = 0.0, max = limits::STRENGTH_PA))]
        yield_stress_pa: f64 = 1.2e4,
        /// Growth of the yield stress for each unit of plastic strain; negative softens.
        #[schemars(range(min = -limits::STRENGTH_PA, max = limits::STRENGTH_PA))]
        hardening_pa: f64 = 0.0,
    }
}

solid! {
    /// A Bingham solid: beyond the yield stress it flows at a rate that its viscosity sets.
    Viscoplastic { Young::Auto, 0.4, 1000.0;
        /// Yield stress in uniaxial tension.
        #[schemars(range(min = 0.0, max = limits::STRENGTH_PA))]
        yield_stress_pa: f64 = 300.0,
        /// Dynamic viscosity of the flow beyond it.
        #[schemars(range(min = 0.0, max = limits::VISCOSITY_PA_S))]
        viscosity_pa_s: f64 = 100.0,
    }
}

solid! {
    /// Grains by Drucker and Prager. Their modulus is that of the heap, not that of a grain.
    Sand { Young::Value(3.5e5), 0.3, 1600.0;
        /// Angle of internal friction: about the slope at which a heap stands.
        #[schemars(range(min = limits::FRICTION_ANGLE_DEG.0, max = limits::FRICTION_ANGLE_DEG.1))]
        friction_angle_deg: f64 = 35.0,
        /// Shear stress that it bears without pressure: moist sand a few hundred.
        #[schemars(range(min = 0.0, max = limits::STRENGTH_PA))]
        cohesion_pa: f64 = 0.0,
    }
}

solid! {
    /// Snow by Stomakhin et al. 2013.
    Snow { Young::Value(1.4e5), 0.2, 400.0;
        /// Compression at which it begins to pack.
        #[schemars(range(min = limits::SNOW_STRETCH.0, max = limits::SNOW_STRETCH.1))]
        theta_c: f64 = 2.5e-2,
        /// Stretch at which it begins to break.
        #[schemars(range(min = limits::SNOW_STRETCH.0, max = limits::SNOW_STRETCH.1))]
        theta_s: f64 = 7.5e-3,
        /// How fast packing hardens it: the moduli grow by exp(hardening (1 - J)).
        #[schemars(range(min = 0.0, max = limits::SNOW_HARDENING))]
        hardening: f64 = 10.0,
    }
}

impl Default for Rigid {
    fn default() -> Self {
        Rigid { density_kg_m3: 1000.0, friction: 0.3, restitution: 0.0 }
    }
}

impl Default for Liquid {
    fn default() -> Self {
        Liquid { density_kg_m3: 1000.0, viscosity_pa_s: 1e-3, surface_tension_n_m: 0.0728, solver: LiquidSolver::Mpm }
    }
}

/// The field of a material that has it, whatever the kind.
macro_rules! field {
    ($(#[$doc:meta])* $get:ident $get_mut:ident: $type:ty = $field:ident of $($kind:ident),*) => {
        $(#[$doc])*
        pub fn $get(&self) -> Option<$type> {
            #[allow(unreachable_patterns, reason = "some fields are of every kind")]
            match self {
                $(Material::$kind(m) => Some(m.$field),)*
                _ => None,
            }
        }

        $(#[$doc])*
        pub fn $get_mut(&mut self) -> Option<&mut $type> {
            #[allow(unreachable_patterns, reason = "some fields are of every kind")]
            match self {
                $(Material::$kind(m) => Some(&mut m.$field),)*
                _ => None,
            }
        }
    };
}

impl Material {
    /// The kinds, as specs write them.
    pub const KINDS: [&'static str; 8] = ["rigid", "elastic", "muscle", "plastic", "viscoplastic", "sand", "snow", "liquid"];

    /// Its kind, as specs write it.
    pub fn kind(&self) -> &'static str {
        let index = match self {
            Material::Rigid(_) => 0,
            Material::Elastic(_) => 1,
            Material::Muscle(_) => 2,
            Material::Plastic(_) => 3,
            Material::Viscoplastic(_) => 4,
            Material::Sand(_) => 5,
            Material::Snow(_) => 6,
            Material::Liquid(_) => 7,
        };
        Material::KINDS[index]
    }

    /// The kind of that name with its defaults.
    pub fn of_kind(kind: &str) -> Option<Material> {
        Some(match kind {
            "rigid" => Material::Rigid(Rigid::default()),
            "elastic" => Material::Elastic(Elastic::default()),
            "muscle" => Material::Muscle(Muscle::default()),
            "plastic" => Material::Plastic(Plastic::default()),
            "viscoplastic" => Material::Viscoplastic(Viscoplastic::default()),
            "sand" => Material::Sand(Sand::default()),
            "snow" => Material::Snow(Snow::default()),
            "liquid" => Material::Liquid(Liquid::default()),
            _ => return None,
        })
    }

    /// Whether it stands as captured by its own elasticity: what flows or stands by itself has no prestress.
    pub fn stands(&self) -> bool {
        matches!(self, Material::Elastic(_) | Material::Muscle(_) | Material::Plastic(_))
    }

    /// Mass density.
    pub fn density_kg_m3(&self) -> f64 {
        self.density().unwrap_or(1000.0)
    }

    field! {
        /// Mass density; every kind has one.
        density density_mut: f64 = density_kg_m3 of Rigid, Elastic, Muscle, Plastic, Viscoplastic, Sand, Snow, Liquid
    }
    field! {
        /// Young's modulus of the kinds that have one.
        young_pa young_pa_mut: Young = young_pa of Elastic, Muscle, Plastic, Viscoplastic, Sand, Snow
    }
    field! {
        /// Poisson's ratio of the kinds that have one.
        poisson poisson_mut: f64 = poisson of Elastic, Muscle, Plastic, Viscoplastic, Sand, Snow
    }
    field! {
        /// Yield stress of the kinds that have one.
        yield_stress_pa yield_stress_pa_mut: f64 = yield_stress_pa of Plastic, Viscoplastic
    }
    field! {
        /// Viscosity of the kinds that have one.
        viscosity_pa_s viscosity_pa_s_mut: f64 = viscosity_pa_s of Viscoplastic, Liquid
    }
    field! {
        /// Surface tension of a liquid.
        surface_tension_n_m surface_tension_n_m_mut: f64 = surface_tension_n_m of Liquid
    }
    field! {
        /// Cohesion of grains.
        cohesion_pa cohesion_pa_mut: f64 = cohesion_pa of Sand
    }
    field! {
        /// Friction of a rigid body's surface.
        friction friction_mut: f64 = friction of Rigid
    }
    field! {
        /// Restitution of a rigid body's surface.
        restitution restitution_mut: f64 = restitution of Rigid
    }
}
