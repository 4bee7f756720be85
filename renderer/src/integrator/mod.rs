//! Rank 8: which light paths are followed, as stages over batches of samples.

pub mod batch;
mod connect;
pub mod light_paths;
pub mod path;
pub mod reuse;
mod scatter;
pub mod stages;

pub use batch::Batch;
pub use path::PathTracer;

use crate::sampling::{DecisionSet, Sampler};
use crate::scene::Scene;

/// Estimates the radiance of a batch of samples.
pub trait Integrator: Send + Sync {
    /// Decisions made up to and at the first hit, and at later ones, in `scene`.
    fn decisions(&self, scene: &Scene) -> [DecisionSet; 2];

    /// Whether samples of neighbouring pixels share what they find (`integrator/reuse.rs`).
    fn reuses(&self, _scene: &Scene) -> bool {
        false
    }

    /// Fills in the radiance of every sample in `batch`.
    fn trace<S: Sampler>(&self, scene: &Scene, sampler: &S, batch: &mut Batch);
}
