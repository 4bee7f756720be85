//! Progressive multi-jittered (0, 2) points, each decision a sequence of its own.

use super::sobol::Sobol;
use super::{Decision, DecisionSet, SampleId, Sampler, Vertex};

/// What tells its seeds from those of [`Sobol`].
const OF_ITS_OWN: u64 = 0x706d_6a30_3200_0000;

/// Numbers of which every aligned run of 2ᵐ has one in each box of area 2^−m, decision by decision.
///
/// A sequence is progressive multi-jittered (0, 2) if each prefix of 2ᵐ points is a (0, m, 2)-net: one point in each of
/// the 2ᵐ columns, in each of the 2ᵐ rows and in each box of every shape between. The first two dimensions of Sobol's
/// sequence are such a sequence, and Owen's scrambling, which permutes halves within halves, leaves the number of points
/// in every such box what it is. So these are the padded sets of [`Sobol`], for every decision: what it lacks is the
/// joint set, and with it any evenness across decisions.
///
/// # Source
/// Christensen, Kensler and Kilpatrick 2018, "Progressive multi-jittered sample sequences", doi 10.1111/cgf.13472, whose
/// points are searched for; that scrambled Sobol points are among them is in Helmer, Christensen and Kensler 2021,
/// "Stochastic generation of (t, s) sample sequences", doi 10.2312/sr.20211287.
///
/// # Verified by
/// Claims `sampler/pmj02/*`
#[derive(Debug, Clone)]
pub struct Pmj02(Sobol);

impl Pmj02 {
    /// The sampler of `seed`.
    pub fn new(seed: u64) -> Self {
        Self(Sobol::new(seed ^ OF_ITS_OWN, DecisionSet::EMPTY))
    }
}

impl Sampler for Pmj02 {
    #[inline]
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        self.0.draw_1d(sample, vertex, decision)
    }

    #[inline]
    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        self.0.draw_2d(sample, vertex, decision)
    }
}
