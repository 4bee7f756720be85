//! A choice among several with given weights.

use crate::ParamError;
use crate::math::float::{ONE_MINUS_EPSILON, round_f32};

/// A distribution over 0 to n − 1, proportional to weights.
///
/// # Precision, limits
/// Sums in f64. A weight below 2⁻²⁴ of the sum is met less or more often than its share, as the 24 digits of `u`
/// allow.
///
/// # Source
/// Inversion of the cumulated sum by bisection: Devroye 1986, "Non-uniform random variate generation", section
/// III.2.
///
/// # Verified by
/// `sampling::discrete::tests`; claims `light/choice/*`
#[derive(Debug, Clone, PartialEq)]
pub struct Discrete {
    /// The sum of the weights up to and with each.
    cumulated: Vec<f64>,
}

/// What was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiscreteSample {
    /// Which one.
    pub index: usize,
    /// Its probability.
    pub pmf: f32,
    /// Where `u` was in its share, in [0, 1): a fresh number, of fewer digits by the logarithm of 1/pmf.
    pub u: f32,
}

impl Discrete {
    /// The distribution of `weights`.
    ///
    /// # Errors
    /// `Empty` if all weights are zero or there are none, `NotFinite` and `OutOfRange` on a weight that is not a
    /// number of 0 or more.
    pub fn new(weights: &[f64]) -> Result<Self, ParamError> {
        let mut sum = 0.0;
        let mut cumulated = Vec::with_capacity(weights.len());
        for &value in weights {
            if !value.is_finite() {
                return Err(ParamError::NotFinite { name: "weight", value });
            }
            if value < 0.0 {
                return Err(ParamError::OutOfRange { name: "weight", value, accepted: "0 or more" });
            }
            sum += value;
            cumulated.push(sum);
        }
        if !sum.is_finite() {
            return Err(ParamError::NotFinite { name: "sum of the weights", value: sum });
        }
        if sum == 0.0 {
            return Err(ParamError::Empty { name: "list of weights", accepted: "a weight above 0" });
        }
        Ok(Self { cumulated })
    }

    /// How many there are to choose from.
    pub fn len(&self) -> usize {
        self.cumulated.len()
    }

    /// Whether there is nothing to choose from: never.
    pub fn is_empty(&self) -> bool {
        self.cumulated.is_empty()
    }

    /// The sum of the weights.
    pub fn sum(&self) -> f64 {
        self.cumulated.last().copied().unwrap_or(0.0)
    }

    /// The sum of the weights before `index`.
    fn before(&self, index: usize) -> f64 {
        if index == 0 { 0.0 } else { self.cumulated[index - 1] }
    }

    /// The probability of `index`.
    ///
    /// # Measure
    /// Mass.
    ///
    /// # Panics
    /// If `index` is not below [`len`](Self::len).
    pub fn pmf(&self, index: usize) -> f32 {
        round_f32((self.cumulated[index] - self.before(index)) / self.sum())
    }

    /// Chooses by `u` in [0, 1); never one of weight 0.
    pub fn sample(&self, u: f32) -> DiscreteSample {
        let position = f64::from(u) * self.sum();
        // u is at most 1 − 2⁻²⁴, so that the position is below the sum and one weight lies beyond it.
        let index = self.cumulated.partition_point(|&c| c <= position);
        let (before, after) = (self.before(index), self.cumulated[index]);
        // Rounding to f32 may reach 1 though the quotient doesn't.
        let rest = round_f32((position - before) / (after - before)).min(ONE_MINUS_EPSILON);
        DiscreteSample { index, pmf: self.pmf(index), u: rest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_what_is_left_of_u() {
        let discrete = Discrete::new(&[1.0, 0.0, 3.0]).unwrap();
        assert_eq!(discrete.sample(0.0), DiscreteSample { index: 0, pmf: 0.25, u: 0.0 });
        assert_eq!(discrete.sample(0.125), DiscreteSample { index: 0, pmf: 0.25, u: 0.5 });
        assert_eq!(discrete.sample(0.25), DiscreteSample { index: 2, pmf: 0.75, u: 0.0 });
        assert_eq!(discrete.sample(0.625), DiscreteSample { index: 2, pmf: 0.75, u: 0.5 });
        assert_eq!((discrete.pmf(1), discrete.len(), discrete.sum()), (0.0, 3, 4.0));
        assert!(!discrete.is_empty());
    }

    #[test]
    fn weight_zero_is_never_chosen() {
        let discrete = Discrete::new(&[0.0, 1.0, 0.0, 0.0]).unwrap();
        for u in [0.0, 0.5, ONE_MINUS_EPSILON] {
            assert_eq!(discrete.sample(u), DiscreteSample { index: 1, pmf: 1.0, u });
        }
    }

    #[test]
    fn the_last_u_leaves_less_than_one() {
        for n in 1..200_u16 {
            let weights: Vec<f64> = (1..=n).map(|k| f64::from(k).sqrt()).collect();
            let last = Discrete::new(&weights).unwrap().sample(ONE_MINUS_EPSILON);
            assert!(last.index == usize::from(n) - 1 && last.u < 1.0, "{last:?}");
        }
    }

    #[test]
    fn bad_weights_are_refused() {
        assert!(matches!(Discrete::new(&[]), Err(ParamError::Empty { .. })));
        assert!(matches!(Discrete::new(&[0.0]), Err(ParamError::Empty { .. })));
        assert!(matches!(Discrete::new(&[1.0, -1.0]), Err(ParamError::OutOfRange { value: -1.0, .. })));
        assert!(matches!(Discrete::new(&[f64::NAN]), Err(ParamError::NotFinite { .. })));
        assert!(matches!(Discrete::new(&[f64::MAX, f64::MAX]), Err(ParamError::NotFinite { .. })));
    }
}
