//! Specs as users write them: read, refused, edited, compared.

use serde_json::{Value, json};

use super::*;

/// The outline of the contract without what later issues bring.
pub(super) const OUTLINE: &str = r##"
format = 1
seed = 1
[scene]
file = "vase.splat"
up = "auto"
metres_per_unit = 1.0
[time]
duration_s = "auto"
fps = 50
[world]
gravity_m_s2 = [0, 0, -9.81]
ground = { height_m = "auto", friction = 0.15, restitution = 0.0 }
[solver]
cells_across = "auto"
[[object]]
name = "vase"
select = "all"
proxy = "voxel"
material = { kind = "elastic", young_pa = "auto", poisson = 0.3, density_kg_m3 = 1000 }
offset_m = [0, 0, 0]
rotate_deg = [0, 0, 0]
rest = "as_captured"
velocity_m_s = [0, 0, 0]
spin_rad_s = [0, 0, 0]
[[pin]]
name = "base"
object = "vase"
region = { below = 0.05 }
from_s = 0.0
to_s = "end"
[[collider]]
name = "plinth"
shape = { box = { centre_m = [0, 0, -0.5], size_m = [1, 1, 0.2] } }
friction = 0.3
[[force]]
name = "wind"
object = "vase"
from_s = 0.2
to_s = 1.0
acceleration_m_s2 = [6, 0, 0]
[[event]]
at_s = 0.5
object = "vase"
push_m_s = [2, 0, 0]
[skin]
neighbours = 8
weights = "exact"
[camera]
eye_m = [2.0, -2.0, 1.0]
target_m = [0, 0, 0.4]
fov_deg = 45
orbit_deg_s = 0
[output]
size = "auto"
background = "#eaeaf2"
[[expect]]
that = "vase.apex_m > 0.3"
"##;

pub(super) fn outline() -> Spec {
    Spec::from_toml(OUTLINE).unwrap()
}

/// Compares with a text in the project's folder of snapshots.
macro_rules! assert_text {
    ($name:literal, $text:expr) => {
        insta::with_settings!({ snapshot_path => "../../snapshots/spec", prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!($name, $text);
        });
    };
}

/// The outline with one line changed.
pub(super) fn with(line: &str, instead: &str) -> Result<Spec, SpecError> {
    assert!(OUTLINE.contains(line), "{line}");
    Spec::from_toml(&OUTLINE.replacen(line, instead, 1))
}

pub(super) fn refused(line: &str, instead: &str) -> SpecError {
    with(line, instead).expect_err(instead)
}

#[test]
fn the_outline_reads_and_is_written_canonically() {
    let spec = outline();
    assert_eq!(spec.events[0].name, "event1");
    let text = spec.to_toml();
    assert_eq!(Spec::from_toml(&text).unwrap(), spec);
    assert_eq!(Spec::from_toml(&text).unwrap().to_toml(), text);
    assert_text!("canonical", text);
}

#[test]
fn the_least_spec_gets_defaults_and_a_name() {
    let spec = Spec::from_toml("format = 1\nscene.file = 'a/b/Vase No 2.splat.gz'\n[[object]]\n").unwrap();
    assert_eq!(spec, Spec::of_scene("a/b/Vase No 2.splat.gz"));
    assert_eq!(spec.objects[0].name, "vase_no_2");
    assert_eq!(spec.time.fps, 50);
    assert_eq!(name_from_file("builtin:demo"), "demo");
    assert_eq!(name_from_file("/x/.splat"), "splat");
    assert_eq!(name_from_file(""), "object");
}

#[test]
fn json_says_the_same_as_toml() {
    let spec = outline();
    assert_eq!(Spec::from_json(&spec.to_value().to_string()).unwrap(), spec);
    assert_eq!(Spec::from_json("{\n\"format\": }").unwrap_err().line, Some(2));
}

#[test]
fn faults_say_path_value_bounds_and_nearest_name() {
    assert_text!(
        "faults",
        [
            refused("fps = 50", "fsp = 50"),
            refused("fps = 50", "fps = 2.5"),
            refused("fps = 50", "fps = 0"),
            refused("fps = 50", "fps = \"fast\""),
            refused("young_pa = \"auto\"", "yuong_pa = 3"),
            refused("young_pa = \"auto\"", "young_pa = 12"),
            refused("young_pa = \"auto\"", "young_pa = \"soft\""),
            refused("poisson = 0.3", "poisson = 0.5"),
            refused("density_kg_m3 = 1000", "density_kg_m3 = nan"),
            refused("proxy = \"voxel\"", "proxy = \"voxels\""),
            refused("velocity_m_s = [0, 0, 0]", "velocity_m_s = [150, 150, 0]"),
            refused("velocity_m_s = [0, 0, 0]", "velocity_m_s = [0, 0]"),
            refused("velocity_m_s = [0, 0, 0]", "velocity_m_s = 3"),
            refused("velocity_m_s = [0, 0, 0]", "velocity_m_s = [0, \"up\", 0]"),
            refused("gravity_m_s2 = [0, 0, -9.81]", "gravity_m_s2 = \"mon\""),
            refused("gravity_m_s2 = [0, 0, -9.81]", "gravity_m_s2 = [0, 0, -1e4]"),
            refused("name = \"vase\"", "name = \"My Vase\""),
            refused("object = \"vase\"\nregion", "object = \"vaes\"\nregion"),
            refused("region = { below = 0.05 }", "region = { beneath = 0.05 }"),
            refused("region = { below = 0.05 }", "region = { below = 1.5 }"),
            refused("region = { below = 0.05 }", ""),
            refused("size_m = [1, 1, 0.2]", "size_m = [1, 1, 0]"),
            refused("to_s = 1.0", "to_s = 0.1"),
            refused("push_m_s = [2, 0, 0]", ""),
            refused("up = \"auto\"", "up = \"z\""),
            refused("background = \"#eaeaf2\"", "background = \"grey\""),
            refused("target_m = [0, 0, 0.4]", "target_m = [2, -2, 1]"),
            refused("that = \"vase.apex_m > 0.3\"", "that = \"vase.apex > 0.3\""),
            refused("that = \"vase.apex_m > 0.3\"", "that = \"vase.com_m.z > 0.3\""),
            refused("that = \"vase.apex_m > 0.3\"", "that = \"pot.apex_m > 0.3\""),
            refused("that = \"vase.apex_m > 0.3\"", "that = \"vase flies\""),
            refused("[[collider]]", "[[pin]]\nname = \"base\"\nobject = \"vase\"\nregion = { above = 0.5 }\n[[collider]]"),
            refused("format = 1", "format = 2"),
            refused("format = 1", ""),
            refused("[scene]", "[scene"),
            refused("seed = 1", "seed = 1979-05-27"),
            refused("seed = 1", "seed = 99999999999999999999"),
            refused("seed = 1", "seed = -1"),
            Spec::from_toml("").unwrap_err(),
            Spec::from_toml("format = 1\nscene.file = 'x.ply'").unwrap_err(),
        ]
        .map(|error| error.to_string())
        .join("\n")
    );
}

#[test]
fn no_spec_asks_for_more_than_the_solver_holds() {
    let colliders = |count: u32| {
        let one = |k: u32| format!("[[collider]]\nname = \"c{k}\"\nshape = {{ sphere = {{ centre_m = [{k}, 0, 0], radius_m = 0.1 }} }}\n");
        Spec::from_toml(&format!("format = 1\nscene.file = 'x.ply'\n[[object]]\n{}", (0..count).map(one).collect::<String>()))
    };
    assert_eq!(colliders(limits::COLLIDERS).unwrap().colliders.len(), 126);
    assert!(colliders(limits::COLLIDERS + 1).unwrap_err().to_string().contains("126"));
    // Three objects of rigid parts; the first is a soft one until an event, if any, makes all of it rigid.
    let pieces = |parts: u32, event: &str| {
        let part = |k: u32| format!("[[object.part]]\nname = \"p{k}\"\nregion = {{ above = 0.5 }}\nmaterial = {{ kind = \"rigid\" }}\n");
        let parts: String = (0..parts).map(part).collect();
        let object = |name: &str, kind: &str| format!("[[object]]\nname = \"{name}\"\nmaterial = {{ kind = \"{kind}\" }}\n{parts}");
        let [a, b, c] = [object("a", "elastic"), object("b", "rigid"), object("c", "rigid")];
        Spec::from_toml(&format!("format = 1\nscene.file = 'x.ply'\n{a}{b}{c}{event}"))
    };
    let event = "[[event]]\nat_s = 1\nobject = \"a\"\nmaterial = { kind = \"rigid\" }\n";
    assert!(pieces(42, "").is_ok());
    assert_eq!(pieces(42, event).unwrap_err().kind, SpecErrorKind::Range);
    assert!(pieces(43, "").unwrap_err().to_string().contains("131 objects and parts are rigid"));
}

#[test]
fn what_comes_later_is_refused_by_name() {
    let faults = [
        refused("[[pin]]", "[[look]]\nobject = \"vase\"\n[[pin]]"),
        refused("push_m_s = [2, 0, 0]", "shatter = true"),
        refused("shape = { box = { centre_m = [0, 0, -0.5], size_m = [1, 1, 0.2] } }", "shape = \"scene\""),
        refused("select = \"all\"", "select = { segment = \"pot\" }"),
        refused("select = \"all\"", "select = [\"all\", { ids = [1, 2, 3] }]"),
    ];
    for fault in &faults {
        assert_eq!(fault.kind, SpecErrorKind::NotBuilt, "{fault}");
    }
    assert_text!("later", faults.map(|error| error.to_string()).join("\n"));
}

#[test]
fn a_count_may_be_written_with_a_point() {
    let spec = |fps: &str| Spec::from_toml(&format!("format = 1.0\n[scene]\nfile = \"a.splat\"\n[time]\nfps = {fps}\n[[object]]\nname = \"a\"\n"));
    assert_eq!(spec("25.0").unwrap().time.fps, 25);
    let fault = spec("25.5").unwrap_err();
    assert!(fault.to_string().contains("time.fps"), "{fault}");
}

#[test]
fn forces_act_in_one_way_that_is_checked() {
    let force = |text: &str| with("acceleration_m_s2 = [6, 0, 0]", text).map(|spec| spec.forces[0].clone());
    let written = force("acceleration_m_s2 = \" vec3( 6.0*sin((3.0*t)),0, 0 ) \"").unwrap();
    assert_eq!(written.acceleration_m_s2, Some(Acceleration::Expression("vec3(6 * sin(3 * t), 0, 0)".to_owned())));
    let wind = force("wind = { velocity_m_s = [5, 0, 0] }").unwrap().wind.unwrap();
    assert_eq!((wind.drag_per_s, wind.gust, wind.eddy_m), (1.0, 0.0, 0.3));
    assert_eq!(force("vortex = { speed_m_s = 3 }").unwrap().vortex.unwrap().centre_m, Auto::Auto);
    let path = with("region = { below = 0.05 }", "region = { below = 0.05 }\npath = [[1, 0.5, 0, 0], [2, 0, 0, 0]]").unwrap();
    assert_eq!(path.pins[0].path.len(), 2);
    let refused = |text: &str| force(text).expect_err(text);
    let pin = |path: &str| with("region = { below = 0.05 }", &format!("region = {{ below = 0.05 }}\npath = {path}")).expect_err(path);
    let faults = [
        refused(""),
        refused("acceleration_m_s2 = \"vec3(6 * sni(t), 0, 0)\""),
        refused("acceleration_m_s2 = \"6 * sin(t)\""),
        refused("acceleration_m_s2 = [1e5, 0, 0]"),
        refused("acceleration_m_s2 = 3"),
        refused("acceleration_m_s2 = [0, 0, 1]\ndrag = { linear_per_s = 1 }"),
        refused("drag = {}"),
        refused("drag = { linear_per_s = -1 }"),
        refused("wind = { speed = 3 }"),
        refused("wind = 3"),
        refused("vortex = { speed_m_s = 3, axis = [0, 0, 0] }"),
        refused("spring = {}"),
        refused("spring = { to_m = [0, 0, 1], path_m = [[0, 0, 0, 0]] }"),
        refused("spring = { path_m = [[1, 0, 0, 0], [1, 0, 0, 1]] }"),
        refused("spring = { path_m = [[0, 0, 0, 0], [0.001, 0, 0, 1]] }"),
        refused("spring = { path_m = [[0, 0, 0]] }"),
        refused("motor = { axis = [0, 0, 1] }"),
        pin("[[0, 0.1, 0, 0]]"),
        pin("[[-1, 0, 0, 0]]"),
    ];
    assert_text!("forces", faults.map(|error| error.to_string()).join("\n"));
}

#[test]
fn edits_set_add_and_remove_by_name() {
    let spec = outline();
    let edited = spec
        .apply(&[
            Edit::set("object.vase.material.young_pa", 3e4),
            Edit::set("object.vase.material.rho", 500),
            Edit::set("object.vase.velocity_m_s.z", 3),
            Edit::set("object.vase.select.sphere", json!({ "centre_m": [0, 0, 0], "radius_m": 1 })),
            Edit::set("collider.plinth.shape.box.size_m", json!([2, 2, 0.2])),
            Edit::set("world.gravity_m_s2", "moon"),
            Edit::set("camera", "auto"),
            Edit::add("event", json!({ "at_s": 1, "object": "vase", "push_m_s": [0, 1, 0] })),
            Edit::add("expect", "vase.drop_m < 1"),
            Edit::remove("expect.vase.apex_m > 0.3"),
            Edit::remove("pin.base"),
            Edit::remove("time.fps"),
        ])
        .unwrap();
    let Material::Elastic(elastic) = &edited.objects[0].material else { panic!("elastic") };
    assert_eq!((elastic.young_pa, elastic.density_kg_m3), (Young::Value(3e4), 500.0));
    assert_eq!(edited.objects[0].velocity_m_s, [0.0, 0.0, 3.0]);
    assert_eq!(edited.objects[0].select, Select::Sphere(SphereShape { centre_m: [0.0; 3], radius_m: 1.0 }));
    assert_eq!(edited.events[1].name, "event2");
    assert_eq!((edited.camera, edited.pins.len(), edited.expectations.len()), (Auto::Auto, 0, 1));
    assert_eq!(edited.expectations[0].that, "vase.drop_m < 1");
    let jelly = spec.apply(&[Edit::set("object.vase.material.preset", "jelly")]).unwrap();
    assert_eq!(jelly, spec.apply(&[Edit::set("object.vase.material", "jelly")]).unwrap());
    assert_ne!(jelly, spec);
}

#[test]
fn edits_that_are_refused_say_why() {
    let spec = outline();
    let faults = [
        Edit::set("object.vaze.material.young_pa", 3e4),
        Edit::set("object.vase.material.young", 3e4),
        Edit::set("object.vase.materail.young_pa", 3e4),
        Edit::set("object.vase.material.young_pa", 12),
        Edit::set("object.vase.material.kind", "gas"),
        Edit::set("object.vase.velocity_m_s.w", 1),
        Edit::set("object.vase.select.box.size_m", json!([1, 1, 1])),
        Edit::set("object", json!([])),
        Edit::set("object[0].name", "x"),
        Edit::set("wrold.gravity_m_s2", "moon"),
        Edit::set("gravity", "moon"),
        Edit::set("young_pa", 3e4),
        Edit::set("", 1),
        Edit::set("..", 1),
        Edit::set("time.fps.x", 1),
        Edit::set("object.vase.velocity_m_s", json!([0, 0, 201])),
        Edit::set("object.vase.name", "pot"),
        Edit::set("format", 2),
        Edit::add("force", json!({ "name": "wind", "object": "vase", "acceleration_m_s2": [0, 0, 1] })),
        Edit::add("forces", json!({})),
        Edit::add("force", 3),
        Edit::remove("object.vase"),
        Edit::remove("scene.file"),
        Edit::remove("collider.tabel"),
        Edit::remove("time.fsp"),
    ]
    .map(|edit| spec.apply(std::slice::from_ref(&edit)).expect_err(&edit.to_string()).to_string());
    assert_text!("refused_edits", faults.join("\n"));
    // All or none: the good edit before the bad one left nothing behind.
    assert!(spec.apply(&[Edit::set("seed", 2), Edit::set("seeds", 2)]).is_err());
    assert_eq!(spec, outline());
}

#[test]
fn set_reads_toml_values_and_bare_words() {
    let value = |text: &str| match Edit::parse_set(text).unwrap() {
        Edit::Set { value, .. } => value,
        other => panic!("{other}"),
    };
    assert_eq!(value("a=3e4"), json!(3e4));
    assert_eq!(value("a = 1_000"), json!(1000));
    assert_eq!(value("a=auto"), json!("auto"));
    assert_eq!(value("a=+x"), json!("+x"));
    assert_eq!(value("a=#ff0000"), json!("#ff0000"));
    assert_eq!(value("a=\"x = 1\""), json!("x = 1"));
    assert_eq!(value("a=[0, 0, -1.62]"), json!([0, 0, -1.62]));
    assert_eq!(value("a={ above = 0.5 }"), json!({ "above": 0.5 }));
    assert_eq!(value("a=2024-01-01"), json!("2024-01-01"));
    assert_eq!(value("a=3 m"), json!("3 m"));
    for wrong in ["a", "=3", "a=", "a=[1, 2", "a=nan", "a={x=1"] {
        assert!(Edit::parse_set(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn differences_have_units_ratios_and_words() {
    let spec = with("young_pa = \"auto\"", "young_pa = 1e5").unwrap();
    let said = |edits: &[Edit]| {
        let to = spec.apply(edits).unwrap();
        spec.diff(&to).iter().map(Change::to_string).collect::<Vec<_>>().join("\n")
    };
    let lines = [
        said(&[Edit::set("object.vase.material.young_pa", 5e4)]),
        said(&[Edit::set("object.vase.material.young_pa", 1.1e5)]),
        said(&[Edit::set("object.vase.material.young_pa", "auto")]),
        said(&[Edit::set("object.vase.material", "rubber")]),
        said(&[Edit::set("world.gravity_m_s2", "moon")]),
        said(&[Edit::set("world.gravity_m_s2", "zero")]),
        said(&[Edit::set("world.gravity_m_s2", json!([0, 0, -19.62]))]),
        said(&[Edit::set("object.vase.velocity_m_s", json!([0, 0, 3]))]),
        said(&[Edit::set("object.vase.offset_m", json!([0, 0.5, 0]))]),
        said(&[Edit::set("event.event1.push_m_s", json!([-4, 0, 0]))]),
        said(&[Edit::set("event.event1.at_s", 1)]),
        said(&[Edit::add("event", json!({ "at_s": 0.5, "object": "vase", "push_m_s": [0, 2, 0] }))]),
        said(&[Edit::remove("event.event1"), Edit::remove("pin.base")]),
        said(&[Edit::set("camera.eye_m", json!([1, -1, 0.7]))]),
        said(&[Edit::set("camera", "auto")]),
        said(&[Edit::set("time.duration_s", 4)]),
        said(&[Edit::set("collider.plinth.shape", json!({ "sphere": { "centre_m": [0, 0, 0], "radius_m": 1 } }))]),
        said(&[Edit::set("object.vase.density_kg_m3", 1)].map(|_| Edit::set("object.vase.material.density_kg_m3", 1400))),
    ];
    assert_text!("differences", lines.join("\n"));
    // Noise is not a difference.
    assert_eq!(said(&[Edit::set("object.vase.material.young_pa", 1e5 * (1.0 + 1e-9))]), "");
    let json = serde_json::to_value(&spec.diff(&spec.apply(&[Edit::set("time.fps", 25)]).unwrap())[0]).unwrap();
    assert_eq!(
        json,
        json!({ "path": "time.fps", "from": 50, "to": 25, "unit": "frames/s", "relative_change": -0.5, "gloss": "half as many frames" })
    );
}

#[test]
fn the_hash_follows_the_content_and_not_the_place() {
    let spec = outline();
    let mut elsewhere = spec.clone();
    elsewhere.scene.file = "../vase.splat".to_owned();
    assert_ne!(spec.hash(), elsewhere.hash());
    let hash = Some(blake3::hash(b"scene").to_hex().to_string());
    let (mut here, mut there) = (spec.clone(), elsewhere);
    here.scene.blake3.clone_from(&hash);
    there.scene.blake3 = hash;
    assert_eq!(here.hash(), there.hash());
    assert_ne!(here.hash(), spec.hash());
    assert_ne!(here.hash(), here.apply(&[Edit::set("seed", 2)]).unwrap().hash());
    assert_eq!(here.hash().len(), 64);
}

#[test]
fn a_spec_file_finds_its_scene_from_where_it_lies() {
    let home = tempfile::tempdir().unwrap();
    let root = std::fs::canonicalize(home.path()).unwrap();
    std::fs::create_dir_all(root.join("specs")).unwrap();
    std::fs::write(root.join("vase.splat"), b"x").unwrap();
    std::fs::write(root.join("specs/a.toml"), "format = 1\nscene.file = '../vase.splat'\n[[object]]\n").unwrap();
    let spec = Spec::read(&root.join("specs/a.toml")).unwrap();
    assert_eq!(spec.scene.file, root.join("vase.splat").to_str().unwrap());
    spec.write(&root.join("out/v1/spec.toml")).unwrap();
    let text = std::fs::read_to_string(root.join("out/v1/spec.toml")).unwrap();
    assert!(text.contains("file = \"../../vase.splat\""), "{text}");
    assert_eq!(Spec::read(&root.join("out/v1/spec.toml")).unwrap(), spec);
    assert_eq!(std::fs::read_dir(root.join("out/v1")).unwrap().count(), 1);

    assert_eq!(Spec::read(&root).unwrap_err().kind, SpecErrorKind::File);
    assert_eq!(Spec::read(&root.join("none.toml")).unwrap_err().kind, SpecErrorKind::File);
    std::fs::write(root.join("bad.toml"), [0xff, 0xfe]).unwrap();
    assert_eq!(Spec::read(&root.join("bad.toml")).unwrap_err().kind, SpecErrorKind::Syntax);
    let builtin = Spec::of_scene("builtin:demo");
    builtin.write(&root.join("demo.toml")).unwrap();
    assert_eq!(Spec::read(&root.join("demo.toml")).unwrap(), builtin);
}

#[test]
fn conditions_compare_what_was_measured() {
    let outcome =
        |text: &str, measured: Measured| expect::Condition::parse(text).unwrap().evaluate(|object, _| (object == "vase").then_some(measured));
    use expect::Measured;
    assert!(outcome("vase.apex_m > 0.3", Measured::Number(0.41)).held);
    assert!(!outcome("vase.apex_m>=0.5", Measured::Number(0.41)).held);
    assert!(outcome("vase.travel_m.y <= -1", Measured::Vector([0.0, -2.0, 0.0])).held);
    assert!(outcome("vase.impacts_s.count == 2", Measured::Series(vec![0.5, 1.0])).held);
    assert!(outcome("vase.stretch_max.max < 2e0", Measured::Series(vec![1.0, 1.5])).held);
    assert!(outcome("vase.com_m.z.last > 1", Measured::VectorSeries(vec![[0.0; 3], [0.0, 0.0, 2.0]])).held);
    assert!(outcome("vase.low_m.first != 1", Measured::Series(vec![0.0])).held);
    let never = outcome("vase.settle_s < 2", Measured::Null);
    assert_eq!(never, expect::Outcome { text: "vase.settle_s < 2".to_owned(), value: None, held: false });
    assert_eq!(outcome("pot.settle_s < 2", Measured::Number(1.0)).value, None);
}

#[test]
fn the_schemas_hold_the_ranges() {
    let spec = schema::spec();
    let young = &spec["$defs"]["Material"]["oneOf"][1]["properties"]["young_pa"];
    assert_eq!((&young["minimum"], &young["maximum"]), (&json!(1e2), &json!(1e12)));
    assert_eq!(spec["$defs"]["Object"]["properties"]["velocity_m_s"]["items"]["maximum"], json!(200.0));
    assert_eq!(spec["$defs"]["Output"]["properties"]["size"]["anyOf"][1]["items"]["minimum"], json!(16));
    let paths = schema::paths();
    for path in [
        "seed",
        "object.NAME.material.young_pa",
        "object.NAME.part.NAME.region.above",
        "world.ground.friction",
        "camera.eye_m",
        "collider.NAME.shape.box.size_m",
        "expect.NAME.that",
    ] {
        assert!(paths.iter().any(|known| known == path), "{path} in {paths:?}");
    }
    let ops: Vec<&Value> = schema::edit()["$defs"]["Edit"]["oneOf"].as_array().unwrap().iter().map(|op| &op["properties"]["op"]["const"]).collect();
    assert_eq!(ops, [&json!("set"), &json!("add"), &json!("remove")]);
}

/// What is far too much is refused before it is read, and in words; what nests without end does not end the program.
#[test]
fn texts_without_end_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("long.toml");
    std::fs::write(&file, format!("{OUTLINE}\n# {}", "x".repeat(10 << 20))).unwrap();
    assert!(Spec::read(&file).unwrap_err().to_string().contains("too many for a spec"));
    let force = |expression: &str| refused("acceleration_m_s2 = [6, 0, 0]", &format!("acceleration_m_s2 = \"{expression}\"")).to_string();
    let long = force(&format!("{}x", "x + ".repeat(10 << 18)));
    assert!(long.contains("bytes") && long.len() < 1000, "{} characters", long.len());
    // There are no names of one's own, so nothing can call itself.
    assert!(force("f(x)").contains('f'));
    for nested in ["[".repeat(100_000), "{a=".repeat(100_000), "a.".repeat(100_000)] {
        let error = Spec::from_toml(&format!("format = 1\nscene = {nested}")).unwrap_err().to_string();
        assert!(error.len() < 2000, "{} characters", error.len());
    }
}

/// Nothing may speak of an object that is not there: neither a spec nor an edit that takes the object away.
#[test]
fn an_event_on_an_object_that_is_gone_is_refused_by_name() {
    let event = OUTLINE.lines().find(|line| line.starts_with("push_m_s")).unwrap();
    let gone = refused(event, &format!("{event}\n[[event]]\nname = \"late\"\nat_s = 0.5\nobject = \"pot\"\npush_m_s = [1, 0, 0]"));
    assert!(gone.path.starts_with("event.late") && gone.to_string().contains("pot"), "{gone}");
    let mut two = outline();
    two.objects.push(crate::spec::Object::new("pot"));
    two.events.push(crate::spec::Event { push_m_s: Some([1.0, 0.0, 0.0]), ..crate::spec::Event::at("late", "pot", 0.5) });
    two.validate().unwrap();
    two.objects.pop();
    assert!(two.validate().unwrap_err().to_string().contains("pot"));
}
