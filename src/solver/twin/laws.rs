//! The laws, in f64 and by other means than the shaders': eigenvectors of F F^T, closed forms.

use super::material::kirchhoff;
use crate::solver::constants::{
    LIQUID_J_LEAST, LIQUID_J_LOOSE, LIQUID_J_MOST, LIQUID_SHOWN_S, LIQUID_STRAIN_MOST, LOOSE_MOST, PACKING_LEAST, PACKING_MOST, RECOIL,
    STRETCH_LEAST, STRETCH_MOST, YIELD_FLOOR,
};
use crate::solver::substance::Substance;
use crate::spec::ElasticModel;
use glam::{DMat3, DVec3};

/// What a particle is, for its law.
#[derive(Clone, Copy, Debug)]
pub struct Matter {
    pub mu: f64,
    pub lambda: f64,
    pub history: f64,
    pub activation: f64,
    /// Of velocity.
    pub gradient: DMat3,
}

/// What stays of a trial F, what is remembered, the Kirchhoff stress.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    pub f: DMat3,
    pub history: f64,
    pub tau: DMat3,
}

pub fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Eigenvalues and vectors of a symmetric matrix by Jacobi's classical turns, largest first, the
/// vectors a rotation.
pub fn eigen(m: DMat3) -> (DVec3, DMat3) {
    let (mut a, mut v) = (m, DMat3::IDENTITY);
    for _ in 0..60 {
        let (p, q) =
            [(0, 1), (0, 2), (1, 2)].into_iter().max_by(|x, y| a.col(x.1)[x.0].abs().total_cmp(&a.col(y.1)[y.0].abs())).expect("three pairs");
        let off = a.col(q)[p];
        if off.abs() <= 1e-300 {
            break;
        }
        let angle = 0.5 * (2.0 * off).atan2(a.col(p)[p] - a.col(q)[q]);
        let mut turn = DMat3::IDENTITY;
        turn.col_mut(p)[p] = angle.cos();
        turn.col_mut(q)[q] = angle.cos();
        turn.col_mut(q)[p] = -angle.sin();
        turn.col_mut(p)[q] = angle.sin();
        a = turn.transpose() * a * turn;
        v *= turn;
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a.col(j)[j].total_cmp(&a.col(i)[i]));
    let values = DVec3::from(order.map(|k| a.col(k)[k]));
    let mut vectors = DMat3::from_cols(v.col(order[0]), v.col(order[1]), v.col(order[2]));
    if vectors.determinant() < 0.0 {
        vectors.z_axis = -vectors.z_axis;
    }
    (values, vectors)
}

/// Principal stretches, the last negative where F is inside out, and their axes after the deformation.
pub fn stretches(f: DMat3) -> (DVec3, DMat3) {
    let (squares, axes) = eigen(f * f.transpose());
    let s = DVec3::new(squares.x.max(0.0).sqrt(), squares.y.max(0.0).sqrt(), squares.z.max(0.0).sqrt());
    (s.with_z(s.z.copysign(f.determinant())), axes)
}

fn sum(v: DVec3) -> f64 {
    v.x + v.y + v.z
}

fn each(v: DVec3, f: impl Fn(f64) -> f64) -> DVec3 {
    DVec3::new(f(v.x), f(v.y), f(v.z))
}

fn principal(axes: DMat3, values: DVec3) -> DMat3 {
    axes * DMat3::from_diagonal(values) * axes.transpose()
}

/// F whose stretches become others along the same axes.
fn restretched(f: DMat3, axes: DMat3, from: DVec3, to: DVec3) -> DMat3 {
    principal(axes, to / from) * f
}

/// From the strain that elasticity would bring to the one that stays; None where all of it stays.
type Yielding<'a> = &'a dyn Fn(DVec3) -> Option<DVec3>;

fn hencky(f: DMat3, m: &Matter, history: f64, yields: Yielding) -> Answer {
    let (s, axes) = stretches(f);
    let cut = each(s, |s| s.clamp(f64::from(STRETCH_LEAST), f64::from(STRETCH_MOST)));
    let strain = each(cut, f64::ln);
    let stays = yields(strain);
    let after = stays.unwrap_or(strain);
    let tau = principal(axes, after * (2.0 * m.mu) + DVec3::splat(m.lambda * sum(after)));
    let f = if stays.is_none() && cut == s { f } else { restretched(f, axes, s, each(after, f64::exp)) };
    Answer { f, history, tau }
}

fn deviator(strain: DVec3) -> DVec3 {
    strain - DVec3::splat(sum(strain) / 3.0)
}

/// `laws.wgsl`: what a law lets stand of a trial F over `dt_s`.
pub fn respond(substance: &Substance, trial: DMat3, m: &Matter, dt_s: f64) -> Answer {
    let root = (2.0f64 / 3.0).sqrt();
    let young = m.mu * (3.0 * m.lambda + 2.0 * m.mu) / (m.lambda + m.mu);
    let elastic = |model: &ElasticModel| kirchhoff(trial, m.mu, m.lambda, *model == ElasticModel::NeoHookean);
    match substance {
        // No particle of it is ever asked.
        Substance::SphLiquid { .. } => Answer { f: trial, history: m.history, tau: DMat3::ZERO },
        Substance::Elastic(model) | Substance::Frozen { model, .. } => Answer { f: trial, history: m.history, tau: elastic(model) },
        // Bodies move their particles; no stress acts on them.
        Substance::Rigid { .. } => Answer { f: trial, history: m.history, tau: DMat3::ZERO },
        Substance::Muscle { model, fibre, .. } => {
            let fibre = trial * fibre.as_dvec3().normalize();
            Answer { f: trial, history: m.history, tau: elastic(model) + outer(fibre, fibre) * (young * m.activation) }
        }
        Substance::Plastic { yield_stress_pa, hardening_pa } => {
            let (y, h) = (f64::from(*yield_stress_pa), f64::from(*hardening_pa));
            let least = f64::from(YIELD_FLOOR) * y;
            let at = |history: f64| (y + h * history).max(least);
            let size = deviator(each(each(stretches(trial).0, |s| s.clamp(f64::from(STRETCH_LEAST), f64::from(STRETCH_MOST))), f64::ln)).length();
            // The slip whose hardened yield stress is what the rest of the strain brings, by halving.
            let missing = |slip: f64| 2.0 * m.mu * (size - slip) - root * at(m.history + root * slip);
            let slip = if missing(0.0) <= 0.0 {
                0.0
            } else {
                let (mut low, mut high) = (0.0, size);
                for _ in 0..100 {
                    let middle = 0.5 * (low + high);
                    if missing(middle) > 0.0 { low = middle } else { high = middle }
                }
                low
            };
            let keep = 1.0 - slip / size.max(1e-300);
            hencky(trial, m, m.history + root * slip, &|e| (slip > 0.0).then(|| e - deviator(e) * (1.0 - keep)))
        }
        Substance::Viscoplastic { yield_stress_pa, viscosity_pa_s } => hencky(trial, m, m.history, &|e| {
            let size = 2.0 * m.mu * deviator(e).length();
            let yielding = root * f64::from(*yield_stress_pa);
            let eta = f64::from(*viscosity_pa_s);
            let after = (size * eta + yielding * m.mu * dt_s) / (eta + m.mu * dt_s);
            (size > yielding && dt_s > 0.0).then(|| e - deviator(e) * (1.0 - after / size))
        }),
        Substance::Sand { friction_angle_deg, cohesion_pa } => {
            let tan = f64::from(*friction_angle_deg).to_radians().tan();
            let bulk = m.lambda + 2.0 / 3.0 * m.mu;
            let tip = f64::from(*cohesion_pa) / tan / bulk;
            let volume_of = |e: DVec3| sum(e) + m.history;
            let strain = each(each(stretches(trial).0, |s| s.clamp(f64::from(STRETCH_LEAST), f64::from(STRETCH_MOST))), f64::ln);
            let history = (volume_of(strain) - tip).clamp(0.0, f64::from(LOOSE_MOST));
            hencky(trial, m, history, &|e| {
                let volume = volume_of(e);
                if volume >= tip {
                    return Some(DVec3::splat(tip / 3.0));
                }
                let (mean, dev) = (DVec3::splat(volume / 3.0), deviator(e));
                let held = std::f64::consts::SQRT_2 * tan * bulk * (tip - volume);
                let share = held / (2.0 * m.mu * dev.length());
                (share < 1.0 || m.history != 0.0).then(|| mean + dev * share.min(1.0))
            })
        }
        Substance::Snow { theta_c, theta_s, hardening } => {
            let (s, axes) = stretches(trial);
            let kept = each(s, |s| s.clamp(1.0 - f64::from(*theta_c), 1.0 + f64::from(*theta_s)));
            let j = kept.x * kept.y * kept.z;
            let mut answer = Answer { f: trial, history: m.history, tau: DMat3::ZERO };
            if kept != s {
                let volume = (s.x * s.y * s.z).max(1e-6);
                answer.history = (m.history * volume / j).clamp(f64::from(PACKING_LEAST), f64::from(PACKING_MOST));
                answer.f = restretched(trial, axes, s, kept);
            }
            let stiffening = (f64::from(*hardening) * (1.0 - answer.history)).exp();
            let stress = each(kept, |s| 2.0 * m.mu * (s - 1.0) * s) + DVec3::splat(m.lambda * j * (j - 1.0));
            answer.tau = principal(axes, stress * stiffening);
            answer
        }
        Substance::Liquid { viscosity_pa_s, .. } => {
            let before = trial.determinant() / (DMat3::IDENTITY + m.gradient * dt_s).determinant().max(0.1);
            let most = before.clamp(f64::from(LIQUID_J_MOST), f64::from(LIQUID_J_LOOSE));
            let j = trial.determinant().clamp(f64::from(LIQUID_J_LEAST), most);
            let relaxing = dt_s * m.lambda / f64::from(*viscosity_pa_s).max(1e-30);
            let (s, axes) = stretches(trial);
            let stretch = principal(axes, s);
            let mean = (stretch.x_axis.x + stretch.y_axis.y + stretch.z_axis.z) / 3.0;
            let strain = (stretch * (1.0 / mean.max(1e-3)) - DMat3::IDENTITY) * (1.0 / (1.0 + relaxing));
            let work = |a: DMat3, b: DMat3| a.to_cols_array().iter().zip(b.to_cols_array()).map(|(a, b)| a * b).sum::<f64>();
            let square = work(strain, strain).max(1e-30);
            let growing = dt_s * work(strain, m.gradient) / square;
            let lasting = if growing < 0.0 { (1.0 + f64::from(RECOIL) * growing).max(0.0) } else { 1.0 };
            let bounded = if trial.determinant() > 0.0 { lasting.min(f64::from(LIQUID_STRAIN_MOST) / square.sqrt()) } else { 0.0 };
            let shape = DMat3::IDENTITY + strain * bounded;
            let size = 2.0 * j * bounded * square.sqrt();
            let tau = DMat3::IDENTITY * (m.lambda * (j - 1.0).min(size)) + strain * (bounded * 2.0 * m.lambda * j);
            Answer { f: shape * (j / shape.determinant()).cbrt(), history: m.history, tau }
        }
    }
}

/// `resting_stress` of `laws.wgsl`: what a law bears as long as nothing yields and no muscle pulls.
pub fn resting_stress(substance: &Substance, f: DMat3, mu: f64, lambda: f64) -> DMat3 {
    let matter = Matter { mu, lambda, history: 0.0, activation: 0.0, gradient: DMat3::ZERO };
    match substance {
        Substance::Plastic { .. } | Substance::Viscoplastic { .. } => hencky(f, &matter, 0.0, &|_| None).tau,
        Substance::Muscle { model, .. } => kirchhoff(f, mu, lambda, *model == ElasticModel::NeoHookean),
        _ => respond(substance, f, &matter, 0.0).tau,
    }
}

/// `g2p_laws.wgsl`: the shown deformation after a substep.
pub fn shown(substance: &Substance, old: DMat3, gradient: DMat3, dt_s: f64) -> DMat3 {
    let Some([least, most]) = substance.shown_stretch() else { return old };
    let f = old + gradient * old * dt_s;
    let (s, axes) = stretches(f);
    let f = restretched(f, axes, s, each(s, |s| s.clamp(f64::from(least), f64::from(most))));
    if substance.is_liquid() { f + (f.inverse().transpose() - f) * (0.5 * (dt_s / f64::from(LIQUID_SHOWN_S)).min(1.0)) } else { f }
}
