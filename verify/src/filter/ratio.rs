//! The weighted average Σf·L/Σf: its bias over n independent samples.

use super::{Kernel, piecewise};

/// Moments that decide the bias of a ratio of means, for samples of a weight w and a value L.
///
/// With μ = E(wL)/E(w), e = wL − μw and b = w: E(e) = 0 and the ratio's error is ē/b̄.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RatioMoments {
    /// What the ratio tends to.
    pub limit: f64,
    /// E(b).
    pub mean: f64,
    /// Var(b).
    pub variance: f64,
    /// Cov[e, b].
    pub covariance: f64,
    /// E[e(b − E b)²].
    pub third: f64,
}

impl RatioMoments {
    /// The bias of the ratio over `n` independent samples: −C/(nB²) + (T/B³ − 3CV/B⁴)/n².
    ///
    /// # Precision, limits
    /// What is left out is of order n⁻³.
    ///
    /// # Source
    /// 1/b̄ as a power series about B, and the moments of means: Cochran 1977, "Sampling Techniques", section 6.8.
    ///
    /// # Verified by
    /// `filter::ratio::tests::the_bias_is_that_of_all_outcomes`
    #[must_use]
    pub fn bias(&self, n: f64) -> f64 {
        let Self { mean, variance, covariance, third, .. } = *self;
        let second = third / mean.powi(3) - 3.0 * covariance * variance / mean.powi(4);
        -covariance / (n * mean * mean) + second / (n * n)
    }
}

/// The moments for samples uniform in the filter's support and a picture that is 1 to the left of an upright edge, 0 beyond.
///
/// * `distance`: of the edge from the pixel's middle, in pixels.
#[must_use]
pub fn edge_ratio_moments(kernel: &Kernel, distance: f64) -> RatioMoments {
    let r = kernel.radius();
    // E over the support of f(x)ᵖf(y)ᵖ, and of it where x is left of the edge.
    let axis = |p: i32, below: f64| {
        let power = |x: f64| if x < below { kernel.eval(x).powi(p) } else { 0.0 };
        piecewise(&power, r, kernel.knots().into_iter().chain([below])) / (2.0 * r)
    };
    let whole = |p: i32| axis(p, r).powi(2);
    let left = |p: i32| axis(p, distance) * axis(p, r);
    let (b, limit) = (whole(1), left(1) / whole(1));
    // E[e·bᵖ] = E[L·bᵖ⁺¹] − μ·E[bᵖ⁺¹]
    let cross = |p: i32| left(p + 1) - limit * whole(p + 1);
    RatioMoments {
        limit,
        mean: b,
        variance: whole(2) - b * b,
        covariance: cross(1),
        third: cross(2) - 2.0 * b * cross(1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights 1 and 2, values 0 and 1, with unequal probabilities: every outcome of 12 and 24 samples, added up.
    #[test]
    fn the_bias_is_that_of_all_outcomes() {
        let outcomes = [(1.0, 0.0, 0.2), (1.0, 1.0, 0.4), (2.0, 0.0, 0.3), (2.0, 1.0, 0.1)];
        let mean = |f: &dyn Fn(f64, f64) -> f64| outcomes.iter().map(|&(w, l, p)| p * f(w, l)).sum::<f64>();
        let b = mean(&|w, _| w);
        let limit = mean(&|w, l| w * l) / b;
        let e = |w: f64, l: f64| w * l - limit * w;
        let moments = RatioMoments {
            limit,
            mean: b,
            variance: mean(&|w, _| (w - b).powi(2)),
            covariance: mean(&|w, l| e(w, l) * w),
            third: mean(&|w, l| e(w, l) * (w - b).powi(2)),
        };
        let exact = |n: i32| {
            let mut sum = 0.0;
            for i in 0..=n {
                for j in 0..=n - i {
                    for k in 0..=n - i - j {
                        let counts = [i, j, k, n - i - j - k];
                        let (mut log, mut top, mut bottom) = (ln_factorial(n), 0.0, 0.0);
                        for (count, (w, l, p)) in counts.into_iter().zip(outcomes) {
                            log += f64::from(count) * p.ln() - ln_factorial(count);
                            top += f64::from(count) * w * l;
                            bottom += f64::from(count) * w;
                        }
                        sum += log.exp() * top / bottom;
                    }
                }
            }
            sum - limit
        };
        for n in [12, 24] {
            let (found, predicted) = (exact(n), moments.bias(f64::from(n)));
            // The next term is of order n⁻³ with a coefficient below 0.2, the size of the moments.
            assert!((found - predicted).abs() < 0.2 / f64::from(n).powi(3), "{n}: {found} {predicted}");
            assert!(predicted.abs() > 10.0 * 0.2 / f64::from(n).powi(3));
        }
    }

    fn ln_factorial(n: i32) -> f64 {
        (1..=n).map(|k| f64::from(k).ln()).sum()
    }

    #[test]
    fn a_box_has_no_bias_and_the_limit_is_the_edge() {
        let bias = edge_ratio_moments(&Kernel::Box { radius: 0.5 }, 0.2).bias(4.0);
        assert!(bias.abs() < 1e-15); // rounding of moments below 1
        let gauss = Kernel::Gaussian { stddev: 0.5, radius: 2.0 };
        assert!((edge_ratio_moments(&gauss, 0.3).limit - gauss.edge(0.3, 0.0)).abs() < 1e-9); // two quadratures at 1e-10
    }
}
