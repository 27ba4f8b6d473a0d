//! The passes of rigid bodies in plain Rust: the same algorithm, a body and a manifold after another.

pub mod meeting;

use super::body::{Assembly, Body, Contact, Manifold, Shape};
use crate::solver::constants::*;
use crate::solver::obstacles::ColliderRecord;
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use glam::{IVec3, Mat3, Quat, Vec3, Vec4};

const NOWHERE: f32 = 1e30;
const SLOTS: usize = RIGID_SLOTS as usize;

/// Everything around the bodies.
pub struct World<'a> {
    pub all: &'a Assembly,
    pub substances: &'a [Substance],
    pub colliders: &'a [ColliderRecord],
    pub gravity_m_s2: Vec3,
    pub accelerations: &'a [Vec3],
    pub dt_s: f32,
    pub speed_most_m_s: f32,
}

fn xyz(v: &[f32; 4]) -> Vec3 {
    Vec3::from_slice(v)
}

fn turn(body: &Body) -> Quat {
    Quat::from_array(body.turn)
}

pub fn spin_of(shape: &Shape, q: Quat, momentum: Vec3) -> Vec3 {
    q * (shape.inverse() * (q.inverse() * momentum))
}

fn spin(shape: &Shape, body: &Body) -> Vec3 {
    spin_of(shape, turn(body), xyz(&body.angular_momentum))
}

struct Facing {
    distance_m: f32,
    normal: Vec3,
}

struct Found {
    local: Vec3,
    gap_m: f32,
    normal: Vec3,
}

impl World<'_> {
    fn facing(&self, bodies: &[Body], other: usize, x: Vec3) -> Facing {
        if let Some(c) = self.colliders.get(other) {
            let beyond = ((x - xyz(&c.at)).abs() - xyz(&c.shape)).max(Vec3::ZERO);
            if c.at[3] == 1.0 && beyond != Vec3::ZERO {
                let normal = (x - xyz(&c.at)).signum() * beyond.normalize();
                return Facing { distance_m: beyond.length(), normal };
            }
            let t = c.touch(x);
            return Facing { distance_m: t.distance_m, normal: c.normal(t.face, x) };
        }
        let b = other - self.colliders.len();
        let q = turn(&bodies[b]);
        let level = self.all.fields[b].at(q.inverse() * (x - xyz(&bodies[b].centre_m)));
        let size = level.gradient.length().max(1e-6);
        Facing { distance_m: level.distance_m / size, normal: q * level.gradient / size }
    }

    fn slide(&self, bodies: &[Body], a: usize, other: usize, start: Vec3, margin_m: f32) -> Found {
        let (q, centre, field) = (turn(&bodies[a]), xyz(&bodies[a].centre_m), &self.all.fields[a]);
        let mut step_m = self.all.shapes[a].apart_m;
        let mut x = start;
        let mut seen = self.facing(bodies, other, centre + q * x);
        let mut far = seen.distance_m > margin_m + 0.35 * step_m;
        if seen.distance_m > margin_m + step_m {
            return Found { local: x, gap_m: NOWHERE, normal: seen.normal };
        }
        let mut rounds = RIGID_SLIDES;
        let mut outward = Vec3::ZERO;
        for k in 0..2 * RIGID_SLIDES {
            let level = field.at(x);
            let size2 = level.gradient.length_squared().max(1e-6);
            x -= level.gradient * (level.distance_m / size2);
            outward = level.gradient / size2.sqrt();
            let n = q.inverse() * seen.normal;
            let down = outward * n.dot(outward) - n;
            let tilt = down.length();
            if tilt < 1e-4 || k + 1 == rounds {
                break;
            }
            let d = down / tilt;
            let ahead = x + d * step_m;
            let there = q.inverse() * self.facing(bodies, other, centre + q * ahead).normal;
            let bend = (field.at(ahead).gradient.normalize() - outward + there - n).dot(d);
            x += d * (step_m * (tilt / bend.max(0.05)).min(1.0));
            if bend > RIGID_SHARP {
                (far, rounds, step_m) = (false, 2 * RIGID_SLIDES, 0.5 * step_m);
            } else if far {
                return Found { local: x, gap_m: NOWHERE, normal: seen.normal };
            }
            seen = self.facing(bodies, other, centre + q * x);
        }
        seen = self.facing(bodies, other, centre + q * x);
        let rest_m = if other < self.colliders.len() { bodies[a].low_m[3] } else { 0.0 };
        let gap_m = if (q * outward).dot(seen.normal) > 0.2 { NOWHERE } else { seen.distance_m - rest_m };
        Found { local: x, gap_m, normal: seen.normal }
    }

    fn reach_m_s(&self, bodies: &[Body], b: usize) -> f32 {
        let shape = &self.all.shapes[b];
        xyz(&bodies[b].velocity_m_s).length() + shape.radius_m * spin(shape, &bodies[b]).length()
    }

    fn margin_m(&self, bodies: &[Body], a: usize, other: usize) -> f32 {
        let body = other.checked_sub(self.colliders.len());
        let closing = self.reach_m_s(bodies, a) + body.map_or(0.0, |b| self.reach_m_s(bodies, b));
        self.dt_s * (closing + 2.0 * self.dt_s * self.gravity_m_s2.length()) + 0.05 * self.all.shapes[a].apart_m
    }

    fn within_reach(&self, bodies: &[Body], a: usize, other: usize) -> bool {
        let (x, shapes) = (xyz(&bodies[a].centre_m), &self.all.shapes);
        let margin_m = self.margin_m(bodies, a, other);
        match self.colliders.get(other) {
            Some(c) => c.touch(x).distance_m < shapes[a].radius_m + margin_m,
            None => {
                let b = other - self.colliders.len();
                shapes[a].object != shapes[b].object && x.distance(xyz(&bodies[b].centre_m)) < shapes[a].radius_m + shapes[b].radius_m + margin_m
            }
        }
    }

    /// `rigid_contacts.wgsl`, with the manifolds and contacts of the substep before.
    pub fn contacts(&self, bodies: &[Body], manifolds: &mut [Manifold], contacts: &mut [Contact]) {
        for a in 0..bodies.len() {
            let old: Vec<Old> = (0..4 * SLOTS)
                .map(|k| (a * SLOTS + k / 4, k % 4))
                .filter(|&(slot, k)| k < manifolds[slot].count as usize)
                .map(|(slot, k)| (manifolds[slot].other, contacts[4 * slot + k].local, contacts[4 * slot + k].impulse))
                .collect();
            let mut old: Vec<_> = old.into_iter().map(Some).collect();
            let others = (0..self.colliders.len() + bodies.len()).filter(|&o| o != self.colliders.len() + a && self.within_reach(bodies, a, o));
            manifolds[a * SLOTS..][..SLOTS].iter_mut().for_each(|m| m.count = 0);
            let mut gaps_m: Vec<f32> = Vec::new();
            for other in others {
                let chosen = self.chosen(bodies, a, other);
                let Some(gap_m) = chosen.first().map(|f| f.gap_m) else { continue };
                let slot = if gaps_m.len() < SLOTS {
                    gaps_m.push(gap_m);
                    gaps_m.len() - 1
                } else {
                    let farthest = (0..SLOTS).rev().max_by(|&i, &j| gaps_m[i].total_cmp(&gaps_m[j])).unwrap();
                    if gap_m >= gaps_m[farthest] {
                        continue;
                    }
                    gaps_m[farthest] = gap_m;
                    farthest
                };
                let slot = a * SLOTS + slot;
                for (c, found) in chosen.iter().enumerate() {
                    contacts[4 * slot + c] = self.contact(bodies, a, other, found, &mut old);
                }
                let shape = &self.all.shapes[a];
                let (friction, restitution) = match self.colliders.get(other) {
                    Some(c) => (c.surface[0], c.surface[1]),
                    None => (self.all.shapes[other - self.colliders.len()].friction, self.all.shapes[other - self.colliders.len()].restitution),
                };
                manifolds[slot] = Manifold {
                    other: other as u32,
                    count: chosen.len() as u32,
                    friction: (shape.friction * friction).sqrt(),
                    restitution: shape.restitution.max(restitution),
                    ..Default::default()
                };
            }
        }
    }

    fn contact(&self, bodies: &[Body], a: usize, other: usize, found: &Found, old: &mut [Option<Old>]) -> Contact {
        let apart_m = self.all.shapes[a].apart_m;
        let mut nearest: Option<(f32, usize)> = None;
        for (i, (with, local, _)) in old.iter().enumerate().filter_map(|(i, o)| o.as_ref().map(|o| (i, o))) {
            let d2 = (xyz(local) - found.local).length_squared();
            if *with == other as u32 && d2 < nearest.map_or(apart_m * apart_m, |n| n.0) {
                nearest = Some((d2, i));
            }
        }
        let impulse = nearest.and_then(|(_, i)| old[i].take()).map_or([0.0; 4], |o| o.2);
        let arm = turn(&bodies[a]) * found.local;
        let arm_other = match other.checked_sub(self.colliders.len()) {
            Some(b) => arm + (xyz(&bodies[a].centre_m) - xyz(&bodies[b].centre_m)),
            None => Vec3::ZERO,
        };
        Contact {
            local: found.local.extend(found.gap_m).into(),
            normal: found.normal.extend(0.0).into(),
            arm: arm.extend(0.0).into(),
            arm_other: arm_other.extend(0.0).into(),
            grip: [0.0; 4],
            impulse,
        }
    }

    /// At most four points: the deepest, the farthest from it, and the two that widen them most.
    fn chosen(&self, bodies: &[Body], a: usize, other: usize) -> Vec<Found> {
        let (shape, margin_m) = (&self.all.shapes[a], self.margin_m(bodies, a, other));
        let points = &self.all.points[shape.first_point as usize..][..shape.points as usize];
        let mut found: Vec<Found> = points.iter().map(|p| self.slide(bodies, a, other, xyz(p), margin_m)).filter(|f| f.gap_m < margin_m).collect();
        let least = 0.25 * shape.apart_m;
        let mut kept: Vec<Found> = Vec::new();
        while kept.len() < 4 {
            let value = |f: &Found| match kept.as_slice() {
                [] => -f.gap_m,
                [p] => f.local.distance(p.local),
                [p, q] => (f.local - p.local).cross(q.local - p.local).length() / p.local.distance(q.local).max(1e-20),
                [p, q, r, ..] => outside(f.local, p.local, q.local, r.local),
            };
            let floor = if kept.is_empty() { f32::NEG_INFINITY } else { least };
            let mut best: Option<(usize, f32)> = None;
            for (i, v) in found.iter().map(value).enumerate() {
                if v > best.map_or(floor, |b| b.1) {
                    best = Some((i, v));
                }
            }
            let Some((next, _)) = best else { break };
            kept.push(found.remove(next));
        }
        kept
    }
}

fn outside(p: Vec3, a: Vec3, b: Vec3, c: Vec3) -> f32 {
    let up = (b - a).cross(c - a);
    let m = up / up.length().max(1e-15);
    let beyond = |from: Vec3, to: Vec3| (to - from).normalize().cross(m).dot(p - from);
    beyond(a, b).max(beyond(b, c)).max(beyond(c, a))
}

/// A contact of the substep before: with whom, where, its impulse.
type Old = (u32, [f32; 4], [f32; 4]);

/// A body inside the solver.
#[derive(Clone, Copy)]
struct Moving {
    v: Vec3,
    omega: Vec3,
    lightness: f32,
    ease: Mat3,
    kept: Vec3,
    old_turn: Quat,
    /// Gravity alone moves it.
    flies: bool,
    /// Twice its energy before contacts.
    had: f32,
    /// Whether it meets something, and nothing that moves.
    meets_still: bool,
}

struct Solve<'a> {
    world: &'a World<'a>,
    moving: Vec<Moving>,
    manifolds: &'a [Manifold],
    contacts: &'a mut [Contact],
}

impl Solve<'_> {
    fn other(&self, m: usize) -> Option<usize> {
        (self.manifolds[m].other as usize).checked_sub(self.world.colliders.len())
    }

    fn relative(&self, m: usize, c: &Contact) -> Vec3 {
        let a = &self.moving[m / SLOTS];
        let v = a.v + a.omega.cross(xyz(&c.arm));
        self.other(m).map_or(v, |b| v - self.moving[b].v - self.moving[b].omega.cross(xyz(&c.arm_other)))
    }

    fn push(&mut self, m: usize, c: &Contact, impulse: Vec3) {
        let a = &mut self.moving[m / SLOTS];
        a.v += impulse * a.lightness;
        a.omega += a.ease * xyz(&c.arm).cross(impulse);
        if let Some(b) = self.other(m) {
            let b = &mut self.moving[b];
            b.v -= impulse * b.lightness;
            b.omega -= b.ease * xyz(&c.arm_other).cross(impulse);
        }
    }

    fn ease(&self, m: usize, c: &Contact, d: Vec3, e: Vec3) -> f32 {
        let one = |body: &Moving, arm: Vec3| body.lightness * d.dot(e) + (body.ease * arm.cross(d)).dot(arm.cross(e));
        one(&self.moving[m / SLOTS], xyz(&c.arm)) + self.other(m).map_or(0.0, |b| one(&self.moving[b], xyz(&c.arm_other)))
    }

    /// Every contact of every manifold, colour after colour.
    fn sweep(&mut self, order: &[usize], mut act: impl FnMut(&mut Self, usize, usize)) {
        for &m in order {
            for k in 0..self.manifolds[m].count as usize {
                act(self, m, 4 * m + k);
            }
        }
    }

    fn prepare(&mut self, m: usize, at: usize) {
        let c = self.contacts[at];
        let n = xyz(&c.normal);
        let t = tangent(n);
        let s = n.cross(t);
        let (tt, ts, ss) = (self.ease(m, &c, t, t), self.ease(m, &c, t, s), self.ease(m, &c, s, s));
        let most = 0.5 * (tt + ss) + (0.25 * (tt - ss).powi(2) + ts * ts).sqrt();
        let ease = self.ease(m, &c, n, n);
        let approach = -self.relative(m, &c).dot(n);
        let c = &mut self.contacts[at];
        c.arm[3] = if ease > 0.0 { 1.0 / ease } else { 0.0 };
        c.grip = [if most > 0.0 { 1.0 / most } else { 0.0 }, 0.0, 0.0, 0.0];
        c.normal[3] = approach;
        let held = xyz(&c.impulse);
        c.impulse = (held - n * held.dot(n)).extend(c.impulse[3]).into();
    }

    fn solve(&mut self, m: usize, at: usize, biased: bool) {
        let c = self.contacts[at];
        let (n, gap_m, shape) = (xyz(&c.normal), c.local[3], &self.world.all.shapes[m / SLOTS]);
        let dt_s = self.world.dt_s;
        let omega = std::f32::consts::TAU * RIGID_HERTZ.min(0.25 / dt_s);
        let one = 2.0 * RIGID_DAMPING + dt_s * omega;
        let two = dt_s * omega * one;
        let three = 1.0 / (1.0 + two);
        let closed = !biased && c.grip[3] > 0.0;
        let (mut bias, mut share, mut back) = (if closed { 0.0 } else { gap_m.max(0.0) / dt_s }, 1.0, 0.0);
        if biased && gap_m < 0.0 {
            (bias, share, back) = ((omega / one * gap_m).max(-RIGID_PUSH_RATE * shape.radius_m), two * three, three);
        }
        let approach = self.relative(m, &c).dot(n);
        let mut wanted = c.impulse[3] - c.arm[3] * share * (approach + bias) - back * c.impulse[3];
        if gap_m < 0.0 {
            wanted = wanted.max(c.impulse[3] - c.arm[3] * approach);
        }
        let normal = wanted.max(0.0);
        self.push(m, &c, n * (normal - c.impulse[3]));
        let v = self.relative(m, &c);
        let along = (xyz(&c.impulse) - (v - n * v.dot(n)) * c.grip[0]).clamp_length_max(self.manifolds[m].friction * normal);
        self.push(m, &c, along - xyz(&c.impulse));
        self.contacts[at].impulse = along.extend(normal).into();
        self.contacts[at].grip[3] = c.grip[3].max(normal);
    }

    fn bounce(&mut self, m: usize, at: usize) {
        let c = self.contacts[at];
        let restitution = self.manifolds[m].restitution;
        let resting = 4.0 * self.world.gravity_m_s2.length() * self.world.dt_s;
        if restitution == 0.0 || c.normal[3] < resting || c.grip[3] == 0.0 {
            return;
        }
        let n = xyz(&c.normal);
        let more = (-c.arm[3] * (self.relative(m, &c).dot(n) - restitution * c.normal[3])).max(-c.impulse[3]);
        self.push(m, &c, n * more);
        self.contacts[at].impulse[3] += more;
    }
}

fn tangent(n: Vec3) -> Vec3 {
    n.cross(if n.x.abs() > 0.6 { Vec3::Y } else { Vec3::X }).normalize()
}

impl World<'_> {
    /// `rigid_solve.wgsl`; `given` is what the grid gives each body.
    pub fn solve(&self, bodies: &mut [Body], manifolds: &[Manifold], contacts: &mut [Contact], given: &[(Vec3, Vec3)]) {
        let moving = bodies.iter_mut().zip(&self.all.shapes).zip(given).map(|((b, s), g)| self.drive(b, s, g)).collect();
        let mut solve = Solve { world: self, moving, manifolds, contacts };
        let mut order: Vec<(u32, usize)> = self.colours(manifolds);
        for &(_, m) in &order {
            let other = solve.other(m);
            solve.moving[m / SLOTS].flies = false;
            solve.moving[m / SLOTS].meets_still = solve.moving[m / SLOTS].lightness > 0.0;
            other.into_iter().for_each(|b| solve.moving[b].flies = false);
        }
        for (_, m) in &order {
            if let Some(b) = solve.other(*m) {
                (solve.moving[b].meets_still, solve.moving[m / SLOTS].meets_still) = (false, false);
            }
        }
        order.sort_unstable();
        let order: Vec<usize> = order.into_iter().map(|(_, m)| m).collect();
        solve.sweep(&order, Solve::prepare);
        solve.sweep(&order, |s, m, at| {
            let c = s.contacts[at];
            s.push(m, &c, xyz(&c.impulse) + xyz(&c.normal) * c.impulse[3]);
        });
        for _ in 0..RIGID_ROUNDS {
            solve.sweep(&order, |s, m, at| s.solve(m, at, true));
        }
        let mut moving = std::mem::take(&mut solve.moving);
        for ((body, m), shape) in bodies.iter_mut().zip(&mut moving).zip(&self.all.shapes) {
            self.travel(body, m, shape);
        }
        solve.moving = moving;
        for _ in 0..RIGID_CALM_ROUNDS {
            solve.sweep(&order, |s, m, at| s.solve(m, at, false));
        }
        solve.sweep(&order, Solve::bounce);
        for ((body, m), shape) in bodies.iter_mut().zip(&solve.moving).zip(&self.all.shapes) {
            let momentum = momentum(m, shape, m.old_turn);
            let energy = m.v.length_squared() * shape.mass_kg() + momentum.dot(m.omega);
            let share = if m.meets_still && energy > m.had { (m.had / energy).sqrt() } else { 1.0 };
            body.velocity_m_s = (m.v * share).extend(body.velocity_m_s[3]).into();
            body.angular_momentum = (momentum * share).extend(0.0).into();
        }
    }

    fn drive(&self, body: &mut Body, shape: &Shape, given: &(Vec3, Vec3)) -> Moving {
        let q = turn(body);
        if body.velocity_m_s[3] != 0.0 {
            body.angular_momentum = [0.0; 4];
            return Moving {
                v: xyz(&body.velocity_m_s),
                omega: Vec3::ZERO,
                lightness: 0.0,
                ease: Mat3::ZERO,
                kept: Vec3::ZERO,
                old_turn: q,
                flies: false,
                had: 0.0,
                meets_still: false,
            };
        }
        let v = xyz(&body.velocity_m_s) + given.0 / shape.mass_kg() + (self.gravity_m_s2 + self.accelerations[shape.object as usize]) * self.dt_s;
        let kept = xyz(&body.angular_momentum) + given.1;
        let rim = shape.radius_m * spin_of(shape, q, kept).length();
        let followed = (self.speed_most_m_s / (v.length() + rim).max(1e-30)).min(1.0);
        let (v, kept) = (v * followed, kept * followed);
        let r = Mat3::from_quat(q);
        let omega = spin_of(shape, q, kept);
        Moving {
            v,
            omega,
            lightness: 1.0 / shape.mass_kg(),
            ease: r * shape.inverse() * r.transpose(),
            kept,
            old_turn: q,
            flies: shape.bonded == 0 && *given == (Vec3::ZERO, Vec3::ZERO),
            had: v.length_squared() * shape.mass_kg() + kept.dot(omega),
            meets_still: false,
        }
    }

    fn travel(&self, body: &mut Body, m: &mut Moving, shape: &Shape) {
        let acceleration = self.gravity_m_s2 + self.accelerations[shape.object as usize];
        let late = if m.flies { acceleration * (0.5 * self.dt_s) } else { Vec3::ZERO };
        let low = xyz(&body.low_m) + (m.v - late) * self.dt_s;
        let quanta = (low / RIGID_QUANTUM_M).round();
        let sum = IVec3::from_slice(&body.whole) + quanta.as_ivec3();
        let a_metre = 1 << RIGID_QUANTUM_BITS;
        let whole = IVec3::from_array(sum.to_array().map(|q| q.rem_euclid(a_metre)));
        let metre = IVec3::from_slice(&body.metre) + (sum - whole) / a_metre;
        (body.metre, body.whole) = (metre.extend(0).into(), whole.extend(0).into());
        body.low_m = (low - quanta * RIGID_QUANTUM_M).extend(body.low_m[3]).into();
        body.centre_m = (metre.as_vec3() + (whole.as_vec3() * RIGID_QUANTUM_M + xyz(&body.low_m))).extend(0.0).into();
        let momentum = momentum(m, shape, m.old_turn);
        let mut omega = m.omega;
        if m.lightness != 0.0 {
            for _ in 0..4 {
                omega = spin_of(shape, advanced(m.old_turn, omega, 0.5 * self.dt_s), momentum);
            }
        }
        body.turn = advanced(m.old_turn, omega, self.dt_s).into();
    }

    /// Manifolds with a contact, and the colour of each.
    fn colours(&self, manifolds: &[Manifold]) -> Vec<(u32, usize)> {
        let mut taken = vec![0u128; self.all.shapes.len()];
        let mut colours = Vec::new();
        for (m, manifold) in manifolds.iter().enumerate().filter(|(_, m)| m.count > 0) {
            let other = (manifold.other as usize).checked_sub(self.colliders.len());
            let used = taken[m / SLOTS] | other.map_or(0, |b| taken[b]);
            let colour = used.trailing_ones();
            let bit = 1u128.checked_shl(colour).unwrap_or(0);
            taken[m / SLOTS] |= bit;
            other.into_iter().for_each(|b| taken[b] |= bit);
            colours.push((colour, m));
        }
        colours
    }
}

fn momentum(m: &Moving, shape: &Shape, q: Quat) -> Vec3 {
    m.kept + q * (shape.inertia() * (q.inverse() * (m.omega - spin_of(shape, q, m.kept))))
}

fn advanced(q: Quat, omega: Vec3, dt_s: f32) -> Quat {
    (Quat::from_scaled_axis(omega * dt_s) * q).normalize()
}

/// `rigid_place.wgsl`: position, velocity, affine momentum and F of a body's particle.
pub fn place(state: &mut ParticleState, body: &Body, shape: &Shape, anchor: Vec3) {
    let (q, omega) = (turn(body), spin(shape, body));
    let arm = q * anchor;
    state.position_m = xyz(&body.centre_m) + arm;
    state.velocity_m_s = xyz(&body.velocity_m_s) + omega.cross(arm);
    let turning = Mat3::from_cols(Vec3::new(0.0, omega.z, -omega.y), Vec3::new(-omega.z, 0.0, omega.x), Vec3::new(omega.y, -omega.x, 0.0));
    state.set_affine(turning * state.mass_kg);
    state.set_f(Mat3::from_quat(q));
}

/// Largest difference of two vectors of four.
pub fn apart(a: &[f32; 4], b: &[f32; 4]) -> f32 {
    (Vec4::from_array(*a) - Vec4::from_array(*b)).abs().max_element()
}
