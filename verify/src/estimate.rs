//! An estimate is a mean and its standard error over independent replicates, never one without the other.

/// Share of one sample above which normal theory is not trusted.
pub const LARGEST_SHARE: f64 = 0.05;

/// One replicate's mean: what an estimator gave from one seed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replicate {
    /// Mean of the replicate's samples.
    pub mean: f64,
    /// The largest absolute contribution of a single sample to this mean, |x|/n; 0 where no record is kept.
    pub largest: f64,
}

impl From<f64> for Replicate {
    fn from(mean: f64) -> Self {
        Self { mean, largest: 0.0 }
    }
}

/// A mean, its standard error, and what the error rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Mean over replicates.
    pub mean: f64,
    /// Standard deviation of that mean, s/√R; NaN with one replicate, whose error is unknown.
    pub standard_error: f64,
    /// Number R of independent replicates.
    pub replicates: u64,
    /// The largest single sample's contribution, as a share of the sum of |replicate means|; 0 where unknown.
    pub largest_share: f64,
}

/// Running mean and sum of squared deviations, which can be merged.
///
/// # Source
/// Welford 1962, 10.1080/00401706.1962.10490022; merging: Chan and others 1983, 10.1080/00031305.1983.10483115.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    count: u64,
    mean: f64,
    squares: f64,
    absolute: f64,
    largest: f64,
}

impl Moments {
    /// Adds one replicate.
    pub fn push(&mut self, replicate: impl Into<Replicate>) {
        let Replicate { mean, largest } = replicate.into();
        self.merge(&Self { count: 1, mean, squares: 0.0, absolute: mean.abs(), largest });
    }

    /// Adds all that `other` has seen.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let total = (self.count + other.count) as f64;
        let apart = other.mean - self.mean;
        let share = other.count as f64 / total;
        self.squares += other.squares + apart * apart * share * self.count as f64;
        self.mean += apart * share;
        self.count += other.count;
        self.absolute += other.absolute;
        self.largest = self.largest.max(other.largest);
    }

    /// Number of replicates seen.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Mean of the replicates seen; 0 for none.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased variance of one replicate, Σ(x − m)²/(R − 1); NaN for fewer than two.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.squares / (self.count - 1) as f64 }
    }

    /// The estimate.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        let share = if self.largest > 0.0 { self.largest / self.absolute } else { 0.0 };
        Estimate {
            mean: self.mean,
            standard_error: (self.variance() / self.count as f64).sqrt(),
            replicates: self.count,
            largest_share: share,
        }
    }
}

impl<R: Into<Replicate>> FromIterator<R> for Moments {
    fn from_iter<I: IntoIterator<Item = R>>(replicates: I) -> Self {
        let mut moments = Self::default();
        replicates.into_iter().for_each(|replicate| moments.push(replicate));
        moments
    }
}

impl Estimate {
    /// The estimate from replicates.
    #[must_use]
    pub fn of(replicates: &[Replicate]) -> Self {
        replicates.iter().copied().collect::<Moments>().estimate()
    }

    /// Why normal theory is not trusted for this estimate, if so.
    #[must_use]
    pub fn doubt(&self) -> Option<String> {
        (self.largest_share > LARGEST_SHARE || self.largest_share.is_nan()).then(|| {
            let percent = 100.0 * self.largest_share;
            format!("normal theory is not trusted: one sample makes up {percent:.1} % of the sum")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_the_textbook_formulas() {
        let estimate = Estimate::of(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].map(Replicate::from));
        assert_eq!((estimate.mean, estimate.replicates), (5.0, 8));
        // Σ(x − 5)² = 32, so s² = 32/7 and s/√8; two roundings of 1.1e-16.
        assert!((estimate.standard_error - (32.0_f64 / 7.0 / 8.0).sqrt()).abs() < 2.3e-16);
    }

    #[test]
    fn merging_equals_pushing_and_keeps_the_digits_of_a_large_offset() {
        let values: Vec<f64> = (0..1000).map(|i| 1e9 + f64::from(i % 10)).collect();
        let mut merged: Moments = values[..300].iter().copied().collect();
        merged.merge(&values[300..].iter().copied().collect());
        merged.merge(&Moments::default());
        // Variance of 0..9 repeated: 8.25·1000/999; spacing of f64 at 1e9 is 1.2e-7, over √1000 terms 4e-9 each.
        assert!((merged.variance() - 8.25 * 1000.0 / 999.0).abs() < 1e-6);
        assert_eq!(merged.count(), 1000);
    }

    #[test]
    fn one_replicate_has_no_error_and_a_heavy_sample_raises_a_doubt() {
        assert!(Estimate::of(&[1.0.into()]).standard_error.is_nan());
        let light = vec![Replicate { mean: 1.0, largest: 0.1 }; 32];
        assert_eq!(Estimate::of(&light).doubt(), None);
        let mut heavy = light;
        heavy[7] = Replicate { mean: 3.0, largest: 2.0 }; // 2/34 = 5.9 %
        assert!(Estimate::of(&heavy).doubt().is_some());
    }
}
