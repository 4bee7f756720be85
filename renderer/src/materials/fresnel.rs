//! How much light a smooth boundary reflects: Fresnel's equations for unpolarised light.

use crate::math::Rgb;

/// What a smooth boundary between two dielectrics does to light from one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interface {
    /// The reflected share of the power, in [0, 1].
    pub reflectance: f32,
    /// The refracted share: 1 − reflectance, computed without that difference.
    pub transmittance: f32,
    /// The cosine of the refracted direction, positive; `None` on total reflection.
    pub cos_t: Option<f32>,
    /// Index of refraction on the far side over that on the near side.
    pub eta_rel: f32,
}

/// Solves Snell's law and Fresnel's equations at a boundary.
///
/// With n the index on the near side and m that on the far side (1 and η, or η and 1), k = n|cos θᵢ|, p = m cos θₜ and
/// d = m² − n² = p² − k²: √Rs = d/(k + p)², √Rp = d((m² + n²)k² − n⁴)/(m²k + n²p)², Ts = 4kp/(k + p)²,
/// Tp = 4m²n²kp/(m²k + n²p)²; R and T are the means of the two polarisations.
///
/// * `cos_i`: cosine of the angle to the normal, in [−1, 1]; negative on the inner side.
/// * `eta`: interior over exterior index, positive.
///
/// # Precision, limits
/// All results are right to 0.51 units in the last place: k and d are exact in f64 and p² = k² + d is rounded once, so that
/// neither the critical angle nor an index next to 1 costs digits; T is not 1 − R.
///
/// # Source
/// Born, Wolf: Principles of Optics, 1.5.2–1.5.3; the differences of amplitudes are written as differences of squares.
///
/// # Verified by
/// Claims `stable/dielectric/*`, `fresnel/dielectric/*`
pub fn dielectric(cos_i: f32, eta: f32) -> Interface {
    let eta = f64::from(eta);
    let beyond = (eta - 1.0) * (eta + 1.0);
    let (n, m, d) = if cos_i < 0.0 { (eta, 1.0, -beyond) } else { (1.0, eta, beyond) };
    let eta_rel = to_f32(m / n);
    let k = n * f64::from(cos_i.abs());
    let p2 = k.mul_add(k, d);
    if p2 <= 0.0 || k == 0.0 {
        return Interface { reflectance: 1.0, transmittance: 0.0, cos_t: None, eta_rel };
    }
    let p = p2.sqrt();
    let (n2, m2) = (n * n, m * m);
    let square = |x: f64| x * x;
    let (s, q) = (square(k + p), square(m2 * k + n2 * p));
    let rp = d * ((m2 + n2) * (k * k) - n2 * n2) / q;
    let reflectance = (square(d / s) + square(rp)) / 2.0;
    Interface {
        reflectance: to_f32(reflectance),
        transmittance: to_f32(transmittance([k, p], [n, m])),
        cos_t: Some(to_f32(p / m)),
        eta_rel,
    }
}

/// The refracted share T between media of the indices [n, m], from [k, p] = [n|cos θᵢ|, m cos θₜ], both above 0; the same
/// bits from either side.
///
/// Where both angles are known nothing is lost near the critical one, as p is by √(k² + d).
pub(super) fn transmittance([k, p]: [f64; 2], [n, m]: [f64; 2]) -> f64 {
    let (s, r) = (k + p, m * m * k + n * n * p);
    let parallel = m * n / r;
    2.0 * (k * p) * (1.0 / (s * s) + parallel * parallel)
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

/// The share of diffuse light from inside a medium that its smooth boundary lets out: 1 less 2 ∫ F(c) c dc over [0, 1].
///
/// * `eta`: index of the medium over that outside, positive.
///
/// # Precision, limits
/// The midpoint rule at 4,096 cosines of the boundary seen from the thinner side: within 1e-6 for indices from 1.01
/// (test `diffuse_light_escapes_as_walsh_says`). From the denser side a share escapes that is 1/η² of what enters.
pub fn diffuse_escaping(eta: f32) -> f64 {
    let steps = 4096_u16;
    let thinner = |eta: f32| {
        let at = |i: u16| {
            let c = (f32::from(i) + 0.5) / f32::from(steps);
            f64::from(dielectric(c, eta).transmittance * c)
        };
        2.0 * (0..steps).map(at).sum::<f64>() / f64::from(steps)
    };
    if eta > 1.0 { thinner(eta) / f64::from(eta).powi(2) } else { thinner(1.0 / eta) }
}

/// The reflectance of a conductor of complex index η − ik in vacuum, channel by channel.
///
/// With s² = sin²θ, t = η² − k² − s², A = √(t² + 4η²k²) and a + ib the root of t + 2iηk (a² = (A + t)/2, ab = ηk):
/// Rs = ((c − a)² + b²)/((c + a)² + b²), Rp = Rs ((ac − s²)² + b²c²)/((ac + s²)² + b²c²); R is their mean.
///
/// * `cos_i`: cosine of the angle to the normal, in [0, 1].
///
/// # Precision, limits
/// Right to 0.51 units in the last place, or 2⁻⁴⁸: sums of squares don't cancel, t is (η − 1)(η + 1) − k² + c² and the smaller
/// of a and b is ηk over the other. Where both polarisations are 0/0 all is reflected.
///
/// # Source
/// Born, Wolf: Principles of Optics, 14.2.
///
/// # Verified by
/// Claim `stable/conductor/everywhere`
pub fn conductor(cos_i: f32, eta: Rgb, k: Rgb) -> Rgb {
    let c = f64::from(cos_i);
    let s2 = (1.0 - c) * (1.0 + c);
    let share = |less: f64, more: f64, square: f64| {
        let whole = more * more + square;
        if whole > 0.0 { (less * less + square) / whole } else { 1.0 }
    };
    let channel = |eta: f32, k: f32| {
        let (eta, k) = (f64::from(eta), f64::from(k));
        let t = c.mul_add(c, (eta - 1.0) * (eta + 1.0) - k * k);
        let cross = eta * k;
        let larger = ((t * t + 4.0 * cross * cross).sqrt() + t.abs()) / 2.0;
        let smaller = if larger > 0.0 { cross * cross / larger } else { 0.0 };
        let (a2, b2) = if t < 0.0 { (smaller, larger) } else { (larger, smaller) };
        let a = a2.sqrt();
        let rs = share(c - a, c + a, b2);
        let rp = rs * share(a * c - s2, a * c + s2, b2 * c * c);
        to_f32((rs + rp) / 2.0)
    };
    Rgb::new(channel(eta.r, k.r), channel(eta.g, k.g), channel(eta.b, k.b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Snell's law and Fresnel's equations as textbooks have them, in f64: [reflectance, cos θt].
    fn textbook(cos_i: f64, eta: f64) -> Option<[f64; 2]> {
        let sin_t = (1.0 - cos_i * cos_i).sqrt() / eta;
        let cos_t = (sin_t < 1.0).then(|| ((1.0 - sin_t) * (1.0 + sin_t)).sqrt())?;
        let rs = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        let rp = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        Some([(rs * rs + rp * rp) / 2.0, cos_t])
    }

    #[test]
    fn glass_reflects_four_percent_at_normal_incidence() {
        for cos in [1.0, -1.0] {
            let at = dielectric(cos, 1.5);
            assert_eq!((at.reflectance, at.transmittance, at.cos_t), (0.04, 0.96, Some(1.0)));
        }
    }

    #[test]
    fn at_brewsters_angle_one_polarisation_is_not_reflected() {
        for eta in [1.1_f32, 1.33, 1.5, 2.4] {
            let e2 = f64::from(eta) * f64::from(eta);
            let rs = ((e2 - 1.0) / (e2 + 1.0)).powi(2);
            let cos = to_f32((1.0 / (1.0 + e2)).sqrt());
            // The reflectance turns by at most 2 per unit of cosine here; the cosine is rounded by 2⁻²⁵.
            assert!((f64::from(dielectric(cos, eta).reflectance) - rs / 2.0).abs() < 1.2e-7, "eta {eta}");
        }
    }

    #[test]
    fn without_a_change_of_index_all_light_passes() {
        for cos in [1.0, 0.5, 1e-3, 1e-20, -0.7] {
            let at = dielectric(cos, 1.0);
            assert_eq!((at.reflectance, at.transmittance, at.cos_t), (0.0, 1.0, Some(cos.abs())));
        }
    }

    #[test]
    fn agrees_with_the_textbook_and_keeps_the_power() {
        for eta in [0.5_f32, 0.99, 1.0001, 1.33, 1.5, 10.0] {
            for i in 1..=10_000_u16 {
                let cos = f32::from(i) / 10_000.0;
                let at = dielectric(cos, eta);
                let Some([r, cos_t]) = textbook(f64::from(cos), f64::from(eta)) else {
                    assert_eq!((at.reflectance, at.transmittance, at.cos_t), (1.0, 0.0, None));
                    continue;
                };
                // Both are rounded to f32 once, by at most 2⁻²⁵ below 1; their sum by 2⁻²⁴.
                assert!((f64::from(at.reflectance) - r).abs() < 3.1e-8, "{cos} {eta}");
                assert!((at.reflectance + at.transmittance - 1.0).abs() <= 1.2e-7, "{cos} {eta}");
                assert!((f64::from(at.cos_t.unwrap()) - cos_t).abs() < 3.1e-8, "{cos} {eta}");
            }
        }
    }

    #[test]
    fn reflects_the_same_share_on_the_way_in_and_out() {
        for i in 1..=1000_u16 {
            let going_in = dielectric(f32::from(i) / 1000.0, 1.5);
            let coming_out = dielectric(-going_in.cos_t.unwrap(), 1.5);
            // cos θt is rounded by 2⁻²⁵; coming out, the reflectance turns at most 24 per unit near the critical
            // angle at the smallest cosine here: 4/cos θi from dcosθi/dcosθt.
            let slope = 4.0 * 1.5 * 1.5 / (f32::from(i) / 1000.0);
            let bound = (slope + 8.0) * 6e-8;
            assert!((going_in.reflectance - coming_out.reflectance).abs() < bound, "{i}");
        }
    }

    #[test]
    fn near_the_critical_angle_no_digit_is_lost_and_the_share_grows_to_one() {
        let critical = (1.0_f32 - 1.0 / 2.25).sqrt();
        let mut last = 0.0;
        for step in (-200..=200_i32).rev() {
            let cos = f32::from_bits(critical.to_bits().checked_add_signed(step).unwrap());
            let at = dielectric(-cos, 1.5);
            let expected = textbook(f64::from(cos), 1.0 / 1.5).map_or(1.0, |[r, _]| r);
            // The textbook's cos²θt is rounded by 2⁻⁵², so its root by 2⁻²⁶ at worst, times a slope of 6.
            assert!((f64::from(at.reflectance) - expected).abs() < 1.2e-7, "{step}");
            assert!(at.reflectance >= last, "{step}");
            last = at.reflectance;
        }
        assert_eq!(last, 1.0);
    }

    #[test]
    fn near_grazing_the_refracted_share_keeps_its_digits() {
        for cos in [1e-4_f32, 1e-8, 1e-20] {
            let expected = 2.0 * f64::from(cos) * (1.0 + 2.25) / 1.25_f64.sqrt();
            let got = f64::from(dielectric(cos, 1.5).transmittance);
            // The series' next term is relative 2 (1/q + 1/(…)) c < 4c, and the result is rounded by 2⁻²⁴.
            assert!((got / expected - 1.0).abs() < 4.0 * f64::from(cos) + 1e-7, "{cos}");
        }
    }

    /// Walsh's closed form for n > 1.
    fn walsh(n: f64) -> f64 {
        let (n2, n4) = (n * n, n.powi(4));
        0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
            + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
            - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
            + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
    }

    #[test]
    fn diffuse_light_escapes_as_walsh_says() {
        for eta in [1.01_f32, 1.1, 1.33, 1.5, 2.4, 10.0] {
            let enters = 1.0 - walsh(f64::from(eta));
            // The rule's error h²/24·|f'| at the ends: 2.5e-9 times a slope of at most 4/√(η² − 1) = 28.
            assert!((diffuse_escaping(1.0 / eta) - enters).abs() < 1e-6, "{eta}: {enters}");
            let leaves = enters / f64::from(eta).powi(2);
            assert!((diffuse_escaping(eta) - leaves).abs() < 1e-6, "{eta}: {leaves}");
        }
        assert_eq!(diffuse_escaping(1.0), 1.0);
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for i in 1..=100_u16 {
            let cos = f32::from(i) / 100.0;
            let metal = conductor(cos, Rgb::splat(1.5), Rgb::BLACK).r;
            // Some ten roundings of 2⁻²⁴ in terms of size about 3.
            assert!((metal - dielectric(cos, 1.5).reflectance).abs() < 2e-6, "{cos}");
        }
    }

    #[test]
    fn a_conductor_without_index_reflects_everything() {
        for cos in [0.0, 1e-20, 0.3, 0.999_999, 1.0] {
            assert_eq!(conductor(cos, Rgb::BLACK, Rgb::BLACK), Rgb::WHITE, "{cos}");
        }
    }

    #[test]
    fn a_conductor_agrees_with_complex_arithmetic() {
        for (eta, k) in [(0.143_f32, 3.983_f32), (1.6575, 9.2238), (4.37, 5.2), (0.04, 0.9), (0.0, 1.0)] {
            for i in 0..=100_u16 {
                let cos = f32::from(i) / 100.0;
                let got = f64::from(conductor(cos, Rgb::splat(eta), Rgb::splat(k)).g);
                let expected = complex_reflectance(f64::from(cos), [f64::from(eta), f64::from(k)]);
                // Some ten roundings of 2⁻²⁴ in quotients of numbers of one size.
                assert!((got - expected).abs() < 2e-6, "{eta} {k} {cos}: {got} {expected}");
            }
        }
    }

    /// |r|² by complex arithmetic on m = η + ik: (c − q)/(c + q) and (m²c − q)/(m²c + q) with q² = m² − s².
    fn complex_reflectance(c: f64, [eta, k]: [f64; 2]) -> f64 {
        let m2 = [eta * eta - k * k, 2.0 * eta * k];
        let q2 = [m2[0] - (1.0 - c * c), m2[1]];
        let (radius, angle) = (q2[0].hypot(q2[1]).sqrt(), q2[1].atan2(q2[0]) / 2.0);
        let q = [radius * angle.cos(), radius * angle.sin()];
        let ratio = |a: [f64; 2]| {
            let norm2 = |re: f64, im: f64| re * re + im * im;
            norm2(a[0] - q[0], a[1] - q[1]) / norm2(a[0] + q[0], a[1] + q[1])
        };
        (ratio([c, 0.0]) + ratio([m2[0] * c, m2[1] * c])) / 2.0
    }
}
