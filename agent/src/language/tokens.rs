//! Text to tokens: words, numbers and signs, each remembering how it was written.

/// One word, number or sign of a request.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    /// As written, for reports.
    pub text: String,
    /// Lower case, without apostrophes and possessive endings: what the lexicon knows.
    pub word: String,
    /// Its value, where it is a number in digits.
    pub number: Option<f64>,
}

impl Token {
    fn new(text: &str, word: &str) -> Token {
        Token { text: text.to_owned(), word: word.to_owned(), number: None }
    }
}

/// Splits a request. Signs that only quote or bracket are dropped; anything else becomes a token.
pub fn tokenise(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        let rest = &chars[at..];
        let glued = at > 0 && chars[at - 1].is_alphanumeric();
        let (token, length) = read_one(rest, glued, tokens.last());
        tokens.extend(token);
        at += length;
    }
    tokens
}

/// Reads one token at the start of `rest`, which is never empty; `glued` says that it touches a letter or a digit before it.
fn read_one(rest: &[char], glued: bool, previous: Option<&Token>) -> (Option<Token>, usize) {
    let first = rest[0];
    let next = rest.get(1).copied().unwrap_or(' ');
    if first.is_whitespace() {
        return (None, 1);
    }
    if let Some(value) = vulgar_fraction(first) {
        return (Some(Token { number: Some(value), ..Token::new(&first.to_string(), &first.to_string()) }), 1);
    }
    let signed = matches!(first, '-' | '+' | '−') && !glued;
    let numeric = first.is_ascii_digit() || (first == '.' && next.is_ascii_digit()) || (signed && (next.is_ascii_digit() || next == '.'));
    if numeric && let Some((token, length)) = read_number(rest) {
        return (Some(token), length);
    }
    if signed && matches!(next.to_ascii_lowercase(), 'x' | 'y' | 'z') && !rest.get(2).is_some_and(|c| c.is_alphanumeric()) {
        let word = if first == '+' { format!("+{}", next.to_ascii_lowercase()) } else { format!("-{}", next.to_ascii_lowercase()) };
        return (Some(Token::new(&rest[..2].iter().collect::<String>(), &word)), 2);
    }
    if first.is_alphabetic() {
        return read_word(rest);
    }
    let sign = match first {
        '"' | '\'' | '(' | ')' | '[' | ']' | '“' | '”' | '‘' | '’' | ':' | '*' | '_' | '`' | '=' | '…' | '·' => return (None, 1),
        '°' | 'º' => "deg",
        '&' | '+' => "and",
        '×' => "x",
        '-' | '−' | '–' | '—' if glued && next.is_ascii_digit() && previous.is_some_and(|t| t.number.is_some()) => "to",
        '-' | '−' | '–' if glued => return (None, 1),
        '-' | '−' | '–' | '—' => ",",
        '.' | '!' | '?' | ';' => ";",
        _ => return (Some(Token::new(&first.to_string(), &first.to_string())), 1),
    };
    (Some(Token::new(&first.to_string(), sign)), 1)
}

/// Digits with an optional sign, decimal point or comma, thousands' commas and exponent.
fn read_number(rest: &[char]) -> Option<(Token, usize)> {
    let digit = |at: usize| rest.get(at).is_some_and(char::is_ascii_digit);
    let mut clean = String::new();
    let mut at = 0;
    if matches!(rest[0], '-' | '+' | '−') {
        clean.push(if rest[0] == '+' { '+' } else { '-' });
        at = 1;
    }
    let mut point = false;
    loop {
        match rest.get(at) {
            Some(c) if c.is_ascii_digit() => clean.push(*c),
            Some('.') if digit(at + 1) && !point => {
                point = true;
                clean.push('.');
            }
            // "1,000" is a thousand, "1,5" is one and a half.
            Some(',') if digit(at + 1) && !point => {
                if !(digit(at + 2) && digit(at + 3) && !digit(at + 4)) {
                    point = true;
                    clean.push('.');
                }
            }
            _ => break,
        }
        at += 1;
    }
    if matches!(rest.get(at), Some('e' | 'E')) {
        let sign = usize::from(matches!(rest.get(at + 1), Some('-' | '+')));
        if digit(at + 1 + sign) {
            let end = (at + 1 + sign..).find(|&i| !digit(i)).unwrap_or(rest.len());
            clean.extend(&rest[at..end]);
            at = end;
        }
    }
    let value: f64 = clean.parse().ok().filter(|v: &f64| v.is_finite())?;
    let text: String = rest[..at].iter().collect();
    Some((Token { number: Some(value), word: clean, text }, at))
}

/// Letters with digits, apostrophes and exponents: `m`, `s2`, `don't`, `m³`, `v2`.
fn read_word(rest: &[char]) -> (Option<Token>, usize) {
    let mut word = String::new();
    let mut at = 0;
    while let Some(&c) = rest.get(at) {
        let letter_next = rest.get(at + 1).is_some_and(|n| n.is_alphanumeric());
        match c {
            '²' => word.push('2'),
            '³' => word.push('3'),
            '^' | '\'' | '’' if letter_next => {
                if c != '^' {
                    word.push('\'');
                }
            }
            c if c.is_alphanumeric() && vulgar_fraction(c).is_none() => word.extend(c.to_lowercase()),
            _ => break,
        }
        at += 1;
    }
    let text: String = rest[..at].iter().collect();
    let stem = match word.strip_suffix("'s") {
        Some(stem) if !matches!(stem, "let" | "it" | "that" | "what") => stem.to_owned(),
        _ => word.replace('\'', ""),
    };
    (Some(Token::new(&text, &stem)), at)
}

fn vulgar_fraction(c: char) -> Option<f64> {
    Some(match c {
        '½' => 0.5,
        '¼' => 0.25,
        '¾' => 0.75,
        '⅓' => 1.0 / 3.0,
        '⅔' => 2.0 / 3.0,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        tokenise(text).into_iter().map(|t| t.word).collect()
    }

    #[test]
    fn words_numbers_and_units() {
        assert_eq!(words("Push it 30cm at 2.5 m/s²!"), ["push", "it", "30", "cm", "at", "2.5", "m", "/", "s2", ";"]);
        assert_eq!(words("the vase's 3 g's, don't"), ["the", "vase", "3", "g", ",", "dont"]);
        assert_eq!(words("along -x by 20 %"), ["along", "-x", "by", "20", "%"]);
        assert_eq!(words("upside-down cloth-like"), ["upside", "down", "cloth", "like"]);
        assert_eq!(words("kg/m^3 v2 0.2-1 s"), ["kg", "/", "m3", "v2", "0.2", "to", "1", "s"]);
    }

    #[test]
    fn numbers_in_digits() {
        let value = |text: &str| tokenise(text)[0].number;
        assert_eq!(value("1,5"), Some(1.5));
        assert_eq!(value("1,000"), Some(1000.0));
        assert_eq!(value("3e4"), Some(3e4));
        assert_eq!(value("-2"), Some(-2.0));
        assert_eq!(value("½"), Some(0.5));
        assert_eq!(value(".5"), Some(0.5));
        assert_eq!(value("1e999"), None);
    }
}
