//! What particles are made of: a table of substances, a row for each, that the passes read.

use crate::spec::ElasticModel;
use bytemuck::{Pod, Zeroable};

/// A constitutive law and its numbers. Moduli and density are each particle's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Substance {
    /// Returns to its shape.
    Elastic(ElasticModel),
}

impl Default for Substance {
    fn default() -> Substance {
        Substance::Elastic(ElasticModel::Corotated)
    }
}

/// `Substance` of `shaders/solver/substance.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct SubstanceRecord {
    pub kind: u32,
    pub model: u32,
    pub values: [f32; 6],
}

impl Substance {
    pub(super) fn record(&self) -> SubstanceRecord {
        match self {
            Substance::Elastic(model) => SubstanceRecord { kind: 0, model: u32::from(*model == ElasticModel::NeoHookean), values: [0.0; 6] },
        }
    }
}

/// The rows that the particles' tags name.
pub(super) fn records(substances: &[Substance]) -> Vec<SubstanceRecord> {
    substances.iter().map(Substance::record).collect()
}
