//! The volume that loose matter takes, by where its particles are: of what flows or falls apart, F tells no volume.

use glam::Vec3;

/// Edge of the cells that it is counted in, in spacings of the particles: eight to a cell.
const EDGE: f64 = 2.0;

/// Volume, m3, of particles at `position_m` with `volume_m3` of matter each: in every cell what matter lies there, at most
/// the cell. So it falls where particles crowd; what spreads thin keeps its own.
pub fn occupied_m3(particles: impl Iterator<Item = (Vec3, f32)> + Clone) -> f64 {
    let (count, total) = particles.clone().fold((0u64, 0.0), |(n, sum), (_, v)| (n + 1, sum + f64::from(v)));
    if count == 0 || total <= 0.0 {
        return 0.0;
    }
    let edge_m = EDGE * (total / count as f64).cbrt();
    let cell = |x: Vec3| (x.as_dvec3() / edge_m).floor().as_i64vec3().to_array();
    let mut held: Vec<([i64; 3], f32)> = particles.map(|(x, v)| (cell(x), v)).collect();
    // In one order whatever that of the particles, so that sums have equal bits.
    held.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    held.chunk_by(|a, b| a.0 == b.0).map(|cell| cell.iter().map(|(_, v)| f64::from(*v)).sum::<f64>().min(edge_m.powi(3))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A jittered block of particles with 1 cm3 each, squeezed along z.
    fn block(squeeze: f32) -> Vec<(Vec3, f32)> {
        let jitter = |i: u32, k: u32| (i.wrapping_mul(2_654_435_761u32.wrapping_add(k * 40_503)) >> 16 & 255) as f32 / 255.0 - 0.5;
        let at = |i: u32| {
            let lattice = Vec3::new((i % 20) as f32, (i / 20 % 20) as f32, (i / 400) as f32);
            (lattice + 0.5 + 1.2 * Vec3::new(jitter(i, 1), jitter(i, 2), jitter(i, 3))) * Vec3::new(0.01, 0.01, 0.01 * squeeze)
        };
        (0..8000).map(|i| (at(i), 1e-6)).collect()
    }

    #[test]
    fn what_crowds_takes_less_and_what_spreads_keeps_its_own() {
        let of = |squeeze: f32| occupied_m3(block(squeeze).into_iter());
        let rest = of(1.0);
        assert!(rest > 0.9 * 8e-3 && rest <= 8e-3, "{rest}");
        assert!((of(0.5) / rest - 0.5).abs() < 0.1, "{}", of(0.5) / rest);
        assert!((of(4.0) - 8e-3).abs() < 1e-8, "{}", of(4.0));
    }
}
