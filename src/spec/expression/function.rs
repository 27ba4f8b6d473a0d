//! What an expression may do with its values, in one table.

/// An operator or a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is named as the table below describes it")]
pub enum Function {
    Or,
    And,
    Less,
    AtMost,
    Greater,
    AtLeast,
    Equal,
    Unequal,
    Add,
    Subtract,
    Multiply,
    Divide,
    Negate,
    Not,
    X,
    Y,
    Z,
    Vec3,
    If,
    Sin,
    Cos,
    Tan,
    Exp,
    Ln,
    Sqrt,
    Pow,
    Abs,
    Min,
    Max,
    Clamp,
    Mix,
    Step,
    Smoothstep,
    Floor,
    Fract,
    Length,
    Normalize,
    Dot,
    Cross,
    Noise,
    Random,
}

/// What a function takes and gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// So many numbers or vectors, component by component; numbers spread out beside vectors.
    Each(usize),
    /// Two numbers to a truth.
    Compare,
    /// So many truths to a truth.
    Logic(usize),
    /// `if(truth, this, otherwise)`
    Choice,
    /// Three numbers to a vector, or one for all three.
    Build,
    /// So many vectors to a number.
    Measure(usize),
    /// So many vectors to a vector.
    Vectors(usize),
    /// A number or a vector to a number.
    Noise,
    /// A number to a number.
    Number,
}

/// How it is written: an operator binds by its strength, the looser the smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Infix(u8),
    Prefix,
    Postfix,
    Call,
}

/// Strength of signs before a value, between those of operators and of components.
pub(super) const PREFIX: u8 = 6;
/// Strength of a component of a value.
pub(super) const POSTFIX: u8 = 7;

pub(super) struct Entry {
    pub function: Function,
    pub word: &'static str,
    pub form: Form,
    pub rule: Rule,
    about: &'static str,
}

const fn entry(function: Function, word: &'static str, form: Form, rule: Rule, about: &'static str) -> Entry {
    Entry { function, word, form, rule, about }
}

/// All of them.
pub(super) const TABLE: &[Entry] = &[
    entry(Function::Or, "||", Form::Infix(1), Rule::Logic(2), "either"),
    entry(Function::And, "&&", Form::Infix(2), Rule::Logic(2), "both"),
    entry(Function::Less, "<", Form::Infix(3), Rule::Compare, "below"),
    entry(Function::AtMost, "<=", Form::Infix(3), Rule::Compare, "at most"),
    entry(Function::Greater, ">", Form::Infix(3), Rule::Compare, "above"),
    entry(Function::AtLeast, ">=", Form::Infix(3), Rule::Compare, "at least"),
    entry(Function::Equal, "==", Form::Infix(3), Rule::Compare, "equal"),
    entry(Function::Unequal, "!=", Form::Infix(3), Rule::Compare, "not equal"),
    entry(Function::Add, "+", Form::Infix(4), Rule::Each(2), "sum"),
    entry(Function::Subtract, "-", Form::Infix(4), Rule::Each(2), "difference"),
    entry(Function::Multiply, "*", Form::Infix(5), Rule::Each(2), "product"),
    entry(Function::Divide, "/", Form::Infix(5), Rule::Each(2), "quotient"),
    entry(Function::Negate, "-", Form::Prefix, Rule::Each(1), "negative"),
    entry(Function::Not, "!", Form::Prefix, Rule::Logic(1), "not"),
    entry(Function::X, "x", Form::Postfix, Rule::Measure(1), "first component"),
    entry(Function::Y, "y", Form::Postfix, Rule::Measure(1), "second component"),
    entry(Function::Z, "z", Form::Postfix, Rule::Measure(1), "third component"),
    entry(Function::Vec3, "vec3", Form::Call, Rule::Build, "vec3(a, b, c); vec3(a) has a three times"),
    entry(Function::If, "if", Form::Call, Rule::Choice, "if(truth, this, otherwise)"),
    entry(Function::Sin, "sin", Form::Call, Rule::Each(1), "sine, of radians"),
    entry(Function::Cos, "cos", Form::Call, Rule::Each(1), "cosine, of radians"),
    entry(Function::Tan, "tan", Form::Call, Rule::Each(1), "tangent, of radians"),
    entry(Function::Exp, "exp", Form::Call, Rule::Each(1), "e to the power"),
    entry(Function::Ln, "ln", Form::Call, Rule::Each(1), "natural logarithm"),
    entry(Function::Sqrt, "sqrt", Form::Call, Rule::Each(1), "square root"),
    entry(Function::Pow, "pow", Form::Call, Rule::Each(2), "pow(base, exponent); whole exponents take negative bases"),
    entry(Function::Abs, "abs", Form::Call, Rule::Each(1), "magnitude"),
    entry(Function::Min, "min", Form::Call, Rule::Each(2), "the smaller"),
    entry(Function::Max, "max", Form::Call, Rule::Each(2), "the larger"),
    entry(Function::Clamp, "clamp", Form::Call, Rule::Each(3), "clamp(a, low, high)"),
    entry(Function::Mix, "mix", Form::Call, Rule::Each(3), "mix(a, b, share): a at 0, b at 1"),
    entry(Function::Step, "step", Form::Call, Rule::Each(2), "step(edge, a): 0 below the edge, 1 from it on"),
    entry(Function::Smoothstep, "smoothstep", Form::Call, Rule::Each(3), "smoothstep(low, high, a): 0 to 1 without corners"),
    entry(Function::Floor, "floor", Form::Call, Rule::Each(1), "the whole number below"),
    entry(Function::Fract, "fract", Form::Call, Rule::Each(1), "a - floor(a)"),
    entry(Function::Length, "length", Form::Call, Rule::Measure(1), "length of a vector"),
    entry(Function::Normalize, "normalize", Form::Call, Rule::Vectors(1), "a vector at length 1; a zero vector stays zero"),
    entry(Function::Dot, "dot", Form::Call, Rule::Measure(2), "scalar product"),
    entry(Function::Cross, "cross", Form::Call, Rule::Vectors(2), "vector product"),
    entry(Function::Noise, "noise", Form::Call, Rule::Noise, "smooth noise of a number or a place, -1 to 1, features of size 1"),
    entry(Function::Random, "random", Form::Call, Rule::Number, "a number from 0 to 1 that looks random, the same for the same argument"),
];

/// Words that are read and never written.
pub(super) const ALIASES: &[(&str, &str)] = &[("select", "if"), ("log", "ln"), ("lerp", "mix"), ("rand", "random"), ("norm", "length")];

impl Function {
    pub(super) fn entry(self) -> &'static Entry {
        // The table is in the order of the variants; a test holds this.
        &TABLE[self as usize]
    }
}

/// Every function that is called by name, with what it does, for the reference.
pub fn functions() -> impl Iterator<Item = (&'static str, &'static str)> {
    TABLE.iter().filter(|e| e.form == Form::Call).map(|e| (e.word, e.about))
}
