//! Closed forms of smooth dielectrics: reflectances at an angle, of diffuse light, and of slabs.

/// Share of unpolarised light that a smooth boundary reflects.
///
/// R = ½(((cos i − n cos t)/(cos i + n cos t))² + ((n cos i − cos t)/(n cos i + cos t))²), sin i = n sin t.
///
/// * `cosine`: of the angle of incidence, in [0, 1]; `eta`: index beyond the boundary over the index before it.
///
/// Returns: 0 to 1; 1 where all is reflected.
///
/// # Source
/// Fresnel 1823; Born and Wolf, "Principles of Optics", section 1.5.
#[must_use]
pub fn reflectance(cosine: f64, eta: f64) -> f64 {
    let sine_2 = (1.0 - cosine) * (1.0 + cosine) / (eta * eta);
    if sine_2 >= 1.0 {
        return 1.0;
    }
    let beyond = (1.0 - sine_2).sqrt();
    let s = (cosine - eta * beyond) / (cosine + eta * beyond);
    let p = (eta * cosine - beyond) / (eta * cosine + beyond);
    0.5 * (s * s + p * p)
}

/// Share of diffuse light that a smooth boundary reflects, from outside and from inside a body of index `n` > 1.
///
/// # Source
/// Walsh 1926, "The reflection factor of a polished glass surface for diffused light"; from inside, what is refracted is 1/n² of
/// what comes from outside, for the same light in both directions.
#[must_use]
pub fn diffuse_reflectance(n: f64) -> [f64; 2] {
    let (n2, n4) = (n * n, n.powi(4));
    let outside = 0.5
        + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln();
    [outside, 1.0 - (1.0 - outside) / n2]
}

/// Shares of light that a clear slab reflects and transmits, all reflections between its faces added: 2R/(1 + R), (1 − R)/(1 + R).
///
/// * `face`: R, the share that one face reflects, the same from both sides.
///
/// # Source
/// The geometric series of the reflections inside: T = (1 − R)²(1 + R² + R⁴ + …).
#[must_use]
pub fn slab(face: f64) -> [f64; 2] {
    [2.0 * face / (1.0 + face), (1.0 - face) / (1.0 + face)]
}

/// How far sideways a ray leaves the plane beyond a slab from where it would without the slab: thickness·(tan i − tan t).
///
/// * `sine`: of the angle of incidence, in [0, 1); `eta`: index of the slab.
///
/// # Source
/// Snell's law.
#[must_use]
pub fn slab_shift(thickness: f64, sine: f64, eta: f64) -> f64 {
    let tangent = |sine: f64| sine / ((1.0 - sine) * (1.0 + sine)).sqrt();
    thickness * (tangent(sine) - tangent(sine / eta))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::irradiance::quadrature::over_unit;
    use proptest::prelude::*;

    proptest! {
        /// ½(sin²(i − t)/sin²(i + t) + tan²(i − t)/tan²(i + t)), and the way back.
        #[test]
        fn reflectances_agree_with_the_form_in_angles(i in 0.01..1.55_f64, eta in 1.05..4.0_f64) {
            let t = (i.sin() / eta).asin();
            let squares = |f: fn(f64) -> f64| (f(i - t) / f(i + t)).powi(2);
            let angles = 0.5 * (squares(f64::sin) + squares(f64::tan));
            // Differences of angles near 0.01·(1 − 1/1.05) lose 1e-16/5e-4, squared terms twice that.
            prop_assert!((reflectance(i.cos(), eta) - angles).abs() < 1e-11);
            // t near the critical angle: cos t has 1e-16/cos t.
            prop_assert!((reflectance(t.cos(), 1.0 / eta) - angles).abs() < 1e-12);
        }
    }

    #[test]
    fn known_angles() {
        assert!((reflectance(1.0, 1.5) - 0.04).abs() < 1e-16); // one rounding
        assert_eq!((reflectance(0.0, 1.5), reflectance(0.7, 1.0 / 1.5)), (1.0, 1.0));
        let brewster = 1.5_f64.atan().cos();
        assert!((reflectance(brewster, 1.5) - 0.5 * (1.25 / 3.25_f64).powi(2)).abs() < 1e-15); // a few roundings
    }

    /// ∫ R·2cos d(cos), on both sides.
    #[test]
    fn diffuse_light_agrees_with_quadrature() {
        for n in [1.33, 1.5, 2.0] {
            let mean = |eta: f64| over_unit(20_000, |square| reflectance(square.sqrt(), eta));
            let [outside, inside] = diffuse_reflectance(n);
            // Midpoint rule with a root at grazing: h^1.5·4 = 1.4e-6; from inside a root at the critical angle too.
            assert!((outside - mean(n)).abs() < 3e-6 && (inside - mean(1.0 / n)).abs() < 1e-5, "{n}");
        }
        assert!((diffuse_reflectance(1.5)[0] - 0.091_778).abs() < 5e-7); // published, six decimals
    }

    #[test]
    fn a_slab_is_its_series_and_keeps_energy() {
        let face = 0.2_f64;
        let series: f64 = (0..40).map(|k| 0.8 * 0.8 * face.powi(2 * k)).sum();
        let [reflected, transmitted] = slab(face);
        assert!((transmitted - series).abs() < 1e-15 && (reflected + transmitted - 1.0).abs() < 1e-15); // rounding of 1
        // 45° on index √2: refracted at 30°.
        let shift = slab_shift(2.0, 0.5_f64.sqrt(), 2.0_f64.sqrt());
        assert!((shift - 2.0 * (1.0 - 1.0 / 3.0_f64.sqrt())).abs() < 1e-15);
    }
}
