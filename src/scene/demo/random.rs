//! Chance that is the same everywhere: integers in, exact operations, no clock.

use glam::Vec3;

/// A sequence of pseudo-random numbers (splitmix64 by Steele, Lea and Flood, 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed and a purpose, so that one part of the scene does not disturb another.
    pub fn new(seed: u64, purpose: u64) -> Random {
        Random(mix(seed ^ mix(purpose)))
    }

    /// Uniform in 0..1, of 24 bits.
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        (mix(self.0) >> 40) as f32 / (1 << 24) as f32
    }

    /// Uniform between two values.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Uniform within a distance of zero.
    pub fn about(&mut self, most: f32) -> f32 {
        self.between(-most, most)
    }
}

fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Smooth noise on the unit lattice, -1..1 (value noise, cubic fade).
pub fn noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let fade = f * f * (Vec3::splat(3.0) - 2.0 * f);
    let corner = |dx: i64, dy: i64, dz: i64| {
        let at = [cell.x as i64 + dx, cell.y as i64 + dy, cell.z as i64 + dz];
        let hash = at.iter().fold(0_u64, |h, &c| mix(h ^ c as u64));
        (hash >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let edge = |dy: i64, dz: i64| lerp(corner(0, dy, dz), corner(1, dy, dz), fade.x);
    lerp(lerp(edge(0, 0), edge(1, 0), fade.y), lerp(edge(0, 1), edge(1, 1), fade.y), fade.z)
}

/// Three octaves of [`noise`], about -1..1.
pub fn cloud(p: Vec3) -> f32 {
    (noise(p) + 0.5 * noise(p * 2.03 + 11.3) + 0.25 * noise(p * 4.1 + 5.7)) / 1.4
}

/// 0 below `from`, 1 above `to`, smooth between.
pub fn smooth(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
