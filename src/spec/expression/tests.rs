//! What holds of every expression, and of some in particular.

use super::function::{Form, TABLE};
use super::*;
use proptest::prelude::*;

fn scalar(text: &str) -> f64 {
    let tree = parse(text, Kind::Scalar).unwrap_or_else(|fault| panic!("{text}: {fault}"));
    Program::of(&tree).expect("a program").evaluate(&inputs())[0].value
}

fn inputs() -> Inputs {
    Inputs { position_m: [1.0, -2.0, 0.5], velocity_m_s: [0.3, 0.1, -4.0], rest_m: [1.0, -2.0, 0.25], time_s: 2.0, mass_kg: 0.01, seed: 77.0 }
}

fn fault(text: &str) -> Fault {
    parse(text, Kind::Vector).expect_err(text)
}

#[test]
fn the_table_is_in_the_order_of_the_functions() {
    for (index, entry) in TABLE.iter().enumerate() {
        assert_eq!(entry.function as usize, index, "{}", entry.word);
        assert_eq!(entry.function.entry().word, entry.word);
    }
}

#[test]
fn values_are_those_of_mathematics() {
    let cases: [(&str, f64); 24] = [
        ("1 + 2 * 3 - 4 / 8", 6.5),
        ("-2 - -3", 1.0),
        ("-pow(-2, 3)", 8.0),
        ("pow(2, 0.5) - sqrt(2)", 0.0),
        ("t * mass", 0.02),
        ("x.y + x0.z - v.z", 2.25),
        ("length(vec3(3, 0, 4))", 5.0),
        ("dot(x, vec3(1)) - (x.x + x.y + x.z)", 0.0),
        ("cross(vec3(1, 0, 0), vec3(0, 1, 0)).z", 1.0),
        ("length(normalize(x)) - length(normalize(vec3(0)))", 1.0),
        ("if(t > 1 && !(t >= 3), 5, 6)", 5.0),
        ("if(t < 1 || t != 2, 5, 6)", 6.0),
        ("select(t == 2, 7, 8)", 7.0),
        ("clamp(5, 0, 2) + min(1, 2) + max(1, 2)", 5.0),
        ("mix(1, 3, 0.25)", 1.5),
        ("step(2, t) + step(2.1, t)", 1.0),
        ("smoothstep(0, 4, t)", 0.5),
        ("floor(-1.5) + fract(-1.5)", -1.5),
        ("ln(exp(2)) - abs(-2)", 0.0),
        ("tan(0.3) - sin(0.3) / cos(0.3)", 0.0),
        ("sin(pi / 2)", 1.0),
        ("vec3(1, 2, 3).y", 2.0),
        ("(x * 2 + 1).y", -3.0),
        (".5e1 + 1.", 6.0),
    ];
    for (text, expected) in cases {
        assert!((scalar(text) - expected).abs() < 1e-12, "{text} = {}", scalar(text));
    }
}

#[test]
fn what_is_no_number_stays_none() {
    for text in ["1 / 0", "0 / 0", "ln(0)", "ln(-1)", "sqrt(-1)", "pow(-2, 0.5)", "pow(0, -1)", "1e30 * 1e30 * exp(1000)"] {
        assert!(!scalar(text).is_finite(), "{text}");
    }
}

#[test]
fn a_fault_points_at_the_character_and_says_what_is_expected() {
    let shown = |text: &str| fault(text).to_string();
    assert_eq!(shown("vec3(1, 2, flor(t))"), "character 12: `flor`; did you mean `floor`?");
    assert_eq!(shown("vec3(1, 2"), "character 10: the end where `)`, `,` or an operator is expected");
    assert_eq!(shown("6 * sin(t)"), "character 1: a number where a vector, such as vec3(0, 0, 1) is expected");
    assert_eq!(shown("x * (t > 1)"), "character 5: a truth where a number or a vector is expected");
    assert_eq!(shown("x.w"), "character 3: `w` where x, y or z is expected");
    assert_eq!(shown("vec3(1, 2)"), "character 1: 2 where 3 or 1 arguments of `vec3` is expected");
    assert_eq!(shown("if(t = 1, x, v)"), "character 6: `=` where `==`, to compare, is expected");
    assert_eq!(shown("x ^ 2"), "character 3: `^` where pow(base, exponent) is expected");
    assert_eq!(shown("if(1 < t < 2, x, v)"), "character 10: `<` where `&&`: comparisons do not chain, so an operator between them is expected");
    assert_eq!(shown("x v"), "character 3: `v` where an operator or the end is expected");
    assert_eq!(shown("é"), "character 1: `\\u{e9}` where a number, a name or a sign is expected");
    assert_eq!(shown("1e99 * x"), "character 1: `1e99` where a number up to 1e30 is expected");
    assert_eq!(shown(""), "character 1: the end where a number, a name or a function is expected");
}

#[test]
fn what_is_too_much_is_refused() {
    let long = "x + ".repeat(3_000_000) + "x";
    let start = std::time::Instant::now();
    assert!(fault(&long).to_string().contains("12000001 bytes"));
    assert!(start.elapsed().as_millis() < 100, "refused unread");
    for text in ["(".repeat(4000), "-".repeat(4000), "sin(".repeat(1000), "x + ".repeat(1000), "x.".repeat(2000)] {
        let fault = fault(&text);
        assert!(fault.at > 0, "{fault}");
    }
    let wide = format!("{}x{}", "smoothstep(x, v, ".repeat(40), ")".repeat(40));
    assert!(parse(&wide, Kind::Vector).is_ok());
}

#[test]
fn numbers_alone_do_not_change_the_steps() {
    let steps = |text: &str| Program::of(&parse(text, Kind::Vector).expect("an expression")).expect("a program").instructions;
    assert_eq!(steps("vec3(6 * sin(3 * t), 0, 0)"), steps("vec3(0.5 * sin(3.25 * t), 7, 0)"));
    assert_ne!(steps("vec3(6 * sin(3 * t), 0, 0)"), steps("vec3(6 * cos(3 * t), 0, 0)"));
}

#[test]
fn noise_is_smooth_bounded_and_zero_on_whole_places() {
    let (mut low, mut high) = (0.0f32, 0.0f32);
    for k in 0..20_000 {
        let place = [k as f32 * 0.137, k as f32 * -0.071, k as f32 * 0.0191];
        let (here, beside) = (noise(place), noise([place[0] + 1e-3, place[1], place[2]]));
        assert!((here - beside).abs() < 1e-2);
        (low, high) = (low.min(here), high.max(here));
    }
    assert!(low < -0.5 && high > 0.5 && low >= -1.0 && high <= 1.0, "{low} {high}");
    assert_eq!(noise([3.0, -2.0, 7.0]), 0.0);
    assert!(noise([f32::NAN, 1e38, -1e38]).is_nan() || noise([0.0, 1e38, -1e38]).is_finite());
    let mean = (0..10_000).map(|k| random(k as f32)).sum::<f32>() / 10_000.0;
    assert!((mean - 0.5).abs() < 0.01, "{mean}");
}

/// A random typed tree, by a list of choices that runs out.
pub(crate) fn grown(choices: &mut std::slice::Iter<u32>, kind: Kind, depth: usize) -> Tree {
    let pick = *choices.next().unwrap_or(&0) as usize;
    if depth == 0 || choices.len() == 0 {
        return leaf(pick, kind);
    }
    let fitting: Vec<_> = TABLE.iter().filter(|e| e.form != Form::Prefix || e.function == Function::Negate).collect();
    let entry = fitting[pick % fitting.len()];
    let vector = |c: &mut std::slice::Iter<u32>| grown(c, Kind::Vector, depth - 1);
    let scalar = |c: &mut std::slice::Iter<u32>| grown(c, Kind::Scalar, depth - 1);
    use super::function::Rule;
    let args = match entry.rule {
        Rule::Each(count) => {
            (0..count).map(|k| if k > 0 && pick.is_multiple_of(3) { scalar(choices) } else { grown(choices, kind, depth - 1) }).collect()
        }
        Rule::Compare => vec![scalar(choices), scalar(choices)],
        Rule::Logic(count) => (0..count).map(|_| grown(choices, Kind::Truth, depth - 1)).collect(),
        Rule::Choice => vec![grown(choices, Kind::Truth, depth - 1), grown(choices, kind, depth - 1), scalar(choices)],
        Rule::Build => (0..if pick.is_multiple_of(4) { 1 } else { 3 }).map(|_| scalar(choices)).collect(),
        Rule::Measure(count) | Rule::Vectors(count) => (0..count).map(|_| vector(choices)).collect(),
        Rule::Noise => vec![vector(choices)],
        Rule::Number => vec![scalar(choices)],
    };
    match Tree::call(entry.function, args) {
        Ok(tree) if tree.kind == kind => tree,
        _ => leaf(pick, kind),
    }
}

fn leaf(pick: usize, kind: Kind) -> Tree {
    let named = |name: usize| Tree::name(Name::ALL[name]);
    match kind {
        Kind::Scalar if pick.is_multiple_of(3) => Tree::number(pick as f64 % 1000.0 * 0.0625),
        Kind::Scalar => named(3 + pick % 4),
        Kind::Vector => named(pick % 3),
        Kind::Truth => Tree::call(Function::Less, vec![named(3), Tree::number(pick as f64 % 4.0)]).expect("a comparison"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_printed_reads_back_as_the_same_tree(choices in prop::collection::vec(any::<u32>(), 1..60)) {
        let tree = grown(&mut choices.iter(), Kind::Vector, 5);
        let text = tree.to_string();
        match parse(&text, Kind::Vector) {
            Ok(again) => {
                prop_assert_eq!(again.to_string(), text);
                prop_assert_eq!(again, tree);
            }
            // Only for its size.
            Err(fault) => prop_assert!(tree.size() > NODES || text.len() > TEXT || fault.at == 0, "{}: {}", text, fault),
        }
    }

    #[test]
    fn derivatives_are_those_of_differences(choices in prop::collection::vec(any::<u32>(), 1..30), place in prop::array::uniform6(0.2f64..2.0)) {
        let tree = grown(&mut choices.iter(), Kind::Vector, 3);
        let Ok(program) = Program::of(&tree) else { return Ok(()) };
        let at = |p: [f64; 6]| program.evaluate(&Inputs { position_m: [p[0], p[1], p[2]], velocity_m_s: [p[3], p[4], p[5]], ..inputs() });
        let here = at(place);
        for k in 0..6 {
            let near = |h: f64| { let mut p = place; p[k] += h; at(p) };
            let (plus, minus, more) = (near(1e-6), near(-1e-6), near(2e-6));
            for c in 0..3 {
                let (forward, backward) = ((plus[c].value - here[c].value) / 1e-6, (here[c].value - minus[c].value) / 1e-6);
                let further = (more[c].value - plus[c].value) / 1e-6;
                let size = 1.0 + forward.abs() + here[c].value.abs();
                // Corners and steps have no one derivative, noise counts as level, and steep places say nothing at this distance.
                let plain = (forward - backward).abs() < 1e-4 * size && (forward - further).abs() < 1e-4 * size && size < 1e4;
                if plain && !tree.to_string().contains("noise") && !tree.to_string().contains("random") {
                    prop_assert!((here[c].slope[k] - forward).abs() < 1e-3 * size, "{} by {k}: {} and {forward}", tree, here[c].slope[k]);
                }
            }
        }
    }

    #[test]
    fn no_text_panics(text in "[-+*/()<>=!&|.,a-z0-9 ]{0,80}", other in ".{0,40}") {
        let _ = parse(&text, Kind::Vector);
        let _ = parse(&other, Kind::Scalar);
    }

    #[test]
    fn damaged_texts_are_read_or_refused(choices in prop::collection::vec(any::<u32>(), 1..40), cut in any::<prop::sample::Index>()) {
        let text = grown(&mut choices.iter(), Kind::Vector, 4).to_string();
        let at = cut.index(text.len());
        if let Err(fault) = parse(&text[..at], Kind::Vector) {
            prop_assert!(fault.at <= at + 1);
        }
    }
}
