//! Hard cases stay numerically stable: each routine over its whole range against exact values, and scenes that break others.

use verify::claim::Claim;
use verify::error::InputError;

use crate::report::StabilityRow;
use routine::Routine;

mod arithmetic;
mod bits;
mod dropped;
mod facets;
mod geometry;
mod hard;
mod invariance;
mod lights;
mod numbers;
mod packets;
mod reflection;
mod routine;
mod solid_angle;
mod spawn;
mod spheres;
mod tables;
mod warps;
mod watertight;

/// A routine's claim, and its row in the table of what stability costs.
struct Entry {
    claim: Claim,
    row: Box<dyn Fn() -> Result<StabilityRow, InputError>>,
}

impl<const N: usize, const M: usize> From<Routine<N, M>> for Entry {
    fn from(routine: Routine<N, M>) -> Self {
        Self { claim: routine.claim(), row: Box::new(move || routine.row()) }
    }
}

fn entries() -> impl Iterator<Item = Entry> {
    let rest = [
        arithmetic::entries(),
        warps::entries(),
        reflection::entries(),
        spheres::entries(),
        geometry::entries(),
        solid_angle::entries(),
        facets::entries(),
        lights::entries(),
    ];
    std::iter::once(bits::entry()).chain(rest.into_iter().flatten())
}

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let scenes = [
        watertight::claims(),
        packets::claims(),
        spawn::claims(),
        invariance::claims(),
        hard::claims(),
        dropped::claims(),
    ];
    let routines = entries().map(|entry| entry.claim).chain(arithmetic::long_sums());
    routines.chain(scenes.into_iter().flatten()).collect()
}

/// The table of what stability costs: every routine's worst errors and times, in its usual form and in ours.
///
/// # Errors
/// A table of `references/stability` that cannot be read.
pub fn table() -> Result<Vec<StabilityRow>, InputError> {
    entries().map(|entry| (entry.row)()).collect()
}
