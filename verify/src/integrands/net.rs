//! Exact variances of Owen-scrambled nets.

use super::{Integrand, Shape, disk_corner_area};

impl Integrand {
    /// Variance of the mean of 2^m points of an Owen-scrambled (0, m, 2)-net in base 2.
    ///
    /// The variance of f is a sum σ² over pairs of levels k₁, k₂ ≥ 0 of Haar wavelets, and over levels k of one coordinate alone. The
    /// net takes k < m and k₁ + k₂ ≤ m − 2 away, doubles k₁ + k₂ = m − 1, keeps the rest, and divides by N = 2^m. With S(a, b), the mean square of
    /// f's means over the cells of 2^a columns and 2^b rows, and A(j) its sum over a + b = j, that is
    ///
    /// N·Var = ∫f² + A(m + 1) − 3A(m) + 2A(m − 1) − S(0, m + 1) − S(m + 1, 0) + S(0, m) + S(m, 0).
    ///
    /// For the bilinear one N³·Var = 1/24 + (8m + (m + 1)·4/3 + 4/9)/256: the error falls as N^(−3/2), times the root of a logarithm.
    ///
    /// # Precision, limits
    /// Sums of 3m terms near ∫f² cancel to N·Var: relative error below 1e-7 up to m = 10. O(m·2^m) steps.
    ///
    /// # Source
    /// Owen 1997, "Monte Carlo variance of scrambled net quadrature", 10.1137/S0036142994277468, whose gain coefficients for t = 0 and two
    /// dimensions are 0, 2 and 1; the sum in terms of S is derived here.
    #[must_use]
    pub fn net_variance(&self, m: u32) -> f64 {
        let Some(before) = m.checked_sub(1) else { return self.variance() };
        let sum = |j: u32| (0..=j).map(|a| self.cell_mean_square([a, j - a])).sum::<f64>();
        let lines = |j: u32| self.cell_mean_square([0, j]) + self.cell_mean_square([j, 0]);
        let square = self.variance() + self.integral().powi(2);
        let scaled = square + sum(m + 1) - 3.0 * sum(m) + 2.0 * sum(before) - lines(m + 1) + lines(m);
        scaled / 2.0_f64.powf(f64::from(m))
    }

    /// S(a, b): the mean over 2^a columns and 2^b rows of the square of a cell's mean.
    fn cell_mean_square(&self, [a, b]: [u32; 2]) -> f64 {
        let (columns, rows) = (1_u32 << a, 1_u32 << b);
        if let Shape::Product(g, h) = self.shape {
            return g.strip_squares(columns) / f64::from(columns) * h.strip_squares(rows) / f64::from(rows);
        }
        let cells = f64::from(columns) * f64::from(rows);
        let area = |i: u32, j: u32| self.area_up_to([i, j].map(f64::from), [columns, rows].map(f64::from));
        let row = |j: u32| (0..=columns).map(|i| area(i, j)).collect::<Vec<_>>();
        let mut below = row(0);
        let mut squares = 0.0;
        for j in 1..=rows {
            let above = row(j);
            let cell = |i: usize| above[i + 1] - above[i] - below[i + 1] + below[i];
            squares += (0..below.len() - 1).map(|i| cell(i).powi(2)).sum::<f64>();
            below = above;
        }
        cells * squares
    }

    /// Area of a figure in the rectangle from the origin to (i/columns, j/rows), up to terms that depend on one coordinate alone.
    fn area_up_to(&self, [i, j]: [f64; 2], [columns, rows]: [f64; 2]) -> f64 {
        let (x, y) = (i / columns, j / rows);
        match self.shape {
            Shape::Product(g, h) => g.integral_to(x) * h.integral_to(y),
            Shape::Disk { centre, radius } => disk_corner_area(radius, x - centre, y - centre),
            Shape::Triangle => x * y - 0.5 * (x + y - 1.0).max(0.0).powi(2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::ALL;
    use super::*;
    use crate::estimate::Moments;
    use crate::seeds::derive;

    fn named(name: &str) -> Integrand {
        Integrand::named(name).unwrap()
    }

    #[test]
    fn one_point_has_the_variance_of_the_function_and_two_halve_what_is_left() {
        for integrand in ALL {
            assert_eq!(integrand.net_variance(0), integrand.variance(), "{}", integrand.name);
        }
        // y alone: two points in the two halves, each of variance 1/48, so that the mean has 1/96.
        assert!((named("lineary").net_variance(1) - 1.0 / 96.0).abs() < 1e-15); // a few roundings of ⅓
    }

    #[test]
    fn the_bilinear_function_has_its_closed_form() {
        for m in 1..=10_u32 {
            let (levels, n) = (f64::from(m), f64::from(1 << m));
            let interaction = 8.0 * levels + (levels + 1.0) * 4.0 / 3.0 + 4.0 / 9.0;
            let exact = (1.0 / 24.0 + interaction / 256.0) / n.powi(3);
            let relative = named("bilinear").net_variance(m) / exact - 1.0;
            assert!(relative.abs() < 1e-7, "{m}: {relative:e}"); // 33 terms of rounding 1e-16 against N·Var = 4e-7
        }
    }

    #[test]
    fn published_errors_of_scrambled_sobol_points_are_met() {
        // RMSE of 100 sequences of 16, 64, 256 and 1024 points; each has the standard error 1/√200 = 7 %.
        for (name, published) in [
            ("quarterdisk", [0.0496, 0.0163, 0.00625, 0.00201]),
            ("triangle", [0.0637, 0.0205, 0.00756, 0.00261]),
            ("stepx", [0.0179, 0.00791, 0.00196, 0.00025]),
            ("quartergaussian", [0.00493, 0.000_596, 0.000_089, 0.000_010_3]),
            ("bilinear", [0.00737, 0.000_978, 0.000_15, 0.000_019_2]),
        ] {
            for (m, rmse) in [4, 6, 8, 10].into_iter().zip(published) {
                let exact = named(name).net_variance(m).sqrt();
                assert!((rmse / exact - 1.0).abs() < 0.28, "{name}, m = {m}: {exact}"); // four standard errors
            }
        }
    }

    /// The net (i/N, bit-reversed i), each bit flipped or not by the bits before it.
    fn scrambled(m: u32, seed: u64) -> Vec<[f64; 2]> {
        let flip = |word: u32, axis: u64| {
            let bit = |k: u32| {
                let prefix = u64::from(word) >> (32 - k) | 1 << k;
                u32::from(derive(seed, axis, prefix) & 1 == 1) << (31 - k)
            };
            word ^ (0..20).map(bit).fold(0, |all, flip| all | flip)
        };
        let number = |word: u32, axis: u64| {
            let low = derive(seed, axis + 2, u64::from(word)) % (1 << 12); // digits 21 to 32 at random
            (f64::from(flip(word, axis) >> 12) * 4096.0 + low as f64) / 2.0_f64.powi(32)
        };
        (0..1_u32 << m).map(|i| [number(i << (32 - m), 0), number(i.reverse_bits(), 1)]).collect()
    }

    #[test]
    fn simulated_scramblings_have_that_variance() {
        for (integrand, m) in ["quarterdisk", "fulldisk", "triangle", "quartergaussian"]
            .map(named)
            .into_iter()
            .zip([3, 4, 4, 5])
        {
            let error = |seed: u64| {
                let points = scrambled(m, derive(7, u64::from(m), seed));
                let mean = points.iter().map(|&p| integrand.eval(p)).sum::<f64>() / points.len() as f64;
                (mean - integrand.integral()).powi(2)
            };
            let estimate = (0..4000).map(error).collect::<Moments>().estimate();
            let exact = integrand.net_variance(m);
            // Six standard errors of the measured variance: 2e-9 for each of 4.
            assert!((estimate.mean - exact).abs() < 6.0 * estimate.standard_error, "{}", integrand.name);
        }
    }
}
