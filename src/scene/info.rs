//! What `scene info` tells.

use super::{Format, Loaded, UpGuess, floaters};
use serde::Serialize;

/// A scene in numbers, in the file's own frame and units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneInfo {
    /// How many there are, unusable ones left out.
    pub gaussians: usize,
    /// Of the file, by content.
    pub format: Format,
    /// 0 to 3.
    pub sh_degree: u32,
    /// Of the centres of all Gaussians, floaters included.
    pub bounds: Bounds,
    /// Up as stated in the file or guessed.
    pub up_guess: UpGuess,
    /// Isolated Gaussians that the proxy leaves out.
    pub floaters: usize,
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// Lowest corner.
    pub low: [f32; 3],
    /// Highest corner.
    pub high: [f32; 3],
}

/// Measures a scene.
pub fn info(loaded: &Loaded) -> SceneInfo {
    let g = &loaded.gaussians;
    let (low, high) = g.bounds();
    SceneInfo {
        gaussians: g.len(),
        format: loaded.format,
        sh_degree: g.sh_degree,
        bounds: Bounds { low: low.to_array(), high: high.to_array() },
        up_guess: loaded.up(),
        floaters: floaters(g).into_iter().filter(|&f| f).count(),
    }
}
