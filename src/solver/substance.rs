//! What particles are made of: a table of substances, a row for each, that the passes read.

use super::constants::{FRICTION, J_FLOOR, J_LEAST, LIQUID_J_MOST, LOOSE_MOST};
use crate::spec::ElasticModel;
use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3};
use serde::{Deserialize, Serialize};

/// How matter that keeps no shape flows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Flow {
    /// Grains stay themselves: sand, snow.
    Grains = 1,
    /// Thick and dull, its colours mix: mud, jam.
    Paste = 2,
    /// Has a skin that shines, its colours mix.
    Liquid = 3,
}

/// A constitutive law and its numbers. Moduli and density are each particle's own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Substance {
    /// Returns to its shape.
    Elastic(ElasticModel),
    /// The same of what froze out of matter that kept no shape. The eye goes on taking it for that: its particles are what
    /// is seen.
    Frozen {
        /// How it returns to the shape that it froze in.
        model: ElasticModel,
        /// How it flowed before.
        poured: Flow,
    },
    /// Elastic, and pulls along its fibres by E times the activation (as stress at rest length).
    Muscle {
        /// Of its passive part.
        model: ElasticModel,
        /// Direction of the fibres in the captured pose; any length but 0.
        fibre: Vec3,
        /// How hard they pull over time.
        activation: Activation,
    },
    /// Von Mises with linear hardening: keeps dents.
    Plastic {
        /// Stress at which a bar in tension yields, Pa.
        yield_stress_pa: f32,
        /// Rise of that stress with plastic strain, Pa; negative softens, down to a hundredth.
        hardening_pa: f32,
    },
    /// Bingham: a solid below its yield stress, above it a thick liquid.
    Viscoplastic {
        /// Stress at which a bar in tension yields, Pa; in shear 1/sqrt(3) of it. 0 always flows.
        yield_stress_pa: f32,
        /// Plastic viscosity in simple shear, Pa s; 0 slips freely at the yield stress.
        viscosity_pa_s: f32,
    },
    /// Drucker-Prager: grains that hold by friction.
    Sand {
        /// Slope at which it comes to rest, degrees, above 0 and below 90: tan of it is the ratio of
        /// shear to pressure at which it slides.
        friction_angle_deg: f32,
        /// Shear stress that it bears without pressure, Pa.
        cohesion_pa: f32,
    },
    /// Stomakhin et al. 2013: packs and hardens, breaks and loosens.
    Snow {
        /// Compression that is still elastic, as a strain.
        theta_c: f32,
        /// Stretch that is still elastic, as a strain.
        theta_s: f32,
        /// Exponent of the stiffness over the packing: exp(hardening (1 - Jp)).
        hardening: f32,
    },
    /// Flows and wets. Its particles have no shear modulus; their bulk modulus stands for that it
    /// cannot be compressed ([`liquid_bulk_pa`]).
    Liquid {
        /// Dynamic viscosity, Pa s.
        viscosity_pa_s: f32,
        /// Surface tension, N/m.
        surface_tension_n_m: f32,
    },
    /// A liquid of smoothed particles, half a cell apart, beside the grid; see `sph`.
    SphLiquid {
        /// Dynamic viscosity.
        viscosity_pa_s: f32,
        /// Against air.
        surface_tension_n_m: f32,
    },
    /// Keeps its shape. The particles of one object and one row are one body; rows of one object whose
    /// particles touch are welded. Moduli are not used. Friction between two bodies, or a body and a collider, is
    /// the root of the product of theirs, restitution the larger of theirs; soft matter, which is given none, has that of
    /// whatever body or collider it lies on.
    Rigid {
        /// Coulomb coefficient.
        friction: f32,
        /// Share of the approaching speed that is given back, 0 to 1.
        restitution: f32,
    },
}

impl Default for Substance {
    fn default() -> Substance {
        Substance::Elastic(ElasticModel::Corotated)
    }
}

/// How hard a muscle pulls over time: 0 not at all, 1 by its Young's modulus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Activation {
    /// Straight lines between points (seconds, value) in ascending time; held before and after them.
    Curve(Vec<(f64, f64)>),
    /// Swings between two values like a cosine, from `least` at phase 0.
    Wave {
        /// Value at the start of a period.
        least: f64,
        /// Value half a period later.
        most: f64,
        /// Length of a period, seconds.
        period_s: f64,
        /// Share of a period that has passed at t = 0.
        phase: f64,
    },
}

impl Activation {
    /// The value at a time, held to 0 to 1.
    pub fn at(&self, time_s: f64) -> f64 {
        let value = match self {
            Activation::Curve(points) => {
                let next = points.partition_point(|&(t, _)| t <= time_s);
                match (next.checked_sub(1).and_then(|k| points.get(k)), points.get(next)) {
                    (Some(&(t0, a0)), Some(&(t1, a1))) => a0 + (a1 - a0) * (time_s - t0) / (t1 - t0),
                    (Some(&(_, a)), None) | (None, Some(&(_, a))) => a,
                    (None, None) => 0.0,
                }
            }
            Activation::Wave { least, most, period_s, phase } => {
                let turn = (time_s / period_s + phase) * std::f64::consts::TAU;
                least + (most - least) * 0.5 * (1.0 - turn.cos())
            }
        };
        if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// `Substance` of `shaders/solver/substance.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct SubstanceRecord {
    pub kind: u32,
    pub model: u32,
    pub shown: [f32; 2],
    pub values: [f32; 5],
    /// How it flows for the eye, a [`Flow`]; 0 where it keeps its shape.
    pub flow: f32,
}

/// Kinds, as WGSL knows them.
pub(super) const ELASTIC: u32 = 0;
pub(super) const MUSCLE: u32 = 1;
pub(super) const PLASTIC: u32 = 2;
pub(super) const VISCOPLASTIC: u32 = 3;
pub(super) const SAND: u32 = 4;
pub(super) const SNOW: u32 = 5;
pub(super) const LIQUID: u32 = 6;
pub(super) const SPH_LIQUID: u32 = 16;
pub(super) const RIGID: u32 = 8;

impl Substance {
    pub(super) fn record(&self) -> SubstanceRecord {
        let model_of = |model: &ElasticModel| u32::from(*model == ElasticModel::NeoHookean);
        let (kind, model, values) = match self {
            Substance::Elastic(model) | Substance::Frozen { model, .. } => (ELASTIC, model_of(model), [0.0; 3]),
            Substance::Muscle { model, fibre, .. } => (MUSCLE, model_of(model), fibre.normalize_or_zero().to_array()),
            Substance::Plastic { yield_stress_pa, hardening_pa } => (PLASTIC, 0, [*yield_stress_pa, *hardening_pa, 0.0]),
            Substance::Viscoplastic { yield_stress_pa, viscosity_pa_s } => (VISCOPLASTIC, 0, [*yield_stress_pa, *viscosity_pa_s, 0.0]),
            Substance::Sand { friction_angle_deg, cohesion_pa } => {
                let tan = friction_angle_deg.to_radians().tan();
                (SAND, 0, [std::f32::consts::SQRT_2 * tan, cohesion_pa / tan, 0.0])
            }
            Substance::Snow { theta_c, theta_s, hardening } => (SNOW, 0, [*theta_c, *theta_s, *hardening]),
            Substance::Liquid { viscosity_pa_s, surface_tension_n_m } => (LIQUID, 0, [*viscosity_pa_s, *surface_tension_n_m, 0.0]),
            Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m } => (SPH_LIQUID, 0, [*viscosity_pa_s, *surface_tension_n_m, 0.0]),
            Substance::Rigid { friction, restitution } => (RIGID, 0, [*friction, *restitution, 0.0]),
        };
        let [a, b, c] = values;
        let flow = self.flow().map_or(0.0, |flow| f32::from(flow as u8));
        SubstanceRecord { kind, model, shown: self.shown_stretch().unwrap_or_default(), values: [a, b, c, f32::MAX, 0.0], flow }
    }

    /// Bounds of the stretch that is shown of what does not remember its shape; none where F is shown.
    /// Narrow where matter comes apart, so that no Gaussian becomes a needle.
    pub(super) fn shown_stretch(&self) -> Option<[f32; 2]> {
        match self {
            Substance::Elastic(_) | Substance::Frozen { .. } | Substance::Muscle { .. } | Substance::Rigid { .. } => None,
            Substance::Plastic { .. } => Some([0.3, 3.0]),
            Substance::Viscoplastic { .. } => Some([0.4, 2.5]),
            Substance::Sand { .. } | Substance::Snow { .. } => Some([0.7, 1.4]),
            Substance::Liquid { .. } => Some([0.6, 1.7]),
            Substance::SphLiquid { .. } => None,
        }
    }

    /// How what keeps no shape flows, or did before it froze, as `frame.wgsl` says it of each particle; none where it always
    /// kept it.
    pub fn flow(&self) -> Option<Flow> {
        match self {
            Substance::Frozen { poured, .. } => Some(*poured),
            Substance::Sand { .. } | Substance::Snow { .. } => Some(Flow::Grains),
            Substance::Viscoplastic { .. } => Some(Flow::Paste),
            Substance::Liquid { .. } | Substance::SphLiquid { .. } => Some(Flow::Liquid),
            _ => None,
        }
    }

    /// Whether the shape of its Gaussians means nothing any more once they part.
    pub fn sheds_shape(&self) -> bool {
        self.flow().is_some()
    }

    /// Whether it flows without any shear modulus.
    pub fn is_liquid(&self) -> bool {
        matches!(self, Substance::Liquid { .. })
    }

    /// Its dynamic viscosity, Pa s, where it is one that clings to walls: liquids on the grid, and pastes that are viscous.
    pub(super) fn clings_pa_s(&self) -> Option<f32> {
        match self {
            Substance::Liquid { viscosity_pa_s, .. } => Some(*viscosity_pa_s),
            Substance::Viscoplastic { viscosity_pa_s, .. } => Some(*viscosity_pa_s).filter(|viscosity| *viscosity > 0.0),
            _ => None,
        }
    }

    /// Its surface tension on the grid, N/m.
    pub(super) fn tension_n_m(&self) -> f32 {
        match self {
            Substance::Liquid { surface_tension_n_m, .. } => *surface_tension_n_m,
            _ => 0.0,
        }
    }

    /// Whether the plain passes do, which know nothing but the elastic law; bodies have their own.
    pub(super) fn is_plain(&self) -> bool {
        matches!(self, Substance::Elastic(_) | Substance::Frozen { .. } | Substance::Rigid { .. }) || self.is_sph()
    }

    /// Friction and restitution of a rigid one.
    pub(super) fn rigid(&self) -> Option<(f32, f32)> {
        match self {
            Substance::Rigid { friction, restitution } => Some((*friction, *restitution)),
            _ => None,
        }
    }

    /// Whether it is a liquid of smoothed particles, which has no part in the grid.
    pub(super) fn is_sph(&self) -> bool {
        matches!(self, Substance::SphLiquid { .. })
    }

    /// Whether it can stand as captured, under a prestress.
    pub(super) fn can_stand(&self) -> bool {
        !(self.flows_freely() || matches!(self, Substance::Sand { .. } | Substance::Snow { .. }))
    }

    /// Whether it flows, by whichever method.
    pub fn flows_freely(&self) -> bool {
        self.is_liquid() || self.is_sph()
    }

    /// Coulomb coefficient of its surface against other objects: grains slide on others as on themselves, liquids freely.
    pub(super) fn friction(&self) -> f32 {
        match self {
            Substance::Rigid { friction, .. } => *friction,
            Substance::Sand { friction_angle_deg, .. } => friction_angle_deg.to_radians().tan(),
            Substance::Liquid { .. } | Substance::SphLiquid { .. } => 0.0,
            _ => FRICTION,
        }
    }

    /// Whether nothing deforms it.
    pub fn is_rigid(&self) -> bool {
        self.rigid().is_some()
    }

    /// Whether it keeps a shape of its own.
    pub fn keeps_shape(&self) -> bool {
        match self {
            Substance::Elastic(_) | Substance::Frozen { .. } | Substance::Muscle { .. } | Substance::Plastic { .. } | Substance::Rigid { .. } => true,
            Substance::Viscoplastic { .. } | Substance::Sand { .. } | Substance::Snow { .. } => false,
            Substance::Liquid { .. } | Substance::SphLiquid { .. } => false,
        }
    }

    /// Whether its law says nothing of what is turned inside out: of the logarithm of no volume.
    pub(super) fn must_not_invert(&self) -> bool {
        matches!(self, Substance::Elastic(ElasticModel::NeoHookean) | Substance::Muscle { model: ElasticModel::NeoHookean, .. })
    }

    /// Whether its stress is that of its stretch.
    pub(super) fn carries_by_stretch(&self) -> bool {
        self.keeps_shape() && !self.is_rigid() || matches!(self, Substance::Viscoplastic { .. } | Substance::Snow { .. })
    }

    /// What its law remembers of a past in which nothing happened.
    pub(super) fn first_history(&self) -> f32 {
        match self {
            // det of the plastic part of F.
            Substance::Snow { .. } => 1.0,
            _ => 0.0,
        }
    }

    /// Whether its history is ln det F at the last sort, from which changes of volume are evened over a cell.
    pub(super) fn remembers_volume(&self) -> bool {
        matches!(self, Substance::Elastic(_) | Substance::Frozen { .. } | Substance::Muscle { .. })
    }

    /// The history of what has this F from now on, whatever it was before where the law asks F alone.
    pub(super) fn history_with(&self, f: Mat3, history: f32) -> f32 {
        if self.remembers_volume() { f.determinant().max(J_FLOOR).ln() } else { history }
    }

    /// F and history with which matter goes on under this law that comes from another: solids keep the
    /// stress that their F carries, sand of it the pressure alone, and what has come apart is loose.
    pub(super) fn taken_over(&self, before: &Substance, f: Mat3, history: f32) -> (Mat3, f32) {
        if std::mem::discriminant(self) == std::mem::discriminant(before) {
            return (f, history);
        }
        // Smoothed particles left each other since: what F was says nothing.
        let f = if before.is_sph() { Mat3::IDENTITY } else { f };
        match self {
            // A body's F is its rotation since it was made.
            Substance::Rigid { .. } => (Mat3::IDENTITY, 0.0),
            Substance::Sand { .. } => {
                let volume = f.determinant().max(J_LEAST);
                (Mat3::from_diagonal(Vec3::splat(volume.min(1.0).cbrt())), volume.ln().clamp(0.0, LOOSE_MOST))
            }
            // What a soft solid was squeezed by would burst it as a liquid: it takes its volume back in
            // its own time, as its density is seen.
            Substance::Liquid { .. } => (Mat3::from_diagonal(Vec3::splat(f.determinant().clamp(0.98, LIQUID_J_MOST).cbrt())), 0.0),
            // Nobody strained a liquid by the gaps that it has.
            _ if before.is_liquid() => (f * (LIQUID_J_MOST / f.determinant().max(LIQUID_J_MOST)).cbrt(), self.first_history()),
            _ => (f, self.first_history()),
        }
    }

    /// What of its numbers makes no sense, where something does not.
    pub(super) fn flaw(&self) -> Option<String> {
        let positive = 0.0..f32::INFINITY;
        let fine = match self {
            Substance::Elastic(_) | Substance::Frozen { .. } => true,
            Substance::Rigid { friction, restitution } => positive.contains(friction) && (0.0..=1.0).contains(restitution),
            Substance::Muscle { fibre, .. } => fibre.is_finite() && *fibre != Vec3::ZERO,
            Substance::Plastic { yield_stress_pa, hardening_pa } => positive.contains(yield_stress_pa) && hardening_pa.is_finite(),
            Substance::Viscoplastic { yield_stress_pa, viscosity_pa_s } => positive.contains(yield_stress_pa) && positive.contains(viscosity_pa_s),
            Substance::Sand { friction_angle_deg, cohesion_pa } => {
                *friction_angle_deg > 0.0 && *friction_angle_deg < 90.0 && positive.contains(cohesion_pa)
            }
            Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m } => {
                positive.contains(viscosity_pa_s) && positive.contains(surface_tension_n_m)
            }
            Substance::Snow { theta_c, theta_s, hardening } => {
                *theta_c > 0.0 && *theta_c < 1.0 && *theta_s > 0.0 && *theta_s < 1.0 && (0.0..=20.0).contains(hardening)
            }
            Substance::Liquid { viscosity_pa_s, surface_tension_n_m } => positive.contains(viscosity_pa_s) && positive.contains(surface_tension_n_m),
        };
        (!fine).then(|| format!("{self:?}"))
    }
}

/// Bulk modulus that a weakly compressible liquid needs, Pa: sound ten times as fast as anything flows
/// compresses it by v^2 / (2 c^2), half a per cent, and its own weight by as much (Monaghan 1994).
/// `depth_m` is the height that it stands or falls through, `speed_m_s` what it is thrown with.
pub fn liquid_bulk_pa(depth_m: f32, speed_m_s: f32, gravity_m_s2: f32, density_kg_m3: f32) -> f32 {
    let fastest_2 = speed_m_s * speed_m_s + 2.0 * gravity_m_s2 * depth_m;
    100.0 * density_kg_m3 * fastest_2
}

/// The rows that the particles' tags name, each stiffened by packing no more than so many times.
pub(super) fn records(substances: &[Substance], stiffenings: &[f32]) -> Vec<SubstanceRecord> {
    substances.iter().zip(stiffenings).map(|(substance, most)| substance.record().stiffened_to(*most)).collect()
}

impl SubstanceRecord {
    /// The same where packing stiffens by no more than so many times.
    pub fn stiffened_to(mut self, most: f32) -> SubstanceRecord {
        self.values[3] = most;
        self
    }
}
