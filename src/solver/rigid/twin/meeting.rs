//! The exchange of bodies and soft matter in plain Rust, on the map of nodes of the solver's own twin.

use super::{World, spin_of, turn, xyz};
use crate::solver::constants::{REST_CELLS, RIGID_LANES};
use crate::solver::core::Params;
use crate::solver::rigid::body::{Body, Shape};
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use crate::solver::twin::{self, Grid, Node};
use glam::{DMat3, DVec3, Vec3};
use std::collections::BTreeMap;

/// What particles leave at a node.
#[derive(Clone, Copy, Debug, Default)]
struct Near {
    /// Of the body that it hangs on, and of the one that it touches.
    bonded_kg: f64,
    touched_kg: f64,
    /// Gap and body of the nearest soft particle, and whether it slides.
    contact: Option<(f32, usize, bool)>,
    bond: Option<usize>,
}

/// A node that meets a body.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    pub body: usize,
    /// Zero where it is bonded.
    pub normal: Vec3,
    slides: bool,
    allowed_m_s: f32,
    rigid_kg: f64,
    impulse: DVec3,
}

type Nodes = BTreeMap<[i32; 3], Near>;

/// What comes of it.
pub struct Exchange {
    pub meetings: BTreeMap<[i32; 3], Meeting>,
    /// Velocity and spin that each body will have.
    pub predicted: Vec<(DVec3, DVec3)>,
    /// Momentum and angular momentum that each body is given.
    pub given: Vec<(DVec3, DVec3)>,
}

fn place_of(node: &[i32; 3], params: &Params) -> Vec3 {
    Vec3::new(node[2] as f32, node[1] as f32, node[0] as f32) * params.cell_m
}

impl World<'_> {
    /// All passes of the exchange; the nodes' momenta change.
    pub fn exchange(&self, bodies: &[Body], states: &[ParticleState], grid: &mut Grid, params: &Params) -> Exchange {
        let nears = self.nears(bodies, states, grid, params);
        let mut meetings = self.meetings(bodies, &nears, grid, params);
        let predicted = self.predicted(bodies, &meetings, grid, params);
        self.couple(bodies, &predicted, &mut meetings, grid, params);
        self.take(bodies, &predicted, &mut meetings, grid, params);
        let mut given = vec![(DVec3::ZERO, DVec3::ZERO); bodies.len()];
        self.members(bodies, &meetings, params, |b, share, _, meeting, r| {
            given[b].0 += meeting.impulse * share;
            given[b].1 += r.cross(meeting.impulse * share);
        });
        Exchange { meetings, predicted, given }
    }

    /// `rigid_share.wgsl` and `rigid_mark.wgsl`.
    fn nears(&self, bodies: &[Body], states: &[ParticleState], grid: &Grid, params: &Params) -> Nodes {
        let mut nears = Nodes::new();
        for s in states.iter().filter(|s| !s.is_rigid()) {
            self.mark(bodies, s, &mut nears, params);
        }
        for (k, member) in self.all.members.iter().enumerate().filter(|(_, m)| m[3] > 0.0) {
            let b = self.all.owners[k / RIGID_LANES as usize] as usize;
            for (node, weight, _) in twin::stencil(xyz(&bodies[b].centre_m) + turn(&bodies[b]) * xyz(member), params) {
                let Some(near) = nears.get_mut(&node).filter(|_| grid.contains_key(&node)) else { continue };
                let kg = f64::from(weight * member[3]);
                near.bonded_kg += if near.bond == Some(b) { kg } else { 0.0 };
                near.touched_kg += if near.contact.is_some_and(|c| c.1 == b) { kg } else { 0.0 };
            }
        }
        nears
    }

    fn mark(&self, bodies: &[Body], s: &ParticleState, nears: &mut Nodes, params: &Params) {
        let (mut contact, mut bond): (Option<(f32, usize, Vec3)>, Option<usize>) = (None, None);
        let loose = matches!(self.substances[s.substance()], Substance::Liquid { .. } | Substance::Sand { .. } | Substance::Snow { .. });
        for (b, (body, shape)) in bodies.iter().zip(&self.all.shapes).enumerate() {
            let d = s.position_m - xyz(&body.centre_m);
            if d.length() > shape.radius_m + 2.0 * params.cell_m {
                continue;
            }
            let level = self.all.fields[b].at(turn(body).inverse() * d);
            let gap_m = level.distance_m - REST_CELLS * params.cell_m;
            if shape.object == s.object() && !loose {
                bond = if level.distance_m < 2.0 * params.cell_m { Some(b) } else { bond };
            } else if gap_m < params.reach_m && contact.is_none_or(|c| gap_m < c.0) {
                contact = Some((gap_m, b, turn(body) * level.gradient.normalize()));
            }
        }
        for (node, _, d) in twin::stencil(s.position_m, params) {
            let near = nears.entry(node).or_default();
            if let Some((gap_m, b, _)) = contact.filter(|c| c.2.dot(d) <= 0.5 && near.contact.is_none_or(|n| c.0 < n.0)) {
                near.contact = Some((gap_m, b, s.mu_pa == 0.0));
            }
            near.bond = near.bond.max(bond);
        }
    }

    /// `rigid_touch.wgsl`.
    fn meetings(&self, bodies: &[Body], nears: &Nodes, grid: &Grid, params: &Params) -> BTreeMap<[i32; 3], Meeting> {
        let mut meetings = BTreeMap::new();
        for (node, near) in nears {
            let Some(soft) = grid.get(node) else { continue };
            let meeting = |body, rigid_kg, normal, allowed_m_s, slides| Meeting { body, normal, slides, allowed_m_s, rigid_kg, impulse: DVec3::ZERO };
            if let Some(b) = near.bond.filter(|_| near.bonded_kg > 0.0 && near.bonded_kg >= 0.25 * soft.mass) {
                meetings.insert(*node, meeting(b, near.bonded_kg, Vec3::ZERO, 0.0, false));
            } else if let Some((gap_m, b, slides)) = near.contact.filter(|_| near.touched_kg > 0.0) {
                let gap_m = gap_m.max(-params.reach_m);
                let x = place_of(node, params);
                let body = &bodies[b];
                let level = self.all.fields[b].at(turn(body).inverse() * (x - xyz(&body.centre_m)));
                let normal = turn(body) * level.gradient.normalize();
                let opening = 4.0 * self.gravity_m_s2.length() * self.dt_s;
                let allowed = if gap_m < 0.0 { (-0.1 * gap_m / self.dt_s).min(opening) } else { -gap_m / self.dt_s };
                let arm = x - xyz(&body.centre_m);
                let own = xyz(&body.velocity_m_s) + spin_of(&self.all.shapes[b], turn(body), xyz(&body.angular_momentum)).cross(arm);
                if ((soft.momentum / soft.mass).as_vec3() - own).dot(normal) < allowed {
                    meetings.insert(*node, meeting(b, near.touched_kg, normal, allowed, slides));
                }
            }
        }
        meetings
    }

    /// Every member's share of every meeting that it reaches: body, share, node, meeting, arm.
    fn members(
        &self,
        bodies: &[Body],
        meetings: &BTreeMap<[i32; 3], Meeting>,
        params: &Params,
        mut act: impl FnMut(usize, f64, &[i32; 3], &Meeting, DVec3),
    ) {
        for (k, member) in self.all.members.iter().enumerate().filter(|(_, m)| m[3] > 0.0) {
            let b = self.all.owners[k / RIGID_LANES as usize] as usize;
            let x = xyz(&bodies[b].centre_m) + turn(&bodies[b]) * xyz(member);
            for (node, weight, _) in twin::stencil(x, params) {
                if let Some(meeting) = meetings.get(&node).filter(|m| m.body == b) {
                    let arm = (place_of(&node, params) - xyz(&bodies[b].centre_m)).as_dvec3();
                    act(b, f64::from(weight * member[3]) / meeting.rigid_kg, &node, meeting, arm);
                }
            }
        }
    }

    /// `rigid_predict.wgsl` and `rigid_meet.wgsl`: each body and its nodes as one rigid thing.
    fn predicted(&self, bodies: &[Body], meetings: &BTreeMap<[i32; 3], Meeting>, grid: &Grid, params: &Params) -> Vec<(DVec3, DVec3)> {
        let own = |(body, shape): (&Body, &Shape)| {
            (xyz(&body.velocity_m_s).as_dvec3() * f64::from(shape.mass_kg()), xyz(&body.angular_momentum).as_dvec3())
        };
        let own = bodies.iter().zip(&self.all.shapes).map(own).collect();
        self.joints(bodies, meetings, grid, params, own, |soft, _| soft.momentum)
    }

    /// How each body and its nodes move together with what it has of momentum and angular momentum and what nodes bring.
    fn joints(
        &self,
        bodies: &[Body],
        meetings: &BTreeMap<[i32; 3], Meeting>,
        grid: &Grid,
        params: &Params,
        has: Vec<(DVec3, DVec3)>,
        brings: impl Fn(&Node, &Meeting) -> DVec3,
    ) -> Vec<(DVec3, DVec3)> {
        let cross = |r: DVec3| DMat3::from_cols(DVec3::new(0.0, r.z, -r.y), DVec3::new(-r.z, 0.0, r.x), DVec3::new(r.y, -r.x, 0.0));
        let own = |((body, shape), (p, l)): ((&Body, &Shape), (DVec3, DVec3))| {
            let r = DMat3::from_quat(turn(body).as_dquat());
            (f64::from(shape.mass_kg()), DVec3::ZERO, r * shape.inertia().as_dmat3() * r.transpose(), p, l)
        };
        let mut sums: Vec<_> = bodies.iter().zip(&self.all.shapes).zip(has).map(own).collect();
        self.members(bodies, meetings, params, |b, share, node, meeting, r| {
            let (m, p) = (grid[node].mass * share, brings(&grid[node], meeting) * share);
            sums[b].0 += m;
            sums[b].1 += r * m;
            sums[b].2 -= cross(r) * cross(r) * m;
            sums[b].3 += p;
            sums[b].4 += r.cross(p);
        });
        sums.iter()
            .map(|(mass, moment, inertia, p, l)| {
                let about = *inertia + cross(*moment) * cross(*moment) * (1.0 / mass);
                let omega = about.inverse() * (*l - moment.cross(*p) / *mass);
                ((*p - omega.cross(*moment)) / *mass, omega)
            })
            .collect()
    }

    /// `rigid_even.wgsl` and `rigid_take.wgsl`: what nodes give beyond what takes each body to what was predicted moves both.
    fn take(&self, bodies: &[Body], predicted: &[(DVec3, DVec3)], meetings: &mut BTreeMap<[i32; 3], Meeting>, grid: &mut Grid, params: &Params) {
        let owed = |((body, shape), (v, omega)): ((&Body, &Shape), &(DVec3, DVec3))| {
            let r = DMat3::from_quat(turn(body).as_dquat());
            let turning = r * shape.inertia().as_dmat3() * r.transpose() * *omega - xyz(&body.angular_momentum).as_dvec3();
            ((xyz(&body.velocity_m_s).as_dvec3() - *v) * f64::from(shape.mass_kg()), -turning)
        };
        let owed = bodies.iter().zip(&self.all.shapes).zip(predicted).map(owed).collect();
        let evened = self.joints(bodies, meetings, grid, params, owed, |_, meeting| meeting.impulse);
        for (node, meeting) in meetings {
            let Some(soft) = grid.get_mut(node) else { continue };
            let (velocity, omega) = evened[meeting.body];
            let arm = (place_of(node, params) - xyz(&bodies[meeting.body].centre_m)).as_dvec3();
            meeting.impulse -= (velocity + omega.cross(arm)) * soft.mass;
            soft.momentum -= meeting.impulse;
        }
    }

    /// `rigid_couple.wgsl`.
    fn couple(&self, bodies: &[Body], predicted: &[(DVec3, DVec3)], meetings: &mut BTreeMap<[i32; 3], Meeting>, grid: &Grid, params: &Params) {
        meetings.retain(|node, meeting| {
            let Some(soft) = grid.get(node) else { return false };
            let v = soft.momentum / soft.mass;
            let (velocity, omega) = predicted[meeting.body];
            let body_v = velocity + omega.cross((place_of(node, params) - xyz(&bodies[meeting.body].centre_m)).as_dvec3());
            let mut after = body_v;
            if meeting.normal != Vec3::ZERO {
                let (normal, allowed) = (meeting.normal.as_dvec3(), f64::from(meeting.allowed_m_s));
                let approach = (v - body_v).dot(normal);
                if approach >= allowed {
                    return false;
                }
                let sliding = v - body_v - normal * approach;
                let friction = if meeting.slides { 0.0 } else { f64::from(self.all.shapes[meeting.body].friction) };
                let grip = friction * (allowed - approach);
                after += normal * allowed + sliding * (1.0 - grip / sliding.length().max(1e-20)).max(0.0);
            }
            meeting.impulse = (v - after) * soft.mass;
            true
        });
    }
}
