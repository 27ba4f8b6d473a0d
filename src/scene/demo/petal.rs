//! The parts that flowers are made of: petals, domes, stems.

use super::dab::{Dab, Finish, Paint, cell_dab, cover};
use super::random::Random;
use glam::Vec3;
use std::f32::consts::TAU;

/// Where a part grows and which way: `axis` up the flower, `out` away from it.
#[derive(Clone, Copy)]
pub struct Seat {
    /// Metres, world.
    pub at: Vec3,
    /// Unit.
    pub axis: Vec3,
    /// Unit, across the axis.
    pub out: Vec3,
}

impl Seat {
    /// A place with its outward side turned about the axis, radians.
    pub fn turned(at: Vec3, axis: Vec3, turn: f32) -> Seat {
        let axis = axis.normalize_or(Vec3::Z);
        let (a, b) = axis.any_orthonormal_pair();
        Seat { at, axis, out: a * turn.cos() + b * turn.sin() }
    }
}

/// The shape of a petal or leaf.
#[derive(Clone, Copy)]
pub struct Blade {
    /// Along its middle.
    pub length_m: f32,
    /// Largest half width.
    pub half_width_m: f32,
    /// Angle from the axis at the base and at the tip, radians.
    pub lean: [f32; 2],
    /// How far the sides rise, of the half width.
    pub cup: f32,
    /// Where it is widest, 0..1, and how blunt its tip is: 0 a point.
    pub widest: f32,
    /// 0 pointed to 1 round.
    pub blunt: f32,
    /// Dabs along and across.
    pub cells: [usize; 2],
    /// Of the light.
    pub translucency: f32,
}

impl Blade {
    /// Half width along it.
    fn width(&self, u: f32) -> f32 {
        let rise = (u / self.widest).min(1.0);
        let fall = ((u - self.widest) / (1.0 - self.widest)).max(0.0);
        let tip = (1.0 - fall * fall).max(0.0).sqrt() * self.blunt + (1.0 - fall) * (1.0 + 0.6 * fall) * (1.0 - self.blunt);
        self.half_width_m * (0.22 + 0.78 * rise * (2.0 - rise)) * tip
    }

    /// A point: u along it, v across it, -1..1.
    fn point(&self, seat: &Seat, u: f32, v: f32) -> Vec3 {
        let bend = self.lean[1] - self.lean[0];
        let angle = self.lean[0] + bend * u;
        let (up, out) = if bend.abs() < 1e-3 {
            (u * angle.cos(), u * angle.sin())
        } else {
            ((angle.sin() - self.lean[0].sin()) / bend, (self.lean[0].cos() - angle.cos()) / bend)
        };
        let inner = seat.axis * angle.sin() - seat.out * angle.cos();
        let width = self.width(u);
        seat.at + (seat.axis * up + seat.out * out) * self.length_m + seat.axis.cross(seat.out) * (width * v) + inner * (self.cup * width * v * v)
    }

    /// Its dabs; `colour` by u and v.
    pub fn grow(&self, dabs: &mut Vec<Dab>, random: &mut Random, seat: &Seat, colour: &dyn Fn(f32, f32) -> Vec3) {
        let surface = |u: f32, v: f32| self.point(seat, u, v * 2.0 - 1.0);
        let finish = Finish::Sheet { translucency: self.translucency };
        cover(dabs, self.cells, 0.12, random, &surface, &mut |u, v, _| Some(Paint { albedo: colour(u, v * 2.0 - 1.0), finish, opacity: 0.96 }));
    }
}

/// A stem along a curve, thinner towards its end.
pub fn stem(dabs: &mut Vec<Dab>, curve: &dyn Fn(f32) -> Vec3, radii_m: [f32; 2], cells: [usize; 2], colour: &dyn Fn(f32) -> Vec3) {
    for i in 0..cells[0] {
        let t = (i as f32 + 0.5) / cells[0] as f32;
        let along = curve(t + 0.5 / cells[0] as f32) - curve(t - 0.5 / cells[0] as f32);
        let (a, b) = along.normalize_or(Vec3::Z).any_orthonormal_pair();
        let radius = radii_m[0] + (radii_m[1] - radii_m[0]) * t;
        for j in 0..cells[1] {
            let turn = (j as f32 + 0.5 * (i % 2) as f32) / cells[1] as f32 * TAU;
            let out = a * turn.cos() + b * turn.sin();
            let around = along.normalize_or(Vec3::Z).cross(out) * (TAU * radius / cells[1] as f32);
            let paint = Paint { albedo: colour(t), finish: Finish::Sheet { translucency: 0.05 }, opacity: 0.96 };
            // The first axis of a dab and the second make its normal: around x along points outwards.
            dabs.push(cell_dab(curve(t) + out * radius, around, along, paint));
        }
    }
}

/// A dome over a seat, or a ball.
#[derive(Clone, Copy)]
pub struct Dome {
    /// Across the axis.
    pub radius_m: f32,
    /// Along it.
    pub height_m: f32,
    /// Where it begins: 0 at its rim, -1 as a whole ball.
    pub from: f32,
    /// Dabs.
    pub cells: usize,
}

impl Dome {
    /// Its dabs, from the top down; `colour` by the height, 1 at the top.
    pub fn grow(&self, dabs: &mut Vec<Dab>, random: &mut Random, seat: &Seat, colour: &mut dyn FnMut(f32) -> Vec3) {
        let side = seat.axis.cross(seat.out);
        let step = (1.0 - self.from) / self.cells as f32;
        for i in 0..self.cells {
            // Bands of equal height on a sphere have equal areas.
            let z = 1.0 - step * (i as f32 + 0.5);
            let turn = i as f32 * 2.399_963_2;
            let ring = (1.0 - z * z).max(0.0).sqrt();
            let flat = seat.out * turn.cos() + side * turn.sin();
            let normal = (flat * ring * self.height_m + seat.axis * z * self.radius_m).normalize_or(seat.axis);
            let edge = (TAU * step).sqrt() * self.radius_m.min(self.height_m.max(self.radius_m * 0.6));
            let du = seat.axis.cross(flat).normalize_or(seat.out) * edge;
            let dv = normal.cross(du);
            let centre = seat.at + flat * (ring * self.radius_m) + seat.axis * (z * self.height_m) + normal * random.about(0.0006);
            dabs.push(cell_dab(centre, du, dv, Paint { albedo: colour(z), finish: Finish::Sheet { translucency: 0.1 }, opacity: 0.96 }));
        }
    }
}
