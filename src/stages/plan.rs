//! What a run would do, and why.

use crate::spec::Camera;
use serde::Serialize;

/// How fine. Changes the cell size and, where `output.size = "auto"`, the picture size; nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quality {
    /// 24 cells along the longest side, 640 x 360.
    Draft,
    /// 64 cells along the longest side, 1280 x 720.
    Full,
}

/// Choices of one run: outside the spec and its hash, inside the stages' keys.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Full on a GPU and draft on a CPU adapter where none is given.
    pub quality: Option<Quality>,
    /// Overrides `output.size`.
    pub size: Option<[u32; 2]>,
    /// Whether pictures are drawn at all.
    pub render: bool,
    /// The camera that the session's first version resolved to: `camera = "auto"` keeps it, so that
    /// versions compare.
    pub camera: Option<Camera>,
}

impl Default for RunOptions {
    fn default() -> Self {
        RunOptions { quality: None, size: None, render: true, camera: None }
    }
}

/// The five stages, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StageName {
    /// Reads and prunes the file, selects the objects.
    Scene,
    /// Gaussians to solids.
    Proxy,
    /// Each Gaussian to its particles.
    Bind,
    /// Particles to motion.
    Simulate,
    /// Motion to pictures.
    Picture,
}

impl StageName {
    /// All of them, in their order.
    pub const ALL: [StageName; 5] = [StageName::Scene, StageName::Proxy, StageName::Bind, StageName::Simulate, StageName::Picture];

    /// As written in `plan.json`.
    pub fn as_str(self) -> &'static str {
        match self {
            StageName::Scene => "scene",
            StageName::Proxy => "proxy",
            StageName::Bind => "bind",
            StageName::Simulate => "simulate",
            StageName::Picture => "picture",
        }
    }
}

/// What happens to a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// It runs from its start.
    Run,
    /// Its result is in the store.
    Hit,
    /// It goes on from a checkpoint.
    Resume,
    /// Nothing asks for it.
    Skip,
}

/// One row of a plan.
#[derive(Clone, Debug, Serialize)]
pub struct PlannedStage {
    /// Which stage.
    pub stage: StageName,
    /// Hash of its declared inputs.
    pub key: String,
    /// What happens to it.
    pub action: Action,
    /// Where a resumed stage starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_s: Option<f64>,
    /// Why, in words: a path of the spec that changed, "first run", "in the store".
    pub reason: String,
    /// What it took, once run; before that an estimate from earlier runs, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
}

/// What a run would do: always five rows, in order.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// The rows.
    pub stages: Vec<PlannedStage>,
}

impl Plan {
    /// The row of one stage.
    pub fn stage(&self, name: StageName) -> Option<&PlannedStage> {
        self.stages.iter().find(|s| s.stage == name)
    }
}
