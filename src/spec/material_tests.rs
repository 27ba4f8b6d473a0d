//! Materials, parts and events as users write them: every kind, other programs' names, ranges, contradictions.

use serde_json::{Value, json};

use super::tests::{outline, refused, with};
use super::*;

const MATERIAL: &str = "material = { kind = \"elastic\", young_pa = \"auto\", poisson = 0.3, density_kg_m3 = 1000 }";

/// Reads a material as far as the schema goes: what is not built yet is refused only after that.
fn read(text: &str) -> Result<(Material, Vec<String>), SpecError> {
    let spec = with(MATERIAL, "material = \"jelly\"").unwrap();
    let mut value = spec.to_value();
    value["object"][0]["material"] = toml::from_str::<Value>(&format!("m = {text}")).unwrap()["m"].take();
    let mut notes = Vec::new();
    spelling::settle(&mut value, &mut notes)?;
    check::spec(&value)?;
    Ok((serde_json::from_value(value["object"][0]["material"].clone()).unwrap(), notes))
}

fn material(text: &str) -> Material {
    read(text).unwrap_or_else(|error| panic!("{text}: {error}")).0
}

fn preset(name: &str) -> Material {
    presets::material(name).unwrap().material.clone()
}

#[test]
fn presets_and_kinds_are_read_by_name() {
    assert_eq!(material("\"jelly\""), preset("jelly"));
    let Material::Elastic(jelly) = preset("jelly") else { panic!("elastic") };
    assert_eq!(material("{ preset = \"jelly\", poisson = 0.2 }"), Material::Elastic(Elastic { poisson: 0.2, ..jelly.clone() }));
    // It bears itself, unless its stiffness is given: that is obeyed.
    assert_eq!(jelly.young_pa, Young::AtLeast(1e4));
    assert_eq!(material("{ young_pa = { at_least = 2e4 } }").young_pa(), Some(Young::AtLeast(2e4)));
    assert_eq!(material("{ preset = \"jelly\", young_pa = 1e4 }").young_pa(), Some(Young::Value(1e4)));
    for kind in Material::KINDS {
        assert_eq!(material(&format!("{{ kind = \"{kind}\" }}")), Material::of_kind(kind).unwrap());
        assert_eq!(Material::of_kind(kind).unwrap().kind(), kind);
    }
    // The stuff is not the kind.
    assert_eq!(material("\"plastic\"").kind(), "rigid");
    for preset in presets::MATERIALS {
        assert_eq!(material(&format!("\"{}\"", preset.name)), preset.material);
        let mut spec = outline();
        spec.objects[0].material = preset.material.clone();
        assert!(spec.validate().is_ok(), "{}", preset.name);
    }
    let conflict = read("{ preset = \"water\", kind = \"sand\" }").unwrap_err();
    assert_eq!(conflict.kind, SpecErrorKind::Conflict);
    let moon = with("gravity_m_s2 = [0, 0, -9.81]", "gravity_m_s2 = \"moon\"").unwrap();
    assert_eq!(moon.world.gravity_m_s2, [0.0, 0.0, -1.62]);
}

#[test]
fn the_names_of_genesis_are_converted_by_kind() {
    let ours = Material::Elastic(Elastic { young_pa: Young::Value(2e5), poisson: 0.25, density_kg_m3: 500.0, model: ElasticModel::NeoHookean });
    for text in [
        "{ E = 2e5, nu = 0.25, rho = 500, model = \"neohooken\" }",
        "{ mu = 8e4, lam = 8e4, rho = 500, model = \"neo_hookean\" }",
        "{ mu = 8e4, nu = 0.25, rho = 500, model = \"neo_hookean\" }",
        "{ lambda = 8e4, nu = 0.25, rho = 500, model = \"neo_hookean\" }",
    ] {
        assert_eq!(material(text), ours, "{text}");
    }
    let (water, notes) = read("{ kind = \"liquid\", mu = 0.005, gamma = 0.01, rho = 800, stiffness = 5e4, exponent = 7, solver = \"sph\" }").unwrap();
    let Material::Liquid(liquid) = water else { panic!("a liquid") };
    assert_eq!((liquid.viscosity_pa_s, liquid.solver), (4.0, LiquidSolver::Sph));
    assert!((liquid.surface_tension_n_m - 0.288_96).abs() < 1e-9);
    let said = notes.join("\n");
    for words in ["0.005 m²/s times 800 kg/m³, so viscosity_pa_s = 4", "gamma", "stiffness is not read", "exponent is not read"] {
        assert!(said.contains(words), "{words} in {said}");
    }
    let (clay, notes) = read("{ kind = \"plastic\", von_mises_yield_stress = 1e4, use_von_mises = true, yield_lower = 0.02 }").unwrap();
    assert!((clay.yield_stress_pa().unwrap() - 12_247.448_71).abs() < 1e-5 && notes.len() == 2);
    assert_eq!(read("{ kind = \"plastic\", use_von_mises = false }").unwrap_err().kind, SpecErrorKind::NotBuilt);
    let Material::Sand(sand) = material("{ kind = \"sand\", friction_angle = 45, cohesion = 10 }") else { panic!("sand") };
    assert_eq!((sand.friction_angle_deg, sand.cohesion_pa), (45.0, 10.0));
    let Material::Snow(snow) = material("{ kind = \"snow\", yield_lower = 0.03, yield_higher = 0.005 }") else { panic!("snow") };
    assert_eq!((snow.theta_c, snow.theta_s), (0.03, 0.005));
    let Material::Rigid(rigid) = material("{ kind = \"rigid\", rho = 600, coup_friction = 0.1, coup_restitution = 0.2 }") else { panic!("rigid") };
    assert_eq!(rigid, Rigid { density_kg_m3: 600.0, friction: 0.1, restitution: 0.2 });
    let Material::Muscle(muscle) = material("{ kind = \"muscle\", E = 1e5, n_groups = 1, model = \"neohooken\" }") else { panic!("a muscle") };
    assert_eq!(muscle.young_pa, Young::Value(1e5));
}

#[test]
fn what_says_two_things_is_refused() {
    for (text, kind) in [
        ("{ E = 1e5, young_pa = 2e5 }", SpecErrorKind::Duplicate),
        ("{ mu = 1e5, young_pa = 2e5 }", SpecErrorKind::Duplicate),
        ("{ kind = \"liquid\", mu = 0.1, viscosity_pa_s = 3 }", SpecErrorKind::Duplicate),
        ("{ kind = \"liquid\", mu = 0.1, E = 1e5 }", SpecErrorKind::Conflict),
        ("{ kind = \"liquid\", mu = -1 }", SpecErrorKind::Type),
        ("{ kind = \"muscle\", n_groups = 2 }", SpecErrorKind::Unknown),
        ("{ viscosity_pa_s = 3 }", SpecErrorKind::Unknown),
        ("{ kind = \"jelly\" }", SpecErrorKind::Unknown),
        ("\"rubbr\"", SpecErrorKind::Unknown),
    ] {
        assert_eq!(read(text).expect_err(text).kind, kind, "{text}");
    }
    let elsewhere = read("{ viscosity_pa_s = 3 }").unwrap_err().to_string();
    assert!(elsewhere.contains("`viscosity_pa_s` is of kind viscoplastic, liquid"), "{elsewhere}");
}

/// A number with its bounds as users were told them.
type Range = (&'static str, f64, f64);

/// Every number of every kind.
const RANGES: &[(&str, &[Range])] = &[
    ("rigid", &[("friction", 0.0, 10.0), ("restitution", 0.0, 1.0)]),
    ("elastic", &[("young_pa", 1e2, 1e12), ("poisson", 0.0, 0.49)]),
    ("muscle", &[("young_pa", 1e2, 1e12), ("poisson", 0.0, 0.49), ("activation", 0.0, 1.0)]),
    ("plastic", &[("young_pa", 1e2, 1e12), ("poisson", 0.0, 0.49), ("yield_stress_pa", 0.0, 1e12), ("hardening_pa", -1e12, 1e12)]),
    ("viscoplastic", &[("young_pa", 1e2, 1e12), ("poisson", 0.0, 0.49), ("yield_stress_pa", 0.0, 1e12), ("viscosity_pa_s", 0.0, 1e6)]),
    ("sand", &[("young_pa", 1e2, 1e12), ("poisson", 0.0, 0.49), ("friction_angle_deg", 1.0, 80.0), ("cohesion_pa", 0.0, 1e12)]),
    ("snow", &[("young_pa", 1e2, 1e12), ("poisson", 0.0, 0.49), ("theta_c", 1e-4, 0.9), ("theta_s", 1e-4, 0.9), ("hardening", 0.0, 20.0)]),
    ("liquid", &[("viscosity_pa_s", 0.0, 1e6), ("surface_tension_n_m", 0.0, 1e3)]),
];

#[test]
fn every_number_of_every_kind_at_below_and_beyond_its_range() {
    for (kind, fields) in RANGES {
        let known = serde_json::to_value(Material::of_kind(kind).unwrap()).unwrap();
        let numbers = known.as_object().unwrap().iter().filter(|(_, value)| value.is_number() || *value == "auto").count();
        assert_eq!(numbers, fields.len() + 1, "{kind}: a field is missing here");
        for (field, low, high) in fields.iter().chain(&[("density_kg_m3", 1.0, 2e4)]) {
            let value = |number: f64| read(&format!("{{ kind = \"{kind}\", {field} = {number:?} }}"));
            for inside in [*low, *high, 0.5 * (low + high)] {
                assert!(value(inside).is_ok(), "{kind}.{field} = {inside}");
            }
            for outside in [low - 1e-9 * low.abs().max(1.0), high + 1e-9 * high.abs().max(1.0), -1e300, 1e300] {
                assert_eq!(value(outside).expect_err(field).kind, SpecErrorKind::Range, "{kind}.{field} = {outside}");
            }
            assert!(read(&format!("{{ kind = \"{kind}\", {field} = \"much\" }}")).is_err());
        }
    }
}

#[test]
fn switching_a_kind_keeps_what_both_have() {
    let mut table = serde_json::to_value(preset("rubber")).unwrap();
    aliases::switch_kind(table.as_object_mut().unwrap(), "sand");
    assert_eq!(table, json!({ "kind": "elastic", "young_pa": 1.5e6, "poisson": 0.45, "density_kg_m3": 930.0 }));
    aliases::switch_kind(table.as_object_mut().unwrap(), "liquid");
    assert_eq!(table, json!({ "kind": "elastic", "density_kg_m3": 930.0 }));
    let mut auto = serde_json::to_value(Material::default()).unwrap();
    aliases::switch_kind(auto.as_object_mut().unwrap(), "snow");
    assert_eq!(auto, json!({ "kind": "elastic", "poisson": 0.3, "density_kg_m3": 1000.0 }));
}

fn with_parts() -> Spec {
    let parts = "[[object.part]]\nname = \"flowers\"\nregion = { above = 0.5 }\nmaterial = { kind = \"elastic\", young_pa = 5e4 }\n\
                 [[object.part]]\nname = \"pot\"\nregion = { below = 0.3 }\nmaterial = \"rubber\"\n[[pin]]";
    with("[[pin]]", parts).unwrap()
}

#[test]
fn parts_are_read_written_edited_and_compared_by_name() {
    let spec = with_parts();
    assert_eq!(spec.objects[0].parts.len(), 2);
    let text = spec.to_toml();
    assert!(text.contains("[[object.part]]\nname = \"flowers\"\nregion = { above = 0.5 }\n"), "{text}");
    assert_eq!(Spec::from_toml(&text).unwrap(), spec);
    let edited = spec
        .apply(&[
            Edit::set("object.vase.part.flowers.material.young_pa", 2e4),
            Edit::set("object.vase.part.pot.region.box", json!({ "centre_m": [0, 0, 0], "size_m": [1, 1, 1] })),
            Edit::add("object.vase.part", json!({ "name": "rim", "region": { "above": 0.9 }, "material": "jelly" })),
        ])
        .unwrap();
    let parts = &edited.objects[0].parts;
    assert_eq!(parts[0].material.young_pa(), Some(Young::Value(2e4)));
    assert!(matches!(parts[1].region, Region::Box(_)));
    assert_eq!((parts[2].name.as_str(), &parts[2].material), ("rim", &preset("jelly")));
    let said: Vec<String> = spec.diff(&edited).iter().map(ToString::to_string).collect();
    assert!(said[0].starts_with("object.vase.part.flowers.material.young_pa: 5e4 → 2e4 Pa"), "{said:?}");
    assert!(said[2].starts_with("object.vase.part.rim: added") && said[2].ends_with("of jelly"), "{said:?}");
    let gone = spec.apply(&[Edit::remove("object.vase.part.flowers")]).unwrap();
    assert_eq!(gone.objects[0].parts.len(), 1);
    // The order counts, so it is a difference.
    let mut turned = spec.clone();
    turned.objects[0].parts.reverse();
    assert!(!spec.diff(&turned).is_empty());
    assert_eq!(spec.apply(&spec.edits_to(&turned)).unwrap(), turned);
    for (edit, words) in [
        (Edit::set("object.vase.part.flower.material", "jelly"), "did you mean `flowers`"),
        (Edit::set("object.vase.part", json!([])), "addressed by name"),
        (Edit::add("object.vase.part", json!({ "name": "pot", "region": { "above": 0.5 } })), "two entries are called `pot`"),
        (Edit::add("object.vase.part", json!({ "name": "rim" })), "region: missing"),
        (Edit::add("object.vase.part", json!({ "name": "rim", "region": { "above": 1.5 } })), "out of range"),
        (Edit::remove("object.vase.part.rim"), "unknown part `rim`"),
        (Edit::remove("object.vase.part"), "addressed by name"),
        (Edit::add("object.pot.part", json!({ "name": "a" })), "unknown object `pot`"),
    ] {
        let error = spec.apply(std::slice::from_ref(&edit)).expect_err(&edit.to_string()).to_string();
        assert!(error.contains(words), "{edit}: {error}");
    }
}

#[test]
fn aliases_in_edits_replace_what_they_stand_for() {
    let mut notes = Vec::new();
    let edited = outline().apply_noted(&[Edit::set("object.vase.material.rho", 500), Edit::set("object.vase.material.mu", 8e4)], &mut notes).unwrap();
    assert_eq!((edited.objects[0].material.density_kg_m3(), edited.objects[0].material.young_pa()), (500.0, Some(Young::Value(208_000.0))));
    assert_eq!(notes.len(), 1);
    let back = edited.apply(&[Edit::remove("object.vase.material.rho")]).unwrap();
    assert_eq!(back.objects[0].material.density_kg_m3(), 1000.0);
}

#[test]
fn contradictory_events_are_refused_with_what_would_be_right() {
    let with_event = |text: &str| refused("at_s = 0.5\nobject = \"vase\"\npush_m_s = [2, 0, 0]", text).to_string();
    for (text, words) in [
        ("object = \"vase\"\npush_m_s = [2, 0, 0]", "it never happens"),
        ("at_s = 0.5\nwhen = \"impact\"\nobject = \"vase\"\npush_m_s = [2, 0, 0]", "both say when"),
        ("at_s = 0.5\nwhen = \"later\"\nobject = \"vase\"\npush_m_s = [2, 0, 0]", "unknown value `later`"),
        ("at_s = 0.5\nobject = \"vase\"", "nothing happens"),
        ("at_s = 0.5\nobject = \"vase\"\nfreeze = false", "nothing happens"),
        ("at_s = 0.5\nobject = \"vase\"\npush_m_s = [2, 0, 0]\nfreeze = true", "push_m_s and freeze at once"),
        ("at_s = 0.5\nobject = \"pot\"\npush_m_s = [2, 0, 0]", "unknown object `pot`"),
        ("at_s = -0.5\nobject = \"vase\"\npush_m_s = [2, 0, 0]", "out of range"),
        ("at_s = 0.5\nobject = \"vase\"\nweaken = 2", "out of range"),
        ("at_s = 0.5\nobject = \"vase\"\nmaterial = \"jely\"", "did you mean `jelly`"),
        ("at_s = 0.5\nobject = \"vase\"\nmaterial = { kind = \"elastic\", young_pa = 1 }", "event.event1.material.young_pa: 1 is out of range"),
    ] {
        let said = with_event(text);
        assert!(said.contains(words), "{text}: {said}");
    }
}
