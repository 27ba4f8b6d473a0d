//! Steps of expressions as WGSL. Only the steps are read here, never a text of a user; numbers stay in a
//! buffer, so that another number is no other shader.

use crate::spec::expression::{Instruction, Kind, Op, Program, parse};
use std::fmt::Write;

/// `field_0`, … for each shape, and the switch `field` over them.
pub fn functions(shapes: &[(&[Instruction], &[u16])]) -> String {
    let mut text = String::new();
    for (index, (instructions, results)) in shapes.iter().enumerate() {
        function(&mut text, index, instructions, results);
    }
    text.push_str("\nfn field(shape: u32, first: u32, here: Here) -> Pull {\n    switch shape {\n");
    for index in 0..shapes.len() {
        let _ = writeln!(text, "        case {index}u: {{ return field_{index}(first, here); }}");
    }
    text.push_str("        default: { return no_pull(); }\n    }\n}\n");
    text
}

fn function(text: &mut String, index: usize, instructions: &[Instruction], results: &[u16]) {
    let program = Program { instructions: instructions.to_vec(), constants: Vec::new(), results: results.to_vec() };
    let varying = program.varying();
    let _ = write!(text, "\nfn field_{index}(first: u32, here: Here) -> Pull {{\n");
    for (number, step) in instructions.iter().enumerate() {
        let _ = writeln!(text, "    let n{number} = {};", value(step, &varying));
    }
    let [x, y, z] = [0, 1, 2].map(|k| results.get(k).map_or_else(|| "level(0.0)".to_owned(), |r| dual(*r, &varying)));
    let _ = write!(text, "    return pull_of({x}, {y}, {z});\n}}\n");
}

/// A step as a plain number.
fn plain(step: u16, varying: &[bool]) -> String {
    format!("n{step}{}", if varying[usize::from(step)] { ".value" } else { "" })
}

/// A step with its derivatives.
fn dual(step: u16, varying: &[bool]) -> String {
    if varying[usize::from(step)] { format!("n{step}") } else { format!("level(n{step})") }
}

fn value(step: &Instruction, varying: &[bool]) -> String {
    let moves = step.args[..step.op.arity()].iter().any(|a| varying[usize::from(*a)]) && !step.op.is_flat();
    if moves {
        return with_derivatives(step, varying);
    }
    let arg = |k: usize| plain(step.args[k], varying);
    let (a, b, c) = match step.op.arity() {
        0 => (String::new(), String::new(), String::new()),
        1 => (arg(0), String::new(), String::new()),
        2 => (arg(0), arg(1), String::new()),
        _ => (arg(0), arg(1), arg(2)),
    };
    match step.op {
        Op::Constant => format!("constants[first + {}u]", step.args[0]),
        Op::Input => input(step.args[0]),
        Op::Add => format!("{a} + {b}"),
        Op::Subtract => format!("{a} - {b}"),
        Op::Multiply => format!("{a} * {b}"),
        Op::Divide => format!("quotient({a}, {b})"),
        Op::Negate => format!("-{a}"),
        Op::Sin => format!("sine({a})"),
        Op::Cos => format!("cosine({a})"),
        Op::Exp => format!("exp({a})"),
        Op::Ln => format!("logarithm({a})"),
        Op::Sqrt => format!("root({a})"),
        Op::Pow => format!("power({a}, {b})"),
        Op::Abs => format!("abs({a})"),
        Op::Min => format!("least({a}, {b})"),
        Op::Max => format!("most({a}, {b})"),
        Op::Floor => format!("floor({a})"),
        Op::Less => format!("truth({a} < {b})"),
        Op::AtMost => format!("truth({a} <= {b})"),
        Op::Equal => format!("truth({a} == {b})"),
        Op::Choose => format!("select({c}, {b}, {a} != 0.0)"),
        Op::Noise => format!("noise_at({a}, {b}, {c})"),
        Op::Random => format!("random_of({a})"),
    }
}

fn with_derivatives(step: &Instruction, varying: &[bool]) -> String {
    let name = match step.op {
        Op::Add => "add",
        Op::Subtract => "subtract",
        Op::Multiply => "multiply",
        Op::Divide => "divide",
        Op::Negate => "negate",
        Op::Sin => "sin",
        Op::Cos => "cos",
        Op::Exp => "exp",
        Op::Ln => "ln",
        Op::Sqrt => "sqrt",
        Op::Pow => "pow",
        Op::Abs => "abs",
        Op::Min => "min",
        Op::Max => "max",
        _ => {
            let [which, a, b] = step.args;
            // What chooses may vary while what it chooses between does not.
            return match varying[usize::from(a)] || varying[usize::from(b)] {
                true => format!("choose_dual({}, {}, {})", plain(which, varying), dual(a, varying), dual(b, varying)),
                false => format!("select({}, {}, {} != 0.0)", plain(b, varying), plain(a, varying), plain(which, varying)),
            };
        }
    };
    let args: Vec<String> = step.args[..step.op.arity()].iter().map(|a| dual(*a, varying)).collect();
    format!("{name}_dual({})", args.join(", "))
}

fn input(which: u16) -> String {
    let axis = ["x", "y", "z"][usize::from(which) % 3];
    let unit = ["vec3<f32>(1.0, 0.0, 0.0)", "vec3<f32>(0.0, 1.0, 0.0)", "vec3<f32>(0.0, 0.0, 1.0)"][usize::from(which) % 3];
    match which {
        0..=2 => format!("Dual(here.x.{axis}, {unit}, vec3<f32>(0.0))"),
        3..=5 => format!("Dual(here.v.{axis}, vec3<f32>(0.0), {unit})"),
        6..=8 => format!("here.x0.{axis}"),
        9 => "here.time_s".to_owned(),
        10 => "here.mass_kg".to_owned(),
        _ => "here.seed".to_owned(),
    }
}

/// Expressions that use every step, with and without derivatives.
pub const SAMPLE: [&str; 2] = [
    "if(x.x < t && !(v.y >= mass) || x.z == 0, 1, 2) * min(max(-x, v), x0) + cross(normalize(x), v) * noise(x * 3) + vec3(random(seed))
     + abs(sin(x)) / (1 + exp(cos(v))) + pow(abs(x) + 1, 1.5) * ln(2 + dot(v, v)) * sqrt(length(x)) + floor(x) * (t - x)",
    "vec3(sin(t) + cos(t) * exp(-t), ln(1 + t) * sqrt(t) + pow(t, 2) - abs(t - 1), min(t, 1) + max(t, 2) + floor(t) * noise(t) / (1 + t))
     * if(t > 1, 2, mass)",
];

/// Their functions.
pub fn sample() -> String {
    let programs: Vec<Program> = SAMPLE.iter().filter_map(|text| Program::of(&parse(text, Kind::Vector).ok()?).ok()).collect();
    functions(&programs.iter().map(|p| (p.instructions.as_slice(), p.results.as_slice())).collect::<Vec<_>>())
}
