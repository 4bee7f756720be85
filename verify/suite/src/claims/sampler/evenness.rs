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

use super::level;
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
    let mut list = vec![net(SamplerKind::Sobol), net(SamplerKind::Pmj02), grid(), multijitter(), halton()];
    let of_family = |kind| family(kind).map(|family| discrepancy(kind, family).from_level(level(kind)));
    list.extend(SamplerKind::ALL.into_iter().filter_map(of_family));
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

/// The claim that aligned runs of 2^m samples are nets.
fn net(kind: SamplerKind) -> Claim {
    let says = format!(
        "each aligned run of 2^m {} points has one in every box of area 2^−m: of pixel positions, and of each later pair of numbers",
        kind.name()
    );
    let even = move |seed| sampler(kind, seed, planned(), 0);
    let mut builder = claim(format!("sampler/{}/net", kind.name()), says)
        .rejects("independent numbers", |run| {
            never_uneven(run, |seed| {
                is_no_net(&*sampler(SamplerKind::Independent, seed, planned(), 0), net_of(seed))
            })
        })
        .rejects("runs without their first point", move |run| {
            let wrong = |seed| Confused { inner: even(seed), question: without_the_first };
            never_uneven(run, |seed| is_no_net(&wrong(seed), net_of(seed)))
        });
    if kind == SamplerKind::Sobol {
        builder = builder.rejects("the lens's dimensions, which are no net", move |run| {
            never_uneven(run, |seed| {
                is_no_net(
                    &*even(seed),
                    Set { decision: Decision::Lens, vertex: Vertex::default(), ..net_of(seed) },
                )
            })
        });
    }
    builder
        .by(move |run| never_uneven(run, |seed| is_no_net(&*even(seed), net_of(seed))))
        .from_level(level(kind))
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

/// How often each cell of a grid is hit; `None` where 24 digits can't tell.
///
/// A number is cut down to a multiple of 2⁻²⁴; where a cell's edge lies between it and the next one, it may have been on either side, and the
/// set shows nothing.
fn counts(points: &[[f64; 2]], [columns, rows]: [u32; 2]) -> Option<Vec<u32>> {
    const DIGIT: f64 = 1.0 / 16_777_216.0;
    let mut counts = vec![0; (columns * rows) as usize];
    for [x, y] in points {
        let ([column, right], [row, above]) =
            ([*x, x + DIGIT].map(|x| cell(x, columns)), [*y, y + DIGIT].map(|y| cell(y, rows)));
        if column != right || row != above {
            return None;
        }
        counts[(row * columns + column) as usize] += 1;
    }
    Some(counts)
}

/// Whether the counts of the cells of a stratified set are wrong.
fn is_uneven(sampler: &dyn Sampler, set: Set) -> bool {
    let columns = set.samples.isqrt();
    let rows = set.samples / columns;
    let Some(counts) = counts(&set.points(sampler), [columns, rows]) else { return false };
    let twice = counts.iter().filter(|&&count| count == 2).count();
    twice != (set.samples - columns * rows) as usize || counts.iter().any(|&count| count != 1 && count != 2)
}

/// The claim that no two multi-jittered samples share a cell, a fine column or a fine row.
fn multijitter() -> Claim {
    let kind = SamplerKind::MultiJitter;
    let says = "no two of n multi-jittered samples share one of a·b cells, of ab columns or of ab rows, a = ⌊√n⌋ and b = ⌈n/a⌉";
    let set_of = |kind: SamplerKind, seed: u64| {
        let set = grid_of(seed);
        (sampler(kind, seed, planned(), set.samples), set)
    };
    let crowded = |sampler: &dyn Sampler, set: Set| {
        let columns = set.samples.isqrt();
        let rows = set.samples.div_ceil(columns);
        let points = set.points(sampler);
        let grids = [[columns, rows], [columns * rows, 1], [1, columns * rows]];
        grids.into_iter().filter_map(|grid| counts(&points, grid)).flatten().any(|count| count > 1)
    };
    claim("sampler/multijitter/grid", says)
        .rejects("stratified numbers", move |run| {
            never_uneven(run, |seed| {
                let (sampler, set) = set_of(SamplerKind::Stratified, seed);
                crowded(&*sampler, set)
            })
        })
        .rejects("samples in pairs of the same numbers", move |run| {
            never_uneven(run, |seed| {
                let (inner, set) = set_of(kind, seed);
                crowded(&Confused { inner, question: in_pairs }, set)
            })
        })
        .by(move |run| {
            never_uneven(run, |seed| {
                let (sampler, set) = set_of(kind, seed);
                crowded(&*sampler, set)
            })
        })
        .from_level(level(kind))
}

/// The claim that runs of 2^a·3^b Halton samples fill a grid, wherever they begin.
fn halton() -> Claim {
    let kind = SamplerKind::Halton;
    let says = "each run of 2^a·3^b Halton pixel positions, wherever it begins, has one in every cell of 2^a columns and 3^b rows";
    let run_of = |kind: SamplerKind, seed: u64| {
        let grid = [1 << ((seed >> 20) % 5), 3_u32.pow(u32::from((seed >> 28).to_le_bytes()[0]) % 4)];
        let samples = grid[0] * grid[1];
        let start = u32::from((seed >> 36).to_le_bytes()[0]);
        let set = Set { start, samples, decision: Decision::Pixel, vertex: Vertex::default(), seed };
        (sampler(kind, seed, planned(), start + samples), set, grid)
    };
    let uneven = |sampler: &dyn Sampler, set: Set, grid: [u32; 2]| {
        counts(&set.points(sampler), grid).is_some_and(|counts| counts.iter().any(|&count| count != 1))
    };
    claim("sampler/halton/runs", says)
        .rejects("Sobol's points", move |run| {
            never_uneven(run, |seed| {
                let (sampler, set, grid) = run_of(SamplerKind::Sobol, seed);
                uneven(&*sampler, set, grid)
            })
        })
        .rejects("samples in pairs of the same numbers", move |run| {
            never_uneven(run, |seed| {
                let (inner, set, grid) = run_of(kind, seed);
                uneven(&Confused { inner, question: in_pairs }, set, grid)
            })
        })
        .by(move |run| {
            never_uneven(run, |seed| {
                let (sampler, set, grid) = run_of(kind, seed);
                uneven(&*sampler, set, grid)
            })
        })
        .from_level(level(kind))
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

/// The family of pixel positions whose mean discrepancy is known exactly.
fn family(kind: SamplerKind) -> Option<Family> {
    match kind {
        SamplerKind::Independent => Some(Family::Random),
        SamplerKind::Stratified => Some(Family::Jitter),
        SamplerKind::Sobol | SamplerKind::Pmj02 => Some(Family::ScrambledNet),
        SamplerKind::MultiJitter | SamplerKind::Halton => None,
    }
}

/// The claim that the mean squared discrepancy of pixel positions is the exact one of their family.
fn discrepancy(kind: SamplerKind, family: Family) -> Claim {
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
