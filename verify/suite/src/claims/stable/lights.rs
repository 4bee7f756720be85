//! Lights whose cone or image is extreme, and weights of pixel filters.

use std::f64::consts::{PI, TAU};

use glam::{DAffine3, DMat3, DVec3, Vec3};
use renderer::film::{Filter, FilterSampler};
use renderer::lights::{Environment, Spot};
use renderer::math::Rgb;
use renderer::shapes::{Shape, ShapeSettings};

use super::Entry;
use super::routine::{ROUNDING, ROUNDING_F64, Routine, single};
use super::tables;

pub(super) fn entries() -> Vec<Entry> {
    vec![SPHERE.into(), SPHERE_PLACE.into(), SPOT.into(), ENVIRONMENT.into(), FILTER.into()]
}

/// The unit ball.
fn ball() -> Option<Shape> {
    let settings = ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 };
    Shape::new(&settings, &DAffine3::IDENTITY, false).ok()
}

/// 1 − cos of the half angle under which a ball is seen from `distance` radii away.
fn height(distance: f64) -> f64 {
    1.0 / (distance * distance) / (1.0 + ((distance - 1.0) * (distance + 1.0)).sqrt() / distance)
}

const SPHERE: Routine<1, 1> = Routine {
    id: "solid-angle/sphere",
    says: "solid angles of balls keep their digits from 1e-12 sr to the hemisphere, seen from 1 + 1e-9 to 1e6 radii",
    unit: "roundings of 2⁻²⁴",
    bound: 0.01, // In f64: the sine has 2⁻⁵³, at 1 + 1e-9 that is 1e-7 of 1 − sin² and 2e-12 of 1 − cos.
    one: |_, [exact]| [ROUNDING * exact],
    table: tables::SPHERE_SOLID_ANGLE,
    corners: &[[1.000_000_001], [2.0], [1e6]],
    draw: |n| [1.0 + n.log(1e-9, 1e6)],
    draws: 2048,
    exact: |[distance]| {
        let half = 0.5 * (1.0 / distance).atan2(((distance - 1.0) * (distance + 1.0)).sqrt() / distance);
        [2.0 * TAU * half.sin() * half.sin()]
    },
    ours: |[distance]| {
        let pdf = ball().and_then(|ball| ball.pdf_solid_angle(0, DVec3::new(0.0, 0.0, *distance)));
        [pdf.map_or(f64::NAN, |pdf| 1.0 / pdf)]
    },
    naive: ("1 − √(1 − sin²) in single precision", |[distance]| {
        let sine = 1.0 / single(*distance);
        [f64::from(std::f32::consts::TAU * (1.0 - (1.0 - sine * sine).sqrt()))]
    }),
};

/// 1 − cos of the angle between the axis and the direction to a point `aside` of it and `along`.
fn opened(aside: f64, along: f64) -> f64 {
    let sine = aside / aside.hypot(along);
    sine * sine / (1.0 + along / aside.hypot(along))
}

const SPHERE_PLACE: Routine<3, 1> = Routine {
    id: "solid-angle/sphere-sampler",
    says: "the sampler of a ball leaves the share u of its solid angle nearer to the axis, seen from 1.001 to 1e6 radii",
    unit: "2⁻²⁴ and the same over the distance in radii",
    bound: 2.0, // Three coordinates are rounded by 2⁻²⁵ of 1 each: 0.87 together; the share turns by at most twice that.
    one: |[distance, _, _], _| [ROUNDING * (1.0 + 1.0 / (distance - 1.0))],
    table: tables::NONE,
    corners: &[[1e6, 0.999_999_940_395_355_2, 0.25], [1.001, 0.5, 0.0], [2.0, 0.0, 0.0]],
    draw: |n| [1.0 + n.log(1e-3, 1e6), n.sampler(), n.unit()].map(|x| f64::from(single(x))),
    draws: 2048,
    exact: |[_, u, _]| [*u],
    ours: |[distance, u, v]| {
        let from = DVec3::new(0.0, 0.0, *distance);
        let place = ball().and_then(|ball| ball.sample_solid_angle(from, [*u, *v].map(single)));
        [place.map_or(f64::NAN, |(surface, _)| {
            let p = surface.point.as_dvec3();
            opened(p.x.hypot(p.y), distance - p.z) / height(*distance)
        })]
    },
    naive: ("cos by difference in single precision", |[distance, u, _]| {
        let sine = 1.0 / single(*distance);
        let cos = 1.0 - single(*u) * (1.0 - (1.0 - sine * sine).sqrt());
        [f64::from(1.0 - cos) / height(*distance)]
    }),
};

/// The axis of the spots: its components are not round in binary.
const AXIS: Vec3 = Vec3::new(0.36, 0.48, 0.8);

const SPOT: Routine<5, 1> = Routine {
    id: "spot/cutoff-0.1-to-180",
    says: "a spot's intensity falls off linearly in the angle, for cones of 0.1° to 180°",
    unit: "roundings of 2⁻²⁴ of the cutoff over the transition",
    bound: 16.0, // Chords 4 each and their ratio 1, atan2 2; both half angles 1½, two differences and the quotient 3.
    one: |[beam, cutoff, ..], _| [ROUNDING * cutoff / (cutoff - beam)],
    table: tables::NONE,
    corners: &[[0.0, 180.0, -0.36, -0.48, -0.8], [5.0, 10.0, 0.36, 0.48, 0.8]],
    draw: |n| {
        let cutoff = n.log(0.1, 180.0);
        let beam = cutoff * n.between(0.0, 0.95);
        let angle = (cutoff * n.between(0.0, 1.05)).min(180.0).to_radians();
        let axis = AXIS.as_dvec3().normalize();
        let (x, y) = axis.any_orthonormal_pair();
        let (sin, cos) = (TAU * n.unit()).sin_cos();
        let w = angle.cos() * axis + angle.sin() * (cos * x + sin * y);
        [beam, cutoff, w.x, w.y, w.z].map(|x| f64::from(single(x)))
    },
    draws: 2048,
    exact: |[beam, cutoff, x, y, z]| {
        let (w, axis) = (DVec3::new(*x, *y, *z), AXIS.as_dvec3());
        let angle = w.cross(axis).length().atan2(w.dot(axis)).to_degrees();
        [((cutoff - angle) / (cutoff - beam)).clamp(0.0, 1.0)]
    },
    ours: |x| {
        let [beam, cutoff, x, y, z] = x.map(single);
        let spot = Spot::new(Vec3::ZERO, AXIS, Rgb::WHITE, [beam, cutoff]);
        [spot.map_or(f64::NAN, |spot| f64::from(spot.towards(Vec3::new(x, y, z)).g))]
    },
    naive: ("arc cosine in single precision", |x| {
        let [beam, cutoff, x, y, z] = x.map(single);
        let angle = Vec3::new(x, y, z).dot(AXIS).clamp(-1.0, 1.0).acos().to_degrees();
        [f64::from(((cutoff - angle) / (cutoff - beam)).clamp(0.0, 1.0))]
    }),
};

/// Columns and rows of the map.
const MAP: [usize; 2] = [4, 3];

/// Cells between them: as many columns, and one row less.
const CELLS: usize = MAP[0] * (MAP[1] - 1);

fn indices([i, j]: [f64; 2]) -> [usize; 2] {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a column and a row")]
    [i as usize, j as usize]
}

/// The mean of a cell: linear between the middles of columns and between rows.
fn cell(pixels: &[f64], i: usize, j: usize) -> f64 {
    let [columns, _] = MAP;
    let row = |j: usize| {
        let at = |step: usize| pixels[j * columns + (i + step) % columns];
        0.125 * at(columns - 1) + 0.75 * at(0) + 0.125 * at(1)
    };
    0.5 * (row(j) + row(j + 1))
}

/// The direction in the map's cell of the last four numbers: column, row, and where in it.
fn direction(x: &[f64; 16]) -> Vec3 {
    let theta = PI * (x[13] + x[15]) / 2.0;
    let (sin, cos) = (TAU * (x[12] + x[14]) / MAP[0] as f64).sin_cos();
    DVec3::new(sin * theta.sin(), theta.cos(), -cos * theta.sin()).as_vec3()
}

/// 2π² sin θ: what a density over the unit square is divided by.
fn stretched(x: &[f64; 16]) -> f64 {
    let w = direction(x).as_dvec3();
    2.0 * PI * PI * w.x.hypot(w.z)
}

const ENVIRONMENT: Routine<16, 1> = Routine {
    id: "environment/pixels-1e-30-to-1e30",
    says: "densities of environment maps are right beside pixels from 1e-30 to 1e30, and black ones",
    unit: "roundings of 2⁻²⁴, and of 2⁻⁵³ of the whole",
    bound: 16.0, // A cell's mean 5 and the total's as many; both shares 1 each, product, quotient and sin θ 3.
    one: |x, [exact]| [ROUNDING * exact + ROUNDING_F64 * CELLS as f64 / stretched(x)],
    table: tables::NONE,
    corners: &[],
    draw: |n| {
        let mut x = [0.0; 16];
        x[..12].fill_with(|| f64::from(single(n.one_of([0.0, 1.0, 1.0]) * n.log(1e-30, 1e30))));
        x[0] = x[0].max(f64::from(single(1e-30)));
        x[12] = (4.0 * n.unit()).floor();
        x[13] = (2.0 * n.unit()).floor();
        x[14] = n.between(0.01, 0.99);
        x[15] = n.between(0.01, 0.99);
        x
    },
    draws: 512,
    exact: |x| {
        let mut means: Vec<f64> = (0..CELLS).map(|k| cell(x, k % MAP[0], k / MAP[0])).collect();
        let [i, j] = indices([x[12], x[13]]);
        let own = means[j * MAP[0] + i];
        // Rows at the poles and the equator: all cells are of one solid angle. From the smallest on, little is lost.
        means.sort_by(f64::total_cmp);
        [own / means.iter().sum::<f64>() * CELLS as f64 / stretched(x)]
    },
    ours: |x| {
        let pixels = x[..12].iter().map(|&p| Rgb::splat(single(p))).collect();
        let map = Environment::new(MAP, pixels, DMat3::IDENTITY);
        [map.map_or(f64::NAN, |map| f64::from(map.pdf(direction(x))))]
    },
    naive: ("cumulated in single precision", |x| {
        let mut sum = 0.0f32;
        let mut sums = vec![0.0f32];
        for k in 0..CELLS {
            sum += single(cell(x, k % MAP[0], k / MAP[0]));
            sums.push(sum);
        }
        let [i, j] = indices([x[12], x[13]]);
        let k = j * MAP[0] + i;
        [f64::from((sums[k + 1] - sums[k]) / sum) * CELLS as f64 / stretched(x)]
    }),
};

/// Numbers over which a filter's weight is averaged.
const GRID: u32 = 1 << 13;

fn filter([kind, a, b]: &[f64; 3]) -> Filter {
    match kind {
        0.0 => Filter::Tent { radius: *a },
        1.0 => Filter::Gaussian { stddev: *a },
        2.0 => Filter::Mitchell { b: *a, c: *b },
        _ => Filter::Lanczos { lobes: *a },
    }
}

/// The mean of a filter's weights over evenly spaced numbers.
fn mean_weight(x: &[f64; 3], of: fn(f32) -> f32) -> [f64; 1] {
    let Ok(sampler) = FilterSampler::new(filter(x)) else { return [f64::NAN] };
    let weight = |i: u32| f64::from(of(sampler.sample((i as f32 + 0.5) / GRID as f32).1));
    [(0..GRID).map(weight).sum::<f64>() / f64::from(GRID)]
}

const FILTER: Routine<3, 1> = Routine {
    id: "filter/normalised",
    says: "weights of tents, Gaussians and filters with negative lobes, narrow, wide and of many lobes, average to 1",
    unit: "variation of the weight over the grid",
    bound: 1.0, // The midpoint rule is off by at most the function's variation over the number of points.
    // The weight is of one size, ∫|f|/∫f, and turns over at each change of sign: of a cubic at most 1.4, of a lobes at most
    // 1 + 0.4·ln a (2.6 of 64), where it also wavers by 2 % between the eight knots of a lobe, 0.3 a lobe.
    one: |[kind, a, _], _| {
        let variation = match kind {
            0.0 | 1.0 => 2.8,
            2.0 => 2.8 * 3.0,
            _ => 2.3 * (1.0 + 0.4 * a.ln()) * (2.0 * a + 1.0),
        };
        [variation / f64::from(GRID)]
    },
    table: tables::NONE,
    corners: &[
        [2.0, 0.0, 1.0],
        [2.0, 1.0, 0.0],
        [3.0, 1.0, 0.0],
        [3.0, 8.0, 0.0],
        [3.0, 64.0, 0.0],
        [1.0, 1e-3, 0.0],
        [1.0, 1e3, 0.0],
    ],
    draw: |n| {
        let kind = n.one_of([0.0, 1.0, 2.0, 3.0]);
        let (wide, unit, lobes) = (n.log(1e-3, 1e3), n.unit(), n.log(1.0, 64.0));
        [kind, [wide, wide, unit, lobes][indices([kind, 0.0])[0]], n.unit()]
    },
    draws: 4,
    exact: |_| [1.0],
    ours: |x| mean_weight(x, |w| w),
    naive: ("weights without their sign", |x| mean_weight(x, f32::abs)),
};
