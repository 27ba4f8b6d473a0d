//! Expressions of forces: read, written, lowered to steps, evaluated.

use crate::target::{Target, class};
use phystalk::spec::expression::{Inputs, Kind, Program, functions, parse};

/// What a force may say.
pub struct Expression;

impl Target for Expression {
    fn name(&self) -> &'static str {
        "expression"
    }

    fn seeds(&self) -> Vec<Vec<u8>> {
        let texts = [
            "vec3(6.0 * sin(3.0 * t), 0, 0)",
            "-9 * (x - x0) - 0.5 * v",
            "if(x.z > 0.5 && t < 1, vec3(0, 0, 3), -v / mass)",
            "normalize(cross(v, vec3(0, 0, 1))) * clamp(length(x), 0, 2) ^ 1.5",
            "noise(x * 3) * vec3(1, 1, 1) + random(seed)",
            "1e30",
            "((((((((((x))))))))))",
        ];
        texts.iter().map(|text| text.as_bytes().to_vec()).collect()
    }

    fn dictionary(&self) -> Vec<&'static [u8]> {
        let words = [
            "x", "v", "x0", "t", "mass", "seed", "pi", ".x", "(", "((((((((", ")", ", ", " + ", " - ", "-", " * ", " / ", "^", " < ", " && ", "!",
            "1e30",
        ];
        functions().map(|(name, _)| name.as_bytes()).chain(words.map(str::as_bytes)).collect()
    }

    fn longest(&self) -> usize {
        // A little more than is read, so that the limit is tried too.
        4200
    }

    fn memory(&self, input_bytes: usize) -> usize {
        (1 << 20) + 1024 * input_bytes
    }

    fn run(&self, input: &[u8]) -> Result<String, String> {
        let text = String::from_utf8_lossy(input);
        let read = [Kind::Vector, Kind::Scalar, Kind::Truth].map(|kind| one(&text, kind));
        let [vector, scalar, truth] = read;
        Ok(format!("{} / {} / {}", vector?, scalar?, truth?))
    }
}

fn one(text: &str, kind: Kind) -> Result<String, String> {
    let tree = match parse(text, kind) {
        Ok(tree) => tree,
        Err(fault) => return Ok(class(&fault.to_string())),
    };
    let written = tree.to_string();
    // The written form may be longer than what is read.
    if written.len() <= phystalk::spec::expression::TEXT {
        let again = parse(&written, kind).map_err(|fault| format!("`{text}` is written as `{written}`, which is refused: {fault}"))?;
        if again.to_string() != written {
            return Err(format!("`{text}` is written as `{written}`, and that as `{again}`"));
        }
    }
    let program = match Program::of(&tree) {
        Ok(program) => program,
        Err(fault) => return Ok(class(&fault.to_string())),
    };
    let inputs =
        Inputs { position_m: [0.1, -2.0, 3.0], velocity_m_s: [0.0, 1e-30, 1e30], time_s: 0.5, mass_kg: 1e-9, seed: 7.0, ..Inputs::default() };
    let values = program.evaluate(&inputs).len() + program.varying().len().min(1) + program.evaluate(&Inputs::default()).len();
    Ok(format!("{values} values"))
}
