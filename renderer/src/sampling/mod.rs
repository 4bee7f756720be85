//! Rank 1: numbers by named decision, and the maps that turn them into points, directions and choices.

pub mod decision;
pub mod discrete;
pub mod generators;
pub mod halton;
mod hash;
pub mod independent;
pub mod mis;
pub mod multijitter;
mod owen;
mod permutation;
pub mod piecewise;
pub mod pmj02;
pub mod redrawn;
pub mod sobol;
mod sobol_matrix;
pub mod stratified;
pub mod warp;
pub mod within_plan;

pub use decision::{Decision, DecisionSet, Vertex};
pub use discrete::{Discrete, DiscreteSample};
pub use generators::Generator;
pub use halton::Halton;
pub use independent::Independent;
pub use multijitter::MultiJitter;
pub use piecewise::{Piecewise1d, Piecewise2d};
pub use pmj02::Pmj02;
pub use redrawn::Redrawn;
pub use sobol::Sobol;
pub use stratified::Stratified;
pub use within_plan::WithinPlan;

/// The families of point sets that a scene can ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SamplerKind {
    /// Independent uniform numbers.
    Independent,
    /// One jittered number in each of as many equal strata as there are samples.
    Stratified,
    /// Correlated multi-jittered points.
    MultiJitter,
    /// Owen-scrambled Halton points, joint over the decisions before the first bounce.
    Halton,
    /// Owen-scrambled Sobol points, joint over the decisions up to the second hit.
    #[default]
    Sobol,
    /// Progressive multi-jittered (0, 2) points.
    Pmj02,
}

impl SamplerKind {
    /// Every kind.
    pub const ALL: [Self; 6] =
        [Self::Independent, Self::Stratified, Self::MultiJitter, Self::Halton, Self::Sobol, Self::Pmj02];

    /// Its name in scene files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Stratified => "stratified",
            Self::MultiJitter => "multijitter",
            Self::Halton => "halton",
            Self::Sobol => "sobol",
            Self::Pmj02 => "pmj02",
        }
    }
}

/// Which sample of an image the numbers are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SampleId {
    /// Pixel: column and row from the upper left corner.
    pub pixel: [u32; 2],
    /// Which of the independent randomisations; numbers of two replicates share nothing.
    pub replicate: u32,
    /// Index of the sample within its pixel and replicate, from 0.
    pub index: u32,
}

/// Where along which sample's path a number is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// The sample.
    pub sample: SampleId,
    /// The place along its path.
    pub vertex: Vertex,
}

impl Place {
    /// Whether two places differ in the index of the sample at most, so that they have points of one set.
    fn shares_set(&self, other: &Self) -> bool {
        let (a, b) = (self.sample, other.sample);
        (a.pixel, a.replicate, self.vertex) == (b.pixel, b.replicate, other.vertex)
    }
}

/// A source of numbers for every random choice of a renderer.
///
/// A number is a pure function of seed, sample, vertex and decision. There is no state: asking twice gives the
/// same number, and asking in another order or from another thread changes nothing.
pub trait Sampler: Send + Sync {
    /// The number in [0, 1) for a decision of one dimension.
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32;

    /// The point in [0, 1)² for a decision of two dimensions.
    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2];

    /// The numbers that [`Self::draw_1d`] gives at each of `places`, written over `out`.
    fn draw_1d_each(&self, places: &[Place], decision: Decision, out: &mut Vec<f32>) {
        out.clear();
        out.extend(places.iter().map(|place| self.draw_1d(place.sample, place.vertex, decision)));
    }

    /// The points that [`Self::draw_2d`] gives at each of `places`, written over `out`.
    fn draw_2d_each(&self, places: &[Place], decision: Decision, out: &mut Vec<[f32; 2]>) {
        out.clear();
        out.extend(places.iter().map(|place| self.draw_2d(place.sample, place.vertex, decision)));
    }
}
