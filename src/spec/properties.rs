//! What holds for every spec, every edit and every junk.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::*;

/// A number of a range, of any exponent.
fn number(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![low..=high, Just(low), Just(high), (0.0..=1.0_f64).prop_map(move |t| (low + (high - low) * t.powi(9)).clamp(low, high))]
}

/// A vector no longer than a limit.
fn vector(limit: f64) -> impl Strategy<Value = [f64; 3]> {
    let most = limit / 2.0;
    prop_oneof![Just([0.0; 3]), prop::array::uniform3(-most..most)]
}

fn shape_box() -> impl Strategy<Value = BoxShape> {
    (vector(1e3), prop::array::uniform3(1e-3..1e3_f64)).prop_map(|(centre_m, size_m)| BoxShape { centre_m, size_m })
}

fn shape_sphere() -> impl Strategy<Value = SphereShape> {
    (vector(1e3), 1e-3..1e3_f64).prop_map(|(centre_m, radius_m)| SphereShape { centre_m, radius_m })
}

fn plane() -> impl Strategy<Value = PlaneShape> {
    (vector(1e3), 0.1..1.0_f64).prop_map(|(point_m, x)| PlaneShape { point_m, normal: [x, 0.0, 1.0] })
}

fn auto<T: Clone + std::fmt::Debug + 'static>(value: impl Strategy<Value = T> + 'static) -> impl Strategy<Value = Auto<T>> {
    prop_oneof![1 => Just(Auto::Auto).boxed(), 2 => value.prop_map(Auto::Value).boxed()]
}

fn young() -> impl Strategy<Value = Young> {
    prop_oneof![Just(Young::Auto), number(1e2, 1e12).prop_map(Young::Value), number(1e2, 1e12).prop_map(Young::AtLeast)]
}

fn axis() -> impl Strategy<Value = Axis> {
    prop::sample::select(vec![Axis::PlusX, Axis::MinusX, Axis::PlusY, Axis::MinusY, Axis::PlusZ, Axis::MinusZ])
}

/// Every kind that is built, any parameters.
fn material() -> BoxedStrategy<Material> {
    let solid = || (young(), number(0.0, 0.49), number(1.0, 2e4));
    let model = || prop::sample::select(vec![ElasticModel::Corotated, ElasticModel::NeoHookean]);
    let strength = || number(0.0, 1e12);
    let activation = prop_oneof![
        number(0.0, 1.0).prop_map(Activation::Steady),
        prop::array::uniform3(0.0..=1.0_f64).prop_map(|a| Activation::Curve(vec![[0.0, a[0]], [0.5, a[1]], [600.0, a[2]]])),
        (0.0..=1.0_f64).prop_map(|most| Activation::Wave(Wave { least: 0.0, most, period_s: 0.5, phase: 0.25 })),
    ];
    let kinds = prop_oneof![
        (number(1.0, 2e4), number(0.0, 10.0), 0.0..=1.0_f64).prop_map(|(density_kg_m3, friction, restitution)| Material::Rigid(Rigid {
            density_kg_m3,
            friction,
            restitution
        })),
        (solid(), model()).prop_map(|((young_pa, poisson, density_kg_m3), model)| Material::Elastic(Elastic {
            young_pa,
            poisson,
            density_kg_m3,
            model
        })),
        (solid(), model(), activation).prop_map(|((young_pa, poisson, density_kg_m3), model, activation)| Material::Muscle(Muscle {
            young_pa,
            poisson,
            density_kg_m3,
            model,
            fibre: [0.5, 0.0, -2.0],
            activation
        })),
        (solid(), strength(), number(-1e12, 1e12)).prop_map(|((young_pa, poisson, density_kg_m3), yield_stress_pa, hardening_pa)| Material::Plastic(
            Plastic { young_pa, poisson, density_kg_m3, yield_stress_pa, hardening_pa }
        )),
        (solid(), strength(), number(0.0, 1e6)).prop_map(|((young_pa, poisson, density_kg_m3), yield_stress_pa, viscosity_pa_s)| {
            Material::Viscoplastic(Viscoplastic { young_pa, poisson, density_kg_m3, yield_stress_pa, viscosity_pa_s })
        }),
        (solid(), number(1.0, 80.0), strength()).prop_map(|((young_pa, poisson, density_kg_m3), friction_angle_deg, cohesion_pa)| Material::Sand(
            Sand { young_pa, poisson, density_kg_m3, friction_angle_deg, cohesion_pa }
        )),
        (solid(), number(1e-4, 0.9), number(1e-4, 0.9), number(0.0, 20.0)).prop_map(
            |((young_pa, poisson, density_kg_m3), theta_c, theta_s, hardening)| {
                Material::Snow(Snow { young_pa, poisson, density_kg_m3, theta_c, theta_s, hardening })
            }
        ),
        (number(1.0, 2e4), number(0.0, 1e6), number(0.0, 1e3), any::<bool>()).prop_map(
            |(density_kg_m3, viscosity_pa_s, surface_tension_n_m, sph)| {
                let solver = if sph { LiquidSolver::Sph } else { LiquidSolver::Mpm };
                Material::Liquid(Liquid { density_kg_m3, viscosity_pa_s, surface_tension_n_m, solver })
            }
        ),
    ];
    kinds.boxed()
}

fn region() -> BoxedStrategy<Region> {
    prop_oneof![
        (0.0..=1.0_f64).prop_map(Region::Above),
        (0.0..=1.0_f64).prop_map(Region::Below),
        shape_box().prop_map(Region::Box),
        shape_sphere().prop_map(Region::Sphere),
        plane().prop_map(Region::HalfSpace),
    ]
    .boxed()
}

/// Parts in any order: of two that overlap the later one counts.
fn parts() -> BoxedStrategy<Vec<Part>> {
    let names = Just(vec!["a", "flowers", "pot-2"]).prop_shuffle();
    let part = |((region, material), name): ((Region, Material), &str)| Part { name: name.to_owned(), region, material };
    (names, prop::collection::vec((region(), material()), 0..=3))
        .prop_map(move |(names, pieces)| pieces.into_iter().zip(names).map(part).collect())
        .boxed()
}

fn object(name: String) -> impl Strategy<Value = Object> {
    let select = prop_oneof![
        Just(Select::All),
        shape_box().prop_map(Select::Box),
        shape_sphere().prop_map(Select::Sphere),
        prop::collection::vec(any::<u32>(), 1..4).prop_map(Select::Ids),
    ];
    let place = (vector(1e4), prop::array::uniform3(-720.0..720.0_f64), vector(200.0), vector(1e3), axis());
    (select, material(), parts(), place, any::<(bool, bool)>()).prop_map(move |(select, material, parts, place, (hull, free))| Object {
        name: name.clone(),
        select,
        proxy: if hull { ProxyKind::Hull } else { ProxyKind::Voxel },
        material,
        parts,
        offset_m: place.0,
        rotate_deg: place.1,
        rest: if free { Rest::StressFree } else { Rest::AsCaptured },
        velocity_m_s: place.2,
        spin_rad_s: place.3,
        forward: place.4,
    })
}

fn until(from_s: f64) -> impl Strategy<Value = Until> {
    prop_oneof![Just(Until::End), (0.01..100.0_f64).prop_map(move |more| Until::Time(from_s + more))]
}

/// Points that rise in time from a time on, not faster than anything may be.
fn path(from_s: f64) -> impl Strategy<Value = Vec<[f64; 4]>> {
    prop::collection::vec((0.1..2.0_f64, vector(9.0)), 0..4).prop_map(move |points| {
        let mut at = from_s;
        let mut point = |(later, place): (f64, [f64; 3])| {
            at += later;
            [at, place[0], place[1], place[2]]
        };
        points.into_iter().map(&mut point).collect()
    })
}

/// A force that acts in any of its ways, of no name and object yet.
fn drive() -> BoxedStrategy<Force> {
    let none = || Force::new("", "", 0.0, Until::End);
    let expression = prop::sample::select(vec!["vec3(6 * sin(3 * t), 0, 0)", "-2 * v - 900 * (x - x0)", "if(t > 1, x, v) * noise(x)"]);
    let rate = || number(0.0, 1e6);
    prop_oneof![
        vector(1e4).prop_map(move |a| Force::constant("", "", 0.0, Until::End, a)),
        expression.prop_map(move |text| Force { acceleration_m_s2: Some(Acceleration::Expression(text.to_owned())), ..none() }),
        (vector(200.0), rate(), 0.0..=2.0_f64, 0.0..=2.0_f64, 1e-6..1e5_f64).prop_map(move |(velocity_m_s, drag_per_s, gust, turbulence, eddy_m)| {
            Force { wind: Some(Wind { velocity_m_s, drag_per_s, gust, turbulence, eddy_m }), ..none() }
        }),
        (number(1e-9, 1e6), rate())
            .prop_map(move |(linear_per_s, quadratic_per_m)| { Force { drag: Some(Drag { linear_per_s, quadratic_per_m }), ..none() } }),
        (auto(vector(1e3)), 0.1..1.0_f64, number(-200.0, 200.0), 1e-6..1e5_f64, rate()).prop_map(
            move |(centre_m, x, speed_m_s, radius_m, drag_per_s)| {
                Force { vortex: Some(Vortex { centre_m, axis: [x, 0.0, 1.0], speed_m_s, radius_m, lift_m_s: x, drag_per_s }), ..none() }
            }
        ),
        (auto(vector(1e3)), number(-1e4, 1e4), 1e-6..1e5_f64, -4.0..8.0_f64).prop_map(move |(centre_m, strength_m_s2, radius_m, falloff)| {
            Force { attractor: Some(Attractor { centre_m, strength_m_s2, radius_m, falloff }), ..none() }
        }),
        (auto(vector(1e3)), number(-200.0, 200.0), 1e-6..1e5_f64)
            .prop_map(move |(centre_m, speed_m_s, radius_m)| { Force { explosion: Some(Explosion { centre_m, speed_m_s, radius_m }), ..none() } }),
        (prop::option::of(vector(1e3)), path(1.0), number(0.0, 1e9), rate()).prop_map(move |(to_m, path, stiffness_per_s2, damping_per_s)| {
            let to_m = if path.is_empty() { Some(to_m.unwrap_or_default()) } else { None };
            Force { spring: Some(Spring { to_m, path_m: path, stiffness_per_s2, damping_per_s }), ..none() }
        }),
        (auto(vector(1e3)), 0.1..1.0_f64, number(-1e3, 1e3), rate()).prop_map(move |(centre_m, y, speed_rad_s, rate_per_s)| {
            Force { motor: Some(Motor { centre_m, axis: [0.0, y, 1.0], speed_rad_s, rate_per_s }), ..none() }
        }),
    ]
    .boxed()
}

fn entries() -> impl Strategy<Value = (Vec<Pin>, Vec<Collider>, Vec<Force>, Vec<Event>)> {
    let capsule = (vector(1e3), vector(1e3), 1e-3..1e3_f64).prop_map(|(from_m, to_m, radius_m)| CapsuleShape { from_m, to_m, radius_m });
    let shape = prop_oneof![
        shape_box().prop_map(ColliderShape::Box),
        shape_sphere().prop_map(ColliderShape::Sphere),
        capsule.prop_map(ColliderShape::Capsule),
        plane().prop_map(ColliderShape::Plane)
    ];
    let pin = (region(), 0.0..9.0_f64).prop_flat_map(|(region, from_s)| {
        (until(from_s), path(from_s)).prop_map(move |(to_s, path)| Pin { name: String::new(), object: "vase".to_owned(), region, from_s, to_s, path })
    });
    let collider = (shape, 0.0..10.0_f64, 0.0..=1.0_f64).prop_map(|(shape, friction, restitution)| Collider {
        name: String::new(),
        shape,
        friction,
        restitution,
    });
    let force = (drive(), 0.0..9.0_f64)
        .prop_flat_map(|(drive, from_s)| until(from_s).prop_map(move |to_s| Force { object: "vase".to_owned(), from_s, to_s, ..drive.clone() }));
    let time = prop_oneof![(0.0..600.0_f64).prop_map(|at_s| Event::at("", "vase", at_s)), Just(Event::on_impact("", "vase"))];
    let effect = prop_oneof![
        vector(200.0).prop_map(|v| Event { push_m_s: Some(v), ..Event::default() }),
        vector(200.0).prop_map(|v| Event { velocity_m_s: Some(v), ..Event::default() }),
        material().prop_map(|material| Event { material: Some(material), ..Event::default() }),
        Just(Event { freeze: true, ..Event::default() }),
    ];
    let event =
        (time, effect).prop_map(|(time, effect)| Event { name: String::new(), at_s: time.at_s, when: time.when, object: time.object, ..effect });
    // Each list takes some of the names, so that two specs share some and not others.
    fn named<T: Clone + std::fmt::Debug>(entry: impl Strategy<Value = T>, name: fn(&mut T, String)) -> impl Strategy<Value = Vec<T>> {
        (prop::collection::vec(entry, 3), prop::sample::subsequence(vec!["a", "b-1", "c_2"], 0..=3)).prop_map(move |(entries, names)| {
            entries
                .into_iter()
                .zip(names)
                .map(|(mut entry, text)| {
                    name(&mut entry, text.to_owned());
                    entry
                })
                .collect()
        })
    }
    (
        named(pin, |pin, name| pin.name = name),
        named(collider, |it, name| it.name = name),
        named(force, |it, name| it.name = name),
        named(event, |it, name| it.name = name),
    )
}

fn spec() -> impl Strategy<Value = Spec> {
    let camera = auto((vector(1e3), 1.0..170.0_f64).prop_map(|(target_m, fov_deg)| Camera {
        eye_m: target_m.map(|x| x + 1.0),
        target_m,
        fov_deg,
        orbit_deg_s: -fov_deg,
    }));
    let ground = (auto(number(-1e5, 1e5)), 0.0..=10.0_f64, 0.0..=1.0_f64).prop_map(|(height_m, friction, restitution)| Ground {
        height_m,
        friction,
        restitution,
    });
    let globals = (
        0..=limits::SEED,
        auto(number(0.0, 600.0)),
        1..=1000_u32,
        vector(1e3),
        ground,
        (auto(4..=1024_u32), limits::SUBSTEPS.0..=limits::SUBSTEPS.1),
        1..=16_u32,
        auto(prop::array::uniform2(16..=8192_u32)),
    );
    let scene = ("[a-zA-Z0-9 \"\\\\/'ü.\n-]{1,20}", auto(axis()), number(1e-6, 1e6), prop::option::of("[0-9a-f]{64}"));
    let objects = (object("vase".to_owned()), prop::option::of(object("pot-2".to_owned())));
    let expectations = prop::sample::subsequence(vec!["vase.apex_m > 0.3", "vase.com_m.z.max <= 1e-3", "vase.settle_s<2"], 0..=3);
    (scene, globals, objects, entries(), camera, expectations).prop_map(|(scene, globals, objects, entries, camera, expectations)| {
        let (seed, duration_s, fps, gravity_m_s2, ground, (cells_across, substeps_most), neighbours, size) = globals;
        let (file, up, metres_per_unit, blake3) = scene;
        Spec {
            format: 1,
            seed,
            scene: Scene { file, blake3, up, metres_per_unit },
            time: Time { duration_s, fps },
            world: World { gravity_m_s2, ground },
            solver: Solver { cells_across, substeps_most },
            objects: std::iter::once(objects.0).chain(objects.1).collect(),
            pins: entries.0,
            colliders: entries.1,
            forces: entries.2,
            events: entries.3,
            skin: Skin { neighbours, weights: Weights::Exact },
            camera,
            output: Output { size, background: "#00aAfF".to_owned() },
            expectations: expectations.into_iter().map(|that| Expectation { that: that.to_owned() }).collect(),
        }
    })
}

/// An edit of a single value.
fn leaf_edit() -> impl Strategy<Value = Edit> {
    let one = |path: &'static str, low: f64, high: f64| (low..high).prop_map(move |value| Edit::set(path, value)).boxed();
    let three = |path: &'static str, limit: f64| vector(limit).prop_map(move |value| Edit::set(path, json!(value))).boxed();
    let word = |path: &'static str, word: &'static str| Just(Edit::set(path, word)).boxed();
    prop::strategy::Union::new([
        one("object.vase.material.density_kg_m3", 1.0, 2e4),
        one("world.ground.friction", 0.0, 1.0),
        one("world.ground.height_m", -3.0, 3.0),
        one("time.duration_s", 0.0, 600.0),
        one("scene.metres_per_unit", 0.1, 10.0),
        three("object.vase.velocity_m_s", 200.0),
        three("object.vase.offset_m", 10.0),
        three("world.gravity_m_s2", 100.0),
        word("object.vase.proxy", "hull"),
        word("object.vase.rest", "stress_free"),
        word("object.vase.select", "all"),
        word("camera", "auto"),
        word("output.background", "#123456"),
        word("skin.weights", "paper"),
    ])
}

/// Any JSON, with words that specs know.
fn junk() -> impl Strategy<Value = Value> {
    let words = prop::sample::select(vec![
        "auto", "vase", "name", "kind", "box", "elastic", "material", "object", "select", "scene", "file", "format", "event", "that", "mu", "E",
        "part", "region", "above", "liquid", "preset", "",
    ]);
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        words.clone().prop_map(Value::from),
        ".{0,8}".prop_map(Value::from),
    ];
    leaf.prop_recursive(4, 40, 6, move |inner| {
        let keys = words.clone().prop_map(str::to_owned);
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..5).prop_map(Value::from),
            prop::collection::vec((keys, inner), 0..6).prop_map(|pairs| pairs.into_iter().collect())
        ]
    })
}

fn junk_path() -> impl Strategy<Value = String> {
    let words = vec![
        "object",
        "vase",
        "material",
        "young_pa",
        "E",
        "mu",
        "preset",
        "select",
        "box",
        "velocity_m_s",
        "z",
        "camera",
        "eye_m",
        "event",
        "part",
        "kind",
        "expect",
        "name",
        "world",
        "",
        "ü",
        "scene",
        "file",
    ];
    prop::collection::vec(prop::sample::select(words), 0..5).prop_map(|words| words.join("."))
}

fn junk_edit() -> impl Strategy<Value = Edit> {
    (0..3, junk_path(), junk()).prop_map(|(op, path, value)| match op {
        0 => Edit::set(path, value),
        1 => Edit::add(path, value),
        _ => Edit::remove(path),
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_spec_reads_back_as_it_was_written(spec in spec()) {
        spec.validate().unwrap();
        let text = spec.to_toml();
        let again = Spec::from_toml(&text).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        prop_assert_eq!(&again, &spec);
        prop_assert_eq!(again.to_toml(), text);
        prop_assert_eq!(again.hash(), spec.hash());
        prop_assert_eq!(Spec::from_json(&spec.to_value().to_string()).unwrap(), spec);
    }

    #[test]
    fn edits_lead_from_any_spec_to_any_other_and_back(a in spec(), b in spec()) {
        let there = a.apply(&a.edits_to(&b)).unwrap();
        prop_assert_eq!(there.diff(&b), vec![]);
        let back = there.apply(&b.edits_to(&a)).unwrap();
        prop_assert_eq!(back.diff(&a), vec![]);
        prop_assert_eq!(a.diff(&a), vec![]);
    }

    #[test]
    fn a_difference_names_what_was_edited(spec in spec(), edits in prop::collection::vec(leaf_edit(), 1..5)) {
        let to = spec.apply(&edits).unwrap();
        let paths: Vec<String> = spec.diff(&to).into_iter().map(|change| change.path).collect();
        for path in &paths {
            prop_assert!(edits.iter().any(|edit| edit.path() == path), "{path} in {edits:?}");
        }
        let (before, after) = (spec.to_value(), to.to_value());
        for edit in &edits {
            let pointer = format!("/{}", edit.path().replace('.', "/").replace("object/vase", "object/0"));
            prop_assert!(paths.contains(&edit.path().to_owned()) || near(&before.pointer(&pointer), &after.pointer(&pointer)), "{edit}");
        }
    }

    #[test]
    fn junk_is_refused_and_changes_nothing(value in junk(), edits in prop::collection::vec(junk_edit(), 1..4), text in ".{0,60}", spec in spec()) {
        let _ = Spec::from_value(value.clone());
        let _ = Spec::from_json(&value.to_string());
        let _ = Spec::from_toml(&text);
        let _ = Edit::parse_set(&text);
        let _ = Edit::parse_set(&format!("seed={text}"));
        let _ = expect::Condition::parse(&text);
        let _ = nearest(&text, ["young_pa"]);
        if let Ok(to) = spec.apply(&edits) {
            to.validate().unwrap();
            prop_assert_eq!(Spec::from_toml(&to.to_toml()).unwrap(), to);
        }
    }

    #[test]
    fn a_damaged_text_is_read_or_refused(spec in spec(), cut in any::<prop::sample::Index>(), insert in "[\\[\\]{}=\",#.\na1-]{0,3}") {
        let text = spec.to_toml();
        let at = cut.index(text.len());
        if text.is_char_boundary(at) {
            let _ = Spec::from_toml(&text[..at]);
            let _ = Spec::from_toml(&format!("{}{insert}{}", &text[..at], &text[at..]));
        }
    }
}

/// Equal up to what a difference leaves out.
fn near(a: &Option<&Value>, b: &Option<&Value>) -> bool {
    match (a.and_then(|a| a.as_f64()), b.and_then(|b| b.as_f64())) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-5 * a.abs().max(b.abs()),
        _ => a == b || a.is_some_and(Value::is_array),
    }
}
