use std::f64::consts::PI;

/// Radiance everywhere inside a closed diffuse body that emits `emitted` and reflects `albedo` at every point.
///
/// L = Le(1 − ρ^(N+1))/(1 − ρ) when paths end after N reflections; Le/(1 − ρ) without end.
///
/// * `reflections`: N, the reflections that a path may have; `None` for no end. N = 0 is the emitter alone.
/// * `albedo`: ρ in [0, 1).
///
/// Returns: W m⁻² sr⁻¹.
///
/// # Source
/// The geometric series of the Neumann expansion: each reflection in a closed body of uniform radiance L gives ρL.
#[must_use]
pub fn furnace_radiance(emitted: f64, albedo: f64, reflections: Option<u32>) -> f64 {
    let missing = reflections.map_or(0.0, |n| albedo.powf(f64::from(n) + 1.0));
    emitted * (1.0 - missing) / (1.0 - albedo)
}

/// Irradiance by inter-reflection in a diffuse sphere, the same at every point, for any layout of sources inside.
///
/// E = ρΦ/(4πR²(1 − ρ)): a diffuse point of a sphere lights all of it equally, since cos θ·cos θ'/r² = 1/(4R²).
///
/// * `power`: Φ, total power that reaches the wall directly, W; `radius`: of the sphere; `albedo`: ρ in [0, 1).
///
/// Returns: W m⁻², without the direct light.
///
/// # Source
/// Textbook (the integrating sphere); derived as above.
#[must_use]
pub fn integrating_sphere_irradiance(power: f64, radius: f64, albedo: f64) -> f64 {
    albedo * power / (4.0 * PI * radius * radius * (1.0 - albedo))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_sum_of_its_terms() {
        for n in 0..12 {
            let sum: f64 = (0..=n).map(|k| 0.5 * 0.7_f64.powi(k)).sum();
            let closed = furnace_radiance(0.5, 0.7, Some(n.unsigned_abs()));
            assert!((closed - sum).abs() < 1e-15); // twelve roundings of numbers below 2, 1.1e-16 each
        }
        assert!((furnace_radiance(0.5, 0.5, Some(8)) - 0.998_046_875).abs() < 1e-16);
        assert_eq!(furnace_radiance(0.5, 0.5, None), 1.0);
    }

    /// Energy: what the walls absorb of all light, (1 − ρ) times direct and indirect, is the power over the wall.
    #[test]
    fn the_integrating_sphere_absorbs_what_is_emitted() {
        let (power, radius, albedo) = (3.0, 2.0, 0.8);
        let area = 4.0 * PI * radius * radius;
        let total = power / area + integrating_sphere_irradiance(power, radius, albedo);
        assert!(((1.0 - albedo) * total * area - power).abs() < 1e-14); // a few roundings of numbers near 3
    }
}
