//! A program on the CPU, in f64, with derivatives.

use super::dual::Dual;
use super::noise;
use super::program::{Instruction, Op, Program};

/// What a particle brings to an expression.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    /// Metres, world frame.
    pub position_m: [f64; 3],
    /// Metres a second.
    pub velocity_m_s: [f64; 3],
    /// Where it was captured.
    pub rest_m: [f64; 3],
    /// Since the start.
    pub time_s: f64,
    /// Its mass.
    pub mass_kg: f64,
    /// Its own number.
    pub seed: f64,
}

impl Inputs {
    fn get(&self, which: usize) -> Dual {
        match which {
            0..=2 => Dual::variable(self.position_m[which], which),
            3..=5 => Dual::variable(self.velocity_m_s[which - 3], which),
            6..=8 => Dual::constant(self.rest_m[which - 6]),
            9 => Dual::constant(self.time_s),
            10 => Dual::constant(self.mass_kg),
            _ => Dual::constant(self.seed),
        }
    }
}

impl Program {
    /// The results, one for each of [`Program::results`], with their derivatives by place and velocity.
    pub fn evaluate(&self, inputs: &Inputs) -> Vec<Dual> {
        let mut values: Vec<Dual> = Vec::with_capacity(self.instructions.len());
        for step in &self.instructions {
            values.push(self.step(step, &values, inputs));
        }
        self.results.iter().map(|r| values[usize::from(*r)]).collect()
    }

    fn step(&self, step: &Instruction, values: &[Dual], inputs: &Inputs) -> Dual {
        let index = usize::from(step.args[0]);
        let arg = |k: usize| values[usize::from(step.args[k])];
        let truth = |holds: bool| Dual::constant(f64::from(u8::from(holds)));
        match step.op {
            Op::Constant => Dual::constant(self.constants[index]),
            Op::Input => inputs.get(index),
            Op::Noise => Dual::constant(f64::from(noise::noise([0, 1, 2].map(|k| arg(k).value as f32)))),
            Op::Random if arg(0).value.is_nan() => Dual::constant(f64::NAN),
            Op::Random => Dual::constant(f64::from(noise::random(arg(0).value as f32))),
            Op::Floor => Dual::constant(arg(0).value.floor()),
            Op::Less => truth(arg(0).value < arg(1).value),
            Op::AtMost => truth(arg(0).value <= arg(1).value),
            Op::Equal => truth(arg(0).value == arg(1).value),
            Op::Choose => arg(if arg(0).value != 0.0 { 1 } else { 2 }),
            op if op.arity() == 2 => two(op, arg(0), arg(1)),
            op => one(op, arg(0)),
        }
    }
}

fn one(op: Op, a: Dual) -> Dual {
    let x = a.value;
    match op {
        Op::Sin => a.chain(x.sin(), x.cos()),
        Op::Cos => a.chain(x.cos(), -x.sin()),
        Op::Exp => a.chain(x.exp(), x.exp()),
        Op::Ln if x <= 0.0 => a.chain(f64::NAN, 0.0),
        Op::Ln => a.chain(x.ln(), 1.0 / x),
        // The corner of a root at zero counts as level.
        Op::Sqrt if x == 0.0 => a.chain(0.0, 0.0),
        Op::Sqrt => a.chain(x.sqrt(), 0.5 / x.sqrt()),
        Op::Abs => a.chain(x.abs(), if x < 0.0 { -1.0 } else { 1.0 }),
        _ => a.chain(-x, -1.0),
    }
}

fn two(op: Op, a: Dual, b: Dual) -> Dual {
    let (x, y) = (a.value, b.value);
    match op {
        Op::Add => a.chain2(b, x + y, 1.0, 1.0),
        Op::Subtract => a.chain2(b, x - y, 1.0, -1.0),
        Op::Multiply => a.chain2(b, x * y, y, x),
        Op::Divide if y == 0.0 => a.chain2(b, f64::NAN, 0.0, 0.0),
        Op::Divide => a.chain2(b, x / y, 1.0 / y, -x / y / y),
        // What is no number is neither the smaller nor the larger: it stays.
        Op::Min | Op::Max if x.is_nan() || y.is_nan() => a.chain(f64::NAN, 0.0),
        Op::Min if y < x => b,
        Op::Max if x < y => b,
        Op::Min | Op::Max => a,
        _ => power(a, b),
    }
}

/// a^b; of a negative base only where the exponent is whole.
fn power(a: Dual, b: Dual) -> Dual {
    let (x, y) = (a.value, b.value);
    let none = x.is_nan() || y.is_nan() || x < 0.0 && y != y.floor() || x == 0.0 && y < 0.0;
    if none {
        return a.chain2(b, f64::NAN, 0.0, 0.0);
    }
    let value = x.powf(y);
    let by = if y == 0.0 || (x == 0.0 && y < 1.0) { 0.0 } else { y * x.powf(y - 1.0) };
    a.chain2(b, value, by, if x > 0.0 { value * x.ln() } else { 0.0 })
}
