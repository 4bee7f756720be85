//! Densities per steradian in double precision, written from their definitions and not from the renderer's code.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;

/// cos θ/π above the surface.
pub(in super::super) fn diffuse(wi: DVec3) -> f64 {
    FRAC_1_PI * wi.z.max(0.0)
}

/// Smith's G₁ of GGX: 2/(1 + √(1 + α² tan² θ)).
pub(in super::super) fn ggx_g1(alpha: f64, w: DVec3) -> f64 {
    let tan2 = w.truncate().length_squared() / (w.z * w.z);
    2.0 / (1.0 + (1.0 + alpha * alpha * tan2).sqrt())
}

/// Mirrored visible normals of GGX: G₁(wo)·(wo·h)·D(h)/cos θₒ, times the Jacobian 1/(4·wo·h).
///
/// # Source
/// Walter, Marschner, Li, Torrance 2007, equations 33, 34 and 14; Heitz 2014, equation 3.
pub(in super::super) fn ggx(alpha: f64, wo: DVec3, wi: DVec3) -> f64 {
    if wi.z <= 0.0 {
        return 0.0;
    }
    let h = (wo + wi).normalize();
    let tan2 = h.truncate().length_squared() / (h.z * h.z);
    let d = alpha * alpha * FRAC_1_PI / (h.z.powi(4) * (alpha * alpha + tan2).powi(2));
    ggx_g1(alpha, wo) * d / (4.0 * wo.z)
}

/// Phong's highlight (n + 1)/(2π)·cosⁿ α about the mirrored direction, above the surface.
pub(in super::super) fn highlight(exponent: i32, wo: DVec3, wi: DVec3) -> f64 {
    let mirrored = DVec3::new(-wo.x, -wo.y, wo.z);
    let cos = mirrored.normalize().dot(wi.normalize()).max(0.0);
    if wi.z <= 0.0 { 0.0 } else { f64::from(exponent + 1) / TAU * cos.powi(exponent) }
}

/// The blur disk: 1/(π f² cos³ γ) where tan γ ≤ f about the ideal direction, on that direction's side of the surface.
pub(in super::super) fn blur(f: f64, ideal: DVec3, wi: DVec3) -> f64 {
    let cos = ideal.dot(wi) / wi.length();
    let tan = ideal.cross(wi).length() / ideal.dot(wi);
    let inside = cos > 0.0 && tan <= f && wi.z * ideal.z > 0.0;
    if inside { FRAC_1_PI / (f * f * cos.powi(3)) } else { 0.0 }
}

/// Fresnel's reflectance by the sines and tangents of both angles; `eta` is the far side's index over the near side's.
pub(in super::super) fn fresnel(cos: f64, eta: f64) -> f64 {
    let near = cos.min(1.0).acos();
    let sin = near.sin() / eta;
    if sin >= 1.0 {
        return 1.0;
    }
    let far = sin.asin();
    let s = (near - far).sin() / (near + far).sin();
    let p = (near - far).tan() / (near + far).tan();
    0.5 * (s * s + p * p)
}
