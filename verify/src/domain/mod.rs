//! Where samples live: each domain maps its points to the unit square such that equal areas there have equal
//! measure.
//!
//! So every cell of a regular grid on the unit square has the same share of the domain's measure, whatever
//! the domain, and one histogram, one quadrature and one chi-square test serve them all.

mod directions;
mod disk;
mod interval;
mod parallelogram;
mod spherical_rectangle;
mod spherical_triangle;
mod triangle;

pub use directions::Directions;
pub use disk::Disk;
pub use interval::Interval;
pub use parallelogram::Parallelogram;
pub use spherical_rectangle::SphericalRectangle;
pub use spherical_triangle::SphericalTriangle;
pub use triangle::Triangle;

/// Relative distance by which a point may miss its domain, since points made in single precision miss it by
/// rounding.
///
/// A few roundings of 2⁻²⁴ = 6e-8 each stay below it; a share of 1e-6 of the measure is below the resolution
/// of any test of less than 10¹² points.
pub const EDGE_ROUNDING: f64 = 1e-6;

/// The largest number below 1: coordinates of points on the far edge.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// A set of points with a measure (length, area, solid angle), and a measure-preserving map to the unit
/// square.
pub trait Domain: Send + Sync + 'static {
    /// What a point is, such as `[f64; 3]`.
    type Point: Copy;

    /// Maps a point to the unit square.
    ///
    /// Returns: coordinates in [0, 1)², uniform when points are uniform on the domain; `None` if the point is
    /// outside by more than [`EDGE_ROUNDING`], or not a number.
    fn to_square(&self, point: Self::Point) -> Option<[f64; 2]>;

    /// The point of given coordinates in [0, 1]²; the inverse of [`to_square`](Self::to_square).
    fn point(&self, square: [f64; 2]) -> Self::Point;

    /// Length, area or solid angle of the whole domain, in the unit of its densities.
    fn measure(&self) -> f64;

    /// What the two coordinates are.
    fn axes(&self) -> [&'static str; 2];

    /// Name in reports.
    fn name(&self) -> &'static str;

    /// Columns and rows of the coarse grid, about 200 cells.
    fn coarse_grid(&self) -> [usize; 2] {
        [14, 14]
    }

    /// Into how many columns and rows each coarse cell is divided for the fine grid: about 100 cells.
    fn refinement(&self) -> [usize; 2] {
        [10, 10]
    }
}

/// Brings a coordinate that misses [0, 1) by rounding into it.
///
/// Returns: `None` if it misses by more than `slack`, or is not a number.
#[inline]
fn inside(x: f64, slack: f64) -> Option<f64> {
    (x >= -slack && x <= 1.0 + slack).then(|| x.clamp(0.0, BELOW_ONE))
}

/// The angle of a point about the origin, as a share of the full circle in [0, 1).
///
/// Folded to the eighth about an axis, where the tangent t is at most √2 − 1, and there arctan t as its
/// series to t²¹: in less time than `atan2`, and every point of a
/// disk or sphere needs it.
///
/// # Precision, limits
/// Absolute error below 2e-11, of which t²³/23/2π = 1.2e-11 is the series'.
/// `domain::tests::turns_agree_with_atan2`.
#[inline]
fn turn(x: f64, y: f64) -> f64 {
    let (ax, ay) = (x.abs(), y.abs());
    let (near, far) = (ax.min(ay), ax.max(ay));
    let folded = near > FOLD * far;
    let (numerator, denominator) = if folded { (near - far, near + far) } else { (near, far) };
    let t = numerator / denominator.max(f64::MIN_POSITIVE);
    let square = t * t;
    let series = ARCTAN.iter().rev().fold(0.0, |sum, &term| f64::mul_add(sum, square, term));
    let eighth = t * series / std::f64::consts::TAU + if folded { 0.125 } else { 0.0 };
    let quarter = mirror(0.125, eighth, ax - ay);
    let half = mirror(0.25, quarter, x);
    mirror(0.5, half, y).min(BELOW_ONE)
}

/// `value` where `sign` is positive, else its mirror image in `centre`; without a branch, which random signs
/// would mispredict.
#[inline]
fn mirror(centre: f64, value: f64, sign: f64) -> f64 {
    centre - (centre - value).copysign(sign)
}

/// tan(π/8) = √2 − 1.
const FOLD: f64 = std::f64::consts::SQRT_2 - 1.0;

/// Coefficients of arctan t / t in powers of t²: (−1)ᵏ/(2k + 1).
const ARCTAN: [f64; 11] = [
    1.0,
    -1.0 / 3.0,
    1.0 / 5.0,
    -1.0 / 7.0,
    1.0 / 9.0,
    -1.0 / 11.0,
    1.0 / 13.0,
    -1.0 / 15.0,
    1.0 / 17.0,
    -1.0 / 19.0,
    1.0 / 21.0,
];

#[inline]
fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn minus<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// Whether a vector's length is 1, as far as single precision says.
#[inline]
fn is_unit(a: [f64; 3]) -> bool {
    (dot(a, a) - 1.0).abs() <= 2.0 * EDGE_ROUNDING
}

#[cfg(test)]
pub(crate) mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Asserts that point and coordinates are inverse, at given coordinates.
    pub(crate) fn assert_round_trip<D: Domain>(domain: &D, square: [f64; 2], tolerance: f64) {
        let back = domain.to_square(domain.point(square)).expect("a domain contains its own points");
        for (a, b) in square.iter().zip(back) {
            assert!((a - b).abs() < tolerance, "{square:?} came back as {back:?} on {}", domain.name());
        }
    }

    /// Asserts that the map stretches every part alike: |∂p/∂x × ∂p/∂y| = measure, by central differences.
    pub(crate) fn assert_equal_measure<D: Domain<Point = [f64; N]>, const N: usize>(
        domain: &D,
        [x, y]: [f64; 2],
    ) {
        const H: f64 = 1e-5;
        let difference = |a: [f64; N], b: [f64; N]| minus(a, b).map(|d| d / (2.0 * H));
        let dx = difference(domain.point([x + H, y]), domain.point([x - H, y]));
        let dy = difference(domain.point([x, y + H]), domain.point([x, y - H]));
        let area = (dot(dx, dx) * dot(dy, dy) - dot(dx, dy).powi(2)).sqrt();
        // Differences of H = 1e-5 err by H²·p'''/6, and p''' grows as x^(-5/2) of the distance to a pole: 1e-10·20^2.5 < 2e-7 at x = 0.05.
        assert!((area / domain.measure() - 1.0).abs() < 1e-6, "{area} at {x}, {y} on {}", domain.name());
    }

    proptest! {
        #[test]
        fn points_come_back_and_cells_have_equal_measure(x in 0.05..0.95f64, y in 0.05..0.95f64) {
            let square = [x, y];
            let triangle = Triangle::new([[0.0, 1.0, 2.0], [3.0, 1.0, 0.0], [1.0, -1.0, 1.0]]).expect("not degenerate");
            let parallelogram = Parallelogram::new([1.0, 2.0, 3.0], [[1.0, 0.0, 1.0], [0.0, 2.0, 1.0]]).expect("not degenerate");
            assert_equal_measure(&triangle, square);
            assert_equal_measure(&parallelogram, square);
            assert_equal_measure(&Disk::of_radius(0.3), square);
            for directions in [Directions::sphere(), Directions::hemisphere(), Directions::cone(0.7)] {
                assert_equal_measure(&directions, square);
                assert_round_trip(&directions, square, 2e-11); // of the angle; rounding of the rest is at most ε/0.05
            }
            assert_round_trip(&triangle, square, 1e-12); // rounding, times at most 1/0.05 near the corner
            assert_round_trip(&parallelogram, square, 1e-12); // the same
            assert_round_trip(&Disk::unit(), square, 2e-11); // of the angle
            assert_round_trip(&Interval::new(-2.0, 5.0).expect("not empty"), [x, 0.5], 1e-12); // the same
        }
    }

    #[test]
    fn turns_agree_with_atan2() {
        for i in 0..100_000 {
            let exact = f64::from(i) / 100_000.0;
            let (sin, cos) = (exact * std::f64::consts::TAU).sin_cos();
            for radius in [1e-200, 1.0, 1e100] {
                let error = (turn(radius * cos, radius * sin) - exact).abs();
                assert!(error < 2e-11, "{error:e} at {exact}"); // the first term left out, (√2 − 1)²³/23/2π = 1.1e-11, and rounding
            }
        }
        assert_eq!(
            [turn(0.0, 0.0), turn(1.0, 0.0), turn(0.0, 1.0), turn(-1.0, 0.0), turn(0.0, -1.0)],
            [0.0, 0.0, 0.25, 0.5, 0.75]
        );
    }

    #[test]
    fn edges_are_inside_and_beyond_is_outside() {
        assert_eq!(inside(1.0, EDGE_ROUNDING), Some(BELOW_ONE));
        assert_eq!(inside(1.0 + 2e-6, EDGE_ROUNDING), None);
        assert_eq!(inside(-1e-7, EDGE_ROUNDING), Some(0.0));
        assert_eq!(inside(f64::NAN, EDGE_ROUNDING), None);
        assert!(turn(1.0, -1e-300) < 1.0);
    }
}
