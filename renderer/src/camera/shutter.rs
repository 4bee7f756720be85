//! When light reaches the film.

use crate::error::ParamError;
use crate::sampling::warp::unit_to_tent;

/// How far the shutter is open, over its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Opening {
    /// Fully, all the time.
    #[default]
    Box,
    /// Opening and closing linearly, fully open in the middle of its time only.
    Triangle,
}

impl Opening {
    /// Every opening, with its name in scene files.
    pub const ALL: [(&'static str, Self); 2] = [("box", Self::Box), ("triangle", Self::Triangle)];
}

/// An interval of time during which light reaches the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    /// When it opens.
    pub open: f64,
    /// When it closes.
    pub close: f64,
    /// How far it is open in between.
    pub opening: Opening,
}

impl Shutter {
    /// Open for no time at all, at moment 0.
    pub const INSTANT: Self = Self { open: 0.0, close: 0.0, opening: Opening::Box };

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
        Ok(Self { open, close, opening: Opening::Box })
    }

    /// The same times with another opening.
    pub fn with_opening(self, opening: Opening) -> Self {
        Self { opening, ..self }
    }

    /// How long it is open.
    pub fn length(&self) -> f64 {
        self.close - self.open
    }

    /// The moment open + s·(close − open): s = u, uniform, under a box; s = ½ + a tent of radius ½ under a triangle.
    ///
    /// # Measure
    /// `pdf_time` = 1 / (close − open) under a box; that times 2 − |4s − 2| under a triangle.
    ///
    /// # Verified by
    /// claims `shutter/time/*`, `shutter/edge/*`
    pub fn time(&self, u: f32) -> f32 {
        let share = match self.opening {
            Opening::Box => u,
            Opening::Triangle => 0.5 + unit_to_tent(u, 0.5),
        };
        #[expect(clippy::cast_possible_truncation, reason = "rays carry their time in f32")]
        let time = (self.open + f64::from(share) * self.length()) as f32;
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
        let triangle = shutter.with_opening(Opening::Triangle);
        assert_eq!([0.0, 0.125, 0.5, 0.875].map(|u| triangle.time(u)), [2.0, 2.5, 3.0, 3.5]); // s²·2 = u below ½
    }
}
