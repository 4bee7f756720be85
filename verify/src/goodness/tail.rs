//! Tail probabilities of the statistics in the limit of many values.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// P(D·√n > λ).
pub(super) fn kolmogorov_tail(lambda: f64) -> f64 {
    // Either series has terms below 1e-16 after the fifth on its side of 1.
    if lambda < 1.0 {
        let term = |k: i32| (-(f64::from(2 * k - 1) * PI / lambda).powi(2) / 8.0).exp();
        return 1.0 - (2.0 * PI).sqrt() / lambda * (1..=5).map(term).sum::<f64>();
    }
    let term = |k: i32| 2.0 * (-2.0 * (f64::from(k) * lambda).powi(2)).exp();
    (1..=5).map(|k| if k % 2 == 1 { term(k) } else { -term(k) }).sum()
}

/// P(A² > z).
pub(super) fn anderson_darling_tail(z: f64) -> f64 {
    if z.is_infinite() {
        return 0.0;
    }
    if z > 8.0 {
        // ½χ²₁ + W with W the rest of the sum: P = E[P(χ²₁ > 2z − 2W)] = P(χ²₁ > 2z)·E[exp W]·(1 + E*[W]/(2z) + O(1/z²)), where
        // E[exp W] = Π_{j≥2} (1 − 2/(j(j + 1)))^−½ = √3 and the tilted mean E*[W] = Σ_{j≥2} 1/((j − 1)(j + 2)) = 11/18.
        let first = 2.0 * crate::tails::normal_tail((2.0 * z).sqrt());
        return 3.0_f64.sqrt() * first * (1.0 + 11.0 / (36.0 * z));
    }
    shifted_tail(z, 0.0)
}

/// Number of weights 1/(j(j + 1)) that are summed one by one.
const TERMS: u32 = 200;

/// Step and number of the nodes of u in [`shifted_tail`].
const STEP: f64 = 0.125;
const NODES: u32 = 3200;

/// P(A² > z) when the first of the components of A² has the mean `shift` instead of 0, for z up to 8 and shifts up to 6.
///
/// A² = Σ zⱼ²/(j(j + 1)) with zⱼ = Σᵢ φⱼ(uᵢ)/√n over Legendre's polynomials φⱼ, so Imhof's inversion gives
/// P(A² > z) = ½ + (1/π)∫₀^∞ sin θ(u)/(u ρ(u)) du, θ = ½ Σ atan(wⱼu) + ½ s²w₁u/(1 + w₁²u²) − ½ z u,
/// ρ = Π (1 + wⱼ²u²)^¼ · exp(½ s²w₁²u²/(1 + w₁²u²)), wⱼ = 1/(j(j + 1)).
///
/// # Source
/// Imhof 1961, 10.1093/biomet/48.3-4.419; the components: Durbin and Knott 1972.
pub(super) fn shifted_tail(z: f64, shift: f64) -> f64 {
    static NODE_VALUES: OnceLock<Vec<[f64; 3]>> = OnceLock::new();
    // At u = 400 ρ exceeds 1e8. The integrand is even and analytic, so the midpoint rule errs only by P(A² > 2π/step − z): 1e-18, and
    // 1e-3 with the largest shift.
    let nodes = NODE_VALUES.get_or_init(|| (0..NODES).map(node).collect());
    // Weights beyond the last sum to 1/(TERMS + 1): they act as their mean.
    let z = z - 1.0 / f64::from(TERMS + 1);
    let square = shift * shift;
    let integrand = |&[u, theta, amplitude]: &[f64; 3]| {
        let wu = 0.5 * u;
        let share = square / (1.0 + wu * wu);
        (theta + 0.5 * share * wu - 0.5 * z * u).sin() * amplitude * (-0.5 * share * wu * wu).exp()
    };
    let sum: f64 = nodes.iter().map(integrand).sum();
    (0.5 + sum * STEP / PI).clamp(0.0, 1.0)
}

/// A node u with ½ Σ atan(wⱼu) and 1/(u Π (1 + wⱼ²u²)^¼).
fn node(i: u32) -> [f64; 3] {
    let u = (f64::from(i) + 0.5) * STEP;
    let (mut theta, mut log_rho) = (0.0, 0.0);
    for j in 1..=TERMS {
        let wu = u / f64::from(j * (j + 1));
        theta += 0.5 * wu.atan();
        log_rho += 0.25 * (wu * wu).ln_1p();
    }
    [u, theta, (-log_rho).exp() / u]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_agree_with_published_quantiles() {
        // Asymptotic Kolmogorov quantiles, printed to three decimals: d ln p = 4λ·5e-4 = 0.4 %.
        for (lambda, p) in [(1.358, 0.05), (1.628, 0.01), (1.949, 0.001)] {
            assert!((kolmogorov_tail(lambda) / p - 1.0).abs() < 4e-3, "{lambda}");
        }
        assert!((kolmogorov_tail(0.999_999) - kolmogorov_tail(1.000_001)).abs() < 1e-5); // slope near 1 is below 2
        // Anderson–Darling quantiles by Marsaglia and Marsaglia; the quadrature is good to 1e-5 of these p.
        for (z, p) in
            [(1.932_957_832_741_593_7, 0.1), (2.492_367_160_049_41, 0.05), (3.878_125_021_605_395, 0.01)]
        {
            assert!((anderson_darling_tail(z) / p - 1.0).abs() < 1e-5, "{z}: {}", anderson_darling_tail(z));
        }
        // Where the far tail takes over its neglected O(1/z²) is below half a percent: (3·E*[W²]/2 − 2·E*[W])/(2z)² = −0.2 %.
        assert!((anderson_darling_tail(7.9999) / anderson_darling_tail(8.0001) - 1.0).abs() < 5e-3);
    }

    #[test]
    fn a_large_shift_leaves_a_normal_component() {
        // More than the first component alone, P(½(Z + 5)² > 4) = P(Z > √8 − 5), and less than with twice the mean of the others, 1.
        let first = |z: f64| crate::tails::normal_tail((2.0 * z).sqrt() - 5.0);
        assert!((first(4.0)..first(3.0)).contains(&shifted_tail(4.0, 5.0)));
        assert!(shifted_tail(4.0, 3.0) > shifted_tail(4.0, 2.0));
    }
}
