//! Bodies of regularly spaced particles, and what is measured of them.

use crate::solver::core::Solver;
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use crate::solver::types::{Collider, Particles, SolverError};
use crate::spec::{ColliderShape, PlaneShape};
use glam::{DVec3, Vec3};

/// A box filled at a spacing, 1000 kg/m^3, fixed corotated.
pub(in crate::solver) fn block(low_m: Vec3, size_m: Vec3, spacing_m: f32, young_pa: f32, poisson: f32) -> Particles {
    let counts = (size_m / spacing_m).round().as_uvec3();
    let mut position_m = Vec::new();
    for z in 0..counts.z {
        for y in 0..counts.y {
            for x in 0..counts.x {
                position_m.push(low_m + (Vec3::new(x as f32, y as f32, z as f32) + 0.5) * spacing_m);
            }
        }
    }
    let n = position_m.len();
    Particles {
        position_m,
        velocity_m_s: vec![Vec3::ZERO; n],
        volume_m3: vec![spacing_m.powi(3); n],
        density_kg_m3: vec![1000.0; n],
        young_pa: vec![young_pa; n],
        poisson: vec![poisson; n],
        substance: vec![0; n],
        substances: vec![Substance::default()],
        object: vec![0; n],
    }
}

/// Adds a body of another object and substance.
pub(in crate::solver) fn append(to: &mut Particles, from: Particles, substance: Substance) {
    let n = from.len();
    let object = to.object.iter().max().map_or(0, |o| o + 1);
    to.position_m.extend(from.position_m);
    to.velocity_m_s.extend(from.velocity_m_s);
    to.volume_m3.extend(from.volume_m3);
    to.density_kg_m3.extend(from.density_kg_m3);
    to.young_pa.extend(from.young_pa);
    to.poisson.extend(from.poisson);
    to.substance.extend(vec![to.substances.len() as u16; n]);
    to.substances.push(substance);
    to.object.extend(vec![object; n]);
}

/// A box filled at a spacing with a liquid.
pub(in crate::solver) fn pool(low_m: Vec3, size_m: Vec3, spacing_m: f32, density_kg_m3: f32, bulk_pa: f32, substance: Substance) -> Particles {
    let mut particles = block(low_m, size_m, spacing_m, bulk_pa, 0.0);
    particles.density_kg_m3.fill(density_kg_m3);
    particles.substances = vec![substance];
    particles
}

/// Frictionless planes around a box, without floor and lid.
pub(super) fn walls(low_m: Vec3, high_m: Vec3) -> Vec<Collider> {
    let plane = |point_m: Vec3, normal: Vec3| {
        let shape = PlaneShape { point_m: point_m.as_dvec3().into(), normal: normal.as_dvec3().into() };
        Collider { shape: ColliderShape::Plane(shape), friction: 0.0, restitution: 0.0 }
    };
    vec![plane(low_m, Vec3::X), plane(high_m, Vec3::NEG_X), plane(low_m, Vec3::Y), plane(high_m, Vec3::NEG_Y)]
}

/// Sets velocity + spin x (x - centre) on every particle.
pub(super) fn set_moving(particles: &mut Particles, centre_m: Vec3, velocity_m_s: Vec3, spin_rad_s: Vec3) {
    for (v, x) in particles.velocity_m_s.iter_mut().zip(&particles.position_m) {
        *v = velocity_m_s + spin_rad_s.cross(*x - centre_m);
    }
}

/// Total momentum, kg m/s.
pub(super) fn momentum(states: &[ParticleState]) -> DVec3 {
    states.iter().map(|s| s.velocity_m_s.as_dvec3() * f64::from(s.mass_kg)).sum()
}

/// Centre of mass.
pub(super) fn centre_m(states: &[ParticleState]) -> DVec3 {
    let mass: f64 = states.iter().map(|s| f64::from(s.mass_kg)).sum();
    states.iter().map(|s| s.position_m.as_dvec3() * f64::from(s.mass_kg)).sum::<DVec3>() / mass
}

/// Total angular momentum about a point, with what APIC keeps in the affine part: a quarter of the
/// cell squared times the axial vector of mass C (Jiang et al. 2015, section 5.3.2).
pub(super) fn angular_momentum(states: &[ParticleState], about_m: DVec3, cell_m: f32) -> DVec3 {
    let quarter = 0.25 * f64::from(cell_m).powi(2);
    let of = |s: &ParticleState| {
        let a = s.affine.map(f64::from);
        let axial = DVec3::new(a[7] - a[5], a[2] - a[6], a[3] - a[1]);
        let arm = s.position_m.as_dvec3() - about_m;
        arm.cross(s.velocity_m_s.as_dvec3()) * f64::from(s.mass_kg) + axial * quarter
    };
    states.iter().map(of).sum()
}

/// Mean of a quantity over the particles that a predicate picks, by their original index.
pub(super) fn mean_of(solver: &Solver, picked: &[usize], of: impl Fn(&ParticleState) -> f64) -> Result<f64, SolverError> {
    let states = solver.states()?;
    Ok(picked.iter().map(|&i| of(&states[i])).sum::<f64>() / picked.len() as f64)
}
