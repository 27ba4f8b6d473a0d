//! Why a run failed, by kind: whoever runs the engine turns the kind into an exit code.

use crate::gpu::GpuError;
use crate::proxy::ProxyError;
use crate::scene::SceneError;
use crate::solver::SolverError;
use crate::spec::SpecError;
use crate::store::StoreError;
use crate::threads::ThreadError;
use crate::world::ScaleError;

/// Anything that ends a run without a result.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The scene is missing, unreadable or empty.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The spec does not fit the scene, or itself.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// An object could not be made solid.
    #[error("object \"{object}\": {source}")]
    Proxy {
        /// Its name.
        object: String,
        /// Why.
        source: ProxyError,
    },
    /// An object has no Gaussians.
    #[error(
        "object \"{object}\" holds none of the scene's {gaussians} Gaussians: {select}; give it a box or sphere that contains some (`phystalk scene info` prints the bounds)"
    )]
    Empty {
        /// Its name.
        object: String,
        /// How many the scene has.
        gaussians: usize,
        /// What it selects.
        select: String,
    },
    /// The scene's file is not the one that the spec was made for.
    #[error(
        "{file} has changed since the spec recorded it: its BLAKE3 is {found}, recorded is {recorded}; restore the file, or remove scene.blake3 from the spec to take the new one"
    )]
    SceneChanged {
        /// Its path.
        file: String,
        /// What it hashes to now.
        found: String,
        /// What the spec says.
        recorded: String,
    },
    /// The scene is too small or too large to be simulated in metres.
    #[error(transparent)]
    Scale(#[from] ScaleError),
    /// No device, or the device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The motion could not be kept stable.
    #[error("{0}")]
    Unstable(String),
    /// Too wide or too fast for the grid that the device holds.
    #[error("{text}")]
    TooLarge {
        /// What was, and what to do.
        text: String,
        /// Until when it moved; 0 where nothing did.
        time_s: f64,
    },
    /// A thread could not be started, or its work panicked.
    #[error(transparent)]
    Thread(#[from] ThreadError),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

impl From<SolverError> for EngineError {
    fn from(error: SolverError) -> Self {
        match error {
            SolverError::Gpu(gpu) => EngineError::Gpu(gpu),
            large @ (SolverError::TooWide { .. } | SolverError::TooFar { .. } | SolverError::TooFast { .. }) => {
                EngineError::TooLarge { text: large.to_string(), time_s: 0.0 }
            }
            other => EngineError::Unstable(other.to_string()),
        }
    }
}

impl EngineError {
    /// What ended the motion at a time.
    pub(super) fn at(error: SolverError, time_s: f64) -> EngineError {
        match EngineError::from(error) {
            EngineError::TooLarge { text, .. } => EngineError::TooLarge { text, time_s },
            other => other,
        }
    }
}
