use super::{BELOW_ONE, Domain, Parallelogram, inside};
use crate::error::InputError;

/// Points of a triangle in two or three dimensions; its measure is area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle<const N: usize> {
    /// The plane's frame: first vertex, and the edges to the other two.
    frame: Parallelogram<N>,
}

impl<const N: usize> Triangle<N> {
    /// The triangle of three vertices.
    ///
    /// # Errors
    /// `Parameter` if the area is not a positive finite number.
    pub fn new([a, b, c]: [[f64; N]; 3]) -> Result<Self, InputError> {
        let edge = |to: [f64; N]| super::minus(to, a);
        Ok(Self { frame: Parallelogram::new(a, [edge(b), edge(c)])? })
    }
}

impl<const N: usize> Domain for Triangle<N> {
    type Point = [f64; N];

    /// With barycentric coordinates b and c of the second and third vertex: the square of s = b + c, since
    /// the strip between s and s + ds has area proportional to s ds, and the place along that strip, c/s.
    fn to_square(&self, point: [f64; N]) -> Option<[f64; 2]> {
        let [b, c] = self.frame.plane_coordinates(point)?;
        let [slack_b, slack_c] = self.frame.slack();
        let (b, c) = (inside(b, slack_b)?, inside(c, slack_c)?);
        let s = b + c;
        let strip = inside(s * s, 2.0 * (slack_b + slack_c))?;
        Some([strip, if s > 0.0 { (c / s).min(BELOW_ONE) } else { 0.0 }])
    }

    fn point(&self, [strip, along]: [f64; 2]) -> [f64; N] {
        let s = strip.sqrt();
        self.frame.point([s * (1.0 - along), s * along])
    }

    fn measure(&self) -> f64 {
        0.5 * self.frame.measure()
    }

    fn axes(&self) -> [&'static str; 2] {
        ["(b + c)²", "c/(b + c)"]
    }

    fn name(&self) -> &'static str {
        "triangle"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_inside_and_the_other_half_is_not() {
        let triangle = Triangle::new([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).expect("not degenerate");
        assert_eq!(triangle.to_square([0.0, 0.0]), Some([0.0, 0.0]));
        assert!(triangle.to_square([1.0, 0.0]).is_some_and(|[x, y]| x < 1.0 && y == 0.0));
        assert!(triangle.to_square([0.0, 1.0]).is_some_and(|[x, y]| x < 1.0 && y < 1.0));
        assert_eq!(triangle.to_square([0.6, 0.6]), None);
        assert_eq!(triangle.measure(), 0.5);
    }

    #[test]
    fn a_degenerate_triangle_is_refused() {
        assert!(Triangle::new([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).is_err());
    }
}
