//! The particles' state: on the host in their original order, on the device in planes of vec4 in the
//! order of the last sort (`shaders/solver/particle.wgsl` has the layout).

use super::constants::REST_CELLS;
use super::obstacles::{ColliderRecord, distance_m};
use super::types::{Particles, SolverError};
use crate::gpu::{Gpu, GpuError, Readback};
use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3};

/// Planes of vec4 in each of the two buffers.
pub(super) const PLANES: usize = 4;

/// Bit of a tag: a rigid body moves the particle.
pub(super) const RIGID_TAG: u32 = 1 << 31;

/// One particle between two segments.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct ParticleState {
    pub position_m: Vec3,
    pub mass_kg: f32,
    pub velocity_m_s: Vec3,
    /// In the order it was given.
    pub index: u32,
    /// mass C, the affine momentum, by rows.
    pub affine: [f32; 9],
    /// F by rows.
    pub deformation: [f32; 9],
    pub mu_pa: f32,
    pub lambda_pa: f32,
    pub volume_m3: f32,
    /// Object in the lower half, row of the substance above it; see [`RIGID_TAG`].
    pub tag: u32,
    /// How far from its support it stands, metres; see `REST_CELLS`.
    pub rest_m: f32,
    /// What its law remembers beside F, as that law's WGSL says; while the prestress is sought, mass
    /// over pseudo mass.
    pub history: f32,
    pub padding: [f32; 2],
}

impl ParticleState {
    /// Row of its substance.
    pub fn substance(&self) -> usize {
        (self.tag >> 16 & 0x7fff) as usize
    }

    /// Whether it takes no part in what soft matter does: a rigid body moves it, or it was left behind.
    pub fn is_rigid(&self) -> bool {
        self.tag & RIGID_TAG != 0
    }

    /// Whether it was left behind: it takes part in nothing, and stays where it was last.
    pub fn has_left(&self) -> bool {
        self.is_rigid() && self.volume_m3 == 0.0
    }

    /// The same, left behind.
    pub fn left(self) -> ParticleState {
        ParticleState { velocity_m_s: Vec3::ZERO, affine: [0.0; 9], mu_pa: 0.0, lambda_pa: 0.0, volume_m3: 0.0, tag: self.tag | RIGID_TAG, ..self }
    }

    /// Whether it is a rigid body's.
    pub fn is_of_body(&self) -> bool {
        self.is_rigid() && !self.has_left()
    }

    /// Makes it of the substance of a row.
    pub fn set_substance(&mut self, row: u16, rigid: bool) {
        self.tag = self.object() | u32::from(row) << 16 | if rigid { RIGID_TAG } else { 0 };
    }

    /// Index of its object.
    pub fn object(&self) -> u32 {
        self.tag & 0xffff
    }

    pub fn f(&self) -> Mat3 {
        Mat3::from_cols_array(&self.deformation).transpose()
    }

    pub fn set_f(&mut self, f: Mat3) {
        self.deformation = f.transpose().to_cols_array();
    }

    pub fn set_affine(&mut self, a: Mat3) {
        self.affine = a.transpose().to_cols_array();
    }
}

/// Every particle as it was sampled.
pub(super) fn initial(particles: &Particles, colliders: &[ColliderRecord], cell_m: f32) -> Result<Vec<ParticleState>, SolverError> {
    let n = particles.len();
    let lengths = [
        particles.velocity_m_s.len(),
        particles.volume_m3.len(),
        particles.density_kg_m3.len(),
        particles.young_pa.len(),
        particles.poisson.len(),
        particles.substance.len(),
        particles.object.len(),
    ];
    let refuse = |what: String, expected: &str| Err(SolverError::Input { what, expected: expected.to_owned() });
    if n == 0 || lengths.iter().any(|&l| l != n) {
        return refuse(format!("{n} positions and arrays of {lengths:?}"), "at least one particle and arrays of one length");
    }
    let mut states = Vec::with_capacity(n);
    if let Some(row) = particles.substance.iter().find(|&&row| usize::from(row) >= particles.substances.len()) {
        return refuse(format!("a particle of substance {row} of {}", particles.substances.len()), "a row of the table");
    }
    for i in 0..n {
        let beside = particles.substances[usize::from(particles.substance[i])].is_sph();
        let rigid = particles.substances[usize::from(particles.substance[i])].rigid().is_some();
        let (mu_pa, lambda_pa) = if beside || rigid { (0.0, 0.0) } else { particles.lame_pa(i) };
        let mass_kg = particles.volume_m3[i] * particles.density_kg_m3[i];
        let (x, v) = (particles.position_m[i], particles.velocity_m_s[i]);
        let flows = particles.substances[usize::from(particles.substance[i])].is_liquid();
        let stiff = (mu_pa > 0.0 || flows) && (lambda_pa + 2.0 * mu_pa).is_finite() && lambda_pa + 2.0 * mu_pa > 0.0;
        let sound = mass_kg > 0.0 && mass_kg.is_finite() && (beside || rigid || stiff);
        if !(x.is_finite() && v.is_finite() && sound && particles.object[i] <= 0xffff) {
            let (e, nu) = (particles.young_pa[i], particles.poisson[i]);
            return refuse(
                format!("particle {i} at {x}, {mass_kg} kg, E = {e} Pa, nu = {nu}"),
                "finite places, positive mass and modulus, nu over -1 and under 0.5",
            );
        }
        let mut state = ParticleState {
            position_m: x,
            mass_kg,
            velocity_m_s: v,
            index: i as u32,
            mu_pa,
            lambda_pa,
            volume_m3: particles.volume_m3[i],
            tag: particles.object[i] | u32::from(particles.substance[i]) << 16 | if rigid { RIGID_TAG } else { 0 },
            history: particles.substances[usize::from(particles.substance[i])].first_history(),
            rest_m: if flows { REST_CELLS * cell_m } else { distance_m(colliders, x).clamp(-2.0 * REST_CELLS * cell_m, REST_CELLS * cell_m) },
            ..Default::default()
        };
        state.set_f(Mat3::IDENTITY);
        states.push(state);
    }
    Ok(states)
}

/// The two buffers of the device.
#[derive(Clone, Debug)]
pub(super) struct StateBuffers {
    pub kinematics: wgpu::Buffer,
    pub matter: wgpu::Buffer,
}

impl StateBuffers {
    pub fn new(gpu: &Gpu, label: &str, count: usize) -> Result<StateBuffers, GpuError> {
        Ok(StateBuffers {
            kinematics: gpu.storage::<[f32; 4]>(&format!("{label}.kinematics"), PLANES * count)?,
            matter: gpu.storage::<[f32; 4]>(&format!("{label}.matter"), PLANES * count)?,
        })
    }

    /// Writes all particles in their original order.
    pub fn upload(&self, gpu: &Gpu, states: &[ParticleState]) {
        let n = states.len();
        let mut kinematics = vec![[0.0f32; 4]; PLANES * n];
        let mut matter = vec![[0.0f32; 4]; PLANES * n];
        for (i, s) in states.iter().enumerate() {
            let (a, f) = (&s.affine, &s.deformation);
            kinematics[i] = s.position_m.extend(s.mass_kg).into();
            kinematics[n + i] = s.velocity_m_s.extend(a[0]).into();
            kinematics[2 * n + i] = [a[1], a[2], a[3], a[4]];
            kinematics[3 * n + i] = [a[5], a[6], a[7], a[8]];
            matter[i] = [f[0], f[1], f[2], s.mu_pa];
            matter[n + i] = [f[3], f[4], f[5], s.lambda_pa];
            matter[2 * n + i] = [f[6], f[7], f[8], s.volume_m3];
            matter[3 * n + i] = [f32::from_bits(s.index), f32::from_bits(s.tag), s.rest_m, s.history];
        }
        gpu.upload(&self.kinematics, &kinematics);
        gpu.upload(&self.matter, &matter);
    }

    /// Reads all particles, back in their original order.
    pub fn download(&self, gpu: &Gpu, count: usize) -> Result<Vec<ParticleState>, GpuError> {
        let bytes = (PLANES * 16 * count) as u64;
        let parts = Readback::start(gpu, &[(&self.kinematics, bytes), (&self.matter, bytes)]).wait(gpu)?;
        Ok(unpack(&parts[0], &parts[1], count))
    }
}

/// Where a particle is and how it moves, without what it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Glance {
    pub position_m: Vec3,
    pub velocity_m_s: Vec3,
    pub object: u32,
    /// See [`ParticleState::rest_m`].
    pub rest_m: f32,
}

impl StateBuffers {
    /// Reads where all particles are, in the order that they lie in: three of the eight planes.
    pub fn glance(&self, gpu: &Gpu, count: usize) -> Result<Vec<Glance>, GpuError> {
        let plane = 16 * count as u64;
        let parts = Readback::start_at(gpu, &[(&self.kinematics, 0, 2 * plane), (&self.matter, 3 * plane, plane)]).wait(gpu)?;
        let [k, m]: [Vec<[f32; 4]>; 2] = [&parts[0], &parts[1]].map(|bytes| bytemuck::pod_collect_to_vec(bytes));
        let glance = |i: usize| Glance {
            position_m: Vec3::from_slice(&k[i]),
            velocity_m_s: Vec3::from_slice(&k[count + i]),
            object: m[i][1].to_bits() & 0xffff,
            rest_m: m[i][2],
        };
        Ok((0..count).map(glance).collect())
    }
}

/// All particles in their original order, from the bytes of both buffers.
pub(super) fn unpack(kinematics: &[u8], matter: &[u8], count: usize) -> Vec<ParticleState> {
    let n = count;
    let (k, m): (Vec<[f32; 4]>, Vec<[f32; 4]>) = (bytemuck::pod_collect_to_vec(kinematics), bytemuck::pod_collect_to_vec(matter));
    let mut states = vec![ParticleState::default(); n];
    for i in 0..n {
        let index = m[3 * n + i][0].to_bits();
        let (q, r, s) = (k[n + i], k[2 * n + i], k[3 * n + i]);
        let (a, b, c) = (m[i], m[n + i], m[2 * n + i]);
        states[index as usize] = ParticleState {
            position_m: Vec3::from_slice(&k[i]),
            mass_kg: k[i][3],
            velocity_m_s: Vec3::from_slice(&q),
            index,
            affine: [q[3], r[0], r[1], r[2], r[3], s[0], s[1], s[2], s[3]],
            deformation: [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]],
            mu_pa: a[3],
            lambda_pa: b[3],
            volume_m3: c[3],
            tag: m[3 * n + i][1].to_bits(),
            rest_m: m[3 * n + i][2],
            history: m[3 * n + i][3],
            padding: [0.0; 2],
        };
    }
    states
}
