//! The weak white furnace: microfacets that face an eye reflect it somewhere on the whole sphere, whatever their roughness.

use glam::Vec3;
use renderer::materials::{Facets, Ggx};
use verify::claim::{Claim, Level, Run, claim};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::super::jittered;
use super::{anywhere, beckmann, brushed, towards};
use crate::bounds;

pub(super) fn claims() -> Vec<Claim> {
    vec![furnace()]
}

/// Side of the square of a replicate's directions.
const SIDE: u32 = 160;

/// Microfacets and the cosine at which they are seen.
fn views() -> Vec<(Facets, f64)> {
    let round = |alpha: f32| Ggx { alpha: [alpha; 2] }.into();
    let all: [Facets; 4] = [round(0.4), round(1.0), brushed(), beckmann()];
    all.into_iter().flat_map(|facets| [0.9, 0.3].map(|z| (facets, z))).collect()
}

/// What is integrated over the sphere of directions l: G₁(v) D(h)/(4 cos θᵥ), h half way between v and l.
///
/// * `from`: of the sphere, the lowest height of l; `shadowing`: G₁, or 1 without it.
fn reflected(facets: Facets, v: Vec3, l: Vec3, [from, shadowing]: [f32; 2]) -> f64 {
    let half = v + l;
    if half.z <= 0.0 || l.z < from {
        return 0.0;
    }
    let g1 = 1.0 + shadowing * (facets.g1(v) - 1.0);
    f64::from(g1 * facets.d(half.normalize()) / (4.0 * v.z))
}

/// # Source
/// Heitz 2014, "Understanding the masking-shadowing function in microfacet-based BRDFs", section 5.1, equation 77.
fn furnace() -> Claim {
    let claims = || {
        // Half vectors, D and the map to the sphere in f32: 32 roundings of 2⁻²⁴ that all agree.
        let one = MeanClaim { rounding: 2e-6, ..MeanClaim::relative(1.0, bounds::FURNACE) };
        vec![one; views().len()]
    };
    let total = |i: usize, seed: u64, how: [f32; 2]| {
        let (facets, z) = views()[i];
        let (v, sphere) = (towards(z), 4.0 * std::f64::consts::PI);
        jittered::mean(seed, SIDE, |u, _| sphere * reflected(facets, v, anywhere(u.map(f64::from)), how))
    };
    const RIGHT: [f32; 2] = [-1.0, 1.0];
    claim(
        "lobe/microfacets/weak-furnace",
        "without shadowing of what leaves, microfacets reflect all light: ∫ G₁(v) D(h)/(4 cos θ) over the whole sphere is 1",
    )
    .rejects("2.2 × resolution", move |run| joint_control(&claims(), run, |i, seed| total(i, seed, RIGHT)))
    .rejects("the upper half of the sphere", move |run| {
        joint_evidence(&claims(), run, |i, seed| total(i, seed, [0.0, 1.0]))
    })
    .rejects("without G₁", move |run| joint_evidence(&claims(), run, |i, seed| total(i, seed, [-1.0, 0.0])))
    .by(move |run: &Run| joint_evidence(&claims(), run, |i, seed| total(i, seed, RIGHT)))
    .from_level(Level::Standard)
}
