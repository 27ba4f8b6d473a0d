//! How stiff a thing may be, so that a frame ends in bounded time; and what is done about what is stiffer.
//!
//! A substep is as long as the fastest wave needs for a share of a cell, so steel in small cells asks for millions of
//! substeps a second, which nobody sees: under its own weight it stays as it is at a thousandth of its
//! stiffness too. So what would need more substeps than a frame may have is softened to what they carry,
//! and that is said.

use super::constants::{BREATHING, PACKING_LEAST};
use super::sph;
use super::state::ParticleState;
use super::substance::Substance;
use super::types::{Settings, Softened, Taut};
use std::collections::{BTreeMap, BTreeSet};

/// Frames longer than this have more substeps than `substeps_most`.
const FRAME_S: f64 = 0.02;
/// Share of its stiffness that softening leaves: waves are half as fast.
const SOFTER: f32 = 0.25;
/// Substeps that a frame may take at all: a pin that is faster than this passes through thousands of cells in it.
pub(super) const SUBSTEPS_MOST: f64 = 200_000.0;

/// Speed that bounds a substep, by the moduli alone; see `step_modulus` in `substance.wgsl`.
fn wave_speed_m_s(s: &ParticleState) -> f32 {
    let modulus_pa = if s.mu_pa > 0.0 { BREATHING * (3.0 * s.lambda_pa + 2.0 * s.mu_pa) } else { s.lambda_pa };
    (modulus_pa * s.volume_m3 / s.mass_kg).sqrt()
}

/// Young's modulus from Lamé's two.
fn young_pa(s: &ParticleState) -> f32 {
    let (mu, lambda) = (s.mu_pa, s.lambda_pa);
    if mu > 0.0 { mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu) } else { lambda }
}

/// Shortest substep that is taken for the sake of stiffness, where a fiftieth of a second or a shorter frame may take
/// `substeps_most`.
pub fn shortest_substep_s(frame_s: f64, substeps_most: u32) -> f64 {
    frame_s.min(FRAME_S) / f64::from(substeps_most)
}

/// The same of a solver.
pub(super) fn shortest_s(settings: &Settings) -> f64 {
    shortest_substep_s(settings.frame_s, settings.substeps_most)
}

/// Softens what is stiffer than the shortest substep carries; what was softened, one entry an object.
pub(super) fn afford(states: &mut [ParticleState], settings: &Settings, time_s: f64) -> Vec<Softened> {
    let fastest_m_s = fastest_m_s(settings);
    let mut softened: BTreeMap<u32, Softened> = BTreeMap::new();
    for s in states {
        let factor = (fastest_m_s / wave_speed_m_s(s)).powi(2);
        // Not again for what was brought to the limit before.
        if factor > 0.999 {
            continue;
        }
        s.mu_pa *= factor;
        s.lambda_pa *= factor;
        let entry = softened.entry(s.object()).or_insert_with(|| Softened {
            object: s.object(),
            what: Taut::Stiffness,
            factor,
            value: 0.0,
            time_s,
            reason: reason(settings),
        });
        entry.factor = entry.factor.min(factor);
        entry.value = entry.value.max(young_pa(s));
    }
    softened.into_values().collect()
}

/// Lowers surface tensions whose shortest waves, as long as a cell, outrun the shortest substep: their
/// modulus is 2 pi sigma / cell. What was lowered, one entry an object.
pub(super) fn slacken(substances: &mut [Substance], states: &[ParticleState], settings: &Settings, time_s: f64) -> Vec<Softened> {
    let on_grid = fastest_m_s(settings).powi(2) * settings.cell_m / std::f32::consts::TAU;
    let beside = sph::tension_over_density(settings.cell_m, shortest_s(settings)) as f32;
    let mut softened: BTreeMap<u32, Softened> = BTreeMap::new();
    for s in states {
        let (surface_tension_n_m, per_density) = match substances.get_mut(s.substance()) {
            Some(Substance::Liquid { surface_tension_n_m, .. }) => (surface_tension_n_m, on_grid),
            Some(Substance::SphLiquid { surface_tension_n_m, .. }) => (surface_tension_n_m, beside),
            _ => continue,
        };
        let factor = per_density * s.mass_kg / s.volume_m3 / surface_tension_n_m.max(f32::MIN_POSITIVE);
        if factor > 0.999 {
            continue;
        }
        *surface_tension_n_m *= factor;
        let value = *surface_tension_n_m;
        let new = Softened { object: s.object(), what: Taut::SurfaceTension, factor: 1.0, value, time_s, reason: reason(settings) };
        let entry = softened.entry(s.object()).or_insert(new);
        (entry.factor, entry.value) = (entry.factor * factor, entry.value.min(value));
    }
    softened.into_values().collect()
}

/// By how much each substance may stiffen as it packs, and what of that is less than it asks for and not as `known` already,
/// one entry an object.
pub(super) fn stiffenings(
    substances: &[Substance],
    states: &[ParticleState],
    settings: &Settings,
    known: &[f32],
    time_s: f64,
) -> (Vec<f32>, Vec<Softened>) {
    let fastest_m_s = fastest_m_s(settings);
    let mut most = vec![f32::MAX; substances.len()];
    // By object and row: the least share of what is asked for.
    let mut least: BTreeMap<(u32, usize), f32> = BTreeMap::new();
    for s in states {
        let Some(Substance::Snow { hardening, .. }) = substances.get(s.substance()) else { continue };
        let asked = (hardening * (1.0 - PACKING_LEAST)).exp();
        let carried = (fastest_m_s / wave_speed_m_s(s)).powi(2).max(1.0);
        if carried >= asked {
            continue;
        }
        let value = &mut most[s.substance()];
        *value = value.min(carried);
        let share = least.entry((s.object(), s.substance())).or_insert(1.0);
        *share = share.min(carried / asked);
    }
    let mut softened: BTreeMap<u32, Softened> = BTreeMap::new();
    for ((object, row), factor) in least.into_iter().filter(|((_, row), _)| known.get(*row) != Some(&most[*row])) {
        let new = Softened { object, what: Taut::Hardening, factor, value: most[row], time_s, reason: reason(settings) };
        let entry = softened.entry(object).or_insert(new);
        (entry.factor, entry.value) = (entry.factor.min(factor), entry.value.min(most[row]));
    }
    (most, softened.into_values().collect())
}

/// Speed of the fastest wave that the shortest substep follows. Nor does anything move faster, which no frame would show: at 4000
/// substeps that is 1600 cells from one to the next. So a frame ends in bounded time whatever drives it.
pub(super) fn fastest_m_s(settings: &Settings) -> f32 {
    (f64::from(settings.cfl) * f64::from(settings.cell_m) / shortest_s(settings)) as f32
}

fn reason(settings: &Settings) -> String {
    format!("with more, it would take substeps under {:.1e} s", shortest_s(settings))
}

/// Takes most of the stiffness, and of the surface tension, of the objects that a predicate picks.
pub(super) fn soften(
    states: &mut [ParticleState],
    substances: &mut [Substance],
    picked: impl Fn(u32) -> bool,
    time_s: f64,
    reason: &str,
) -> Vec<Softened> {
    let mut softened: BTreeMap<(u32, bool), Softened> = BTreeMap::new();
    let new = |object, what, value| Softened { object, what, factor: SOFTER, value, time_s, reason: reason.to_owned() };
    let mut rows = BTreeSet::new();
    for s in states.iter_mut().filter(|s| picked(s.object())) {
        let row = s.substance();
        if let Some(Substance::Liquid { surface_tension_n_m: sigma, .. } | Substance::SphLiquid { surface_tension_n_m: sigma, .. }) =
            substances.get_mut(row).filter(|_| rows.insert(row))
            && *sigma > 0.0
        {
            *sigma *= SOFTER;
            softened.insert((s.object(), true), new(s.object(), Taut::SurfaceTension, *sigma));
        }
        if s.lambda_pa + s.mu_pa > 0.0 {
            s.mu_pa *= SOFTER;
            s.lambda_pa *= SOFTER;
            let entry = softened.entry((s.object(), false)).or_insert_with(|| new(s.object(), Taut::Stiffness, 0.0));
            entry.value = entry.value.max(young_pa(s));
        }
    }
    softened.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn particle(object: u32, young_pa: f32, poisson: f32) -> ParticleState {
        let (mu_pa, lambda_pa) = (young_pa / (2.0 * (1.0 + poisson)), young_pa * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)));
        ParticleState { position_m: Vec3::ZERO, mass_kg: 1e-3, volume_m3: 1e-6, mu_pa, lambda_pa, tag: object, ..Default::default() }
    }

    #[test]
    fn what_is_too_stiff_is_brought_to_what_is_carried_once() {
        let settings = Settings::new(0.02);
        let mut states = vec![particle(0, 1e5, 0.3), particle(1, 1e12, 0.3), particle(1, 5e11, 0.3)];
        let softened = afford(&mut states, &settings, 0.0);
        assert_eq!(softened.len(), 1);
        assert_eq!(softened[0].object, 1);
        assert!((young_pa(&states[0]) - 1e5).abs() < 1.0);
        let carried_s = f64::from(settings.cfl * settings.cell_m / wave_speed_m_s(&states[1]));
        assert!((carried_s / shortest_s(&settings) - 1.0).abs() < 1e-3, "{carried_s}");
        assert!((softened[0].value / young_pa(&states[1]) - 1.0).abs() < 1e-3);
        let mut drop = [Substance::Liquid { viscosity_pa_s: 1e-3, surface_tension_n_m: 1e9 }];
        let tension = slacken(&mut drop, &states[..1], &settings, 0.0);
        let Substance::Liquid { surface_tension_n_m: sigma, .. } = drop[0] else { unreachable!() };
        let modulus_pa = std::f32::consts::TAU * sigma / settings.cell_m;
        let carried_s = f64::from(settings.cfl * settings.cell_m / (modulus_pa / 1000.0).sqrt());
        assert!((carried_s / shortest_s(&settings) - 1.0).abs() < 1e-3, "{carried_s}");
        assert_eq!((tension[0].what, tension[0].value), (Taut::SurfaceTension, sigma));
        assert!(slacken(&mut drop, &states[..1], &settings, 0.0).is_empty());
        let kept = states.clone();
        assert!(afford(&mut states, &settings, 1.0).is_empty());
        assert_eq!(states, kept);
    }
}
