//! The laws beside the elastic one: their passes, compiled only where a scene has one, and what they
//! keep beside the particles.

use super::advance::Plan;
use super::core::{Solver, padded};
use super::kept::Kept;
use super::passes::SUBSTEP;
use super::sph::Sph;
use super::substance::{self, Activation, Substance};
use super::types::SolverError;
use glam::Mat3;

passes! {
    /// Passes that know all laws, in place of those for elastic matter alone.
    LawPasses;
    stress_laws: ["control", "substep", "substance", "material", "particle", "particle_write", "svd", "hencky", "law_plastic", "law_viscoplastic", "law_sand", "law_snow", "law_muscle", "cube_root", "law_liquid", "laws", "activation", "stress_laws", "stress"] [Read, Write, Read, Write, Read, Read] SUBSTEP;
    prestress_gather_laws: ["control", "substep", "substance", "material", "particle", "particle_write", "svd", "hencky", "law_plastic", "law_viscoplastic", "law_sand", "law_snow", "law_muscle", "cube_root", "law_liquid", "laws", "prestress", "gather", "prestress_gather"] [Read, Write, Write, Read, Write, Read] SUBSTEP;
}

/// Three rows of a matrix, each with a word to spare.
pub(super) type Rows = [[f32; 4]; 3];

pub(super) fn rows(m: Mat3) -> Rows {
    m.transpose().to_cols_array_2d().map(|row| [row[0], row[1], row[2], 0.0])
}

pub(super) fn from_rows(rows: &Rows) -> Mat3 {
    Mat3::from_cols_array_2d(&rows.map(|row| [row[0], row[1], row[2]])).transpose()
}

/// What of a solver the laws keep.
#[derive(Debug)]
pub(super) struct Laws {
    /// The table that tags name a row of.
    pub substances: Vec<Substance>,
    pub table: wgpu::Buffer,
    /// Activation of each row at each boundary of the segment's substeps.
    pub activations: wgpu::Buffer,
    /// Deformation that is shown of particles whose F forgets, in the original order.
    shown: Option<Kept>,
    none_shown: wgpu::Buffer,
    /// Whether the passes know more than the elastic law.
    pub all: bool,
    /// By how much each row may stiffen as it packs.
    pub stiffenings: Vec<f32>,
}

impl Laws {
    /// Of elastic matter; [`Solver::set_substances`] adds what a table needs.
    pub fn new(gpu: &crate::gpu::Gpu) -> Result<Laws, SolverError> {
        Ok(Laws {
            substances: Vec::new(),
            table: gpu.storage_from("solver.substances", &padded(&substance::records(&[], &[]), 1))?,
            activations: gpu.storage_from("solver.activations", &[0f32])?,
            shown: None,
            none_shown: gpu.storage::<Rows>("solver.none_shown", 1)?,
            all: false,
            stiffenings: Vec::new(),
        })
    }

    /// The buffer of what is shown, a single entry where there is none.
    pub fn shown(&self) -> &wgpu::Buffer {
        self.shown.as_ref().map_or(&self.none_shown, |kept| &kept.live)
    }

    /// What is part of the state.
    pub fn kept(&self) -> Option<&Kept> {
        self.shown.as_ref()
    }
}

impl Solver {
    /// Replaces the table. What the new one needs beside the old is made: passes, and room for the
    /// shown deformation.
    pub(super) fn set_substances(&mut self, substances: &[Substance]) -> Result<(), SolverError> {
        if let Some(what) = substances.iter().find_map(Substance::flaw) {
            return Err(SolverError::Input { what, expected: "numbers within the law's range".to_owned() });
        }
        if substances.len() > 1 << 15 {
            return Err(SolverError::Input { what: format!("{} substances", substances.len()), expected: "at most 32768".to_owned() });
        }
        // What was found of a substance holds as long as it has its row.
        let known = self.laws.substances.iter().zip(&self.laws.stiffenings).map(Some).chain(std::iter::repeat(None));
        let stiffening =
            |(now, known): (&Substance, Option<(&Substance, &f32)>)| known.filter(|(then, _)| *then == now).map_or(f32::MAX, |(_, most)| *most);
        self.laws.stiffenings = substances.iter().zip(known).map(stiffening).collect();
        self.laws.table = self.gpu.storage_from("solver.substances", &padded(&substance::records(substances, &self.laws.stiffenings), 1))?;
        self.laws.substances = substances.to_vec();
        if !self.laws.all && !substances.iter().all(Substance::is_plain) {
            let LawPasses { stress_laws, prestress_gather_laws } = LawPasses::new(&self.gpu);
            self.passes.stress = stress_laws;
            self.transfers.know_all_laws(&self.gpu);
            self.passes.prestress_gather = prestress_gather_laws;
            self.laws.all = true;
        }
        self.wet(substances);
        if self.sph.is_none() && substances.iter().any(Substance::is_sph) {
            let (sph, kept) = Sph::new(&self.gpu, self.params.count as usize)?;
            self.sph = Some(sph);
            self.kept.extend(kept);
        }
        if !substances.iter().any(|s| s.shown_stretch().is_some()) {
            self.laws.shown = None;
        } else if self.laws.shown.is_none() {
            self.laws.shown = Some(Kept::new(&self.gpu, "solver.shown", &vec![rows(Mat3::IDENTITY); self.params.count as usize])?);
        }
        Ok(())
    }

    /// Changes what is shown, particle by particle in the original order.
    pub(super) fn edit_shown(&mut self, mut change: impl FnMut(usize, Mat3) -> Mat3) -> Result<(), SolverError> {
        let mut shown = self.shown()?;
        shown.iter_mut().enumerate().for_each(|(i, f)| *f = rows(change(i, from_rows(f))));
        self.set_shown(&shown);
        Ok(())
    }

    /// What is shown, in the original order; nothing where no law needs it.
    pub(super) fn shown(&self) -> Result<Vec<Rows>, SolverError> {
        let kept = self.laws.shown.as_ref();
        Ok(kept.map(|k| self.gpu.read(&k.live, self.params.count as usize)).transpose()?.unwrap_or_default())
    }

    /// Replaces it.
    pub(super) fn set_shown(&self, shown: &[Rows]) {
        if let Some(kept) = &self.laws.shown {
            self.gpu.upload(&kept.live, shown);
        }
    }

    /// Uploads the activations of a segment: each row's at each boundary of its substeps.
    pub(super) fn set_activations(&mut self, plan: &Plan) -> Result<(), SolverError> {
        let curves: Vec<Option<&Activation>> =
            self.laws.substances.iter().map(|s| if let Substance::Muscle { activation, .. } = s { Some(activation) } else { None }).collect();
        if curves.iter().all(Option::is_none) {
            return Ok(());
        }
        let at = |boundary: u32| {
            let time_s = self.time_s + plan.time_s(boundary);
            curves.iter().map(move |curve| curve.map_or(0.0, |c| c.at(time_s) as f32))
        };
        let values: Vec<f32> = (0..=plan.substeps).flat_map(at).collect();
        if self.laws.activations.size() < size_of_val(&values[..]) as u64 {
            self.laws.activations = self.gpu.storage::<f32>("solver.activations", values.len() * 2)?;
        }
        self.gpu.upload(&self.laws.activations, &values);
        Ok(())
    }
}
