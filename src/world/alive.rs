//! A prepared scene alive: the one simulator, whether it runs as fast as it goes or against a clock.

use super::bodies::Matter;
use super::settings::settings;
use crate::gpu::{Gpu, Recording};
use crate::solver::{Advance, Placement, Solver, SolverError};
use crate::spec::{Event, Rest, Spec};
use crate::{Stop, solver};
use glam::{EulerRot, Quat, Vec3};

use super::Resolved;

/// A change at an instant: a push or a new velocity of one object.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedEvent {
    /// When.
    pub at_s: f64,
    /// Index of the object.
    pub object: u32,
    /// Added to the velocity.
    pub push_m_s: Option<Vec3>,
    /// Replaces the velocity, before the push.
    pub velocity_m_s: Option<Vec3>,
}

/// A scene in motion.
#[derive(Debug)]
pub struct World {
    gpu: Gpu,
    solver: Solver,
    events: Vec<TimedEvent>,
    fps: u32,
    frame: u32,
}

/// What one frame took.
#[derive(Clone, Debug)]
pub struct Step {
    /// The frame that was reached; the one before where the run was stopped.
    pub frame: u32,
    /// What the solver did on the way.
    pub advance: Vec<Advance>,
    /// Whether it was stopped on the way.
    pub stopped: bool,
}

impl World {
    /// A world in the captured pose, stress-free, not yet placed.
    pub fn new(gpu: &Gpu, spec: &Spec, matter: &Matter, resolved: &Resolved) -> Result<World, SolverError> {
        let solver = Solver::new(gpu, settings(spec, matter, resolved), &matter.particles)?;
        let index_of = |name: &str| spec.objects.iter().position(|o| o.name == name);
        let mut events: Vec<TimedEvent> = spec.events.iter().filter_map(|e| timed(e, index_of(&e.object)? as u32)).collect();
        events.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        Ok(World { gpu: gpu.clone(), solver, events, fps: spec.time.fps, frame: 0 })
    }

    /// Solves the prestress of every object that stands as captured.
    pub fn prestress(&mut self, spec: &Spec, stop: &Stop, progress: &mut dyn FnMut(f32)) -> Result<solver::PrestressReport, SolverError> {
        let standing: Vec<u32> = (0..spec.objects.len() as u32).filter(|&i| spec.objects[i as usize].rest == Rest::AsCaptured).collect();
        self.solver.prestress(&standing, stop, progress)
    }

    /// Moves every object to where the spec starts it, with its velocity and spin.
    pub fn place(&mut self, spec: &Spec, matter: &Matter) -> Result<(), SolverError> {
        for (index, object) in spec.objects.iter().enumerate() {
            let [x, y, z] = object.rotate_deg.map(|degrees| degrees.to_radians() as f32);
            let placement = Placement {
                // About fixed x, then y, then z.
                rotation: Quat::from_euler(EulerRot::ZYX, z, y, x),
                centre_m: matter.centre_m[index],
                offset_m: vec3(object.offset_m),
                velocity_m_s: vec3(object.velocity_m_s),
                spin_rad_s: vec3(object.spin_rad_s),
            };
            self.solver.place(index as u32, &placement)?;
        }
        Ok(())
    }

    /// The frame that the world is at.
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// Goes on to the next frame: cut at each event on the way, which takes effect at that boundary.
    pub fn step_frame(&mut self, stop: &Stop) -> Result<Step, SolverError> {
        let (from_s, to_s) = (self.time_s(self.frame), self.time_s(self.frame + 1));
        let due: Vec<TimedEvent> = self.events.iter().filter(|e| e.at_s >= from_s && e.at_s < to_s).cloned().collect();
        let mut advance = Vec::new();
        for event in due {
            if event.at_s > from_s && !self.advance(event.at_s, stop, &mut advance)? {
                return Ok(Step { frame: self.frame, advance, stopped: true });
            }
            self.apply(&event);
        }
        if !self.advance(to_s, stop, &mut advance)? {
            return Ok(Step { frame: self.frame, advance, stopped: true });
        }
        self.frame += 1;
        Ok(Step { frame: self.frame, advance, stopped: false })
    }

    /// Whether the time was reached.
    fn advance(&mut self, to_s: f64, stop: &Stop, done: &mut Vec<Advance>) -> Result<bool, SolverError> {
        let advance = self.solver.advance(to_s, stop)?;
        let reached = !advance.stopped;
        done.push(advance);
        Ok(reached)
    }

    /// Applies an event now.
    pub fn apply(&mut self, event: &TimedEvent) {
        if let Some(velocity) = event.velocity_m_s {
            self.solver.set_velocity(event.object, velocity);
        }
        if let Some(push) = event.push_m_s {
            self.solver.kick(event.object, push);
        }
    }

    /// Writes the frame's motion and velocities, which [`World::motion`] and [`World::velocity`] then hold.
    pub fn show(&mut self) {
        let mut recording = Recording::default();
        self.solver.record_frame(&mut recording);
        self.gpu.submit(&recording);
    }

    /// Eight words a particle: position and deformation since the captured pose, see [`Solver::motion`].
    pub fn motion(&self) -> &wgpu::Buffer {
        self.solver.motion()
    }

    /// Velocity and det G of each particle.
    pub fn velocity(&self) -> &wgpu::Buffer {
        self.solver.velocity()
    }

    /// The whole state, from which the same bits go on.
    pub fn checkpoint(&self) -> Result<Vec<u8>, SolverError> {
        self.solver.checkpoint()
    }

    /// Goes back to a state at a frame.
    pub fn restore(&mut self, frame: u32, bytes: &[u8]) -> Result<(), SolverError> {
        self.solver.restore(bytes)?;
        self.frame = frame;
        Ok(())
    }

    fn time_s(&self, frame: u32) -> f64 {
        f64::from(frame) / f64::from(self.fps)
    }
}

fn timed(event: &Event, object: u32) -> Option<TimedEvent> {
    Some(TimedEvent { at_s: event.at_s?, object, push_m_s: event.push_m_s.map(vec3), velocity_m_s: event.velocity_m_s.map(vec3) })
}

fn vec3(value: [f64; 3]) -> Vec3 {
    Vec3::from(value.map(|v| v as f32))
}
