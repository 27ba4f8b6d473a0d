//! A prepared scene alive: the one simulator, whether it runs as fast as it goes or against a clock.

use super::bodies::Matter;
use super::settings::settings;
use super::stuff::Stuff;
use crate::gpu::{Gpu, Recording};
use crate::solver::{Advance, Checkpoint, Moduli, Placement, Solver, SolverError};
use crate::spec::{Event, Rest, Spec};
use crate::{Stop, solver};
use glam::{EulerRot, Quat, Vec3};

use super::Resolved;

/// A change of one object at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedEvent {
    /// When.
    pub at_s: f64,
    /// Index of the object.
    pub object: u32,
    /// Its piece, where only one changes: 0 is the object's own material, 1 its first part's.
    pub piece: Option<u16>,
    /// What happens.
    pub effect: Effect,
}

/// What an event does.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Adds to the velocity.
    Push(Vec3),
    /// Replaces the velocity.
    Velocity(Vec3),
    /// Makes it of other stuff; mass, place and speed stay.
    Become(Stuff),
    /// Multiplies moduli, yield stress and cohesion.
    Weaken(f64),
}

/// A scene in motion.
#[derive(Debug)]
pub struct World {
    gpu: Gpu,
    solver: Solver,
    events: Vec<TimedEvent>,
    /// Piece of its object that each particle belongs to, and the particles of each object.
    piece: Vec<u16>,
    ranges: Vec<std::ops::Range<usize>>,
    /// What each piece of each object is now, and was at the start.
    stuffs: Vec<Vec<Stuff>>,
    first_stuffs: Vec<Vec<Stuff>>,
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
        let numbered = spec.events.iter().zip(&matter.changes);
        let mut events: Vec<TimedEvent> = numbered.filter_map(|(e, change)| timed(e, change.as_ref(), index_of(&e.object)?, spec)).collect();
        events.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        let (piece, ranges) = (matter.piece.clone(), matter.bodies.ranges.clone());
        let stuffs = matter.stuffs.clone();
        Ok(World { gpu: gpu.clone(), solver, events, piece, ranges, first_stuffs: stuffs.clone(), stuffs, fps: spec.time.fps, frame: 0 })
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
            self.apply(&event)?;
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
    pub fn apply(&mut self, event: &TimedEvent) -> Result<(), SolverError> {
        match &event.effect {
            Effect::Push(push) => self.solver.kick(event.object, *push),
            Effect::Velocity(velocity) => self.solver.set_velocity(event.object, *velocity),
            Effect::Become(stuff) => {
                let only = event.piece.map(|piece| self.particles_of(event.object, piece));
                self.solver.change_material(event.object, only.as_deref(), Some(&stuff.substance), stuff.moduli())?;
            }
            Effect::Weaken(share) => {
                for piece in pieces(event, &self.stuffs) {
                    let only = self.particles_of(event.object, piece);
                    let weaker = self.stuffs[event.object as usize][usize::from(piece)].weakened(*share);
                    self.solver.change_material(event.object, Some(&only), Some(&weaker.substance), Moduli::Scaled(*share as f32))?;
                }
            }
        }
        note(event, &mut self.stuffs);
        Ok(())
    }

    /// Indices of the particles of one piece of an object.
    fn particles_of(&self, object: u32, piece: u16) -> Vec<u32> {
        self.ranges[object as usize].clone().filter(|&i| self.piece[i] == piece).map(|i| i as u32).collect()
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

    /// As [`World::checkpoint`], without waiting for it.
    pub fn start_checkpoint(&self) -> Result<Checkpoint, SolverError> {
        self.solver.start_checkpoint()
    }

    /// Goes back to a state at a frame.
    pub fn restore(&mut self, frame: u32, bytes: &[u8]) -> Result<(), SolverError> {
        self.solver.restore(bytes)?;
        self.frame = frame;
        self.stuffs = self.first_stuffs.clone();
        // What happens at the frame itself is still to come.
        let until_s = self.time_s(frame);
        self.events.iter().filter(|event| event.at_s < until_s).for_each(|event| note(event, &mut self.stuffs));
        Ok(())
    }

    fn time_s(&self, frame: u32) -> f64 {
        f64::from(frame) / f64::from(self.fps)
    }
}

/// What an event does in a world; none for what a pin does or what does not have a time.
fn timed(event: &Event, change: Option<&Stuff>, object: usize, spec: &Spec) -> Option<TimedEvent> {
    let effect = match event {
        Event { push_m_s: Some(push), .. } => Effect::Push(vec3(*push)),
        Event { velocity_m_s: Some(velocity), .. } => Effect::Velocity(vec3(*velocity)),
        Event { weaken: Some(share), .. } => Effect::Weaken(*share),
        _ => Effect::Become(change?.clone()),
    };
    let part = event.part.as_ref().and_then(|name| spec.objects[object].parts.iter().position(|part| part.name == *name));
    Some(TimedEvent { at_s: event.at_s?, object: object as u32, piece: part.map(|index| index as u16 + 1), effect })
}

/// The pieces that an event is about.
fn pieces(event: &TimedEvent, stuffs: &[Vec<Stuff>]) -> Vec<u16> {
    event.piece.map_or_else(|| (0..stuffs[event.object as usize].len() as u16).collect(), |piece| vec![piece])
}

/// Keeps in mind what an event makes of its pieces.
fn note(event: &TimedEvent, stuffs: &mut [Vec<Stuff>]) {
    for piece in pieces(event, stuffs) {
        let stuff = &mut stuffs[event.object as usize][usize::from(piece)];
        match &event.effect {
            Effect::Become(next) => *stuff = next.clone(),
            Effect::Weaken(share) => *stuff = stuff.weakened(*share),
            Effect::Push(_) | Effect::Velocity(_) => {}
        }
    }
}

fn vec3(value: [f64; 3]) -> Vec3 {
    Vec3::from(value.map(|v| v as f32))
}
