//! The search for the prestress: one system of conjugate gradients in f64.

use super::laws::resting_stress;
use super::{Grid, Surroundings, gather, p2g};
use crate::solver::constants::{CARRY_MOST, CARRY_SHARE, CARRY_STEPS};
use crate::solver::state::ParticleState;
use glam::{DMat3, DVec3, Vec3};
use std::collections::BTreeMap;

type Field = BTreeMap<[i32; 3], DVec3>;

fn dot(a: &Field, b: &Field) -> f64 {
    a.iter().map(|(node, value)| value.dot(b[node])).sum()
}

/// What a linear solid answers to a strain.
pub fn linear_stress(strain: DMat3, mu: f64, lambda: f64) -> DMat3 {
    let trace = strain.col(0).x + strain.col(1).y + strain.col(2).z;
    strain * (2.0 * mu) + DMat3::IDENTITY * (lambda * trace)
}

fn strain(gradient: DMat3) -> DMat3 {
    (gradient + gradient.transpose()) * 0.5
}

/// Linear stiffness times a displacement, along what is free.
fn product(states: &[ParticleState], field: &Field, held: &dyn Fn(&[i32; 3], DVec3) -> DVec3, around: &Surroundings) -> Field {
    let grid: Grid = field.iter().map(|(node, u)| (*node, super::Node { velocity: u.as_vec3(), ..Default::default() })).collect();
    let mut pushed = states.to_vec();
    for s in &mut pushed {
        let tau = linear_stress(strain(gather(&grid, s.position_m, &around.params).1), f64::from(s.mu_pa), f64::from(s.lambda_pa));
        s.velocity_m_s = Vec3::ZERO;
        s.set_affine((tau * (-4.0 * f64::from(around.params.per_m).powi(2) * f64::from(s.volume_m3))).as_mat3());
    }
    p2g(&pushed, around).into_iter().map(|(node, value)| (node, held(&node, -value.momentum))).collect()
}

/// Displacements after some rounds, from particles whose velocity stands for their weight; nodes that
/// the ground holds keep their height. Each round is `prestress_gather`, `p2g`, `prestress_product`,
/// `prestress_control` and `prestress_update`.
pub fn rounds(states: &[ParticleState], around: &Surroundings, rounds: u32, lightest_kg: f64) -> Field {
    let start = p2g(states, around);
    let held = |node: &[i32; 3], f: DVec3| {
        let stands = start[node].marks[0] != 0 && super::mark_gap_m(start[node].marks[0], &around.params) <= 1e-4 * around.params.cell_m;
        if stands { f.with_z(0.0) } else { f }
    };
    let mass = |node: &[i32; 3]| start[node].mass.max(lightest_kg);
    let precondition = |r: &Field| r.iter().map(|(node, f)| (*node, *f / mass(node))).collect::<Field>();
    let mut residual: Field = start.iter().map(|(node, value)| (*node, held(node, value.momentum))).collect();
    let mut direction = precondition(&residual);
    let mut solution: Field = residual.keys().map(|node| (*node, DVec3::ZERO)).collect();
    let mut gamma = dot(&residual, &direction);
    for _ in 0..rounds {
        let pushed = product(states, &direction, &held, around);
        let alpha = gamma / dot(&pushed, &direction);
        let old = residual.clone();
        for (node, value) in residual.iter_mut() {
            *solution.entry(*node).or_default() += direction[node] * alpha;
            *value -= pushed[node] * alpha;
        }
        let step = precondition(&residual);
        let beta = ((dot(&residual, &step) - dot(&old, &step)) / gamma).max(0.0);
        gamma = dot(&residual, &step);
        direction = step.iter().map(|(node, s)| (*node, *s + direction[node] * beta)).collect();
    }
    solution
}

/// F of a particle after it took over a displacement: `prestress_gather` with its last job.
pub fn adopted(state: &ParticleState, solution: &Field, around: &Surroundings) -> DMat3 {
    let grid: Grid = solution.iter().map(|(node, u)| (*node, super::Node { velocity: u.as_vec3(), ..Default::default() })).collect();
    let (mu, lambda) = (f64::from(state.mu_pa), f64::from(state.lambda_pa));
    let law = |f: DMat3| resting_stress(&around.substances[state.substance()], f, mu, lambda);
    let wanted = law(state.f().as_dmat3()) + linear_stress(strain(gather(&grid, state.position_m, &around.params).1), mu, lambda);
    (0..CARRY_STEPS).fold(state.f().as_dmat3(), |f, _| {
        let missing = wanted - law(f);
        let trace = missing.col(0).x + missing.col(1).y + missing.col(2).z;
        let answer = missing * (0.5 / mu) - DMat3::IDENTITY * (trace * 0.5 * lambda / (mu * (3.0 * lambda + 2.0 * mu)));
        let strain = f - DMat3::IDENTITY + answer * f64::from(CARRY_SHARE);
        let widest = strain.to_cols_array().iter().fold(f64::from(CARRY_MOST), |a, b| a.max(b.abs()));
        DMat3::IDENTITY + strain * (f64::from(CARRY_MOST) / widest)
    })
}
