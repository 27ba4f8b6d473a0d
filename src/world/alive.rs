//! A prepared scene alive: the one simulator, whether it runs as fast as it goes or against a clock.

use super::bodies::Matter;
use super::event::{Course, Effect, Piece, TimedEvent, vec3};
use super::impact::{self, State, Waiting};
use super::settings::settings;
use crate::Stop;
use crate::gpu::{Gpu, Recording};
use crate::solver::{self, Advance, Moduli, Placement, Solver, SolverError};
use crate::spec::{Rest, Spec};
use glam::{EulerRot, Quat};

use super::Resolved;

/// A scene in motion.
#[derive(Debug)]
pub struct World {
    gpu: Gpu,
    solver: Solver,
    /// In the order of their times, and how many of them have happened.
    events: Vec<TimedEvent>,
    happened: usize,
    /// Events that wait for an impact, in the spec's order.
    waiting: Vec<Waiting>,
    /// Piece of its object that each particle belongs to, and the particles of each object.
    piece: Vec<u16>,
    ranges: Vec<std::ops::Range<usize>>,
    /// Object of each pin.
    pinned: Vec<String>,
    names: Vec<String>,
    /// What everything is now, and was at the start.
    course: Course,
    start: Course,
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
    /// Events that waited for an impact, by their number among those, and when it came.
    pub fired: Vec<(usize, f64)>,
    /// Whether it was stopped on the way.
    pub stopped: bool,
}

/// A state on its way back from the device; [`Checkpoint::bytes`] can wait for it on another thread.
#[derive(Debug)]
pub struct Checkpoint {
    solver: solver::Checkpoint,
    /// How far what waits has come, JSON.
    waiting: Vec<u8>,
}

impl Checkpoint {
    /// The solver's state, what waits, the length of that.
    pub fn bytes(self) -> Result<Vec<u8>, SolverError> {
        let mut bytes = self.solver.bytes()?;
        bytes.extend_from_slice(&self.waiting);
        bytes.extend_from_slice(&(self.waiting.len() as u64).to_le_bytes());
        Ok(bytes)
    }
}

impl World {
    /// A world in the captured pose, stress-free, not yet placed.
    pub fn new(gpu: &Gpu, spec: &Spec, matter: &Matter, resolved: &Resolved) -> Result<World, SolverError> {
        let solver = Solver::new(gpu, settings(spec, matter, resolved), &matter.particles)?;
        let all = spec.events.iter().zip(&matter.changes).filter_map(|(e, change)| TimedEvent::of(e, change.as_ref(), spec));
        let (mut events, waiting): (Vec<_>, Vec<_>) = all.partition(|e| e.at_s.is_finite());
        events.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        let course = Course::new(&matter.stuffs, &matter.frozen);
        Ok(World {
            gpu: gpu.clone(),
            solver,
            events,
            happened: 0,
            waiting: waiting.into_iter().map(Waiting::new).collect(),
            piece: matter.piece.clone(),
            ranges: matter.bodies.ranges.clone(),
            pinned: spec.pins.iter().map(|pin| pin.object.clone()).collect(),
            names: spec.objects.iter().map(|object| object.name.clone()).collect(),
            start: course.clone(),
            course,
            fps: spec.time.fps,
            frame: 0,
        })
    }

    /// Solves the prestress of every object that stands as captured. What the user should know of it.
    pub fn prestress(&mut self, spec: &Spec, stop: &Stop, progress: &mut dyn FnMut(f32)) -> Result<Vec<String>, SolverError> {
        let standing: Vec<u32> = (0..spec.objects.len() as u32).filter(|&i| spec.objects[i as usize].rest == Rest::AsCaptured).collect();
        let report = self.solver.prestress(&standing, stop, progress)?;
        let hangs = |&(object, gap_m): &(u32, f32)| {
            let (name, gap_mm) = (&self.names[object as usize], gap_m * 1e3);
            format!("{name} hangs {gap_mm:.0} mm above whatever is below it, so nothing carries it as captured: its pose is taken as free of stress")
        };
        Ok(report.hanging.iter().map(hangs).chain(report.warnings).collect())
    }

    /// Whether every object starts in its captured pose, so that [`World::place`] moves nothing.
    pub fn starts_as_captured(spec: &Spec) -> bool {
        spec.objects.iter().all(|object| object.offset_m == [0.0; 3] && object.rotate_deg == [0.0; 3])
    }

    /// Moves every object to where the spec starts it, with its velocity and spin.
    /// What the user should know of it.
    pub fn place(&mut self, spec: &Spec, matter: &Matter) -> Result<Vec<String>, SolverError> {
        let mut warnings = Vec::new();
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
            let out = self.solver.place(index as u32, &placement)?;
            if out != glam::Vec3::ZERO {
                let [x, y, z] = out.to_array();
                warnings.push(format!("{}: was placed inside a collider and starts in front of it, [{x:.3}, {y:.3}, {z:.3}] m further", object.name));
            }
        }
        Ok(warnings)
    }

    /// The frame that the world is at.
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// Seconds since the start.
    pub fn now_s(&self) -> f64 {
        self.solver.time_s()
    }

    /// Goes on to the next frame: cut at each event on the way, which takes effect at that boundary.
    pub fn step_frame(&mut self, stop: &Stop) -> Result<Step, SolverError> {
        let to_s = self.time_s(self.frame + 1);
        let mut step = Step { frame: self.frame, advance: Vec::new(), fired: Vec::new(), stopped: false };
        while let Some(event) = self.events.get(self.happened).filter(|e| e.at_s < to_s).cloned() {
            if event.at_s > self.solver.time_s() && !self.go(event.at_s, stop, &mut step)? {
                return Ok(Step { stopped: true, ..step });
            }
            self.apply(&event)?;
            self.happened += 1;
        }
        if !self.go(to_s, stop, &mut step)? {
            return Ok(Step { stopped: true, ..step });
        }
        self.frame += 1;
        Ok(Step { frame: self.frame, ..step })
    }

    /// Goes on to a time, with the impacts on the way. Whether it was reached.
    fn go(&mut self, to_s: f64, stop: &Stop, done: &mut Step) -> Result<bool, SolverError> {
        loop {
            let next_s = self.look_out(to_s, done)?;
            let advance = self.solver.advance(next_s, stop)?;
            let reached = !advance.stopped;
            done.advance.push(advance);
            if !reached || next_s >= to_s {
                return Ok(reached);
            }
        }
    }

    /// Lets happen what waited for an impact that is there, and says until when none other is in sight.
    fn look_out(&mut self, to_s: f64, done: &mut Step) -> Result<f64, SolverError> {
        while self.waiting.iter().any(|w| w.state.fired_s.is_none()) {
            let sight = self.solver.sight()?;
            let now_s = self.solver.time_s();
            let open = |w: &&mut Waiting| w.state.fired_s.is_none();
            let met: Vec<TimedEvent> = self
                .waiting
                .iter_mut()
                .enumerate()
                .filter(|(_, w)| open(w))
                .filter_map(|(number, w)| {
                    w.meets(&sight).then(|| {
                        w.state.fired_s = Some(now_s);
                        done.fired.push((number, now_s));
                        TimedEvent { at_s: now_s, ..w.event.clone() }
                    })
                })
                .collect();
            if met.is_empty() {
                // The same moments whatever else cuts a frame.
                let look_s = 1.0 / f64::from(self.fps * impact::LOOKS);
                let first = (now_s / look_s + 1e-6).floor() as u64 + 1;
                let times_s: Vec<f64> = (first..).map(|k| k as f64 * look_s).take_while(|t| *t < to_s - 1e-9).collect();
                let after_s: Vec<f32> = times_s.iter().map(|t| (t - now_s) as f32).collect();
                let soonest = self.waiting.iter().filter(|w| w.state.fired_s.is_none()).filter_map(|w| w.soonest(&sight, &after_s)).min();
                return Ok(soonest.map_or(to_s, |k| times_s[k]));
            }
            for event in met {
                self.apply(&event)?;
            }
        }
        Ok(to_s)
    }

    /// Applies an event now.
    pub fn apply(&mut self, event: &TimedEvent) -> Result<(), SolverError> {
        match &event.effect {
            Effect::Push(push) => self.solver.kick(event.object, *push),
            Effect::Velocity(velocity) => self.solver.set_velocity(event.object, *velocity),
            Effect::Release => self.end_pins(event),
            Effect::Become(_) | Effect::Weaken(_) | Effect::Freeze => {}
        }
        for (number, before, after) in self.course.changes(event) {
            self.change(event, number, &before, &after)?;
        }
        self.course.note(event);
        Ok(())
    }

    /// Makes of one piece what an event makes of it.
    fn change(&mut self, event: &TimedEvent, number: u16, before: &Piece, after: &Piece) -> Result<(), SolverError> {
        let other = before.now != after.now;
        let substance = other.then_some(&after.now.substance);
        let only = || self.particles_of(event.object, number);
        match event.effect {
            Effect::Freeze if before.thawed.is_none() && !after.now.substance.is_rigid() => {
                let moduli = if other { after.now.moduli() } else { Moduli::Kept };
                self.solver.freeze(event.object, Some(&only()), substance, moduli)
            }
            Effect::Weaken(share) if other => self.solver.change_material(event.object, Some(&only()), substance, Moduli::Scaled(share as f32)),
            Effect::Become(_) => self.solver.change_material(event.object, Some(&only()), Some(&after.now.substance), after.now.moduli()),
            Effect::Release if other => self.solver.change_material(event.object, Some(&only()), substance, after.now.moduli()),
            _ => Ok(()),
        }
    }

    /// Ends the pins of an event's object.
    fn end_pins(&mut self, event: &TimedEvent) {
        let Some(name) = self.names.get(event.object as usize) else { return };
        let pins: Vec<usize> = (0..self.pinned.len()).filter(|&pin| self.pinned[pin] == *name).collect();
        self.solver.end_pins(&pins, event.at_s);
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
        self.start_checkpoint()?.bytes()
    }

    /// As [`World::checkpoint`], without waiting for it.
    pub fn start_checkpoint(&self) -> Result<Checkpoint, SolverError> {
        let states: Vec<&State> = self.waiting.iter().map(|w| &w.state).collect();
        let waiting = serde_json::to_vec(&states).map_err(|e| SolverError::Checkpoint { what: e.to_string() })?;
        Ok(Checkpoint { solver: self.solver.start_checkpoint()?, waiting })
    }

    /// Goes back to a state at a frame.
    pub fn restore(&mut self, frame: u32, bytes: &[u8]) -> Result<(), SolverError> {
        let refuse = |what: String| SolverError::Checkpoint { what };
        let short = || refuse(format!("{} bytes", bytes.len()));
        let (rest, length) = bytes.split_last_chunk::<8>().ok_or_else(short)?;
        let solver = rest.len().checked_sub(u64::from_le_bytes(*length) as usize).ok_or_else(short)?;
        let states: Vec<State> = serde_json::from_slice(&rest[solver..]).map_err(|e| refuse(e.to_string()))?;
        self.solver.restore(&rest[..solver])?;
        self.frame = frame;
        self.course = self.start.clone();
        // What happens at the frame itself is still to come. The state of the captured pose is that of any events.
        let until_s = self.time_s(frame);
        self.happened = self.events.partition_point(|event| event.at_s < until_s);
        let mut past = self.events[..self.happened].to_vec();
        if frame > 0 {
            if states.len() != self.waiting.len() {
                return Err(refuse(format!("{} events that wait, of {}", states.len(), self.waiting.len())));
            }
            self.waiting.iter_mut().zip(states).for_each(|(waiting, state)| waiting.state = state);
            past.extend(self.waiting.iter().filter_map(|w| Some(TimedEvent { at_s: w.state.fired_s?, ..w.event.clone() })));
            past.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        }
        for event in &past {
            self.course.note(event);
            if event.effect == Effect::Release {
                self.end_pins(event);
            }
        }
        Ok(())
    }

    fn time_s(&self, frame: u32) -> f64 {
        f64::from(frame) / f64::from(self.fps)
    }
}
