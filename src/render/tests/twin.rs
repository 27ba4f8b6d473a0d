//! Each pass in plain Rust, in f32 and in the order of the shader, compared with what the device wrote.
//! A pass is given what the device's earlier passes wrote, so that each is checked alone.

use super::scenes::{cloud, front, upload};
use crate::gpu::{Gpu, Recording, Tier};
use crate::render::profile::{CORRELATION_MAX, DEPTH_BITS, EXPONENT_SLACK, FAR, OPACITY_MAX, REACH_SLACK, VARIANCE_MAX};
use crate::render::uniform::Uniform;
use crate::render::{Profile, RenderOptions, Renderer};
use bytemuck::{Pod, Zeroable};
use glam::{DQuat, Quat, Vec2, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles};

/// `struct Splat` and `struct Cover` of the shaders.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct Splat {
    shape: Vec4,
    weight: Vec4,
    colour: Vec4,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
struct Cover {
    corner: u32,
    size: u32,
    hits: u32,
    depth: u32,
}

const NO_COVER: Cover = Cover { corner: 0, size: 0, hits: 0, depth: 0 };

impl Cover {
    fn bins(&self) -> u32 {
        (self.size & 0xffff) * (self.size >> 16)
    }

    fn touched(&self) -> u32 {
        if self.bins() <= 32 { self.hits.count_ones() } else { self.hits }
    }
}

fn exponent(splat: &Splat, p: Vec2) -> f32 {
    let (d, s, w) = (p - splat.shape.xy(), splat.shape, splat.weight);
    w.y - (s.z * d.x * d.x + w.x * d.y * d.y + s.w * d.x * d.y)
}

fn largest_exponent(splat: &Splat, first: Vec2, last: Vec2) -> f32 {
    let nearest = splat.shape.xy().clamp(first, last);
    let d = nearest - splat.shape.xy();
    let on_column = Vec2::new(nearest.x, (splat.shape.y + splat.weight.z * d.x).clamp(first.y, last.y));
    let on_row = Vec2::new((splat.shape.x + splat.weight.w * d.y).clamp(first.x, last.x), nearest.y);
    exponent(splat, on_column).max(exponent(splat, on_row))
}

fn reaches(frame: &Uniform, splat: &Splat, x: u32, y: u32) -> bool {
    let first = Vec2::new((x << frame.bin_shift) as f32, (y << frame.bin_shift) as f32) + 0.5;
    let last = first + ((1 << frame.bin_shift) - 1) as f32;
    largest_exponent(splat, first, last) >= frame.alpha_min_log2 - EXPONENT_SLACK
}

fn project(frame: &Uniform, geometry: &[Vec4], sh: &dyn Fn(usize) -> f32) -> Option<(Splat, Cover)> {
    let row = |i: usize| Vec4::from_array(frame.camera[i]);
    let p = geometry[0].xyz().extend(1.0);
    let at = Vec3::new(row(0).dot(p), row(1).dot(p), row(2).dot(p));
    let focal = Vec2::from_array(frame.focal);
    let centre = focal * at.xy() / at.z + Vec2::from_array(frame.centre);
    if !(at.z > frame.near && at.z < FAR && centre.x.abs() < FAR && centre.y.abs() < FAR) {
        return None;
    }
    let slope = focal / at.z;
    let bend = slope * (at.xy() / at.z).clamp(Vec2::from_array(frame.tangent_low), Vec2::from_array(frame.tangent_high));
    let to_x = slope.x * row(0).xyz() - bend.x * row(2).xyz();
    let to_y = slope.y * row(1).xyz() - bend.y * row(2).xyz();
    let (s, last) = (geometry[1], geometry[2]);
    let apply = |v: Vec3| Vec3::new(s.xyz().dot(v), Vec3::new(s.y, s.w, last.x).dot(v), Vec3::new(s.z, last.x, last.y).dot(v));
    let (a, b, d) = (to_x.dot(apply(to_x)), to_x.dot(apply(to_y)), to_y.dot(apply(to_y)));
    let (xx, yy) = (a + frame.dilation, d + frame.dilation);
    if !(a >= 0.0 && d >= 0.0 && xx < VARIANCE_MAX && yy < VARIANCE_MAX && b.abs() < VARIANCE_MAX) {
        return None;
    }
    let xy = b.clamp(-CORRELATION_MAX * (xx * yy).sqrt(), CORRELATION_MAX * (xx * yy).sqrt());
    let det = xx * yy - xy * xy;
    let mut opacity = geometry[0].w;
    if frame.compensation_floor > 0.0 {
        opacity *= ((a * d - b * b).max(0.0) / det).sqrt().max(frame.compensation_floor);
    }
    if !(opacity >= frame.alpha_min && opacity <= OPACITY_MAX) {
        return None;
    }
    let [x, y, across, down] = bins_of(frame, centre, [xx, yy], det, opacity);
    if across == 0 || down == 0 {
        return None;
    }
    let turn = Quat::from_vec4(geometry[3]);
    let look = turn.inverse() * (geometry[0].xyz() - Vec3::from_array(frame.eye)).normalize();
    let raw = colour(frame.sh_degree, look, sh) + 0.5;
    let splat = Splat {
        shape: Vec4::new(centre.x, centre.y, 0.5 * std::f32::consts::LOG2_E * yy / det, -std::f32::consts::LOG2_E * xy / det),
        weight: Vec4::new(0.5 * std::f32::consts::LOG2_E * xx / det, opacity.log2(), xy / xx, xy / yy),
        colour: (raw.max(Vec3::ZERO) * last.z).extend(at.z),
    };
    let hits = hits_in(frame, &splat, [x, y, across, down]);
    let cover = Cover { corner: x | y << 16, size: across | down << 16, hits, depth: at.z.to_bits() };
    (hits != 0).then_some((splat, cover))
}

fn bins_of(frame: &Uniform, centre: Vec2, variance: [f32; 2], det: f32, opacity: f32) -> [u32; 4] {
    let side = (1u32 << frame.bin_shift) as f32;
    let corner = centre - 0.5;
    let (first, end) = if frame.sigmas > 0.0 {
        let middle = 0.5 * (variance[0] + variance[1]);
        let radius = (frame.sigmas * (middle + (middle * middle - det).max(0.1).sqrt()).sqrt()).ceil();
        (((corner - radius) / side).floor(), ((corner + radius + side - 1.0) / side).floor())
    } else {
        let sigmas = (2.0 * (opacity / frame.alpha_min).ln()).sqrt();
        let reach = sigmas * Vec2::from_array(variance).map(f32::sqrt) * REACH_SLACK + REACH_SLACK - 1.0;
        (((corner - reach) / side).floor(), ((corner + reach) / side).floor() + 1.0)
    };
    let limit = Vec2::new(frame.bins[0] as f32, frame.bins[1] as f32);
    let (low, high) = (first.clamp(Vec2::ZERO, limit).as_uvec2(), end.clamp(Vec2::ZERO, limit).as_uvec2());
    [low.x, low.y, high.x.saturating_sub(low.x), high.y.saturating_sub(low.y)]
}

fn hits_in(frame: &Uniform, splat: &Splat, [x, y, across, down]: [u32; 4]) -> u32 {
    let bins = across * down;
    if frame.sigmas > 0.0 {
        return if bins <= 32 { u32::MAX >> (32 - bins) } else { bins };
    }
    let hits = (0..bins).filter(|i| bins == 1 || reaches(frame, splat, x + i % across, y + i / across));
    if bins <= 32 { hits.fold(0, |mask, i| mask | 1 << i) } else { hits.count() as u32 }
}

fn colour(degree: u32, d: Vec3, sh: &dyn Fn(usize) -> f32) -> Vec3 {
    let (x, y, z, s) = (d.x, d.y, d.z, d * d);
    let basis = [
        0.282_094_8,
        -0.488_602_52 * y,
        0.488_602_52 * z,
        -0.488_602_52 * x,
        1.092_548_5 * x * y,
        -1.092_548_5 * y * z,
        0.315_391_57 * (2.0 * s.z - s.x - s.y),
        -1.092_548_5 * x * z,
        0.546_274_24 * (s.x - s.y),
        -0.590_043_6 * y * (3.0 * s.x - s.y),
        2.890_611_4 * x * y * z,
        -0.457_045_8 * y * (4.0 * s.z - s.x - s.y),
        0.373_176_34 * z * (2.0 * s.z - 3.0 * s.x - 3.0 * s.y),
        -0.457_045_8 * x * (4.0 * s.z - s.x - s.y),
        1.445_305_7 * z * (s.x - s.y),
        -0.590_043_6 * x * (s.x - 3.0 * s.y),
    ];
    let coefficients = ((degree + 1) * (degree + 1)) as usize;
    (0..coefficients).map(|k| basis[k] * Vec3::new(sh(3 * k), sh(3 * k + 1), sh(3 * k + 2))).sum()
}

/// Keys and values of what is visible, in its own order.
fn compact(covers: &[Cover]) -> (Vec<u32>, Vec<u32>) {
    let visible: Vec<u32> = (0..covers.len() as u32).filter(|&g| covers[g as usize].hits != 0).collect();
    let depths = || visible.iter().map(|&g| covers[g as usize].depth);
    let (nearest, farthest) = (depths().min().unwrap_or(0), depths().max().unwrap_or(0));
    let shift = (u32::BITS - (farthest - nearest).leading_zeros()).saturating_sub(DEPTH_BITS);
    (depths().map(|depth| (depth - nearest) >> shift).collect(), visible)
}

/// Pairs of bin and Gaussian in the order given.
fn emit(frame: &Uniform, order: &[u32], covers: &[Cover], splats: &[Splat]) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    for &g in order {
        let (cover, splat) = (covers[g as usize], &splats[g as usize]);
        let (x, y, across) = (cover.corner & 0xffff, cover.corner >> 16, cover.size & 0xffff);
        let before = pairs.len();
        for i in 0..cover.bins() {
            let (bx, by) = (x + i % across, y + i / across);
            let whole = cover.hits == cover.bins();
            let hit = if cover.bins() <= 32 { cover.hits >> i & 1 == 1 } else { whole || reaches(frame, splat, bx, by) };
            if hit {
                pairs.push((by * frame.bins[0] + bx, g));
            }
        }
        assert_eq!((pairs.len() - before) as u32, cover.touched(), "count and emit agree");
    }
    pairs
}

/// Start of each bin in sorted keys, and where the last ends.
fn ranges(keys: &[u32], bins: u32) -> Vec<u32> {
    (0..=bins).map(|bin| keys.partition_point(|&k| k < bin) as u32).collect()
}

/// Colour and transmittance of one pixel.
fn raster(frame: &Uniform, splats: &[Splat], order: &[u32], x: u32, y: u32) -> (Vec3, f32) {
    let (mut colour, mut transmittance) = (Vec3::ZERO, 1.0f32);
    let p = Vec2::new(x as f32, y as f32) + 0.5;
    for splat in order.iter().map(|&g| &splats[g as usize]) {
        let e = exponent(splat, p);
        let alpha = if e >= frame.alpha_min_log2 { e.exp2().min(frame.opacity_cap) } else { 0.0 };
        let next = transmittance * (1.0 - alpha);
        if next <= frame.stop {
            break;
        }
        colour += transmittance * alpha * splat.colour.xyz();
        transmittance = next;
    }
    (colour, transmittance)
}

/// What the device wrote in every pass of one frame.
struct Written {
    frame: Uniform,
    geometry: Vec<Vec4>,
    sh: Vec<f32>,
    splats: Vec<Splat>,
    covers: Vec<Cover>,
    depth: [(Vec<u32>, Vec<u32>); 2],
    counts: Vec<u32>,
    pairs: [(Vec<u32>, Vec<u32>); 2],
    starts: Vec<u32>,
    colours: Vec<[f32; 4]>,
}

/// Runs one frame, stopping before each sort to read what it will be given.
fn written(gpu: &Gpu, tier: Tier, bin: u32, profile: Profile, wide: bool) -> Written {
    let mut scene = cloud(2000, 2, 31);
    if wide {
        scene.scale.iter_mut().step_by(40).for_each(|s| *s *= 8.0);
    }
    let splats = upload(gpu, &scene, DQuat::from_rotation_y(0.3));
    let renderer = Renderer::with_form(gpu, tier, bin);
    let options = RenderOptions { profile, colour: true, ..RenderOptions::default() };
    let frame = renderer.prepare(&splats, &front(150, 110), &options).unwrap();
    let recording = frame.record(gpu, &renderer.shared.passes, &splats);
    let b = &frame.buffers;
    let is = |step: &crate::gpu::Step, label| matches!(step, crate::gpu::Step::Dispatch { kernel, .. } | crate::gpu::Step::Indirect { kernel, .. } if kernel.label == label);
    let upto = |label| recording.steps.iter().position(|s| is(s, label)).unwrap() + 1;
    let part = |from: usize, to: usize| gpu.submit(&Recording { steps: recording.steps[from..to].to_vec() });
    let sorted = |buffers: &crate::gpu::SortBuffers, side: usize, n: usize| {
        (gpu.read::<u32>(&buffers.keys[side], n).unwrap(), gpu.read::<u32>(&buffers.values[side], n).unwrap())
    };
    let (compacted, emitted, ranged) = (upto("render.compact"), upto("render.emit"), upto("render.ranges"));
    part(0, compacted);
    let shown = gpu.read::<u32>(&b.shown.buffer, 1).unwrap()[0] as usize;
    let unsorted = sorted(&b.by_depth, 0, shown);
    part(compacted, emitted);
    let n = gpu.read::<u32>(&b.pairs.buffer, 2).unwrap();
    assert_eq!(n[0], n[1], "the test's scene fits");
    let unbinned = sorted(&b.by_bin, 0, n[0] as usize);
    part(emitted, ranged);
    part(ranged, recording.steps.len());
    let bins = frame.uniform.bin_count();
    let bits = u32::BITS - bins.leading_zeros();
    let words: Vec<u32> = gpu.read(&b.pixels, frame.planes.starts()[3] as usize).unwrap();
    Written {
        frame: frame.uniform,
        geometry: gpu.read(&splats.geometry, 4 * scene.len()).unwrap(),
        sh: gpu.read(&splats.sh, 28 * scene.len()).unwrap(),
        splats: gpu.read(&b.splats, scene.len()).unwrap(),
        covers: gpu.read(&b.covers, scene.len()).unwrap(),
        depth: [unsorted, sorted(&b.by_depth, (DEPTH_BITS.div_ceil(8) % 2) as usize, shown)],
        counts: gpu.read(&b.counts, shown).unwrap(),
        pairs: [unbinned, sorted(&b.by_bin, (bits.div_ceil(8) % 2) as usize, n[0] as usize)],
        starts: gpu.read(&b.starts, bins as usize + 1).unwrap(),
        colours: bytemuck::cast_slice(&words[frame.uniform.colour_at as usize..]).to_vec(),
    }
}

fn check(w: &Written) {
    check_project(w);
    assert!(compact(&w.covers) == w.depth[0], "compact");
    let order = &w.depth[1].1;
    let counts: Vec<u32> = order.iter().map(|&g| w.covers[g as usize].touched()).collect();
    assert!(counts == w.counts, "gather");
    let (keys, values): (Vec<u32>, Vec<u32>) = emit(&w.frame, order, &w.covers, &w.splats).into_iter().unzip();
    assert!((keys, values) == w.pairs[0], "emit");
    assert!(ranges(&w.pairs[1].0, w.frame.bin_count()) == w.starts, "ranges");
    for (i, got) in w.colours.iter().enumerate() {
        let (x, y) = (i as u32 % w.frame.size[0], i as u32 / w.frame.size[0]);
        let bin = ((y >> w.frame.bin_shift) * w.frame.bins[0] + (x >> w.frame.bin_shift)) as usize;
        let (colour, t) = raster(&w.frame, &w.splats, &w.pairs[1].1[w.starts[bin] as usize..w.starts[bin + 1] as usize], x, y);
        let error = (Vec4::from_array(*got) - colour.extend(1.0 - t)).abs().max_element();
        // A splat at the cut changes a pixel by its whole alpha, 1/255, at most.
        assert!(error < 5e-3, "pixel {x}, {y}: {got:?} against {colour} {t}");
    }
    let close = |i: usize| {
        let (x, y) = (i as u32 % w.frame.size[0], i as u32 / w.frame.size[0]);
        let bin = ((y >> w.frame.bin_shift) * w.frame.bins[0] + (x >> w.frame.bin_shift)) as usize;
        let (colour, t) = raster(&w.frame, &w.splats, &w.pairs[1].1[w.starts[bin] as usize..w.starts[bin + 1] as usize], x, y);
        (Vec4::from_array(w.colours[i]) - colour.extend(1.0 - t)).abs().max_element() < 1e-5
    };
    let flips = (0..w.colours.len()).filter(|&i| !close(i)).count();
    assert!(flips < w.colours.len() / 1000, "{flips} pixels differ by more than rounding");
}

fn check_project(w: &Written) {
    let n = w.covers.len();
    let mut flips = 0;
    for g in 0..n {
        let sh = |f: usize| w.sh[4 * ((f / 4) * n + g) + f % 4];
        let (got, expected) = (w.covers[g], project(&w.frame, &w.geometry[4 * g..4 * g + 4], &sh));
        if got.hits == 0 || expected.is_none() {
            flips += usize::from((got != NO_COVER) != expected.is_some());
            continue;
        }
        let (splat, cover) = expected.unwrap();
        flips += usize::from(Cover { depth: got.depth, ..cover } != got);
        let near = |a: Vec4, b: Vec4| (a - b).abs().max_element() <= 2e-5 * b.abs().max_element().max(1.0);
        let s = &w.splats[g];
        assert!(near(s.shape, splat.shape) && near(s.weight, splat.weight) && near(s.colour, splat.colour), "{s:?} against {splat:?}");
    }
    assert!(flips <= n / 500, "{flips} covers differ");
}

#[test]
fn each_pass_equals_its_twin() {
    let gpu = Gpu::shared_for_tests().unwrap();
    check(&written(&gpu, Tier::Cpu, 16, Profile::Gsplat, true));
    check(&written(&gpu, Tier::Gpu, 32, Profile::Gsplat, false));
    check(&written(&gpu, Tier::Gpu, 16, Profile::Antialiased, true));
    check(&written(&gpu, Tier::Cpu, 32, Profile::Inria, true));
}
