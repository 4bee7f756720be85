//! How fast the samplers' errors fall: slopes and variances against the exact ones of their families.

use renderer::sampling::{Decision, DecisionSet, SampleId, Sampler, SamplerKind, Vertex};
use verify::claim::{Claim, Run, claim};
use verify::convergence::SlopeClaim;
use verify::error::InputError;
use verify::integrands::Integrand;
use verify::mean::{MeanClaim, joint_control, joint_evidence};
use verify::seeds::derive;

use super::sampler::level;
use crate::bounds;
use crate::setup::sampler;
use crate::wrong::samplers::{Confused, in_pairs, repeating_after_64};

/// Sample counts: powers of four, so that each makes a square grid and a whole net.
const COUNTS: [u32; 4] = [16, 64, 256, 1024];

/// Replicates for a slope, at each sample count.
const REPLICATES: u64 = 600;

/// Sample counts at which variances are compared.
const VARIANCE_COUNTS: [u32; 2] = [16, 64];

/// Replicates for a variance: 64 means over 64 squared errors each, so that the means are close to normal.
const SQUARES: u64 = 64;

/// Integrands by their names in ids.
const INTEGRANDS: [(&str, &str); 3] =
    [("disk", "quarterdisk"), ("gaussian", "quartergaussian"), ("bilinear", "bilinear")];

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let of_kind = |kind: SamplerKind| {
        let slopes = INTEGRANDS.map(|(short, name)| slope(kind, short, integrand(name)));
        let all = slopes.into_iter().chain([variance(kind)]);
        all.map(|claim| claim.from_level(level(kind))).collect::<Vec<_>>()
    };
    KINDS.into_iter().flat_map(of_kind).collect()
}

/// The samplers whose variances are known exactly.
const KINDS: [SamplerKind; 4] =
    [SamplerKind::Independent, SamplerKind::Stratified, SamplerKind::Sobol, SamplerKind::Pmj02];

fn integrand(name: &str) -> Integrand {
    Integrand::named(name).expect("the integrands of this file are in the list")
}

/// One replicate's mean of an integrand over a number of samples, from a seed.
type Mean = fn(&Integrand, u32, u64) -> f64;

/// The mean of the integrand over a pixel's first `n` points.
fn mean_over(sampler: &dyn Sampler, integrand: &Integrand, n: u32) -> f64 {
    let value = |index: u32| {
        let sample = SampleId { pixel: [3, 1], replicate: 0, index };
        integrand.eval(sampler.draw_2d(sample, Vertex::default(), Decision::Pixel).map(f64::from))
    };
    (0..n).map(value).sum::<f64>() / f64::from(n)
}

fn mean_of(kind: SamplerKind, integrand: &Integrand, n: u32, seed: u64) -> f64 {
    mean_over(&*sampler(kind, seed, DecisionSet::EMPTY.with(Decision::Pixel), n), integrand, n)
}

/// The exact variance of the mean over `n` points of the sampler's family: independent points, jitter on a square grid, Owen-scrambled nets.
fn exact_variance(kind: SamplerKind, integrand: &Integrand, n: u32) -> f64 {
    match kind {
        SamplerKind::Independent => integrand.random_variance(u64::from(n)),
        SamplerKind::Stratified => integrand.jitter_variance(n.isqrt()),
        _ => integrand.net_variance(n.ilog2()),
    }
}

/// The least-squares slope of the exact ln RMSE at [`COUNTS`].
///
/// That is −½ for independent points. For the others it is what the asymptotic law comes to over these counts: of the disk −0.72 under
/// jitter (law −¾) and −0.76 under nets (−¾); of the bilinear and the Gaussian function −1.00 under jitter (−1), and −1.41 and −1.44 under
/// nets (−3/2 and the root of a logarithm). Where the errors are no exact power of N, the slope depends a little on how the fit weighs the
/// counts; kurtoses of the errors that differ by a fifth move it by less than 0.001, a ninth of the standard error.
fn theory(kind: SamplerKind, integrand: &Integrand) -> f64 {
    let points = COUNTS.map(|n| (f64::from(n).ln(), 0.5 * exact_variance(kind, integrand, n).ln()));
    let count = COUNTS.len() as f64;
    let centre = points.iter().map(|(x, _)| x).sum::<f64>() / count;
    let spread: f64 = points.iter().map(|(x, _)| (x - centre).powi(2)).sum();
    points.iter().map(|(x, y)| (x - centre) * y).sum::<f64>() / spread
}

fn slope(kind: SamplerKind, short: &str, integrand: Integrand) -> Claim {
    let test = move || SlopeClaim {
        name: format!("{}, {}", kind.name(), integrand.name),
        exact: integrand.integral(),
        counts: COUNTS.map(u64::from).into(),
        replicates: REPLICATES,
        theory: theory(kind, &integrand),
        bound: bounds::SLOPE,
    };
    let count = |n: u64| u32::try_from(n).expect("the counts of this file are below 2^32");
    let subject = move |n: u64, seed: u64| mean_of(kind, &integrand, count(n), seed);
    let (mistake, wrong): (_, Mean) = match kind {
        SamplerKind::Independent => ("numbers that repeat after 64 samples", |integrand, n, seed| {
            let inner = sampler(SamplerKind::Independent, seed, DecisionSet::EMPTY, n);
            mean_over(&Confused { inner, question: repeating_after_64 }, integrand, n)
        }),
        _ => ("independent numbers", |integrand, n, seed| {
            mean_of(SamplerKind::Independent, integrand, n, seed)
        }),
    };
    let says = format!(
        "the error of {} points on the {short} function falls with the sample count as theory says",
        kind.name()
    );
    claim(format!("convergence/{}/{short}", kind.name()), says)
        .rejects("2.2 × resolution", move |run| test().control(run, subject))
        .rejects(mistake, move |run| test().evidence(run, |n, seed| wrong(&integrand, count(n), seed)))
        .by(move |run| test().evidence(run, subject))
}

/// The integrand and sample count of configuration `i` of a variance claim.
fn configuration(i: usize) -> (Integrand, u32) {
    let counts = VARIANCE_COUNTS.len();
    (integrand(INTEGRANDS[i / counts].1), VARIANCE_COUNTS[i % counts])
}

/// The claim that squared errors have the mean that the family's exact variance is.
fn variance(kind: SamplerKind) -> Claim {
    let tests = move || {
        let one = |i: usize| {
            let (integrand, n) = configuration(i);
            let exact = exact_variance(kind, &integrand, n);
            MeanClaim { replicates: SQUARES, ..MeanClaim::relative(exact, bounds::VARIANCE) }
        };
        (0..INTEGRANDS.len() * VARIANCE_COUNTS.len()).map(one).collect::<Vec<_>>()
    };
    let squares =
        |subject: &dyn Fn(&Integrand, u32, u64) -> f64, (integrand, n): (Integrand, u32), seed: u64| {
            let square = |i| (subject(&integrand, n, derive(seed, 0, i)) - integrand.integral()).powi(2);
            (0..SQUARES).map(square).sum::<f64>() / SQUARES as f64
        };
    let right = move |i: usize, seed: u64| {
        squares(&|integrand, n, seed| mean_of(kind, integrand, n, seed), configuration(i), seed)
    };
    let (mistake, wrong): (_, Mean) = match kind {
        SamplerKind::Independent => ("samples in pairs of the same numbers", |integrand, n, seed| {
            let inner = sampler(SamplerKind::Independent, seed, DecisionSet::EMPTY, n);
            mean_over(&Confused { inner, question: in_pairs }, integrand, n)
        }),
        _ => ("independent numbers", |integrand, n, seed| {
            mean_of(SamplerKind::Independent, integrand, n, seed)
        }),
    };
    let family = match kind {
        SamplerKind::Independent => "σ²/N",
        SamplerKind::Stratified => "that of one point in each cell of a grid",
        _ => "that of Owen-scrambled nets",
    };
    let says = format!(
        "the variance of means over {} points is {family}, on three integrands at two counts",
        kind.name()
    );
    claim(format!("convergence/{}/variance", kind.name()), says)
        .rejects("2.2 × resolution", move |run: &Run| joint_control(&tests(), run, right))
        .rejects(mistake, move |run| -> Result<_, InputError> {
            joint_evidence(&tests(), run, |i, seed| squares(&wrong, configuration(i), seed))
        })
        .by(move |run| joint_evidence(&tests(), run, right))
}
