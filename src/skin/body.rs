//! What is seen of matter that keeps no shape. Once particles part from those that were around them, they are drawn
//! themselves: a Gaussian each (of grains several), of the particle's volume, shaped by how its neighbours lie, coloured by the captured
//! Gaussians that were nearest to it and, where it flows, by what it is stirred into.

mod clear;
mod dye;
#[cfg(test)]
mod tests;
#[cfg(test)]
pub(super) mod twin;

use super::Splats;
use super::neighbours::{Tree, nearest_of_all};
use super::skinner::{self, AFFINE, ROTATION, groups};
use crate::gpu::{Access, Constant, Extent, Gpu, GpuError, Kernel, KernelSource, RadixSort, Recording, SortBuffers};
use crate::scene::Gaussians;
use crate::solver::Substance;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::collections::BTreeMap;

/// Particles that see each other are so near, in spacings.
pub const REACH: f32 = 2.5;
/// Particles whose leaving is watched, of each.
pub const BESIDE: u32 = 8;
/// Spacings that one of them is farther than it was when it begins to have left, and when it has.
pub const GONE: [f32; 2] = [0.4, 1.0];
/// The same of grains, which are seen to slide past each other.
pub const GRAINS_GONE: [f32; 2] = [0.15, 0.5];
/// Share of them that has left at which a particle begins to be seen, and has wholly parted.
pub const PARTED: [f32; 2] = [0.02, 0.25];
/// Standard deviation of a drop's Gaussian over the particle's size: at half of its opacity it ends where a ball of the volume does.
pub const RADIUS: f32 = 0.53;
/// A grain's over a drop's, so that grains stay apart to the eye.
pub const GRAIN: f32 = 0.9;
/// Size over the whole when it begins to be seen.
pub const YOUNG: f32 = 0.6;
/// How far parted it is when it is as opaque as it gets, and how opaque that is.
pub const SEEN: f32 = 0.3;
/// Opacity of what is drawn.
pub const OPACITY: f32 = 0.97;
/// Share of the volume around it that is a particle's own: from the first number on it begins to be alone, at the second it is.
pub const ALONE: [f32; 2] = [0.5, 0.9];
/// Volume around a particle of a sheet and of a thread of single particles a spacing apart, over its own: the integrals of
/// (1 - r^2)^3 over a disc and a line of [`REACH`] spacings.
pub const SHEET: f32 = std::f32::consts::FRAC_PI_4 * REACH * REACH;
/// See [`SHEET`].
pub const THREAD: f32 = 0.914_285_7 * REACH;
/// The same of a body: the integral over a ball.
pub const BALL: f32 = 0.638_291_3 * REACH * REACH * REACH;
/// Ratio of the two largest spreads up to which it is a thread, and from which it is not.
pub const BROAD: [f32; 2] = [0.3, 0.7];
/// A Gaussian becomes at most so many times wider, however its neighbours part.
pub const WIDEST: f32 = 3.5;
/// And no thinner than this share of its radius.
pub const THINNEST: f32 = 0.15;
/// Share of the volume around it that is its own from which on what lies up to two reaches away counts too, and alone counts.
pub const FEW: [f32; 2] = [0.22, 0.4];
/// The middle of what is around a particle of a surface lies so far from it, in reaches: 0.246 if the surface passed through it,
/// less as it lies half a spacing below.
pub const SKIN: f32 = 0.14;
/// The mean of such middles over its neighbours, from which on it may lie at a surface, and at which it does: by how particles
/// happen to lie it is a few hundredths inside.
pub const LEAN: [f32; 2] = [0.03, 0.09];
/// At a surface it is so much wider and thinner, so that it is even.
pub const FLAT: f32 = 1.25;
/// Share by which what sticks out of a surface is drawn in.
pub const EVEN: f32 = 0.8;
/// Ratio of the two least spreads, squared, up to which it is a sheet whose way out is across it, and from which it is a body's surface.
pub const THIN: [f32; 2] = [0.08, 0.25];
/// Grains differ in tone by this share at most.
pub const TONE: f32 = 0.14;
/// And in size: the least and the largest over the mean one.
pub const GRAINS: [f32; 2] = [0.55, 1.3];
/// A grain lies so far at most from its particle along each axis, in sizes: particles begin on a lattice, grains do not.
pub const ASTRAY: f32 = 0.75;
/// Weight of its own colour among those of its neighbours that a particle is stirred into, by its volume 1.
pub const OWN_COLOUR: f32 = 0.3;
/// How much a surface of a paste, a thick and a clear liquid shines, over a mirror's share.
pub const GLOSS: [f32; 3] = [0.5, 2.0, 1.5];
/// Of what lies loosely a Gaussian becomes at most so many times larger.
pub const LOOSEST: f32 = 1.8;
/// How much wider a clear liquid's are.
pub const WIDER: f32 = 1.3;
/// Gaussians of a clear liquid's layer that lie over each other: 2 pi times their variance over a spacing's square.
pub const LAYERED: f32 = std::f32::consts::TAU * (RADIUS * FLAT * WIDER) * (RADIUS * FLAT * WIDER);
/// Length over which one of a clear liquid dims what is behind it by a factor of e, metres.
pub const FREE_M: f32 = 0.04;
/// How far a clear liquid's colour goes towards white, in a body and as a drop.
pub const PALE: [f32; 2] = [0.35, 0.8];
/// Opacity of a clear drop, and its size over that of its volume.
pub const DROP: [f32; 2] = [0.35, 0.75];
/// At most so many Gaussians are drawn of a particle of grains.
pub const GRAINS_EACH: u32 = 3;
/// And of all of them, unless there are more particles.
pub const GRAINS_MOST: usize = 600_000;
/// Of one key no more particles are looked at.
const CROWD: u32 = 512;
/// Captured Gaussians that a particle has its colour from.
const COLOURS: usize = 16;
/// The first spherical harmonic: a colour is 0.5 and this times its coefficient.
pub(super) const SH_FIRST: f32 = 0.282_094_8;

/// What both the host and the passes know.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Immediates {
    origin: [f32; 3],
    count: u32,
    reach_m: f32,
    spacing_m: f32,
    first: u32,
    mask: u32,
    grains: u32,
    padding: [u32; 3],
}

/// The particles of a scene as they are drawn.
#[derive(Clone, Debug, Default)]
pub struct Filling {
    /// Captured positions, metres, world.
    pub rest_m: Vec<Vec3>,
    /// Colour of each, display-referred, from all sides alike, and its size in metres.
    pub tint: Vec<[f32; 4]>,
    /// What each adds to the colour of what it flows with: that of its surroundings. And how clear it is as a liquid, 0 to 1.
    pub dye: Vec<[f32; 4]>,
    /// [`BESIDE`] nearest particles of each of the same object; itself where there are fewer.
    pub beside: Vec<u32>,
    /// Distance between particles where they fill the room, metres.
    pub spacing_m: f32,
    /// Gaussians of each: the last so many times the particles of those that are drawn.
    pub grains: u32,
}

impl Filling {
    /// Of particles in the captured pose, with their volumes and the objects they belong to.
    pub fn new(gaussians: &Gaussians, object_of: &[u32], rest_m: &[Vec3], volume_m3: &[f32], object: &[u32]) -> Filling {
        let spacing_m = spacing_m(volume_m3);
        let mut filling = Filling {
            rest_m: rest_m.to_vec(),
            tint: vec![[0.0; 4]; rest_m.len()],
            dye: vec![[0.0; 4]; rest_m.len()],
            beside: Vec::new(),
            spacing_m,
            grains: 1,
        };
        filling.beside = (0..rest_m.len() as u32).flat_map(|i| std::iter::repeat_n(i, BESIDE as usize)).collect();
        let mut own: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        (0..rest_m.len()).for_each(|i| own.entry(object[i]).or_default().push(i));
        for (object, own) in own {
            let seen = (0..gaussians.len()).filter(|&g| object_of[g] == object).map(|g| (gaussians.mean[g], g as u32));
            filling.watch(&own);
            filling.colour(&own, Tree::new(seen.collect()), gaussians);
            let dye = dye::mix(&filling, &own);
            own.iter().zip(dye).for_each(|(&i, colour)| filling.dye[i] = colour.extend(0.0).to_array());
        }
        for (tint, volume) in filling.tint.iter_mut().zip(volume_m3) {
            tint[3] = volume.max(0.0).cbrt().clamp(0.4 * spacing_m, 1.5 * spacing_m);
        }
        filling
    }

    /// Of what the particles are made of, and what they may become: how clear that is, and whether it is grains.
    pub fn made_of(mut self, substances: impl Iterator<Item = Substance>, later: &[Substance]) -> Filling {
        let later_clear = later.iter().find_map(clear::clearness);
        let mut grains = later.iter().any(clear::is_grains);
        for (dye, substance) in self.dye.iter_mut().zip(substances) {
            dye[3] = clear::clearness(&substance).or(later_clear).unwrap_or(0.0);
            grains |= clear::is_grains(&substance);
        }
        if grains {
            self.grains = ((GRAINS_MOST / self.rest_m.len().max(1)) as u32).clamp(1, GRAINS_EACH);
        }
        self
    }

    /// Finds the particles that are next to each of an object's.
    fn watch(&mut self, own: &[usize]) {
        let places: Vec<Vec3> = own.iter().map(|&i| self.rest_m[i]).collect();
        let tree = Tree::new(own.iter().map(|&i| (self.rest_m[i], i as u32)).collect());
        for (&i, nearest) in own.iter().zip(nearest_of_all(&tree, &places, BESIDE as usize + 1)) {
            let others = nearest.found().iter().map(|found| found.1).filter(|&j| j != i as u32);
            let slots = &mut self.beside[i * BESIDE as usize..(i + 1) * BESIDE as usize];
            slots.iter_mut().zip(others).for_each(|(slot, j)| *slot = j);
        }
    }

    /// Gives an object's particles the colours of what was captured nearest to them.
    fn colour(&mut self, own: &[usize], seen: Tree, gaussians: &Gaussians) {
        let places: Vec<Vec3> = own.iter().map(|&i| self.rest_m[i]).collect();
        let floats = gaussians.sh_coefficients() * 3;
        let near2 = self.spacing_m * self.spacing_m + f32::MIN_POSITIVE;
        for (&i, nearest) in own.iter().zip(nearest_of_all(&seen, &places, COLOURS)) {
            let (mut sum, mut total) = (Vec3::ZERO, 0.0);
            for &(d2, g) in nearest.found() {
                let weight = gaussians.opacity[g as usize] / (d2 + near2);
                let seen = Vec3::from_slice(&gaussians.sh[g as usize * floats..]) * SH_FIRST + 0.5;
                sum += seen.max(Vec3::ZERO) * weight;
                total += weight;
            }
            let colour = if total > 0.0 { sum / total } else { Vec3::ZERO };
            self.tint[i][..3].copy_from_slice(&colour.to_array());
        }
    }
}

/// The size that nine of ten particles do not pass: thin places are sampled with less.
fn spacing_m(volume_m3: &[f32]) -> f32 {
    let mut volumes = volume_m3.to_vec();
    let at = volumes.len() * 9 / 10;
    if volumes.is_empty() { 0.0 } else { volumes.select_nth_unstable_by(at, f32::total_cmp).1.cbrt().max(f32::MIN_POSITIVE) }
}

/// The passes and what they keep.
#[derive(Debug)]
pub(super) struct Body {
    place: Kernel,
    order: Kernel,
    stir: Kernel,
    stir_bindings: wgpu::BindGroup,
    shape: Kernel,
    shape_bindings: wgpu::BindGroup,
    sort: Recording,
    buffers: SortBuffers,
    /// Which of the sort's buffers is sorted.
    to: usize,
    beside: wgpu::Buffer,
    /// How far each particle has parted from those that were around it, 0 to 1.
    pub parted: wgpu::Buffer,
    spans: wgpu::Buffer,
    sorted: wgpu::Buffer,
    tint: wgpu::Buffer,
    dye: wgpu::Buffer,
    immediates: Immediates,
}

impl Body {
    /// The last Gaussians of `splats` are those of the particles.
    pub fn new(gpu: &Gpu, splats: &Splats, filling: &Filling, origin: Vec3) -> Result<Body, GpuError> {
        let count = filling.rest_m.len() as u32;
        let places = (2 * count).next_power_of_two().max(64);
        let radix = RadixSort::new(gpu);
        let buffers = radix.buffers(gpu, "skin.body_sort", count)?;
        let extent = Extent::known(gpu, "skin.body_extent", count, &radix.blocks)?;
        let plan = radix.plan(gpu, &buffers, &extent, places.trailing_zeros() + 1);
        let spans = gpu.storage::<[u32; 2]>("skin.spans", places as usize)?;
        let sorted = gpu.storage::<[u32; 8]>("skin.sorted", count as usize)?;
        let blended = gpu.storage::<[f32; 8]>("skin.blended", count as usize)?;
        let [place, order, stir, shape] = sources().map(|source| gpu.kernel(&source));
        let to = plan.sorted;
        let (keys, values) = (&buffers.keys[to], &buffers.values[to]);
        Ok(Body {
            stir_bindings: gpu.bind(&stir, &[keys, &spans, &sorted, &blended]),
            shape_bindings: gpu.bind(&shape, &[keys, values, &spans, &sorted, &blended, &splats.geometry, &splats.sh]),
            place,
            order,
            stir,
            shape,
            sort: plan.recording,
            buffers,
            to,
            beside: gpu.storage_from("skin.beside", &filling.beside)?,
            parted: gpu.storage::<f32>("skin.parted", count as usize)?,
            spans,
            sorted,
            tint: gpu.storage_from("skin.tint", &filling.tint)?,
            dye: gpu.storage_from("skin.dye", &filling.dye)?,
            immediates: Immediates {
                origin: origin.to_array(),
                count,
                reach_m: REACH * filling.spacing_m,
                spacing_m: filling.spacing_m,
                first: splats.count - count * filling.grains.max(1),
                mask: places - 1,
                grains: filling.grains.max(1),
                padding: [0; 3],
            },
        })
    }

    /// Adds the passes that read `motion` and write the Gaussians of the particles. `rest_particles` are their captured places.
    pub fn record(&self, gpu: &Gpu, motion: &wgpu::Buffer, rest_particles: &wgpu::Buffer, recording: &mut Recording) {
        let (keys, values) = (&self.buffers.keys, &self.buffers.values);
        let run = |recording: &mut Recording, kernel: &Kernel, bindings: &wgpu::BindGroup| {
            recording.dispatch_with(kernel, bindings, &self.immediates, groups(self.immediates.count));
        };
        let place = gpu.bind(&self.place, &[motion, rest_particles, &self.beside, &keys[0], &values[0], &self.parted]);
        run(recording, &self.place, &place);
        recording.extend(&self.sort);
        recording.clear(&self.spans);
        let order = [&keys[self.to], &values[self.to], motion, &self.tint, &self.dye, &self.parted, &self.spans, &self.sorted];
        let order = gpu.bind(&self.order, &order);
        run(recording, &self.order, &order);
        run(recording, &self.stir, &self.stir_bindings);
        run(recording, &self.shape, &self.shape_bindings);
    }
}

macro_rules! part {
    ($name:literal) => {
        (concat!("skin/", $name, ".wgsl"), include_str!(concat!("../../shaders/skin/", $name, ".wgsl")))
    };
}

/// The passes, in the order in which they run; between the first two keys are sorted.
pub(super) fn sources() -> [KernelSource; 4] {
    use Access::{Read, Write};
    let pass = |label, parts: &[(&'static str, &'static str)], bindings| KernelSource {
        label,
        entry: "main",
        parts: [&[part!("body")], parts].concat(),
        constants: constants(),
        bindings,
        immediate_bytes: size_of::<Immediates>() as u32,
    };
    [
        pass("skin.body_place", &[AFFINE, part!("body_place")], vec![Read, Read, Read, Write, Write, Write]),
        pass("skin.body_order", &[AFFINE, part!("body_order")], vec![Read, Read, Read, Read, Read, Read, Write, Write]),
        pass("skin.body_stir", &[part!("body_stir")], vec![Read, Read, Read, Write]),
        pass("skin.body_shape", &[ROTATION, part!("principal"), part!("body_shape")], vec![Read, Read, Read, Read, Read, Write, Write]),
    ]
}

fn constants() -> Vec<(&'static str, Constant)> {
    let numbers = [
        ("GONE_LOW", GONE[0]),
        ("GONE_HIGH", GONE[1]),
        ("GRAINS_GONE_LOW", GRAINS_GONE[0]),
        ("GRAINS_GONE_HIGH", GRAINS_GONE[1]),
        ("FEW_LOW", FEW[0]),
        ("FEW_HIGH", FEW[1]),
        ("THINNEST", THINNEST),
        ("PARTED_LOW", PARTED[0]),
        ("PARTED_HIGH", PARTED[1]),
        ("RADIUS", RADIUS),
        ("GRAIN", GRAIN),
        ("YOUNG", YOUNG),
        ("SEEN", SEEN),
        ("OPACITY", OPACITY),
        ("ALONE_LOW", ALONE[0]),
        ("ALONE_HIGH", ALONE[1]),
        ("SHEET", SHEET),
        ("THREAD", THREAD),
        ("BROAD_LOW", BROAD[0]),
        ("BROAD_HIGH", BROAD[1]),
        ("WIDEST", WIDEST),
        ("SKIN", SKIN),
        ("LEAN_LOW", LEAN[0]),
        ("LEAN_HIGH", LEAN[1]),
        ("FLAT", FLAT),
        ("EVEN", EVEN),
        ("THIN_LOW", THIN[0]),
        ("THIN_HIGH", THIN[1]),
        ("OWN_COLOUR", OWN_COLOUR),
        ("BALL", BALL),
        ("LOOSEST", LOOSEST),
        ("WIDER", WIDER),
        ("LAYERED", LAYERED),
        ("FREE_M", FREE_M),
        ("PALE", PALE[0]),
        ("DROP_PALE", PALE[1]),
        ("DROP_OPACITY", DROP[0]),
        ("DROP_SIZE", DROP[1]),
        ("GLOSS_CLEAR", GLOSS[2]),
        ("SH_FIRST", SH_FIRST),
        ("TONE", TONE),
        ("GRAINS_LOW", GRAINS[0]),
        ("GRAINS_HIGH", GRAINS[1]),
        ("ASTRAY", ASTRAY),
        ("GLOSS_PASTE", GLOSS[0]),
        ("GLOSS_LIQUID", GLOSS[1]),
    ];
    let mut all = skinner::constants();
    all.extend(numbers.map(|(name, value)| (name, Constant::F32(value))));
    all.extend([("BESIDE", Constant::U32(BESIDE)), ("CROWD", Constant::U32(CROWD))]);
    all
}
