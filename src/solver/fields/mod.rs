//! Fields: what accelerates particles by expressions. One pass after each substep, whose functions are
//! written from the scene's expressions and whose numbers lie in a buffer; only scenes with fields have it.

mod respond;
pub(super) mod write;

pub use respond::velocity_change;

use super::advance::Substep;
use super::constants;
use super::core::Solver;
use super::passes::SUBSTEP;
use super::record::Bound;
use super::state::StateBuffers;
use super::types::{Advance, Field, Particles, Settings, SolverError};
use crate::gpu::Access::{Read, Write};
use crate::gpu::{Gpu, Kernel, KernelSource, Recording};
use crate::spec::expression::{Instruction, hash};
use bytemuck::{Pod, Zeroable};
use std::sync::OnceLock;

/// `Field` of `shaders/solver/fields.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct FieldRecord {
    pub shape: u32,
    pub first: u32,
    pub object: u32,
    pub number: u32,
}

/// The head of `Fields` of that file.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
struct Head {
    count: u32,
    asks: u32,
    start_s: f32,
    frame_s: f32,
}

/// Words of `Tally` of that file before the counts of each field.
const TALLY_HEAD: usize = 3;

/// Which fields a pass goes by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum When {
    /// Those in force in the present segment, which act.
    Now,
    /// Those in force after it, whose largest change is wanted.
    Next,
}

/// The fields of a scene on the device.
#[derive(Debug)]
pub(super) struct Fields {
    kernel: Kernel,
    /// One for each field of the settings.
    records: Vec<FieldRecord>,
    constants: wgpu::Buffer,
    captured: wgpu::Buffer,
    now: wgpu::Buffer,
    next: wgpu::Buffer,
    tally: wgpu::Buffer,
    /// What the last segment counted.
    last: Vec<u32>,
}

/// The number of its own that a particle brings, 0 to 2^24 - 1.
pub(super) fn own_number(index: u32, seed: u32) -> f32 {
    (hash(index ^ hash(seed)) >> 8) as f32
}

/// Distinct expressions, numbers apart, each once.
pub(super) fn shapes(fields: &[Field]) -> Vec<(&[Instruction], &[u16])> {
    let mut shapes: Vec<(&[Instruction], &[u16])> = Vec::new();
    for field in fields {
        let shape = (field.acceleration.instructions.as_slice(), field.acceleration.results.as_slice());
        if !shapes.contains(&shape) {
            shapes.push(shape);
        }
    }
    shapes
}

impl Fields {
    /// None where the settings have no fields.
    pub fn new(gpu: &Gpu, settings: &Settings, particles: &Particles, seed: u32) -> Result<Option<Fields>, SolverError> {
        if settings.fields.is_empty() {
            return Ok(None);
        }
        if let Some(field) = settings.fields.iter().find(|f| f.acceleration.results.len() != 3) {
            let what = format!("a field `{}` of {} numbers", field.name, field.acceleration.results.len());
            return Err(SolverError::Input { what, expected: "a vector".to_owned() });
        }
        let shapes = shapes(&settings.fields);
        let mut constants: Vec<f32> = Vec::new();
        let mut records = Vec::new();
        for (number, field) in settings.fields.iter().enumerate() {
            let program = &field.acceleration;
            let shape = shapes.iter().position(|s| *s == (program.instructions.as_slice(), program.results.as_slice())).unwrap_or(0);
            records.push(FieldRecord { shape: shape as u32, first: constants.len() as u32, object: field.object, number: number as u32 });
            constants.extend(program.constants.iter().map(|c| *c as f32));
        }
        let places = particles.position_m.iter().enumerate();
        let captured: Vec<[f32; 4]> = places.map(|(i, x)| x.extend(own_number(i as u32, seed)).into()).collect();
        let list_bytes = (size_of::<Head>() + records.len() * size_of::<FieldRecord>()) as u64;
        Ok(Some(Fields {
            kernel: gpu.kernel_with(&source(), &write::functions(&shapes)),
            constants: gpu.storage_from("solver.fields.constants", &constants)?,
            captured: gpu.storage_from("solver.fields.captured", &captured)?,
            now: gpu.storage_bytes("solver.fields.now", list_bytes)?,
            next: gpu.storage_bytes("solver.fields.next", list_bytes)?,
            tally: gpu.storage::<u32>("solver.fields.tally", TALLY_HEAD + records.len())?,
            last: vec![0; TALLY_HEAD + records.len()],
            records,
        }))
    }

    /// Everything bound, for particles that lie in `state`.
    pub fn bind(&self, solver: &Solver, state: &StateBuffers, when: When) -> wgpu::BindGroup {
        let list = if when == When::Now { &self.now } else { &self.next };
        let buffers = [&solver.params_buffer, &state.kinematics, &state.matter, &self.captured, list, &self.constants, &solver.control, &self.tally];
        solver.gpu.bind(&self.kernel, &buffers)
    }

    fn upload(&self, gpu: &Gpu, when: When, in_force: &[FieldRecord], start_s: f64, frame_s: f64) {
        let asks = u32::from(when == When::Next);
        let head = Head { count: in_force.len() as u32, asks, start_s: start_s as f32, frame_s: frame_s as f32 };
        let bytes = [bytemuck::bytes_of(&head), bytemuck::cast_slice(in_force)].concat();
        gpu.upload(if when == When::Now { &self.now } else { &self.next }, &bytes);
    }

    /// Where the counts of a segment lie, and how many bytes.
    pub fn tally(&self) -> (&wgpu::Buffer, u64) {
        (&self.tally, (self.last.len() * size_of::<u32>()) as u64)
    }

    /// Takes the counts in; the largest change of velocity that fields may bring in the next frame, and over
    /// the whole of it.
    pub fn read(&mut self, bytes: &[u8]) -> (f32, f32) {
        self.last = bytemuck::pod_collect_to_vec(bytes);
        let change = |at: usize| f32::from_bits(self.last.get(at).copied().unwrap_or(0));
        (change(0), change(1))
    }
}

impl Solver {
    fn fields_in_force(&self, fields: &Fields, time_s: f64) -> Vec<FieldRecord> {
        let acting = fields.records.iter().zip(&self.settings.fields);
        acting.filter(|(_, f)| super::advance::spans(f.from_s, f.to_s, time_s)).map(|(record, _)| *record).collect()
    }

    /// Uploads the fields of the present time.
    pub(super) fn set_fields(&self) {
        if let Some(fields) = &self.fields {
            let in_force = self.fields_in_force(fields, self.time_s);
            fields.upload(&self.gpu, When::Now, &in_force, self.time_s, self.settings.frame_s);
        }
    }

    /// Prepares the question what the fields of a time may bring, and forgets what was counted.
    pub(super) fn ask_fields_at(&self, time_s: f64) {
        if let Some(fields) = &self.fields {
            let in_force = self.fields_in_force(fields, time_s);
            fields.upload(&self.gpu, When::Next, &in_force, time_s, self.settings.frame_s);
            self.gpu.upload(&fields.tally, &vec![0u32; fields.last.len()]);
        }
    }

    /// Adds that question, for the present state.
    pub(super) fn record_field_question(&self, recording: &mut Recording) {
        if let Some(fields) = &self.fields {
            let bindings = fields.bind(self, &self.buffers[self.current], When::Next);
            recording.dispatch_with(&fields.kernel, &bindings, &Substep::zeroed(), self.particle_groups());
        }
    }

    /// Adds what fields do after a substep.
    pub(super) fn record_fields(&self, bound: &Bound, substep: &Substep, recording: &mut Recording) {
        if let (Some(fields), Some(bindings)) = (&self.fields, &bound.fields) {
            recording.dispatch_with(&fields.kernel, bindings, substep, self.particle_groups());
        }
    }

    /// Adds what the last segment counted.
    pub(super) fn report_fields(&self, report: &mut Advance) {
        let Some(fields) = &self.fields else { return };
        report.limited += u64::from(fields.last.get(TALLY_HEAD - 1).copied().unwrap_or(0));
        for (field, times) in self.settings.fields.iter().zip(fields.last.iter().skip(TALLY_HEAD)).filter(|(_, times)| **times > 0) {
            match report.undefined.iter_mut().find(|(name, _)| *name == field.name) {
                Some((_, sum)) => *sum += u64::from(*times),
                None => report.undefined.push((field.name.clone(), u64::from(*times))),
            }
        }
    }
}

/// The pass without the functions of a scene.
fn source() -> KernelSource {
    KernelSource {
        label: "solver.fields",
        entry: "main",
        parts: vec![
            shader!("common"),
            shader!("control"),
            shader!("substep"),
            shader!("hash"),
            shader!("particle"),
            shader!("particle_write"),
            shader!("chance"),
            shader!("dual"),
            shader!("field"),
            shader!("fields"),
        ],
        constants: constants::all(),
        bindings: vec![Read, Write, Read, Read, Read, Read, Write, Write],
        immediate_bytes: SUBSTEP,
    }
}

/// The pass with the functions of expressions that use every step, for validation and keys.
pub(super) fn kernels() -> Vec<KernelSource> {
    static SAMPLE: OnceLock<String> = OnceLock::new();
    let mut sample = source();
    sample.parts.push(("solver/fields of a sample", SAMPLE.get_or_init(write::sample)));
    vec![sample]
}
