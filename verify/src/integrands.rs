//! Functions on the unit square whose integral and variance are known exactly, to measure samplers with.
//!
//! The set is that of Christensen, Kensler, Kilpatrick 2018 (progressive multi-jittered sequences), 10.1111/cgf.13472; the formulas
//! are derived here.

use statrs::function::erf::erf;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

mod net;

/// A function of two coordinates in [0, 1), with exact moments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrand {
    /// Its name in reports.
    pub name: &'static str,
    shape: Shape,
}

/// How smooth an integrand is; it decides the rate at which stratified and low-discrepancy points converge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regularity {
    /// Differentiable on the whole square.
    Smooth,
    /// Jumps along a curve.
    Edge,
    /// Jumps along a line of constant coordinate.
    AlignedEdge,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// g(x)·h(y).
    Product(Factor, Factor),
    /// 1 within the radius of the centre; the disk's part outside the square does not count.
    Disk { centre: f64, radius: f64 },
    /// 1 where x + y < 1.
    Triangle,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Factor {
    One,
    Linear,
    Square,
    /// exp(−(t − centre)²).
    Gaussian(f64),
    /// 1 below the edge.
    Below(f64),
    /// sin(k·π·t).
    Sine(f64),
}

/// 1/√(2π), the radius of a disk of area ½.
const HALF_AREA_RADIUS: f64 = 0.398_942_280_401_432_7;

/// Every integrand.
pub const ALL: [Integrand; 12] = [
    // √(2/π): a quarter of that disk has area ½.
    Integrand::of("quarterdisk", Shape::Disk { centre: 0.0, radius: 2.0 * HALF_AREA_RADIUS }),
    Integrand::of("fulldisk", Shape::Disk { centre: 0.5, radius: HALF_AREA_RADIUS }),
    Integrand::of("triangle", Shape::Triangle),
    Integrand::of("stepx", Shape::Product(Factor::Below(FRAC_1_PI), Factor::One)),
    Integrand::of("quartergaussian", Shape::Product(Factor::Gaussian(0.0), Factor::Gaussian(0.0))),
    Integrand::of("fullgaussian", Shape::Product(Factor::Gaussian(0.5), Factor::Gaussian(0.5))),
    Integrand::of("bilinear", Shape::Product(Factor::Linear, Factor::Linear)),
    Integrand::of("biquadratic", Shape::Product(Factor::Square, Factor::Square)),
    Integrand::of("lineary", Shape::Product(Factor::One, Factor::Linear)),
    Integrand::of("gaussianx", Shape::Product(Factor::Gaussian(0.0), Factor::One)),
    Integrand::of("siny", Shape::Product(Factor::One, Factor::Sine(1.0))),
    Integrand::of("sin2x", Shape::Product(Factor::Sine(2.0), Factor::One)),
];

impl Factor {
    fn eval(self, t: f64) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Linear => t,
            Self::Square => t * t,
            Self::Gaussian(centre) => (-(t - centre).powi(2)).exp(),
            Self::Below(edge) => f64::from(u8::from(t < edge)),
            Self::Sine(k) => (k * PI * t).sin(),
        }
    }

    /// ∫ from 0 to t.
    fn integral_to(self, t: f64) -> f64 {
        match self {
            Self::One => t,
            Self::Linear => 0.5 * t * t,
            Self::Square => t * t * t / 3.0,
            Self::Gaussian(centre) => 0.5 * PI.sqrt() * (erf(t - centre) + erf(centre)),
            Self::Below(edge) => t.min(edge),
            Self::Sine(k) => (1.0 - (k * PI * t).cos()) / (k * PI),
        }
    }

    /// ∫ of the square over [0, 1].
    fn mean_square(self) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Linear => 1.0 / 3.0,
            Self::Square => 0.2,
            Self::Gaussian(c) => {
                let wide = f64::sqrt(2.0);
                0.5 * FRAC_PI_2.sqrt() * (erf(wide * (1.0 - c)) + erf(wide * c))
            }
            Self::Below(edge) => edge,
            Self::Sine(_) => 0.5, // for whole k
        }
    }

    /// Σ over n strips of the strip mean's square.
    fn strip_squares(self, n: u32) -> f64 {
        let at = |i: u32| self.integral_to(f64::from(i) / f64::from(n));
        (0..n).map(|i| (f64::from(n) * (at(i + 1) - at(i))).powi(2)).sum()
    }
}

impl Integrand {
    const fn of(name: &'static str, shape: Shape) -> Self {
        Self { name, shape }
    }

    /// The integrand of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        ALL.into_iter().find(|integrand| integrand.name == name)
    }

    /// The value at a point of the unit square.
    #[must_use]
    pub fn eval(&self, [x, y]: [f64; 2]) -> f64 {
        let inside = match self.shape {
            Shape::Product(g, h) => return g.eval(x) * h.eval(y),
            Shape::Disk { centre, radius } => (x - centre).powi(2) + (y - centre).powi(2) < radius * radius,
            Shape::Triangle => x + y < 1.0,
        };
        f64::from(u8::from(inside))
    }

    /// The integral over the unit square.
    #[must_use]
    pub fn integral(&self) -> f64 {
        match self.shape {
            Shape::Product(g, h) => g.integral_to(1.0) * h.integral_to(1.0),
            Shape::Disk { .. } | Shape::Triangle => 0.5,
        }
    }

    /// The variance of the value at one uniform point, ∫f² − (∫f)².
    #[must_use]
    pub fn variance(&self) -> f64 {
        match self.shape {
            Shape::Product(g, h) => g.mean_square() * h.mean_square() - self.integral().powi(2),
            Shape::Disk { .. } | Shape::Triangle => 0.25,
        }
    }

    /// How smooth it is.
    #[must_use]
    pub fn regularity(&self) -> Regularity {
        match self.shape {
            Shape::Product(Factor::Below(_), _) | Shape::Product(_, Factor::Below(_)) => {
                Regularity::AlignedEdge
            }
            Shape::Product(..) => Regularity::Smooth,
            Shape::Disk { .. } | Shape::Triangle => Regularity::Edge,
        }
    }

    /// Variance of the mean of `samples` independent uniform points, σ²/N.
    #[must_use]
    pub fn random_variance(&self, samples: u64) -> f64 {
        self.variance() / samples as f64
    }

    /// Variance of the mean of n² points, one uniform in each of n×n square cells: Σ over cells of the cell's variance, over n⁴.
    ///
    /// Products: (n²·∫f² − Σaᵢ²·Σbⱼ²)/n⁴ with the strips' means a and b; for the bilinear one that is 1/(18N²) − 1/(144N³).
    /// The triangle's diagonal cells are halves: n/4/n⁴. Disks: Σp(1 − p)/n⁴ over the exact areas p of disk ∩ cell.
    ///
    /// # Precision, limits
    /// The difference of a product loses a factor n² of f64's 1e-16: relative error 1e-10 at n = 1024.
    #[must_use]
    pub fn jitter_variance(&self, n: u32) -> f64 {
        let side = f64::from(n);
        let cells = side * side;
        let sum = match self.shape {
            Shape::Product(g, h) => {
                cells * g.mean_square() * h.mean_square() - g.strip_squares(n) * h.strip_squares(n)
            }
            Shape::Triangle => 0.25 * side,
            Shape::Disk { centre, radius } => {
                let at = |i: u32| f64::from(i) / side - centre;
                let corner = |i: u32, j: u32| disk_corner_area(radius, at(i), at(j));
                let share = |i: u32, j: u32| {
                    cells * (corner(i + 1, j + 1) - corner(i, j + 1) - corner(i + 1, j) + corner(i, j))
                };
                (0..n).flat_map(|i| (0..n).map(move |j| share(i, j))).map(|p| p * (1.0 - p)).sum()
            }
        };
        sum / (cells * cells)
    }
}

/// Area of the disk about the origin within the rectangle from the origin to (x, y); odd in x and in y.
fn disk_corner_area(radius: f64, x: f64, y: f64) -> f64 {
    let sign = x.signum() * y.signum();
    let (x, y) = (x.abs().min(radius), y.abs().min(radius));
    let segment = |t: f64| {
        0.5 * (t * ((radius - t) * (radius + t)).sqrt() + radius * radius * (t / radius).min(1.0).asin())
    };
    let flat = ((radius - y) * (radius + y)).sqrt().min(x);
    sign * (y * flat + segment(x) - segment(flat))
}

/// A family of point sets, by its rate of convergence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Independent points.
    Random,
    /// One point in each of n×n cells.
    Jitter,
    /// Owen-scrambled (0, m, 2)-nets at powers of two.
    ScrambledNet,
}

/// The slope of ln RMSE against ln N that theory predicts in two dimensions.
///
/// # Source
/// Random −½. Jitter: Mitchell 1996, 10.1145/237170.237265: −1 smooth, −¾ with an edge. Scrambled nets: Owen 1997,
/// 10.1214/aos/1031594731: −3/2 smooth, up to logarithms; −¾ with an edge and −1 with an aligned one, where one stratum of 1/N is
/// cut (derived here: f(1 − f)/N² in the single coordinate).
#[must_use]
pub fn theory_slope(family: Family, regularity: Regularity) -> f64 {
    match (family, regularity) {
        (Family::Random, _) => -0.5,
        (Family::Jitter, Regularity::Smooth) => -1.0,
        (Family::Jitter, _) | (Family::ScrambledNet, Regularity::Edge) => -0.75,
        (Family::ScrambledNet, Regularity::Smooth) => -1.5,
        (Family::ScrambledNet, Regularity::AlignedEdge) => -1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Moments;
    use crate::seeds::uniform;

    #[test]
    fn moments_agree_with_the_midpoint_rule() {
        let n = 1000;
        for integrand in ALL {
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
            let values = (0..n).flat_map(|i| (0..n).map(move |j| integrand.eval([at(i), at(j)])));
            let moments: Moments = values.collect();
            // Smooth: f''/24n² < 2.5e-6. An edge is wrong in at most 2n of the n² cells, by a half on average; the
            // errors of crossing cells mostly cancel: a tenth of 1/n.
            let tolerance = if integrand.regularity() == Regularity::Smooth { 2.5e-6 } else { 7e-4 };
            assert!((moments.mean() - integrand.integral()).abs() < tolerance, "{}", integrand.name);
            assert!((moments.variance() - integrand.variance()).abs() < tolerance, "{}", integrand.name);
        }
    }

    #[test]
    fn jitter_variance_has_the_known_closed_forms() {
        let named = |name| Integrand::named(name).unwrap();
        for n in [1_u32, 4, 32] {
            let count = f64::from(n * n);
            let bilinear = 1.0 / (18.0 * count.powi(2)) - 1.0 / (144.0 * count.powi(3));
            let fraction = (f64::from(n) / PI).fract();
            let step = fraction * (1.0 - fraction) / count.powf(1.5);
            // Cancellation by n² = 1024 of 2.2e-16, a few times.
            assert!((named("bilinear").jitter_variance(n) / bilinear - 1.0).abs() < 1e-12);
            assert!((named("stepx").jitter_variance(n) / step - 1.0).abs() < 1e-12);
            assert!((named("triangle").jitter_variance(n) * count.powf(1.5) - 0.25).abs() < 1e-15);
        }
        // One cell is one random point.
        for integrand in ALL {
            assert!(
                (integrand.jitter_variance(1) - integrand.variance()).abs() < 1e-15,
                "{}",
                integrand.name
            );
        }
    }

    #[test]
    fn jitter_variance_agrees_with_simulation() {
        for (k, integrand) in ALL.into_iter().enumerate() {
            let mean = |seed: u64| -> f64 {
                let cell = |i: u32| {
                    let x = (uniform(seed, u64::from(2 * i)) + f64::from(i % 5)) / 5.0;
                    let y = (uniform(seed, u64::from(2 * i + 1)) + f64::from(i / 5)) / 5.0;
                    integrand.eval([x, y])
                };
                (0..25).map(cell).sum::<f64>() / 25.0
            };
            let errors: Moments =
                (0..4000).map(|r| (mean(4000 * k as u64 + r) - integrand.integral()).powi(2)).collect();
            let (estimate, exact) = (errors.estimate(), integrand.jitter_variance(5));
            // Six standard errors of the measured variance: 2e-9 for each of 12.
            assert!((estimate.mean - exact).abs() < 6.0 * estimate.standard_error, "{}", integrand.name);
        }
    }

    #[test]
    fn theory_has_the_slopes_of_the_exact_variances() {
        let slope = |variances: [f64; 2], points: f64| 0.5 * (variances[1] / variances[0]).ln() / points.ln();
        for integrand in ALL {
            let regularity = integrand.regularity();
            let jitter = slope([4, 256].map(|n| integrand.jitter_variance(n)), 4096.0);
            let net = slope([4, 10].map(|m| integrand.net_variance(m)), 64.0);
            let random = slope([1.0, 1.0 / 64.0].map(|share| share * integrand.variance()), 64.0);
            for (family, found) in
                [(Family::Jitter, jitter), (Family::ScrambledNet, net), (Family::Random, random)]
            {
                // The net's logarithm, √m from 4 to 10: ½·ln 2.5/ln 64 = 0.11; what an edge leaves of its cells varies by less.
                let off = found - theory_slope(family, regularity);
                assert!(off.abs() < 0.12, "{} {family:?}: {found}", integrand.name);
            }
        }
    }

    #[test]
    fn published_errors_of_the_quarter_disk_are_met() {
        // RMSE of jitter at N = 16, 64, 256, 1024 from numeric cell areas, printed to four digits.
        for (n, rmse) in [(4, 0.05141), (8, 0.02049), (16, 0.007_427), (32, 0.002_599)] {
            let exact = Integrand::named("quarterdisk").unwrap().jitter_variance(n).sqrt();
            assert!((exact / rmse - 1.0).abs() < 3e-4, "{n}: {exact}"); // half a unit of the last digit, 2e-4
        }
    }
}
