//! Light from one point into a cone.

use glam::Vec3;

use crate::ParamError;
use crate::math::Rgb;

/// A point that shines into a cone about its axis: with its whole intensity up to the angle `beam`, then falling in
/// proportion to the angle, to nothing at `cutoff`.
///
/// # Source
/// The plugin `spot` of Mitsuba 3.9.1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Position in the render frame.
    pub position: Vec3,
    /// Unit vector along the middle of the cone.
    axis: Vec3,
    /// Intensity [W sr⁻¹] in the middle.
    pub intensity: Rgb,
    /// Half angles in radians.
    beam: f32,
    cutoff: f32,
}

impl Spot {
    /// The spot at `position` about the unit vector `axis`; half angles in degrees, 0 ≤ `beam` ≤ `cutoff` ≤ 180.
    ///
    /// # Errors
    /// `OutOfRange` for other angles.
    pub fn new(
        position: Vec3,
        axis: Vec3,
        intensity: Rgb,
        [beam, cutoff]: [f32; 2],
    ) -> Result<Self, ParamError> {
        check_angles([beam, cutoff].map(f64::from))?;
        let [beam, cutoff] = [beam, cutoff].map(f32::to_radians);
        Ok(Self { position, axis, intensity, beam, cutoff })
    }

    /// The intensity [W sr⁻¹] in the direction of the unit vector `w`, away from the light.
    pub fn towards(&self, w: Vec3) -> Rgb {
        // Half of it by the chords to the axis and to its opposite, which keep the digits of small angles and of large ones.
        let angle = 2.0 * libm::atan2f((w - self.axis).length(), (w + self.axis).length());
        if angle <= self.beam {
            self.intensity
        } else if angle < self.cutoff {
            self.intensity * ((self.cutoff - angle) / (self.cutoff - self.beam))
        } else {
            Rgb::BLACK
        }
    }
}

/// Checks the half angles of a spot \[degrees\].
///
/// # Errors
/// `OutOfRange` unless 0 ≤ `beam` ≤ `cutoff` ≤ 180 and 0 < `cutoff`.
pub fn check_angles([beam, cutoff]: [f64; 2]) -> Result<(), ParamError> {
    let check = |holds, name, value, accepted| {
        if holds { Ok(()) } else { Err(ParamError::OutOfRange { name, value, accepted }) }
    };
    check(cutoff > 0.0 && cutoff <= 180.0, "cutoff_angle", cutoff, "an angle in (0, 180] degrees")?;
    check((0.0..=cutoff).contains(&beam), "beam_width", beam, "an angle from 0 to cutoff_angle")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cone_is_mitsubas() {
        let spot = Spot::new(Vec3::ZERO, Vec3::Z, Rgb::WHITE, [22.5, 30.0]).unwrap();
        // Mitsuba 3.9.1's intensity over the squared distance at (x, 0, 1), of a spot with a cutoff angle of 30°.
        let theirs =
            [(0.0, 1.0), (0.3, 0.917431), (0.45, 0.640029), (0.5, 0.366395), (0.55, 0.121736), (0.6, 0.0)];
        for (x, expected) in theirs {
            let p = Vec3::new(x, 0.0, 1.0);
            let got = spot.towards(p.normalize()).g / p.length_squared();
            // Six digits, and an angle's rounding of 2⁻²² over the transition of 0.13.
            assert!((got - expected).abs() < 4e-6, "{x}: {got}");
        }
        assert_eq!(spot.towards(Vec3::NEG_Z), Rgb::BLACK);
        assert!(Spot::new(Vec3::ZERO, Vec3::Z, Rgb::WHITE, [31.0, 30.0]).is_err());
    }
}
