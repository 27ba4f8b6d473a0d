//! The `phystalk` program.
fn main() {}
