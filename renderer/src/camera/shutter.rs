//! When light reaches the film.

use crate::error::ParamError;

/// An interval of time during which the shutter is fully open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    /// When it opens.
    pub open: f64,
    /// When it closes.
    pub close: f64,
}

impl Shutter {
    /// Open for no time at all, at moment 0.
    pub const INSTANT: Self = Self { open: 0.0, close: 0.0 };

    /// A shutter that opens at `open` and closes at `close`.
    ///
    /// # Errors
    /// A moment that is not finite, or closing before opening.
    pub fn new(open: f64, close: f64) -> Result<Self, ParamError> {
        for (name, value) in [("shutter_open", open), ("shutter_close", close)] {
            if !value.is_finite() {
                return Err(ParamError::NotFinite { name, value });
            }
        }
        if close < open {
            return Err(ParamError::OutOfRange {
                name: "shutter_close",
                value: close,
                accepted: "a moment not before shutter_open",
            });
        }
        Ok(Self { open, close })
    }

    /// How long it is open.
    pub fn length(&self) -> f64 {
        self.close - self.open
    }

    /// The moment t = open + u·(close − open), uniform in time for u uniform in [0, 1).
    ///
    /// # Measure
    /// `pdf_time` = 1 / (close − open).
    pub fn time(&self, u: f32) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "rays carry their time in f32")]
        let time = (self.open + f64::from(u) * self.length()) as f32;
        time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversed_shutter_is_refused() {
        assert!(Shutter::new(1.0, 0.5).unwrap_err().to_string().starts_with("shutter_close is 0.5"));
        assert!(Shutter::new(f64::NAN, 1.0).is_err());
    }

    #[test]
    fn times_span_the_opening() {
        let shutter = Shutter::new(2.0, 4.0).unwrap();
        assert_eq!(shutter.time(0.0), 2.0);
        assert_eq!(shutter.time(0.5), 3.0);
    }
}
