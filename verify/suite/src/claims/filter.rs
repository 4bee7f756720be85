//! Pixel filters: where samples fall, recorded from renders, and what their weights average to.

use std::sync::Arc;

use glam::DVec3;
use renderer::film::{FilmSettings, Filter, FilterSampler};
use renderer::integrator::batch::{Path, Sample};
use renderer::sampling::Decision;
use renderer::scene::{IntegratorSettings, Scene};
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, Level, claim};
use verify::domain::Parallelogram;
use verify::filter::Kernel;
use verify::mean::{MeanClaim, joint_control, joint_evidence};
use verify::points;
use verify::quadrature::{Tolerance, integrate};

mod constant;
mod edge;
mod wave;
mod weighted;

use super::pointwise::single;
use super::recorded::{Recorded, Wrong};
use crate::bounds;
use crate::setup::{built, spot};

/// Every filter with its name, and a version of it that is a little wrong.
const FILTERS: [(&str, Filter, Filter); 6] = [
    ("box", Filter::Box { radius: 0.5 }, Filter::Box { radius: 0.51 }),
    ("tent", Filter::Tent { radius: 1.0 }, Filter::Tent { radius: 0.98 }),
    ("gaussian", Filter::Gaussian { stddev: 0.5 }, Filter::Gaussian { stddev: 0.49 }),
    ("mitchell", Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }, Filter::Mitchell { b: 0.3, c: 0.35 }),
    ("catmull-rom", Filter::Mitchell { b: 0.0, c: 0.5 }, Filter::Mitchell { b: 0.04, c: 0.48 }),
    ("lanczos", Filter::Lanczos { lobes: 3.0 }, Filter::Lanczos { lobes: 2.9 }),
];

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    FILTERS
        .into_iter()
        .flat_map(|(name, filter, wrong)| {
            let level = if LATER.contains(&name) { Level::Standard } else { Level::Quick };
            [
                distribution((name, level), filter, wrong),
                weight((name, level), filter),
                edge::any_angle(name, filter),
                wave::response(name, filter),
                constant::mean_and_variance(name, filter),
            ]
        })
        .chain([edge::representative(), wave::zone_plate()])
        .chain(weighted::claims())
        .map(|claim| claim.same_up_to(Level::Standard))
        .collect()
}

/// Filters of a family that another one represents at the quick level.
const LATER: [&str; 2] = ["catmull-rom", "lanczos"];

/// The closed form of a filter.
fn kernel(filter: Filter) -> Kernel {
    match filter {
        Filter::Box { radius } => Kernel::Box { radius },
        Filter::Tent { radius } => Kernel::Tent { radius },
        Filter::Gaussian { stddev } => Kernel::Gaussian { stddev, radius: 4.0 * stddev },
        Filter::Mitchell { b, c } => Kernel::Cubic { b, c },
        Filter::Lanczos { lobes } => Kernel::Lanczos { radius: lobes },
    }
}

fn scene(filter: Filter) -> Scene {
    let mut description = spot(DVec3::ZERO, DVec3::Z, Vec::new(), IntegratorSettings::DIRECT);
    description.film = FilmSettings { width: 64, height: 64, filter, ..description.film };
    built(&description)
}

/// Distance of a sample from its pixel's middle.
fn offset(_: &Scene, sample: &Sample, _: &Path) -> Option<[f64; 2]> {
    Some(std::array::from_fn(|i| sample.position[i] - f64::from(sample.id.pixel[i]) - 0.5))
}

fn distribution((name, level): (&'static str, Level), filter: Filter, wrong: Filter) -> Claim {
    let radius = filter.radius();
    let mass = absolute_mass(filter);
    let domain = Parallelogram::rectangle([-radius; 2], [radius; 2]).expect("the radius is above 0");
    let recorded = Recorded {
        target: ChiSquare::on(domain)
            .density(move |p: [f64; 2]| p.map(|x| filter.eval(x).abs() / mass).iter().product()),
        decision: Decision::Pixel,
        scene: scene(filter),
        read: offset,
        bound: bounds::RECORDED,
    };
    let builder = claim(
        format!("filter/{name}/distribution"),
        format!("samples of a render lie in the {name} filter with the density |f| / ∫|f|"),
    );
    recorded
        .claim(
            builder,
            Wrong {
                name: "a filter with slightly other parameters",
                scene: Some(scene(wrong)),
                read: offset,
            },
        )
        .from_level(level)
}

/// ∫|f| along one axis, per pixel width.
fn absolute_mass(filter: Filter) -> f64 {
    let radius = filter.radius();
    let pieces = 64;
    let tolerance = Tolerance { relative: 1e-10, absolute: 1e-14, pieces: 10_000 };
    (0..pieces)
        .map(|i| {
            let at = |k: i32| radius * (2.0 * f64::from(k) / f64::from(pieces) - 1.0);
            integrate(&|x| filter.eval(x).abs(), [at(i), at(i + 1)], tolerance).value
        })
        .sum()
}

/// Weighted samples average to the filter's own integrals: ∫f·g / ∫f for g = 1, x², |x|.
fn weight((name, level): (&'static str, Level), filter: Filter) -> Claim {
    let moments: [fn(f64) -> f64; 3] = [|_| 1.0, |x| x * x, f64::abs];
    let radius = filter.radius();
    let integral = move |g: fn(f64) -> f64| {
        let tolerance = Tolerance { relative: 1e-12, absolute: 1e-16, pieces: 10_000 };
        let f = |x: f64| filter.eval(x) * g(x);
        // no kink of any filter lies inside these halves' quarters
        (0..8)
            .map(|i| f64::from(i) / 8.0 * radius)
            .map(|a| 2.0 * integrate(&f, [a, a + radius / 8.0], tolerance).value)
            .sum::<f64>()
    };
    let exact = moments.map(|g| integral(g) / integral(moments[0]));
    let claims: Vec<MeanClaim> = exact
        .into_iter()
        // weights and positions are f32
        .map(|e| MeanClaim {
            rounding: 8.0 * f64::from(f32::EPSILON),
            ..MeanClaim::in_units_of(1.0, e, bounds::FILTER_MOMENT)
        })
        .collect();
    let sampler = FilterSampler::new(filter).expect("the filters of claims are valid");
    let estimate = move |moment: usize, seed: u64, stretch: f64| {
        let n = 4096;
        let draw = |i: u32| {
            let [mut u, mut turn] = [[0.0]; 2];
            points::fill(seed, u64::from(i), &mut u);
            // all strata turned together, so that no jump of the filter has the same place in its stratum each time
            points::fill(seed, u64::from(n), &mut turn);
            let (x, w) = sampler.sample(single(((f64::from(i) + u[0]) / f64::from(n) + turn[0]).fract()));
            f64::from(w) * moments[moment](stretch * f64::from(x))
        };
        (0..n).map(draw).sum::<f64>() / f64::from(n)
    };
    let estimate = Arc::new(estimate);
    let (control, stretched) = (estimate.clone(), estimate.clone());
    let claims = Arc::new(claims);
    let (claims2, claims3) = (claims.clone(), claims.clone());
    claim(
        format!("filter/{name}/weight"),
        format!("weighted samples of the {name} filter average to its integrals against 1, x² and |x|"),
    )
    .bound(bounds::FILTER_MOMENT)
    .rejects("2.2 × resolution", move |run| joint_control(&claims2, run, |i, seed| control(i, seed, 1.0)))
    .rejects("positions 1 % too far", move |run| {
        joint_evidence(&claims3, run, |i, seed| stretched(i, seed, 1.01))
    })
    .by(move |run| joint_evidence(&claims, run, |i, seed| estimate(i, seed, 1.0)))
    .from_level(level)
}
