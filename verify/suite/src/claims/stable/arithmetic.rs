//! Numbers from bits, differences of products, weights, choices, sums.

use std::sync::LazyLock;

use renderer::film::{Film, FilmSettings, Filter, PixelSum, Reconstruction};
use renderer::math::Rgb;
use renderer::math::float::{difference_of_products, unit_f32, unit_f64};
use renderer::math::spherical::turn;
use renderer::sampling::Discrete;
use renderer::sampling::mis::power_heuristic;
use verify::claim::{Claim, Level};

use super::Entry;
use super::numbers::Numbers;
use super::routine::{ROUNDING, ROUNDING_F64, Routine, single, ulp, ulps};
use super::tables;

pub(super) fn entries() -> Vec<Entry> {
    vec![
        UNIT_F64.into(),
        DIFFERENCE.into(),
        POWER.into(),
        TURN.into(),
        DISCRETE.into(),
        POSITION.into(),
        SUM.into(),
        ERROR_OF_MEAN.into(),
    ]
}

/// The sums of more terms than a quick run has time for.
pub(super) fn long_sums() -> Vec<Claim> {
    let million = Routine {
        id: "standard-error/million-parts",
        says: "the standard error from a million parts whose mean is a million times their spread keeps its digits",
        bound: 1.2e-10, // As for 16,384 parts: 10⁶·2⁻⁵³ = 1.1e-10.
        corners: &[[4.0, 1_000_000.0]],
        draws: 0,
        ..ERROR_OF_MEAN
    };
    let billion = Routine {
        id: "accumulation/billion-samples",
        says: "a pixel's mean over 10⁹ samples from 1e-6 to 1e6 keeps its digits",
        bound: 33.0, // A tree of depth 30, the sum of its parts in two roundings and the quotient.
        corners: &[[2.0, 1e9]],
        draws: 0,
        ..SUM
    };
    vec![million.claim().from_level(Level::Standard), billion.claim().from_level(Level::Exhaustive)]
}

fn bits([high, low]: &[f64; 2]) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "halves of a word")]
    let word = (*high as u64) << 32 | *low as u64;
    word
}

const UNIT_F64: Routine<2, 1> = Routine {
    id: "unit-f64/every-bits",
    says: "64 random bits become the multiple of 2⁻⁵³ at or below bits/2⁶⁴, and never 1",
    unit: "steps of 2⁻⁵³",
    bound: 0.5, // The value is exact: any other multiple is a whole step away.
    one: |_, _| [ROUNDING_F64],
    table: tables::NONE,
    corners: &[
        [0.0, 0.0],
        [4_294_967_295.0, 4_294_967_295.0],
        [4_294_967_295.0, 4_294_966_272.0],
        [0.0, 2048.0],
    ],
    draw: |n| {
        let half = |n: &Numbers| (4_294_967_296.0 * n.unit()).floor();
        [half(n), half(n)]
    },
    draws: 4096,
    // The upper half and what is left of the lower one are added as numbers; both are exact.
    exact: |[high, low]| [high / 4_294_967_296.0 + (low / 2048.0).floor() * ROUNDING_F64],
    ours: |x| [unit_f64(bits(x))],
    naive: ("all 64 bits over 2⁶⁴", |x| [bits(x) as f64 / 18_446_744_073_709_551_616.0]),
};

const DIFFERENCE: Routine<4, 1> = Routine {
    id: "difference-of-products/cancelling",
    says: "a·b − c·d is right to 1.5 units in the last place however much cancels",
    unit: "ulp",
    bound: 1.501, // 1.5 by theorem 1.1 of Jeannerod, Louvet, Muller 2013, which is reached; f64 rounds the exact value once.
    one: ulps,
    table: tables::DIFFERENCE_OF_PRODUCTS,
    corners: &[[1.0, 1.0, 1.0, 1.0], [3.0, 7.0, 7.0, 3.0]],
    draw: |n| {
        let [a, b, c] = [(); 3].map(|()| f64::from(single(n.sign() * n.log(1e-3, 1e3))));
        let d = f64::from(single(a * b / c * (1.0 + n.sign() * n.log(1e-8, 1.0))));
        [a, b, c, d]
    },
    draws: 4096,
    exact: |[a, b, c, d]| [a * b - c * d],
    ours: |x| {
        let [a, b, c, d] = x.map(single);
        [f64::from(difference_of_products(a, b, c, d))]
    },
    naive: ("a·b − c·d", |x| {
        let [a, b, c, d] = x.map(single);
        [f64::from(a * b - c * d)]
    }),
};

const POWER: Routine<2, 1> = Routine {
    id: "power-heuristic/every-density",
    says: "the power heuristic's weight of densities from 1e-44 to 3e38 neither overflows nor loses digits",
    unit: "roundings of 2⁻²⁴, or 2⁻¹²⁸",
    bound: 5.0, // The ratio has 1, its square 3, the sum 4 and the inverse 5.
    // A ratio's square overflows from 2¹²⁸ on, where the weight becomes 0.
    one: |_, [weight]| [(ROUNDING * weight).max(2f64.powi(-128))],
    table: tables::POWER_HEURISTIC,
    corners: &[[1e-30, 1e30], [1e30, 1e30], [3e38, 1e-44]],
    draw: |n| [n.log(1e-44, 3e38), n.log(1e-44, 3e38)].map(|x| f64::from(single(x))),
    draws: 4096,
    exact: |[a, b]| [1.0 / (1.0 + (b / a) * (b / a))],
    ours: |x| {
        let [a, b] = x.map(single);
        [f64::from(power_heuristic(a, b))]
    },
    naive: ("a²/(a² + b²)", |x| {
        let [a, b] = x.map(single);
        [f64::from(a * a / (a * a + b * b))]
    }),
};

const TURN: Routine<2, 1> = Routine {
    id: "azimuth/seam",
    says: "an azimuth is a share of the full turn below 1, also just before the seam",
    unit: "roundings of 1",
    bound: 3.0, // atan2 has 1 of π, the constant ½, the quotient and the sum with 1 a rounding each, of at most 1.
    one: |_, _| [ROUNDING],
    table: tables::NONE,
    corners: &[[1.0, -1e-30], [1.0, -1e-9], [-1.0, 0.0], [0.0, 0.0], [0.0, -1.0], [1e-40, -1e-45]],
    draw: |n| {
        let [x, y] = [n.sign() * n.log(1e-30, 1.0), n.sign() * n.log(1e-30, 1.0)];
        [x, y].map(|c| f64::from(single(c)))
    },
    draws: 4096,
    // 1 itself is a wrong answer, and so the last turns go to 0 as theirs does.
    exact: |[x, y]| {
        let (x, y) = (f64::from(single(*x)), f64::from(single(*y)));
        let turns = y.atan2(x) / std::f64::consts::TAU;
        let turns = if turns < 0.0 { turns + 1.0 } else { turns };
        [if turns >= 1.0 - 0.5 * ROUNDING { 0.0 } else { turns }]
    },
    ours: |x| {
        let [x, y] = x.map(single);
        [f64::from(turn(x, y))]
    },
    naive: ("atan2/2π, and 1 more where negative", |x| {
        let [x, y] = x.map(single);
        let turn = y.atan2(x) / std::f32::consts::TAU;
        [f64::from(if turn < 0.0 { turn + 1.0 } else { turn })]
    }),
};

fn weights(x: &[f64; 9]) -> (&[f64], usize) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of 0 to 7")]
    let index = x[8] as usize;
    (&x[..8], index)
}

const DISCRETE: Routine<9, 1> = Routine {
    id: "discrete/weights-1e-30-to-1e30",
    says: "shares of weights from 1e-30 to 1e30, of one alone and of zeros are right, and 0 for 0",
    unit: "half a last place, or 16 roundings of f64",
    bound: 1.0, // Eight sums and a difference of them, each within 2⁻⁵³ of the total, and the rounding to f32.
    one: |_, exact| [0.5 * ulp(exact[0]) + 16.0 * ROUNDING_F64],
    table: tables::DISCRETE,
    corners: &[
        [0.0, 0.0, 1e-30, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0],
        [1e30, 1.0, 1e-30, 0.0, 1.0, 1.0, 1.0, 1.0, 3.0],
    ],
    draw: |n| {
        let mut x = [0.0; 9];
        x[..8].fill_with(|| n.one_of([0.0, 1.0, 1.0]) * n.log(1e-30, 1e30));
        x[0] = x[0].max(1e-30);
        x[8] = (8.0 * n.unit()).floor();
        x
    },
    draws: 1024,
    exact: |x| {
        let (list, index) = weights(x);
        // From the smallest on, so that little is lost.
        let mut sorted = list.to_vec();
        sorted.sort_by(f64::total_cmp);
        [list[index] / sorted.iter().sum::<f64>()]
    },
    ours: |x| {
        let (list, index) = weights(x);
        [Discrete::new(list).map_or(f64::NAN, |d| f64::from(d.pmf(index)))]
    },
    naive: ("cumulated in single precision", |x| {
        let (list, index) = weights(x);
        let mut sum = 0.0f32;
        let sums: Vec<f32> = list
            .iter()
            .map(|&w| {
                sum += single(w);
                sum
            })
            .collect();
        let before = if index == 0 { 0.0 } else { sums[index - 1] };
        [f64::from((sums[index] - before) / sum)]
    }),
};

static FILM: LazyLock<Film> = LazyLock::new(|| {
    let settings = FilmSettings {
        width: 100_000,
        height: 1,
        crop: None,
        filter: Filter::PIXEL,
        reconstruction: Reconstruction::Importance,
    };
    Film::new(&settings).expect("100,000 pixels are allowed")
});

const POSITION: Routine<2, 1> = Routine {
    id: "film/100000-columns",
    says: "a sample's place on a film of 100,000 columns is right to a hundredth of a pixel",
    unit: "pixels",
    bound: 0.003, // The image's coordinate, below 1, is rounded to f32 once: 2⁻²⁵·100,000/2 = 0.0015 pixels; and u by 2⁻²⁵ of 1.
    one: |_, _| [1.0],
    table: tables::NONE,
    corners: &[[0.0, 0.0], [99_999.0, 0.999_999_940_395_355_2]],
    draw: |n| [(100_000.0 * n.unit()).floor(), n.sampler()],
    draws: 256,
    exact: |[pixel, u]| [pixel + u],
    ours: |[pixel, u]| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a column")]
        let (position, _) = FILM.place([*pixel as u32, 0], [single(*u), 0.5]);
        [(f64::from(FILM.to_image(position)[0]) + 1.0) * 50_000.0]
    },
    naive: ("all in single precision", |[pixel, u]| {
        let x = 2.0 * (single(*pixel) + single(*u)) / 100_000.0 - 1.0;
        [(f64::from(x) + 1.0) * 50_000.0]
    }),
};

/// Values from 1e-6 to 1e6 whose sum is exact: whole multiples of 2⁻²⁰ of at most 24 digits, drawn by a hash.
fn values(seed: f64, count: f64) -> impl Iterator<Item = (f32, u64)> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count and a seed")]
    let (seed, count) = (seed as u64, count as u64);
    (0..count).map(move |i| {
        let word = (i ^ seed.rotate_left(32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        // 1 to 24 digits, shifted by 0 to 16.
        let steps = ((word >> 40 >> (word & 15)).max(1)) << ((word >> 8) & 15);
        (steps as f32 / 1_048_576.0, steps)
    })
}

const SUM: Routine<2, 1> = Routine {
    id: "accumulation/1e-6-to-1e6",
    says: "a pixel's mean over 2¹⁸ samples from 1e-6 to 1e6 keeps its digits",
    unit: "roundings of 2⁻⁵³",
    bound: 20.0, // A tree of depth 18, the sum of its parts and the quotient.
    one: |_, exact| exact.map(|e| e * ROUNDING_F64),
    table: tables::NONE,
    corners: &[[1.0, 262_144.0]],
    draw: |n| [(1e6 * n.unit()).floor(), 16_384.0],
    draws: 4,
    exact: |[seed, count]| {
        let sum: u128 = values(*seed, *count).map(|(_, steps)| u128::from(steps)).sum();
        [sum as f64 / 1_048_576.0 / count]
    },
    ours: |[seed, count]| {
        let mut sum = PixelSum::new(1);
        for (value, _) in values(*seed, *count) {
            sum.push(0, Rgb::splat(value), 1.0);
        }
        [sum.estimate(Reconstruction::Importance).mean[0]]
    },
    naive: ("running sum in single precision", |[seed, count]| {
        let sum: f32 = values(*seed, *count).map(|(value, _)| value).sum();
        [f64::from(sum) / count]
    }),
};

/// Values about 1e6 with a spread of 1: steps of 1/16.
fn offset_values(seed: f64, count: f64) -> impl Iterator<Item = f32> {
    values(seed, count).map(|(_, steps)| 1e6 + (steps.wrapping_mul(0x9e37_79b9) >> 20 & 15) as f32 / 16.0)
}

const ERROR_OF_MEAN: Routine<2, 1> = Routine {
    id: "standard-error/large-mean",
    says: "the standard error from 16,384 parts whose mean is a million times their spread keeps its digits",
    unit: "relative error",
    bound: 2e-12, // Two sums of 2¹⁴ terms in f64, each within 2¹⁴·2⁻⁵³ = 1.8e-12 relative; half of that under the root, twice.
    one: |_, exact| *exact,
    table: tables::NONE,
    corners: &[[3.0, 16_384.0]],
    draw: |n| [(1e6 * n.unit()).floor(), 4096.0],
    draws: 4,
    exact: |[seed, count]| {
        // In whole sixteenths above 1e6, exactly.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 15")]
        let steps = || offset_values(*seed, *count).map(|v| ((f64::from(v) - 1e6) * 16.0) as u64);
        let (sum, squares) = steps().fold((0u64, 0u64), |(s, q), x| (s + x, q + x * x));
        let (sum, squares) = (sum as f64, squares as f64);
        [((squares - sum * sum / count) / (count * (count - 1.0))).sqrt() / 16.0]
    },
    ours: |[seed, count]| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let mut sum = PixelSum::new(*count as u32);
        for (replicate, value) in (0..).zip(offset_values(*seed, *count)) {
            sum.push(replicate, Rgb::splat(value), 1.0);
        }
        [sum.estimate(Reconstruction::Importance).standard_error.map_or(f64::NAN, |e| e[0])]
    },
    naive: ("mean of squares less square of the mean", |[seed, count]| {
        let (sum, squares) =
            offset_values(*seed, *count).map(f64::from).fold((0.0, 0.0), |(s, q), x| (s + x, q + x * x));
        let mean = sum / count;
        [((squares / count - mean * mean) / (count - 1.0)).sqrt()]
    }),
};

/// The value of [`unit_f32`] and how far `subject` is from it, in steps of 2⁻²⁴.
pub(super) fn steps_off(bits: u32, subject: fn(u32) -> f32) -> f64 {
    let exact = f64::from(bits >> 8) * ROUNDING;
    (f64::from(subject(bits)) - exact).abs() / ROUNDING
}

/// The renderer's number from 32 bits.
pub(super) const OURS: fn(u32) -> f32 = unit_f32;

/// All 32 bits over 2³², which is 1 for the 128 largest.
pub(super) const NAIVE: fn(u32) -> f32 = |bits| bits as f32 / 4_294_967_296.0;
