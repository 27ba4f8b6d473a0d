//! The canonical text of a tree: it reads back as the same tree.

use super::function::{Form, Function, POSTFIX, PREFIX, Rule};
use super::tree::{Kind, Node, Tree};
use crate::spec::number;
use std::fmt;

/// Strength of what needs no brackets.
const TIGHT: u8 = 8;

impl fmt::Display for Tree {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write(self, out)
    }
}

fn write(tree: &Tree, out: &mut fmt::Formatter<'_>) -> fmt::Result {
    let function = match tree.node {
        Node::Number(value) | Node::Given(_, value) => return out.write_str(&number(value)),
        Node::Name(name) => return out.write_str(name.word()),
        Node::Call(function) => function,
    };
    let entry = function.entry();
    let args = shown(function, &tree.args);
    match entry.form {
        Form::Infix(strength) => {
            bracketed(args[0], strength + u8::from(strength == 3), out)?;
            write!(out, " {} ", entry.word)?;
            bracketed(args[1], strength + 1, out)
        }
        Form::Prefix => {
            out.write_str(entry.word)?;
            bracketed(args[0], PREFIX, out)
        }
        Form::Postfix => {
            bracketed(args[0], POSTFIX, out)?;
            write!(out, ".{}", entry.word)
        }
        Form::Call => {
            write!(out, "{}(", entry.word)?;
            for (index, arg) in args.iter().enumerate() {
                if index > 0 {
                    out.write_str(", ")?;
                }
                write(arg, out)?;
            }
            out.write_str(")")
        }
    }
}

/// The arguments as they are written: a number that stands beside a vector need not say that it spreads.
fn shown(function: Function, args: &[Tree]) -> Vec<&Tree> {
    let spreads = matches!(function.entry().rule, Rule::Each(_) | Rule::Choice);
    let beside_vector = args.iter().any(|a| a.kind == Kind::Vector && !a.is_spread());
    args.iter().map(|a| if spreads && beside_vector && a.is_spread() { &a.args[0] } else { a }).collect()
}

fn bracketed(tree: &Tree, least: u8, out: &mut fmt::Formatter<'_>) -> fmt::Result {
    let strength = match tree.node {
        Node::Call(function) => match function.entry().form {
            Form::Infix(strength) => strength,
            Form::Prefix => PREFIX,
            Form::Postfix => POSTFIX,
            Form::Call => TIGHT,
        },
        Node::Number(value) | Node::Given(_, value) if value < 0.0 => PREFIX,
        Node::Number(_) | Node::Given(..) | Node::Name(_) => TIGHT,
    };
    if strength >= least {
        return write(tree, out);
    }
    out.write_str("(")?;
    write(tree, out)?;
    out.write_str(")")
}
