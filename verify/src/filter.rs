//! Closed forms of pixel filters: what a pixel shows of an edge, of a wave and of a constant.
//!
//! A filter is a product f(x)·f(y) of distances in pixels; all results are divided by its mass (∫f)².

mod ratio;

pub use ratio::{RatioMoments, edge_ratio_moments};

use crate::quadrature::{Tolerance, integrate};
use statrs::function::erf::erf;
use std::f64::consts::{PI, SQRT_2};

/// One axis of a separable pixel filter; distances are in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// 1 within `radius`.
    Box {
        /// Half width.
        radius: f64,
    },
    /// 1 − |x|/`radius`.
    Tent {
        /// Half width.
        radius: f64,
    },
    /// exp(−x²/2σ²) − exp(−r²/2σ²) within r: lowered so that it ends at 0.
    Gaussian {
        /// Standard deviation σ.
        stddev: f64,
        /// Half width r.
        radius: f64,
    },
    /// The piecewise cubic of Mitchell and Netravali, within 2.
    Cubic {
        /// Blur B.
        b: f64,
        /// Ringing C.
        c: f64,
    },
    /// sinc(x)·sinc(x/a) within a, sinc x = sin(πx)/(πx).
    Lanczos {
        /// Half width a.
        radius: f64,
    },
}

/// What integrals reach: 1e-10 of their value, or of 1.
const TOLERANCE: Tolerance = Tolerance { relative: 1e-10, absolute: 1e-11, pieces: 2000 };

impl Kernel {
    /// Half width of the support.
    #[must_use]
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Box { radius }
            | Self::Tent { radius }
            | Self::Gaussian { radius, .. }
            | Self::Lanczos { radius } => radius,
            Self::Cubic { .. } => 2.0,
        }
    }

    /// f(x), not normalised.
    ///
    /// # Source
    /// Mitchell and Netravali 1988, 10.1145/54852.378514, equation 8; Duchon 1979, "Lanczos filtering in one and two dimensions".
    #[must_use]
    pub fn eval(&self, x: f64) -> f64 {
        let a = x.abs();
        if a > self.radius() {
            return 0.0;
        }
        match *self {
            Self::Box { .. } => 1.0,
            Self::Tent { radius } => 1.0 - a / radius,
            Self::Gaussian { stddev, radius } => gauss(a / stddev) - gauss(radius / stddev),
            Self::Cubic { b, c } => {
                let [k3, k2, k1, k0] = cubic(b, c)[usize::from(a >= 1.0)];
                ((k3 * a + k2) * a + k1) * a + k0
            }
            Self::Lanczos { radius } => sinc(a) * sinc(a / radius),
        }
    }

    /// The share of the filter's mass below `x`: what a pixel shows of an upright edge at `x` from its middle.
    ///
    /// Polynomials for box, tent and cubic, the error function for the Gaussian, sine integrals for Lanczos.
    ///
    /// # Source
    /// Integrals of [`Self::eval`]; sin A sin B = ½(cos(A − B) − cos(A + B)) and one integration by parts for Lanczos.
    ///
    /// # Verified by
    /// `filter::tests::cumulative_is_the_integral`
    #[must_use]
    pub fn cumulative(&self, x: f64) -> f64 {
        let a = x.abs().min(self.radius());
        let share = self.at_distance(a) / (2.0 * self.at_distance(self.radius()));
        0.5 + share.copysign(x)
    }

    /// ∫₀ᵃ f.
    fn at_distance(&self, a: f64) -> f64 {
        match *self {
            Self::Box { .. } => a,
            Self::Tent { radius } => a * (1.0 - 0.5 * a / radius),
            Self::Gaussian { stddev, radius } => {
                stddev * (0.5 * PI).sqrt() * erf(a / (stddev * SQRT_2)) - a * gauss(radius / stddev)
            }
            Self::Cubic { b, c } => {
                let integral = |[k3, k2, k1, k0]: [f64; 4], a: f64| {
                    (((k3 / 4.0 * a + k2 / 3.0) * a + k1 / 2.0) * a + k0) * a
                };
                let [inner, outer] = cubic(b, c);
                integral(inner, a.min(1.0)) + integral(outer, a.max(1.0)) - integral(outer, 1.0)
            }
            Self::Lanczos { radius } => {
                if a == 0.0 {
                    return 0.0;
                }
                let (slow, fast) = (PI * (1.0 - 1.0 / radius), PI * (1.0 + 1.0 / radius));
                let boundary = 2.0 * (PI * a).sin() * (PI * a / radius).sin() / a;
                let integrals = fast * sine_integral(fast * a) - slow * sine_integral(slow * a);
                radius / (2.0 * PI * PI) * (integrals - boundary)
            }
        }
    }

    /// What a pixel shows of a half-plane that is bright where x cos φ + y sin φ < `distance`, from its middle.
    ///
    /// ∫ f(y)·F((d − y sin φ)/cos φ) dy/∫f with F the cumulative of one axis, in pieces without kinks.
    ///
    /// * `distance`: of the edge from the pixel's middle, in pixels; `angle`: φ, of the edge's normal to the x axis, in radians.
    ///
    /// Returns: 0 to 1, beyond for filters with negative lobes; within 1e-9.
    ///
    /// # Source
    /// Fubini; [`Self::cumulative`].
    ///
    /// # Verified by
    /// `filter::tests::edges_agree_with_areas_waves_and_quadrature`
    #[must_use]
    pub fn edge(&self, distance: f64, angle: f64) -> f64 {
        let (across, along) = (angle.cos().abs(), angle.sin().abs());
        let (c, s) = if across > along { (across, along) } else { (along, across) };
        if s == 0.0 {
            return self.cumulative(distance);
        }
        let mass = 2.0 * self.at_distance(self.radius());
        let row = |y: f64| self.eval(y) / mass * self.cumulative((distance - y * s) / c);
        let jumps = self.knots().into_iter().flat_map(|k| [k, (distance - c * k) / s]);
        piecewise(&row, self.radius(), jumps)
    }

    /// The amplitude that a wave cos(2πfx) keeps: H(f) = ∫ f(x) cos(2πfx) dx/∫f.
    ///
    /// sinc(2rf) for the box, sinc²(rf) for the tent, a closed form for the cubic, quadrature for the others.
    ///
    /// * `frequency`: waves a pixel.
    ///
    /// # Source
    /// Mitchell and Netravali 1988 for the cubic's transform, here as sums of sinc at f and 2f.
    ///
    /// # Verified by
    /// `filter::tests::responses_agree_with_quadrature_and_limits`
    #[must_use]
    pub fn response(&self, frequency: f64) -> f64 {
        let f = frequency.abs();
        match *self {
            Self::Box { radius } => sinc(2.0 * radius * f),
            Self::Tent { radius } => sinc(radius * f).powi(2),
            // The closed form divides by f⁴ what cancels to that order: below 0.05 it has lost 1e-10.
            Self::Cubic { b, c } if f > 0.05 => {
                let (one, two, four) = (sinc(f), sinc(2.0 * f), sinc(4.0 * f));
                let square = (PI * f).powi(2);
                (1.0 - b) * 3.0 / square * (one * one - two) + b * one.powi(4)
                    - 2.0 * c / square * (3.0 * two * two - 2.0 * two - four)
            }
            _ => self.response_by_quadrature(f),
        }
    }

    fn response_by_quadrature(&self, f: f64) -> f64 {
        let wave = |x: f64| self.eval(x) * (2.0 * PI * f * x).cos();
        piecewise(&wave, self.radius(), self.knots()) / (2.0 * self.at_distance(self.radius()))
    }

    /// ∫|f|/∫f of one axis: above 1 for filters with negative lobes.
    ///
    /// Samples drawn from |f| in two dimensions carry weights ± the square of it, whose variance is its fourth power less 1.
    #[must_use]
    pub fn absolute_mass(&self) -> f64 {
        let zeros = (1..8).map(f64::from).chain([self.cubic_root()]).flat_map(|x| [x, -x]);
        let all = self.knots().into_iter().chain(zeros);
        piecewise(&|x| self.eval(x).abs(), self.radius(), all) / (2.0 * self.at_distance(self.radius()))
    }

    /// Where the cubic's outer piece changes sign, between 1 and 2; 1 for other kernels.
    fn cubic_root(&self) -> f64 {
        let (mut low, mut high) = (1.0, 2.0 - 1e-9);
        if !matches!(self, Self::Cubic { .. }) || self.eval(low) * self.eval(high) >= 0.0 {
            return 1.0;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *if self.eval(middle) > 0.0 { &mut low } else { &mut high } = middle;
        }
        low
    }

    /// Where the kernel or a derivative of it jumps.
    fn knots(&self) -> Vec<f64> {
        let r = self.radius();
        match self {
            Self::Cubic { .. } => vec![-2.0, -1.0, 0.0, 1.0, 2.0],
            Self::Box { .. } | Self::Gaussian { .. } | Self::Lanczos { .. } => vec![-r, r],
            Self::Tent { .. } => vec![-r, 0.0, r],
        }
    }
}

/// ∫ over [−radius, radius], cut at `jumps`.
fn piecewise(f: &impl Fn(f64) -> f64, radius: f64, jumps: impl IntoIterator<Item = f64>) -> f64 {
    let mut cuts: Vec<f64> = jumps.into_iter().filter(|x| x.abs() < radius).collect();
    cuts.extend([-radius, radius]);
    cuts.sort_by(f64::total_cmp);
    cuts.windows(2).filter(|w| w[1] > w[0]).map(|w| integrate(&|x| f(x), [w[0], w[1]], TOLERANCE).value).sum()
}

fn gauss(z: f64) -> f64 {
    (-0.5 * z * z).exp()
}

/// sin(πx)/(πx).
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

/// Coefficients of |x|³ … 1 within 1 and from 1 to 2.
fn cubic(b: f64, c: f64) -> [[f64; 4]; 2] {
    [
        [12.0 - 9.0 * b - 6.0 * c, -18.0 + 12.0 * b + 6.0 * c, 0.0, 6.0 - 2.0 * b],
        [-b - 6.0 * c, 6.0 * b + 30.0 * c, -12.0 * b - 48.0 * c, 8.0 * b + 24.0 * c],
    ]
    .map(|k| k.map(|k| k / 6.0))
}

/// Si(x) = ∫₀ˣ sin t/t dt by its series, for |x| below 20.
///
/// # Precision, limits
/// Terms reach e^x/x and cancel: 1e-15·e^x/x absolute, 1e-11 at the 12.6 that Lanczos with three lobes needs.
fn sine_integral(x: f64) -> f64 {
    let (mut term, mut sum, mut k) = (x, x, 1.0);
    while term.abs() > 1e-17 * sum.abs() {
        term *= -x * x / ((k + 1.0) * (k + 2.0));
        k += 2.0;
        sum += term / k;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::integrate_2d;
    use proptest::prelude::*;

    const ALL: [Kernel; 6] = [
        Kernel::Box { radius: 0.5 },
        Kernel::Tent { radius: 1.0 },
        Kernel::Gaussian { stddev: 0.5, radius: 2.0 },
        Kernel::Cubic { b: 1.0 / 3.0, c: 1.0 / 3.0 },
        Kernel::Cubic { b: 0.0, c: 0.5 },
        Kernel::Lanczos { radius: 3.0 },
    ];

    #[test]
    fn cumulative_is_the_integral() {
        for kernel in ALL {
            let mass = piecewise(&|x| kernel.eval(x), kernel.radius(), kernel.knots());
            for x in [-2.9, -1.3, -0.4, 0.0, 0.2, 0.7, 1.1, 1.9, 2.4] {
                let below = |t: f64| if t < x { kernel.eval(t) } else { 0.0 };
                let knots = kernel.knots().into_iter().chain([x]);
                let share = piecewise(&below, kernel.radius(), knots) / mass;
                assert!((kernel.cumulative(x) - share).abs() < 1e-9, "{kernel:?} {x}"); // quadrature's 1e-10 and Si's 1e-11
            }
        }
    }

    #[test]
    fn sine_integrals_have_their_tabled_values() {
        // Si(π) is the Wilbraham–Gibbs constant; Si(10) from Abramowitz and Stegun, table 5.1.
        assert!((sine_integral(PI) - 1.851_937_051_982_466_2).abs() < 1e-14); // roundings of terms up to 5
        assert!((sine_integral(10.0) - 1.658_347_594_2).abs() < 5e-11); // ten decimals
        assert_eq!(sine_integral(0.0), 0.0);
    }

    /// Three independent routes: the area of a clipped square, the projection–slice theorem, and quadrature in two dimensions.
    #[test]
    fn edges_agree_with_areas_waves_and_quadrature() {
        // A square cut by its diagonal direction: the corner triangle has area e², e its height.
        let edge = Kernel::Box { radius: 0.5 }.edge(0.5_f64.sqrt() - 0.2, 0.25 * PI);
        assert!((edge - (1.0 - 0.04)).abs() < 1e-9);
        for kernel in [ALL[1], ALL[3], ALL[4]] {
            for (distance, angle) in [(0.3, 0.4_f64), (-0.8, 1.2), (1.4, 0.1)] {
                // ½ + (1/π)∫ H(f cos φ)H(f sin φ) sin(2πfd)/f df; the transforms fall as f⁻² and f⁻³ or faster.
                let wave = |f: f64| {
                    kernel.response(f * angle.cos())
                        * kernel.response(f * angle.sin())
                        * (2.0 * PI * f * distance).sin()
                        / (PI * f)
                };
                let waves: f64 = (0..200)
                    .map(|i| integrate(&wave, [f64::from(i), f64::from(i) + 1.0], TOLERANCE).value)
                    .sum();
                // The tail beyond 200: |H| below (πf sin φ)⁻² along the flatter axis, 1/(π·3·(π·20)²·…) < 1e-6.
                assert!((kernel.edge(distance, angle) - 0.5 - waves).abs() < 1e-6, "{kernel:?} {distance}");
            }
        }
        for kernel in ALL {
            let r = kernel.radius();
            let mass = (2.0 * kernel.at_distance(r)).powi(2);
            let inside = |[x, y]: [f64; 2]| {
                if 0.6 * x + 0.8 * y < 0.35 { kernel.eval(x) * kernel.eval(y) / mass } else { 0.0 }
            };
            let rough = Tolerance { relative: 0.0, absolute: 1e-4, pieces: 20_000 };
            let area = integrate_2d(&inside, [[-r, r], [-r, r]], rough);
            let edge = kernel.edge(0.35, 0.8_f64.atan2(0.6));
            assert!((edge - area.value).abs() < area.error.max(1e-3), "{kernel:?}: {edge} {area:?}");
        }
    }

    #[test]
    fn responses_agree_with_quadrature_and_limits() {
        for kernel in ALL {
            assert!((kernel.response(0.0) - 1.0).abs() < 1e-10);
            for f in [0.02, 0.06, 0.3, 0.5, 1.2] {
                let difference = kernel.response(f) - kernel.response_by_quadrature(f);
                assert!(difference.abs() < 1e-9, "{kernel:?} {f}"); // both within 1e-10 of values up to 1
            }
        }
        // The lowered Gaussian is the whole one but for e⁻⁸ of its height over 4σ: below 2·4·e⁻⁸ of its mass.
        let whole = |f: f64| (-2.0 * (PI * 0.5 * f).powi(2)).exp();
        assert!((ALL[2].response(0.4) - whole(0.4)).abs() < 8.0 * (-8.0_f64).exp());
    }

    #[test]
    fn absolute_masses_are_the_published_ones() {
        assert!((ALL[3].absolute_mass() - 1.069_971).abs() < 1e-6); // six decimals
        assert!((ALL[4].absolute_mass() - 7.0 / 6.0).abs() < 1e-9);
        for kernel in &ALL[..3] {
            assert!((kernel.absolute_mass() - 1.0).abs() < 1e-9, "{kernel:?}");
        }
    }

    proptest! {
        #[test]
        fn the_two_sides_of_an_edge_add_up(distance in -4.0..4.0_f64, angle in 0.0..6.3_f64, k in 0..6_usize) {
            let sum = ALL[k].edge(distance, angle) + ALL[k].edge(-distance, angle);
            prop_assert!((sum - 1.0).abs() < 1e-8); // two integrals within 1e-9 each
        }
    }
}
