use super::{Receiver, cross, dot, length, minus};
use std::f64::consts::{FRAC_PI_2, PI};

/// Irradiance from a sphere of radiance 1 at any tilt, also partly below the receiver's horizon.
///
/// With sin σ = R/d and ω the angle from the normal to the centre: E = π cos ω sin²σ where the whole sphere is above the horizon;
/// where the horizon cuts it, with h = d/R, x = √(h² − 1), y = −x cot ω:
/// E = (cos ω·acos y − x sin ω √(1 − y²))/h² + atan(sin ω √(1 − y²)/x); 0 where it is below.
///
/// * `centre`, `radius`: of the sphere, which does not contain the receiver.
///
/// Returns: W m⁻² per W m⁻² sr⁻¹; NaN for a receiver inside.
///
/// # Source
/// Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-42 and B-43, times π; Snyder 1996 (NASA) gives the same in
/// another form, which the tests compare.
#[must_use]
pub fn from_sphere(receiver: Receiver, centre: [f64; 3], radius: f64) -> f64 {
    let to = minus(centre, receiver.position);
    let h = length(to) / radius;
    let omega = length(cross(to, receiver.normal)).atan2(dot(to, receiver.normal));
    let sigma = (1.0 / h).asin();
    if omega <= FRAC_PI_2 - sigma {
        return PI * omega.cos() / (h * h);
    }
    if omega >= FRAC_PI_2 + sigma {
        return 0.0;
    }
    let x = ((h - 1.0) * (h + 1.0)).sqrt();
    // The branches above bound |y| by 1 up to rounding.
    let y = (-x * omega.cos() / omega.sin()).clamp(-1.0, 1.0);
    let root = omega.sin() * ((1.0 - y) * (1.0 + y)).sqrt();
    (omega.cos() * y.acos() - x * root) / (h * h) + (root / x).atan()
}

#[cfg(test)]
mod tests {
    use super::super::quadrature::over_square;
    use super::*;
    use proptest::prelude::*;

    const UP: Receiver = Receiver { position: [0.0; 3], normal: [0.0, 0.0, 1.0] };

    fn at(omega: f64, distance: f64) -> f64 {
        from_sphere(UP, [distance * omega.sin(), 0.0, distance * omega.cos()], 1.0)
    }

    /// Snyder's form of the same.
    fn snyder(omega: f64, distance: f64) -> f64 {
        let s = (1.0 / distance).asin();
        if omega <= FRAC_PI_2 - s {
            return PI * omega.cos() * s.sin().powi(2);
        }
        if omega >= FRAC_PI_2 + s {
            return 0.0;
        }
        let g = (s.cos() / omega.sin()).asin();
        let first = -2.0 * omega.sin() * s.cos() * g.cos() + FRAC_PI_2 - g + g.sin() * g.cos();
        let root = (s.sin().powi(2) - g.cos().powi(2)).max(0.0).sqrt();
        let second = omega.cos() * (g.cos() * root + s.sin().powi(2) * (g.cos() / s.sin()).min(1.0).asin());
        if omega <= FRAC_PI_2 { PI * omega.cos() * s.sin().powi(2) + first - second } else { first + second }
    }

    /// Quadrature over the cone of directions, uniform in solid angle.
    fn by_directions(omega: f64, distance: f64) -> f64 {
        let cap = 1.0 - (1.0 - distance.powi(-2)).sqrt();
        2.0 * PI
            * cap
            * over_square(800, |u, v| {
                let cosine = 1.0 - u * cap;
                let sine = (1.0 - cosine * cosine).sqrt();
                (cosine * omega.cos() - sine * (2.0 * PI * v).cos() * omega.sin()).max(0.0)
            })
    }

    #[test]
    fn agrees_with_quadrature_at_every_tilt() {
        for distance in [1.05, 1.5, 4.0] {
            for step in 0..=20 {
                let omega = PI * f64::from(step) / 20.0;
                let difference = at(omega, distance) - by_directions(omega, distance);
                // Midpoint rule, h = 1/800, √u at the pole and a kink at the horizon: 2π·h^1.5 = 3e-4 would be the
                // worst; the kink runs obliquely and its errors average, which leaves a tenth.
                assert!(difference.abs() < 3e-5, "{omega} {distance}: {difference}");
            }
        }
    }

    #[test]
    fn is_continuous_where_the_formula_changes() {
        let s = (1.0_f64 / 1.7).asin();
        for edge in [FRAC_PI_2 - s, FRAC_PI_2 + s] {
            // Slope below π: a step of 2e-9 changes less than 7e-9.
            assert!((at(edge - 1e-9, 1.7) - at(edge + 1e-9, 1.7)).abs() < 7e-9);
        }
    }

    proptest! {
        #[test]
        fn agrees_with_the_second_formula(omega in 0.0..PI, distance in 1.001..50.0_f64) {
            // acos and asin near ±1 turn a rounding of 1.1e-16 into its square root times the small factor that follows.
            prop_assert!((at(omega, distance) - snyder(omega, distance)).abs() < 1e-8);
        }
    }
}
