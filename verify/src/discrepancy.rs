//! Discrepancy: how far a point set is from uniform, over all boxes from the origin.

use crate::integrands::Family;

/// Mean of [`l2_star_squared`] over the randomisations of a family of point sets in two dimensions.
///
/// The mean of T² is the integral over x of the variance with which the family measures the box [0, x). Random: 5/(36N). Jitter of N = n²: a
/// cell that an edge cuts at the share a has the variance a(1 − a), so ((n − 1)/6 + 5/36)/N². Scrambled nets of N = 2^m: level k of
/// the step `1[u < x]` has the variance 2^−k/12 on average, and with the gains 0, 2 and 1 of [`net_variance`] it is
/// (20 + 6m)/(144N²).
///
/// * `samples`: N; for jitter its root, for nets its logarithm is rounded down.
///
/// # Source
/// Derived here. Means of 100 Owen-scrambled Sobol sets of 16, 64 and 256 points, 1.18e-3, 9.6e-5 and 7.2e-6, agree to 2 %.
///
/// [`net_variance`]: crate::integrands::Integrand::net_variance
#[must_use]
pub fn mean_l2_star_squared(family: Family, samples: u32) -> f64 {
    let n = f64::from(samples);
    match family {
        Family::Random => 5.0 / (36.0 * n),
        Family::Jitter => ((f64::from(samples.isqrt()) - 1.0) / 6.0 + 5.0 / 36.0) / (n * n),
        Family::ScrambledNet => (20.0 + 6.0 * f64::from(samples.ilog2())) / (144.0 * n * n),
    }
}

/// Squared L2-star discrepancy, ∫(points in [0, x)/N − volume)² dx, by Warnock's formula in O(D·N²).
///
/// T² = 3^−D − (2^(1−D)/N) Σᵢ Πⱼ(1 − xᵢⱼ²) + N^−2 Σᵢₖ Πⱼ(1 − max(xᵢⱼ, xₖⱼ)). Independent points have the mean (2^−D − 3^−D)/N.
///
/// # Precision, limits
/// Terms of size 3^−D cancel: below 1e-14 the value is noise. Points in [0, 1]; NaN for none.
///
/// # Source
/// Warnock 1972, "Computational investigations of low-discrepancy point sets".
#[must_use]
pub fn l2_star_squared<const D: usize>(points: &[[f64; D]]) -> f64 {
    let n = points.len() as f64;
    let single: f64 = points.iter().map(|p| p.iter().map(|x| (1.0 - x) * (1.0 + x)).product::<f64>()).sum();
    let pair = |a: &[f64; D], b: &[f64; D]| a.iter().zip(b).map(|(x, y)| 1.0 - x.max(*y)).product::<f64>();
    let row =
        |(i, a): (usize, &[f64; D])| pair(a, a) + 2.0 * points[..i].iter().map(|b| pair(a, b)).sum::<f64>();
    let double: f64 = points.iter().enumerate().map(row).sum();
    let dimensions = D as f64;
    3.0_f64.powf(-dimensions) - 2.0_f64.powf(1.0 - dimensions) / n * single + double / (n * n)
}

/// Star discrepancy in two dimensions, the greatest |points in the box/N − area| over boxes from the origin, exactly in O(N²).
///
/// The supremum is at a corner of the grid of coordinates (and 1): an open box there holds the fewest points for its area, a closed one
/// the most.
///
/// * `points`: in [0, 1)²; 0 for none.
///
/// # Source
/// Niederreiter 1972, 10.1007/978-1-4615-6753-1 (the discrete form); the sweep is our own.
#[must_use]
pub fn star_2d(points: &[[f64; 2]]) -> f64 {
    let mut by_x = points.to_vec();
    by_x.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut heights: Vec<f64> = points.iter().map(|p| p[1]).collect();
    heights.sort_by(f64::total_cmp);
    let n = points.len() as f64;
    let mut worst = 0.0_f64;
    // Ordinates of the points to the left of the sweep line, in order.
    let mut left: Vec<f64> = Vec::with_capacity(points.len());
    let mut next = 0;
    while next <= by_x.len() {
        let x = by_x.get(next).map_or(1.0, |p| p[0]);
        worst = worst.max(column(x, &left, &heights, n, false));
        let same = by_x[next..].iter().take_while(|p| p[0] == x).count();
        for point in &by_x[next..next + same] {
            left.insert(left.partition_point(|&y| y < point[1]), point[1]);
        }
        worst = worst.max(column(x, &left, &heights, n, true));
        next += same.max(1);
    }
    worst
}

/// The greatest difference over boxes of width x: too few points in open ones, too many in closed ones.
fn column(x: f64, left: &[f64], heights: &[f64], n: f64, closed: bool) -> f64 {
    let (mut count, mut worst) = (0, 0.0_f64);
    for &y in heights.iter().chain([&1.0]) {
        while count < left.len() && (left[count] < y || (closed && left[count] == y)) {
            count += 1;
        }
        let surplus = count as f64 / n - x * y;
        worst = worst.max(if closed { surplus } else { -surplus });
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Moments;
    use crate::seeds::uniform;
    use proptest::prelude::*;

    fn random(seed: u64, n: u64) -> Vec<[f64; 2]> {
        (0..n).map(|i| [uniform(seed, 2 * i), uniform(seed, 2 * i + 1)]).collect()
    }

    /// All boxes with corners on the coordinates, counted point by point.
    fn by_force(points: &[[f64; 2]]) -> f64 {
        let n = points.len() as f64;
        let mut worst = 0.0_f64;
        for x in points.iter().map(|p| p[0]).chain([1.0]) {
            for y in points.iter().map(|p| p[1]).chain([1.0]) {
                let open = points.iter().filter(|p| p[0] < x && p[1] < y).count() as f64;
                let closed = points.iter().filter(|p| p[0] <= x && p[1] <= y).count() as f64;
                worst = worst.max(x * y - open / n).max(closed / n - x * y);
            }
        }
        worst
    }

    #[test]
    fn single_points_have_their_closed_forms() {
        // ∫(1[x > a] − x)² dx = 2·∫₀^½ x² dx = 1/12 for a = ½.
        assert!((l2_star_squared(&[[0.5]]) - 1.0 / 12.0).abs() < 1e-16);
        assert_eq!(star_2d(&[[0.5, 0.5]]), 0.75);
        assert_eq!(star_2d(&[]), 0.0);
    }

    #[test]
    fn independent_points_have_the_known_mean() {
        let values: Moments = (0..2000).map(|seed| l2_star_squared(&random(seed, 16))).collect();
        let estimate = values.estimate();
        // (2^-2 − 3^-2)/16 within six standard errors, 2e-9.
        assert!((estimate.mean - 5.0 / 36.0 / 16.0).abs() < 6.0 * estimate.standard_error);
    }

    #[test]
    fn jittered_points_have_their_mean_and_one_point_is_a_random_one() {
        let cell = |seed: u64, i: u64| {
            let place = |k: u64, offset: u64| (uniform(seed, 2 * i + k) + offset as f64) / 4.0;
            [place(0, i % 4), place(1, i / 4)]
        };
        let jittered = |seed| l2_star_squared(&(0..16).map(|i| cell(seed, i)).collect::<Vec<_>>());
        let estimate = (0..2000).map(jittered).collect::<Moments>().estimate();
        let exact = mean_l2_star_squared(Family::Jitter, 16);
        assert!((estimate.mean - exact).abs() < 6.0 * estimate.standard_error); // six standard errors: 2e-9
        for family in [Family::Random, Family::Jitter, Family::ScrambledNet] {
            assert!((mean_l2_star_squared(family, 1) - 5.0 / 36.0).abs() < 1e-16);
        }
    }

    #[test]
    fn scrambled_sobol_points_have_their_published_mean() {
        for (n, published) in [(16, 1.18e-3), (64, 9.6e-5), (256, 7.2e-6)] {
            let exact = mean_l2_star_squared(Family::ScrambledNet, n);
            assert!((published / exact - 1.0).abs() < 0.02, "{n}: {exact:e}"); // printed to two or three digits
        }
    }

    #[test]
    fn warnock_agrees_with_quadrature() {
        let points = random(3, 5);
        let volume = crate::irradiance::quadrature::over_square(1000, |x, y| {
            let inside = points.iter().filter(|p| p[0] < x && p[1] < y).count() as f64;
            (inside / 5.0 - x * y).powi(2)
        });
        assert!((l2_star_squared(&points) - volume).abs() < 1e-3); // 10 jumps of at most ⅖ in strips of 1/2000
    }

    proptest! {
        #[test]
        fn the_sweep_agrees_with_counting(seed in 0_u64..1000, n in 1_u64..30, coarse in any::<bool>()) {
            let round = |x: f64| if coarse { (8.0 * x).floor() / 8.0 } else { x };
            let points: Vec<[f64; 2]> = random(seed, n).into_iter().map(|p| p.map(round)).collect();
            prop_assert!((star_2d(&points) - by_force(&points)).abs() < 1e-15); // the same sums, one rounding
        }
    }
}
