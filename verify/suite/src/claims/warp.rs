//! Maps from uniform numbers: their points follow the closed form of the density, `pdf` is that form, and the inverse undoes the map.

use verify::claim::{Claim, claim};

use super::pointwise::{never, rejecting, same_on_circle, single};

mod directions;
mod flat;

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    [flat::claims(), directions::claims()].into_iter().flatten().collect()
}

/// Distance that rounding can put between a number and what comes back for it: map and inverse make at most 16 roundings of 2⁻²⁴ between them
/// (the largest distance among 10⁶ points is 7, on the cone).
const ROUND_TRIP: f32 = 16.0 / 16_777_216.0;

/// Distance from the sides of the unit square within which no number is tried: at a pole all of a side maps to one point, and no inverse can tell
/// them apart. The maps' own tests have the sides.
const MARGIN: f64 = 1.0 / 1024.0;

/// A claim that an inverse undoes its map.
///
/// * `round_trip`: map and then inverse; `wrong`: the same with an inverse that makes the mistake of that name.
fn inverse(
    id: &str,
    says: &str,
    round_trip: impl Fn([f32; 2]) -> [f32; 2] + Send + Sync + 'static,
    (mistake, wrong): (&'static str, impl Fn([f32; 2]) -> [f32; 2] + Send + Sync + 'static),
) -> Claim {
    let misses = |u: [f64; 2], back: &dyn Fn([f32; 2]) -> [f32; 2]| {
        let u = u.map(|u| single(MARGIN + (1.0 - 2.0 * MARGIN) * u));
        !same_on_circle(back(u), u, ROUND_TRIP)
    };
    let builder = rejecting(claim(id, says), mistake, move |u| misses(u, &wrong));
    never(builder, "share of points that do not come back", move |u| misses(u, &round_trip))
}
