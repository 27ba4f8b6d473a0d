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
    let one = Particles { substance: vec![0; from.len()], substances: vec![substance], object: vec![0; from.len()], ..from };
    *to = joined(std::mem::take(to), one);
}

/// A ball filled at a spacing, 1000 kg/m^3; particles at its surface have the volume of their share of it
/// and stand at the middle of that share.
pub(in crate::solver) fn ball(centre_m: Vec3, radius_m: f32, spacing_m: f32) -> Particles {
    const PROBES: i32 = 8;
    let reach = (radius_m / spacing_m).ceil() as i32;
    let (mut position_m, mut volume_m3) = (Vec::new(), Vec::new());
    let at = |k: i32, of: i32| (k as f32 + 0.5) / of as f32;
    for cell in 0..(2 * reach).pow(3) {
        let side = 2 * reach;
        let low = glam::IVec3::new(cell % side, cell / side % side, cell / side / side) - reach;
        let probes = (0..PROBES.pow(3)).map(|p| {
            let inner = Vec3::new(at(p % PROBES, PROBES), at(p / PROBES % PROBES, PROBES), at(p / PROBES / PROBES, PROBES));
            (low.as_vec3() + inner) * spacing_m
        });
        let inside: Vec<Vec3> = probes.filter(|p| p.length() < radius_m).collect();
        if inside.len() >= 16 {
            position_m.push(centre_m + inside.iter().sum::<Vec3>() / inside.len() as f32);
            volume_m3.push(spacing_m.powi(3) * inside.len() as f32 / PROBES.pow(3) as f32);
        }
    }
    let n = position_m.len();
    Particles {
        position_m,
        velocity_m_s: vec![Vec3::ZERO; n],
        volume_m3,
        density_kg_m3: vec![1000.0; n],
        young_pa: vec![1e5; n],
        poisson: vec![0.3; n],
        substance: vec![0; n],
        substances: vec![Substance::default()],
        object: vec![0; n],
    }
}

/// The same particles as one rigid body.
pub(in crate::solver) fn rigid(particles: Particles, friction: f32, restitution: f32) -> Particles {
    Particles { substances: vec![Substance::Rigid { friction, restitution }], ..particles }
}

/// Two scenes in one; the second's objects and substances come after the first's.
pub(in crate::solver) fn joined(mut one: Particles, other: Particles) -> Particles {
    let objects = one.object.iter().max().map_or(0, |o| o + 1);
    let rows = one.substances.len() as u16;
    one.position_m.extend(other.position_m);
    one.velocity_m_s.extend(other.velocity_m_s);
    one.volume_m3.extend(other.volume_m3);
    one.density_kg_m3.extend(other.density_kg_m3);
    one.young_pa.extend(other.young_pa);
    one.poisson.extend(other.poisson);
    one.substance.extend(other.substance.iter().map(|row| row + rows));
    one.substances.extend(other.substances);
    one.object.extend(other.object.iter().map(|object| object + objects));
    one
}

/// The particles of one whose places a predicate picks.
pub(in crate::solver) fn keep(all: &Particles, inside: impl Fn(Vec3) -> bool) -> Particles {
    let picked: Vec<usize> = (0..all.len()).filter(|&i| inside(all.position_m[i])).collect();
    fn of<T: Copy>(values: &[T], picked: &[usize]) -> Vec<T> {
        picked.iter().map(|&i| values[i]).collect()
    }
    Particles {
        position_m: of(&all.position_m, &picked),
        velocity_m_s: of(&all.velocity_m_s, &picked),
        volume_m3: of(&all.volume_m3, &picked),
        density_kg_m3: of(&all.density_kg_m3, &picked),
        young_pa: of(&all.young_pa, &picked),
        poisson: of(&all.poisson, &picked),
        substance: of(&all.substance, &picked),
        substances: all.substances.clone(),
        object: of(&all.object, &picked),
    }
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
pub(in crate::solver) fn angular_momentum(states: &[ParticleState], about_m: DVec3, cell_m: f32) -> DVec3 {
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
