//! Rigid bodies: whole objects, and rigid parts of soft ones.
//!
//! Six degrees of freedom a body, moved on the device in every substep. A body's particles lie among all
//! others and are put where the body is; contact with colliders and with other bodies is the bodies' own
//! affair, exact where a grid would be a cell wide.

mod body;
mod field;
mod meeting;
mod remake;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;

use super::advance::Substep;
use super::constants::{RIGID_LANES, RIGID_POINTS, RIGID_STEP_S, RIGID_STEP_SHARE, WORKGROUP};
use super::core::{Kick, Solver, check_count};
use super::grid::GridBuffers;
use super::kept::Kept;
use super::passes::SUBSTEP;
use super::types::{Placement, SolverError};
use crate::gpu::{Gpu, Recording};
use body::{Assembly, Body, Contact, Manifold, Shape};
use glam::{Quat, Vec3};
use meeting::{Meeting, MeetingBound, Of};

const KICK: u32 = size_of::<Kick>() as u32;

/// Every pass of the room.
pub(super) fn all_kernels() -> Vec<crate::gpu::KernelSource> {
    [kernels(), meeting::kernels()].concat()
}

passes! {
    /// The passes of rigid bodies.
    RigidPasses;
    rigid_hold: ["control", "substep", "contact", "pin", "rigid", "rigid_hold"] [Read, Read, Write, Read, Read, Write] SUBSTEP;
    rigid_contacts: ["control", "substep", "contact", "rigid", "rigid_field", "rigid_contacts"] [Read, Read, Read, Read, Read, Read, Write, Write, Write, Write] SUBSTEP;
    rigid_driven: ["particle", "rigid", "rigid_driven"] [Read, Read, Read, Read, Read, Read, Write] 0;
    rigid_solve: ["substep", "rigid", "rigid_solve"] [Read, Write, Read, Write, Write, Read, Read, Write] SUBSTEP;
    rigid_place: ["control", "substep", "particle", "particle_write", "rigid", "rigid_place"] [Read, Write, Write, Read, Read, Read, Write] SUBSTEP;
    rigid_kick: ["rigid", "kick_of", "rigid_kick"] [Read, Write, Read] KICK;
}

pub(super) use body::{assemble, build};

/// The rigid bodies of a solver.
#[derive(Clone, Debug)]
pub(super) struct Rigid {
    passes: RigidPasses,
    shapes_host: Vec<Shape>,
    least_m: f32,
    bodies: Kept,
    manifolds: Kept,
    contacts: Kept,
    shapes: wgpu::Buffer,
    points: wgpu::Buffer,
    field: wgpu::Buffer,
    /// See [`Assembly::anchors`].
    pub anchors_host: Vec<[f32; 4]>,
    anchors: wgpu::Buffer,
    scratch: wgpu::Buffer,
    given: wgpu::Buffer,
    driven: wgpu::Buffer,
    /// Where there is soft matter too.
    meeting: Option<Meeting>,
}

/// A body at one instant, world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    pub mass_kg: f32,
    /// Of mass.
    pub centre_m: Vec3,
    /// Since the captured pose.
    pub turn: Quat,
    pub velocity_m_s: Vec3,
    pub spin_rad_s: Vec3,
    /// About the centre.
    pub angular_momentum: Vec3,
}

impl Motion {
    fn of(body: &Body, shape: &Shape) -> Motion {
        let (turn, angular_momentum) = (Quat::from_array(body.turn), Vec3::from_slice(&body.angular_momentum));
        Motion {
            mass_kg: shape.mass_kg(),
            centre_m: Vec3::from_slice(&body.centre_m),
            turn,
            velocity_m_s: Vec3::from_slice(&body.velocity_m_s),
            spin_rad_s: turn * (shape.inverse() * (turn.inverse() * angular_momentum)),
            angular_momentum,
        }
    }
}

/// The bind groups of the passes over one of the two state buffers.
pub(super) struct RigidBound {
    hold: wgpu::BindGroup,
    contacts: wgpu::BindGroup,
    /// Where fields, or liquids beside the grid, drive particles.
    driven: Option<wgpu::BindGroup>,
    solve: wgpu::BindGroup,
    place: wgpu::BindGroup,
    meeting: Option<MeetingBound>,
}

impl Rigid {
    /// Uploads the bodies of an assembly.
    pub fn new(gpu: &Gpu, all: &Assembly) -> Result<Rigid, SolverError> {
        check_count(all.members.len() as u64, RIGID_LANES)?;
        let slots = body::slots(all.bodies.len());
        Ok(Rigid {
            passes: RigidPasses::new(gpu),
            shapes_host: all.shapes.clone(),
            anchors_host: all.anchors.clone(),
            least_m: all.least_m,
            bodies: Kept::new(gpu, "solver.rigid.bodies", &all.bodies)?,
            manifolds: Kept::new(gpu, "solver.rigid.manifolds", &vec![Manifold::default(); slots])?,
            contacts: Kept::new(gpu, "solver.rigid.contacts", &vec![Contact::default(); 4 * slots])?,
            shapes: gpu.storage_from("solver.rigid.shapes", &all.shapes)?,
            points: gpu.storage_from("solver.rigid.points", &all.points)?,
            field: gpu.storage_from("solver.rigid.field", &all.coefficients)?,
            anchors: gpu.storage_from("solver.rigid.anchors", &all.anchors)?,
            scratch: gpu.storage::<[[f32; 4]; 2]>("solver.rigid.scratch", all.points.len().max(RIGID_POINTS as usize))?,
            given: gpu.storage::<[[f32; 4]; 2]>("solver.rigid.given", all.owners.len().max(1))?,
            driven: gpu.storage::<[u32; 12]>("solver.rigid.driven", all.bodies.len())?,
            meeting: if all.owners.is_empty() { None } else { Some(Meeting::new(gpu, all)?) },
        })
    }

    /// What a rollback and a checkpoint keep.
    pub fn kept(&self) -> [&Kept; 3] {
        [&self.bodies, &self.manifolds, &self.contacts]
    }

    /// Particles of each body, by their index.
    pub fn members(&self) -> Vec<Vec<usize>> {
        body::members(&self.anchors_host, self.count())
    }

    /// How many bodies there are.
    pub fn count(&self) -> usize {
        self.shapes_host.len()
    }

    /// The longest substep, whatever the speeds: contacts are found once in each.
    pub fn longest_step_s(&self, acceleration_m_s2: f32) -> f64 {
        let fall_s = (2.0 * f64::from(self.least_m) / f64::from(acceleration_m_s2).max(1e-9)).sqrt();
        RIGID_STEP_S.min(RIGID_STEP_SHARE * fall_s)
    }

    /// Everything bound, for particles that lie in one of the two state buffers.
    pub fn bind(&self, solver: &Solver, grid: &GridBuffers, current: usize) -> RigidBound {
        let (gpu, p, params, state) = (&solver.gpu, &self.passes, &solver.params_buffer, &solver.buffers[current]);
        let (bodies, shapes) = (&self.bodies.live, &self.shapes);
        let (manifolds, contacts) = (&self.manifolds.live, &self.contacts.live);
        let driven = [params, &state.kinematics, &state.matter, bodies, shapes, &self.anchors, &self.driven];
        let of = Of { bodies, shapes, field: &self.field, given: &self.given };
        RigidBound {
            meeting: self.meeting.as_ref().and_then(|m| m.bind(solver, grid, current, &of)),
            driven: (solver.fields.is_some() || solver.sph.is_some()).then(|| gpu.bind(&p.rigid_driven, &driven)),
            hold: gpu.bind(&p.rigid_hold, &[params, &solver.pins_buffer, bodies, shapes, &self.points, &solver.control]),
            contacts: gpu.bind(
                &p.rigid_contacts,
                &[params, &solver.colliders_buffer, bodies, shapes, &self.points, &self.field, manifolds, contacts, &self.scratch, &solver.control],
            ),
            solve: gpu.bind(&p.rigid_solve, &[params, bodies, shapes, manifolds, contacts, &solver.objects_buffer, &self.given, &self.driven]),
            place: gpu.bind(&p.rigid_place, &[params, &state.kinematics, &state.matter, bodies, shapes, &self.anchors, &solver.control]),
        }
    }

    /// Adds what a segment begins with: which bodies the pins in force hold.
    pub fn record_start(&self, b: &RigidBound, substep: &Substep, recording: &mut Recording) {
        recording.dispatch_with(&self.passes.rigid_hold, &b.hold, substep, self.body_groups());
    }

    /// Adds the exchange with soft matter, between p2g and the grid.
    pub fn record_meeting(&self, b: &RigidBound, substep: &Substep, particle_groups: [u32; 3], recording: &mut Recording) {
        self.meeting.iter().zip(&b.meeting).for_each(|(m, b)| m.record(b, substep, particle_groups, recording));
    }

    /// Adds one substep of all bodies, and of the particles that they carry.
    pub fn record_substep(&self, b: &RigidBound, substep: &Substep, particles: u32, recording: &mut Recording) {
        let particle_groups = [particles.div_ceil(WORKGROUP), 1, 1];
        if let Some(driven) = &b.driven {
            recording.dispatch(&self.passes.rigid_driven, driven, particle_groups);
        }
        recording.dispatch_with(&self.passes.rigid_contacts, &b.contacts, substep, self.body_groups());
        recording.dispatch_with(&self.passes.rigid_solve, &b.solve, substep, [1, 1, 1]);
        recording.dispatch_with(&self.passes.rigid_place, &b.place, substep, particle_groups);
    }

    /// Adds a change of velocity of one object's bodies.
    pub fn record_kick(&self, solver: &Solver, kick: &Kick, recording: &mut Recording) {
        let bindings = solver.gpu.bind(&self.passes.rigid_kick, &[&solver.params_buffer, &self.bodies.live, &self.shapes]);
        recording.dispatch_with(&self.passes.rigid_kick, &bindings, kick, [1, 1, 1]);
    }

    /// Moves one object's bodies to where it starts.
    pub fn place(&self, gpu: &Gpu, object: u32, placement: &Placement) -> Result<(), SolverError> {
        let mut bodies = self.bodies(gpu)?;
        for (body, shape) in bodies.iter_mut().zip(&self.shapes_host).filter(|(_, s)| s.object == object) {
            *body = placed(body, shape, placement);
        }
        gpu.upload(&self.bodies.live, &bodies);
        Ok(())
    }

    /// Where the bodies are and how they move.
    pub fn motions(&self, gpu: &Gpu) -> Result<Vec<Motion>, SolverError> {
        Ok(self.bodies(gpu)?.iter().zip(&self.shapes_host).map(|(b, s)| Motion::of(b, s)).collect())
    }

    /// The bodies as they are.
    pub fn bodies(&self, gpu: &Gpu) -> Result<Vec<Body>, SolverError> {
        Ok(gpu.read(&self.bodies.live, self.shapes_host.len())?)
    }

    fn body_groups(&self) -> [u32; 3] {
        [self.shapes_host.len() as u32, 1, 1]
    }
}

/// A body of an object that is moved rigidly, with its velocity and spin.
fn placed(body: &Body, shape: &Shape, placement: &Placement) -> Body {
    let turn = placement.rotation.normalize();
    let pivot = placement.centre_m + placement.offset_m;
    let still = turn.is_near_identity() && placement.offset_m == Vec3::ZERO;
    let old = Quat::from_array(body.turn);
    let (centre, orientation) = match still {
        true => (Vec3::from_slice(&body.centre_m), old),
        false => (turn * (Vec3::from_slice(&body.centre_m) - placement.centre_m) + pivot, (turn * old).normalize()),
    };
    let velocity = placement.velocity_m_s + placement.spin_rad_s.cross(centre - pivot);
    let momentum = orientation * (shape.inertia() * (orientation.inverse() * placement.spin_rad_s));
    let mut moved = Body {
        turn: orientation.into(),
        velocity_m_s: velocity.extend(body.velocity_m_s[3]).into(),
        angular_momentum: momentum.extend(0.0).into(),
        ..*body
    };
    moved.put(centre);
    moved
}
