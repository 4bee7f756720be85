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
/// With c = |cos θᵢ|, η the index of the far side over that of the near side and q = η cos θₜ = √(c² + η² − 1):
/// Rs = ((c − q)/(c + q))², Rp = ((η²c − q)/(η²c + q))², Ts = 4cq/(c + q)², Tp = 4η²cq/(η²c + q)²;
/// R and T are the means of the two polarisations.
///
/// * `cos_i`: cosine of the angle to the normal, in [−1, 1]; negative on the inner side.
/// * `eta`: interior over exterior index, positive.
///
/// # Precision, limits
/// Computed in f64 from the f32 cosine: q² does not cancel near the critical angle, T keeps its digits near grazing.
///
/// # Source
/// Born, Wolf: Principles of Optics, 1.5.2–1.5.3; written in q so that η = 1 gives exactly 0 and 1.
pub fn dielectric(cos_i: f32, eta: f32) -> Interface {
    let eta_rel = if cos_i < 0.0 { 1.0 / f64::from(eta) } else { f64::from(eta) };
    let c = f64::from(cos_i.abs());
    let q2 = c * c + (eta_rel - 1.0) * (eta_rel + 1.0);
    if q2 <= 0.0 || c == 0.0 {
        return Interface { reflectance: 1.0, transmittance: 0.0, cos_t: None, eta_rel: to_f32(eta_rel) };
    }
    let q = q2.sqrt();
    let ec = eta_rel * eta_rel * c;
    let square = |x: f64| x * x;
    let reflectance = (square((c - q) / (c + q)) + square((ec - q) / (ec + q))) / 2.0;
    let transmittance = (4.0 * c * q / square(c + q) + 4.0 * ec * q / square(ec + q)) / 2.0;
    Interface {
        reflectance: to_f32(reflectance),
        transmittance: to_f32(transmittance),
        cos_t: Some(to_f32(q / eta_rel)),
        eta_rel: to_f32(eta_rel),
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

/// The reflectance of a conductor of complex index η − ik in vacuum, channel by channel.
///
/// With s² = sin²θ, t = η² − k² − s², A = √(t² + 4η²k²), a² = (A + t)/2:
/// Rs = (A − 2ac + c²)/(A + 2ac + c²), Rp = Rs (Ac² − 2acs² + s⁴)/(Ac² + 2acs² + s⁴); R is their mean.
///
/// * `cos_i`: cosine of the angle to the normal, in [0, 1].
///
/// # Precision, limits
/// a² is 2η²k²/(A − t) where t < 0, so that a strong k costs no digits.
///
/// # Source
/// Born, Wolf: Principles of Optics, 14.2.
pub fn conductor(cos_i: f32, eta: Rgb, k: Rgb) -> Rgb {
    let c2 = cos_i * cos_i;
    let s2 = (1.0 - cos_i) * (1.0 + cos_i);
    let channel = |eta: f32, k: f32| {
        let (eta2, k2) = (eta * eta, k * k);
        let t = eta2 - k2 - s2;
        let big_a = (t * t + 4.0 * eta2 * k2).sqrt();
        let a2 = if t < 0.0 { 2.0 * eta2 * k2 / (big_a - t) } else { (big_a + t) / 2.0 };
        let ac2 = 2.0 * a2.sqrt() * cos_i;
        let rs = (big_a + c2 - ac2) / (big_a + c2 + ac2);
        let p = big_a * c2 + s2 * s2;
        let rp = rs * (p - ac2 * s2) / (p + ac2 * s2);
        (rs + rp) / 2.0
    };
    Rgb::new(channel(eta.r, k.r), channel(eta.g, k.g), channel(eta.b, k.b))
}
