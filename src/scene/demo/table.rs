//! A low table of oak boards on four tapered legs, and the tiled floor it stands on.

use super::dab::{Dab, Finish, Paint, cell_dab, cover, linear};
use super::random::{Random, cloud, noise, smooth};
use glam::Vec3;

/// Height of the top's upper face above the floor.
pub const TOP_M: f32 = 0.42;
/// Length along x, depth along y and thickness of the top.
pub const TOP_SIZE_M: Vec3 = Vec3::new(0.46, 0.62, 0.032);
/// Dabs lie this much below the face that they show, so that what stands on it is told apart.
const BELOW_M: f32 = 8e-4;
/// Radius of the rim.
const ROUND_M: f32 = 0.007;
/// Boards of the top.
const BOARDS: usize = 4;
/// Width of a leg at the top and at the floor.
const LEG_M: [f32; 2] = [0.046, 0.030];
/// From the corner of the top to the middle of a leg.
const LEG_INSET_M: f32 = 0.052;

/// The solids of the table: top, then legs; low and high corners.
pub fn solids() -> Vec<[Vec3; 2]> {
    let half = TOP_SIZE_M / 2.0;
    let top = [Vec3::new(-half.x, -half.y, TOP_M - TOP_SIZE_M.z), Vec3::new(half.x, half.y, TOP_M)];
    let leg = |x: f32, y: f32| {
        // Slim enough to stay inside the taper, so that a leg does not shade itself.
        let r = LEG_M[1] / 2.0 - 0.004;
        [Vec3::new(x - r, y - r, 0.0), Vec3::new(x + r, y + r, top[0].z)]
    };
    let (x, y) = (half.x - LEG_INSET_M, half.y - LEG_INSET_M);
    vec![top, leg(x, y), leg(-x, y), leg(-x, -y), leg(x, -y)]
}

/// Oak at a place of a board: `along` the grain, `across` and `down` it in metres, each board its own.
fn oak(board: f32, along: f32, across: f32, down: f32) -> Vec3 {
    let warp = 0.018 * cloud(Vec3::new(along * 2.2, across * 5.0, board * 7.3));
    let rings = noise(Vec3::new(along * 1.4, (across + warp + down) * 95.0, board * 3.1 + 0.5));
    let fibre = noise(Vec3::new(along * 16.0, (across + down) * 420.0, board));
    let patch = cloud(Vec3::new(along * 3.0, across * 9.0, board * 5.0 + 40.0));
    let light = linear(0xb98652).lerp(linear(0x9c6b3c), 0.5 + 0.5 * noise(Vec3::new(board * 17.3, 0.5, 0.5)));
    let dark = linear(0x5b361b);
    let mut wood = light.lerp(dark, (0.30 + 0.50 * rings + 0.24 * fibre).clamp(0.0, 0.85));
    wood *= 1.0 + 0.22 * patch;
    wood
}

fn varnished(albedo: Vec3) -> Paint {
    Paint { albedo, finish: Finish::Coated { reflectance: 0.035, roughness: 0.45 }, opacity: 0.97 }
}

fn raw(albedo: Vec3) -> Paint {
    Paint { albedo, finish: Finish::Sheet { translucency: 0.0 }, opacity: 0.97 }
}

/// All dabs of the table.
pub fn table(seed: u64) -> Vec<Dab> {
    let mut dabs = Vec::new();
    let mut random = Random::new(seed, 1);
    top_face(&mut dabs, &mut random);
    top_edges(&mut dabs, &mut random);
    for (index, leg) in solids()[1..].iter().enumerate() {
        one_leg(&mut dabs, &mut random, (leg[0] + leg[1]) / 2.0, index as f32);
    }
    apron(&mut dabs, &mut random);
    dabs
}

/// Boards run along y, streaks of grain along them, a dark seam between two.
fn top_face(dabs: &mut Vec<Dab>, random: &mut Random) {
    let half = TOP_SIZE_M / 2.0 - Vec3::splat(ROUND_M * 0.7);
    let (width, length) = (2.0 * half.x / BOARDS as f32, 2.0 * half.y);
    let (rows, streaks) = (44, 32);
    for board in 0..BOARDS {
        let left = -half.x + board as f32 * width;
        for streak in 0..streaks {
            // The outer streaks of a board are its eased edges, narrow and dark.
            let (from, to) = eased(streak, streaks);
            let (x, dx) = (left + width * (from + to) / 2.0, width * (to - from));
            let shift = random.unit();
            for row in 0..=rows {
                let (low, high) = ((row as f32 - shift).max(0.0) / rows as f32, (row as f32 + 1.0 - shift).min(rows as f32) / rows as f32);
                if high - low < 0.2 / rows as f32 {
                    continue;
                }
                let (y, dy) = (-half.y + length * (low + high) / 2.0, length * (high - low));
                let seam = streak == 0 && board > 0 || streak == streaks - 1 && board + 1 < BOARDS;
                let albedo = oak(board as f32, y, x - left, 0.0) * if seam { 0.4 } else { 1.0 };
                let centre = Vec3::new(x, y, TOP_M - BELOW_M);
                let mut dab = cell_dab(centre, Vec3::Y * dy, -Vec3::X * dx, varnished(albedo));
                dab.sigma.z = 4e-4;
                dabs.push(dab);
            }
        }
    }
}

/// Share of a board that a streak covers: the first and last are a third as wide as the others.
fn eased(streak: usize, streaks: usize) -> (f32, f32) {
    let narrow = 0.3;
    let all = streaks as f32 - 2.0 + 2.0 * narrow;
    let edge = |i: usize| match i {
        0 => 0.0,
        i if i == streaks => 1.0,
        i => (narrow + i as f32 - 1.0) / all,
    };
    (edge(streak), edge(streak + 1))
}

/// A rounded rim around the top, and its underside.
fn top_edges(dabs: &mut Vec<Dab>, random: &mut Random) {
    let half = TOP_SIZE_M / 2.0;
    let (low, round) = (TOP_M - TOP_SIZE_M.z, ROUND_M);
    // Four sides: outward direction and length along it.
    for (out, side, length) in
        [(Vec3::X, Vec3::Y, TOP_SIZE_M.y), (-Vec3::X, -Vec3::Y, TOP_SIZE_M.y), (Vec3::Y, -Vec3::X, TOP_SIZE_M.x), (-Vec3::Y, Vec3::X, TOP_SIZE_M.x)]
    {
        let reach = out.abs().dot(half);
        let end_grain = out.y != 0.0;
        let section = |v: f32| {
            // Up the side, then a quarter round onto the face.
            let straight = TOP_SIZE_M.z - round;
            let arc = round * std::f32::consts::FRAC_PI_2;
            let s = v * (straight + arc);
            if s < straight {
                (reach, low + s)
            } else {
                let turn = (s - straight) / round;
                (reach - round + round * turn.cos(), low + straight + round * turn.sin())
            }
        };
        let surface = |u: f32, v: f32| {
            let (r, z) = section(v);
            out * r + side * ((u - 0.5) * length) + Vec3::Z * (z - BELOW_M)
        };
        let cells = if end_grain { [84, 9] } else { [60, 10] };
        cover(dabs, cells, 0.12, random, &surface, &mut |_, _, p| {
            let board = ((p.x + half.x) / TOP_SIZE_M.x * BOARDS as f32).floor().clamp(0.0, BOARDS as f32 - 1.0);
            let across = p.x + half.x - board * TOP_SIZE_M.x / BOARDS as f32;
            let seam = smooth(0.0, 0.004, across.min(TOP_SIZE_M.x / BOARDS as f32 - across));
            let wood = if end_grain { oak(board, p.z * 2.0, across * 0.35, (TOP_M - p.z) * 0.3) * 0.8 } else { oak(board, p.y, across, TOP_M - p.z) };
            Some(varnished(wood * (0.5 + 0.5 * seam)))
        });
    }
    let underside = |u: f32, v: f32| Vec3::new((v - 0.5) * TOP_SIZE_M.x, (u - 0.5) * TOP_SIZE_M.y, low + BELOW_M);
    cover(dabs, [24, 16], 0.1, random, &underside, &mut |_, _, p| Some(raw(oak(p.x.floor(), p.y, p.x, 0.0))));
}

/// A square leg, tapered towards the floor.
fn one_leg(dabs: &mut Vec<Dab>, random: &mut Random, middle: Vec3, index: f32) {
    let high = TOP_M - TOP_SIZE_M.z;
    for (out, side) in [(Vec3::X, Vec3::Y), (Vec3::Y, -Vec3::X), (-Vec3::X, -Vec3::Y), (-Vec3::Y, Vec3::X)] {
        let surface = |u: f32, v: f32| {
            let half = (LEG_M[1] + (LEG_M[0] - LEG_M[1]) * v) / 2.0;
            // Slightly rounded corners.
            let s = (u - 0.5) * 2.0;
            let bulge = half - 0.10 * half * s.abs().powi(6);
            // Rows grow finer towards the floor, where the leg ends.
            Vec3::new(middle.x, middle.y, 0.003 + v * (0.3 + 0.7 * v) * (high - 0.003)) + out * bulge + side * (half * s * 0.97)
        };
        cover(dabs, [7, 26], 0.15, random, &surface, &mut |u, v, p| {
            let wood = oak(20.0 + index, p.z, u * 0.05 + out.x * 0.3 + out.y * 0.7, 0.0);
            Some(raw(wood * (0.85 + 0.15 * v)))
        });
    }
}

/// Boards between the legs.
fn apron(dabs: &mut Vec<Dab>, random: &mut Random) {
    let half = TOP_SIZE_M / 2.0 - LEG_INSET_M;
    let (low, high) = (TOP_M - TOP_SIZE_M.z - 0.055, TOP_M - TOP_SIZE_M.z);
    for (out, side, reach, length) in [
        (Vec3::X, Vec3::Y, half.x, 2.0 * half.y),
        (-Vec3::X, -Vec3::Y, half.x, 2.0 * half.y),
        (Vec3::Y, -Vec3::X, half.y, 2.0 * half.x),
        (-Vec3::Y, Vec3::X, half.y, 2.0 * half.x),
    ] {
        for (face, turn) in [(0.010, 1.0), (-0.010, -1.0)] {
            let surface = |u: f32, v: f32| out * (reach + face) + side * (turn * (u - 0.5) * (length - 0.04)) + Vec3::Z * (low + v * (high - low));
            cover(dabs, [(length / 0.026) as usize, 7], 0.1, random, &surface, &mut |_, _, p| {
                Some(raw(oak(30.0 + out.x * 2.0 + out.y, p.dot(side), p.z, 0.0) * 0.92))
            });
        }
    }
}

/// Edge of a tile with its joint.
const TILE_M: f32 = 0.24;
/// Tiles in each direction from the middle.
const TILES: i32 = 6;
/// Widths of the strips of a tile, of the whole: narrow at the rim, and the joint last.
const STRIPS: [f32; 8] = [0.04, 0.09, 0.185, 0.24, 0.22, 0.135, 0.055, 0.035];
/// Where the floor begins and ceases to fade, from the middle.
const FADE_M: [f32; 2] = [0.62, 1.38];

/// Square stone tiles, each of its own shade, dark joints between them, fading out towards the border.
pub fn floor(seed: u64) -> Vec<Dab> {
    let mut dabs = Vec::new();
    let mut random = Random::new(seed, 2);
    for i in -TILES..TILES {
        for j in -TILES..TILES {
            let corner = Vec3::new(i as f32 + 0.37, j as f32 + 0.21, 0.0) * TILE_M;
            let shade = [random.about(1.0), random.about(1.0)];
            one_tile(&mut dabs, corner, shade);
        }
    }
    dabs
}

/// The strips of a tile along x times those along y. Around a leg they are split, so that no dab
/// in front of it reaches over its foot.
fn one_tile(dabs: &mut Vec<Dab>, corner: Vec3, shade: [f32; 2]) {
    let joint = STRIPS.len() - 1;
    let mut x = 0.0;
    for (a, dx) in STRIPS.into_iter().enumerate() {
        let mut y = 0.0;
        for (b, dy) in STRIPS.into_iter().enumerate() {
            let size = Vec3::new(dx, dy, 0.0) * TILE_M;
            let low = corner + Vec3::new(x, y, 0.0) * TILE_M;
            let parts = if near_a_leg(low + size / 2.0) { 4 } else { 1 };
            for part in 0..parts * parts {
                let part_size = size / parts as f32;
                let centre = low + part_size * Vec3::new((part % parts) as f32 + 0.5, (part / parts) as f32 + 0.5, 0.0);
                floor_dab(dabs, centre, [part_size.x, part_size.y], shade, a == joint || b == joint);
            }
            y += dy;
        }
        x += dx;
    }
}

fn near_a_leg(p: Vec3) -> bool {
    let half = TOP_SIZE_M / 2.0 - LEG_INSET_M;
    (p.x.abs() - half.x).hypot(p.y.abs() - half.y) < 0.075
}

fn floor_dab(dabs: &mut Vec<Dab>, centre: Vec3, size: [f32; 2], shade: [f32; 2], joint: bool) {
    let radius = (centre * Vec3::new(1.0, 1.0, 0.0)).length();
    let opacity = 0.97 * smooth(FADE_M[1], FADE_M[0], radius);
    if opacity < 0.02 {
        return;
    }
    let stone = linear(0xa29b90).lerp(linear(0x867d71), 0.5 + 0.5 * shade[0]) * (1.0 + 0.07 * shade[1]);
    let veins = cloud(centre * 7.0 + Vec3::new(shade[0], shade[1], 0.0) * 20.0);
    let albedo = if joint { linear(0x4f4a44) } else { stone * (1.0 + 0.10 * veins) };
    let finish = if joint { Finish::Sheet { translucency: 0.0 } } else { Finish::Coated { reflectance: 0.03, roughness: 0.55 } };
    let mut dab = cell_dab(centre, Vec3::X * size[0], Vec3::Y * size[1], Paint { albedo, finish, opacity });
    dab.sigma.z = 5e-4;
    dab.centre.z = -5e-4;
    dabs.push(dab);
}
