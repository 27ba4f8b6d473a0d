//! Going on in time: segments of whole substeps, watched, rolled back and run again.

use super::budget;
use super::constants::{LEAST_SPEED_M_S, PUSH_SHARE};
use super::core::Solver;
use super::encounter::Layers;
use super::fields::Fields;
use super::grid::GridBuffers;
use super::grip::Grip;
use super::obstacles;
use super::retry::{Tries, WayOn};
use super::types::{Advance, PinRegion, SolverError};
use super::watch::{Control, Watch};
use crate::Stop;
use crate::gpu::{Readback, Recording, Tier};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// `Substep` of `shaders/solver/substep.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Substep {
    pub dt_s: f32,
    pub dt_next_s: f32,
    pub index: u32,
    pub job: u32,
    pub since_s: f32,
    pub lag: u32,
}

/// How a segment is cut into substeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan {
    /// Length of all but perhaps the last.
    pub dt_s: f32,
    /// Length of the last: a cut inside a frame leaves a part.
    pub last_dt_s: f32,
    /// How many.
    pub substeps: u32,
    /// A sort before each so many.
    pub sort_every: u32,
    /// Liquids on the grid are poured anew before each so many: at every sort, and between.
    pub pour_every: u32,
    /// Rounds of implicit viscosity of the liquids beside the grid.
    pub viscous_rounds: u32,
}

impl Plan {
    /// Seconds from the segment's start to a boundary between substeps.
    pub fn time_s(&self, boundary: u32) -> f64 {
        let last_s = if boundary >= self.substeps { f64::from(self.last_dt_s) } else { f64::from(self.dt_s) };
        match boundary {
            0 => 0.0,
            _ => f64::from(self.dt_s) * f64::from(boundary - 1) + last_s,
        }
    }

    pub fn dt_of(&self, step: u32) -> f32 {
        match () {
            _ if step + 1 < self.substeps => self.dt_s,
            _ if step + 1 == self.substeps => self.last_dt_s,
            _ => 0.0,
        }
    }
}

/// Two times closer than this are one.
const SAME_TIME_S: f64 = 1e-9;
/// Bodies that fall fast through little may take substeps shorter than stiffness may: they cost little.
const BODY_SHARE: f64 = 0.125;
/// Cells that anything may travel in one segment.
const SEGMENT_CELLS: f64 = 32.0;
/// Sorting is amortised over at most so many substeps: runs of equal cells break up meanwhile.
const SORT_EVERY: u32 = 4;
/// Where workgroups go by block, who moves within it does not matter.
const SORT_BLOCKS_EVERY: u32 = 32;
/// What liquids find when they are poured grows old.
const POUR_EVERY: u32 = 4;
/// Particle-substeps of one submit: about 0.1 s on two CPU cores, so that a stop is heard.
const CPU_BATCH: u32 = 400_000;
/// Substeps of one submit at most: what is recorded takes memory, however few the particles are.
const CPU_BATCH_MOST: u32 = 1024;
/// Substeps of one submit on a GPU, the first of a segment and the longest: while little is recorded the device waits.
const GPU_BATCH: (u32, u32) = (4, 64);

/// Whether something from one time to another is in force at a third.
pub(super) fn spans(from_s: f64, to_s: f64, time_s: f64) -> bool {
    from_s <= time_s + SAME_TIME_S && time_s + SAME_TIME_S < to_s
}

enum Outcome {
    Done(Watch),
    Stopped,
}

impl Solver {
    /// Goes on exactly to `to_s`. The state is then at the end of the last substep before it; where it
    /// was stopped, or fails, at the last frame or cut before that.
    pub fn advance(&mut self, to_s: f64, stop: &Stop) -> Result<Advance, SolverError> {
        let mut report = Advance { dt_min_s: f64::INFINITY, softened: std::mem::take(&mut self.softened), ..Default::default() };
        while self.time_s < to_s - SAME_TIME_S && !report.stopped {
            self.segment(to_s, stop, &mut report)?;
        }
        if report.substeps == 0 {
            report.dt_min_s = 0.0;
        }
        Ok(report)
    }

    /// One segment: to the end of the frame, to a cut, or to `to_s`, whichever is first.
    fn segment(&mut self, to_s: f64, stop: &Stop, report: &mut Advance) -> Result<(), SolverError> {
        let frame_end_s = ((self.time_s / self.settings.frame_s + 1e-6).floor() + 1.0) * self.settings.frame_s;
        let mut until_s = self.next_cut(to_s.min(frame_end_s));
        if (until_s - frame_end_s).abs() < SAME_TIME_S {
            until_s = frame_end_s;
        }
        self.begin_pins()?;
        let mut seen = self.look()?;
        self.backup();
        let calm = (seen.driven_m_s, seen.drift_m_s);
        let mut tries = Tries::default();
        loop {
            if !tries.reason.is_empty() {
                self.count_retry(&tries)?;
            }
            let acceleration_m_s2 = self.set_surroundings();
            let pins_m_s = self.pin_speed_m_s();
            (seen.driven_m_s, seen.drift_m_s) = (seen.driven_m_s.max(pins_m_s), seen.drift_m_s.max(pins_m_s));
            let mut plan = self.plan(&seen, until_s, frame_end_s, acceleration_m_s2, self.wary.halvings);
            // Who moves farther than was thought is found again sooner.
            plan.sort_every = if tries.trips > 0 { 1 } else { plan.sort_every };
            if f64::from(plan.substeps) > budget::SUBSTEPS_MOST {
                return Err(SolverError::TooFast {
                    time_s: self.time_s,
                    speed_m_s: seen.speed_m_s.max(pins_m_s),
                    cell_m: self.settings.cell_m,
                    substeps: plan.substeps,
                });
            }
            // What is fast takes its frame in several segments, so that the grid need not hold all of its way. Where
            // they end goes by the whole frame: a cut changes nothing before itself.
            let speed_m_s = f64::from(seen.speed_m_s + seen.drift_m_s) + f64::from(acceleration_m_s2) * (frame_end_s - self.time_s);
            let speed_m_s = speed_m_s.min(self.speed_most_m_s(pins_m_s));
            let at_once = SEGMENT_CELLS * f64::from(self.settings.cell_m) / (speed_m_s * f64::from(plan.dt_s)).max(1e-12);
            if f64::from(plan.substeps) > at_once {
                plan = Plan { substeps: (at_once as u32).max(1), last_dt_s: plan.dt_s, ..plan };
                until_s = self.time_s + f64::from(plan.substeps) * f64::from(plan.dt_s);
            }
            self.params.momentum_floor = self.heaviest_kg * LEAST_SPEED_M_S.max(acceleration_m_s2 * plan.dt_s);
            self.ask_fields_at(until_s);
            let reach_m = (speed_m_s * (until_s - self.time_s)) as f32;
            let margin = ((reach_m / self.settings.cell_m).ceil() as i32 + self.params.slack + 3) * tries.room;
            let high = if self.soft { seen.high } else { seen.low };
            let fits = self.fit_window(seen.low, high, margin).and_then(|()| self.make_room(seen.blocks, seen.blocks / 8));
            if let Err(error) = fits {
                tries.reason = error.to_string();
                // What a failed try came to may ask for more room than there is; shorter substeps may never come to it.
                if tries.room > 1 {
                    (tries.room, tries.room_most) = (tries.room / 2, tries.room / 2);
                } else if tries.trips == 0 {
                    if !self.leave_behind(&error, margin, report)? {
                        return Err(error);
                    }
                    self.backup();
                    seen = self.look()?;
                } else if self.shorten(&error, &mut tries) {
                    (seen.driven_m_s, seen.drift_m_s) = calm;
                } else if self.give_way(0, &mut tries, report)? {
                    self.backup();
                    seen = self.look()?;
                } else {
                    self.count_given_up(&tries)?;
                    break;
                }
                continue;
            }
            tracing::debug!(time_s = self.time_s, until_s, dt_s = plan.dt_s, substeps = plan.substeps, speed_m_s, ?seen, wary = ?self.wary, "segment");
            let (start, order) = (self.substep, self.current);
            let outcome = self.run(&plan, stop, tries.trips > 0)?;
            let Outcome::Done(now) = outcome else {
                self.roll_back(start, order);
                report.stopped = true;
                return Ok(());
            };
            // Room is no matter of the time step either, while there is any.
            if now.blocks > self.grid.as_ref().map_or(0, |g| g.capacity) {
                self.roll_back(start, order);
                tries.reason = format!("{} blocks of the grid are needed", now.blocks);
                match self.make_room(now.blocks, 0) {
                    Err(error) if !self.shorten(&error, &mut tries) => {
                        if !self.give_way(now.suspects, &mut tries, report)? {
                            self.count_given_up(&tries)?;
                            break;
                        }
                        self.backup();
                        seen = self.look()?;
                    }
                    _ => {}
                }
                continue;
            }
            let travel_m = self.params.slack as f32 * self.settings.cell_m;
            let Some(reason) = now.trip(plan.dt_s, plan.sort_every, self.settings.cell_m, travel_m) else {
                self.seen = Some(now);
                self.wary.given_up = 0;
                self.report(&plan, &now, report);
                break;
            };
            if self.is_mendable(&now, &plan, travel_m, &tries) {
                tracing::debug!(time_s = self.time_s, dt_s = plan.dt_s, reason, ?now, "mended");
                self.wary.trouble();
                self.wary.given_up = 0;
                self.mend(!now.has_sound_volumes(), report)?;
                self.report(&plan, &now, report);
                break;
            }
            tracing::debug!(time_s = self.time_s, dt_s = plan.dt_s, reason, before = ?seen, ?now, "rolled back");
            self.roll_back(start, order);
            report.retries += 1;
            tries.reason.clone_from(&reason);
            // How wide the window happens to be is no part of the state: leaving it asks for room and teaches nothing, so
            // that a run from a checkpoint, which makes its own, goes on to the same bits.
            if now.window && now.nonfinite == 0 && tries.room < tries.room_most {
                tries.room *= 2;
                continue;
            }
            // Nor is how long lists of neighbours happen to be.
            if now.crowded && now.nonfinite == 0 && self.lengthen_lists()? {
                continue;
            }
            self.wary.trouble();
            tries.trips += 1;
            let now = now.sane(self.params.speed_most);
            let faster = now.peak_speed_m_s > 1.1 * speed_m_s as f32;
            // Nothing is faster than what is affordable to follow.
            (seen.driven_m_s, seen.drift_m_s) = (seen.driven_m_s.max(now.peak_speed_m_s), seen.drift_m_s.max(now.peak_speed_m_s));
            match self.way_on(&now, &plan, faster, &mut tries)? {
                WayOn::Wider => {}
                WayOn::Shorter => self.wary.halvings += 1,
                WayOn::Softer => {
                    self.soften(now.suspects, &reason)?;
                    report.softened.append(&mut self.softened);
                    self.backup();
                    seen = Watch { driven_m_s: seen.driven_m_s, drift_m_s: seen.drift_m_s, ..self.look()? };
                }
                WayOn::None => {
                    if !self.give_way(now.suspects, &mut tries, report)? {
                        self.count_given_up(&tries)?;
                        break;
                    }
                    self.backup();
                    seen = self.look()?;
                }
            }
        }
        self.time_s = until_s;
        if (until_s - frame_end_s).abs() < SAME_TIME_S {
            self.wary.frame_ends();
            self.set_wary(self.wary);
        }
        Ok(())
    }

    /// Adds a segment that held.
    fn report(&self, plan: &Plan, now: &Watch, report: &mut Advance) {
        self.report_fields(report);
        report.substeps += u64::from(plan.substeps);
        report.dt_min_s = report.dt_min_s.min(f64::from(plan.dt_s.min(plan.last_dt_s)));
        report.dt_max_s = report.dt_max_s.max(f64::from(plan.dt_s.max(plan.last_dt_s)));
        if now.peak_speed_m_s >= 0.999 * self.params.speed_most {
            report.held_m_s = self.params.speed_most;
        }
        report.unmet |= now.unmet;
    }

    /// The fastest that anything is followed, but for pins.
    fn speed_most_m_s(&self, pins_m_s: f32) -> f64 {
        f64::from(self.params.speed_most.max(pins_m_s))
    }

    /// The next time, up to `until_s`, at which a force or a pin begins or ends.
    fn next_cut(&self, until_s: f64) -> f64 {
        let forces = self.settings.forces.iter().flat_map(|f| [f.from_s, f.to_s]);
        let fields = self.settings.fields.iter().flat_map(|f| [f.from_s, f.to_s]);
        let pins = self.settings.pins.iter().flat_map(|p| p.times_s());
        forces.chain(fields).chain(pins).filter(|&t| t > self.time_s + SAME_TIME_S).fold(until_s, f64::min)
    }

    pub(super) fn in_force(&self, from_s: f64, to_s: f64) -> bool {
        spans(from_s, to_s, self.time_s)
    }

    /// Ends pins, by their place in the settings, that last longer.
    pub fn end_pins(&mut self, pins: &[usize], at_s: f64) {
        for &pin in pins {
            if let Some(pin) = self.settings.pins.get_mut(pin).filter(|p| p.from_s < at_s) {
                pin.to_s = pin.to_s.min(at_s);
            }
        }
    }

    /// The fastest that a pin moves in this segment.
    fn pin_speed_m_s(&self) -> f32 {
        let pins = self.settings.pins.iter().filter(|p| self.in_force(p.from_s, p.to_s));
        pins.map(|p| p.motion(self.time_s + SAME_TIME_S).1.length() as f32).fold(0.0, f32::max)
    }

    /// Uploads the forces and pins of the present time. The largest acceleration that anything feels
    /// beside contact and stress.
    pub(super) fn set_surroundings(&mut self) -> f32 {
        let mut accelerations = vec![Vec3::ZERO; self.object_count as usize];
        for force in self.settings.forces.iter().filter(|f| self.in_force(f.from_s, f.to_s)) {
            if let Some(sum) = accelerations.get_mut(force.object as usize) {
                *sum += force.acceleration_m_s2;
            }
        }
        self.set_pins(|layers, object| layers.layer_of(object));
        self.set_fields();
        self.gpu.upload(&self.objects_buffer, &accelerations.iter().map(|a| a.extend(0.0)).collect::<Vec<_>>());
        let driven = accelerations.iter().map(|a| a.length()).fold(0.0, f32::max);
        self.settings.gravity_m_s2.length() + driven
    }

    /// Uploads the pins of the present time, each for the layer of the grid that its object is on.
    pub(super) fn set_pins(&mut self, layer_of: impl Fn(&Layers, u32) -> u32) {
        let pins = self.settings.pins.iter().zip(&self.grips).filter(|(p, _)| self.in_force(p.from_s, p.to_s));
        let record =
            |(p, grip): (&PinRegion, &Grip)| obstacles::pin(p, &grip.pose, layer_of(&self.layers, p.object), self.settings.cell_m, self.time_s);
        let records: Vec<_> = pins.map(record).collect();
        self.params.pin_count = records.len() as u32;
        self.gpu.upload(&self.pins_buffer, &records);
    }

    /// Substeps from physics: dt <= cfl cell / (c + |v|), equal parts of the whole frame, of which a cut
    /// takes the first ones and a remainder.
    pub(super) fn plan(&self, seen: &Watch, until_s: f64, frame_end_s: f64, acceleration_m_s2: f32, halvings: u32) -> Plan {
        let cell_m = f64::from(self.settings.cell_m);
        let left_s = frame_end_s - self.time_s;
        let speed_m_s = f64::from(seen.speed_m_s + seen.driven_m_s) + f64::from(acceleration_m_s2) * left_s;
        let speed_m_s = speed_m_s.min(self.speed_most_m_s(self.pin_speed_m_s()));
        let shortest_s = budget::shortest_s(&self.settings);
        let courant_m = f64::from(self.settings.cfl) * cell_m;
        // Laws that stiffen as they go may ask for more than is carried; the watch sees what comes of it.
        let wave_m_s = f64::from(seen.wave_speed_m_s).min(courant_m / shortest_s);
        let halved = f64::from(1u32 << halvings);
        let limit_s = courant_m / (wave_m_s + speed_m_s) / halved;
        let limit_s = self.sph().map_or(limit_s, |sph| {
            limit_s.min(sph.limit_s(0.5 * cell_m, f64::from(self.settings.cfl), speed_m_s, f64::from(acceleration_m_s2), shortest_s) / halved)
        });
        let rigid_s = self.rigid.as_ref().map_or(f64::INFINITY, |r| r.longest_step_s(acceleration_m_s2).max(BODY_SHARE * shortest_s)) / halved;
        let dt_s = left_s / (left_s / limit_s.min(rigid_s)).ceil().max(1.0);
        let parts = (until_s - self.time_s) / dt_s;
        let whole = (parts + 1e-6).floor();
        let rest_s = (parts - whole) * dt_s;
        // However little is left, it is a substep.
        let cut = rest_s > 1e-6 * dt_s || whole < 1.0;
        // Half the slack by the present speed; the watch sees to the rest.
        let sorts = 0.5 * f64::from(self.params.slack) * cell_m / (speed_m_s * dt_s).max(1e-12);
        // Lists of neighbours are made from the cells of the sort.
        let sort_every = if self.sph().is_some() { 1 } else { (sorts as u32).clamp(1, (self.most_between_sorts() >> halvings).max(1)) };
        let pour_every = sort_every.min((POUR_EVERY >> halvings).max(1));
        Plan {
            dt_s: dt_s as f32,
            last_dt_s: if cut { rest_s as f32 } else { dt_s as f32 },
            substeps: whole as u32 + u32::from(cut),
            // What was poured lies where the sort put it.
            sort_every: if self.liquid.is_some() { sort_every / pour_every * pour_every } else { sort_every },
            pour_every,
            viscous_rounds: self.sph().map_or(0, |sph| sph.viscous_rounds(cell_m, dt_s)),
        }
    }

    fn most_between_sorts(&self) -> u32 {
        match self.gpu.tier {
            Tier::Gpu => SORT_BLOCKS_EVERY,
            Tier::Cpu => SORT_EVERY,
        }
    }

    /// Measures the present state, where that has not been done.
    pub(super) fn look(&mut self) -> Result<Watch, SolverError> {
        if let Some(seen) = self.seen {
            return Ok(seen);
        }
        self.gpu.upload(&self.params_buffer, &[self.params]);
        self.gpu.upload(&self.control, &[Control::FRESH]);
        self.ask_fields_at(self.time_s);
        let mut recording = Recording::default();
        self.record_measure(&mut recording);
        self.gpu.submit(&recording);
        let seen = self.read_watch()?;
        self.seen = Some(seen);
        Ok(seen)
    }

    fn record_measure(&self, recording: &mut Recording) {
        let state = &self.buffers[self.current];
        let bindings = self.gpu.bind(&self.passes.measure, &[&self.params_buffer, &state.kinematics, &state.matter, &self.control, &self.laws.table]);
        recording.dispatch(&self.passes.measure, &bindings, self.particle_groups());
        self.record_field_question(recording);
    }

    fn read_watch(&mut self) -> Result<Watch, SolverError> {
        let mut sources = vec![(&self.control, size_of::<Control>() as u64)];
        sources.extend(self.fields.as_ref().map(Fields::tally));
        let parts = Readback::start(&self.gpu, &sources).wait(&self.gpu)?;
        let mut watch = bytemuck::pod_read_unaligned::<Control>(&parts[0]).watch();
        if let (Some(fields), Some(tally)) = (&mut self.fields, parts.get(1)) {
            (watch.driven_m_s, watch.drift_m_s) = fields.read(tally);
        }
        Ok(watch)
    }

    /// Runs the substeps of a plan from the present state. The queue is kept full: a batch is recorded
    /// while the one before it runs.
    /// `watched`: ends as soon as something went wrong, at the cost of a read-back a batch.
    fn run(&mut self, plan: &Plan, stop: &Stop, watched: bool) -> Result<Outcome, SolverError> {
        self.set_activations(plan)?;
        self.params.push_m = PUSH_SHARE * self.params.slack as f32 * self.settings.cell_m / plan.sort_every.max(1) as f32;
        let bound = self.bind_both()?;
        self.start_segment();
        let (mut batch, longest) = match self.gpu.tier {
            Tier::Cpu => [(CPU_BATCH / self.params.count).clamp(1, CPU_BATCH_MOST); 2].into(),
            Tier::Gpu => GPU_BATCH,
        };
        let mut earlier: Option<wgpu::SubmissionIndex> = None;
        let mut step = 0;
        while step < plan.substeps {
            let end = (step + batch).min(plan.substeps);
            batch = (2 * batch).min(longest);
            let mut recording = Recording::default();
            for step in step..end {
                self.record_substep(plan, step, &bound, &mut recording);
            }
            if end == plan.substeps {
                self.record_measure(&mut recording);
            }
            let submitted = self.gpu.submit(&recording);
            if let Some(earlier) = earlier.replace(submitted) {
                let poll = wgpu::PollType::Wait { submission_index: Some(earlier), timeout: None };
                self.gpu.device.poll(poll).map_err(|e| self.gpu.lost(e))?;
            }
            if stop.raised() {
                return Ok(Outcome::Stopped);
            }
            if watched && end < plan.substeps {
                let so_far = self.gpu.read::<Control>(&self.control, 1)?.first().map(Control::watch);
                let travel_m = self.params.slack as f32 * self.settings.cell_m;
                if so_far.is_some_and(|now| now.went_wrong(plan.dt_s, plan.sort_every, self.settings.cell_m, travel_m)) {
                    // Which object it is shows in the state.
                    let mut recording = Recording::default();
                    self.record_measure(&mut recording);
                    self.gpu.submit(&recording);
                    return Ok(Outcome::Done(self.read_watch()?));
                }
            }
            step = end;
        }
        Ok(Outcome::Done(self.read_watch()?))
    }

    /// Uploads what the passes of a segment start from.
    pub(super) fn start_segment(&mut self) {
        self.params.pools = u32::from(self.liquid.is_some() || self.sph.is_some());
        // Liquids beside the grid look for the particles of a cell.
        self.params.mixes = u32::from(self.transfers.by_block() && self.sph().is_none());
        self.params.first_substep = self.substep;
        self.gpu.upload(&self.params_buffer, &[self.params]);
        self.gpu.upload(&self.control, &[Control::FRESH]);
    }

    /// Keeps the present state on the device.
    fn backup(&self) {
        self.copy_state(&self.buffers[self.current], &self.backup);
        let mut recording = Recording::default();
        self.kept().for_each(|k| k.keep(&mut recording));
        self.gpu.submit(&recording);
    }

    /// Back to the kept state; whatever the failed segment left on the grid goes.
    fn roll_back(&mut self, substep: u32, current: usize) {
        self.substep = substep;
        self.current = current;
        self.copy_state(&self.backup, &self.buffers[current]);
        let mut recording = Recording::default();
        for buffer in self.grid.iter().flat_map(GridBuffers::dirty) {
            recording.clear(buffer);
        }
        self.kept().for_each(|k| k.restore(&mut recording));
        self.gpu.submit(&recording);
    }

    pub(super) fn copy_state(&self, from: &super::state::StateBuffers, to: &super::state::StateBuffers) {
        let bytes = (super::state::PLANES * self.params.count as usize * 16) as u64;
        let mut recording = Recording::default();
        recording.copy(&from.kinematics, &to.kinematics, bytes);
        recording.copy(&from.matter, &to.matter, bytes);
        self.gpu.submit(&recording);
    }
}
