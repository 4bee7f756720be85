//! Points are as even as those of their family: exactly where it is a matter of counting, in the mean where it is one of chance.

use renderer::sampling::{Decision, DecisionSet, SampleId, Sampler, SamplerKind, Vertex};
use verify::claim::{Claim, Evidence, Run, claim};
use verify::discrepancy::{l2_star_squared, mean_l2_star_squared};
use verify::error::InputError;
use verify::integrands::Family;
use verify::mean::{MeanClaim, joint_control, joint_evidence};
use verify::nets::first_uneven;
use verify::seeds::derive;
use verify::share;

use crate::bounds;
use crate::setup::sampler;
use crate::wrong::samplers::{Confused, in_pairs, without_the_first};

/// Largest logarithm of the number of points of a net that is tried.
const LARGEST_NET: u64 = 8;

/// Sample counts at which discrepancies are compared.
const COUNTS: [u32; 2] = [16, 64];

/// Replicates for a discrepancy: 64 means over 64 sets each, so that the means are close to normal.
const SETS: u64 = 64;

pub(super) fn claims() -> Vec<Claim> {
    let mut list = vec![net(), grid()];
    list.extend(SamplerKind::ALL.map(discrepancy));
    list
}

/// One set of points to look at.
#[derive(Clone, Copy)]
struct Set {
    seed: u64,
    start: u32,
    samples: u32,
    decision: Decision,
    vertex: Vertex,
}

impl Set {
    fn points(&self, sampler: &dyn Sampler) -> Vec<[f64; 2]> {
        let [x, y] = [self.seed, self.seed >> 8].map(|bits| u32::from(bits.to_le_bytes()[0]));
        let sample = |index| SampleId { pixel: [x, y], replicate: 1, index };
        let draw = |index| sampler.draw_2d(sample(index), self.vertex, self.decision).map(f64::from);
        (self.start..self.start + self.samples).map(draw).collect()
    }
}

/// The evidence of sets drawn at random from `draw`, none of which may be uneven.
fn never_uneven(run: &Run, uneven: impl Fn(u64) -> bool) -> Result<Evidence, InputError> {
    let trials = share::trials_for(bounds::UNEVEN)? * run.effort;
    let misses = (0..trials).filter(|&i| uneven(derive(run.seed, 0, i))).count();
    share::judge("share of point sets", misses as u64, trials, bounds::UNEVEN)
}

fn planned() -> DecisionSet {
    DecisionSet::EMPTY.with(Decision::Pixel).with(Decision::Lens)
}

/// The claim that aligned runs of 2^m Sobol samples are nets.
fn net() -> Claim {
    let says = "each aligned run of 2^m pixel positions, and of each later pair of numbers, has one point in every box of area 2^−m";
    claim("sampler/sobol/net", says)
        .rejects("independent numbers", |run| {
            never_uneven(run, |seed| {
                is_no_net(&*sampler(SamplerKind::Independent, seed, planned(), 0), net_of(seed))
            })
        })
        .rejects("runs without their first point", |run| {
            let wrong = |seed| Confused { inner: sobol(seed), question: without_the_first };
            never_uneven(run, |seed| is_no_net(&wrong(seed), net_of(seed)))
        })
        .rejects("the lens's dimensions, which are no net", |run| {
            never_uneven(run, |seed| {
                is_no_net(
                    &*sobol(seed),
                    Set { decision: Decision::Lens, vertex: Vertex::default(), ..net_of(seed) },
                )
            })
        })
        .by(|run| never_uneven(run, |seed| is_no_net(&*sobol(seed), net_of(seed))))
}

fn sobol(seed: u64) -> Box<dyn Sampler> {
    sampler(SamplerKind::Sobol, seed, planned(), 0)
}

/// A run of samples of a decision whose points are a net, chosen by the bits of `seed`.
fn net_of(seed: u64) -> Set {
    let samples = 1 << ((seed >> 20) % (LARGEST_NET + 1));
    let block = u32::from((seed >> 32).to_le_bytes()[0]);
    let later = |bounce| Vertex { bounce, ..Vertex::default() };
    let (decision, vertex) = match (seed >> 40) % 3 {
        0 => (Decision::Pixel, Vertex::default()),
        1 => (Decision::LightPoint, Vertex::default()),
        _ => (Decision::Direction, later(u16::from((seed >> 48).to_le_bytes()[0]))),
    };
    Set { seed, start: block * samples, samples, decision, vertex }
}

fn is_no_net(sampler: &dyn Sampler, set: Set) -> bool {
    first_uneven(&set.points(sampler), 0).is_some()
}

/// The claim that stratified samples have one point in each cell of their grid, and those that are left over different cells.
fn grid() -> Claim {
    let says = "n stratified samples have a point in each of a·b cells, a = ⌊√n⌋ and b = ⌊n/a⌋, and n − ab cells have two";
    let stratified = |set: &Set| sampler(SamplerKind::Stratified, set.seed, planned(), set.samples);
    claim("sampler/stratified/grid", says)
        .rejects("independent numbers", |run| {
            never_uneven(run, |seed| {
                is_uneven(&*sampler(SamplerKind::Independent, seed, planned(), 0), grid_of(seed))
            })
        })
        .rejects("samples in pairs of the same numbers", move |run| {
            let wrong = |set| Confused { inner: stratified(&set), question: in_pairs };
            never_uneven(run, |seed| is_uneven(&wrong(grid_of(seed)), grid_of(seed)))
        })
        .by(move |run| never_uneven(run, |seed| is_uneven(&*stratified(&grid_of(seed)), grid_of(seed))))
}

/// A set of up to 256 samples, chosen by the bits of `seed`.
fn grid_of(seed: u64) -> Set {
    let samples = 1 + u32::from((seed >> 20).to_le_bytes()[0]);
    Set { start: 0, samples, ..net_of(seed) }
}

/// Whether the counts of the cells are wrong, as far as 24 digits can tell.
///
/// A number is cut down to a multiple of 2⁻²⁴; where a cell's edge lies between it and the next one, it may have been on either side, and the
/// set shows nothing.
fn is_uneven(sampler: &dyn Sampler, set: Set) -> bool {
    const DIGIT: f64 = 1.0 / 16_777_216.0;
    let columns = set.samples.isqrt();
    let rows = set.samples / columns;
    let mut counts = vec![0; (columns * rows) as usize];
    for [x, y] in set.points(sampler) {
        let ([column, right], [row, above]) =
            ([x, x + DIGIT].map(|x| cell(x, columns)), [y, y + DIGIT].map(|y| cell(y, rows)));
        if column != right || row != above {
            return false;
        }
        counts[(row * columns + column) as usize] += 1;
    }
    let twice = counts.iter().filter(|&&count| count == 2).count();
    twice != (set.samples - columns * rows) as usize || counts.iter().any(|&count| count != 1 && count != 2)
}

/// In which of `cells` equal parts of [0, 1) a number lies.
fn cell(u: f64, cells: u32) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the floor is wanted, of 0 to cells"
    )]
    let cell = (u * f64::from(cells)) as u32;
    cell
}

/// The claim that the mean squared discrepancy of pixel positions is the exact one of their family.
fn discrepancy(kind: SamplerKind) -> Claim {
    let family = match kind {
        SamplerKind::Independent => Family::Random,
        SamplerKind::Stratified => Family::Jitter,
        SamplerKind::Sobol => Family::ScrambledNet,
    };
    let tests = move || {
        COUNTS.map(|n| MeanClaim {
            replicates: SETS,
            ..MeanClaim::relative(mean_l2_star_squared(family, n), bounds::DISCREPANCY)
        })
    };
    let mean = |kind: SamplerKind, samples: u32, seed: u64| {
        let one = |i: u64| {
            let seed = derive(seed, 1, i);
            let set = Set { seed, start: 0, samples, decision: Decision::Pixel, vertex: Vertex::default() };
            l2_star_squared(&set.points(&*sampler(kind, seed, planned(), samples)))
        };
        (0..SETS).map(one).sum::<f64>() / SETS as f64
    };
    let (mistake, wrong) = match kind {
        SamplerKind::Independent => ("stratified points", SamplerKind::Stratified),
        _ => ("independent points", SamplerKind::Independent),
    };
    let says =
        format!("the mean discrepancy (L2 star) of {} points is the exact one of their family", kind.name());
    claim(format!("sampler/{}/discrepancy", kind.name()), says)
        .rejects("2.2 × resolution", move |run| {
            joint_control(&tests(), run, |i, seed| mean(kind, COUNTS[i], seed))
        })
        .rejects(mistake, move |run| joint_evidence(&tests(), run, |i, seed| mean(wrong, COUNTS[i], seed)))
        .by(move |run| joint_evidence(&tests(), run, |i, seed| mean(kind, COUNTS[i], seed)))
}
