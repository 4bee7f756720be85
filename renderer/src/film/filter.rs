//! Pixel filters, and drawing from them.

use crate::error::ParamError;

/// A separable pixel filter f(x)·f(y); distances are in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Filter {
    /// f = 1 within `radius`: with radius ½ the plain average over the pixel.
    Box {
        /// Half width, above 0.
        radius: f64,
    },
    /// f = 1 − |x| / radius.
    Tent {
        /// Half width, above 0.
        radius: f64,
    },
    /// f = exp(−x² / 2σ²) − exp(−r² / 2σ²) for |x| < r = 4σ.
    Gaussian {
        /// Standard deviation σ, above 0.
        stddev: f64,
    },
    /// The cubic of Mitchell and Netravali, for |x| < 2.
    Mitchell {
        /// Blur, in [0, 1].
        b: f64,
        /// Ringing, in [0, 1].
        c: f64,
    },
    /// f = sinc(x)·sinc(x / a) for |x| < a, where sinc x = sin(πx)/(πx).
    Lanczos {
        /// Number of lobes a, above 0 and at most [`MOST_LOBES`](Self::MOST_LOBES); 3 by custom.
        lobes: f64,
    },
}

impl Filter {
    /// The plain average over the pixel.
    pub const PIXEL: Self = Self::Box { radius: 0.5 };

    /// The most lobes of a Lanczos filter: [`FilterSampler`] then has eight knots a pixel, or a lobe. With one a lobe all of them would
    /// be roots, and nothing but the middle be drawn.
    pub const MOST_LOBES: f64 = 64.0;

    /// Beyond this distance the filter is zero.
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Box { radius } | Self::Tent { radius } => radius,
            Self::Gaussian { stddev } => 4.0 * stddev,
            Self::Mitchell { .. } => 2.0,
            Self::Lanczos { lobes } => lobes,
        }
    }

    /// The filter's value at `x`, not normalised, except that Mitchell's integrates to 1.
    ///
    /// # Source
    /// Mitchell and Netravali 1988, "Reconstruction filters in computer graphics", equation 8
    /// (doi:10.1145/54852.378514); Duchon 1979, "Lanczos filtering in one and two dimensions", for the windowed sinc. The
    /// Gaussian is lowered to reach zero at its radius, as Mitsuba's.
    pub fn eval(&self, x: f64) -> f64 {
        let a = x.abs();
        if a > self.radius() {
            return 0.0;
        }
        match *self {
            Self::Box { .. } => 1.0,
            Self::Tent { radius } => 1.0 - a / radius,
            Self::Gaussian { stddev } => {
                let at = |x: f64| libm::exp(-x * x / (2.0 * stddev * stddev));
                at(a) - at(self.radius())
            }
            Self::Mitchell { b, c } => mitchell(a, b, c),
            Self::Lanczos { lobes } => sinc(a) * sinc(a / lobes),
        }
    }

    fn check(&self) -> Result<(), ParamError> {
        let (name, value, holds, accepted) = match *self {
            Self::Box { radius } | Self::Tent { radius } => {
                ("radius", radius, radius > 0.0 && radius.is_finite(), "a finite radius above 0")
            }
            Self::Gaussian { stddev } => {
                ("stddev", stddev, stddev > 0.0 && stddev.is_finite(), "a finite deviation above 0")
            }
            Self::Mitchell { b, c } => {
                let bad = if (0.0..=1.0).contains(&b) { ("C", c) } else { ("B", b) };
                (bad.0, bad.1, (0.0..=1.0).contains(&bad.1), "a value in [0, 1]")
            }
            Self::Lanczos { lobes } => {
                let holds = lobes > 0.0 && lobes <= Self::MOST_LOBES;
                ("lobes", lobes, holds, "a number above 0 and at most 64")
            }
        };
        if holds { Ok(()) } else { Err(ParamError::OutOfRange { name, value, accepted }) }
    }
}

/// sin(πx)/(πx).
fn sinc(x: f64) -> f64 {
    let x = std::f64::consts::PI * x;
    if x == 0.0 { 1.0 } else { libm::sin(x) / x }
}

fn mitchell(a: f64, b: f64, c: f64) -> f64 {
    let polynomial = |k3: f64, k2: f64, k1: f64, k0: f64| (((k3 * a + k2) * a + k1) * a + k0) / 6.0;
    if a < 1.0 {
        polynomial(12.0 - 9.0 * b - 6.0 * c, -18.0 + 12.0 * b + 6.0 * c, 0.0, 6.0 - 2.0 * b)
    } else {
        polynomial(-b - 6.0 * c, 6.0 * b + 30.0 * c, -12.0 * b - 48.0 * c, 8.0 * b + 24.0 * c)
    }
}

/// Draws distances from |f| of one axis, with signed weights.
///
/// The density is |f| at knots (equidistant ones, and the filter's changes of sign) and linear between them; the
/// weight f / (pdf·∫f) makes up for the difference exactly, so that the mean of w·g(x) is ∫f·g / ∫f for every g.
#[derive(Debug, Clone)]
pub struct FilterSampler {
    filter: Filter,
    /// Distances, in ascending order from −radius to radius.
    knots: Vec<f64>,
    /// |f| at the knots, scaled so that the density integrates to 1.
    density: Vec<f64>,
    /// Probability below each knot.
    cdf: Vec<f64>,
    /// ∫f.
    integral: f64,
}

impl FilterSampler {
    /// Cells between knots. A box and a tent are exact with any even number; for the others the weight's relative
    /// spread at 1024 is below 1e-5 (test `smooth_filters_have_nearly_constant_weights`).
    const CELLS: usize = 1024;

    /// Tables for `filter`.
    ///
    /// # Errors
    /// A parameter out of its range.
    pub fn new(filter: Filter) -> Result<Self, ParamError> {
        filter.check()?;
        let knots = knots(&filter, Self::CELLS);
        let mut density: Vec<f64> = knots.iter().map(|&x| filter.eval(x).abs()).collect();
        let mut cdf = vec![0.0];
        for (x, d) in knots.windows(2).zip(density.windows(2)) {
            let mass = 0.5 * (d[0] + d[1]) * (x[1] - x[0]);
            cdf.push(cdf[cdf.len() - 1] + mass);
        }
        let total = cdf[cdf.len() - 1];
        cdf.iter_mut().for_each(|c| *c /= total);
        density.iter_mut().for_each(|d| *d /= total);
        Ok(Self { filter, knots, density, cdf, integral: integral(&filter) })
    }

    /// Beyond this distance in pixels there is nothing.
    pub fn radius(&self) -> f64 {
        self.filter.radius()
    }

    /// The most pixels whose filters hold one position.
    pub fn pixels(&self) -> u32 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "filters are some pixels wide"
        )]
        let wide = (2.0 * self.radius()).ceil() as u32;
        wide.saturating_mul(wide)
    }

    /// f / ∫f at a distance.
    ///
    /// # Measure
    /// per pixel width.
    pub fn value(&self, x: f64) -> f64 {
        self.filter.eval(x) / self.integral
    }

    /// Whether this is the plain average over the pixel.
    pub fn is_pixel(&self) -> bool {
        self.filter == Filter::PIXEL
    }

    /// A distance drawn from |f|, and its signed weight f / (pdf·∫f), for `u` in [0, 1).
    ///
    /// # Measure
    /// per pixel width.
    #[inline]
    pub fn sample(&self, u: f32) -> (f32, f32) {
        if let Filter::Box { radius } = self.filter {
            return (spread(u, radius), 1.0);
        }
        self.by_table(u)
    }

    fn by_table(&self, u: f32) -> (f32, f32) {
        let u = f64::from(u);
        let cell = self.cdf.partition_point(|&c| c <= u).clamp(1, self.cdf.len() - 1) - 1;
        let width = self.knots[cell + 1] - self.knots[cell];
        let (d0, d1) = (self.density[cell], self.density[cell + 1]);
        let mass = (u - self.cdf[cell]) / width;
        // t solves d0·t + (d1 − d0)·t²/2 = mass in the form that does not cancel
        let root = (d0 * d0 + 2.0 * (d1 - d0) * mass).max(0.0).sqrt();
        let t = if d0 + root > 0.0 { (2.0 * mass / (d0 + root)).clamp(0.0, 1.0) } else { 0.5 };
        let x = self.knots[cell] + t * width;
        let pdf = d0 + (d1 - d0) * t;
        let weight = if pdf > 0.0 { self.filter.eval(x) / (pdf * self.integral) } else { 0.0 };
        round((x, weight))
    }

    /// A distance uniform in the filter's support, and f there.
    pub fn uniform(&self, u: f32) -> (f32, f32) {
        let x = spread(u, self.filter.radius());
        round((f64::from(x), self.filter.eval(f64::from(x))))
    }
}

/// `cells` + 1 equidistant distances over the filter, and between two of different sign the root, by bisection.
fn knots(filter: &Filter, cells: usize) -> Vec<f64> {
    let radius = filter.radius();
    let mut knots = vec![-radius];
    for i in 1..=cells {
        let (mut low, mut high) = (knots[knots.len() - 1], (2.0 * i as f64 / cells as f64 - 1.0) * radius);
        let next = high;
        if filter.eval(low) * filter.eval(high) < 0.0 {
            // 60 halvings leave less than one unit in the last place
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                *if filter.eval(low) * filter.eval(middle) <= 0.0 { &mut high } else { &mut low } = middle;
            }
            knots.push(high);
        }
        knots.push(next);
    }
    knots
}

/// `u` in [0, 1) to [−radius, radius).
fn spread(u: f32, radius: f64) -> f32 {
    round(((2.0 * f64::from(u) - 1.0) * radius, 0.0)).0
}

#[expect(clippy::cast_possible_truncation, reason = "positions in a pixel and weights are of order 1")]
fn round((x, weight): (f64, f64)) -> (f32, f32) {
    (x as f32, weight as f32)
}

/// ∫f over its support: in closed form, and by Simpson's rule for Lanczos, whose integral has none without sine integrals.
fn integral(filter: &Filter) -> f64 {
    match *filter {
        Filter::Box { radius } => 2.0 * radius,
        Filter::Tent { radius } => radius,
        Filter::Gaussian { stddev } => {
            let full = stddev * (std::f64::consts::TAU).sqrt() * libm::erf(4.0 / std::f64::consts::SQRT_2);
            full - 8.0 * stddev * libm::exp(-8.0)
        }
        Filter::Mitchell { .. } => 1.0,
        Filter::Lanczos { lobes } => {
            let steps = 2048;
            let h = lobes / f64::from(steps);
            // The error is h⁴/180·|f‴(a) − f‴(0)|, the latter 0 of an even function: f‴(a) is about 6π/a², so that 64 lobes (h = 1/32)
            // leave less than 1e-10, three 1e-12, and narrow ones less than rounding.
            let weight = |i: i32| if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
            2.0 * h / 3.0 * (0..=steps).map(|i| weight(i) * filter.eval(f64::from(i) * h)).sum::<f64>()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Filter; 5] = [
        Filter::Box { radius: 0.5 },
        Filter::Tent { radius: 1.0 },
        Filter::Gaussian { stddev: 0.5 },
        Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
        Filter::Lanczos { lobes: 3.0 },
    ];

    fn grid(n: u32) -> impl Iterator<Item = f32> {
        (0..n).map(move |i| (i as f32 + 0.5) / n as f32)
    }

    #[test]
    fn closed_integrals_agree_with_the_midpoint_rule() {
        for filter in ALL {
            let n = 100_000;
            let h = 2.0 * filter.radius() / f64::from(n);
            let sum: f64 = (0..n).map(|i| filter.eval((f64::from(i) + 0.5) * h - filter.radius()) * h).sum();
            // midpoint rule: error below h² times the variation of f', which is at most 20 here: 3.2e-8
            assert!((sum - integral(&filter)).abs() < 20.0 * h * h, "{filter:?}");
        }
    }

    #[test]
    fn lanczos_integrates_to_its_sine_integrals() {
        // a/π²·(β·Si(βa) − α·Si(αa) − (cos αa − cos βa)/a) with α, β = π(1 ∓ 1/a), by mpmath.
        let exact = [
            (0.3, 0.344_848_918_150_368_65),
            (1.0, 0.902_823_333_580_280_6),
            (3.0, 0.997_055_345_954_339_7),
            (63.7, 1.000_013_044_671_708_5),
            (64.0, 1.000_000_313_259_931),
        ];
        for (lobes, exact) in exact {
            let off = integral(&Filter::Lanczos { lobes }) - exact;
            assert!(off.abs() < 1e-10, "{lobes}: {off}"); // Simpson's error, derived at `integral`
        }
    }

    #[test]
    fn the_mean_of_weighted_moments_is_that_of_the_filter() {
        for filter in ALL {
            let sampler = FilterSampler::new(filter).unwrap();
            let n = 1 << 16;
            let moment = |k: i32| {
                grid(n)
                    .map(|u| sampler.sample(u))
                    .map(|(x, w)| f64::from(w) * f64::from(x).powi(k))
                    .sum::<f64>()
                    / f64::from(n)
            };
            let h = 2.0 * filter.radius() / f64::from(n);
            let exact = |k: i32| {
                (0..n)
                    .map(|i| (f64::from(i) + 0.5) * h - filter.radius())
                    .map(|x| filter.eval(x) * x.powi(k) * h)
                    .sum::<f64>()
                    / integral(&filter)
            };
            // The grid of u is a midpoint rule on w·xᵏ, which jumps by 2w·|x|ᵏ at the changes of sign, about 1, 2 … below the
            // radius on either side: its variation, to k = 4, over n bounds the error.
            let (radius, w) = (filter.radius(), f64::from(sampler.sample(0.5).1));
            let jumps: f64 = (1..8).map(f64::from).filter(|x| *x < radius).map(|x| 2.0 * x.powi(4)).sum();
            let variation = 2.0 * w * (radius.powi(4) + jumps);
            for k in 0..5 {
                assert!((moment(k) - exact(k)).abs() < variation / f64::from(n), "{filter:?} {k}");
            }
        }
    }

    #[test]
    fn smooth_filters_have_nearly_constant_weights() {
        for filter in &ALL[..3] {
            let sampler = FilterSampler::new(*filter).unwrap();
            let spread = grid(4096).map(|u| (sampler.sample(u).1 - 1.0).abs()).fold(0.0, f32::max);
            // relative curvature f''h²/8f of the Gaussian away from its zero ends, h = 1/256: 4·h²/8·(x²/σ² − 1)
            assert!(spread < 1e-3, "{filter:?}: {spread}");
        }
    }

    #[test]
    fn mitchell_weights_are_signed_and_as_large_as_its_absolute_mass() {
        let sampler = FilterSampler::new(ALL[3]).unwrap();
        for u in grid(1000) {
            let (x, w) = sampler.sample(u);
            // ∫|f| = 1.069971 for B = C = 1/3; next to a root the density is off by h·f''/2f' = 0.4 % for h = 1/256
            assert!((w.abs() - 1.069_971).abs() < 0.006, "{x} {w}");
        }
    }

    #[test]
    fn edges_of_the_unit_interval_stay_inside_the_filter() {
        for filter in ALL {
            let sampler = FilterSampler::new(filter).unwrap();
            for u in [0.0, 1.0 - f32::EPSILON / 2.0] {
                let (x, w) = sampler.sample(u);
                assert!(f64::from(x).abs() <= filter.radius() && w.is_finite(), "{filter:?} {u}");
            }
        }
    }

    #[test]
    fn impossible_parameters_are_refused_by_name() {
        let refuse = |f| FilterSampler::new(f).unwrap_err().to_string();
        assert_eq!(refuse(Filter::Box { radius: 0.0 }), "radius is 0; a finite radius above 0 is accepted");
        assert_eq!(refuse(Filter::Mitchell { b: 0.5, c: 2.0 }), "C is 2; a value in [0, 1] is accepted");
        let accepted = "a number above 0 and at most 64 is accepted";
        for lobes in [0.0, 64.5, f64::NAN, f64::INFINITY] {
            let text = refuse(Filter::Lanczos { lobes });
            assert!(text.starts_with("lobes is ") && text.ends_with(accepted), "{text}");
        }
    }
}
