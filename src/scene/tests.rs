//! Files in and out: what survives, what is refused and what the refusal says.

use super::*;
use crate::spec::Axis;
use glam::Vec3;
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// A file of the reference collection, where there is one.
fn shared(file: &str) -> Option<PathBuf> {
    let root = std::env::var_os("PHYSTALK_SHARED").map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = root.join(file);
    if path.exists() {
        return Some(path);
    }
    println!("absent: {}; this part of the test is left out", path.display());
    None
}

fn random_gaussians(count: usize, degree: u32, seed: u32) -> Gaussians {
    let mut state = seed.wrapping_mul(747_796_405).wrapping_add(1);
    let mut next = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let mut vector = |low: f32, high: f32| Vec3::new(next(), next(), next()) * (high - low) + low;
    Gaussians {
        mean: (0..count).map(|_| vector(-5.0, 5.0)).collect(),
        scale: (0..count).map(|_| vector(1e-4, 0.2)).collect(),
        rotation: (0..count).map(|_| vector(-1.0, 1.0).extend(0.5).to_array()).collect(),
        opacity: (0..count).map(|_| vector(0.0, 1.0).x).collect(),
        sh_degree: degree,
        sh: (0..count * ((degree + 1) * (degree + 1)) as usize).flat_map(|_| vector(-1.0, 1.0).to_array()).collect(),
    }
}

fn splat_bytes(g: &Gaussians) -> Vec<u8> {
    splat::encode(g).0
}

fn ply_header_of(properties: &str, count: usize) -> Vec<u8> {
    format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{properties}end_header\n").into_bytes()
}

/// Records that a .splat may hold: finite, scales that are not negative.
fn record() -> impl Strategy<Value = Vec<u8>> {
    let float = prop_oneof![Just(0.0_f32), 1e-7..1e-3_f32, 1e-3..10.0_f32, Just(1e-42_f32), Just(1e9_f32)];
    (prop::array::uniform3(-100.0..100.0_f32), prop::array::uniform3(float), prop::array::uniform8(any::<u8>())).prop_map(|(mean, scale, bytes)| {
        let mut record: Vec<u8> = mean.into_iter().chain(scale).flat_map(f32::to_le_bytes).collect();
        record.extend(bytes);
        record
    })
}

proptest! {
    #[test]
    fn splat_to_ply_to_splat_is_byte_for_byte(records in prop::collection::vec(record(), 1..40)) {
        let bytes = records.concat();
        let first = parse(&bytes, "a.splat").unwrap();
        let ply = ply::encode(&first.gaussians);
        let second = parse(&ply, "a.ply").unwrap();
        prop_assert!(second.warnings.is_empty());
        let (back, lost) = splat::encode(&second.gaussians);
        prop_assert_eq!(back, bytes);
        prop_assert!(lost.is_empty(), "{:?}", lost);
    }

    #[test]
    fn a_ply_returns_what_was_written(count in 1..30_usize, degree in 0..=3_u32, seed in any::<u32>()) {
        let g = random_gaussians(count, degree, seed);
        let back = parse(&ply::encode(&g), "a.ply").unwrap().gaussians;
        prop_assert_eq!(&back.mean, &g.mean);
        prop_assert_eq!(&back.scale, &g.scale);
        prop_assert_eq!(&back.rotation, &g.rotation);
        prop_assert_eq!(&back.sh, &g.sh);
        prop_assert!(back.opacity.iter().zip(&g.opacity).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn garbage_is_refused_or_read_and_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        for name in ["a.ply", "a.splat", "a"] {
            if let Err(error) = parse(&bytes, name) {
                prop_assert!(error.to_string().starts_with(&format!("{name} ")), "{}", error);
            }
        }
    }

    #[test]
    fn a_damaged_ply_is_refused_or_read_and_never_panics(at in 0..2000_usize, byte in any::<u8>(), length in 0..2500_usize) {
        let mut bytes = ply::encode(&random_gaussians(8, 1, 7));
        if let Some(b) = bytes.get_mut(at) {
            *b = byte;
        }
        bytes.truncate(length);
        let _ = parse(&bytes, "a.ply");
    }
}

#[test]
fn properties_are_found_by_name_in_any_order_and_type() {
    let properties = "property uchar red\nproperty double rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n\
        property float scale_2\nproperty float scale_1\nproperty float scale_0\nproperty float opacity\nproperty short z\n\
        property float y\nproperty float x\nproperty float f_dc_2\nproperty float f_dc_1\nproperty float f_dc_0\n";
    let mut bytes = ply_header_of(properties, 1);
    bytes.push(200);
    bytes.extend(0.5_f64.to_le_bytes());
    bytes.extend([0.1, 0.2, 0.3, -3.0, -2.0, -1.0, 0.0_f32].into_iter().flat_map(f32::to_le_bytes));
    bytes.extend(7_i16.to_le_bytes());
    bytes.extend([6.0, 5.0, 0.3, 0.2, 0.1_f32].into_iter().flat_map(f32::to_le_bytes));
    let g = parse(&bytes, "a.ply").unwrap().gaussians;
    assert_eq!(g.mean, [Vec3::new(5.0, 6.0, 7.0)]);
    assert_eq!(g.rotation, [[0.5, 0.1, 0.2, 0.3]]);
    assert_eq!(g.sh, [0.1, 0.2, 0.3]);
    assert_eq!(g.opacity, [0.5]);
    assert!((g.scale[0].x - (-1.0_f32).exp()).abs() < 1e-6 && (g.scale[0].z - (-3.0_f32).exp()).abs() < 1e-7);
}

#[test]
fn spherical_harmonics_are_channel_major_in_the_file() {
    let mut g = random_gaussians(1, 1, 3);
    g.sh = (0..12).map(|i| i as f32).collect();
    let bytes = ply::encode(&g);
    let header = ply_header::parse(&bytes, "a.ply").unwrap();
    let row = &bytes[header.bytes..];
    let rest: Vec<f32> = (0..9).map(|i| header.elements[0].column(&format!("f_rest_{i}")).unwrap().read(row)).collect();
    // Coefficients 1 to 3 of red, then of green, then of blue.
    assert_eq!(rest, [3.0, 6.0, 9.0, 4.0, 7.0, 10.0, 5.0, 8.0, 11.0]);
}

#[test]
fn sigma_is_ignored_once_the_scale_was_changed() {
    let g = random_gaussians(2000, 0, 5);
    let mut bytes = ply::encode(&g);
    let header = ply_header::parse(&bytes, "a.ply").unwrap();
    let vertex = &header.elements[0];
    assert!(vertex.column("sigma_0").is_some());
    // Another program doubles the size of the first.
    let at = header.bytes + 4 * vertex.properties.iter().position(|(n, _)| n == "scale_0").unwrap();
    let doubled = g.scale[0].x.ln() + 2.0_f32.ln();
    bytes[at..at + 4].copy_from_slice(&doubled.to_le_bytes());
    let back = parse(&bytes, "a.ply").unwrap().gaussians;
    assert!((back.scale[0].x / g.scale[0].x - 2.0).abs() < 1e-5);
    assert_eq!(back.scale[0].y, g.scale[0].y);
    assert_eq!(back.scale[1..], g.scale[1..]);
}

#[test]
fn a_splat_says_what_it_loses() {
    let mut g = random_gaussians(4, 2, 9);
    g.sh[0] = 9.0;
    let lost = splat::encode(&g).1;
    for word in ["4 of 4 Gaussians: colour no longer changes with the view", "clamped", "rounded to 8 bits", "normalised"] {
        assert!(lost.iter().any(|l| l.contains(word)), "{word}: {lost:?}");
    }
}

#[test]
fn unusable_gaussians_are_dropped_and_counted() {
    let mut g = random_gaussians(8, 0, 11);
    g.mean[0].x = f32::NAN;
    g.scale[1].y = f32::INFINITY;
    g.mean[2].z = 1e30;
    g.scale[3].x = -0.1;
    let loaded = parse(&splat_bytes(&g), "a.splat").unwrap();
    assert_eq!(loaded.gaussians.len(), 5);
    assert_eq!(loaded.gaussians.scale[0].x, 0.1);
    let warnings = loaded.warnings.join("\n");
    for sentence in
        ["2 of 8 Gaussians dropped: NaN or infinite", "1 of 8 Gaussians dropped: numbers over 1e12", "1 of 8 Gaussians have negative scales"]
    {
        assert!(warnings.contains(sentence), "{warnings}");
    }
    // A logarithm of 1000 is a scale of infinity.
    let mut bytes = ply::encode(&random_gaussians(3, 0, 11));
    let header = ply_header::parse(&bytes, "a.ply").unwrap();
    let at = header.bytes + 4 * header.elements[0].properties.iter().position(|(n, _)| n == "scale_1").unwrap();
    bytes[at..at + 4].copy_from_slice(&1000.0_f32.to_le_bytes());
    assert_eq!(parse(&bytes, "a.ply").unwrap().gaussians.len(), 2);
}

#[test]
fn refusals_name_the_file_and_what_to_do() {
    let mut truncated = ply::encode(&random_gaussians(10, 0, 1));
    truncated.truncate(truncated.len() - 100);
    let lying = ply_header_of("property float x\nproperty float y\nproperty float z\n", 4_000_000_000);
    let cloud = [ply_header_of("property float x\nproperty float y\nproperty float z\nproperty uchar red\n", 1), vec![0; 13]].concat();
    let none = ply::encode(&Gaussians::default());
    let behind = b"ply\nformat binary_little_endian 1.0\nelement face 4294967295\nproperty float a\nelement vertex 0\nend_header\n".to_vec();
    let mut all_nan = random_gaussians(3, 0, 1);
    all_nan.mean.fill(Vec3::NAN);
    let mut ksplat = vec![0_u8; 5200];
    ksplat[1] = 1;
    ksplat[4] = 1;
    let cases: [(&str, Vec<u8>, &[&str]); 15] = [
        ("f.ply", vec![], &["0 bytes"]),
        ("f.ply", truncated, &["8 of 10 Gaussians", "copy or export"]),
        ("f.ply", lying, &["0 of 4000000000", "48000000"]),
        ("f.ply", b"ply\nformat ascii 1.0\nelement vertex 1\nend_header\n".to_vec(), &["ascii", "not supported yet", "splat-transform"]),
        ("f.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex".to_vec(), &["end_header"]),
        ("f.ply", b"ply\nformat binary_little_endian 1.0\nproperty float x\n".to_vec(), &["line 3"]),
        ("f.ply", behind, &["the end of the file after 0 of 0", "copy or export"]),
        ("f.ply", cloud, &["f_dc_0", "point cloud"]),
        ("f.ply", none, &["count is 0"]),
        ("f.ply", vec![1, 2, 3], &["no `ply` line"]),
        ("f.splat", splat_bytes(&all_nan), &["all 3"]),
        ("f.splat", splat_bytes(&random_gaussians(3, 0, 1))[..80].to_vec(), &["16 bytes after 2 whole records"]),
        ("f.splat", b"{\"version\": 2}".to_vec(), &["JSON"]),
        ("f.splat", b"Hello, this is no scene at all..".to_vec(), &["it is text"]),
        ("f.bin", ksplat, &[".ksplat", "not supported yet"]),
    ];
    for (name, bytes, words) in cases {
        let message = parse(&bytes, name).unwrap_err().to_string();
        for word in words.iter().chain([&name]) {
            assert!(message.contains(word), "`{word}` in: {message}");
        }
    }
}

#[test]
fn folders_missing_files_and_unwritable_places_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: &Path| read(path).unwrap_err().to_string();
    assert!(message(folder.path()).contains("folder"));
    assert!(message(&folder.path().join("no.ply")).contains("check the path"));
    let g = random_gaussians(2, 0, 1);
    assert!(matches!(write(&folder.path().join("a.txt"), &g), Err(SceneError::Extension { .. })));
    write(&folder.path().join("a.ply"), &g).unwrap();
    assert!(matches!(write(&folder.path().join("a.ply/b.ply"), &g), Err(SceneError::Write { .. })));
    assert_eq!(read(&folder.path().join("a.ply")).unwrap().gaussians.mean, g.mean);
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["a.ply"], "nothing is left beside the file");
}

#[test]
fn the_same_three_gaussians_from_both_formats() {
    let (Some(ply), Some(splat)) = (shared("checks/fixtures/train-3points.ply"), shared("checks/fixtures/train-3points.splat")) else { return };
    let (ply, splat) = (read(&ply).unwrap(), read(&splat).unwrap());
    assert_eq!((ply.format, splat.format), (Format::Ply, Format::Splat));
    assert_eq!((ply.gaussians.sh_degree, splat.gaussians.sh_degree), (3, 0));
    assert_eq!(ply.gaussians.len(), 3);
    for i in 0..3 {
        // The .splat is ordered by size: match by place.
        let same = (0..3).find(|&j| ply.gaussians.mean[i].distance(splat.gaussians.mean[j]) < 1e-4).unwrap();
        assert!(ply.gaussians.covariance(i).abs_diff_eq(splat.gaussians.covariance(same), 3e-2 * ply.gaussians.scale[i].length_squared()));
        assert!((ply.gaussians.opacity[i] - splat.gaussians.opacity[same]).abs() < 0.005);
    }
}

#[test]
fn reference_files_have_their_known_counts() {
    let known: [(&str, usize, u32, Format); 7] = [
        ("checks/fixtures/train-1000_sh3.ply", 1000, 3, Format::Ply),
        ("checks/fixtures/fruit_drops_label_sh3.ply", 4721, 3, Format::Ply),
        ("checks/fixtures/st_minimal.splat", 4, 0, Format::Splat),
        ("checks/derived/daffodils_sh2.ply", 92_802, 2, Format::Ply),
        ("scenes/vase.splat", 9499, 0, Format::Splat),
        ("scenes/bulldozer.splat", 56_045, 0, Format::Splat),
        ("scenes/hamburger.ply", 52_709, 0, Format::Ply),
    ];
    for (file, count, degree, format) in known {
        let Some(path) = shared(file) else { continue };
        let loaded = read(&path).unwrap();
        assert_eq!((loaded.gaussians.len(), loaded.gaussians.sh_degree, loaded.format), (count, degree, format), "{file}");
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    }
    for file in ["scenes/guitar.compressed.ply", "scenes/narcissus.sog", "checks/fixtures/st_minimal.ksplat", "checks/fixtures/st_minimal-v4.spz"] {
        let Some(path) = shared(file) else { continue };
        assert!(matches!(read(&path), Err(SceneError::Unsupported { .. })), "{file}: {:?}", read(&path).err());
    }
}

#[test]
fn captured_splats_survive_a_ply_byte_for_byte() {
    for file in ["scenes/vase.splat", "scenes/bulldozer.splat", "checks/fixtures/st_minimal.splat", "checks/fixtures/train-3points.splat"] {
        let Some(path) = shared(file) else { continue };
        let bytes = std::fs::read(&path).unwrap();
        let ply = ply::encode(&parse(&bytes, file).unwrap().gaussians);
        let back = splat_bytes(&parse(&ply, "a.ply").unwrap().gaussians);
        assert!(back == bytes, "{file}");
    }
}

#[test]
fn up_is_guessed_as_it_is_known() {
    let known = [
        ("scenes/vase.splat", Axis::PlusZ),
        ("scenes/bulldozer.splat", Axis::PlusZ),
        ("scenes/hamburger.ply", Axis::PlusY),
        ("checks/derived/daffodils_sh2.ply", Axis::MinusY),
        ("checks/derived/vase.ply", Axis::PlusZ),
    ];
    for (file, axis) in known {
        let Some(path) = shared(file) else { continue };
        let guess = read(&path).unwrap().up();
        assert!(guess.axis == axis && guess.sure, "{file}: {guess:?}");
    }
    let Some(path) = shared("checks/fixtures/train-1000_sh3.ply") else { return };
    let guess = read(&path).unwrap().up();
    assert!(guess.axis == Axis::MinusY && !guess.sure, "{guess:?}");
}

/// A cone on its base, whichever axis points up.
#[test]
fn a_cone_stands_on_its_base() {
    for up in [Axis::PlusX, Axis::MinusX, Axis::PlusY, Axis::MinusY, Axis::PlusZ, Axis::MinusZ] {
        let frame = SceneFrame { up, metres_per_unit: 1.0 };
        let mut g = random_gaussians(3000, 0, 4);
        for (i, p) in g.mean.iter_mut().enumerate() {
            let (turn, share) = (i as f32 * 2.399_963, (i as f32 / 3000.0).sqrt());
            let side = Vec3::new(share * turn.cos(), share * turn.sin(), 2.0 * (1.0 - share));
            *p = frame.to_scene(if i % 3 == 0 { side * Vec3::new(1.0, 1.0, 0.0) } else { side });
            g.scale[i] = Vec3::splat(0.02);
        }
        let guess = guess_up(&g);
        assert!(guess.axis == up && guess.sure, "{guess:?}");
    }
}

#[test]
fn a_comment_that_states_up_is_believed() {
    let g = random_gaussians(2, 0, 2);
    let text = ply::encode(&g);
    let at = text.windows(7).position(|w| w == b"element").unwrap();
    let bytes = [&text[..at], b"comment Vertical axis: z\n", &text[at..]].concat();
    let guess = parse(&bytes, "a.ply").unwrap().up();
    assert_eq!(guess.axis, Axis::PlusZ);
    assert!(guess.sure && guess.why.contains("Vertical axis: z"));
    assert!(!guess_up(&g).sure, "two Gaussians have no shape");
}

#[test]
fn info_has_the_numbers() {
    let g = random_gaussians(100, 0, 21);
    let info = serde_json::to_value(info(&parse(&splat_bytes(&g), "a.splat").unwrap())).unwrap();
    assert_eq!((info["gaussians"].as_u64(), info["sh_degree"].as_u64(), info["format"].as_str()), (Some(100), Some(0), Some("splat")));
    assert!(info["bounds"]["low"][0].as_f64().unwrap() < -4.0 && info["up_guess"]["axis"].is_string() && info["floaters"].is_u64());
}

#[test]
fn only_evidence_makes_a_file_without_a_name_a_splat() {
    let scene = splat_bytes(&random_gaussians(200, 0, 1));
    assert_eq!(parse(&scene, "a").unwrap().format, Format::Splat);
    let counts: Vec<u8> = (0_u32..4096).flat_map(u32::to_le_bytes).collect();
    let noise: Vec<u8> = (0_u32..4096).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let padded = [scene[..320].to_vec(), vec![0; 32 * 1000]].concat();
    for (name, bytes) in
        [("zeros", vec![0; 32 * 1000]), ("ones", vec![0x3f; 32 * 1000]), ("counts", counts), ("noise", noise), ("padded", padded.clone())]
    {
        let refused = parse(&bytes, name);
        assert!(matches!(refused, Err(SceneError::NotAScene { .. })), "{name}: {refused:?}");
    }
    assert!(matches!(parse(&padded, "a.splat"), Err(SceneError::NotAScene { .. })));
    assert!(matches!(parse(&vec![0; 3200], "a.splat"), Err(SceneError::NotAScene { .. })));
}

#[test]
fn a_long_sparse_file_is_refused_by_a_part_of_it() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["sparse", "sparse.splat"] {
        let path = folder.path().join(name);
        // More than any machine has memory for.
        std::fs::File::create(&path).unwrap().set_len(1 << 42).unwrap();
        assert!(matches!(read(&path), Err(SceneError::NotAScene { .. })));
        assert!(digest(&path).is_err());
    }
}

#[test]
fn gaussians_that_stay_are_the_subset_in_place() {
    let all = random_gaussians(20, 2, 3);
    let mut kept = all.clone();
    kept.retain(&[0, 3, 4, 19]);
    assert_eq!(kept, all.subset(&[0, 3, 4, 19]));
}
