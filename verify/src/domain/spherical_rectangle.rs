use super::{Domain, SphericalTriangle, add, inside};
use crate::error::InputError;

/// Unit vectors towards a parallelogram in space, such as an area light's; its measure is solid angle.
///
/// Two spherical triangles that share a corner and the diagonal from it: the arcs from that corner sweep one, then the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalRectangle {
    halves: [SphericalTriangle; 2],
    /// The first half's share of the solid angle.
    split: f64,
}

impl SphericalRectangle {
    /// The rectangle as seen from the origin.
    ///
    /// * `corner`: relative to the point that sees it; `edges`: the two sides that leave that corner.
    ///
    /// # Errors
    /// `Parameter` if the solid angle is not a positive finite number: the origin must not be in the rectangle's plane.
    pub fn new(corner: [f64; 3], [a, b]: [[f64; 3]; 2]) -> Result<Self, InputError> {
        let (right, far, left) = (add(corner, a), add(add(corner, a), b), add(corner, b));
        let first = SphericalTriangle::new([right, corner, far])?;
        let second = SphericalTriangle::new([far, corner, left])?;
        let split = first.measure() / (first.measure() + second.measure());
        Ok(Self { halves: [first, second], split })
    }
}

impl Domain for SphericalRectangle {
    type Point = [f64; 3];

    /// The share of the area that the arc from the corner has swept, and (1 − cos θ) as a share of that at the arc's end.
    fn to_square(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        let [first, second] = &self.halves;
        let ([swept, along], slack) = first.coordinates(point)?;
        if swept <= 1.0 {
            return Some([inside(swept, slack)? * self.split, inside(along, 2.0 * first.slack())?]);
        }
        let ([swept, along], slack) = second.coordinates(point)?;
        let swept = inside(swept, slack)?;
        let x = self.split + swept * (1.0 - self.split);
        Some([inside(x, slack)?, inside(along, 2.0 * second.slack())?])
    }

    fn point(&self, [swept, along]: [f64; 2]) -> [f64; 3] {
        if swept < self.split {
            return self.halves[0].point([swept / self.split, along]);
        }
        self.halves[1].point([(swept - self.split) / (1.0 - self.split), along])
    }

    fn measure(&self) -> f64 {
        self.halves.iter().map(Domain::measure).sum()
    }

    fn axes(&self) -> [&'static str; 2] {
        ["swept area", "(1 − cos θ)/(1 − cos θmax)"]
    }

    fn name(&self) -> &'static str {
        "spherical rectangle"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::tests::{assert_equal_measure, assert_round_trip};
    use crate::domain::unit;
    use crate::irradiance::parallel_rectangle_solid_angle;

    fn light(distance: f64) -> SphericalRectangle {
        SphericalRectangle::new([-1.0, -0.5, distance], [[3.0, 0.0, 0.0], [0.0, 1.5, 0.0]]).expect("seen")
    }

    #[test]
    fn the_solid_angle_is_the_closed_form() {
        for distance in [0.1, 1.0, 10.0] {
            let exact = parallel_rectangle_solid_angle([-1.0, 2.0], [-0.5, 1.0], distance);
            assert!((light(distance).measure() / exact - 1.0).abs() < 1e-13); // four terms of few roundings each
        }
    }

    #[test]
    fn rectangles_near_and_far_are_mapped_evenly_and_back() {
        for distance in [0.3, 2.0, 1e3] {
            for square in [[0.1, 0.2], [0.4, 0.7], [0.6, 0.5], [0.9, 0.9]] {
                if distance < 10.0 {
                    assert_equal_measure(&light(distance), square);
                }
                // A direction's rounding of 2e-16 over the light's angle, times some tens near the corner.
                assert_round_trip(&light(distance), square, 1e-14 * (distance + 1.0));
            }
        }
    }

    #[test]
    fn directions_to_the_light_are_inside_and_others_not() {
        let light = light(2.0);
        for [x, y] in [[0.0, 0.0], [0.2, 0.9], [0.9, 0.2], [1.0, 1.0], [0.5, 0.5]] {
            let point = |x: f64, y: f64| unit([-1.0 + 3.0 * x, -0.5 + 1.5 * y, 2.0]);
            assert!(light.to_square(point(x, y)).is_some(), "{x} {y}");
            for outside in [point(x, 1.01), point(1.01, y), point(x, -0.01), point(-0.01, y)] {
                assert_eq!(light.to_square(outside), None);
            }
            assert_eq!(light.to_square(point(x, y).map(|v| -v)), None);
        }
    }

    #[test]
    fn a_rectangle_seen_on_edge_is_refused() {
        assert!(SphericalRectangle::new([1.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).is_err());
    }
}
