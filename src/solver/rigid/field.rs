//! A body's surface: its signed distance as a smooth spline, and points spread over it.
//!
//! Particles know their volumes, so their smoothed density says where the surface is to a small part
//! of their spacing: a plane under the same kernel has a known profile, whose inverse is the distance.
//! The level is moved until the surface encloses the particles' own volume.

use glam::{IVec3, UVec3, Vec3};

/// Deviation of the smoothing kernel in particle spacings: the lattice of particles leaves no trace.
const KERNEL_SPACINGS: f32 = 0.9;
/// And at least this in voxels.
const KERNEL_VOXELS: f32 = 0.8;
/// The kernel, a Gaussian since a ball must stay one, ends here, in deviations.
const KERNEL_REACH: f32 = 3.5;
/// Distances are taken from the density this far from the surface, in deviations.
const BAND: f32 = 1.5;
/// Voxels along the longest side of a small body.
const LEAST_ACROSS: f32 = 24.0;
/// Voxels around a body.
const MARGIN_VOXELS: f32 = 3.0;
/// Density at a surface, the kernel's of a plane.
const OUTSIDE: f32 = 0.5;
/// Where no density within [`THIN_SPACINGS`] reaches this, the body is too thin for the kernel.
const THIN: f32 = 0.7;
/// See [`THIN`].
const THIN_SPACINGS: f32 = 1.5;
/// There this much around each particle is solid, in spacings.
const CORE_SPACINGS: f32 = 0.45;
/// Candidates that the points of a surface are picked from.
const CANDIDATES: usize = 6_000;

/// Signed distance to a body's surface, metres, negative inside: a quadratic B-spline, so that normals
/// are continuous and a ball rolls.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::solver) struct Field {
    /// Place of the first coefficient, body frame.
    pub low_m: Vec3,
    /// Between coefficients.
    pub voxel_m: f32,
    /// Coefficients along each axis; x runs fastest.
    pub size: UVec3,
    pub coefficients: Vec<f32>,
}

/// A field at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::solver) struct Level {
    pub distance_m: f32,
    pub gradient: Vec3,
}

/// Points and volumes that a field is made of, body frame.
pub(in crate::solver) struct Cloud<'a> {
    pub points_m: &'a [Vec3],
    pub volumes_m3: &'a [f32],
    /// Of whole particles.
    pub spacing_m: f32,
}

impl Field {
    /// The field of a cloud, of at most `most` coefficients.
    pub fn of(cloud: &Cloud, most: usize) -> Field {
        let room = Vec3::splat(0.5 * cloud.spacing_m);
        let low = cloud.points_m.iter().copied().fold(Vec3::INFINITY, Vec3::min) - room;
        let high = cloud.points_m.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max) + room;
        let extent = high - low;
        let mut voxel_m = cloud.spacing_m.min(extent.max_element() / LEAST_ACROSS);
        let mut size = sized(extent, voxel_m);
        while size.as_u64vec3().element_product() > most as u64 {
            voxel_m *= 1.05;
            size = sized(extent, voxel_m);
        }
        let low_m = 0.5 * (low + high) - 0.5 * (size - 1).as_vec3() * voxel_m;
        let mut field = Field { low_m, voxel_m, size, coefficients: Vec::new() };
        field.fill(cloud);
        field
    }

    fn fill(&mut self, cloud: &Cloud) {
        let width_m = (KERNEL_SPACINGS * cloud.spacing_m).max(KERNEL_VOXELS * self.voxel_m);
        let mut density = self.density(cloud, width_m);
        let share = self.crush(&mut density);
        let per_voxel = width_m / self.voxel_m;
        let profile = Profile::new();
        let mut values: Vec<f32> = density.iter().map(|&d| per_voxel * profile.distance_of(d)).collect();
        self.add_cores(cloud, &density, &mut values);
        let shift = self.level_of_volume(&values, f64::from(share) * cloud.volumes_m3.iter().map(|&v| f64::from(v)).sum::<f64>());
        values.iter_mut().for_each(|v| *v -= shift);
        let known: Vec<bool> = values.iter().map(|v| v.abs() < BAND * per_voxel).collect();
        self.redistance(&mut values, &known);
        self.coefficients = self.interpolating(&values);
        self.coefficients.iter_mut().for_each(|c| *c *= self.voxel_m);
    }

    /// Smoothed share of solid at each node.
    fn density(&self, cloud: &Cloud, width_m: f32) -> Vec<f32> {
        let mut density = vec![0.0f32; self.len()];
        let reach = KERNEL_REACH * width_m / self.voxel_m;
        for (&p, &volume) in cloud.points_m.iter().zip(cloud.volumes_m3) {
            let at = (p - self.low_m) / self.voxel_m;
            let (first, last) = self.span(at, reach);
            let along =
                |axis: usize| -> Vec<f32> { (first[axis]..=last[axis]).map(|k| gaussian((k as f32 - at[axis]) * self.voxel_m / width_m)).collect() };
            let (wx, wy, wz) = (along(0), along(1), along(2));
            let share = volume / width_m.powi(3);
            for (z, &wz) in (first.z..).zip(&wz) {
                for (y, &wy) in (first.y..).zip(&wy) {
                    let start = self.index(UVec3::new(first.x, y, z));
                    for (d, wx) in density[start..start + wx.len()].iter_mut().zip(&wx) {
                        *d += share * wx * wy * wz;
                    }
                }
            }
        }
        density
    }

    /// What was crushed before it became a body is no larger than where its particles are: around them is nothing. The share
    /// of its density that is left.
    fn crush(&self, density: &mut [f32]) -> f32 {
        let at_edge = |i: usize| (self.node(i).cmpeq(UVec3::ZERO) | (self.node(i) + 1).cmpeq(self.size)).any();
        let most = (0..self.len()).filter(|&i| at_edge(i)).map(|i| density[i]).fold(0.0, f32::max);
        if most < OUTSIDE {
            return 1.0;
        }
        let share = 0.5 * OUTSIDE / most;
        density.iter_mut().for_each(|d| *d *= share);
        share
    }

    /// What is thinner than the kernel keeps a solid core around each of its particles.
    fn add_cores(&self, cloud: &Cloud, density: &[f32], values: &mut [f32]) {
        let per_voxel = cloud.spacing_m / self.voxel_m;
        for &p in cloud.points_m {
            let at = (p - self.low_m) / self.voxel_m;
            if self.near(at, THIN_SPACINGS * per_voxel).any(|node| density[self.index(node)] > THIN) {
                continue;
            }
            let core = CORE_SPACINGS * per_voxel;
            for node in self.near(at, core + 1.5) {
                let value = &mut values[self.index(node)];
                *value = value.min((node.as_vec3() - at).length() - core);
            }
        }
    }

    /// The nodes of a cube around a place in voxels.
    fn near(&self, at: Vec3, reach: f32) -> impl Iterator<Item = UVec3> {
        let (first, last) = self.span(at, reach);
        (first.z..=last.z).flat_map(move |z| (first.y..=last.y).flat_map(move |y| (first.x..=last.x).map(move |x| UVec3::new(x, y, z))))
    }

    /// Nodes within `reach` voxels along each axis.
    fn span(&self, at: Vec3, reach: f32) -> (UVec3, UVec3) {
        let last = (self.size - 1).as_ivec3();
        let low = (at - reach).ceil().as_ivec3().clamp(IVec3::ZERO, last);
        let high = (at + reach).floor().as_ivec3().clamp(IVec3::ZERO, last);
        (low.as_uvec3(), high.as_uvec3())
    }

    /// The value whose level set encloses a volume.
    fn level_of_volume(&self, values: &[f32], volume_m3: f64) -> f32 {
        let wanted = volume_m3 / f64::from(self.voxel_m).powi(3);
        let enclosed = |level: f32| values.iter().map(|v| f64::from((0.5 + level - v).clamp(0.0, 1.0))).sum::<f64>();
        let (mut low, mut high) = (-2.0f32, 2.0f32);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if enclosed(middle) < wanted { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Makes distances, in voxels, of all values that are not known: |grad| = 1 by fast sweeping
    /// (Zhao 2005).
    fn redistance(&self, values: &mut [f32], known: &[bool]) {
        let inside: Vec<bool> = values.iter().map(|v| *v < 0.0).collect();
        let mut distance: Vec<f32> = values.iter().zip(known).map(|(v, &k)| if k { v.abs() } else { f32::MAX }).collect();
        for sweep in 0..16u32 {
            for k in 0..self.len() {
                let mut node = self.node(k);
                for axis in 0..3 {
                    if sweep >> axis & 1 != 0 {
                        node[axis] = self.size[axis] - 1 - node[axis];
                    }
                }
                let i = self.index(node);
                if !known[i] {
                    distance[i] = distance[i].min(self.arrival(&distance, node));
                }
            }
        }
        for ((value, distance), inside) in values.iter_mut().zip(&distance).zip(&inside) {
            *value = if *inside { -distance } else { *distance };
        }
    }

    /// Distance at a node from the smaller neighbours along each axis.
    fn arrival(&self, distance: &[f32], node: UVec3) -> f32 {
        let mut near = [f32::MAX; 3];
        for axis in 0..3 {
            let mut step = UVec3::ZERO;
            step[axis] = 1;
            if node[axis] > 0 {
                near[axis] = distance[self.index(node - step)];
            }
            if node[axis] + 1 < self.size[axis] {
                near[axis] = near[axis].min(distance[self.index(node + step)]);
            }
        }
        near.sort_by(f32::total_cmp);
        let [a, b, c] = near;
        if b >= a + 1.0 {
            return a + 1.0;
        }
        let two = 0.5 * (a + b + (2.0 - (a - b).powi(2)).max(0.0).sqrt());
        if c >= two {
            return two;
        }
        let sum = a + b + c;
        (sum + (sum * sum - 3.0 * (a * a + b * b + c * c - 1.0)).max(0.0).sqrt()) / 3.0
    }

    /// Coefficients whose spline passes through the values.
    fn interpolating(&self, values: &[f32]) -> Vec<f32> {
        let mut coefficients = values.to_vec();
        for _ in 0..6 {
            let smooth = self.smoothed(&coefficients);
            for ((c, v), s) in coefficients.iter_mut().zip(values).zip(&smooth) {
                *c += v - s;
            }
        }
        coefficients
    }

    /// Values of the spline at its own nodes.
    fn smoothed(&self, coefficients: &[f32]) -> Vec<f32> {
        let mut values = coefficients.to_vec();
        for axis in 0..3 {
            let from = values.clone();
            let stride = [1, self.size.x as usize, (self.size.x * self.size.y) as usize][axis];
            for (i, value) in values.iter_mut().enumerate() {
                let at = self.node(i)[axis];
                let before = if at > 0 { from[i - stride] } else { from[i] };
                let after = if at + 1 < self.size[axis] { from[i + stride] } else { from[i] };
                *value = 0.75 * from[i] + 0.125 * (before + after);
            }
        }
        values
    }

    /// The spline at a point of the body frame; beyond its nodes the way to them is added.
    pub fn at(&self, x: Vec3) -> Level {
        let free = (x - self.low_m) / self.voxel_m;
        let u = free.clamp(Vec3::splat(0.5), self.size.as_vec3() - 1.501);
        let base = (u - 0.5).floor();
        let t = u - base;
        let (a, b, c) = (1.5 - t, t - 1.0, t - 0.5);
        let w = [0.5 * a * a, 0.75 - b * b, 0.5 * c * c];
        let d = [-a, -2.0 * b, c];
        let first = base.as_uvec3();
        let (mut value, mut g) = (0.0, Vec3::ZERO);
        for k in 0..9usize {
            let (y, z) = (k % 3, k / 3);
            let start = self.index(first + UVec3::new(0, y as u32, z as u32));
            let row = Vec3::from_slice(&self.coefficients[start..start + 3]);
            let along = row.dot(Vec3::new(w[0].x, w[1].x, w[2].x));
            let slope = row.dot(Vec3::new(d[0].x, d[1].x, d[2].x));
            let (wy, wz, dy, dz) = (w[y].y, w[z].z, d[y].y, d[z].z);
            value += along * wy * wz;
            g += Vec3::new(slope * wy * wz, along * dy * wz, along * wy * dz);
        }
        let beyond = (free - u) * self.voxel_m;
        let away_m = beyond.length();
        let outward = if away_m > 0.0 { beyond / away_m } else { Vec3::ZERO };
        Level { distance_m: value + away_m, gradient: g / self.voxel_m + outward }
    }

    /// At most `most` points spread over the surface, the farthest from all before it next (Gonzalez
    /// 1985), and how far apart they are.
    pub fn surface(&self, most: usize) -> (Vec<Vec3>, f32) {
        let near: Vec<usize> = (0..self.len()).filter(|&i| self.coefficients[i].abs() < 0.9 * self.voxel_m).collect();
        let stride = near.len().div_ceil(CANDIDATES).max(1);
        let candidates: Vec<Vec3> = near.iter().step_by(stride).filter_map(|&i| self.landed(i)).collect();
        let mut picked: Vec<Vec3> = Vec::new();
        let mut away: Vec<f32> = candidates.iter().map(|c| 1e6 + c.length_squared()).collect();
        let mut spacing_m = self.voxel_m;
        while picked.len() < most {
            let farthest = away.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(&a.0)));
            let Some((next, apart)) = farthest.map(|(i, &d)| (i, d.sqrt())).filter(|(_, d)| *d > 0.3 * self.voxel_m) else { break };
            if picked.len() > 1 {
                spacing_m = apart;
            }
            let point = candidates[next];
            picked.push(point);
            away.iter_mut().zip(&candidates).for_each(|(a, c)| *a = a.min(c.distance_squared(point)));
        }
        (picked, spacing_m)
    }

    /// The surface point below a node, where Newton's steps find one.
    fn landed(&self, index: usize) -> Option<Vec3> {
        let start = self.low_m + self.node(index).as_vec3() * self.voxel_m;
        let mut x = start;
        for _ in 0..5 {
            let level = self.at(x);
            x -= level.gradient * (level.distance_m / level.gradient.length_squared().max(0.1));
        }
        (self.at(x).distance_m.abs() < 0.02 * self.voxel_m && x.distance(start) < 2.0 * self.voxel_m).then_some(x)
    }

    fn len(&self) -> usize {
        self.size.element_product() as usize
    }

    fn index(&self, node: UVec3) -> usize {
        ((node.z * self.size.y + node.y) * self.size.x + node.x) as usize
    }

    fn node(&self, index: usize) -> UVec3 {
        let (i, s) = (index as u32, self.size);
        UVec3::new(i % s.x, i / s.x % s.y, i / (s.x * s.y))
    }
}

fn sized(extent: Vec3, voxel_m: f32) -> UVec3 {
    (extent / voxel_m + 2.0 * MARGIN_VOXELS).ceil().as_uvec3() + 1
}

/// Of unit deviation and integral.
fn gaussian(t: f32) -> f32 {
    (-0.5 * t * t).exp() * (0.5 * std::f32::consts::FRAC_1_PI).sqrt()
}

/// Density beside a plane under the kernel, against the distance from it in deviations.
struct Profile {
    /// From -KERNEL_REACH to KERNEL_REACH in equal steps.
    densities: Vec<f32>,
}

impl Profile {
    const STEPS: usize = 512;

    fn new() -> Profile {
        let step = 2.0 * KERNEL_REACH / Self::STEPS as f32;
        let mut beyond: Vec<f32> = vec![0.0];
        for k in (0..Self::STEPS).rev() {
            let low = k as f32 * step - KERNEL_REACH;
            let area = step / 6.0 * (gaussian(low) + 4.0 * gaussian(low + 0.5 * step) + gaussian(low + step));
            beyond.push(beyond.last().copied().unwrap_or(0.0) + area);
        }
        beyond.reverse();
        Profile { densities: beyond }
    }

    /// Signed distance, positive outside, at which the density is this.
    fn distance_of(&self, density: f32) -> f32 {
        let after = self.densities.partition_point(|&d| d > density);
        let place = match after {
            0 => 0.0,
            _ if after > Self::STEPS => Self::STEPS as f32,
            _ => after as f32 - (density - self.densities[after]) / (self.densities[after - 1] - self.densities[after]),
        };
        place * (2.0 * KERNEL_REACH / Self::STEPS as f32) - KERNEL_REACH
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::validate::{ball, block};

    fn cloud_of(points_m: &[Vec3], volumes_m3: &[f32], spacing_m: f32) -> Field {
        Field::of(&Cloud { points_m, volumes_m3, spacing_m }, 64 * 64 * 64)
    }

    #[test]
    fn what_was_crushed_to_a_point_has_a_surface_about_it() {
        let cloud = Cloud { points_m: &[Vec3::ONE; 500], volumes_m3: &[1e-3; 500], spacing_m: 0.1 };
        let field = Field::of(&cloud, 32 * 32 * 32);
        assert!(field.at(Vec3::ONE).distance_m < 0.0);
        let (points, _) = field.surface(512);
        assert!(points.len() > 50 && points.iter().all(|p| (0.02..0.1).contains(&p.distance(Vec3::ONE))), "{} points", points.len());
    }

    #[test]
    fn a_ball_has_the_distance_of_a_sphere() {
        let (radius, spacing) = (0.1, 0.0125);
        let ball = ball(Vec3::ZERO, radius, spacing);
        let field = cloud_of(&ball.position_m, &ball.volume_m3, spacing);
        let (points, apart) = field.surface(512);
        assert!(points.len() == 512 && apart < 0.02, "{} points, {apart} m apart", points.len());
        let worst = points.iter().map(|p| (p.length() - radius).abs()).fold(0.0, f32::max);
        assert!(worst < 0.004 * radius, "the surface is {worst} m off");
        let tilt = points.iter().map(|p| field.at(*p).gradient.normalize().angle_between(*p)).fold(0.0, f32::max);
        assert!(tilt < 0.02, "a normal is {tilt} rad off");
        for p in &points {
            let away = field.at(*p * 1.2).distance_m;
            assert!((away / (0.2 * radius) - 1.0).abs() < 0.2, "{away}");
        }
    }

    #[test]
    fn a_box_has_flat_sides_and_a_bowl_is_hollow() {
        let spacing = 0.02;
        let cube = block(Vec3::splat(-0.1), Vec3::splat(0.2), spacing, 1e5, 0.3);
        let field = cloud_of(&cube.position_m, &cube.volume_m3, spacing);
        for k in 0..20 {
            let (a, b) = (0.04 * (k as f32 * 1.7).sin(), 0.04 * (k as f32 * 2.9).cos());
            let level = field.at(Vec3::new(a, b, 0.1));
            assert!(level.distance_m.abs() < 0.2 * spacing, "{}", level.distance_m);
            assert!(level.gradient.angle_between(Vec3::Z) < 0.01, "{}", level.gradient);
        }
        let kept: Vec<usize> = (0..cube.len()).filter(|&i| cube.position_m[i].with_z(cube.position_m[i].z - 0.1).length() > 0.08).collect();
        let points: Vec<Vec3> = kept.iter().map(|&i| cube.position_m[i]).collect();
        let volumes: Vec<f32> = kept.iter().map(|&i| cube.volume_m3[i]).collect();
        let bowl = cloud_of(&points, &volumes, spacing);
        assert!(bowl.at(Vec3::new(0.0, 0.0, 0.09)).distance_m > 0.05);
        assert!(bowl.at(Vec3::new(0.0, 0.0, -0.05)).distance_m < -0.02);
    }
}
