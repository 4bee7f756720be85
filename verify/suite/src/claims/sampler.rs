//! What every sampler promises: each number uniform over its randomisations, means without bias, points as even as their family's, and
//! numbers for different purposes that have nothing to do with each other.

use renderer::sampling::SamplerKind;
use verify::claim::{Claim, Level};

mod evenness;
mod independence;
mod indices;
mod names;
mod recording;
mod uniformity;

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let groups = [
        uniformity::claims(),
        evenness::claims(),
        independence::claims(),
        indices::claims(),
        names::claims(),
    ];
    groups.into_iter().flatten().collect()
}

/// The level from which on a sampler's claims run: those of the three that most scenes use run at every level.
pub(super) fn level(kind: SamplerKind) -> Level {
    match kind {
        SamplerKind::Independent | SamplerKind::Stratified | SamplerKind::Sobol => Level::Quick,
        SamplerKind::MultiJitter | SamplerKind::Halton | SamplerKind::Pmj02 => Level::Standard,
    }
}
