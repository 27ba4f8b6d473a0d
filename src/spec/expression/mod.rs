//! Expressions: a number, a vector or a truth made of where a particle is, how fast, when.
//!
//! Text becomes a small typed [`Tree`], bounded in length, depth and size, and a tree becomes a
//! [`Program`]: straight-line steps on single numbers, which the CPU evaluates and from which a pass is
//! written. Text itself never reaches a shader. There are no loops, no memory and no access to anything.
//!
//! A value that is none (a division by zero, the logarithm or root of a negative number, a negative base
//! under a broken exponent, anything past the range of f32) makes the whole acceleration zero for that
//! particle and substep, and is counted.

mod dual;
mod evaluate;
mod fault;
mod function;
mod lexer;
mod noise;
mod parser;
mod print;
mod program;
mod tree;

pub use dual::Dual;
pub use evaluate::Inputs;
pub use fault::Fault;
pub use function::{Function, functions};
pub use noise::{hash, noise, random};
pub use parser::{Parameter, parse, parse_with};
pub use program::{Instruction, Op, Program};
pub use tree::{Kind, Name, Node, Tree};

#[cfg(test)]
pub(crate) mod tests;

/// Longest text, bytes.
pub const TEXT: usize = 4096;
/// Deepest nesting of brackets, functions and signs.
pub const DEPTH: usize = 48;
/// Most numbers, names and functions of one expression.
pub const NODES: usize = 512;
/// Most steps of one program.
pub const STEPS: usize = 2048;
/// Largest number that may be written.
pub const NUMBER: f64 = 1e30;
