//! The bouquet: peonies, daisies, larkspur, billy buttons and eucalyptus, each on a stem of its own.

use super::dab::{Dab, linear};
use super::petal::{Blade, Dome, Seat, stem};
use super::random::Random;
use super::vase::MOUTH_M;
use glam::Vec3;
use std::f32::consts::TAU;

/// What grows on a stem.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Peony,
    Daisy,
    Larkspur,
    Button,
    Eucalyptus,
    Sprig,
    Leaf,
}

/// Kind; azimuth and lean from the vertical, degrees; distance of the head from the middle of the mouth, metres; size.
type Stalk = (Kind, f32, f32, f32, f32);

/// The arrangement. Large heads low and to the front, fine ones high and between.
const STALKS: [Stalk; 36] = [
    (Kind::Peony, 216.0, 44.0, 0.126, 1.19),
    (Kind::Peony, 292.0, 42.0, 0.154, 1.04),
    (Kind::Peony, 142.0, 40.0, 0.162, 1.09),
    (Kind::Peony, 45.0, 44.0, 0.138, 1.14),
    (Kind::Peony, 222.0, 10.0, 0.228, 1.04),
    (Kind::Daisy, 178.0, 58.0, 0.156, 1.15),
    (Kind::Daisy, 254.0, 58.0, 0.168, 1.05),
    (Kind::Daisy, 262.0, 26.0, 0.246, 1.15),
    (Kind::Daisy, 168.0, 24.0, 0.258, 1.10),
    (Kind::Daisy, 85.0, 28.0, 0.240, 1.10),
    (Kind::Daisy, 350.0, 30.0, 0.240, 1.15),
    (Kind::Daisy, 5.0, 60.0, 0.150, 1.05),
    (Kind::Daisy, 95.0, 62.0, 0.156, 1.05),
    (Kind::Larkspur, 140.0, 17.0, 0.196, 1.10),
    (Kind::Larkspur, 290.0, 21.0, 0.190, 1.05),
    (Kind::Larkspur, 40.0, 12.0, 0.213, 1.15),
    (Kind::Button, 196.0, 30.0, 0.247, 1.00),
    (Kind::Button, 278.0, 44.0, 0.218, 0.95),
    (Kind::Button, 60.0, 36.0, 0.236, 1.00),
    (Kind::Button, 318.0, 10.0, 0.287, 1.00),
    (Kind::Button, 130.0, 50.0, 0.213, 0.90),
    (Kind::Eucalyptus, 238.0, 72.0, 0.230, 1.05),
    (Kind::Eucalyptus, 116.0, 60.0, 0.259, 1.10),
    (Kind::Eucalyptus, 326.0, 60.0, 0.247, 1.10),
    (Kind::Eucalyptus, 160.0, 36.0, 0.287, 1.00),
    (Kind::Eucalyptus, 10.0, 34.0, 0.287, 1.00),
    (Kind::Sprig, 160.0, 30.0, 0.196, 1.00),
    (Kind::Sprig, 305.0, 24.0, 0.201, 1.05),
    (Kind::Sprig, 20.0, 26.0, 0.201, 1.05),
    (Kind::Sprig, 230.0, 2.0, 0.172, 1.00),
    (Kind::Leaf, 196.0, 72.0, 0.110, 1.05),
    (Kind::Leaf, 276.0, 68.0, 0.120, 1.05),
    (Kind::Leaf, 156.0, 64.0, 0.115, 1.00),
    (Kind::Leaf, 75.0, 70.0, 0.120, 1.05),
    (Kind::Leaf, 20.0, 72.0, 0.115, 1.00),
    (Kind::Leaf, 320.0, 74.0, 0.105, 0.95),
];

/// Radii of a stem where it leaves the mouth and below its head: thick enough to hold itself up.
const STEM_M: [f32; 2] = [0.0046, 0.0036];

/// All dabs of the bouquet in a vase whose foot stands at `foot`.
pub fn bouquet(seed: u64, foot: Vec3) -> Vec<Dab> {
    let mut dabs = Vec::new();
    let mouth = foot + Vec3::Z * MOUTH_M[0];
    for (index, &(kind, azimuth, lean, reach, size)) in STALKS.iter().enumerate() {
        let mut random = Random::new(seed, 100 + index as u64);
        let (turn, lean) = ((azimuth + random.about(3.0)).to_radians(), (lean + random.about(2.0)).to_radians());
        let side = Vec3::new(turn.cos(), turn.sin(), 0.0);
        let from = mouth + side * (MOUTH_M[1] * 0.62 * (lean / 1.2).min(1.0)) - Vec3::Z * 0.012;
        let head = mouth + (side * lean.sin() + Vec3::Z * lean.cos()) * reach;
        // Rises steeply, then leans out.
        let elbow = from + Vec3::Z * (reach * 0.45) + side * (reach * 0.16 * lean);
        let curve = |t: f32| from * ((1.0 - t) * (1.0 - t)) + elbow * (2.0 * t * (1.0 - t)) + head * (t * t);
        let end = (head - elbow).normalize_or(Vec3::Z);
        grow(&mut dabs, &mut random, kind, &curve, end, reach, size);
    }
    dabs
}

fn grow(dabs: &mut Vec<Dab>, random: &mut Random, kind: Kind, curve: &dyn Fn(f32) -> Vec3, end: Vec3, reach: f32, size: f32) {
    let green = linear(0x5f8f3d).lerp(linear(0x7da654), random.unit());
    let cells = [(reach / 0.0075) as usize, 6];
    match kind {
        Kind::Leaf => return leaf(dabs, random, curve, end, size),
        Kind::Eucalyptus => {
            stem(dabs, curve, [0.0038, 0.0022], cells, &|_| linear(0x7d6a4e));
            return eucalyptus(dabs, random, curve, size);
        }
        Kind::Sprig => {
            stem(dabs, curve, [0.0040, 0.0024], cells, &|_| green);
            return sprig(dabs, random, curve, size);
        }
        Kind::Button => stem(dabs, curve, [0.0042, 0.0034], cells, &|_| green),
        _ => stem(dabs, curve, STEM_M, cells, &|t| green * (0.8 + 0.3 * t)),
    }
    match kind {
        Kind::Peony => peony(dabs, random, curve(1.0), end, size),
        Kind::Daisy => daisy(dabs, random, curve(1.0), (end + Vec3::new(-0.25, -0.12, 0.1)).normalize_or(end), size),
        Kind::Larkspur => larkspur(dabs, random, curve(0.86), end, size),
        _ => button(dabs, random, curve(1.0), end, size),
    }
}

/// Bowls of petals within bowls, closed at the heart, open at the skirt.
fn peony(dabs: &mut Vec<Dab>, random: &mut Random, at: Vec3, axis: Vec3, size: f32) {
    // Petals, lean at base and tip, length and half width in metres, height of the seat.
    const BOWLS: [(usize, [f32; 2], f32, f32, f32); 6] = [
        (4, [0.30, -0.75], 0.026, 0.013, 0.006),
        (5, [0.45, -0.45], 0.031, 0.016, 0.004),
        (6, [0.70, -0.15], 0.035, 0.018, 0.002),
        (7, [0.95, 0.20], 0.038, 0.020, 0.0),
        (8, [1.20, 0.60], 0.041, 0.021, -0.002),
        (8, [1.50, 1.15], 0.043, 0.022, -0.004),
    ];
    let hue = random.unit();
    let (heart, skirt) = (linear(0xc40f45).lerp(linear(0xe02d3c), hue), linear(0xff7c9b).lerp(linear(0xff9a86), hue));
    for (bowl, &(petals, lean, length, half_width, rise)) in BOWLS.iter().enumerate() {
        let first = random.unit() * TAU;
        for petal in 0..petals {
            let turn = first + (petal as f32 + random.about(0.18)) / petals as f32 * TAU;
            let tilt = random.about(0.10);
            let blade = Blade {
                length_m: length * size * (1.0 + random.about(0.08)),
                half_width_m: half_width * size,
                lean: [lean[0] + tilt, lean[1] + tilt + random.about(0.12)],
                cup: 0.42,
                widest: 0.62,
                blunt: 0.9,
                cells: [6, 6],
                translucency: 0.45,
            };
            let depth = bowl as f32 / 5.0;
            let shade = 1.0 + random.about(0.06);
            let colour = |u: f32, v: f32| {
                let pale = (depth * 0.75 + 0.45 * u * u + 0.12 * v * v).min(1.0);
                heart.lerp(skirt, pale) * (shade * (0.82 + 0.24 * u))
            };
            blade.grow(dabs, random, &Seat::turned(at + axis * (rise * size), axis, turn), &colour);
        }
    }
    sepals(dabs, random, at - axis * (0.006 * size), axis, 0.020 * size);
}

/// Small green leaves under a head.
fn sepals(dabs: &mut Vec<Dab>, random: &mut Random, at: Vec3, axis: Vec3, length_m: f32) {
    for i in 0..5 {
        let blade =
            Blade { length_m, half_width_m: length_m * 0.36, lean: [1.3, 1.0], cup: 0.3, widest: 0.4, blunt: 0.2, cells: [4, 3], translucency: 0.25 };
        let seat = Seat::turned(at, axis, i as f32 / 5.0 * TAU + random.about(0.2));
        blade.grow(dabs, random, &seat, &|u, _| linear(0x4c7034) * (0.8 + 0.3 * u));
    }
}

/// White rays about a golden dome.
fn daisy(dabs: &mut Vec<Dab>, random: &mut Random, at: Vec3, axis: Vec3, size: f32) {
    let rays = 19;
    let droop = random.between(-0.05, 0.25);
    for i in 0..rays {
        let upper = i % 2 == 0;
        let turn = (i as f32 + random.about(0.22)) / rays as f32 * TAU;
        let lean = if upper { 1.30 } else { 1.42 } + droop + random.about(0.08);
        let blade = Blade {
            length_m: (0.031 + random.about(0.002)) * size,
            half_width_m: 0.0056 * size,
            lean: [lean - 0.12, lean + 0.25],
            cup: 0.30,
            widest: 0.65,
            blunt: 0.75,
            cells: [8, 3],
            translucency: 0.5,
        };
        let seat = Seat::turned(at + axis * if upper { 0.0012 } else { 0.0 }, axis, turn);
        let shade = 1.0 + random.about(0.04);
        let colour = |u: f32, _: f32| linear(0xc9c19a).lerp(linear(0xe9e7e2), (u * 2.2).min(1.0)) * shade;
        let seat = Seat { at: seat.at + seat.out * (0.004 * size), ..seat };
        blade.grow(dabs, random, &seat, &colour);
    }
    let mut tint = random.clone();
    let mut gold = |z: f32| linear(0xc98a1c).lerp(linear(0xf4c435), (1.2 - z + 0.35 * tint.unit()).min(1.0)) * (0.8 + 0.3 * tint.unit());
    let seat = Seat::turned(at, axis, 0.0);
    Dome { radius_m: 0.0092 * size, height_m: 0.0062 * size, from: 0.0, cells: 110 }.grow(dabs, random, &seat, &mut gold);
    sepals(dabs, random, at - axis * 0.003, axis, 0.012 * size);
}

/// A spike of small blue flowers, buds at its tip.
fn larkspur(dabs: &mut Vec<Dab>, random: &mut Random, at: Vec3, axis: Vec3, size: f32) {
    let length = 0.115 * size;
    let axis = (axis + Vec3::Z * 0.6).normalize_or(Vec3::Z);
    let curve = |t: f32| at + axis * (length * t);
    stem(dabs, &curve, [0.0036, 0.0018], [22, 6], &|_| linear(0x55773c));
    let florets = 34;
    for i in 0..florets {
        let t = (i as f32 + 0.5) / florets as f32;
        let small = 1.0 - 0.62 * t;
        let turn = i as f32 * 2.399_963_2 + random.about(0.2);
        let whorl = Seat::turned(curve(t), axis, turn);
        let face = (whorl.out + axis * (0.35 + 0.8 * t)).normalize_or(axis);
        let heart = whorl.at + whorl.out * (0.0085 * small * size + 0.0028);
        let tone = linear(0x4a55b8).lerp(linear(0x7d6cd0), random.unit()) * random.between(0.85, 1.1);
        for petal in 0..5 {
            let blade = Blade {
                length_m: 0.0115 * small * size,
                half_width_m: 0.0050 * small * size,
                lean: [0.75, 1.35],
                cup: 0.3,
                widest: 0.6,
                blunt: 0.9,
                cells: [3, 2],
                translucency: 0.45,
            };
            let seat = Seat::turned(heart, face, petal as f32 / 5.0 * TAU + turn);
            blade.grow(dabs, random, &seat, &|u, _| tone.lerp(linear(0xa9a4ee), 0.55 * u * u));
        }
        let eye = Seat::turned(heart + face * 0.0008, face, 0.0);
        Dome { radius_m: 0.0019 * small, height_m: 0.0016 * small, from: 0.0, cells: 4 }.grow(dabs, random, &eye, &mut |_| linear(0xf3efe0));
    }
}

/// A yellow ball of tiny florets.
fn button(dabs: &mut Vec<Dab>, random: &mut Random, at: Vec3, axis: Vec3, size: f32) {
    let mut tint = random.clone();
    let mut gold =
        |z: f32| linear(0xd9a21b).lerp(linear(0xf6d34a), (0.5 + 0.4 * z + 0.5 * (tint.unit() - 0.5)).clamp(0.0, 1.0)) * (0.78 + 0.34 * tint.unit());
    let seat = Seat::turned(at + axis * (0.009 * size), axis, 0.0);
    Dome { radius_m: 0.0128 * size, height_m: 0.0120 * size, from: -0.96, cells: 190 }.grow(dabs, random, &seat, &mut gold);
}

/// Round silvery leaves in pairs along a branch.
fn eucalyptus(dabs: &mut Vec<Dab>, random: &mut Random, curve: &dyn Fn(f32) -> Vec3, size: f32) {
    let pairs = 9;
    for i in 0..pairs {
        let t = 0.30 + 0.70 * (i as f32 + 0.5) / pairs as f32;
        let axis = (curve(t + 0.02) - curve(t - 0.02)).normalize_or(Vec3::Z);
        let small = 1.0 - 0.42 * t;
        for side in 0..2 {
            let turn = i as f32 * 1.35 + side as f32 * TAU / 2.0 + random.about(0.25);
            let blade = Blade {
                length_m: 0.034 * small * size,
                half_width_m: 0.0155 * small * size,
                lean: [0.75 + random.about(0.15), 1.25 + random.about(0.15)],
                cup: 0.16,
                widest: 0.48,
                blunt: 1.0,
                cells: [6, 5],
                translucency: 0.22,
            };
            let tone = linear(0x7f9a86).lerp(linear(0x9db39a), random.unit());
            let vein = |u: f32, v: f32| tone * (if v.abs() < 0.12 { 1.12 } else { 0.95 } - 0.12 * u);
            blade.grow(dabs, random, &Seat::turned(curve(t), axis, turn), &vein);
        }
    }
    let tip = Seat::turned(curve(1.0), (curve(1.0) - curve(0.96)).normalize_or(Vec3::Z), 0.0);
    let blade = Blade {
        length_m: 0.020 * size,
        half_width_m: 0.008 * size,
        lean: [0.05, 0.3],
        cup: 0.2,
        widest: 0.5,
        blunt: 0.8,
        cells: [5, 4],
        translucency: 0.22,
    };
    blade.grow(dabs, random, &tip, &|_, _| linear(0x93aa8a));
}

/// Pointed leaves in threes along a stem: the green between the flowers.
fn sprig(dabs: &mut Vec<Dab>, random: &mut Random, curve: &dyn Fn(f32) -> Vec3, size: f32) {
    let whorls = 6;
    for i in 0..whorls {
        let t = 0.40 + 0.60 * (i as f32 + 0.5) / whorls as f32;
        let axis = (curve(t + 0.02) - curve(t - 0.02)).normalize_or(Vec3::Z);
        for side in 0..3 {
            let blade = Blade {
                length_m: (0.050 - 0.014 * t) * size,
                half_width_m: 0.0105 * size,
                lean: [0.55 + random.about(0.15), 1.05 + random.about(0.2)],
                cup: 0.3,
                widest: 0.42,
                blunt: 0.15,
                cells: [7, 3],
                translucency: 0.3,
            };
            let tone = linear(0x4d7f39).lerp(linear(0x78a24c), random.unit());
            let turn = i as f32 * 1.1 + side as f32 * TAU / 3.0 + random.about(0.3);
            let vein = |u: f32, v: f32| tone * (if v.abs() < 0.25 { 1.2 } else { 0.95 } - 0.1 * u);
            blade.grow(dabs, random, &Seat::turned(curve(t), axis, turn), &vein);
        }
    }
}

/// A broad leaf that hangs over the lip.
fn leaf(dabs: &mut Vec<Dab>, random: &mut Random, curve: &dyn Fn(f32) -> Vec3, end: Vec3, size: f32) {
    let at = curve(0.12);
    stem(dabs, curve, [0.0036, 0.0026], [12, 6], &|_| linear(0x55773c));
    let level = Vec3::new(end.x, end.y, 0.0).normalize_or(Vec3::X);
    let seat = Seat { at: at + level * 0.012 + Vec3::Z * 0.018, axis: Vec3::Z, out: level };
    let blade = Blade {
        length_m: 0.108 * size,
        half_width_m: 0.023 * size,
        lean: [0.75 + random.about(0.1), 2.0 + random.about(0.15)],
        cup: 0.32,
        widest: 0.42,
        blunt: 0.15,
        cells: [15, 7],
        translucency: 0.28,
    };
    let tone = linear(0x35602f).lerp(linear(0x4f7f3a), random.unit());
    let colour = |u: f32, v: f32| {
        let rib = (v.abs() + u * 0.55).fract();
        let vein = if v.abs() < 0.11 { 1.35 } else { 0.92 + 0.16 * (rib * 6.0).fract() };
        tone * vein
    };
    blade.grow(dabs, random, &seat, &colour);
}
