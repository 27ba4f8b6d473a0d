//! Tests of the renderer: against a slow reference in f64, pass by pass against plain Rust, against
//! pictures of other programs where they are there, and against itself.

mod behaviour;
mod ground;
mod other_programs;
mod reference;
mod scenes;
mod text;
mod twin;
