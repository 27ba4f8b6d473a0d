//! A solver's state as bytes, from which another goes on to the same bits.

use super::core::Solver;
use super::grip::{Begun, Grip};
use super::state::{PLANES, ParticleState, unpack};
use super::substance::Substance;
use super::types::SolverError;
use super::wary::Wary;
use crate::gpu::{Gpu, Readback};
use bytemuck::{Pod, Zeroable};

/// First bytes of every checkpoint.
const MAGIC: [u8; 4] = *b"PTSC";

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Header {
    magic: [u8; 4],
    version: u32,
    count: u32,
    substep: u32,
    time_s: f64,
    /// Bytes of the table of substances, JSON.
    table_bytes: u64,
    /// Rigid bodies.
    bodies: u64,
    /// Pins that have begun.
    grips: u64,
    wary: Wary,
}

/// A state on its way back from the device; [`Checkpoint::bytes`] can wait for it on another thread.
#[derive(Debug)]
pub struct Checkpoint {
    head: Vec<u8>,
    /// Of rigid bodies: the host has them.
    anchors: Vec<u8>,
    count: usize,
    readback: Readback,
    gpu: Gpu,
}

impl Checkpoint {
    /// The whole state, from which the same bits go on.
    pub fn bytes(self) -> Result<Vec<u8>, SolverError> {
        let parts = self.readback.wait(&self.gpu)?;
        let [kinematics, matter, unstressed, beside @ ..] = parts.as_slice() else {
            return Err(SolverError::Checkpoint { what: "a state without particles".to_owned() });
        };
        let mut bytes = self.head;
        bytes.extend_from_slice(bytemuck::cast_slice(&unpack(kinematics, matter, self.count)));
        bytes.extend_from_slice(unstressed);
        bytes.extend_from_slice(&self.anchors);
        beside.iter().for_each(|part| bytes.extend_from_slice(part));
        Ok(bytes)
    }
}

impl Solver {
    /// The whole state between two segments. Particles are in their original order: the order in which
    /// they are summed follows from where they are, and is found again by the next sort.
    pub fn checkpoint(&self) -> Result<Vec<u8>, SolverError> {
        self.start_checkpoint()?.bytes()
    }

    /// As [`Solver::checkpoint`], without waiting for it: the solver may go on meanwhile.
    pub fn start_checkpoint(&self) -> Result<Checkpoint, SolverError> {
        let count = self.params.count;
        let table = serde_json::to_vec(&self.laws.substances).map_err(|e| SolverError::Checkpoint { what: e.to_string() })?;
        let table_bytes = table.len() as u64;
        let bodies = self.rigid.as_ref().map_or(0, |r| r.count() as u64);
        let begun: Vec<Begun> = self.grips.iter().filter_map(Grip::begun).collect();
        let header = Header {
            magic: MAGIC,
            version: super::VERSION,
            count,
            substep: self.substep,
            time_s: self.time_s,
            table_bytes,
            bodies,
            grips: begun.len() as u64,
            wary: self.wary,
        };
        let head = [bytemuck::bytes_of(&header), &table, bytemuck::cast_slice(&begun)].concat();
        // A change may have made them on the way.
        let anchors = bytemuck::cast_slice(self.rigid.as_ref().map_or(&[][..], |r| &r.anchors_host)).to_vec();
        let state = &self.buffers[self.current];
        let plane_bytes = (PLANES * 16 * count as usize) as u64;
        let unstressed_bytes = (size_of::<[f32; 12]>() * count as usize) as u64;
        let mut sources = vec![(&state.kinematics, plane_bytes), (&state.matter, plane_bytes), (&self.unstressed, unstressed_bytes)];
        sources.extend(self.kept().map(|kept| (&kept.live, kept.bytes())));
        let readback = Readback::start(&self.gpu, &sources);
        Ok(Checkpoint { head, anchors, count: count as usize, readback, gpu: self.gpu.clone() })
    }

    /// Goes back, or forward, to a checkpoint of a solver with the same particles and the same settings until then: pins that
    /// begin later may be others. Settings that changed on
    /// the way ([`Solver::end_pins`]) are the caller's: going forward they have to change again, and back of their change
    /// only a solver made anew will do.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), SolverError> {
        let refuse = |what: String| SolverError::Checkpoint { what };
        let count = self.params.count as usize;
        let (head, states, tail) = (size_of::<Header>(), count * size_of::<ParticleState>(), count * size_of::<[f32; 12]>());
        let Some((header, bytes)) = bytes.split_at_checked(head) else {
            return Err(refuse(format!("{} bytes", bytes.len())));
        };
        let header: Header = bytemuck::pod_read_unaligned(header);
        if header.magic != MAGIC || header.version != super::VERSION || header.count as usize != count {
            return Err(refuse(format!("version {} for {} particles", header.version, header.count)));
        }
        let Some((table, bytes)) = bytes.split_at_checked(header.table_bytes as usize) else {
            return Err(refuse(format!("{} bytes, of which {} are a table", bytes.len(), header.table_bytes)));
        };
        // A material may have changed since the start.
        let table: Vec<Substance> = serde_json::from_slice(table).map_err(|e| refuse(e.to_string()))?;
        self.set_substances(&table)?;
        let of_grips = (header.grips as usize).saturating_mul(size_of::<Begun>());
        let Some((begun, bytes)) = bytes.split_at_checked(of_grips) else {
            return Err(refuse(format!("{} bytes, of which {of_grips} are where pins hold", bytes.len())));
        };
        let begun: Vec<Begun> = bytemuck::pod_collect_to_vec(begun);
        self.grips.iter_mut().for_each(|grip| grip.resume(&begun));
        let anchors = if header.bodies > 0 { count * size_of::<[f32; 4]>() } else { 0 };
        let short = |whole: usize| refuse(format!("{} bytes where {count} particles take {whole}", bytes.len()));
        if bytes.len() < states + tail + anchors || header.bodies > count as u64 {
            return Err(short(states + tail + anchors));
        }
        let particles: Vec<ParticleState> = bytemuck::pod_collect_to_vec(&bytes[..states]);
        let unstressed: Vec<[f32; 12]> = bytemuck::pod_collect_to_vec(&bytes[states..states + tail]);
        if let Some(row) = particles.iter().map(ParticleState::substance).find(|&row| row >= table.len()) {
            return Err(refuse(format!("a particle of substance {row} of {}", table.len())));
        }
        let anchored = bytemuck::pod_collect_to_vec(&bytes[states + tail..states + tail + anchors]);
        self.rebuild(anchored, header.bodies as usize, &particles)?;
        let whole = states + tail + anchors + self.kept().map(|k| k.bytes() as usize).sum::<usize>();
        if bytes.len() != whole {
            return Err(short(whole));
        }
        self.set_layers(&particles)?;
        self.replace(particles);
        if header.time_s > 0.0 {
            // Told when it happened, on the way here.
            self.softened.clear();
        }
        self.gpu.upload(&self.unstressed, &unstressed);
        let mut rest = &bytes[states + tail + anchors..];
        for kept in self.kept() {
            let (content, more) = rest.split_at(kept.bytes() as usize);
            kept.write(&self.gpu, content);
            rest = more;
        }
        self.set_wary(header.wary);
        self.substep = header.substep;
        self.time_s = header.time_s;
        Ok(())
    }
}
