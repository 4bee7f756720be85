//! What every sampler promises: each number uniform over its randomisations, means without bias, points as even as their family's, and
//! numbers for different purposes that have nothing to do with each other.

use verify::claim::Claim;

mod evenness;
mod independence;
mod recording;
mod uniformity;

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    [uniformity::claims(), evenness::claims(), independence::claims()].into_iter().flatten().collect()
}
