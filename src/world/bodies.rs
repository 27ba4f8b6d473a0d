//! Solids given matter: what the solver and the measures need of each particle.

use super::Prepared;
use super::measure::Bodies;
use super::occupied::occupied_m3;
use super::prepared::NEAR_M;
use super::region::{self, bounds};
use super::stuff::{Stuff, Yardstick};
use crate::proxy::{self, Solid, YoungAuto};
use crate::solver::Particles;
use crate::spec::{Material, Object, Rest, Spec, Young};
use glam::Vec3;

/// Particles of all objects, one object after another, and what was decided about them.
#[derive(Clone, Debug)]
pub struct Matter {
    /// What the solver is given. Captured pose, at rest.
    pub particles: Particles,
    /// What the measures need.
    pub bodies: Bodies,
    /// Piece of its object that each particle belongs to: 0 is the object's own material, 1 its first part's.
    pub piece: Vec<u16>,
    /// What each piece of each object is at the start.
    pub stuffs: Vec<Vec<Stuff>>,
    /// What each of them is when it freezes.
    pub frozen: Vec<Vec<Stuff>>,
    /// Young's moduli that the spec left to the program, by path.
    pub young_auto: Vec<(String, f64)>,
    /// What each event of the spec makes of its object, in the spec's order; none where it changes no material.
    pub changes: Vec<Option<Stuff>>,
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

impl Matter {
    /// Whether any of it keeps no shape, now or after an event.
    pub fn sheds_shape(&self) -> bool {
        self.stuffs.iter().flatten().chain(self.changes.iter().flatten()).any(|stuff| stuff.substance.sheds_shape())
    }
}

/// Gives each object's solid its materials, one `Solid` for each object of the spec.
pub fn matter(spec: &Spec, prepared: &Prepared, solids: &[Solid]) -> Matter {
    let mut matter = Matter {
        particles: Particles::default(),
        bodies: Bodies {
            ranges: Vec::new(),
            mass_kg: Vec::new(),
            volume_m3: Vec::new(),
            found: Vec::new(),
            colliders: spec.colliders.clone(),
            ground_m: prepared.ground_m,
            // No more than a cell of what is small.
            near_m: solids.iter().map(|s| 2.0 * f64::from(s.spacing_m)).fold(NEAR_M, f64::min),
        },
        piece: Vec::new(),
        stuffs: Vec::new(),
        frozen: Vec::new(),
        young_auto: Vec::new(),
        changes: vec![None; spec.events.len()],
        centre_m: Vec::new(),
        fill_ratio: Vec::new(),
        gaussians: Vec::new(),
        warnings: Vec::new(),
        notes: Vec::new(),
    };
    for (index, solid) in solids.iter().enumerate() {
        add(&mut matter, spec, prepared, index, solid);
    }
    let loose = matter.sheds_shape();
    let found = solids.iter().map(|solid| if loose { found(solid) } else { 1.0 });
    matter.bodies.found.extend(found);
    matter
}

/// Share of a solid's volume that is found where its particles are.
fn found(solid: &Solid) -> f64 {
    let whole: f64 = solid.volume_m3.iter().map(|&v| f64::from(v)).sum();
    let share = occupied_m3(solid.position_m.iter().copied().zip(solid.volume_m3.iter().copied())) / whole;
    if share > 0.0 { share } else { 1.0 }
}

/// The piece that each particle belongs to. Of parts that overlap the later one has what both claim.
fn pieces(object: &Object, points: &[Vec3], warnings: &mut Vec<String>) -> Vec<u16> {
    let whole = bounds(points);
    let mut piece = vec![0u16; points.len()];
    for (index, part) in object.parts.iter().enumerate() {
        let mut taken = vec![0usize; index + 1];
        let mut any = false;
        for (owner, point) in piece.iter_mut().zip(points) {
            if region::holds(&part.region, *point, whole) {
                taken[usize::from(*owner)] += 1;
                *owner = index as u16 + 1;
                any = true;
            }
        }
        if !any {
            warnings.push(format!("{}: part {} holds no particle: its region is empty, or thinner than a cell", object.name, part.name));
        }
        for (other, count) in object.parts.iter().zip(&taken[1..]).filter(|(_, count)| **count > 0) {
            let (name, later) = (&other.name, &part.name);
            warnings.push(format!("{}: parts {name} and {later} overlap: {later}, the later one, has the {count} particles of both", object.name));
        }
    }
    piece
}

fn add(matter: &mut Matter, spec: &Spec, prepared: &Prepared, index: usize, solid: &Solid) {
    let object = &spec.objects[index];
    let members = prepared.gaussians.subset(&prepared.members(index as u32, false));
    let auto = proxy::young_auto(&solid.stance, object.material.density_kg_m3());
    let (low, high) = bounds(&solid.position_m);
    let yard =
        Yardstick { standing_pa: auto.value_pa, density_kg_m3: object.material.density_kg_m3(), height_m: height_m(low.z, high.z, solid.spacing_m) };
    let own = (format!("object.{}", object.name), &object.material);
    let parts = object.parts.iter().map(|part| (format!("object.{}.part.{}", object.name, part.name), &part.material));
    let mut stuffs = Vec::new();
    for (path, material) in std::iter::once(own).chain(parts) {
        stuffs.push(yard.stuff(material));
        resolve(matter, material, &stuffs[stuffs.len() - 1], &path);
    }
    for (number, event) in spec.events.iter().enumerate().filter(|(_, event)| event.object == object.name) {
        if let Some(material) = &event.material {
            let stuff = yard.stuff_throughout(material);
            resolve(matter, material, &stuff, &format!("event.{}", event.name));
            matter.changes[number] = Some(stuff);
        }
    }
    let standing = object.rest == Rest::AsCaptured;
    warn_of_softness(matter, object, &auto, stuffs[0].young_pa);

    let piece = pieces(object, &solid.position_m, &mut matter.warnings);
    let count = solid.position_m.len();
    // Places that need more to stand keep their share over the rest when the whole is made softer or stiffer.
    let nearest = proxy::nearest(&members, &solid.position_m);
    let heavier = |stuff: &Stuff| (stuff.density_kg_m3 / object.material.density_kg_m3()) as f32;
    let young_pa = |g: usize, material: &Material, stuff: &Stuff| match material.young_pa() {
        Some(Young::AtLeast(least_pa)) => (least_pa as f32).max(proxy::BEARING as f32 * auto.needs_pa[g] * heavier(stuff)),
        _ if standing && material.stands() => stuff.young_pa as f32 * (auto.local[g] / auto.value_pa as f32),
        _ => stuff.young_pa as f32,
    };
    let start = matter.bodies.mass_kg.len();
    let particles = &mut matter.particles;
    let first_row = particles.substances.len() as u16;
    particles.substances.extend(stuffs.iter().map(|stuff| stuff.substance.clone()));
    for (i, &p) in piece.iter().enumerate() {
        let stuff = &stuffs[usize::from(p)];
        let material = if p == 0 { &object.material } else { &object.parts[usize::from(p) - 1].material };
        particles.density_kg_m3.push(stuff.density_kg_m3 as f32);
        particles.young_pa.push(young_pa(nearest[i] as usize, material, stuff));
        particles.poisson.push(stuff.poisson as f32);
        particles.substance.push(first_row + p);
    }
    notes_of_bearing(matter, object, &piece, start);
    let particles = &mut matter.particles;
    particles.position_m.extend(&solid.position_m);
    particles.velocity_m_s.extend(std::iter::repeat_n(Vec3::ZERO, count));
    particles.volume_m3.extend(&solid.volume_m3);
    particles.object.extend(std::iter::repeat_n(index as u32, count));
    let mass: Vec<f32> = solid.volume_m3.iter().zip(&particles.density_kg_m3[start..]).map(|(v, density)| v * density).collect();
    let total: f64 = mass.iter().map(|&m| f64::from(m)).sum();
    let moment: glam::DVec3 = solid.position_m.iter().zip(&mass).map(|(p, &m)| p.as_dvec3() * f64::from(m)).sum();
    matter.bodies.ranges.push(start..start + count);
    matter.bodies.mass_kg.extend(mass);
    matter.bodies.volume_m3.extend(&solid.volume_m3);
    matter.piece.extend(piece);
    matter.frozen.push(stuffs.iter().map(|stuff| yard.frozen(stuff)).collect());
    matter.stuffs.push(stuffs);
    matter.centre_m.push((moment / total.max(f64::MIN_POSITIVE)).as_vec3());
    matter.fill_ratio.push(f64::from(solid.fill_ratio));
    matter.gaussians.push(prepared.members(index as u32, true).len());
}

/// Writes an automatic modulus down.
fn resolve(matter: &mut Matter, material: &Material, stuff: &Stuff, owner: &str) {
    if material.young_pa() == Some(Young::Auto) {
        matter.young_auto.push((format!("{owner}.material.young_pa"), stuff.young_pa));
    }
}

/// Says how stiff the pieces of an object, whose particles begin at `start`, became that are only as stiff as asked for where that
/// bears what they carry.
fn notes_of_bearing(matter: &mut Matter, object: &Object, piece: &[u16], start: usize) {
    let own = (object.name.clone(), &object.material);
    let parts = object.parts.iter().map(|part| (format!("{}, {}", object.name, part.name), &part.material));
    for (number, (name, material)) in std::iter::once(own).chain(parts).enumerate() {
        let Some(Young::AtLeast(least_pa)) = material.young_pa() else { continue };
        let young_pa = || piece.iter().zip(&matter.particles.young_pa[start..]).filter(|(p, _)| usize::from(**p) == number).map(|(_, &young)| young);
        let stiffer = young_pa().filter(|&young| young > 1.05 * least_pa as f32).count();
        if stiffer > 0 {
            let most_pa = f64::from(young_pa().fold(0.0, f32::max));
            let (least, most) = (proxy::pascals(least_pa), proxy::pascals(most_pa));
            let share = 100.0 * stiffer as f64 / young_pa().count() as f64;
            matter.notes.push(format!("{name}: is of {least}, and of up to {most} where that would not bear its weight ({share:.0} % of it)"));
        }
    }
}

/// Height of what has particles between two heights; of a single layer that of a particle.
fn height_m(low_m: f32, high_m: f32, spacing_m: f32) -> f64 {
    f64::from((high_m - low_m).max(spacing_m))
}

/// Says where an object that stands as captured cannot: an automatic modulus says so of itself.
fn warn_of_softness(matter: &mut Matter, object: &Object, auto: &YoungAuto, young_pa: f64) {
    if !object.material.stands() {
        return;
    }
    if object.material.young_pa() == Some(Young::Auto) {
        matter.warnings.extend(auto.warnings.iter().map(|w| format!("{}: {w}", object.name)));
        matter.notes.extend(auto.notes.iter().map(|n| format!("{}: {n}", object.name)));
    } else if matches!(object.material.young_pa(), Some(Young::Value(_))) && object.rest == Rest::AsCaptured && young_pa < auto.value_pa / 4.0 {
        matter.warnings.push(format!(
            "{}: with a stiffness of {:.3} kPa its most slender part cannot carry its own weight and will sag; it stands from about {:.0} kPa on, \
             \"stiffness {:.0} kPa\"",
            object.name,
            young_pa / 1e3,
            auto.value_pa / 4e3,
            auto.value_pa / 4e3
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Part, Region};

    #[test]
    fn later_parts_win_and_overlap_and_emptiness_are_said() {
        let part = |name: &str, region| Part { name: name.to_owned(), region, material: Material::default() };
        let mut object = Object::new("vase");
        object.parts = vec![part("flowers", Region::Above(0.5)), part("waist", Region::Above(0.25)), part("sky", Region::Above(1.0))];
        object.parts.push(part("nothing", Region::Sphere(crate::spec::SphereShape { centre_m: [9.0; 3], radius_m: 1.0 })));
        let points: Vec<Vec3> = (0..=8).map(|i| Vec3::Z * i as f32).collect();
        let mut warnings = Vec::new();
        assert_eq!(pieces(&object, &points, &mut warnings), [0, 0, 2, 2, 2, 2, 2, 2, 3]);
        let said = warnings.join("\n");
        assert!(
            said.contains("flowers and waist overlap: waist, the later one, has the 5 particles") && said.contains("part nothing holds no particle"),
            "{said}"
        );
    }
}
