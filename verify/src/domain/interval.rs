use super::{Domain, EDGE_ROUNDING, inside};
use crate::error::InputError;

/// Numbers from a to b; its measure is length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    /// The interval from `low` to `high`.
    ///
    /// # Errors
    /// `Parameter` if its length is not a positive finite number.
    pub fn new(low: f64, high: f64) -> Result<Self, InputError> {
        let length = high - low;
        if !(length > 0.0 && length.is_finite()) {
            return Err(InputError::Parameter {
                name: "length of an interval",
                value: length,
                accepted: "above 0",
            });
        }
        Ok(Self { low, high })
    }

    /// The interval [0, 1).
    pub fn unit() -> Self {
        Self { low: 0.0, high: 1.0 }
    }
}

impl Domain for Interval {
    type Point = f64;

    fn to_square(&self, point: f64) -> Option<[f64; 2]> {
        Some([inside((point - self.low) / (self.high - self.low), EDGE_ROUNDING)?, 0.5])
    }

    fn point(&self, [x, _]: [f64; 2]) -> f64 {
        self.low + x * (self.high - self.low)
    }

    fn measure(&self) -> f64 {
        self.high - self.low
    }

    fn axes(&self) -> [&'static str; 2] {
        ["x", "(one row)"]
    }

    fn name(&self) -> &'static str {
        "interval"
    }

    fn coarse_grid(&self) -> [usize; 2] {
        [200, 1]
    }

    fn refinement(&self) -> [usize; 2] {
        [100, 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_are_inside() {
        let interval = Interval::new(2.0, 4.0).expect("not empty");
        assert_eq!(interval.to_square(2.0), Some([0.0, 0.5]));
        assert!(interval.to_square(4.0).is_some_and(|[x, _]| x < 1.0));
        assert_eq!(interval.to_square(4.1), None);
        assert_eq!(interval.measure(), 2.0);
    }

    #[test]
    fn an_empty_interval_is_refused() {
        assert!(Interval::new(1.0, 1.0).is_err() && Interval::new(0.0, f64::NAN).is_err());
    }
}
