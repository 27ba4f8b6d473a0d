//! A solver's state as bytes, from which another goes on to the same bits.

use super::core::Solver;
use super::state::ParticleState;
use super::substance::Substance;
use super::types::SolverError;
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
}

impl Solver {
    /// The whole state between two segments. Particles are in their original order: the order in which
    /// they are summed follows from where they are, and is found again by the next sort.
    pub fn checkpoint(&self) -> Result<Vec<u8>, SolverError> {
        let count = self.params.count;
        let table = serde_json::to_vec(&self.laws.substances).map_err(|e| SolverError::Checkpoint { what: e.to_string() })?;
        let table_bytes = table.len() as u64;
        let bodies = self.rigid.as_ref().map_or(0, |r| r.count() as u64);
        let header = Header { magic: MAGIC, version: super::VERSION, count, substep: self.substep, time_s: self.time_s, table_bytes, bodies };
        let mut bytes = bytemuck::bytes_of(&header).to_vec();
        bytes.extend(table);
        bytes.extend_from_slice(bytemuck::cast_slice(&self.states()?));
        let unstressed: Vec<[f32; 12]> = self.gpu.read(&self.unstressed, count as usize)?;
        bytes.extend_from_slice(bytemuck::cast_slice(&unstressed));
        // A change may have made them on the way.
        bytes.extend_from_slice(bytemuck::cast_slice(self.rigid.as_ref().map_or(&[][..], |r| &r.anchors_host)));
        for kept in self.kept() {
            bytes.extend(kept.read(&self.gpu)?);
        }
        Ok(bytes)
    }

    /// Goes back, or forward, to a checkpoint of a solver with the same settings and particles.
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
        self.substep = header.substep;
        self.time_s = header.time_s;
        Ok(())
    }
}
