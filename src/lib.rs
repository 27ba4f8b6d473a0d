//! Talk to a 3D Gaussian Splatting scene, and physics answers: the engine.
//!
//! A [`spec::Spec`] says what to simulate. The stages prepare its scene, solve its motion and draw
//! its pictures; only what changed runs again.

pub mod export;
pub mod gpu;
pub mod proxy;
pub mod render;
pub mod scene;
mod sink;
pub mod skin;
pub mod solver;
pub mod spec;
pub mod stages;
pub mod store;
pub mod threads;
pub mod world;

pub use sink::{Discard, Frame, Progress, Sink, Stop};
