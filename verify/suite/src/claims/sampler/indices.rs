//! Samples of a pixel beyond the first 2¹⁶ have points of their own.

use std::sync::Arc;

use renderer::sampling::{Decision, DecisionSet, SampleId, Sampler, SamplerKind, Vertex};
use verify::claim::{Claim, claim};

use super::super::pointwise::{never, rejecting};
use super::level;
use crate::setup::sampler;

/// How far apart two indices are that differ beyond 16 bits only.
const APART: u32 = 1 << 16;

/// The decision that is the joint sequence's, and one after a bounce.
const PLACES: [(Decision, u16); 2] = [(Decision::Pixel, 0), (Decision::LightPoint, 3)];

pub(super) fn claims() -> Vec<Claim> {
    SamplerKind::ALL.into_iter().map(|kind| beyond_16_bits(kind).from_level(level(kind))).collect()
}

fn beyond_16_bits(kind: SamplerKind) -> Claim {
    let planned = DecisionSet::EMPTY.with(Decision::Pixel);
    let sampler: Arc<dyn Sampler> = sampler(kind, 0, planned, 2 * APART).into();
    // Whether the point of an index is that of one 2¹⁶ later, if that is looked at through some of its bits. The pixel is the randomisation.
    let same = |sampler: &dyn Sampler, [x, y, i, place]: [f64; 4], bits: u32| {
        let [column, row, index] = [x, y, i].map(|u| whole(u, APART));
        let (decision, bounce) = PLACES[whole(place, 2) as usize];
        let [near, far] = [index, index + APART].map(|index| {
            let id = SampleId { pixel: [column, row], replicate: 0, index: index & bits };
            sampler.draw_2d(id, Vertex { bounce, ..Vertex::default() }, decision)
        });
        near == far
    };
    let name = kind.name();
    let says = format!("a {name} sample of a pixel has not the point of the one 65,536 samples before it");
    let short = sampler.clone();
    let builder = claim(format!("sampler/{name}/beyond-16-bits"), says);
    let builder = rejecting(builder, "an index of 16 bits", move |u| same(&*short, u, APART - 1));
    never(builder, "share of points that come again", move |u| same(&*sampler, u, u32::MAX))
}

/// A whole number below `count` of a uniform one.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in [0, count), a u32")]
fn whole(u: f64, count: u32) -> u32 {
    (u * f64::from(count)) as u32
}
