//! Solids given matter: what the solver and the measures need of each particle.

use super::Prepared;
use super::measure::Bodies;
use crate::proxy::{self, Solid};
use crate::solver::{Particles, Substance};
use crate::spec::{Auto, Material, Rest, Spec};
use glam::Vec3;

/// Particles of all objects, one object after another, and what was decided about them.
#[derive(Clone, Debug)]
pub struct Matter {
    /// What the solver is given. Captured pose, at rest.
    pub particles: Particles,
    /// What the measures need.
    pub bodies: Bodies,
    /// Young's modulus of each object, chosen where the spec says `"auto"`.
    pub young_pa: Vec<f64>,
    /// Centre of mass of each object in the captured pose.
    pub centre_m: Vec<Vec3>,
    /// Inner particles over all, of each object.
    pub fill_ratio: Vec<f64>,
    /// Gaussians of each object.
    pub gaussians: Vec<usize>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// What the user may like to know.
    pub notes: Vec<String>,
}

/// Gives each object's solid its material, one `Solid` for each object of the spec.
pub fn matter(spec: &Spec, prepared: &Prepared, solids: &[Solid]) -> Matter {
    let mut matter = Matter {
        particles: Particles::default(),
        bodies: Bodies {
            ranges: Vec::new(),
            mass_kg: Vec::new(),
            volume_m3: Vec::new(),
            colliders: spec.colliders.clone(),
            ground_m: prepared.ground_m,
        },
        young_pa: Vec::new(),
        centre_m: Vec::new(),
        fill_ratio: Vec::new(),
        gaussians: Vec::new(),
        warnings: Vec::new(),
        notes: Vec::new(),
    };
    for (index, solid) in solids.iter().enumerate() {
        add(&mut matter, spec, prepared, index, solid);
    }
    matter
}

fn add(matter: &mut Matter, spec: &Spec, prepared: &Prepared, index: usize, solid: &Solid) {
    let object = &spec.objects[index];
    let Material::Elastic(elastic) = object.material;
    let density = elastic.density_kg_m3;
    let members = prepared.gaussians.subset(&prepared.members(index as u32, false));
    let auto = proxy::young_auto(&solid.stance, density);
    let count = solid.position_m.len();
    let young_pa = elastic.young_pa.unwrap_or(auto.value_pa);
    let standing = object.rest == Rest::AsCaptured;
    if elastic.young_pa == Auto::Auto {
        matter.warnings.extend(auto.warnings.iter().map(|w| format!("{}: {w}", object.name)));
        matter.notes.extend(auto.notes.iter().map(|n| format!("{}: {n}", object.name)));
    } else if standing && young_pa < auto.value_pa / 4.0 {
        matter.warnings.push(format!(
            "{}: at {young_pa:.3e} Pa its most slender part cannot carry its own weight and will sag; it stands by itself from about {:.1e} Pa",
            object.name,
            auto.value_pa / 4.0
        ));
    }
    // Parts that need more to stand keep their share over the rest when the whole is made softer or stiffer.
    let nearest = proxy::nearest(&members, &solid.position_m);
    let share = |g: u32| if standing { auto.local[g as usize] / auto.value_pa as f32 } else { 1.0 };
    let young_local = nearest.iter().map(|&g| young_pa as f32 * share(g));
    let start = matter.bodies.mass_kg.len();
    let particles = &mut matter.particles;
    particles.position_m.extend(&solid.position_m);
    particles.velocity_m_s.extend(std::iter::repeat_n(Vec3::ZERO, count));
    particles.volume_m3.extend(&solid.volume_m3);
    particles.density_kg_m3.extend(std::iter::repeat_n(density as f32, count));
    particles.young_pa.extend(young_local);
    particles.poisson.extend(std::iter::repeat_n(elastic.poisson as f32, count));
    let row = particles.substances.len() as u16;
    particles.substances.push(Substance::Elastic(elastic.model));
    particles.substance.extend(std::iter::repeat_n(row, count));
    particles.object.extend(std::iter::repeat_n(index as u32, count));
    let mass: Vec<f32> = solid.volume_m3.iter().map(|v| v * density as f32).collect();
    let total: f64 = mass.iter().map(|&m| f64::from(m)).sum();
    let moment: glam::DVec3 = solid.position_m.iter().zip(&mass).map(|(p, &m)| p.as_dvec3() * f64::from(m)).sum();
    matter.bodies.ranges.push(start..start + count);
    matter.bodies.mass_kg.extend(mass);
    matter.bodies.volume_m3.extend(&solid.volume_m3);
    matter.young_pa.push(young_pa);
    matter.centre_m.push((moment / total.max(f64::MIN_POSITIVE)).as_vec3());
    matter.fill_ratio.push(f64::from(solid.fill_ratio));
    matter.gaussians.push(prepared.members(index as u32, true).len());
}
