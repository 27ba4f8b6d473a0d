//! Bodies made anew on the way: by a change of material, or from a checkpoint after one.

use super::body::{self, Shape};
use super::{Rigid, assemble, build};
use crate::solver::core::Solver;
use crate::solver::laws::{Rows, from_rows, rows};
use crate::solver::obstacles;
use crate::solver::state::ParticleState;
use crate::solver::types::SolverError;
use glam::Mat3;

impl Solver {
    /// Makes all bodies from what particles are now. Momentum and angular momentum stay, and what is seen.
    pub(in crate::solver) fn reassemble(&mut self, states: &mut [ParticleState], unstressed: &mut [Rows]) -> Result<(), SolverError> {
        for (state, unstressed) in states.iter_mut().zip(unstressed).filter(|(s, _)| s.is_of_body()) {
            *unstressed = rows(state.f() * from_rows(unstressed));
            state.set_f(Mat3::IDENTITY);
        }
        let colliders = obstacles::colliders(&self.settings);
        let all = assemble(states, &self.laws.substances, &colliders, self.settings.cell_m)?;
        self.rigid = all.map(|all| Rigid::new(&self.gpu, &all)).transpose()?;
        Ok(())
    }

    /// Makes the bodies of a checkpoint, whose motion is then that of the checkpoint.
    pub(in crate::solver) fn rebuild(&mut self, anchors: Vec<[f32; 4]>, count: usize, states: &[ParticleState]) -> Result<(), SolverError> {
        // Anchors tell the shape and what hangs on it; of what it is made may have changed before anything moved.
        let table = &self.laws.substances;
        let made = |shape: &Shape, members: &[usize]| body::surface(states, members, table) == (shape.friction, shape.restitution);
        let same = |rigid: &Rigid| {
            bytemuck::cast_slice::<_, u32>(&rigid.anchors_host) == bytemuck::cast_slice::<_, u32>(&anchors)
                && rigid.shapes_host.iter().zip(body::members(&anchors, count)).all(|(shape, members)| made(shape, &members))
        };
        if count == 0 {
            self.rigid = None;
        } else if !self.rigid.as_ref().is_some_and(same) {
            let mut members = vec![0usize; count];
            for (state, anchor) in states.iter().zip(&anchors) {
                match members.get_mut(anchor[3].to_bits() as usize) {
                    Some(members) if state.is_of_body() => *members += 1,
                    None if !state.is_of_body() => {}
                    _ => return Err(SolverError::Checkpoint { what: "a body without its particles".to_owned() }),
                }
            }
            if members.contains(&0) {
                return Err(SolverError::Checkpoint { what: "a body of nothing".to_owned() });
            }
            let all = build(anchors, count, states, &self.laws.substances, self.settings.cell_m);
            self.rigid = Some(Rigid::new(&self.gpu, &all)?);
        }
        Ok(())
    }
}
