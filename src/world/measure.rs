//! Motion in numbers: what `metrics.json` holds of each object at each frame.

use crate::spec::Collider;
use glam::{DMat3, DVec3, Mat3, Vec3};
use serde::{Deserialize, Serialize};

use super::occupied::occupied_m3;
use super::prepared::support_below;

/// One frame of motion on the host, particles in their original order.
#[derive(Clone, Debug)]
pub struct MotionFrame {
    /// Positions, world metres.
    pub position_m: Vec<Vec3>,
    /// Deformation since the captured pose, G = F F0^-1.
    pub deformation: Vec<Mat3>,
    /// Whether each keeps no shape, so that G tells no volume.
    pub loose: Vec<bool>,
    /// Whether each flew out of what is followed, and counts for nothing.
    pub left: Vec<bool>,
    /// Empty where only the motion was kept.
    pub velocity_m_s: Vec<Vec3>,
}

/// Words of one particle in a motion buffer: three f32 of position, nine f16 of G - I, one that is above 0 where it keeps no shape and below 0 where
/// it is no longer followed.
pub const MOTION_WORDS: usize = 8;

impl MotionFrame {
    /// Unpacks what the solver's frame pass wrote.
    pub fn unpack(motion: &[u8], velocity: &[u8]) -> MotionFrame {
        let particles = motion.chunks_exact(MOTION_WORDS * 4);
        let number = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let half = |bytes: &[u8], i: usize| half::f16::from_le_bytes([bytes[12 + 2 * i], bytes[13 + 2 * i]]).to_f32();
        MotionFrame {
            position_m: particles.clone().map(|p| Vec3::new(number(&p[0..4]), number(&p[4..8]), number(&p[8..12]))).collect(),
            loose: particles.clone().map(|p| half(p, 9) > 0.5).collect(),
            left: particles.clone().map(|p| half(p, 9) < -0.5).collect(),
            deformation: particles
                .map(|p| {
                    let rows: [f32; 9] = std::array::from_fn(|i| half(p, i));
                    Mat3::from_cols_array(&rows).transpose() + Mat3::IDENTITY
                })
                .collect(),
            velocity_m_s: velocity.chunks_exact(16).map(|v| Vec3::new(number(&v[0..4]), number(&v[4..8]), number(&v[8..12]))).collect(),
        }
    }
}

impl MotionFrame {
    /// Particles with a value that is not a number.
    pub fn nonfinite(&self) -> u64 {
        let motion = self.position_m.iter().zip(&self.deformation).map(|(x, g)| x.is_finite() && g.is_finite());
        let bad = |fine: bool| u64::from(!fine);
        motion.map(bad).sum::<u64>().max(self.velocity_m_s.iter().map(|v| bad(v.is_finite())).sum())
    }
}

/// What does not change from frame to frame.
#[derive(Clone, Debug)]
pub struct Bodies {
    /// Particles of each object: index ranges into the particle arrays, one object after another.
    pub ranges: Vec<std::ops::Range<usize>>,
    /// Mass of each particle.
    pub mass_kg: Vec<f32>,
    /// Undeformed volume of each particle.
    pub volume_m3: Vec<f32>,
    /// Share of each object's volume that is found where its particles are as captured, as [`occupied_m3`] finds it.
    pub found: Vec<f64>,
    /// Static colliders and the ground, for the gap below.
    pub colliders: Vec<Collider>,
    /// Height of the ground.
    pub ground_m: f64,
    /// What reaches no higher than this over a point counts as below it.
    pub near_m: f64,
}

/// One object at one frame. Definitions as in [`crate::stages::ObjectMetrics`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "named and documented in ObjectMetrics")]
pub struct Row {
    pub com_m: [f64; 3],
    pub low_m: f64,
    pub high_m: f64,
    pub speed_m_s: f64,
    pub mean_speed_m_s: f64,
    pub volume_ratio: f64,
    pub stretch_max: f64,
    pub spin_rad_s: [f64; 3],
    pub kinetic_j: f64,
    pub spread_m: f64,
    pub gap_m: f64,
}

/// Measures every object of one frame.
pub fn measure(frame: &MotionFrame, bodies: &Bodies) -> Vec<Row> {
    if frame.left.contains(&true) {
        let (frame, bodies) = followed(frame, bodies);
        return measure(&frame, &bodies);
    }
    bodies.ranges.iter().zip(&bodies.found).map(|(range, &found)| row(frame, bodies, range.clone(), found)).collect()
}

/// The same without what is no longer followed.
fn followed(frame: &MotionFrame, bodies: &Bodies) -> (MotionFrame, Bodies) {
    fn kept<T: Copy>(values: &[T], left: &[bool]) -> Vec<T> {
        values.iter().zip(left).filter(|(_, left)| !**left).map(|(value, _)| *value).collect()
    }
    let left = &frame.left;
    let stay = |particles: &[bool]| particles.iter().filter(|left| !**left).count();
    let followed = MotionFrame {
        position_m: kept(&frame.position_m, left),
        deformation: kept(&frame.deformation, left),
        loose: kept(&frame.loose, left),
        left: vec![false; stay(left)],
        velocity_m_s: kept(&frame.velocity_m_s, left),
    };
    let bodies = Bodies {
        ranges: bodies.ranges.iter().map(|r| stay(&left[..r.start])..stay(&left[..r.end])).collect(),
        mass_kg: kept(&bodies.mass_kg, left),
        volume_m3: kept(&bodies.volume_m3, left),
        ..bodies.clone()
    };
    (followed, bodies)
}

fn row(frame: &MotionFrame, bodies: &Bodies, range: std::ops::Range<usize>, found: f64) -> Row {
    if range.is_empty() {
        return Row::default();
    }
    let (x, v, g) = (&frame.position_m[range.clone()], &frame.velocity_m_s[range.clone()], &frame.deformation[range.clone()]);
    let loose = &frame.loose[range.clone()];
    let (mass, volume) = (&bodies.mass_kg[range.clone()], &bodies.volume_m3[range]);
    let total: f64 = mass.iter().map(|&m| f64::from(m)).sum();
    let com: DVec3 = x.iter().zip(mass).map(|(x, &m)| x.as_dvec3() * f64::from(m)).sum::<DVec3>() / total;
    let drift: DVec3 = v.iter().zip(mass).map(|(v, &m)| v.as_dvec3() * f64::from(m)).sum::<DVec3>() / total;
    let (mut inertia, mut angular, mut kinetic, mut spread, mut speeds, mut fastest) = (DMat3::ZERO, DVec3::ZERO, 0.0, 0.0, 0.0, 0.0f64);
    for ((x, v), &m) in x.iter().zip(v).zip(mass) {
        let (m, r, v) = (f64::from(m), x.as_dvec3() - com, v.as_dvec3());
        let outer = DMat3::from_cols(r * r.x, r * r.y, r * r.z);
        inertia += (DMat3::from_diagonal(DVec3::splat(r.length_squared())) - outer) * m;
        angular += r.cross(v - drift) * m;
        kinetic += 0.5 * m * v.length_squared();
        spread += m * (r.x * r.x + r.y * r.y);
        speeds += v.length();
        fastest = fastest.max(v.length());
    }
    let shaped = g.iter().zip(volume).zip(loose).filter(|(_, loose)| !**loose);
    let shaped: f64 = shaped.map(|((g, &w), _)| f64::from(g.determinant()) * f64::from(w)).sum();
    let pours = x.iter().zip(volume).zip(loose).filter(|(_, loose)| **loose).map(|((x, w), _)| (*x, *w));
    let occupied = shaped + occupied_m3(pours) / found;
    let captured: f64 = volume.iter().map(|&w| f64::from(w)).sum();
    let mut heights: Vec<f32> = x.iter().map(|p| p.z).collect();
    let mut stretches: Vec<f32> = g.iter().map(largest_stretch).collect();
    let gap = x.iter().map(|p| gap_below(p, bodies)).fold(f64::INFINITY, f64::min);
    Row {
        com_m: com.to_array(),
        low_m: f64::from(quantile(&mut heights, 0.01)),
        high_m: f64::from(quantile(&mut heights, 0.99)),
        speed_m_s: fastest,
        mean_speed_m_s: speeds / x.len() as f64,
        volume_ratio: occupied / captured,
        stretch_max: f64::from(quantile(&mut stretches, 0.99)),
        spin_rad_s: spin(inertia, angular).to_array(),
        kinetic_j: kinetic,
        spread_m: (spread / total).sqrt(),
        gap_m: gap,
    }
}

/// Inertia^-1 L, zero for a body too thin to have an inertia of full rank.
fn spin(inertia: DMat3, angular: DVec3) -> DVec3 {
    let scale = (inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z) / 3.0;
    if inertia.determinant() > 1e-9 * scale.powi(3) { inertia.inverse() * angular } else { DVec3::ZERO }
}

fn gap_below(point: &Vec3, bodies: &Bodies) -> f64 {
    let p = point.as_dvec3();
    p.z - support_below(&bodies.colliders, bodies.ground_m, p.to_array(), bodies.near_m)
}

/// The value below which a share of all values lies; reorders them.
fn quantile(values: &mut [f32], share: f64) -> f32 {
    let at = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(at, f32::total_cmp).1
}

/// The largest singular value of G: the root of the largest eigenvalue of G^T G, in closed form.
fn largest_stretch(g: &Mat3) -> f32 {
    let c = g.transpose() * *g;
    let mean = (c.x_axis.x + c.y_axis.y + c.z_axis.z) / 3.0;
    let off = c.x_axis.y * c.x_axis.y + c.x_axis.z * c.x_axis.z + c.y_axis.z * c.y_axis.z;
    let diagonal = Vec3::new(c.x_axis.x - mean, c.y_axis.y - mean, c.z_axis.z - mean);
    let p = ((diagonal.length_squared() + 2.0 * off) / 6.0).sqrt();
    if p < 1e-9 {
        return mean.max(0.0).sqrt();
    }
    let b = (c - Mat3::from_diagonal(Vec3::splat(mean))) * (1.0 / p);
    let angle = (b.determinant() / 2.0).clamp(-1.0, 1.0).acos() / 3.0;
    (mean + 2.0 * p * angle.cos()).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> (Vec<Vec3>, Bodies) {
        let points: Vec<Vec3> =
            (0..1000).map(|i| Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) * 0.1 + Vec3::splat(0.05)).collect();
        let bodies = Bodies {
            ranges: vec![0..1000; 1],
            mass_kg: vec![0.001; 1000],
            volume_m3: vec![0.001; 1000],
            found: vec![1.0],
            colliders: vec![],
            ground_m: 0.0,
            near_m: 0.01,
        };
        (points, bodies)
    }

    #[test]
    fn a_spinning_stretched_cube_measures_as_it_was_made() {
        let (points, bodies) = cube();
        let (centre, omega) = (Vec3::splat(0.5), Vec3::new(0.0, 0.0, 3.0));
        let frame = MotionFrame {
            velocity_m_s: points.iter().map(|p| omega.cross(*p - centre) + Vec3::X).collect(),
            deformation: vec![Mat3::from_rotation_x(0.7) * Mat3::from_diagonal(Vec3::new(1.0, 1.5, 0.8)); 1000],
            loose: vec![false; 1000],
            left: vec![false; 1000],
            position_m: points,
        };
        let row = measure(&frame, &bodies)[0];
        assert!((DVec3::from(row.com_m) - DVec3::splat(0.5)).length() < 1e-6);
        assert!((DVec3::from(row.spin_rad_s) - omega.as_dvec3()).length() < 1e-5);
        assert!((row.volume_ratio - 1.2).abs() < 1e-5 && (row.stretch_max - 1.5).abs() < 1e-4);
        // Of what keeps no shape it is where it is that counts.
        let poured = MotionFrame { loose: vec![true; 1000], ..frame.clone() };
        assert!((measure(&poured, &bodies)[0].volume_ratio - 1.0).abs() < 1e-3);
        let crowded = MotionFrame { position_m: frame.position_m.iter().map(|p| *p * Vec3::new(1.0, 1.0, 0.5)).collect(), ..poured };
        // A half, and what the uppermost layer of cells has room for.
        assert!((measure(&crowded, &bodies)[0].volume_ratio - 0.6).abs() < 0.01);
        // A tenth of it that flew far away counts for nothing; what was seen of the rest stays.
        let far = |i: usize| i % 10 == 9;
        let position_m = frame.position_m.iter().enumerate().map(|(i, p)| if far(i) { *p + Vec3::splat(1e3) } else { *p }).collect();
        let torn = MotionFrame { position_m, left: (0..1000).map(far).collect(), ..frame.clone() };
        let rest = measure(&torn, &bodies)[0];
        assert!((rest.volume_ratio - 1.2).abs() < 1e-5 && rest.high_m < 1.0 && rest.gap_m == row.gap_m);
        assert!((row.low_m - 0.05).abs() < 1e-6 && (row.high_m - 0.95).abs() < 1e-6 && (row.gap_m - 0.05).abs() < 1e-6);
    }

    #[test]
    fn motion_bytes_unpack_to_what_was_packed() {
        let mut words = Vec::new();
        for value in [1.0f32, -2.0, 3.5] {
            words.extend(value.to_le_bytes());
        }
        for value in [0.5f32, 0.25, 0.0, 0.0, -0.5, 0.0, 0.0, 0.0, 0.125, 1.0] {
            words.extend(half::f16::from_f32(value).to_le_bytes());
        }
        let frame = MotionFrame::unpack(&words, &[]);
        assert_eq!(frame.position_m, [Vec3::new(1.0, -2.0, 3.5)]);
        assert_eq!((frame.nonfinite(), frame.loose.as_slice()), (0, &[true][..]));
        assert_eq!(MotionFrame { position_m: vec![Vec3::NAN], ..frame.clone() }.nonfinite(), 1);
        assert_eq!(frame.deformation[0].row(0), Vec3::new(1.5, 0.25, 0.0));
        assert_eq!(frame.deformation[0].row(2), Vec3::new(0.0, 0.0, 1.125));
    }
}
