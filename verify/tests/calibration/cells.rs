//! Tests that count: chi-square, cubes, marginals, independence, shares.

use std::sync::LazyLock;

use verify::chi_square::{ChiSquare, Target};
use verify::claim::{Evidence, Run};
use verify::cube::Cube;
use verify::domain::Parallelogram;
use verify::goodness::{Marginal, Sides, Statistic};
use verify::independence::{IndependenceClaim, Source, Tally, judge_tallies};
use verify::seeds::derive;
use verify::share;

use crate::{Kind, Null, Stream, check, stated};

type Square = Target<Parallelogram<2>>;

/// Points of a run: 27 in a coarse cell, 0.27 in a fine one, so that pooling is tested too.
const POINTS: u64 = 5280;

/// Cells along an axis of the coarse grid of a square.
const SIDE: f64 = 14.0;

static UNIFORM: LazyLock<Square> = LazyLock::new(|| ChiSquare::on(Parallelogram::unit_square()));
static PEAKED: LazyLock<Square> =
    LazyLock::new(|| ChiSquare::on(Parallelogram::unit_square()).density(|[x, _]| 4.0 * x * x * x));
static ATOMS: LazyLock<Square> =
    LazyLock::new(|| ChiSquare::on(Parallelogram::unit_square()).atoms(&[0.2, 0.1]));

fn run(seed: u64) -> Run {
    Run { seed, effort: 1 }
}

/// Uniform points whose share in neighbouring cells alternates by ±`defect`.
fn checkered(stream: &Stream, defect: f64, side: f64) -> [f64; 2] {
    let x = stream.uniform();
    [x, checkered_row(stream, x, defect, side)]
}

/// The second coordinate of a point whose first is given: in a cell with too many it moves to the next row.
fn checkered_row(stream: &Stream, x: f64, defect: f64, side: f64) -> f64 {
    let [y, choice] = [stream.uniform(), stream.uniform()];
    let odd = |x: f64| (x * side).rem_euclid(2.0) >= 1.0;
    let moved = odd(x) != odd(y) && choice < defect;
    if moved { (y + 1.0 / side).fract() } else { y }
}

fn square_trial(target: &Square, seed: u64, point: impl Fn(&Stream) -> [f64; 2]) -> Evidence {
    let (stream, mut histogram) = (Stream::of(seed), target.histogram());
    (0..POINTS).for_each(|_| target.add(&mut histogram, point(&stream)));
    target.judge(&histogram, 0.5).expect("enough points")
}

const CHI_SQUARE: Kind = Kind {
    name: "chi-square",
    says: "uniform points of a square, 27 a cell; defect: a checkerboard of cells",
    null: Null::Uniform,
    trial: |seed, defect| square_trial(&UNIFORM, seed, |stream| checkered(stream, defect, SIDE)),
    resolution: stated,
};

const PEAKED_CHI_SQUARE: Kind = Kind {
    name: "chi-square of a peaked density",
    says: "points of density 4x³, rare cells pooled; defect: a checkerboard of cells",
    null: Null::Uniform,
    trial: |seed, defect| {
        square_trial(&PEAKED, seed, |stream| {
            let x = stream.uniform().powf(0.25);
            [x, checkered_row(stream, x, defect, SIDE)]
        })
    },
    resolution: stated,
};

const CONTRASTS: Kind = Kind {
    name: "chi-square of a smooth error",
    says: "uniform points of a square; defect: a density that rises evenly, which the low-order contrasts see",
    null: Null::Uniform,
    trial: |seed, defect| {
        square_trial(&UNIFORM, seed, |stream| [tilted(stream.uniform(), defect), stream.uniform()])
    },
    resolution: |_| UNIFORM.smooth_resolution(POINTS).expect("a density"),
};

const ATOMIC: Kind = Kind {
    name: "chi-square with atoms",
    says: "points of a square and of two atoms of probability 0.2 and 0.1; defect: a checkerboard of cells",
    null: Null::Uniform,
    trial: |seed, defect| {
        let (stream, mut histogram) = (Stream::of(seed), ATOMS.histogram());
        // The checkerboard's error counts by the share 0.7 of the points that are in cells.
        let defect = defect / 0.7_f64.sqrt();
        for _ in 0..POINTS {
            match stream.uniform() {
                choice if choice < 0.2 => histogram.add_atom(0),
                choice if choice < 0.3 => histogram.add_atom(1),
                _ => ATOMS.add(&mut histogram, checkered(&stream, defect, SIDE)),
            }
        }
        ATOMS.judge(&histogram, 0.5).expect("enough points")
    },
    resolution: stated,
};

const CUBE: Kind = Kind {
    name: "cube",
    says: "points of four dimensions through six projections; defect: a checkerboard of two axes",
    null: Null::Uniform,
    trial: |seed, defect| {
        let (stream, mut cube) = (Stream::of(seed), Cube::new(4).expect("four dimensions"));
        for _ in 0..POINTS {
            let [x, y] = checkered(&stream, defect, 16.0);
            cube.add(&[stream.uniform(), x, stream.uniform(), y]);
        }
        cube.judge(0.5).expect("enough points")
    },
    resolution: stated,
};

/// A number of density 1 + θ√3(2u − 1): F = u + θ√3(u² − u), solved for u.
fn tilted(v: f64, theta: f64) -> f64 {
    let a = theta * 3.0_f64.sqrt();
    if a == 0.0 { v } else { (((1.0 - a) * (1.0 - a) + 4.0 * a * v).sqrt() - (1.0 - a)) / (2.0 * a) }
}

/// A number whose distribution function is uniform but for a tooth of height `defect` at the median.
fn toothed(v: f64, defect: f64) -> f64 {
    // Where F(u) = ½ ± w + …: density 2 from ½ − d to ½, and none from ½ to ½ + d.
    if (0.5 - defect..0.5 + defect).contains(&v) { 0.5 * (v + 0.5 - defect) } else { v }
}

fn marginal(statistic: Statistic, sides: Sides, seed: u64, defect: f64) -> Evidence {
    let claim = Marginal { statistic, sides, values: 500, bound: 0.5, source: Source::Independent };
    let stream = Stream::of(seed);
    let value = |_, _| match statistic {
        Statistic::KolmogorovSmirnov => toothed(stream.uniform(), defect),
        Statistic::AndersonDarling => tilted(stream.uniform(), defect),
    };
    claim.evidence(&run(seed), value).expect("runs")
}

pub(crate) const KOLMOGOROV: Kind = Kind {
    name: "kolmogorov-smirnov",
    says: "500 uniform numbers; defect: a step of the distribution function at the median",
    null: Null::Uniform,
    trial: |seed, defect| marginal(Statistic::KolmogorovSmirnov, Sides::Upper, seed, defect),
    resolution: stated,
};

const KOLMOGOROV_BOTH: Kind = Kind {
    name: "kolmogorov-smirnov two-sided",
    says: "500 uniform numbers, too good a fit is wrong too; defect: a step at the median",
    null: Null::Uniform,
    trial: |seed, defect| marginal(Statistic::KolmogorovSmirnov, Sides::Both, seed, defect),
    resolution: stated,
};

const ANDERSON: Kind = Kind {
    name: "anderson-darling",
    says: "500 uniform numbers; defect: a density that rises evenly",
    null: Null::Uniform,
    trial: |seed, defect| marginal(Statistic::AndersonDarling, Sides::Upper, seed, defect),
    resolution: stated,
};

const ANDERSON_BOTH: Kind = Kind {
    name: "anderson-darling two-sided",
    says: "500 uniform numbers, too good a fit is wrong too; defect: a density that rises evenly",
    null: Null::Uniform,
    trial: |seed, defect| marginal(Statistic::AndersonDarling, Sides::Both, seed, defect),
    resolution: stated,
};

/// A pair with uniform margins and correlation ρ: density 1 + 3ρ(2x − 1)(2y − 1) (Farlie, Gumbel, Morgenstern), y being with
/// probability |3ρ(2x − 1)| the larger or the smaller of two.
fn correlated(stream: &Stream, rho: f64) -> [f64; 2] {
    let [x, y, other, choice] = [stream.uniform(), stream.uniform(), stream.uniform(), stream.uniform()];
    let slope = 3.0 * rho * (2.0 * x - 1.0);
    let extreme = if slope > 0.0 { y.max(other) } else { y.min(other) };
    [x, if choice < slope.abs() { extreme } else { y }]
}

const INDEPENDENCE: Kind = Kind {
    name: "independence",
    says: "2,000 pairs, 8 × 8 table; defect: a correlation",
    null: Null::Uniform,
    trial: |seed, rho| {
        let claim = IndependenceClaim { pairs: 2000, grid: 8, bound: 0.5, source: Source::Independent };
        let stream = Stream::of(seed);
        claim.evidence(&run(seed), |_, _| correlated(&stream, rho)).expect("enough pairs")
    },
    resolution: stated,
};

const TALLIES: Kind = Kind {
    name: "independence of many streams",
    says: "six pairs of four streams, 2,000 numbers each; defect: a correlation of one pair",
    null: Null::Uniform,
    trial: |seed, rho| {
        let streams: Vec<Stream> = (0..4).map(|k| Stream::of(derive(seed, 7, k))).collect();
        let mut tallies: Vec<([usize; 2], Tally)> = (0..4)
            .flat_map(|i| (i + 1..4).map(move |j| ([i, j], Tally::new(format!("{i} and {j}")))))
            .collect();
        for _ in 0..2000 {
            let [x, y] = correlated(&streams[0], rho);
            let numbers = [x, y, streams[2].uniform(), streams[3].uniform()];
            tallies.iter_mut().for_each(|([i, j], tally)| tally.push([numbers[*i], numbers[*j]]));
        }
        judge_tallies(&tallies.into_iter().map(|(_, tally)| tally).collect::<Vec<_>>(), 0.5)
            .expect("enough pairs")
    },
    resolution: stated,
};

const SHARE: Kind = Kind {
    name: "share of misses",
    says: "700 trials that never miss, so that nothing is left to chance and p is 1; defect: a share of misses",
    null: Null::Never,
    trial: |seed, share| {
        let stream = Stream::of(seed);
        let misses = (0..700).filter(|_| stream.uniform() < share).count() as u64;
        share::judge("share", misses, 700, 0.5).expect("trials")
    },
    resolution: stated,
};

macro_rules! tests {
    ($($name:ident: $kind:ident,)*) => { $(#[test] fn $name() { check(&$kind); })* };
}

tests! {
    chi_square: CHI_SQUARE,
    chi_square_of_a_peaked_density: PEAKED_CHI_SQUARE,
    chi_square_of_a_smooth_error: CONTRASTS,
    chi_square_with_atoms: ATOMIC,
    cube: CUBE,
    kolmogorov_smirnov: KOLMOGOROV,
    kolmogorov_smirnov_two_sided: KOLMOGOROV_BOTH,
    anderson_darling: ANDERSON,
    anderson_darling_two_sided: ANDERSON_BOTH,
    independence: INDEPENDENCE,
    independence_of_many_streams: TALLIES,
    share_of_misses: SHARE,
}
