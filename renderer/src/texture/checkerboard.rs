//! Two values in turn, on squares of half a unit.

use glam::{Affine2, Vec2};

use super::range_of;
use crate::error::ParamError;
use crate::math::Rgb;

/// A checkerboard with two squares to a unit in each direction.
///
/// The first colour is where the fractional parts of both transformed coordinates are on the same side of ½
/// (½ itself belongs to the lower side).
///
/// # Source
/// The plugin `checkerboard` of Mitsuba 3.9.1, measured at points on and beside the edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checkerboard {
    colors: [Rgb; 2],
    to_uv: Affine2,
}

impl Checkerboard {
    /// The board of two colours; `to_uv` is applied to the surface coordinates first.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`] when the transform has an entry that is not finite.
    pub fn new(colors: [Rgb; 2], to_uv: Affine2) -> Result<Self, ParamError> {
        check_to_uv(to_uv)?;
        Ok(Self { colors, to_uv })
    }

    /// The same with its two values exchanged.
    #[must_use]
    pub fn exchanged(self) -> Self {
        let [a, b] = self.colors;
        Self { colors: [b, a], ..self }
    }

    /// The value at the surface coordinates `uv`.
    pub fn eval(&self, uv: [f32; 2]) -> Rgb {
        let p = self.to_uv.transform_point2(Vec2::from(uv));
        let upper = [p.x - p.x.floor() > 0.5, p.y - p.y.floor() > 0.5];
        self.colors[usize::from(upper[0] != upper[1])]
    }

    pub(super) fn range(&self) -> [f32; 2] {
        range_of(self.colors)
    }

    pub(super) fn mean(&self) -> f32 {
        (self.colors[0].mean() + self.colors[1].mean()) / 2.0
    }
}

/// Checks a transform of surface coordinates.
pub(super) fn check_to_uv(to_uv: Affine2) -> Result<(), ParamError> {
    match to_uv.to_cols_array().into_iter().find(|v| !v.is_finite()) {
        Some(value) => Err(ParamError::NotFinite { name: "to_uv", value: f64::from(value) }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_and_edges_are_those_of_mitsuba() {
        let colors = [Rgb::splat(0.1), Rgb::splat(0.6)];
        let board = Checkerboard::new(colors, Affine2::from_scale(Vec2::new(2.0, 3.0))).unwrap();
        // Which colour Mitsuba 3.9.1 returned for the same board with to_uv = scale(2, 3).
        let asked = [
            ([0.0, 0.0], 0),
            ([0.1, 0.1], 0),
            ([0.3, 0.1], 1),
            ([0.1, 0.3], 1),
            ([0.25, 0.1], 0),
            ([0.3, 0.2], 0),
            ([0.51, 0.1], 0),
            ([-0.1, 0.1], 1),
            ([-0.3, 0.1], 0),
        ];
        for (uv, which) in asked {
            assert_eq!(board.eval(uv), colors[which], "{uv:?}");
        }
    }

    #[test]
    fn a_transform_with_nan_is_refused() {
        let bad = Affine2::from_scale(Vec2::new(1.0, f32::NAN));
        assert!(matches!(Checkerboard::new([Rgb::BLACK; 2], bad), Err(ParamError::NotFinite { .. })));
    }
}
