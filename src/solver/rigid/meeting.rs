//! Bodies and soft matter: momentum through the grid.
//!
//! A body has no mass on the grid. Nodes that it meets are first weighed as if they moved with it, which
//! gives the velocity that both will have; then each node responds to that velocity, as to a moving
//! collider or, where its own object's soft parts hang on the body, by moving with it. What they give so is not quite what
//! takes the body there; the difference moves both. The body gets the opposite of what the fixed point of the grid took. So
//! momentum is kept but for the rounding of sums, and a body may be as light beside a liquid as it likes.

use super::body::Assembly;
use crate::gpu::{Gpu, Recording};
use crate::solver::advance::Substep;
use crate::solver::core::Solver;
use crate::solver::grid::GridBuffers;
use crate::solver::passes::SUBSTEP;
use crate::solver::types::SolverError;

passes! {
    /// The passes of rigid bodies among soft matter.
    MeetingPasses;
    rigid_share: ["rigid", "rigid_meeting", "rigid_share"] [Read, Read, Read, Read, Read, Write] 0;
    rigid_mark: ["substance", "particle", "on_grid", "rigid", "rigid_field", "rigid_meeting", "rigid_mark"] [Read, Read, Read, Read, Read, Read, Write, Read] 0;
    rigid_touch: ["control", "substep", "rigid", "rigid_field", "node", "rigid_meeting", "rigid_touch"] [Read, Read, Read, Read, Read, Read, Write, Write, Write] SUBSTEP;
    rigid_predict: ["rigid", "rigid_meeting", "rigid_predict"] [Read, Read, Read, Read, Read, Write] 0;
    rigid_meet: ["rigid", "rigid_joint", "rigid_meet"] [Read, Read, Read, Read, Write] 0;
    rigid_couple: ["rigid", "node", "rigid_meeting", "rigid_couple"] [Read, Read, Read, Read, Read, Write] 0;
    rigid_even: ["rigid", "rigid_joint", "rigid_even"] [Read, Read, Read, Read, Read, Write] 0;
    rigid_take: ["control", "substep", "rigid", "node", "rigid_meeting", "rigid_take"] [Read, Read, Read, Read, Write, Write, Write] SUBSTEP;
    rigid_gather: ["rigid", "rigid_meeting", "rigid_gather"] [Read, Read, Read, Read, Read, Write] 0;
}

/// What bodies among soft matter need beside themselves.
#[derive(Clone, Debug)]
pub(in crate::solver) struct Meeting {
    passes: MeetingPasses,
    members: wgpu::Buffer,
    owners: wgpu::Buffer,
    burdens: wgpu::Buffer,
    pub(super) predicted: wgpu::Buffer,
    evened: wgpu::Buffer,
    chunks: u32,
}

/// The bind groups of its passes.
pub(in crate::solver) struct MeetingBound {
    active_groups: wgpu::Buffer,
    share: wgpu::BindGroup,
    mark: wgpu::BindGroup,
    touch: wgpu::BindGroup,
    predict: wgpu::BindGroup,
    meet: wgpu::BindGroup,
    couple: wgpu::BindGroup,
    even: wgpu::BindGroup,
    take: wgpu::BindGroup,
    gather: wgpu::BindGroup,
}

/// The buffers of the bodies themselves.
pub(super) struct Of<'a> {
    pub bodies: &'a wgpu::Buffer,
    pub shapes: &'a wgpu::Buffer,
    pub field: &'a wgpu::Buffer,
    pub given: &'a wgpu::Buffer,
}

impl Meeting {
    pub fn new(gpu: &Gpu, all: &Assembly) -> Result<Meeting, SolverError> {
        Ok(Meeting {
            passes: MeetingPasses::new(gpu),
            members: gpu.storage_from("solver.rigid.members", &all.members)?,
            owners: gpu.storage_from("solver.rigid.owners", &all.owners)?,
            burdens: gpu.storage::<[[f32; 4]; 4]>("solver.rigid.burdens", all.owners.len())?,
            predicted: gpu.storage::<[[f32; 4]; 2]>("solver.rigid.predicted", all.bodies.len())?,
            evened: gpu.storage::<[[f32; 4]; 2]>("solver.rigid.evened", all.bodies.len())?,
            chunks: all.owners.len() as u32,
        })
    }

    /// Everything bound; none before there is a grid that knows of bodies.
    pub fn bind(&self, solver: &Solver, grid: &GridBuffers, current: usize, of: &Of) -> Option<MeetingBound> {
        let (gpu, p, params, state) = (&solver.gpu, &self.passes, &solver.params_buffer, &solver.buffers[current]);
        let (nears, meetings) = grid.meeting.as_ref().map(|m| (&m.nears, &m.meetings))?;
        let (active, control, members, owners) = (&grid.active_blocks, &solver.control, &self.members, &self.owners);
        Some(MeetingBound {
            active_groups: grid.active_groups.clone(),
            share: gpu.bind(&p.rigid_share, &[params, of.bodies, members, owners, &grid.sums, nears]),
            mark: gpu.bind(&p.rigid_mark, &[params, &state.kinematics, &state.matter, of.bodies, of.shapes, of.field, nears, &solver.laws.table]),
            touch: gpu.bind(&p.rigid_touch, &[params, active, of.bodies, of.shapes, of.field, &grid.sums, nears, meetings, control]),
            predict: gpu.bind(&p.rigid_predict, &[params, of.bodies, members, owners, meetings, &self.burdens]),
            meet: gpu.bind(&p.rigid_meet, &[params, of.bodies, of.shapes, &self.burdens, &self.predicted]),
            couple: gpu.bind(&p.rigid_couple, &[params, active, of.bodies, of.shapes, &self.predicted, meetings]),
            even: gpu.bind(&p.rigid_even, &[params, of.bodies, of.shapes, &self.burdens, &self.predicted, &self.evened]),
            take: gpu.bind(&p.rigid_take, &[params, active, of.bodies, &self.evened, &grid.sums, meetings, control]),
            gather: gpu.bind(&p.rigid_gather, &[params, of.bodies, members, owners, meetings, of.given]),
        })
    }

    /// Adds the exchange of one substep, between p2g and the grid.
    pub fn record(&self, b: &MeetingBound, substep: &Substep, particle_groups: [u32; 3], recording: &mut Recording) {
        let (p, chunks) = (&self.passes, [self.chunks, 1, 1]);
        recording.dispatch(&p.rigid_mark, &b.mark, particle_groups);
        recording.dispatch(&p.rigid_share, &b.share, chunks);
        recording.indirect_with(&p.rigid_touch, &b.touch, substep, &b.active_groups, 0);
        recording.dispatch(&p.rigid_predict, &b.predict, chunks);
        recording.dispatch(&p.rigid_meet, &b.meet, [1, 1, 1]);
        recording.indirect(&p.rigid_couple, &b.couple, &b.active_groups, 0);
        recording.dispatch(&p.rigid_predict, &b.predict, chunks);
        recording.dispatch(&p.rigid_even, &b.even, [1, 1, 1]);
        recording.indirect_with(&p.rigid_take, &b.take, substep, &b.active_groups, 0);
        recording.dispatch(&p.rigid_gather, &b.gather, chunks);
    }
}
