//! What can be fuzzed. A new target is one file in `targets/` and a line in `targets/mod.rs`.

/// A reader of bytes that others wrote.
pub trait Target {
    /// As the command line calls it.
    fn name(&self) -> &'static str;

    /// Inputs to start from: good ones, and ones that were wrong in an interesting way.
    fn seeds(&self) -> Vec<Vec<u8>>;

    /// Words of its language, which mutations insert.
    fn dictionary(&self) -> Vec<&'static [u8]>;

    /// Longest input, bytes.
    fn longest(&self) -> usize {
        1 << 14
    }

    /// Most memory for an input of so many bytes, all allocations that live at once together.
    fn memory(&self, input_bytes: usize) -> usize;

    /// Reads an input. The class of what came of it: equal classes mean equal paths, roughly. An error is a broken promise, not
    /// an input that was refused.
    fn run(&self, input: &[u8]) -> Result<String, String>;
}

/// The class of a message: its words, without the numbers and quotations that differ from input to input.
pub fn class(message: &str) -> String {
    // What is quoted may hold quotes itself: from the first to the last.
    let around = message.split_once(['`', '"']).map_or((message, ""), |(before, rest)| (before, rest.rsplit(['`', '"']).next().unwrap_or_default()));
    let words = around.0.chars().chain(around.1.chars());
    let mut class = String::new();
    for c in words.map(|c| if c.is_ascii_digit() { '#' } else { c }) {
        if !(c == '#' && class.ends_with('#')) {
            class.push(c);
        }
    }
    class.chars().take(100).collect()
}
