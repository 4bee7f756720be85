//! Smooth boundaries of dielectrics: Fresnel's equations, their mean, a slab of glass, what is seen in and through them, and three ways to follow both branches.

use verify::claim::{Claim, Level};

mod branch;
mod curve;
mod film;
mod mean;
mod radiance;

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    [curve::claims(), mean::claims(), branch::claims(), film::claims(), radiance::claims()]
        .into_iter()
        .flatten()
        .map(|claim| claim.same_up_to(Level::Standard))
        .collect()
}
