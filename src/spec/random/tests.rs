use super::*;
use crate::spec::{ColliderShape, Event, Force, LiquidSolver, Material, Region};
use std::collections::BTreeMap;

const FILE: &str = "block.ply";

#[test]
fn what_is_drawn_is_mostly_a_spec_and_always_the_same() {
    let drawn: Vec<_> = (0..300).map(|seed| spec(seed, FILE, Size::Small)).collect();
    let good = drawn.iter().flatten().count();
    let errors: Vec<_> = drawn.iter().filter_map(|d| d.as_ref().err()).map(ToString::to_string).take(5).collect();
    assert!(good > 270, "{good} of 300; {errors:?}");
    assert_eq!(spec(7, FILE, Size::Small).map(|s| s.hash()).ok(), spec(7, FILE, Size::Small).map(|s| s.hash()).ok());
}

/// Whatever a spec may be made of is drawn, in the small ones of a test run as in all of them, and the
/// ends of every range.
#[test]
fn everything_that_a_spec_may_say_is_drawn() {
    for (size, count) in [(Size::Small, 200), (Size::Whole, 10_000)] {
        let mut seen: BTreeMap<String, u32> = BTreeMap::new();
        for spec in (0..count).flat_map(|seed| spec(seed, FILE, size)) {
            words(&spec).into_iter().for_each(|word| *seen.entry(word).or_default() += 1);
        }
        let least = count as u32 / 2000;
        let missing: Vec<_> = expected(size).into_iter().filter(|word| seen.get(word).is_none_or(|n| *n <= least)).collect();
        assert!(missing.is_empty(), "{size:?}: {missing:?} of {seen:?}");
    }
}

fn expected(size: Size) -> Vec<String> {
    let mut all = Vec::new();
    let mut add = |stem: &str, words: &[&str]| all.extend(words.iter().map(|word| format!("{stem} {word}")));
    let kinds = ["rigid", "elastic", "muscle", "plastic", "viscoplastic", "sand", "snow", "mpm", "sph"];
    add("object", &kinds);
    add("part", &kinds);
    add("becomes", if size == Size::Small { &["sand"] } else { &kinds });
    add("force", Force::WAYS);
    add("event", &["push_m_s", "velocity_m_s", "material", "weaken", "freeze", "release", "of a part", "on impact"]);
    add("collider", &["box", "sphere", "capsule", "plane", "near"]);
    add("region", &["above", "below", "box", "sphere", "half_space"]);
    add("pin", &["still", "moving"]);
    add("scale", &["0.001", "1", "100"]);
    add("it", &["lasts no time", "is of two objects", "is of a few Gaussians", "starts overlapped"]);
    add("little", &["young_pa", "density_kg_m3"]);
    add("much", &["young_pa", "density_kg_m3", "speed", "viscosity_pa_s", "gravity"]);
    all
}

/// What is in a spec, in words.
fn words(spec: &Spec) -> Vec<String> {
    let mut all = Vec::new();
    let mut add = |stem: &str, word: &str| all.push(format!("{stem} {word}"));
    add("scale", &spec.scene.metres_per_unit.to_string());
    let length = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    for (word, is) in [
        ("lasts no time", spec.time.duration_s.unwrap_or(1.0) == 0.0),
        ("is of two objects", spec.objects.len() == 2),
        ("starts overlapped", spec.objects.len() == 2 && spec.objects[0].offset_m[0] > spec.objects[1].offset_m[0]),
    ] {
        if is {
            add("it", word);
        }
    }
    if length(&spec.world.gravity_m_s2) > 100.0 {
        add("much", "gravity");
    }
    for object in &spec.objects {
        if matches!(object.select, crate::spec::Select::Ids(_)) {
            add("it", "is of a few Gaussians");
        }
        if length(&object.velocity_m_s) > 100.0 {
            add("much", "speed");
        }
        let own = [("object", &object.material)];
        for (stem, material) in own.into_iter().chain(object.parts.iter().map(|p| ("part", &p.material))) {
            add(stem, kind(material));
            let value = serde_json::to_value(material).unwrap_or_default();
            for (key, little, much) in [("young_pa", 1e3, 1e11), ("density_kg_m3", 10.0, 1e4), ("viscosity_pa_s", 0.0, 1e4)] {
                let Some(value) = value.get(key).and_then(Value::as_f64) else { continue };
                if value < little {
                    add("little", key);
                }
                if value > much {
                    add("much", key);
                }
            }
        }
    }
    for region in spec.pins.iter().map(|p| &p.region).chain(spec.objects.iter().flat_map(|o| o.parts.iter().map(|p| &p.region))) {
        add(
            "region",
            match region {
                Region::Above(_) => "above",
                Region::Below(_) => "below",
                Region::Box(_) => "box",
                Region::Sphere(_) => "sphere",
                Region::HalfSpace(_) => "half_space",
            },
        );
    }
    spec.pins.iter().for_each(|pin| add("pin", if pin.path.is_empty() { "still" } else { "moving" }));
    for collider in &spec.colliders {
        let (word, place) = match collider.shape {
            ColliderShape::Box(b) => ("box", b.centre_m),
            ColliderShape::Sphere(s) => ("sphere", s.centre_m),
            ColliderShape::Capsule(c) => ("capsule", c.from_m),
            ColliderShape::Plane(p) => ("plane", p.point_m),
        };
        add("collider", word);
        if length(&place) < 2.0 * spec.scene.metres_per_unit {
            add("collider", "near");
        }
    }
    for force in &spec.forces {
        let value = serde_json::to_value(force).unwrap_or_default();
        Force::WAYS.iter().filter(|way| value.get(**way).is_some()).for_each(|way| add("force", way));
    }
    for event in &spec.events {
        event.effects().iter().for_each(|effect| add("event", effect));
        let Event { part, when, material, .. } = event;
        part.iter().for_each(|_| add("event", "of a part"));
        when.iter().for_each(|_| add("event", "on impact"));
        material.iter().for_each(|m| add("becomes", kind(m)));
    }
    all
}

fn kind(material: &Material) -> &'static str {
    match material {
        Material::Rigid(_) => "rigid",
        Material::Elastic(_) => "elastic",
        Material::Muscle(_) => "muscle",
        Material::Plastic(_) => "plastic",
        Material::Viscoplastic(_) => "viscoplastic",
        Material::Sand(_) => "sand",
        Material::Snow(_) => "snow",
        Material::Liquid(liquid) if liquid.solver == LiquidSolver::Sph => "sph",
        Material::Liquid(_) => "mpm",
    }
}
