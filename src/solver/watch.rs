//! What the device reports at the end of a segment, and what of it means that the segment failed.

use bytemuck::{Pod, Zeroable};
use glam::IVec3;

/// `Control` of `shaders/solver/control.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Control {
    momentum: [u32; 4],
    speed: u32,
    overflow: u32,
    window: u32,
    nonfinite: u32,
    j_low: u32,
    j_high: u32,
    suspects: u32,
    low: [i32; 3],
    high: [i32; 3],
    final_speed: u32,
    wave_speed: u32,
    crowded: u32,
    blocks: u32,
    unmet: u32,
    inside_out: u32,
}

impl Control {
    /// What a segment starts from.
    pub const FRESH: Control = Control {
        momentum: [0; 4],
        speed: 0,
        overflow: 0,
        window: 0,
        nonfinite: 0,
        j_low: u32::MAX,
        j_high: 0,
        suspects: 0,
        low: [i32::MAX; 3],
        high: [i32::MIN; 3],
        final_speed: 0,
        wave_speed: 0,
        crowded: 0,
        blocks: 0,
        unmet: 0,
        inside_out: 0,
    };

    pub fn watch(&self) -> Watch {
        Watch {
            speed_m_s: f32::from_bits(self.final_speed),
            wave_speed_m_s: f32::from_bits(self.wave_speed),
            peak_speed_m_s: f32::from_bits(self.speed),
            driven_m_s: 0.0,
            drift_m_s: 0.0,
            overflow: self.overflow != 0,
            window: self.window != 0,
            crowded: self.crowded != 0,
            blocks: self.blocks as usize,
            unmet: self.unmet != 0,
            inside_out: self.inside_out,
            nonfinite: self.nonfinite,
            j_low: value(self.j_low),
            j_high: value(self.j_high),
            suspects: self.suspects,
            low: self.low.into(),
            high: self.high.into(),
        }
    }
}

/// Back from bits that are ordered as the values are.
fn value(bits: u32) -> f32 {
    f32::from_bits(if bits >> 31 != 0 { bits & 0x7fff_ffff } else { !bits })
}

/// The state of a run at the end of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Watch {
    /// Fastest particle now.
    pub speed_m_s: f32,
    /// Largest speed that bounds a substep, by what particles are made of now.
    pub wave_speed_m_s: f32,
    /// Fastest particle at any substep of the segment.
    pub peak_speed_m_s: f32,
    /// By how much fields and moving pins may speed anything up in the next frame.
    pub driven_m_s: f32,
    /// By how much fields change anything's velocity over the whole of the next frame: a stiff spring goes to and fro.
    pub drift_m_s: f32,
    pub overflow: bool,
    pub window: bool,
    /// A list of neighbours was too short.
    pub crowded: bool,
    /// Most blocks of the grid that any sort of the segment asked for.
    pub blocks: usize,
    /// A rigid body touched more things than it has slots for.
    pub unmet: bool,
    /// Particles inside out whose law does not follow that.
    pub inside_out: u32,
    pub nonfinite: u32,
    pub j_low: f32,
    pub j_high: f32,
    /// Objects, modulo 32, with a particle that is not finite or far from its volume.
    pub suspects: u32,
    /// Lattice bounds of the first nodes of all stencils.
    pub low: IVec3,
    pub high: IVec3,
}

/// det F beyond these is no longer the material's own doing.
const J_TRIP: (f32, f32) = (-1.0, 70.0);
/// Cells that a particle may move in one substep.
const STEP_CELLS: f32 = 0.6;
/// Cells that the speed which bounds substeps may come to in one, where 0.57 is stable for any particle and 0.72 to 0.8 for
/// packed ones: a law that stiffened meanwhile takes smaller ones.
const WAVE_CELLS: f32 = 0.6;

impl Watch {
    /// What of a failed segment may guide the next try: a speed that is none, or beyond all that is followed, is held.
    pub fn sane(self, speed_most_m_s: f32) -> Watch {
        Watch { peak_speed_m_s: if self.peak_speed_m_s.is_nan() { speed_most_m_s } else { self.peak_speed_m_s.min(speed_most_m_s) }, ..self }
    }

    /// Whether a segment that is still running has failed already; what is measured at its end is not known yet.
    pub fn went_wrong(&self, dt_s: f32, sort_every: u32, cell_m: f32, travel_m: f32) -> bool {
        let unmeasured = Watch { nonfinite: 0, wave_speed_m_s: 0.0, inside_out: 0, j_low: 1.0, j_high: 1.0, ..*self };
        unmeasured.trip(dt_s, sort_every, cell_m, travel_m).is_some()
    }

    /// Whether no particle is larger or smaller than its law may make it.
    pub fn has_sound_volumes(&self) -> bool {
        !(self.j_low < J_TRIP.0 || self.j_high > J_TRIP.1)
    }

    /// Why the segment has to be run again, if it has to. `travel_m` is how far a particle may go
    /// between two sorts.
    pub fn trip(&self, dt_s: f32, sort_every: u32, cell_m: f32, travel_m: f32) -> Option<String> {
        if self.nonfinite > 0 {
            return Some(format!("{} particles are not finite", self.nonfinite));
        }
        // NaN compares false with everything.
        let moved_m = self.peak_speed_m_s * dt_s;
        if !(moved_m <= STEP_CELLS * cell_m && moved_m * sort_every as f32 <= travel_m) {
            return Some(format!("particles moved {:.2} cells in a substep", moved_m / cell_m));
        }
        let wave_cells = self.wave_speed_m_s * dt_s / cell_m;
        if wave_cells > WAVE_CELLS {
            return Some(format!("waves ran {wave_cells:.2} cells in a substep"));
        }
        if self.window {
            return Some("particles left the grid".to_owned());
        }
        if self.crowded {
            return Some("particles crowd together".to_owned());
        }
        if self.overflow {
            return Some("momentum left the range of the grid's sums".to_owned());
        }
        if self.inside_out > 0 {
            return Some(format!("{} particles were turned inside out", self.inside_out));
        }
        if !self.has_sound_volumes() {
            return Some(format!("volumes changed by factors of {:.2} to {:.2}", self.j_low, self.j_high));
        }
        None
    }
}
