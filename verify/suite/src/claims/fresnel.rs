//! Smooth boundaries of dielectrics: Fresnel's equations, their mean, a slab of glass, and three ways to follow both branches.

use verify::claim::Claim;

mod branch;
mod curve;
mod mean;

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    [curve::claims(), mean::claims(), branch::claims()].into_iter().flatten().collect()
}
