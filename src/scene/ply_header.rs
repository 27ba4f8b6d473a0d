//! The text at the front of a .ply: which elements follow, of which properties.

use super::SceneError;
use super::error::{CONVERT, COPY_AGAIN};

/// A header ends within this many bytes, or the file is something else.
const LONGEST_HEADER: usize = 1 << 18;

/// What a .ply holds.
#[derive(Debug, PartialEq)]
pub struct Header {
    /// In the order of the file.
    pub elements: Vec<Element>,
    /// Text of the lines that start with `comment` or `obj_info`.
    pub comments: Vec<String>,
    /// Bytes before the first element.
    pub bytes: usize,
}

/// A table of rows of fixed length.
#[derive(Debug, PartialEq)]
pub struct Element {
    /// Such as `vertex`.
    pub name: String,
    /// Rows.
    pub count: u64,
    /// Columns.
    pub properties: Vec<(String, Column)>,
    /// Bytes of a row.
    pub stride: usize,
    /// Has a list property, so that rows differ in length.
    pub lists: bool,
}

/// Where a row holds a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    offset: usize,
    scalar: Scalar,
}

/// The number types of the format.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn parse(word: &str) -> Option<Scalar> {
        Some(match word {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }
}

impl Column {
    /// The number in a row of the element, little endian.
    pub fn read(self, row: &[u8]) -> f32 {
        let o = self.offset;
        match self.scalar {
            Scalar::F32 => f32::from_le_bytes([row[o], row[o + 1], row[o + 2], row[o + 3]]),
            Scalar::F64 => {
                let eight = [row[o], row[o + 1], row[o + 2], row[o + 3], row[o + 4], row[o + 5], row[o + 6], row[o + 7]];
                f64::from_le_bytes(eight) as f32
            }
            Scalar::I32 => i32::from_le_bytes([row[o], row[o + 1], row[o + 2], row[o + 3]]) as f32,
            Scalar::U32 => u32::from_le_bytes([row[o], row[o + 1], row[o + 2], row[o + 3]]) as f32,
            Scalar::I16 => f32::from(i16::from_le_bytes([row[o], row[o + 1]])),
            Scalar::U16 => f32::from(u16::from_le_bytes([row[o], row[o + 1]])),
            Scalar::I8 => f32::from(row[o] as i8),
            Scalar::U8 => f32::from(row[o]),
        }
    }
}

impl Element {
    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<Column> {
        self.properties.iter().find(|(n, _)| n == name).map(|&(_, column)| column)
    }
}

/// Reads a header; refuses the text and the big-endian kinds of the format.
pub fn parse(bytes: &[u8], name: &str) -> Result<Header, SceneError> {
    let front = &bytes[..bytes.len().min(LONGEST_HEADER)];
    let mut header = Header { elements: Vec::new(), comments: Vec::new(), bytes: 0 };
    let mut at = 0;
    let mut number = 0;
    while let Some(length) = front[at..].iter().position(|&b| b == b'\n') {
        let line = String::from_utf8_lossy(&front[at..at + length]);
        let line = line.trim();
        at += length + 1;
        number += 1;
        if line == "end_header" {
            header.bytes = at;
            return Ok(header);
        }
        take_line(&mut header, line, name, number)?;
    }
    Err(SceneError::Damaged {
        file: name.to_owned(),
        at: format!("byte {}", front.len()),
        found: "the header still open".to_owned(),
        expected: "a line `end_header`".to_owned(),
        advice: COPY_AGAIN,
    })
}

fn take_line(header: &mut Header, line: &str, name: &str, number: usize) -> Result<(), SceneError> {
    let damaged = |expected: &str| SceneError::Damaged {
        file: name.to_owned(),
        at: format!("line {number} of its header"),
        found: format!("`{}`", line.chars().take(60).collect::<String>()),
        expected: expected.to_owned(),
        advice: COPY_AGAIN,
    };
    let words: Vec<&str> = line.split_whitespace().collect();
    match words.as_slice() {
        ["ply"] if number == 1 => {}
        [] => {}
        ["comment" | "obj_info", ..] => header.comments.push(line.split_once(' ').map_or("", |(_, text)| text).to_owned()),
        ["format", "binary_little_endian", _] => {}
        ["format", kind @ ("ascii" | "binary_big_endian"), ..] => {
            let found = if *kind == "ascii" { "a text (ascii) .ply" } else { "a big-endian .ply" };
            return Err(SceneError::Unsupported { file: name.to_owned(), found: found.to_owned(), advice: CONVERT });
        }
        ["element", element, count] => {
            let count = count.parse().map_err(|_| damaged("a whole number of rows"))?;
            header.elements.push(Element { name: (*element).to_owned(), count, properties: Vec::new(), stride: 0, lists: false });
        }
        ["property", rest @ ..] => {
            let Some(element) = header.elements.last_mut() else { return Err(damaged("an `element` before its properties")) };
            match rest {
                ["list", _, _, _] => element.lists = true,
                [kind, property] => {
                    let scalar = Scalar::parse(kind).ok_or_else(|| damaged("a number type such as `float`"))?;
                    element.properties.push(((*property).to_owned(), Column { offset: element.stride, scalar }));
                    element.stride += scalar.bytes();
                }
                _ => return Err(damaged("`property TYPE NAME`")),
            }
        }
        _ => return Err(damaged("`format`, `element`, `property`, `comment` or `end_header`")),
    }
    Ok(())
}
