//! Tokens to a typed tree, by the strength of operators.

use super::fault::Fault;
use super::function::{ALIASES, Form, Function, PREFIX, TABLE};
use super::lexer::{Placed, Token, shorten, tokens};
use super::tree::{Kind, Name, Tree};
use super::{DEPTH, NODES, Program, TEXT};

/// A value that a text of our own leaves open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    /// A number.
    Scalar(f64),
    /// A vector.
    Vector([f64; 3]),
}

/// Reads an expression that gives a value of some kind. A number where a vector is asked for is refused:
/// it would point nowhere in particular.
pub fn parse(text: &str, kind: Kind) -> Result<Tree, Fault> {
    bounded(text, kind, &[], TEXT, NODES)
}

/// As [`parse`], for a text of our own with further names that stand for values. It may be longer.
pub fn parse_with(text: &str, kind: Kind, parameters: &[(&str, Parameter)]) -> Result<Tree, Fault> {
    bounded(text, kind, parameters, 16 * TEXT, 16 * NODES)
}

fn bounded(text: &str, kind: Kind, parameters: &[(&str, Parameter)], bytes: usize, nodes: usize) -> Result<Tree, Fault> {
    let tokens = tokens(text, bytes)?;
    let mut parser = Parser { tokens: &tokens, next: 0, depth: 0, nodes: 0, most: nodes, parameters };
    let (tree, at) = parser.value(0)?;
    if parser.token().0 != Token::End {
        return Err(parser.unexpected("an operator or the end"));
    }
    if tree.kind != kind {
        let example = if kind == Kind::Vector { ", such as vec3(0, 0, 1)" } else { "" };
        return Err(Fault::new(at, tree.kind.word(), format!("{}{example}", kind.word())));
    }
    Program::of(&tree)?;
    Ok(tree)
}

/// A tree and where it begins.
type Found = (Tree, usize);

struct Parser<'a> {
    tokens: &'a [Placed],
    next: usize,
    depth: usize,
    nodes: usize,
    most: usize,
    parameters: &'a [(&'a str, Parameter)],
}

impl Parser<'_> {
    fn token(&self) -> &Placed {
        // The last token is the end, which nothing steps over.
        &self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    fn step(&mut self) {
        self.next += 1;
    }

    fn is(&self, sign: &str) -> bool {
        matches!(self.token().0, Token::Sign(s) if s == sign)
    }

    fn unexpected(&self, expected: &str) -> Fault {
        let (token, at) = self.token();
        let found = match token {
            Token::End => "the end".to_owned(),
            Token::Number(value) => format!("the number {value}"),
            Token::Word(word) => format!("`{}`", shorten(word)),
            Token::Sign(sign) => format!("`{sign}`"),
        };
        let expected = match token {
            Token::Sign("=") => "`==`, to compare,",
            _ => expected,
        };
        Fault::new(*at, found, expected)
    }

    fn count(&mut self, at: usize, more: usize) -> Result<(), Fault> {
        self.nodes += more;
        if self.nodes > self.most { Err(Fault::new(at, "a longer expression", format!("one of at most {} parts", self.most))) } else { Ok(()) }
    }

    fn call(&mut self, function: Function, args: Vec<Found>, at: usize) -> Result<Tree, Fault> {
        let places: Vec<(usize, Kind)> = args.iter().map(|(tree, at)| (*at, tree.kind)).collect();
        let had = args.len();
        let tree = Tree::call(function, args.into_iter().map(|(tree, _)| tree).collect()).map_err(|misfit| match misfit.argument {
            Some(argument) => Fault::new(places[argument].0, places[argument].1.word(), misfit.expected),
            None => Fault::new(at, format!("{had}"), misfit.expected),
        })?;
        let spread = tree.args.iter().filter(|a| a.is_spread()).count();
        self.count(at, 1 + spread)?;
        Ok(tree)
    }

    /// A value and the operators behind it that bind at least so strongly.
    fn value(&mut self, least: u8) -> Result<Found, Fault> {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(Fault::new(self.token().1, "a deeper nesting", format!("at most {DEPTH} levels")));
        }
        let (mut tree, start) = self.signed()?;
        while let Some((function, strength)) = self.infix().filter(|(_, strength)| *strength >= least) {
            let at = self.token().1;
            self.step();
            let right = self.value(strength + 1)?;
            tree = self.call(function, vec![(tree, start), right], at)?;
            let compares = |f: Function| matches!(f.entry().form, Form::Infix(3));
            if compares(function) && self.infix().is_some_and(|(next, _)| compares(next)) {
                return Err(self.unexpected("`&&`: comparisons do not chain, so an operator between them"));
            }
        }
        self.depth -= 1;
        Ok((tree, start))
    }

    /// The operator here.
    fn infix(&self) -> Option<(Function, u8)> {
        let Token::Sign(sign) = self.token().0 else { return None };
        TABLE.iter().find_map(|e| match e.form {
            Form::Infix(strength) if e.word == sign => Some((e.function, strength)),
            _ => None,
        })
    }

    /// Signs, then a value with its components.
    fn signed(&mut self) -> Result<Found, Fault> {
        let at = self.token().1;
        let sign = match self.token().0 {
            Token::Sign(sign) => TABLE.iter().find(|e| e.form == Form::Prefix && e.word == sign),
            _ => None,
        };
        if let Some(entry) = sign {
            self.step();
            let inner = self.value(PREFIX)?;
            return Ok((self.call(entry.function, vec![inner], at)?, at));
        }
        if self.is("+") {
            self.step();
            return self.value(PREFIX);
        }
        let (mut tree, start) = self.primary()?;
        while self.is(".") {
            let at = self.token().1;
            self.step();
            let component = match &self.token().0 {
                Token::Word(word) => TABLE.iter().find(|e| e.form == Form::Postfix && e.word == word),
                _ => None,
            };
            let entry = component.ok_or_else(|| self.unexpected("x, y or z"))?;
            self.step();
            tree = self.call(entry.function, vec![(tree, start)], at)?;
        }
        Ok((tree, start))
    }

    fn primary(&mut self) -> Result<Found, Fault> {
        let (token, at) = self.token().clone();
        match token {
            Token::Number(value) => {
                self.step();
                self.count(at, 1)?;
                Ok((Tree::number(value), at))
            }
            Token::Word(word) => self.word(&word, at),
            Token::Sign("(") => {
                self.step();
                let (tree, _) = self.value(0)?;
                self.close()?;
                Ok((tree, at))
            }
            _ => Err(self.unexpected("a number, a name or a function")),
        }
    }

    fn word(&mut self, word: &str, at: usize) -> Result<Found, Fault> {
        let settled = ALIASES.iter().find(|(alias, _)| *alias == word).map_or(word, |(_, word)| word);
        if let Some(entry) = TABLE.iter().find(|e| e.form == Form::Call && e.word == settled) {
            self.step();
            if !self.is("(") {
                return Err(self.unexpected(&format!("`(` after `{word}`")));
            }
            let args = self.arguments()?;
            return Ok((self.call(entry.function, args, at)?, at));
        }
        let tree = match Name::ALL.into_iter().find(|name| name.word() == word) {
            Some(name) => Tree::name(name),
            None => match self.given(word) {
                Some(value) => value,
                None => return Err(unknown(word, at)),
            },
        };
        self.step();
        self.count(at, tree.size())?;
        Ok((tree, at))
    }

    fn given(&self, word: &str) -> Option<Tree> {
        let mut which = 0;
        for (name, parameter) in self.parameters {
            match parameter {
                Parameter::Scalar(value) if *name == word => return Some(Tree::given(which, *value)),
                Parameter::Vector(value) if *name == word => return Some(Tree::given_vector(which, *value)),
                Parameter::Scalar(_) => which += 1,
                Parameter::Vector(_) => which += 3,
            }
        }
        None
    }

    /// `(a, b, …)`
    fn arguments(&mut self) -> Result<Vec<Found>, Fault> {
        self.step();
        let mut args = Vec::new();
        if self.is(")") {
            self.step();
            return Ok(args);
        }
        loop {
            args.push(self.value(0)?);
            if !self.is(",") {
                break;
            }
            self.step();
        }
        self.close()?;
        Ok(args)
    }

    fn close(&mut self) -> Result<(), Fault> {
        if !self.is(")") {
            return Err(self.unexpected("`)`, `,` or an operator"));
        }
        self.step();
        Ok(())
    }
}

fn unknown(word: &str, at: usize) -> Fault {
    let names = Name::ALL.iter().map(|name| name.word());
    let functions = TABLE.iter().filter(|e| e.form == Form::Call).map(|e| e.word);
    let list = names.clone().collect::<Vec<_>>().join(", ");
    let mut fault = Fault::new(at, format!("`{}`", shorten(word)), format!("one of {list}, or a function"));
    fault.nearest = crate::spec::nearest(word, names.chain(functions)).map(str::to_owned);
    fault
}
