//! The typed tree that an expression is.

use super::function::{Function, Rule};

/// What a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Scalar,
    /// Three numbers.
    Vector,
    /// True or false.
    Truth,
}

impl Kind {
    /// As messages call it.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Scalar => "a number",
            Kind::Vector => "a vector",
            Kind::Truth => "a truth",
        }
    }
}

/// What an expression knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Name {
    /// Where the particle is, metres, world frame.
    Position,
    /// Its velocity, m/s.
    Velocity,
    /// Where it was captured, metres, world frame.
    Rest,
    /// Seconds since the start.
    Time,
    /// Its mass, kg.
    Mass,
    /// A whole number of its own, 0 to 2^24 - 1, drawn from the spec's seed.
    Seed,
    /// 3.14159…
    Pi,
}

impl Name {
    /// All of them.
    pub const ALL: [Name; 7] = [Name::Position, Name::Velocity, Name::Rest, Name::Time, Name::Mass, Name::Seed, Name::Pi];

    /// As it is written.
    pub fn word(self) -> &'static str {
        match self {
            Name::Position => "x",
            Name::Velocity => "v",
            Name::Rest => "x0",
            Name::Time => "t",
            Name::Mass => "mass",
            Name::Seed => "seed",
            Name::Pi => "pi",
        }
    }

    /// What it stands for, for the reference.
    pub fn about(self) -> &'static str {
        match self {
            Name::Position => "where the particle is, metres",
            Name::Velocity => "its velocity, m/s",
            Name::Rest => "where it was captured, metres",
            Name::Time => "seconds since the start",
            Name::Mass => "its mass, kg",
            Name::Seed => "a whole number of its own, for `random`",
            Name::Pi => "3.14159…",
        }
    }

    /// What it is.
    pub fn kind(self) -> Kind {
        match self {
            Name::Position | Name::Velocity | Name::Rest => Kind::Vector,
            Name::Time | Name::Mass | Name::Seed | Name::Pi => Kind::Scalar,
        }
    }
}

/// What stands at a place of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// A number, finite; from text never negative.
    Number(f64),
    /// A number that a text of our own left open, and which of its numbers it is.
    Given(u16, f64),
    /// Something known.
    Name(Name),
    /// A function of the arguments below.
    Call(Function),
}

/// A typed expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// What stands here.
    pub node: Node,
    /// What it gives.
    pub kind: Kind,
    /// Of a function.
    pub args: Vec<Tree>,
}

/// An argument that does not fit, or the number of them where there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Misfit {
    pub argument: Option<usize>,
    pub expected: String,
}

impl Tree {
    /// A number.
    pub fn number(value: f64) -> Tree {
        Tree { node: Node::Number(value), kind: Kind::Scalar, args: Vec::new() }
    }

    /// A number that was left open.
    pub(super) fn given(which: u16, value: f64) -> Tree {
        Tree { node: Node::Given(which, value), kind: Kind::Scalar, args: Vec::new() }
    }

    /// A vector that was left open: three numbers one after another.
    pub(super) fn given_vector(which: u16, value: [f64; 3]) -> Tree {
        let args = (which..).zip(value).map(|(which, value)| Tree::given(which, value)).collect();
        Tree { node: Node::Call(Function::Vec3), kind: Kind::Vector, args }
    }

    /// Something known.
    pub fn name(name: Name) -> Tree {
        Tree { node: Node::Name(name), kind: name.kind(), args: Vec::new() }
    }

    /// A function of arguments; numbers among vectors are spread out to vectors.
    pub(super) fn call(function: Function, mut args: Vec<Tree>) -> Result<Tree, Misfit> {
        let kind = settle(function, &mut args)?;
        Ok(Tree { node: Node::Call(function), kind, args })
    }

    /// Whether this is one number spread out to a vector.
    pub(super) fn is_spread(&self) -> bool {
        self.node == Node::Call(Function::Vec3) && self.args.len() == 1
    }

    /// How many nodes it has.
    pub fn size(&self) -> usize {
        1 + self.args.iter().map(Tree::size).sum::<usize>()
    }
}

fn spread(arg: &mut Tree) {
    let inner = std::mem::replace(arg, Tree { node: Node::Call(Function::Vec3), kind: Kind::Vector, args: Vec::new() });
    arg.args.push(inner);
}

/// Checks the arguments' number and kinds; what the function gives.
fn settle(function: Function, args: &mut [Tree]) -> Result<Kind, Misfit> {
    let entry = function.entry();
    let counted = |wanted: &[usize], args: &[Tree]| {
        let list = wanted.iter().map(usize::to_string).collect::<Vec<_>>().join(" or ");
        let plural = if wanted == [1] { "argument" } else { "arguments" };
        let misfit = || Misfit { argument: None, expected: format!("{list} {plural} of `{}`", entry.word) };
        if wanted.contains(&args.len()) { Ok(()) } else { Err(misfit()) }
    };
    let all = |args: &[Tree], kind: Kind| match args.iter().position(|a| a.kind != kind) {
        Some(argument) => Err(Misfit { argument: Some(argument), expected: kind.word().to_owned() }),
        None => Ok(()),
    };
    let no_truth = |args: &[Tree]| match args.iter().position(|a| a.kind == Kind::Truth) {
        Some(argument) => Err(Misfit { argument: Some(argument), expected: "a number or a vector".to_owned() }),
        None => Ok(()),
    };
    match entry.rule {
        Rule::Each(count) => {
            counted(&[count], args)?;
            no_truth(args)?;
            Ok(alike(args))
        }
        Rule::Compare => counted(&[2], args).and_then(|()| all(args, Kind::Scalar)).map(|()| Kind::Truth),
        Rule::Logic(count) => counted(&[count], args).and_then(|()| all(args, Kind::Truth)).map(|()| Kind::Truth),
        Rule::Choice => {
            counted(&[3], args)?;
            all(&args[..1], Kind::Truth)?;
            no_truth(&args[1..]).map_err(|m| Misfit { argument: m.argument.map(|a| a + 1), ..m })?;
            Ok(alike(&mut args[1..]))
        }
        Rule::Build => counted(&[3, 1], args).and_then(|()| all(args, Kind::Scalar)).map(|()| Kind::Vector),
        Rule::Measure(count) => counted(&[count], args).and_then(|()| all(args, Kind::Vector)).map(|()| Kind::Scalar),
        Rule::Vectors(count) => counted(&[count], args).and_then(|()| all(args, Kind::Vector)).map(|()| Kind::Vector),
        Rule::Noise => counted(&[1], args).and_then(|()| no_truth(args)).map(|()| Kind::Scalar),
        Rule::Number => counted(&[1], args).and_then(|()| all(args, Kind::Scalar)).map(|()| Kind::Scalar),
    }
}

/// Spreads numbers out where there is a vector.
fn alike(args: &mut [Tree]) -> Kind {
    if args.iter().all(|a| a.kind == Kind::Scalar) {
        return Kind::Scalar;
    }
    args.iter_mut().filter(|a| a.kind == Kind::Scalar).for_each(spread);
    Kind::Vector
}
