//! A tree as straight-line steps on single numbers: what both the CPU and the device run.

use super::fault::Fault;
use super::function::Function;
use super::tree::{Kind, Name, Node, Tree};
use super::{STEPS, function};
use std::collections::HashMap;

/// What one step does with the numbers of earlier ones. Truths are 1 and 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the operation that it is called")]
pub enum Op {
    /// The number in a slot of the constants, which is the first argument.
    Constant,
    /// What the particle brings: 0 to 2 position, 3 to 5 velocity, 6 to 8 rest position, 9 time, 10 mass, 11 seed.
    Input,
    Add,
    Subtract,
    Multiply,
    Divide,
    Negate,
    Sin,
    Cos,
    Exp,
    Ln,
    Sqrt,
    Pow,
    Abs,
    Min,
    Max,
    Floor,
    /// 1 where the first is below the second.
    Less,
    /// 1 where the first is not above the second.
    AtMost,
    /// 1 where both are equal.
    Equal,
    /// The second where the first is not 0, else the third.
    Choose,
    Noise,
    Random,
}

impl Op {
    /// How many earlier numbers it takes.
    pub fn arity(self) -> usize {
        match self {
            Op::Constant | Op::Input => 0,
            Op::Negate | Op::Sin | Op::Cos | Op::Exp | Op::Ln | Op::Sqrt | Op::Abs | Op::Floor | Op::Random => 1,
            Op::Add | Op::Subtract | Op::Multiply | Op::Divide | Op::Pow | Op::Min | Op::Max | Op::Less | Op::AtMost | Op::Equal => 2,
            Op::Choose | Op::Noise => 3,
        }
    }

    /// Whether a small change of its arguments is no change of it. Noise counts as standing still.
    pub fn is_flat(self) -> bool {
        matches!(self, Op::Floor | Op::Less | Op::AtMost | Op::Equal | Op::Noise | Op::Random | Op::Constant)
    }
}

/// One step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Instruction {
    /// What it does.
    pub op: Op,
    /// Indices of earlier steps; of a constant its slot, of an input which.
    pub args: [u16; 3],
}

/// Steps, each of which may use those before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// In the order they run. Two expressions that differ in numbers alone have the same.
    pub instructions: Vec<Instruction>,
    /// The numbers, by slot.
    pub constants: Vec<f64>,
    /// The steps that give the result: one, or three of a vector.
    pub results: Vec<u16>,
}

impl Program {
    /// The steps of a tree.
    pub fn of(tree: &Tree) -> Result<Program, Fault> {
        let mut writer = Writer {
            program: Program { instructions: Vec::new(), constants: Vec::new(), results: Vec::new() },
            known: HashMap::new(),
            given: HashMap::new(),
        };
        let results = writer.lower(tree)?;
        writer.program.results = results;
        Ok(writer.program)
    }

    /// Which steps change with the particle's place or velocity.
    pub fn varying(&self) -> Vec<bool> {
        let mut varies = Vec::with_capacity(self.instructions.len());
        for step in &self.instructions {
            let one = match step.op {
                Op::Input => step.args[0] < 6,
                op if op.is_flat() => false,
                // What is chosen by varies, what chooses does not.
                Op::Choose => step.args[1..].iter().any(|a| varies[usize::from(*a)]),
                op => step.args[..op.arity()].iter().any(|a| varies[usize::from(*a)]),
            };
            varies.push(one);
        }
        varies
    }
}

/// One step for a scalar, three for a vector.
type Value = Vec<u16>;

struct Writer {
    program: Program,
    known: HashMap<Instruction, u16>,
    /// Slots of numbers that a text left open.
    given: HashMap<u16, u16>,
}

impl Writer {
    fn emit(&mut self, op: Op, args: &[u16]) -> Result<u16, Fault> {
        let mut padded = [0; 3];
        padded[..args.len()].copy_from_slice(args);
        let instruction = Instruction { op, args: padded };
        if let Some(index) = self.known.get(&instruction) {
            return Ok(*index);
        }
        let index = self.program.instructions.len();
        if index >= STEPS {
            return Err(Fault::whole("an expression of too many steps", format!("at most {STEPS}: a shorter one")));
        }
        self.program.instructions.push(instruction);
        self.known.insert(instruction, index as u16);
        Ok(index as u16)
    }

    fn constant(&mut self, value: f64) -> Result<u16, Fault> {
        let slot = self.program.constants.len() as u16;
        self.program.constants.push(value);
        self.emit(Op::Constant, &[slot])
    }

    /// A number that was left open has one slot, however often it occurs.
    fn given(&mut self, which: u16, value: f64) -> Result<u16, Fault> {
        if let Some(slot) = self.given.get(&which).copied() {
            return self.emit(Op::Constant, &[slot]);
        }
        self.given.insert(which, self.program.constants.len() as u16);
        self.constant(value)
    }

    fn lower(&mut self, tree: &Tree) -> Result<Value, Fault> {
        match tree.node {
            Node::Number(value) => Ok(vec![self.constant(value)?]),
            Node::Given(which, value) => Ok(vec![self.given(which, value)?]),
            Node::Name(name) => self.name(name),
            Node::Call(function) => {
                let args = tree.args.iter().map(|a| self.lower(a)).collect::<Result<Vec<Value>, Fault>>()?;
                self.function(function, &args, tree.kind)
            }
        }
    }

    fn name(&mut self, name: Name) -> Result<Value, Fault> {
        let inputs = match name {
            Name::Position => 0..3,
            Name::Velocity => 3..6,
            Name::Rest => 6..9,
            Name::Time => 9..10,
            Name::Mass => 10..11,
            Name::Seed => 11..12,
            Name::Pi => return Ok(vec![self.constant(std::f64::consts::PI)?]),
        };
        inputs.map(|input| self.emit(Op::Input, &[input])).collect()
    }

    fn function(&mut self, function: Function, args: &[Value], kind: Kind) -> Result<Value, Fault> {
        match function {
            Function::X => Ok(vec![args[0][0]]),
            Function::Y => Ok(vec![args[0][1]]),
            Function::Z => Ok(vec![args[0][2]]),
            Function::Vec3 if args.len() == 1 => Ok(vec![args[0][0]; 3]),
            Function::Vec3 => Ok(args.concat()),
            Function::Length => Ok(vec![self.length(&args[0])?]),
            Function::Dot => Ok(vec![self.dot(&args[0], &args[1])?]),
            Function::Normalize => self.normalize(&args[0]),
            Function::Cross => self.cross(&args[0], &args[1]),
            Function::Noise => self.noise(&args[0]),
            _ => {
                // Truths and numbers are one wide; what chooses is one wide beside vectors.
                let width = if kind == Kind::Vector { 3 } else { 1 };
                let component = |value: &Value, k: usize| if value.len() == 1 { value[0] } else { value[k] };
                (0..width).map(|k| self.single(function, &args.iter().map(|a| component(a, k)).collect::<Vec<u16>>())).collect()
            }
        }
    }

    /// A function of single numbers.
    fn single(&mut self, function: Function, a: &[u16]) -> Result<u16, Fault> {
        match function {
            Function::And => self.emit(Op::Multiply, a),
            Function::Or => self.emit(Op::Max, a),
            Function::Not => self.complement(a[0]),
            Function::Less => self.emit(Op::Less, a),
            Function::AtMost => self.emit(Op::AtMost, a),
            Function::Greater => self.emit(Op::Less, &[a[1], a[0]]),
            Function::AtLeast => self.emit(Op::AtMost, &[a[1], a[0]]),
            Function::Equal => self.emit(Op::Equal, a),
            Function::Unequal => {
                let equal = self.emit(Op::Equal, a)?;
                self.complement(equal)
            }
            Function::Add => self.emit(Op::Add, a),
            Function::Subtract => self.emit(Op::Subtract, a),
            Function::Multiply => self.emit(Op::Multiply, a),
            Function::Divide => self.emit(Op::Divide, a),
            Function::Negate => self.emit(Op::Negate, a),
            Function::If => self.emit(Op::Choose, a),
            Function::Sin => self.emit(Op::Sin, a),
            Function::Cos => self.emit(Op::Cos, a),
            Function::Tan => {
                let (sine, cosine) = (self.emit(Op::Sin, a)?, self.emit(Op::Cos, a)?);
                self.emit(Op::Divide, &[sine, cosine])
            }
            Function::Exp => self.emit(Op::Exp, a),
            Function::Ln => self.emit(Op::Ln, a),
            Function::Sqrt => self.emit(Op::Sqrt, a),
            Function::Pow => self.emit(Op::Pow, a),
            Function::Abs => self.emit(Op::Abs, a),
            Function::Min => self.emit(Op::Min, a),
            Function::Max => self.emit(Op::Max, a),
            Function::Clamp => self.clamp(a[0], a[1], a[2]),
            Function::Mix => {
                let span = self.emit(Op::Subtract, &[a[1], a[0]])?;
                let part = self.emit(Op::Multiply, &[span, a[2]])?;
                self.emit(Op::Add, &[a[0], part])
            }
            Function::Step => self.emit(Op::AtMost, a),
            Function::Smoothstep => self.smoothstep(a[0], a[1], a[2]),
            Function::Floor => self.emit(Op::Floor, a),
            Function::Fract => {
                let whole = self.emit(Op::Floor, a)?;
                self.emit(Op::Subtract, &[a[0], whole])
            }
            Function::Random => self.emit(Op::Random, a),
            _ => Err(Fault::whole(format!("`{}`", function::Function::entry(function).word), "a function of single numbers")),
        }
    }

    fn complement(&mut self, truth: u16) -> Result<u16, Fault> {
        let one = self.constant(1.0)?;
        self.emit(Op::Subtract, &[one, truth])
    }

    fn clamp(&mut self, a: u16, low: u16, high: u16) -> Result<u16, Fault> {
        let raised = self.emit(Op::Max, &[a, low])?;
        self.emit(Op::Min, &[raised, high])
    }

    /// s^2 (3 - 2 s) with s the clamped share of the way.
    fn smoothstep(&mut self, low: u16, high: u16, a: u16) -> Result<u16, Fault> {
        let (zero, one, two, three) = (self.constant(0.0)?, self.constant(1.0)?, self.constant(2.0)?, self.constant(3.0)?);
        let (way, span) = (self.emit(Op::Subtract, &[a, low])?, self.emit(Op::Subtract, &[high, low])?);
        let share = self.emit(Op::Divide, &[way, span])?;
        let s = self.clamp(share, zero, one)?;
        let square = self.emit(Op::Multiply, &[s, s])?;
        let double = self.emit(Op::Multiply, &[two, s])?;
        let rest = self.emit(Op::Subtract, &[three, double])?;
        self.emit(Op::Multiply, &[square, rest])
    }

    fn dot(&mut self, a: &[u16], b: &[u16]) -> Result<u16, Fault> {
        let mut sum = self.emit(Op::Multiply, &[a[0], b[0]])?;
        for k in 1..3 {
            let product = self.emit(Op::Multiply, &[a[k], b[k]])?;
            sum = self.emit(Op::Add, &[sum, product])?;
        }
        Ok(sum)
    }

    fn length(&mut self, a: &[u16]) -> Result<u16, Fault> {
        let square = self.dot(a, a)?;
        self.emit(Op::Sqrt, &[square])
    }

    /// a / length(a), and a itself, which is zero, where the length is.
    fn normalize(&mut self, a: &[u16]) -> Result<Value, Fault> {
        let (zero, one) = (self.constant(0.0)?, self.constant(1.0)?);
        let length = self.length(a)?;
        let vanishes = self.emit(Op::Equal, &[length, zero])?;
        let divisor = self.emit(Op::Choose, &[vanishes, one, length])?;
        a.iter().map(|c| self.emit(Op::Divide, &[*c, divisor])).collect()
    }

    fn cross(&mut self, a: &[u16], b: &[u16]) -> Result<Value, Fault> {
        (0..3)
            .map(|k| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let (plus, minus) = (self.emit(Op::Multiply, &[a[i], b[j]])?, self.emit(Op::Multiply, &[a[j], b[i]])?);
                self.emit(Op::Subtract, &[plus, minus])
            })
            .collect()
    }

    /// Of a number: along the first axis of a place that is a half on the others, so that it is not 0 at
    /// every whole number's plane.
    fn noise(&mut self, a: &[u16]) -> Result<Value, Fault> {
        let place = match a {
            [single] => {
                let half = self.constant(0.5)?;
                [*single, half, half]
            }
            more => [more[0], more[1], more[2]],
        };
        Ok(vec![self.emit(Op::Noise, &place)?])
    }
}
