use crate::estimate::Moments;
use crate::tails::{normal_quantile, t_quantile, t_tail};

/// A sum over pixels with the variance of that sum and the degrees of freedom with which the variance is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sum {
    pub(super) mean: f64,
    pub(super) variance: f64,
    /// While pixels are added: the sum of squared variances.
    pub(super) dof: f64,
}

impl Sum {
    /// The mean over replicates of the whole sum.
    pub(super) fn over_replicates(replicates: &[f64]) -> Self {
        let moments: Moments = replicates.iter().copied().collect();
        let count = moments.count() as f64;
        Self { mean: moments.mean(), variance: moments.variance() / count, dof: count - 1.0 }
    }

    /// Adds an independent pixel.
    pub(super) fn add(&mut self, [mean, variance]: [f64; 2]) {
        self.mean += mean;
        self.variance += variance;
        self.dof += variance * variance;
    }

    /// Turns the sum of squared variances into degrees of freedom, ν(Σv)²/Σv² (Satterthwaite 1946, 10.2307/3002019).
    ///
    /// With ν degrees of freedom a pixel, E[v²] = σ⁴(1 + 2/ν), so the result is too small by up to that factor: on the safe side.
    pub(super) fn finish(&mut self, dof: f64) {
        self.dof = if self.variance > 0.0 { dof * self.variance * self.variance / self.dof } else { dof };
    }

    /// The sum over channels whose dependence is unknown: its standard error is at most the sum of the channels'.
    pub(super) fn of_dependent(channels: &[Self]) -> Self {
        let error: f64 = channels.iter().map(|sum| sum.variance.sqrt()).sum();
        Self {
            mean: channels.iter().map(|sum| sum.mean).sum(),
            variance: error * error,
            dof: channels.iter().map(|sum| sum.dof).fold(f64::INFINITY, f64::min),
        }
    }
}

/// The difference of two independent sums.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Difference {
    pub(super) value: f64,
    pub(super) error: f64,
    pub(super) dof: f64,
    pub(super) t: f64,
}

impl Difference {
    /// Welch's difference of two means; a difference of at most `rounding` counts as none.
    ///
    /// # Source
    /// Welch 1947, 10.1093/biomet/34.1-2.28.
    pub(super) fn of(a: Sum, b: Sum, rounding: f64) -> Self {
        let variance = a.variance + b.variance;
        let dof = if variance > 0.0 {
            variance * variance / (a.variance * a.variance / a.dof + b.variance * b.variance / b.dof)
        } else {
            a.dof.min(b.dof)
        };
        let value = a.mean - b.mean;
        let beyond = (value.abs() - rounding).max(0.0);
        let t = if beyond > 0.0 { (beyond / variance.sqrt()).copysign(value) } else { 0.0 };
        Self { value, error: variance.sqrt(), dof, t }
    }

    /// Two-sided probability of so large a difference between equal means.
    pub(super) fn p_value(&self) -> f64 {
        2.0 * t_tail(self.t.abs(), self.dof)
    }

    /// The standard normal number with the same tail as t; capped where the tail underflows.
    pub(super) fn normal_score(&self) -> f64 {
        // The cap is the score of the smallest normal f64: 37.5.
        normal_quantile(t_tail(self.t.abs(), self.dof).max(f64::MIN_POSITIVE))
    }

    /// Half the width of the interval that covers the difference with probability 1 − `level`.
    pub(super) fn half_width(&self, level: f64) -> f64 {
        t_quantile(0.5 * level, self.dof) * self.error
    }
}
