//! Text to tokens.

use super::NUMBER;
use super::fault::Fault;

/// A piece of text.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Word(String),
    Sign(&'static str),
    End,
}

/// A token and the character at which it begins, from 1.
pub(super) type Placed = (Token, usize);

/// Longer signs first: `<=` begins with `<`.
const SIGNS: [&str; 18] = ["<=", ">=", "==", "!=", "&&", "||", "<", ">", "+", "-", "*", "/", "!", "(", ")", ",", ".", "="];

/// All tokens, the end last. A text that is too long is refused unread.
pub(super) fn tokens(text: &str, most: usize) -> Result<Vec<Placed>, Fault> {
    if text.len() > most {
        return Err(Fault::whole(format!("an expression of {} bytes", text.len()), format!("one of at most {most}")));
    }
    let chars: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        let c = chars[at];
        let next = chars.get(at + 1).copied().unwrap_or(' ');
        let (token, end) = match c {
            c if c.is_whitespace() => {
                at += 1;
                continue;
            }
            c if c.is_ascii_digit() || (c == '.' && next.is_ascii_digit()) => number(&chars, at)?,
            c if c.is_ascii_alphabetic() || c == '_' => word(&chars, at),
            _ => sign(&chars, at)?,
        };
        tokens.push((token, at + 1));
        at = end;
    }
    tokens.push((Token::End, chars.len() + 1));
    Ok(tokens)
}

fn run(chars: &[char], from: usize, fits: impl Fn(char) -> bool) -> usize {
    chars[from..].iter().position(|c| !fits(*c)).map_or(chars.len(), |length| from + length)
}

fn number(chars: &[char], at: usize) -> Result<(Token, usize), Fault> {
    let digit = |c: char| c.is_ascii_digit();
    let mut end = run(chars, at, digit);
    if chars.get(end) == Some(&'.') {
        end = run(chars, end + 1, digit);
    }
    if matches!(chars.get(end), Some('e' | 'E')) {
        let signed = matches!(chars.get(end + 1), Some('+' | '-'));
        let power = end + 1 + usize::from(signed);
        let after = run(chars, power.min(chars.len()), digit);
        if after > power {
            end = after;
        }
    }
    let text: String = chars[at..end].iter().collect();
    match text.parse::<f64>() {
        Ok(value) if value <= NUMBER => Ok((Token::Number(value), end)),
        _ => Err(Fault::new(at + 1, format!("`{}`", shorten(&text)), format!("a number up to {NUMBER:e}"))),
    }
}

fn word(chars: &[char], at: usize) -> (Token, usize) {
    let end = run(chars, at, |c| c.is_ascii_alphanumeric() || c == '_');
    (Token::Word(chars[at..end].iter().collect()), end)
}

fn sign(chars: &[char], at: usize) -> Result<(Token, usize), Fault> {
    let begins = |sign: &&&str| sign.chars().enumerate().all(|(i, c)| chars.get(at + i) == Some(&c));
    match SIGNS.iter().find(begins) {
        Some(sign) => Ok((Token::Sign(sign), at + sign.len())),
        None if chars[at] == '^' => Err(Fault::new(at + 1, "`^`", "pow(base, exponent)")),
        None => Err(Fault::new(at + 1, format!("`{}`", chars[at].escape_default()), "a number, a name or a sign")),
    }
}

/// At most twenty characters.
pub(super) fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(20).collect();
    if text.chars().count() > 20 {
        short.push('…');
    }
    short
}
