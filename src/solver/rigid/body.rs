//! Which particles make a body, and what the passes know of it.
//!
//! The rigid particles of one object and one row of the table, which is one part, are one body. Parts
//! of one object that touch are welded: they are one body too.

use super::field::{Cloud, Field};
use crate::solver::constants::{RIGID_BODIES, RIGID_FIELD, RIGID_LANES, RIGID_POINTS, RIGID_QUANTUM_M, RIGID_SLOTS};
use crate::solver::obstacles::{ColliderRecord, distance_m};
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use crate::solver::types::SolverError;
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, IVec3, Mat3, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// `Body` of `shaders/solver/rigid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(in crate::solver) struct Body {
    pub centre_m: [f32; 4],
    pub metre: [i32; 4],
    pub whole: [i32; 4],
    /// w: how far inside its support it stood when it was made, 0 or less.
    pub low_m: [f32; 4],
    pub turn: [f32; 4],
    pub velocity_m_s: [f32; 4],
    pub angular_momentum: [f32; 4],
}

impl Body {
    /// Puts the centre at a place.
    pub fn put(&mut self, centre_m: Vec3) {
        let metre = centre_m.floor();
        let whole = ((centre_m - metre) / RIGID_QUANTUM_M).round();
        (self.metre, self.whole) = (metre.as_ivec3().extend(0).into(), whole.as_ivec3().extend(0).into());
        self.low_m = (centre_m - metre - whole * RIGID_QUANTUM_M).extend(self.low_m[3]).into();
        self.centre_m = centre_m.extend(0.0).into();
    }
}

/// `Shape` of `shaders/solver/rigid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(in crate::solver) struct Shape {
    /// Columns; w of the first is the mass.
    pub inertia: [[f32; 4]; 3],
    pub inverse: [[f32; 4]; 3],
    pub low_m: [f32; 3],
    pub voxel_m: f32,
    pub size: [u32; 3],
    pub first_coefficient: u32,
    pub first_point: u32,
    pub points: u32,
    pub radius_m: f32,
    pub apart_m: f32,
    pub friction: f32,
    pub restitution: f32,
    pub object: u32,
    pub bonded: u32,
    pub first_chunk: u32,
    pub chunks: u32,
    pub padding: [u32; 2],
}

impl Shape {
    /// Inertia tensor about the centre, body frame.
    pub fn inertia(&self) -> Mat3 {
        Mat3::from_cols_slice(&self.inertia.map(|c| [c[0], c[1], c[2]]).concat())
    }

    /// Its inverse.
    pub fn inverse(&self) -> Mat3 {
        Mat3::from_cols_slice(&self.inverse.map(|c| [c[0], c[1], c[2]]).concat())
    }

    pub fn mass_kg(&self) -> f32 {
        self.inertia[0][3]
    }
}

/// Of a particle that no body moves.
const NO_ANCHOR: [f32; 4] = [0.0, 0.0, 0.0, f32::from_bits(u32::MAX)];

/// All bodies of a scene as they start.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Assembly {
    pub bodies: Vec<Body>,
    pub shapes: Vec<Shape>,
    /// Of all surfaces, body frame.
    pub points: Vec<[f32; 4]>,
    pub coefficients: Vec<f32>,
    /// Place in the body frame of each particle in the original order, and the bits of its body's number; see
    /// [`NO_ANCHOR`].
    pub anchors: Vec<[f32; 4]>,
    pub fields: Vec<Field>,
    /// Particles near the surface: place in the body frame and mass; each body's fill whole chunks.
    pub members: Vec<[f32; 4]>,
    /// The body of each chunk.
    pub owners: Vec<u32>,
    /// Smallest radius of any body.
    pub least_m: f32,
}

/// What one body is made of, before it has a place among the others.
struct Made {
    shape: Shape,
    field: Field,
    points: Vec<Vec3>,
}

/// The bodies that the particles make; none without rigid particles. Their frame is the world's as it is.
pub(in crate::solver) fn assemble(
    states: &[ParticleState],
    substances: &[Substance],
    colliders: &[ColliderRecord],
    cell_m: f32,
) -> Result<Option<Assembly>, SolverError> {
    let groups = groups(states, cell_m);
    if groups.is_empty() {
        return Ok(None);
    }
    if groups.len() > RIGID_BODIES as usize {
        let what = format!("{} rigid bodies", groups.len());
        return Err(SolverError::Input { what, expected: format!("at most {RIGID_BODIES}") });
    }
    let mut anchors = vec![NO_ANCHOR; states.len()];
    let mut centres_m = Vec::new();
    for (index, members) in groups.iter().enumerate() {
        let centre_m = mean(states, members, |s| s.position_m).as_vec3();
        members.iter().for_each(|&i| anchors[i] = (states[i].position_m - centre_m).extend(f32::from_bits(index as u32)).into());
        centres_m.push(centre_m);
    }
    let mut all = build(anchors, groups.len(), states, substances, cell_m);
    for ((body, members), centre_m) in groups.iter().enumerate().zip(centres_m) {
        all.start(body, members, centre_m, states, colliders);
    }
    Ok(Some(all))
}

/// The bodies whose particles have these places in their frames, wherever they are now: all but how they move.
pub(in crate::solver) fn build(anchors: Vec<[f32; 4]>, count: usize, states: &[ParticleState], substances: &[Substance], cell_m: f32) -> Assembly {
    let groups = members(&anchors, count);
    let most = (RIGID_FIELD as usize / count).clamp(32 * 32 * 32, 96 * 96 * 96);
    let made: Vec<Made> = groups.par_iter().map(|members| make(states, members, &anchors, substances, most)).collect();
    let mut all = Assembly { anchors, least_m: f32::INFINITY, ..Default::default() };
    for (index, (made, members)) in made.into_iter().zip(&groups).enumerate() {
        let mut shape = made.shape;
        (shape.first_coefficient, shape.first_point) = (all.coefficients.len() as u32, all.points.len() as u32);
        shape.bonded = u32::from(states.iter().any(|s| s.object() == shape.object && !s.is_rigid()));
        all.add_members(&mut shape, index as u32, &made, states, members, cell_m);
        all.points.extend(made.points.iter().map(|p| p.extend(0.0).to_array()));
        all.coefficients.extend(&made.field.coefficients);
        all.least_m = all.least_m.min(shape.radius_m);
        all.bodies.push(Body { turn: [0.0, 0.0, 0.0, 1.0], ..Default::default() });
        all.shapes.push(shape);
        all.fields.push(made.field);
    }
    all
}

/// The particles of each of `count` bodies, by what anchors them.
pub(super) fn members(anchors: &[[f32; 4]], count: usize) -> Vec<Vec<usize>> {
    let mut groups = vec![Vec::new(); count];
    for (i, anchor) in anchors.iter().enumerate() {
        if let Some(members) = groups.get_mut(anchor[3].to_bits() as usize) {
            members.push(i);
        }
    }
    groups
}

/// Friction and restitution of what some particles are made of: their means by mass.
pub(super) fn surface(states: &[ParticleState], members: &[usize], substances: &[Substance]) -> (f32, f32) {
    let (mut mass, mut friction, mut restitution) = (0.0, 0.0, 0.0);
    for state in members.iter().map(|&i| &states[i]) {
        let kg = f64::from(state.mass_kg);
        let (rough, lively) = substances[state.substance()].rigid().unwrap_or_default();
        (mass, friction, restitution) = (mass + kg, friction + kg * f64::from(rough), restitution + kg * f64::from(lively));
    }
    ((friction / mass) as f32, (restitution / mass) as f32)
}

impl Assembly {
    /// Puts a body where its particles are, as they move.
    fn start(&mut self, body: usize, members: &[usize], centre_m: Vec3, states: &[ParticleState], colliders: &[ColliderRecord]) {
        let shape = &self.shapes[body];
        let velocity_m_s = mean(states, members, |s| s.velocity_m_s);
        // What the particles' places alone carry; the rest turns with them.
        let (mut places, mut angular) = (DMat3::ZERO, DVec3::ZERO);
        for &i in members {
            let (m, r) = (f64::from(states[i].mass_kg), Vec3::from_slice(&self.anchors[i]).as_dvec3());
            places += around(r) * m;
            angular += r.cross(states[i].velocity_m_s.as_dvec3()) * m;
        }
        let momentum = shape.inertia().as_dmat3() * solved(places, angular);
        let points = &self.points[shape.first_point as usize..(shape.first_point + shape.points) as usize];
        let deepest_m = points.iter().map(|p| distance_m(colliders, Vec3::from_slice(p) + centre_m)).fold(0.0, f32::min);
        let started = &mut self.bodies[body];
        started.low_m[3] = deepest_m.max(-shape.voxel_m);
        started.put(centre_m);
        started.velocity_m_s = velocity_m_s.as_vec3().extend(0.0).into();
        started.angular_momentum = momentum.as_vec3().extend(0.0).into();
    }

    /// Lists the particles that soft matter may meet: those within two cells of the surface.
    fn add_members(&mut self, shape: &mut Shape, body: u32, made: &Made, states: &[ParticleState], particles: &[usize], cell_m: f32) {
        shape.first_chunk = self.owners.len() as u32;
        if states.iter().all(ParticleState::is_rigid) {
            return;
        }
        let places = particles.iter().map(|&i| (Vec3::from_slice(&self.anchors[i]), states[i].mass_kg));
        let near: Vec<_> = places.filter(|(p, _)| made.field.at(*p).distance_m > -2.0 * cell_m).map(|(p, kg)| p.extend(kg).to_array()).collect();
        self.members.extend(near);
        self.members.resize(self.members.len().next_multiple_of(RIGID_LANES as usize), [0.0; 4]);
        self.owners.resize(self.members.len() / RIGID_LANES as usize, body);
        shape.chunks = self.owners.len() as u32 - shape.first_chunk;
    }
}

/// Members of each body, by their index: tags that touch within an object are one.
fn groups(states: &[ParticleState], cell_m: f32) -> Vec<Vec<usize>> {
    let mut by_tag: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, s) in states.iter().enumerate().filter(|(_, s)| s.is_of_body()) {
        by_tag.entry(s.object() << 16 | s.substance() as u32).or_default().push(i);
    }
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut open: Option<u32> = None;
    let mut first = 0;
    for (tag, members) in by_tag {
        if open != Some(tag >> 16) {
            (open, first) = (Some(tag >> 16), groups.len());
        }
        // Every earlier body of the object that this part touches joins it.
        let (welded, apart): (Vec<_>, Vec<_>) = groups.drain(first..).partition(|other| touching(states, other, &members, cell_m));
        let mut whole: Vec<usize> = welded.into_iter().flatten().chain(members).collect();
        whole.sort_unstable();
        groups.extend(apart);
        groups.push(whole);
    }
    groups
}

/// Whether two sets of particles come closer than three quarters of a cell, one and a half spacings.
fn touching(states: &[ParticleState], one: &[usize], other: &[usize], cell_m: f32) -> bool {
    let cell = |i: &usize| (states[*i].position_m / cell_m).floor().as_ivec3();
    let mut hash: HashMap<IVec3, Vec<usize>> = HashMap::new();
    one.iter().for_each(|i| hash.entry(cell(i)).or_default().push(*i));
    let around = (0..27).map(|k| IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)).collect::<Vec<_>>();
    other.iter().any(|i| {
        let near = around.iter().filter_map(|step| hash.get(&(cell(i) + *step))).flatten();
        near.into_iter().any(|j| states[*i].position_m.distance(states[*j].position_m) < 0.75 * cell_m)
    })
}

fn make(states: &[ParticleState], members: &[usize], anchors: &[[f32; 4]], substances: &[Substance], most: usize) -> Made {
    let mass: f64 = members.iter().map(|&i| f64::from(states[i].mass_kg)).sum();
    let points_m: Vec<Vec3> = members.iter().map(|&i| Vec3::from_slice(&anchors[i])).collect();
    let volumes_m3: Vec<f32> = members.iter().map(|&i| states[i].volume_m3).collect();
    let mut inertia = DMat3::ZERO;
    for (s, r) in members.iter().map(|&i| &states[i]).zip(&points_m) {
        // Each particle is a cube of its volume.
        let own = f64::from(s.volume_m3).powf(2.0 / 3.0) / 6.0;
        inertia += (around(r.as_dvec3()) + DMat3::from_diagonal(DVec3::splat(own))) * f64::from(s.mass_kg);
    }
    let field = Field::of(&Cloud { points_m: &points_m, volumes_m3: &volumes_m3, spacing_m: spacing_m(&volumes_m3) }, most);
    let (points, apart_m) = field.surface(RIGID_POINTS as usize);
    let (friction, restitution) = surface(states, members, substances);
    let shape = Shape {
        inertia: columns(inertia.as_mat3(), mass as f32),
        inverse: columns(inertia.inverse().as_mat3(), 0.0),
        low_m: field.low_m.into(),
        voxel_m: field.voxel_m,
        size: field.size.into(),
        points: points.len() as u32,
        radius_m: points.iter().chain(&points_m).map(|p| p.length()).fold(0.5 * field.voxel_m, f32::max),
        apart_m,
        friction,
        restitution,
        object: states[members[0]].object(),
        ..Default::default()
    };
    Made { shape, field, points }
}

/// Of some particles, by mass.
fn mean(states: &[ParticleState], members: &[usize], of: impl Fn(&ParticleState) -> Vec3) -> DVec3 {
    let mass: f64 = members.iter().map(|&i| f64::from(states[i].mass_kg)).sum();
    members.iter().map(|&i| of(&states[i]).as_dvec3() * f64::from(states[i].mass_kg)).sum::<DVec3>() / mass
}

/// Inertia about the origin of a unit of mass.
fn around(r: DVec3) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(r.length_squared())) - DMat3::from_cols(r * r.x, r * r.y, r * r.z)
}

/// inertia^-1 L; zero about axes along which all lies on a line.
fn solved(inertia: DMat3, angular: DVec3) -> DVec3 {
    let scale = (inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z) / 3.0;
    if inertia.determinant() > 1e-9 * scale.powi(3) { inertia.inverse() * angular } else { DVec3::ZERO }
}

/// Edge of a whole particle: nine tenths are not larger.
fn spacing_m(volumes_m3: &[f32]) -> f32 {
    let mut sorted = volumes_m3.to_vec();
    let at = (sorted.len() - 1) * 9 / 10;
    sorted.select_nth_unstable_by(at, f32::total_cmp).1.cbrt()
}

fn columns(m: Mat3, w: f32) -> [[f32; 4]; 3] {
    [m.x_axis.extend(w).into(), m.y_axis.extend(0.0).into(), m.z_axis.extend(0.0).into()]
}

/// `Manifold` of `shaders/solver/rigid.wgsl`: where one body meets one other thing.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(in crate::solver) struct Manifold {
    pub other: u32,
    pub count: u32,
    pub colour: u32,
    pub padding: u32,
    pub friction: f32,
    pub restitution: f32,
    pub spare: [f32; 2],
}

/// `Contact` of `shaders/solver/rigid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(in crate::solver) struct Contact {
    /// In the frame of the body; w the gap.
    pub local: [f32; 4],
    /// Away from the other; w the speed of approach before the contact acted.
    pub normal: [f32; 4],
    pub arm: [f32; 4],
    pub arm_other: [f32; 4],
    pub grip: [f32; 4],
    /// Along the surface; w along the normal.
    pub impulse: [f32; 4],
}

/// Manifolds of all bodies.
pub(in crate::solver) fn slots(bodies: usize) -> usize {
    bodies * RIGID_SLOTS as usize
}
