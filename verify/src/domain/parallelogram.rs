use super::{Domain, EDGE_ROUNDING, dot, inside, minus};
use crate::error::InputError;

/// Points o + x·a + y·b in two or three dimensions; its measure is area. Rectangles and the unit square are
/// special cases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parallelogram<const N: usize> {
    origin: [f64; N],
    edges: [[f64; N]; 2],
    /// Vectors whose dot products with p − o are x and y.
    dual: [[f64; N]; 2],
    area: f64,
    /// Distance that counts as rounding: points far from the coordinates' origin have fewer digits left.
    rounding: f64,
}

impl<const N: usize> Parallelogram<N> {
    /// The parallelogram of a corner and the two edges that leave it.
    ///
    /// # Errors
    /// `Parameter` if the area is not a positive finite number.
    pub fn new(origin: [f64; N], edges: [[f64; N]; 2]) -> Result<Self, InputError> {
        let [a, b] = edges;
        let (aa, ab, bb) = (dot(a, a), dot(a, b), dot(b, b));
        let square = aa * bb - ab * ab;
        if !(square > 0.0 && square.is_finite()) {
            return Err(InputError::Parameter { name: "squared area", value: square, accepted: "above 0" });
        }
        let combine = |s: f64, t: f64| std::array::from_fn(|i| (s * a[i] + t * b[i]) / square);
        let dual = [combine(bb, -ab), combine(-ab, aa)];
        let rounding = EDGE_ROUNDING * (dot(origin, origin).sqrt() + aa.sqrt() + bb.sqrt());
        Ok(Self { origin, edges, dual, area: square.sqrt(), rounding })
    }

    /// By how much x and y may miss [0, 1]: what the rounding of a point makes of them.
    pub(super) fn slack(&self) -> [f64; 2] {
        self.dual.map(|dual| self.rounding * dot(dual, dual).sqrt())
    }

    /// x and y of a point, in the parallelogram or not; `None` if it is off the plane.
    pub(super) fn plane_coordinates(&self, point: [f64; N]) -> Option<[f64; 2]> {
        let from_origin = minus(point, self.origin);
        let [x, y] = self.dual.map(|dual| dot(dual, from_origin));
        if N == 2 {
            return Some([x, y]);
        }
        let off_plane = minus(point, self.point([x, y]));
        (dot(off_plane, off_plane) <= self.rounding * self.rounding).then_some([x, y])
    }
}

impl Parallelogram<2> {
    /// The square [0, 1)².
    pub fn unit_square() -> Self {
        let edges = [[1.0, 0.0], [0.0, 1.0]];
        Self { origin: [0.0; 2], edges, dual: edges, area: 1.0, rounding: EDGE_ROUNDING }
    }

    /// The rectangle between two corners, its sides along the axes.
    ///
    /// # Errors
    /// `Parameter` if the area is not a positive finite number.
    pub fn rectangle(low: [f64; 2], high: [f64; 2]) -> Result<Self, InputError> {
        Self::new(low, [[high[0] - low[0], 0.0], [0.0, high[1] - low[1]]])
    }
}

impl<const N: usize> Domain for Parallelogram<N> {
    type Point = [f64; N];

    fn to_square(&self, point: [f64; N]) -> Option<[f64; 2]> {
        let [x, y] = self.plane_coordinates(point)?;
        let [slack_x, slack_y] = self.slack();
        Some([inside(x, slack_x)?, inside(y, slack_y)?])
    }

    fn point(&self, [x, y]: [f64; 2]) -> [f64; N] {
        let [a, b] = self.edges;
        std::array::from_fn(|i| self.origin[i] + x * a[i] + y * b[i])
    }

    fn measure(&self) -> f64 {
        self.area
    }

    fn axes(&self) -> [&'static str; 2] {
        ["x", "y"]
    }

    fn name(&self) -> &'static str {
        "parallelogram"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_and_outside() {
        let skewed = Parallelogram::new([1.0, 1.0], [[2.0, 0.0], [1.0, 1.0]]).expect("not degenerate");
        assert_eq!(skewed.to_square([1.0, 1.0]), Some([0.0, 0.0]));
        assert!(skewed.to_square([4.0, 2.0]).is_some());
        assert_eq!(skewed.to_square([1.0, 2.0]), None);
        assert_eq!(skewed.measure(), 2.0);
    }

    #[test]
    fn a_point_off_the_plane_is_outside() {
        let floor = Parallelogram::new([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).expect("not degenerate");
        assert!(floor.to_square([0.5, 0.5, 1e-7]).is_some());
        assert_eq!(floor.to_square([0.5, 0.5, 1e-3]), None);
        assert_eq!(floor.to_square([0.5, 0.5, f64::NAN]), None);
    }

    #[test]
    fn the_unit_square_is_the_rectangle_from_0_to_1() {
        let square = Parallelogram::unit_square();
        assert_eq!(square.to_square([0.25, 0.75]), Some([0.25, 0.75]));
        let rectangle = Parallelogram::rectangle([0.0; 2], [1.0; 2]).expect("not empty");
        assert_eq!(rectangle.to_square([0.25, 0.75]), Some([0.25, 0.75]));
        assert!(Parallelogram::rectangle([0.0; 2], [1.0, 0.0]).is_err());
    }
}
