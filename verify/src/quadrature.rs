//! Integrals to a stated error, by adaptive Gauss–Kronrod rules in one and two dimensions.
//!
//! The interval or rectangle is divided where the estimated error is largest, across the axis that causes it,
//! until the sum of the estimates is small enough or too many pieces are needed. So a jump, a kink or an
//! integrable singularity costs pieces along it, and what was not reached is reported instead of hidden.

use std::collections::BinaryHeap;

/// Positive abscissae of the Kronrod rule of 7 points on [−1, 1]; the second is also one of the Gauss rule of
/// 3 points.
const ABSCISSAE: [f64; 3] = [0.960_491_268_708_020_3, 0.774_596_669_241_483_4, 0.434_243_749_346_802_56];

/// Weights of the 7 points, in the order of [`nodes`]; exact for polynomials of degree 11.
const KRONROD: [f64; 7] = symmetric(
    [0.104_656_226_026_467_27, 0.268_488_089_868_333_44, 0.401_397_414_775_962_22],
    0.450_916_538_658_474_14,
);

/// Weights of the Gauss rule of 3 points among the same nodes; exact for polynomials of degree 5.
const GAUSS: [f64; 7] = symmetric([0.0, 5.0 / 9.0, 0.0], 8.0 / 9.0);

const fn symmetric([a, b, c]: [f64; 3], middle: f64) -> [f64; 7] {
    [a, b, c, middle, c, b, a]
}

/// When an integral is good enough, and when to give up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Error accepted, relative to the integral.
    pub relative: f64,
    /// Error accepted however small the integral is.
    pub absolute: f64,
    /// Number of pieces after which the error reached is returned as it is.
    pub pieces: usize,
}

/// An integral and how well it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integral {
    /// Its value.
    pub value: f64,
    /// Estimate of the absolute error: the sum over the pieces of the difference of the two rules, which for
    /// smooth functions exceeds the error by orders of magnitude.
    pub error: f64,
}

/// Integrates a function over the interval from `a` to `b`.
///
/// * `f`: is never evaluated at the ends, and must be finite elsewhere.
pub fn integrate(f: &impl Fn(f64) -> f64, [a, b]: [f64; 2], tolerance: Tolerance) -> Integral {
    integrate_2d(&|[x, _]| f(x), [[a, b], [0.0, 1.0]], tolerance)
}

/// Integrates a function over a rectangle.
///
/// * `f`: is never evaluated on the edges, and must be finite elsewhere.
/// * `rectangle`: range of x, range of y.
///
/// # Precision, limits
/// The error's estimate misses what no node sees: a feature narrower than 1/50 of a rectangle that the first
/// 49 nodes miss.
///
/// # Source
/// Kronrod 1965, "Nodes and weights of quadrature formulas"; the division by largest error is that of
/// Piessens et al. 1983, QUADPACK, QAG.
///
/// # Verified by
/// `quadrature::tests`
pub fn integrate_2d(
    f: &impl Fn([f64; 2]) -> f64,
    rectangle: [[f64; 2]; 2],
    tolerance: Tolerance,
) -> Integral {
    let whole = Piece::of(f, rectangle);
    let accepted = |value: f64| tolerance.absolute.max(tolerance.relative * value.abs());
    if whole.error <= accepted(whole.value) {
        return Integral { value: whole.value, error: whole.error };
    }
    let (mut value, mut error) = (whole.value, whole.error);
    let mut pieces = BinaryHeap::from([whole]);
    while error > accepted(value) && pieces.len() < tolerance.pieces {
        let Some(worst) = pieces.pop() else { break };
        (value, error) = (value - worst.value, error - worst.error);
        for half in worst.halves() {
            let piece = Piece::of(f, half);
            (value, error) = (value + piece.value, error + piece.error);
            pieces.push(piece);
        }
    }
    let pieces = pieces.into_vec(); // summed afresh: the running sums carry the rounding of what was taken away
    Integral { value: pieces.iter().map(|p| p.value).sum(), error: pieces.iter().map(|p| p.error).sum() }
}

/// A rectangle with its integral by the finer rule, and by how much coarser rules differ.
struct Piece {
    rectangle: [[f64; 2]; 2],
    value: f64,
    error: f64,
    /// The axis along which the coarser rule differs more.
    worse_axis: usize,
}

impl Piece {
    fn of(f: &impl Fn([f64; 2]) -> f64, rectangle: [[f64; 2]; 2]) -> Self {
        let [xs, ys] = rectangle.map(nodes);
        let (mut fine, mut coarse_x, mut coarse_y) = (0.0, 0.0, 0.0);
        for (j, y) in ys.into_iter().enumerate() {
            let (mut row_fine, mut row_coarse) = (0.0, 0.0);
            for (i, x) in xs.into_iter().enumerate() {
                let value = f([x, y]);
                row_fine += KRONROD[i] * value;
                row_coarse += GAUSS[i] * value;
            }
            fine += KRONROD[j] * row_fine;
            coarse_x += KRONROD[j] * row_coarse;
            coarse_y += GAUSS[j] * row_fine;
        }
        let quarter_area = rectangle.map(|[low, high]| 0.5 * (high - low)).iter().product::<f64>();
        let [error_x, error_y] = [coarse_x, coarse_y].map(|coarse| (quarter_area * (fine - coarse)).abs());
        let worse_axis = usize::from(error_y > error_x);
        Self { rectangle, value: quarter_area * fine, error: error_x + error_y, worse_axis }
    }

    fn halves(&self) -> [[[f64; 2]; 2]; 2] {
        let [low, high] = self.rectangle[self.worse_axis];
        let middle = 0.5 * (low + high);
        [[low, middle], [middle, high]].map(|half| {
            let mut rectangle = self.rectangle;
            rectangle[self.worse_axis] = half;
            rectangle
        })
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Piece {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.error.total_cmp(&other.error)
    }
}

/// The 7 nodes in an interval.
fn nodes([low, high]: [f64; 2]) -> [f64; 7] {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let [a, b, c] = ABSCISSAE.map(|x| half * x);
    [middle - a, middle - b, middle - c, middle, middle + c, middle + b, middle + a]
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIGHT: Tolerance = Tolerance { relative: 1e-10, absolute: 0.0, pieces: 2000 };

    #[test]
    fn the_rules_are_exact_to_their_degrees_and_no_further() {
        let moment = |weights: [f64; 7], k: i32| -> f64 {
            nodes([-1.0, 1.0]).into_iter().zip(weights).map(|(x, w)| w * x.powi(k)).sum()
        };
        for k in (0..12).step_by(2) {
            assert!((moment(KRONROD, k) - 2.0 / f64::from(k + 1)).abs() < 1e-15, "Kronrod, degree {k}"); // rounding of weights below 1
        }
        assert!((moment(GAUSS, 4) - 0.4).abs() < 1e-15 && (moment(GAUSS, 6) - 2.0 / 7.0).abs() > 1e-2); // degree 5: 0.24 ≠ 0.2857
    }

    #[test]
    fn smooth_integrals_reach_their_tolerance() {
        let sine = integrate(&f64::sin, [0.0, std::f64::consts::PI], TIGHT);
        assert!((sine.value - 2.0).abs() <= sine.error && sine.error <= 2e-10); // 1e-10 relative
        let gauss = integrate_2d(&|[x, y]| (-x * x - y * y).exp(), [[-6.0, 6.0], [-6.0, 6.0]], TIGHT);
        assert!((gauss.value - std::f64::consts::PI).abs() < 4e-10); // 1e-10 relative; erfc(6) = 2e-17
    }

    #[test]
    fn a_singular_edge_is_divided_until_good() {
        let root = integrate_2d(
            &|[x, _]| 1.0 / x.sqrt(),
            [[0.0, 1.0], [0.0, 1.0]],
            Tolerance { relative: 1e-6, ..TIGHT },
        );
        assert!((root.value - 2.0).abs() < 2e-6 && root.error < 2e-6); // the tolerance
    }

    #[test]
    fn a_jump_reports_the_error_reached_and_the_error_covers_the_truth() {
        let inside_circle = |[x, y]: [f64; 2]| if x * x + y * y < 1.0 { 1.0 } else { 0.0 };
        let quarter =
            |pieces| integrate_2d(&inside_circle, [[0.0, 1.0], [0.0, 1.0]], Tolerance { pieces, ..TIGHT });
        let (few, many) = (quarter(20), quarter(2000));
        for integral in [few, many] {
            assert!((integral.value - std::f64::consts::FRAC_PI_4).abs() < integral.error);
        }
        assert!(few.error > 1e-10 * few.value && many.error < 0.1 * few.error); // not reached, and said so; pieces × 100 divide cells × 10
    }
}
